// What a surface does with light, for the path tracer. Private to preview/reference.
#pragma once

#include "materials/material.h"
#include "materials/sample.h"

namespace panwright::preview::reference {

// A material's laws, and whether its lobe is so narrow that directions to the Sun's disc, taken at
// random, miss the most of it: then directions that the lobe draws have to look for the Sun, too.
struct Scatter {
  materials::Scattering scattering;
  double slope = 1;  // RMS, of its narrowest lobe
  bool has_mirror = false;

  explicit Scatter(const materials::Material& material);
  Scatter(materials::Scattering brdf_model, double least_slope)
      : scattering(std::move(brdf_model)), slope(least_slope), has_mirror(scattering.has_delta()) {}

  bool is_narrow() const;
  // With slopes times what a roughness map says, as preview/shaders/shading.frag.
  Scatter roughened(double factor) const;
  // With what a reflectance map says.
  Scatter reflecting(const Vec3& reflectance) const;
};

}  // namespace panwright::preview::reference
