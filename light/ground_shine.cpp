#include "light/ground_shine.h"

#include <algorithm>
#include <cmath>

namespace panwright::light {

bool GroundShine::hides(const Vec3& direction) const {
  if (is_ground.empty())
    return std::ranges::any_of(
        caps, [&](const Cap& cap) { return glm::dot(direction, cap.axis) > cap.cosine; });
  const auto texel = [](double v) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(std::floor((v + 1) * 0.5 * kSide)), 0, kSide - 1));
  };
  const Vec2 place = octahedron_place(direction);
  return is_ground[texel(place.y) * kSide + texel(place.x)] != 0;
}

Vec3 octahedron_direction(const Vec2& place) {
  const double z = 1 - std::fabs(place.x) - std::fabs(place.y);
  if (z >= 0) return {place.x, place.y, z};
  return {std::copysign(1 - std::fabs(place.y), place.x),
          std::copysign(1 - std::fabs(place.x), place.y), z};
}

Vec2 octahedron_place(const Vec3& direction) {
  const Vec3 d =
      direction / (std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z));
  if (d.z >= 0) return {d.x, d.y};
  return {std::copysign(1 - std::fabs(d.y), d.x), std::copysign(1 - std::fabs(d.x), d.y)};
}

}  // namespace panwright::light
