// Exact predicates of points in the plane.
#pragma once

#include "base/math.h"

namespace panwright::geometry::internal {

// 1 when a, b, c turn counter-clockwise, −1 clockwise, 0 when they lie on one line. Exact, as long
// as no coordinate but 0 lies below 1e-60 times another. Shewchuk, "Adaptive precision
// floating-point arithmetic and fast robust geometric predicates", 1997.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

// Whether d lies within the circle through a, b, c (counter-clockwise), beyond doubt: false where
// rounding could have made it so. Lengths are taken in the plane in space whose projection the
// points are; `lift` holds the squared distances of a, b and c to d in it.
bool clearly_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d,
                       const Vec3& lift);

}  // namespace panwright::geometry::internal
