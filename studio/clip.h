// Lines clipped to an image.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "base/math.h"

namespace panwright::studio {

// The part of a line within an image, as shares of the way from a to b (Liang and Barsky 1984);
// nothing: it is outside. size: pixels
inline std::optional<std::pair<double, double>> visible_part(const Vec2& a, const Vec2& b,
                                                             const Vec2& size) {
  double from = 0, to = 1;
  const Vec2 way = b - a;
  for (int k = 0; k < 2; ++k)
    for (const auto& [distance, speed] :
         {std::pair{a[k], way[k]}, std::pair{size[k] - a[k], -way[k]}}) {
      if (speed == 0 && distance < 0) return std::nullopt;
      if (speed > 0) from = std::max(from, -distance / speed);
      if (speed < 0) to = std::min(to, -distance / speed);
    }
  if (!(from <= to)) return std::nullopt;
  return std::pair(from, to);
}

}  // namespace panwright::studio
