// Exact predicates of points in the plane.
#pragma once

#include "base/math.h"

namespace panwright::geometry::internal {

// Returns 1 when a, b, c turn counter-clockwise, −1 clockwise, 0 when collinear. Exact, as long as
// no coordinate but 0 lies below 1e-60 times another. Shewchuk, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates", 1997.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

// Returns true if d certainly lies within the circle through a, b, c (counter-clockwise); false if
// rounding could decide. Lengths are taken in the spatial plane that projects to these points;
// `lift` holds the squared distances of a, b and c to d in it.
bool clearly_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d,
                       const Vec3& lift);

}  // namespace panwright::geometry::internal
