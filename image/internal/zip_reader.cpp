// Reader of the zip file format, as in PKWARE's APPNOTE 6.3: stored and deflated entries, zip64.
#include <zlib.h>

#include <algorithm>
#include <new>

#include "image/internal/zip.h"

namespace panwright::image {
namespace {

constexpr std::uint64_t kEnd = 22, kEnd64 = 56, kLocator = 20, kCentral = 46, kLocal = 30;  // bytes
constexpr std::uint64_t kMostComment = 0xffff;
constexpr std::uint64_t kIn64 = 0xffffffffu;  // "see the zip64 record"
constexpr std::size_t kMostEntries = 1 << 20;

}  // namespace

ZipReader::ZipReader(std::span<const std::byte> bytes) : bytes_(bytes) {
  good_ = read_directory();
  if (!good_) entries_.clear();
}

// Expects: at + count <= size.
std::uint64_t ZipReader::number(std::uint64_t at, unsigned count) const {
  std::uint64_t value = 0;
  for (unsigned i = count; i-- > 0;)
    value = value << 8 | std::to_integer<std::uint64_t>(bytes_[at + i]);
  return value;
}

bool ZipReader::read_directory() {
  const std::uint64_t size = bytes_.size();
  if (size < kEnd) return false;
  std::uint64_t end = size - kEnd;
  const std::uint64_t last = end - std::min(end, kMostComment);
  while (number(end, 4) != 0x06054b50u)
    if (end-- == last) return false;
  std::uint64_t count = number(end + 10, 2), at = number(end + 16, 4);
  if ((count == 0xffff || at == kIn64) && end >= kLocator &&
      number(end - kLocator, 4) == 0x07064b50u) {
    const std::uint64_t end64 = number(end - kLocator + 8, 8);
    if (end64 > size || size - end64 < kEnd64 || number(end64, 4) != 0x06064b50u) return false;
    count = number(end64 + 32, 8);
    at = number(end64 + 48, 8);
  }
  if (count > kMostEntries) return false;
  for (; count > 0; --count) {
    if (at > size || size - at < kCentral || number(at, 4) != 0x02014b50u) return false;
    const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2);
    const std::uint64_t whole = kCentral + name + extra + number(at + 32, 2);
    if (whole > size - at) return false;
    Entry entry{{},
                number(at + 24, 4),
                number(at + 20, 4),
                number(at + 42, 4),
                static_cast<std::uint32_t>(number(at + 16, 4)),
                static_cast<std::uint16_t>(number(at + 10, 2))};
    entry.name.assign(reinterpret_cast<const char*>(bytes_.data()) + at + kCentral, name);
    std::uint64_t field = at + kCentral + name;
    for (const std::uint64_t fields = field + extra; fields - field >= 4;) {
      const std::uint64_t length = number(field + 2, 2);
      if (length > fields - field - 4) break;
      std::uint64_t place = field + 4;
      if (number(field, 2) == 1)
        for (std::uint64_t* value : {&entry.size, &entry.stored, &entry.offset})
          if (*value == kIn64 && place + 8 <= field + 4 + length) {
            *value = number(place, 8);
            place += 8;
          }
      field += 4 + length;
    }
    entries_.push_back(std::move(entry));
    at += whole;
  }
  return true;
}

std::optional<std::span<const std::byte>> ZipReader::stored(const Entry& entry) const {
  const std::uint64_t size = bytes_.size();
  if (entry.offset > size || size - entry.offset < kLocal ||
      number(entry.offset, 4) != 0x04034b50u || (number(entry.offset + 6, 2) & 1) != 0)
    return std::nullopt;
  const std::uint64_t head = kLocal + number(entry.offset + 26, 2) + number(entry.offset + 28, 2);
  if (head > size - entry.offset || entry.stored > size - entry.offset - head) return std::nullopt;
  return bytes_.subspan(entry.offset + head, entry.stored);
}

bool ZipReader::is_whole() const {
  return good_ && std::ranges::all_of(
                      entries_, [&](const Entry& entry) { return stored(entry).has_value(); });
}

std::optional<std::vector<std::byte>> ZipReader::content(const Entry& entry) const {
  const auto place = stored(entry);
  if (!place) return std::nullopt;
  const std::span<const std::byte> stored = *place;
  // deflate makes at most 1032 bytes of one
  constexpr std::uint64_t kMostGrowth = 1040;
  if (entry.method == 0 ? entry.size != entry.stored
                        : entry.method != 8 || entry.size / kMostGrowth > entry.stored)
    return std::nullopt;
  std::vector<std::byte> out(entry.size);
  if (entry.method == 0) {
    std::ranges::copy(stored, out.begin());
  } else {
    z_stream stream{};
    constexpr int kRaw = -15;
    if (inflateInit2(&stream, kRaw) != Z_OK) throw std::bad_alloc();
    std::uint64_t from = 0, to = 0;
    int status = Z_OK;
    while (status == Z_OK) {
      constexpr std::uint64_t kPiece = 1u << 30;
      const auto in = static_cast<uInt>(std::min(kPiece, stored.size() - from));
      const auto room = static_cast<uInt>(std::min(kPiece, out.size() - to));
      Bytef none = 0;
      // note: zlib takes a mutable pointer, and only reads
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(stored.data() + from));
      stream.avail_in = in;
      stream.next_out = room == 0 ? &none : reinterpret_cast<Bytef*>(out.data() + to);
      stream.avail_out = room;
      status = inflate(&stream, Z_NO_FLUSH);
      from += in - stream.avail_in;
      to += room - stream.avail_out;
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END || to != out.size()) return std::nullopt;
  }
  const auto crc =
      out.empty() ? 0 : crc32_z(0, reinterpret_cast<const Bytef*>(out.data()), out.size());
  if (crc != entry.crc) return std::nullopt;
  return out;
}

}  // namespace panwright::image
