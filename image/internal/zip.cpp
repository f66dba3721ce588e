// The zip file format as in PKWARE's APPNOTE 6.3: stored and deflated entries.
#include <zlib.h>

#include <algorithm>
#include <new>
#include <utility>

#include "image/internal/zip.h"

namespace panwright::image {
namespace {

constexpr std::uint16_t kDosDate = (1 << 5) | 1;  // 1980-01-01, the earliest there is
constexpr std::uint16_t kDeflated = 8;            // the method
constexpr int kLevel = 4;                         // of zlib: fast
constexpr std::uint32_t kEscape32 = 0xffffffffu;  // "see the zip64 record"

class Record {
 public:
  Record& u16(std::uint64_t value) { return little_endian(value, 2); }
  Record& u32(std::uint64_t value) { return little_endian(value, 4); }
  Record& u64(std::uint64_t value) { return little_endian(value, 8); }
  Record& text(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  std::span<const std::byte> bytes() const { return as_bytes(bytes_); }
  std::size_t size() const { return bytes_.size(); }

 private:
  Record& little_endian(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>((value >> (8 * i)) & 0xff);
    return *this;
  }
  std::string bytes_;
};

std::uint32_t crc_of(std::uint32_t crc, std::span<const std::byte> bytes) {
  if (bytes.empty()) return crc;  // note: zlib takes a null pointer as a wish to start again
  return static_cast<std::uint32_t>(
      crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

bool ZipWriter::put(std::span<const std::byte> bytes, DiagnosticLog& log) {
  position_ += bytes.size();
  return file_.write(bytes, log);
}

bool ZipWriter::deflate(std::span<const std::byte> head, std::span<const std::byte> body,
                        DiagnosticLog& log) {
  constexpr std::size_t kPiece = 1u << 20;
  constexpr int kRaw = -15, kMemory = 8;  // no zlib header, as a zip demands
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kRaw, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::vector<std::byte> out(kPiece);
  bool good = true;
  for (const auto& [part, last] : {std::pair{head, false}, std::pair{body, true}})
    for (std::size_t at = 0; good && (at < part.size() || (last && at == 0)); at += kPiece) {
      const std::size_t length = std::min(kPiece, part.size() - std::min(at, part.size()));
      // note: zlib takes a mutable pointer, and only reads
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(part.data() + at));
      stream.avail_in = static_cast<uInt>(length);
      const int flush = last && at + length >= part.size() ? Z_FINISH : Z_NO_FLUSH;
      do {
        stream.next_out = reinterpret_cast<Bytef*>(out.data());
        stream.avail_out = kPiece;
        (void)::deflate(&stream, flush);
        good = put(std::span(out).first(kPiece - stream.avail_out), log);
      } while (good && stream.avail_out == 0);
    }
  deflateEnd(&stream);
  return good;
}

bool ZipWriter::add(const std::string& name, std::span<const std::byte> head,
                    std::span<const std::byte> body, DiagnosticLog& log, bool deflated) {
  const std::uint64_t size = head.size() + body.size();
  Entry entry{name, size, size, position_, crc_of(crc_of(0, head), body), deflated};
  // deflated bytes may be a little more than the others
  const bool large = size + (deflated ? size / 1000 + 64 : 0) >= zip64_from_;
  const auto header = [&] {
    Record record;
    record.u32(0x04034b50).u16(large ? 45 : 20).u16(0).u16(deflated ? kDeflated : 0);
    record.u16(0).u16(kDosDate).u32(entry.crc);
    record.u32(large ? kEscape32 : entry.stored).u32(large ? kEscape32 : size);
    record.u16(name.size()).u16(large ? 20 : 0).text(name);
    if (large) record.u16(1).u16(16).u64(size).u64(entry.stored);
    return record;
  };
  if (!put(header().bytes(), log)) return false;
  const std::uint64_t begin = position_;
  if (!(deflated ? deflate(head, body, log) : put(head, log) && put(body, log))) return false;
  entry.stored = position_ - begin;
  entries_.push_back(entry);
  return !deflated || file_.write_at(entry.offset, header().bytes(), log);
}

bool ZipWriter::finish(DiagnosticLog& log) {
  const std::uint64_t start = position_;
  bool any_large = false;
  for (const Entry& entry : entries_) {
    const bool large =
        entry.size >= zip64_from_ || entry.stored >= zip64_from_ || entry.offset >= zip64_from_;
    any_large = any_large || large;
    Record record;
    record.u32(0x02014b50).u16(large ? 45 : 20).u16(large ? 45 : 20).u16(0);
    record.u16(entry.deflated ? kDeflated : 0).u16(0).u16(kDosDate).u32(entry.crc);
    record.u32(large ? kEscape32 : entry.stored).u32(large ? kEscape32 : entry.size);
    record.u16(entry.name.size()).u16(large ? 28 : 0).u16(0).u16(0).u16(0).u32(0);
    record.u32(large ? kEscape32 : entry.offset).text(entry.name);
    if (large) record.u16(1).u16(24).u64(entry.size).u64(entry.stored).u64(entry.offset);
    if (!put(record.bytes(), log)) return false;
  }
  const std::uint64_t size = position_ - start;
  const std::uint64_t count = entries_.size();
  Record tail;
  const bool large = any_large || start >= zip64_from_;
  if (large) {
    tail.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(count).u64(count);
    tail.u64(size).u64(start);
    tail.u32(0x07064b50).u32(0).u64(position_).u32(1);
  }
  tail.u32(0x06054b50).u16(0).u16(0).u16(count).u16(count);
  tail.u32(large ? kEscape32 : size).u32(large ? kEscape32 : start).u16(0);
  return put(tail.bytes(), log);
}

}  // namespace panwright::image
