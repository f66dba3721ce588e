// Light of one source at a point of a surface.
#pragma once

#include "base/math.h"

namespace panwright::materials {

// An eighth of the square of the Sun's angular radius, 4.6504e-3 rad, at 1 AU: the contribution of
// a uniform disc to the squares of alpha for light and viewer at the normal. Half vectors spread by
// ρ²/16 along each axis there, and alpha² is twice that; elsewhere see
// materials/formulas/disc.glsl.
inline constexpr double kSunAlpha2 = 2.7033e-6;

// The argument of BRDFs that stands for the light; the formulas have the same in their precision
// (materials/formulas/incidence.glsl).
struct Incidence {
  Vec3 to_light{0, 0, 1};  // unit, from the surface to the middle of the light
  Vec3 irradiance{1};      // RGB, on a plane that faces it
  double alpha2 = 0;  // an eighth of the square of its disc's angular radius (its sine); 0: a point
  double limb = 0;    // limb darkening u of the disc, I = 1 − u·(1 − μ), 0 to 1

  Incidence() = default;
  // A direction alone is a point of irradiance 1.
  Incidence(const Vec3& direction, const Vec3& received = Vec3(1), double disc_alpha2 = 0,
            double darkening = 0)
      : to_light(direction), irradiance(received), alpha2(disc_alpha2), limb(darkening) {}
  bool operator==(const Incidence&) const = default;
};

// Returns the light of the Sun at 1 AU, without limb darkening, of irradiance 1.
inline Incidence sunlight(const Vec3& to_sun) { return {to_sun, Vec3(1), kSunAlpha2}; }

}  // namespace panwright::materials
