// Random points and directions for visibility rays. Private to compiler.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "compiler/internal/visibility_rays.h"

namespace panwright::compiler::internal {

// Returns a uniform direction; a and b are random in (0, 1).
inline Vec3 on_sphere(double a, double b) {
  const double z = 2 * a - 1;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const auto turn = det::sincos(2 * kPi * b);
  return {across * turn.cos, across * turn.sin, z};
}

// Returns the fractional part.
inline double part(double x) { return x - std::floor(x); }

// Returns a direction within a cone about d; a and b are random.
inline Vec3 in_cone(const Vec3& d, double angle, std::uint32_t a, std::uint32_t b) {
  const auto [right, up] = perpendiculars(d);
  const double r = angle * std::sqrt(in_unit(a));
  const auto turn = det::sincos(2 * kPi * in_unit(b));
  return glm::normalize(d + r * turn.cos * right + r * turn.sin * up);
}

// Returns a cosine-distributed direction about a normal; a uniform one without a normal.
inline Vec3 cosine(const Vec3& normal, std::uint32_t a, std::uint32_t b) {
  const Vec3 random = on_sphere(in_unit(a), in_unit(b));
  const Vec3 sum = normal + random;
  const double length = glm::length(sum);
  return length > 1e-9 ? sum / length : random;
}

// Returns points at corners, edges and insides in turn.
inline Vec3 point_of(const std::array<Vec3, 3>& corners, std::uint32_t number,
                     const std::array<std::uint32_t, 4>& random) {
  constexpr double kInset = 1e-3;
  double u = in_unit(random[0]);
  double v = in_unit(random[1]);
  if (number % 4 == 0) {  // a corner
    u = v = kInset;
  } else if (number % 4 == 1) {  // an edge
    u = kInset + (1 - 3 * kInset) * u;
    v = kInset;
  } else if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const std::uint32_t k = number / 4 % 3;
  return corners[k] + u * (corners[(k + 1) % 3] - corners[k]) +
         v * (corners[(k + 2) % 3] - corners[k]);
}

inline Vec3 normal_of(const std::array<Vec3, 3>& c) {
  const Vec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double length = glm::length(cross);
  return length > 0 ? cross / length : Vec3(0);
}

inline std::uint32_t side_of(const Vec3& front, const Vec3& direction) {
  return glm::dot(front, direction) < 0 ? 1 : 0;
}

}  // namespace panwright::compiler::internal
