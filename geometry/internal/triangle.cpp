#include "geometry/internal/triangle.h"

#include <algorithm>

namespace panwright::geometry {

TriangleMeasure measure(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 bc = c - b;
  const Vec3 cross = glm::cross(ab, ac);
  return {cross, glm::length(cross),
          std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)})};
}

Vec3 nearest_to_origin(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const double d1 = -glm::dot(ab, a);
  const double d2 = -glm::dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = -glm::dot(ab, b);
  const double d4 = -glm::dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double d5 = -glm::dot(ab, c);
  const double d6 = -glm::dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  // inside: the foot of the perpendicular, exact in direction even for slivers
  const Vec3 n = glm::cross(ab, ac);
  return n * (glm::dot(n, a) / glm::dot(n, n));
}

}  // namespace panwright::geometry
