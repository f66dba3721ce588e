// Earthshine on a convex mirror-like sphere: quadrature over the sphere and over the Earth's disc.
#pragma once

#include <cmath>

#include "materials/brdf.h"
#include "materials/material.h"

namespace panwright::testing_support {

// A Lambert Earth, of Bond albedo 0.3 and the Sun's irradiance 1, `height` above a sphere along z.
struct Earthshine {
  double height = 400e3;
  Vec3 to_sun{0, 0, -1};  // unit

  // Radiant intensity of a sphere of radius 1, seen from far away. The Sun does not light it.
  double intensity(const materials::Material& material, const Vec3& to_viewer) const {
    constexpr double kEarth = 6371e3;
    constexpr int kPlaces = 20, kRings = 50, kSectors = 100;
    const materials::f64::CompiledBrdf compiled(material);
    const double distance = kEarth + height;
    const double least = std::sqrt(1 - kEarth * kEarth / distance / distance);
    const Vec3 x = glm::normalize(glm::cross(to_viewer, Vec3(0.3, 0.9, 0.2)));
    const Vec3 y = glm::cross(to_viewer, x);
    double sum = 0;
    for (int i = 0; i < kPlaces; ++i)
      for (int j = 0; j < 2 * kPlaces; ++j) {
        // of equal areas as seen
        const double r = std::sqrt((i + 0.5) / kPlaces), turn = kPi * (j + 0.5) / kPlaces;
        const Vec3 normal =
            r * std::cos(turn) * x + r * std::sin(turn) * y + std::sqrt(1 - r * r) * to_viewer;
        for (int ring = 0; ring < kRings; ++ring)
          for (int sector = 0; sector < kSectors; ++sector) {
            const double along = 1 - (1 - least) * (ring + 0.5) / kRings;
            const double across = std::sqrt(1 - along * along);
            const double angle = 2 * kPi * (sector + 0.5) / kSectors;
            const Vec3 to_light(across * std::cos(angle), across * std::sin(angle), along);
            const double facing = glm::dot(normal, to_light);
            if (facing <= 0) continue;
            const double b = distance * along;
            const double way = b - std::sqrt(b * b - distance * distance + kEarth * kEarth);
            const Vec3 up = (way * to_light - Vec3(0, 0, distance)) / kEarth;
            const double light = 0.3 / kPi * std::max(0.0, glm::dot(up, to_sun));
            if (light > 0) sum += compiled.brdf(to_light, to_viewer, normal).x * facing * light;
          }
      }
    const double area = kPi / (2.0 * kPlaces * kPlaces);
    return sum * area * 2 * kPi * (1 - least) / (kRings * kSectors);
  }
};

// Gold of one index for all bands, rough as foil.
inline materials::Material gold(double slope) {
  materials::Material material;
  material.weights = Vec3(0, 1, 0);
  material.specular = Vec3(1);
  material.refract = Vec3(0.2);
  material.extinction = Vec3(3);
  material.specular_brdf = materials::Ggx{.alpha_x = slope, .alpha_y = slope};
  materials::fit(material);
  return material;
}

}  // namespace panwright::testing_support
