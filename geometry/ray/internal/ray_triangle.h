// Watertight ray-triangle intersection. Private to geometry.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "base/math.h"

namespace panwright::geometry::internal {

// Ray in a frame sheared so that it runs along the third axis. The rest is plane geometry of points
// that depend on the ray and one corner each.
struct ShearedRay {
  ShearedRay() = default;
  // Expects: a direction of any non-zero length.
  ShearedRay(const Vec3& from, const Vec3& to) : origin(from), direction(to) {
    const Vec3 size = glm::abs(direction);
    z = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    x = (z + 1) % 3;
    y = (x + 1) % 3;
    // note: keeps the winding
    if (direction[z] < 0) std::swap(x, y);
    inverse = 1 / direction[z];
    shear = {direction[x] * inverse, direction[y] * inverse};
    start = {origin[x], origin[y], origin[z]};
  }

  // A point projected into the plane.
  Vec2 flat(const Vec3& p) const {
    // note: glm's operator[] branches on the axis, and processors predict that badly
    const double* const at = glm::value_ptr(p);
    const double height = at[z] - start.z;
    return {at[x] - start.x - shear.x * height, at[y] - start.y - shear.y * height};
  }

  Vec3 origin;
  Vec3 direction;
  Vec3 start;          // the origin's x, y and z
  Vec2 shear{0};       // of x and y for each z
  double inverse = 1;  // of the direction's z
  int x = 0;
  int y = 1;
  int z = 2;  // axis of the largest component of the direction
};

// Returns a.x·b.y − a.y·b.x with the exact sign despite rounding, and its negative with a and b
// exchanged.
inline double turn(const Vec2& a, const Vec2& b) {
  const double left = a.x * b.y;
  const double right = a.y * b.x;
  if (left != right || left == 0) return left - right;
  return std::fma(a.x, b.y, -left) - std::fma(a.y, b.x, -right);
}

struct Crossing {
  double along = 0;     // in lengths of the direction, from the origin
  Vec2 barycentric{0};  // weights of b and c
  bool front = true;    // a, b, c turn counter-clockwise along the ray
};

// Intersects a ray's line with the triangle a, b, c, its outline included. Each corner is rounded
// to one point in the plane across the ray, and the sides of these points are decided exactly: so a
// line between neighbours hits at least one of them. Woop, Benthin, Wald, "Watertight ray/triangle
// intersection", 2013, in double.
//
//   first  false if the crossing lies before it, in lengths of the direction
inline bool cross(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c, double first,
                  Crossing& crossing) {
  const Vec2 flat_a = ray.flat(a);
  const Vec2 flat_b = ray.flat(b);
  const Vec2 flat_c = ray.flat(c);
  const double u = turn(flat_c, flat_b);
  const double v = turn(flat_a, flat_c);
  const double w = turn(flat_b, flat_a);
  // note: one branch instead of six
  if (((u < 0) | (v < 0) | (w < 0)) & ((u > 0) | (v > 0) | (w > 0))) return false;
  const double sum = u + v + w;
  if (!(sum != 0)) return false;
  // the height above the plane decides on which side of it the ray begins
  const Vec3 normal = glm::cross(b - a, c - a);
  const double along = glm::dot(normal, a - ray.origin) / glm::dot(normal, ray.direction);
  if (!(along >= first)) return false;
  // edge on, the plane is inaccurate: the crossing lies between the corners
  const double at_a = (a[ray.z] - ray.start.z) * ray.inverse;
  const double at_b = (b[ray.z] - ray.start.z) * ray.inverse;
  const double at_c = (c[ray.z] - ray.start.z) * ray.inverse;
  crossing.along = std::clamp(along, std::min({at_a, at_b, at_c}), std::max({at_a, at_b, at_c}));
  crossing.barycentric = {v / sum, w / sum};
  crossing.front = sum > 0;
  return true;
}

}  // namespace panwright::geometry::internal
