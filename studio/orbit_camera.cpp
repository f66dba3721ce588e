#include "studio/orbit_camera.h"

#include <algorithm>
#include <cmath>

namespace panwright::studio {
namespace {

constexpr double kSteepest = 89.9;  // straight up and down have no azimuth

}  // namespace

Vec3 direction_of(double azimuth, double elevation) {
  azimuth *= kDegree;
  elevation *= kDegree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

double wrapped_degrees(double angle) { return std::remainder(angle, 360); }

Vec3 OrbitCamera::direction() const { return direction_of(azimuth, elevation); }
Vec3 OrbitCamera::position() const { return centre + range * direction(); }

void OrbitCamera::turn(double right, double down) {
  azimuth = wrapped_degrees(azimuth - right * 180);
  elevation = std::clamp(elevation + down * 180, -kSteepest, kSteepest);
}

void OrbitCamera::shift(double right, double down) {
  const double height = 2 * range * std::tan(fov * kDegree / 2);
  fly(0, -right * height / range, down * height / range);
}

void OrbitCamera::fly(double ahead, double right, double up) {
  const Vec3 back = direction();
  const Vec3 side = glm::normalize(glm::cross(Vec3(0, 0, 1), back));
  centre += range * (right * side + up * glm::cross(back, side) - ahead * back);
}

void OrbitCamera::zoom(double factor) { range = std::clamp(range * factor, kNearest, kFarthest); }

void OrbitCamera::frame_all(const workspace::BoundingSphere& sphere, double aspect) {
  centre = sphere.centre;
  const double across = std::atan(std::tan(fov * kDegree / 2) * std::min(1.0, aspect));
  range = std::clamp(1.05 * sphere.radius / std::sin(across), kNearest, kFarthest);
  frame.clear();
  if (sphere.up == Vec3(0, 0, 1) || glm::dot(direction(), sphere.up) > 0.1) return;
  // not from below the ground
  const Vec3 from = workspace::from_local(sphere.up, {-0.5, -1, 1});
  azimuth = std::atan2(from.y, from.x) / kDegree;
  elevation = std::clamp(std::asin(from.z) / kDegree, -kSteepest, kSteepest);
}

}  // namespace panwright::studio
