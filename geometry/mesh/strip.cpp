#include "geometry/mesh/strip.h"

namespace panwright::geometry {

std::uint64_t append_strip(std::span<const std::uint32_t> strip, std::vector<Triangle>& triangles) {
  std::uint64_t left_out = 0;
  for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
    const std::uint32_t a = strip[i];
    const std::uint32_t b = strip[i + 1];
    const std::uint32_t c = strip[i + 2];
    if (a == b || b == c || c == a) {
      ++left_out;
    } else if (i % 2 == 0) {
      triangles.push_back({a, b, c});
    } else {
      triangles.push_back({b, a, c});
    }
  }
  return left_out;
}

}  // namespace panwright::geometry
