// Measures of single triangles.
#pragma once

#include "base/math.h"

namespace panwright::geometry {

// 2·area / longest edge² below this: the corners are collinear in single precision.
inline constexpr double kDegenerateRatio = 1e-7;

struct TriangleMeasure {
  Vec3 cross;              // 2·area, along the counter-clockwise normal
  double double_area;      // m²
  double longest_squared;  // m²
  bool degenerate() const {
    return !(double_area >= kDegenerateRatio * longest_squared) || double_area == 0;
  }
};
TriangleMeasure measure(const Vec3& a, const Vec3& b, const Vec3& c);

// Returns the point of triangle abc nearest to the origin. Ericson, "Real-Time Collision
// Detection", 2005, 5.1.5.
Vec3 nearest_to_origin(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace panwright::geometry
