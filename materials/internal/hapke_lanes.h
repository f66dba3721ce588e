// Hapke's BRDF for many directions at once. Private to materials.
#pragma once

#include "materials/internal/formulas.h"

namespace panwright::materials {

struct HapkeLanes {
  static constexpr int kCount = 64;
  // unit vectors: x, y, z of all
  double to_light[3][kCount], to_viewer[3][kCount], normal[3][kCount];
  double value[kCount];
};

// Sets the values, bit-equal to f64::hapke().
void hapke(const f64::SurfaceFields& s, HapkeLanes& lanes);
// The same without the processor's wide registers.
void plain_hapke(const f64::SurfaceFields& s, HapkeLanes& lanes);

}  // namespace panwright::materials
