// Diffuse and specular colours as glTF's base colour and metallic part. Private to exporters.
#pragma once

#include "base/math.h"

namespace panwright::exporters {

// What a metallic-roughness material makes of them.
struct Mixture {
  Vec3 base{0};
  double metallic = 0;
  double error = 0;  // the largest difference of a channel of what comes of it
};

// The mixture of a dielectric and a metal whose diffuse albedo and reflectance at normal incidence
// come nearest to the two. glTF makes of base colour b and metallic part s the diffuse albedo
// b·(1 − s)·(1 − d) and the reflectance d·(1 − s) + b·s, d the dielectric's: three channels
// of both have six numbers for its four, and exact are those that came from such a mixture.
//
//   diffuse, reflectance  0 to 1
//   dielectric            d, 0 to 0.5
//   levels                metallic is a multiple of 1/levels; 0: any number
// Cost: O(1), 50 ns.
Mixture mixture_of(const Vec3& diffuse, const Vec3& reflectance, double dielectric, int levels = 0);

}  // namespace panwright::exporters
