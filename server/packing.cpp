#include "server/packing.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::server {

std::uint32_t word_at(std::span<const std::uint8_t> bytes) {
  assert(bytes.size() >= 4);
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
         std::uint32_t{bytes[2]} << 8 | std::uint32_t{bytes[3]};
}

WireWriter& WireWriter::word(std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
  return *this;
}

WireWriter& WireWriter::flag(bool value) {
  bytes_.push_back(value ? 1 : 0);
  return *this;
}

WireWriter& WireWriter::real64(double value) {
  const std::uint64_t both = packed(value);
  word(static_cast<std::uint32_t>(both));
  return word(static_cast<std::uint32_t>(both >> 32));
}

WireWriter& WireWriter::text(std::string_view value) {
  const std::size_t size = value.size() + 1 + (value.size() + 1) % 2;
  assert(size <= 0xFFFF);
  bytes_.push_back(static_cast<std::uint8_t>(size >> 8));
  bytes_.push_back(static_cast<std::uint8_t>(size));
  bytes_.insert(bytes_.end(), value.begin(), value.end());
  bytes_.resize(bytes_.size() + size - value.size(), 0);
  return *this;
}

WireWriter& WireWriter::bytes(std::span<const std::uint8_t> value) {
  bytes_.insert(bytes_.end(), value.begin(), value.end());
  return *this;
}

std::span<std::uint8_t> WireWriter::room(std::size_t count) {
  bytes_.resize(bytes_.size() + count);
  return std::span(bytes_).last(count);
}

std::uint32_t WireReader::word() { return word_at(bytes(4)); }

bool WireReader::flag() { return bytes(1)[0] != 0; }

double WireReader::real() {
  const double value = unpacked(word());
  finite_ = finite_ && std::isfinite(value);
  return value;
}

double WireReader::real64() {
  const std::uint64_t low = word();
  const double value = unpacked(std::uint64_t{word()} << 32 | low);
  finite_ = finite_ && std::isfinite(value);
  return value;
}

std::span<const std::uint8_t> WireReader::bytes(std::size_t count) {
  assert(count <= left_.size());
  const auto out = left_.first(count);
  left_ = left_.subspan(count);
  return out;
}

}  // namespace panwright::server
