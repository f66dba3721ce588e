// The visible lit disc of a body in parts. Private to sky.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "sky/planetshine.h"
#include "sky/sky.h"

namespace panwright::sky {

// A part of a disc: its direction, and its irradiance on a plane that faces it.
struct Part {
  Vec3 direction;  // unit
  Vec3 irradiance;
  double flux = 0;  // the sum over the bands
};

inline Vec3 perpendicular(const Vec3& axis) {
  const Vec3 other = std::fabs(axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  return glm::normalize(glm::cross(axis, other));
}

// Calls f(part) for the lit parts of a body's disc. Solid angles of the ellipsoid's space become
// those of the world by the map's determinant.
template <class F>
void for_parts(const Sky& sky, std::size_t index, const Vec3& point, const CapGrid& grid,
               const F& f) {
  const Ellipsoid& shape = sky.shape(index);
  const Vec3 from = shape.from(point);
  const double distance = std::sqrt(glm::dot(from, from));
  if (!(distance > 1)) return;
  const Vec3 axis = -from / distance;
  const Vec3 x = perpendicular(axis), y = glm::cross(axis, x);
  const double cosine = std::sqrt((distance - 1) * (distance + 1)) / distance;
  const double height = 1 / (distance * distance) / (1 + cosine);  // 1 − cos of the disc's radius
  const double solid = 2 * kPi * height / grid.rings / grid.sectors;
  const double footprint = std::sqrt(4 * kPi / grid.rings / grid.sectors) * 0.5;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double h = height * (ring + 0.5) / grid.rings;
    const double across = std::sqrt(h * (2 - h)), along = 1 - h;
    const double beside = distance * across;
    const double way = distance * along - std::sqrt(std::max(0.0, (1 - beside) * (1 + beside)));
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / grid.sectors);
      const Vec3 ray = along * axis + across * (turn.cos * x + turn.sin * y);
      const Vec3 place = glm::normalize(from + way * ray);
      const Vec3 toward = shape.world_from_unit * ray;
      const double stretch = std::sqrt(glm::dot(toward, toward));
      const Vec3 direction = toward / stretch;
      const Vec3 light = sky.radiance(index, place, -direction, footprint) *
                         (solid * shape.volume / (stretch * stretch * stretch));
      const double flux = light.x + light.y + light.z;
      if (flux > 0) f(Part{direction, light, flux});
    }
  }
}

}  // namespace panwright::sky
