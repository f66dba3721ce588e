#include "image/whole.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <zlib.h>

#include <cstdint>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "image/image.h"
#include "image/internal/image_codecs.h"
#include "image/internal/writers.h"
#include "image/internal/zip.h"
#include "image/npy.h"

namespace panwright::image {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Chunks of ISO/IEC 15948: length, type, content, CRC of the type and content.
bool is_whole_png(std::span<const std::byte> bytes) {
  constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kAround = 12;
  if (!text_of(bytes).starts_with(kPngSignature)) return false;
  bytes = bytes.subspan(kPngSignature.size());
  while (bytes.size() >= kAround) {
    const std::size_t length = big_endian(bytes, 0);
    if (length > bytes.size() - kAround) return false;
    const auto content = bytes.subspan(4, 4 + length);
    if (crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()) !=
        big_endian(bytes, 8 + length))
      return false;
    bytes = bytes.subspan(kAround + length);
    if (text_of(content).starts_with("IEND")) return bytes.empty();
  }
  return false;
}

bool is_whole_exr(const std::filesystem::path& path) {
  try {
    Imf::InputFile file(path.c_str(), 1);
    const auto window = file.header().dataWindow();
    const Imf::ChannelList& channels = file.header().channels();
    if (!file.isComplete() || channels.begin() == channels.end()) return false;
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    if (width <= 0 || width > (std::int64_t{1} << 24)) return false;
    std::vector<float> line(static_cast<std::size_t>(width));
    Imf::FrameBuffer buffer;
    buffer.insert(channels.begin().name(),
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(line.data() - window.min.x),
                             sizeof(float), 0));
    file.setFrameBuffer(buffer);
    file.readPixels(window.max.y);
    return true;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

bool is_whole(const std::filesystem::path& path) {
  const auto format = image_format(path);
  if (!format) return false;
  DiagnosticLog none;
  const auto file = MappedFile::open(path, none);
  if (!file) return false;
  switch (*format) {
    case ImageFormat::png:
      return is_whole_png(file->bytes());
    case ImageFormat::exr:
      return is_whole_exr(path);
    case ImageFormat::npy:
      return is_whole_npy(file->bytes());
    case ImageFormat::npz:
      return ZipReader(file->bytes()).is_whole();
    case ImageFormat::tiff:
      return is_whole_tiff(text_of(file->bytes()));
    case ImageFormat::fits:
      return is_whole_fits(text_of(file->bytes()));
  }
  return false;
}

}  // namespace panwright::image
