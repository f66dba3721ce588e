// Scattering by a surface, for the path tracer. Private to preview/reference.
#pragma once

#include "materials/material.h"
#include "materials/sample.h"

namespace panwright::preview::reference {

// BRDFs of a material, and a mark for lobes so narrow that uniform directions to the Sun's disc
// mostly miss them: then the Sun is also sampled by the lobe.
struct Scatter {
  materials::Scattering scattering;
  double slope = 1;  // RMS, of its narrowest lobe
  bool has_mirror = false;

  explicit Scatter(const materials::Material& material);
  Scatter(materials::Scattering brdf_model, double least_slope)
      : scattering(std::move(brdf_model)), slope(least_slope), has_mirror(scattering.has_delta()) {}

  bool is_narrow() const;
  // Returns the same with slopes times the value of a roughness map, as
  // preview/shaders/shading.frag.
  Scatter roughened(double factor) const;
  // Returns the same with the value of a reflectance map.
  Scatter reflecting(const Vec3& reflectance) const;
};

}  // namespace panwright::preview::reference
