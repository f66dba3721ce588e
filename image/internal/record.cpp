// The record in files that write_image() wrote: of each format only what that takes.
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string_view>

#include "base/file.h"
#include "base/text.h"
#include "image/image.h"
#include "image/internal/writers.h"
#include "image/internal/zip.h"

namespace panwright::image {
namespace {

using Found = std::optional<std::string>;

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = (value << 8) | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Among the text chunks.
Found record_of_png(std::string_view bytes) {
  const std::string begin = std::string(kRecordName) + '\0';
  constexpr std::size_t kFrame = 12;  // length, type and checksum of a chunk
  for (std::size_t at = 8; at + kFrame <= bytes.size();) {
    const std::size_t length = big_endian_at(bytes, at);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const std::string_view body = bytes.substr(at + 8, length);
    if (bytes.substr(at + 4, 4) == "tEXt" && body.starts_with(begin))
      return std::string(body.substr(begin.size()));
    at += kFrame + length;
  }
  return std::nullopt;
}

Found record_of_npz(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kMostBytes = 64u << 20;
  const ZipReader zip(bytes);
  for (const ZipReader::Entry& entry : zip.entries()) {
    if (entry.name != "meta.json" || entry.size > kMostBytes) continue;
    const auto content = zip.content(entry);
    if (!content) return std::nullopt;
    return std::string(reinterpret_cast<const char*>(content->data()), content->size());
  }
  return std::nullopt;
}

Found record_of_exr(const std::filesystem::path& path) {
  try {
    const Imf::InputFile file(path.c_str(), 1);
    const auto* text = file.header().findTypedAttribute<Imf::StringAttribute>(kRecordName);
    if (text != nullptr) return text->value();
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> read_image_record(const std::filesystem::path& path, DiagnosticLog& log) {
  const auto format = image_format(path);
  if (!format) {
    log.report_file(Code("E0202"), path.string(),
                    fmt::format("records are read from .png, .exr, .npz, .tif and .fits, not {}",
                                in_quotes(path.extension().string())));
    return failed;
  }
  const auto file = MappedFile::open(path, log);
  if (!file) return failed;
  const std::string_view bytes(reinterpret_cast<const char*>(file->bytes().data()),
                               file->bytes().size());
  Found found;
  if (*format == ImageFormat::png) found = record_of_png(bytes);
  if (*format == ImageFormat::tiff) found = record_of_tiff(bytes);
  if (*format == ImageFormat::fits) found = record_of_fits(bytes);
  if (*format == ImageFormat::npz) found = record_of_npz(file->bytes());
  if (*format == ImageFormat::exr) found = record_of_exr(path);
  if (found) return *std::move(found);
  log.report_file(Code("E0207"), path.string(), "the image has no record of how it was made",
                  *format == ImageFormat::npy ? ".npy has no place for one; .npz has" : "");
  return failed;
}

}  // namespace panwright::image
