// The record in files that write_image() wrote: of each format only what that takes.
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/core.h>

#include <exception>
#include <optional>
#include <string_view>

#include "base/file.h"
#include "base/text.h"
#include "image/image.h"

namespace panwright::image {
namespace {

using Found = std::optional<std::string>;

std::uint32_t number_at(std::string_view bytes, std::size_t at, std::size_t count, bool big) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[at + (big ? i : count - 1 - i)]);
    value = (value << 8) | byte;
  }
  return value;
}

// Among the text chunks.
Found record_of_png(std::string_view bytes) {
  const std::string begin = std::string(kRecordName) + '\0';
  constexpr std::size_t kFrame = 12;  // length, type and checksum of a chunk
  for (std::size_t at = 8; at + kFrame <= bytes.size();) {
    const std::size_t length = number_at(bytes, at, 4, true);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const std::string_view body = bytes.substr(at + 8, length);
    if (bytes.substr(at + 4, 4) == "tEXt" && body.starts_with(begin))
      return std::string(body.substr(begin.size()));
    at += kFrame + length;
  }
  return std::nullopt;
}

// Among the stored entries, from the first one on.
Found record_of_npz(std::string_view bytes) {
  constexpr std::size_t kHeader = 30;
  for (std::size_t at = 0; at + kHeader <= bytes.size();) {
    if (number_at(bytes, at, 4, false) != 0x04034b50u || number_at(bytes, at + 8, 2, false) != 0)
      return std::nullopt;
    const std::size_t size = number_at(bytes, at + 18, 4, false);
    const std::size_t name = number_at(bytes, at + 26, 2, false);
    const std::size_t body = kHeader + name + number_at(bytes, at + 28, 2, false);
    if (body > bytes.size() - at || size > bytes.size() - at - body) return std::nullopt;
    if (bytes.substr(at + kHeader, name) == "meta.json")
      return std::string(bytes.substr(at + body, size));
    at += body + size;
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
    log.report_file(Code::E0202, path.string(),
                    fmt::format("records are read from .png, .exr and .npz, not {}",
                                in_quotes(path.extension().string())));
    return failed;
  }
  const auto file = MappedFile::open(path, log);
  if (!file) return failed;
  const std::string_view bytes(reinterpret_cast<const char*>(file->bytes().data()),
                               file->bytes().size());
  Found found;
  if (*format == ImageFormat::png) found = record_of_png(bytes);
  if (*format == ImageFormat::npz) found = record_of_npz(bytes);
  if (*format == ImageFormat::exr) found = record_of_exr(path);
  if (found) return *std::move(found);
  log.report_file(Code::E0207, path.string(), "the image has no record of how it was made",
                  *format == ImageFormat::npy ? ".npy has no place for one; .npz has" : "");
  return failed;
}

}  // namespace panwright::image
