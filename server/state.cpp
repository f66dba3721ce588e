#include "server/state.h"

#include <algorithm>
#include <cmath>

namespace panwright::server {

namespace {

Quat turned(const Vec3& rotation) {
  const double angle = glm::length(rotation);
  if (!(angle > 0)) return Quat(1, 0, 0, 0);
  const det::SinCos half = det::sincos(angle / 2);
  return Quat(half.cos, rotation / angle * half.sin);
}

}  // namespace

world::Pose Motion::at(const world::Pose& start, double time) const {
  const double square = time * time / 2, cube = time * time * time / 6;
  return {start.translation + velocity * time + acceleration * square + jerk * cube,
          glm::normalize(start.rotation *
                         turned(turn * time + turn_acceleration * square + turn_jerk * cube))};
}

double Fog::transmission(double range) const {
  const double d = radius > 0 ? std::min(range, radius) : range;
  switch (mode) {
    case FogMode::none:
      return 1;
    case FogMode::linear: {
      if (!std::isfinite(d)) return 0;
      return end > begin ? std::clamp((end - d) / (end - begin), 0.0, 1.0) : (d < begin ? 1 : 0);
    }
    case FogMode::exponential:
      return density > 0 ? det::exp(-density * d) : 1;
    case FogMode::squared:
      return density > 0 ? det::exp(-density * d * (density * d)) : 1;
  }
  return 1;
}

Vec3 SkyColor::color() const {
  switch (type) {
    case 3:
      return Vec3(1, 0, 0);
    case 4:
      return Vec3(0, 1, 0);
    case 5:
      return Vec3(0, 0, 1);
    case 6:
      return Vec3(1);
    case 8:
      return glm::max(rgb, Vec3(0));
    case 9: {
      if (!(cie.y > 0)) return Vec3(0);
      const double big_x = cie.x / cie.y * cie.z, big_z = (1 - cie.x - cie.y) / cie.y * cie.z;
      // IEC 61966-2-1: linear sRGB from CIE XYZ
      return glm::max(Vec3(3.2406 * big_x - 1.5372 * cie.z - 0.4986 * big_z,
                           -0.9689 * big_x + 1.8758 * cie.z + 0.0415 * big_z,
                           0.0557 * big_x - 0.2040 * cie.z + 1.0570 * big_z),
                      Vec3(0));
    }
    default:
      return Vec3(0);
  }
}

}  // namespace panwright::server
