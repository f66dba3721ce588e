// Doubles in a file of either byte order. Private to ephemeris.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace panwright::ephemeris {

inline std::uint64_t swapped(std::uint64_t bits) { return __builtin_bswap64(bits); }

// View of doubles. What lies outside is NaN, so that no count of a file leads beyond its bytes.
class Doubles {
 public:
  Doubles() = default;
  Doubles(const std::byte* data, std::size_t count, bool other_order)
      : data_(data), count_(count), other_order_(other_order) {}

  std::size_t size() const { return count_; }
  double operator[](std::size_t i) const {
    if (i >= count_) return std::numeric_limits<double>::quiet_NaN();
    std::uint64_t bits = 0;
    std::memcpy(&bits, data_ + i * sizeof bits, sizeof bits);
    return std::bit_cast<double>(other_order_ ? swapped(bits) : bits);
  }
  // Parts that do not lie inside are empty.
  Doubles part(std::size_t first, std::size_t count) const {
    if (first > count_ || count > count_ - first) return {};
    return {data_ + first * sizeof(double), count, other_order_};
  }

 private:
  const std::byte* data_ = nullptr;
  std::size_t count_ = 0;
  bool other_order_ = false;
};

// Returns the index of the last value at or below x, of ascending ones; 0 where none is.
inline std::size_t last_at_or_below(const Doubles& values, double x) {
  std::size_t low = 0, high = values.size();
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (values[middle] <= x ? low : high) = middle;
  }
  return low;
}

// Returns a whole number in [0, most]; ~0 for other values.
inline std::size_t whole_number(double value, std::size_t most) {
  if (!(value >= 0) || !(value <= static_cast<double>(most))) return ~std::size_t{0};
  const auto out = static_cast<std::size_t>(value);
  return static_cast<double>(out) == value ? out : ~std::size_t{0};
}

}  // namespace panwright::ephemeris
