// The visible lit disc of a body in parts. Private to sky.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "sky/planetshine.h"
#include "sky/sky.h"

namespace panwright::sky {

inline Vec3 perpendicular(const Vec3& axis) {
  const Vec3 other = std::fabs(axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  return glm::normalize(glm::cross(axis, other));
}

// Returns how far a ray goes to the unit sphere, in its own length; below 0 from within, infinity
// past it.
inline double way_to_sphere(const Vec3& from, const Vec3& ray) {
  const double a = glm::dot(ray, ray), b = glm::dot(from, ray);
  const double c = glm::dot(from, from) - 1;
  const double square = b * b - a * c;
  if (!(square >= 0) || !(b < 0)) return INFINITY;
  return c / (std::sqrt(square) - b);
}

// Returns whether another body stands before what is seen of one.
//
//   direction  unit; away: metres
inline bool is_hidden(const Sky& sky, std::size_t index, const Vec3& point, const Vec3& direction,
                      double away) {
  for (std::size_t k = 0; k < sky.size(); ++k) {
    if (k == index) continue;
    const Ellipsoid& other = sky.shape(k);
    const double way = way_to_sphere(other.from(point), other.unit_from_world * direction);
    if (way > 0 && way < away) return true;
  }
  return false;
}

struct PartAxes {
  Vec3 x, y, z;
};

// Calls f(part) for the lit parts of a body's air beside its disc.
template <class F>
void for_air(const Sky& sky, std::size_t index, const Vec3& point, const PartAxes& axes,
             const CapGrid& grid, const F& f) {
  const light::Air* air = sky.air(index);
  if (air == nullptr) return;
  const Ellipsoid& shape = sky.shape(index);
  const Vec3 from = shape.from(point);
  const double distance = std::sqrt(glm::dot(from, from));
  // cosines of the ground's limb and of the air's; within the air all of the sky
  const auto cosine_of = [&](double r) {
    return std::sqrt(std::max(0.0, (distance - r) * (distance + r))) / distance;
  };
  const bool outside = distance > air->top();
  const double low = outside ? cosine_of(air->top()) : -1, high = cosine_of(1);
  const int rings = outside ? 1 + grid.rings / 8 : grid.rings;
  const double solid = 2 * kPi * (high - low) / rings / grid.sectors;
  for (int ring = 0; ring < rings; ++ring) {
    // closer to each other at the ground
    const double t = (ring + 0.5) / rings, along = high - (high - low) * t * t;
    const double across = std::sqrt(std::max(0.0, (1 - along) * (1 + along)));
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / grid.sectors);
      const Vec3 ray = along * axes.z + across * (turn.cos * axes.x + turn.sin * axes.y);
      const Vec3 toward = shape.world_from_unit * ray;
      const double stretch = std::sqrt(glm::dot(toward, toward));
      const Vec3 light = sky.air_light(index, from, toward).light *
                         (2 * t * solid * shape.volume / (stretch * stretch * stretch));
      const double flux = light.x + light.y + light.z;
      const Vec3 direction = toward / stretch;
      // air is seen as far away as the limb
      if (flux > 0 && !is_hidden(sky, index, point, direction, distance * along * stretch))
        f(light::ShinePart{direction, light, flux});
    }
  }
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
  for_air(sky, index, point, {x, y, axis}, grid, f);
  const bool in_air = sky.air(index) && distance < sky.air(index)->top();
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
      const Vec3 light =
          sky.radiance(index, place, -direction, footprint, in_air ? &from : nullptr) *
          (solid * shape.volume / (stretch * stretch * stretch));
      const double flux = light.x + light.y + light.z;
      if (flux > 0 && !is_hidden(sky, index, point, direction, way * stretch))
        f(light::ShinePart{direction, light, flux});
    }
  }
}

}  // namespace panwright::sky
