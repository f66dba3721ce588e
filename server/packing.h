// Numbers and texts of the PANGU protocol as bytes (docs/server.md).
//
// Big-endian. A float is its IEEE word turned left by 9 bits, so that sign and exponent are the low
// bits; a double is turned by 12, and its low word comes first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace panwright::server {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t packed(float value) {
  return std::rotl(std::bit_cast<std::uint32_t>(value), 9);
}
constexpr float unpacked(std::uint32_t word) { return std::bit_cast<float>(std::rotr(word, 9)); }
constexpr std::uint64_t packed(double value) {
  return std::rotl(std::bit_cast<std::uint64_t>(value), 12);
}
constexpr double unpacked(std::uint64_t word) { return std::bit_cast<double>(std::rotr(word, 12)); }

// Returns the word in the first four bytes. Expects: as many.
std::uint32_t word_at(std::span<const std::uint8_t> bytes);

// Writer of a message.
class WireWriter {
 public:
  WireWriter& word(std::uint32_t value);
  WireWriter& flag(bool value);
  WireWriter& real(double value) { return word(packed(static_cast<float>(value))); }
  WireWriter& real64(double value);
  // Length with the final zero, padded to an even number, then the text. Expects: below 64 KiB.
  WireWriter& text(std::string_view value);
  WireWriter& bytes(std::span<const std::uint8_t> value);
  // A float in IEEE form, big-endian.
  WireWriter& ieee(float value) { return word(std::bit_cast<std::uint32_t>(value)); }
  // Appends N bytes, to be set by the caller before anything else is written.
  std::span<std::uint8_t> room(std::size_t count);
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

// Reader of a whole message. Expects: no more is read than it has.
class WireReader {
 public:
  explicit WireReader(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  std::uint32_t word();
  bool flag();
  double real();
  double real64();
  std::span<const std::uint8_t> bytes(std::size_t count);
  // False once a number was read that is not finite.
  bool finite() const { return finite_; }
  std::size_t left() const { return left_.size(); }

 private:
  std::span<const std::uint8_t> left_;
  bool finite_ = true;
};

}  // namespace panwright::server
