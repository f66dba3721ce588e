// Digital numbers as TIFF 6.0: one strip, not compressed, little-endian; the record as
// ImageDescription.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "image/internal/writers.h"

namespace panwright::image {

namespace {

constexpr std::uint16_t kShort = 3, kLong = 4, kAscii = 2;
constexpr std::uint16_t kDescription = 270, kStrip = 273, kStripBytes = 279;

void append_little(std::uint64_t value, int bytes, std::string& out) {
  for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k));
}

std::uint64_t little_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < count && at + k < bytes.size(); ++k)
    value |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

struct Tag {
  std::size_t count = 0, value = 0;
};

std::optional<Tag> find_tag(std::string_view bytes, std::uint16_t id) {
  if (!bytes.starts_with(std::string_view("II*\0", 4))) return std::nullopt;
  const std::size_t directory = little_at(bytes, 4, 4);
  const std::size_t tags = little_at(bytes, directory, 2);
  for (std::size_t k = 0; k < tags; ++k) {
    const std::size_t at = directory + 2 + 12 * k;
    if (at + 12 > bytes.size()) break;
    if (little_at(bytes, at, 2) == id)
      return Tag{little_at(bytes, at + 4, 4), little_at(bytes, at + 8, 4)};
  }
  return std::nullopt;
}

}  // namespace

bool write_tiff(AtomicFile& file, const Image& image, DiagnosticLog& log) {
  std::string record;
  for (const auto& [name, value] : image.metadata)
    if (name == kRecordName) record = value;
  record += '\0';
  const std::uint32_t bytes = image.dn_bits > 8 ? 2 : 1;
  constexpr std::uint32_t kTags = 11, kHeader = 8;
  constexpr std::uint32_t kDirectory = 2 + 12 * kTags + 4;
  const std::uint32_t text = kHeader + kDirectory;
  const std::uint32_t data = (text + static_cast<std::uint32_t>(record.size()) + 1) & ~1u;
  std::string head = "II";
  append_little(42, 2, head);
  append_little(kHeader, 4, head);
  append_little(kTags, 2, head);
  const auto tag = [&](std::uint16_t id, std::uint16_t type, std::uint64_t count,
                       std::uint64_t value) {
    append_little(id, 2, head);
    append_little(type, 2, head);
    append_little(count, 4, head);
    append_little(value, 4, head);
  };
  tag(256, kLong, 1, image.width);
  tag(257, kLong, 1, image.height);
  tag(258, kShort, 1, 8 * bytes);  // bits of a sample
  tag(259, kShort, 1, 1);          // not compressed
  tag(262, kShort, 1, 1);          // black is 0
  tag(kDescription, kAscii, record.size(), text);
  tag(kStrip, kLong, 1, data);
  tag(277, kShort, 1, 1);  // samples of a pixel
  tag(278, kLong, 1, image.height);
  tag(kStripBytes, kLong, 1, std::uint64_t{bytes} * image.dn.size());
  tag(281, kShort, 1, (1u << image.dn_bits) - 1);  // largest sample
  append_little(0, 4, head);
  head += record;
  head.resize(data, '\0');
  std::string samples;
  samples.reserve(bytes * image.dn.size());
  for (const std::uint16_t number : image.dn)
    append_little(number, static_cast<int>(bytes), samples);
  return file.write(as_bytes(head), log) && file.write(as_bytes(samples), log);
}

std::optional<std::string> record_of_tiff(std::string_view bytes) {
  const auto tag = find_tag(bytes, kDescription);
  if (!tag || tag->count < 2 || tag->value > bytes.size() || tag->count > bytes.size() - tag->value)
    return std::nullopt;
  return std::string(bytes.substr(tag->value, tag->count - 1));
}

bool is_whole_tiff(std::string_view bytes) {
  const auto strip = find_tag(bytes, kStrip), size = find_tag(bytes, kStripBytes);
  return strip && size && std::uint64_t{strip->value} + size->value == bytes.size();
}

}  // namespace panwright::image
