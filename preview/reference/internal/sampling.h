// Area-preserving maps from the unit square, and frames about a direction. Private to
// preview/reference.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace panwright::preview::reference {

// Two directions that make a right-handed frame with a unit z.
struct Frame {
  Vec3 x;
  Vec3 y;
};

// Builds a frame. T. Duff et al., "Building an orthonormal basis, revisited", 2017.
inline Frame frame_about(const Vec3& z) {
  const double sign = std::copysign(1.0, z.z);
  const double a = -1 / (sign + z.z);
  const double b = z.x * z.y * a;
  return {Vec3(1 + sign * z.x * z.x * a, sign * b, -sign * z.x),
          Vec3(b, sign + z.y * z.y * a, -z.y)};
}

// Maps to the unit disc. P. Shirley, K. Chiu, "A low distortion map between disk and square", 1997.
inline Vec2 on_disc(const Vec2& u) {
  const Vec2 p = 2.0 * u - 1.0;
  if (p.x == 0 && p.y == 0) return Vec2(0);
  const bool wide = std::fabs(p.x) > std::fabs(p.y);
  const double radius = wide ? p.x : p.y;
  const double angle = kPi / 4 * (wide ? p.y / p.x : p.x / p.y);
  const det::SinCos turn = det::sincos(angle);
  return radius * (wide ? Vec2(turn.cos, turn.sin) : Vec2(turn.sin, turn.cos));
}

// Maps to directions about a unit normal with the density cos / π.
inline Vec3 in_cosine_lobe(const Vec3& normal, const Vec2& u) {
  const Vec2 place = on_disc(u);
  const Frame frame = frame_about(normal);
  const double height = std::sqrt(std::max(0.0, 1 - glm::dot(place, place)));
  return place.x * frame.x + place.y * frame.y + height * normal;
}

}  // namespace panwright::preview::reference
