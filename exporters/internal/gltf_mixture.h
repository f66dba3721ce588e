// Diffuse and specular colours as glTF's base colour and metallic part. Private to exporters.
#pragma once

#include "base/math.h"

namespace panwright::exporters {

// Metallic-roughness mixture for them.
struct Mixture {
  Vec3 base{0};
  double metallic = 0;
  double error = 0;  // largest difference of a channel from the mixture's result
};

// Returns the mixture of a dielectric and a metal nearest to a diffuse albedo and a reflectance at
// normal incidence. glTF makes of base colour b and metallic part s the diffuse albedo b·(1 − s)·(1
// − d) and the reflectance d·(1 − s) + b·s, d the dielectric's: six numbers for its four, so only
// colours of such a mixture are exact.
//
//   diffuse, reflectance  0 to 1
//   dielectric            d, 0 to 0.5
//   levels                metallic is a multiple of 1/levels; 0: any number
// Cost: O(1), 50 ns.
Mixture mixture_of(const Vec3& diffuse, const Vec3& reflectance, double dielectric, int levels = 0);

}  // namespace panwright::exporters
