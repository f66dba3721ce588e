// Material report: albedos, energy conservation, reciprocity and precision.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "materials/energy.h"
#include "materials/material.h"

namespace panwright::materials {

// Largest relative error called safe in single precision: a quarter of a step of an 8-bit image.
inline constexpr double kSafeInSingle = 1e-3;
// Largest residual called reciprocal.
inline constexpr double kReciprocal = 1e-6;
// Largest directional albedo called energy-conserving: 1, and the error of quadratures.
inline constexpr double kConserved = 1 + 1e-4;

struct MaterialReport {
  struct Albedo {
    double mu;    // cosine of the direction
    Vec3 rgb{0};  // directional albedo, of light along the tangent
    // by channel, over all azimuths; both are rgb for isotropic materials
    Vec3 least{0};
    Vec3 largest{0};
  };
  std::vector<Albedo> directional;
  Vec3 hemispherical{0};  // 2∫E μ dμ
  Gain gain;              // the largest directional albedo found; above 1 the material gains energy
  double reciprocity = 0;  // largest |f(l, v) − f(v, l)|/f in double
  // largest |f32 − f64| over f64, for f64 above 1e-6 of its largest; directions to 89.9°
  double f32_error = 0;
  double f32_rms = 0;  // root of the mean square of the same
  // the least slope, of 0.3, 0.1, 0.03 … 1e-4 and the material's own, down to which f32_error stays
  // within kSafeInSingle, with that slope for material and coat; none for materials without slopes
  std::optional<double> safe_slope;
  double fit_error = 0;  // of the fits that replace integrals, see Fits
};

// Measures a fitted material. The same numbers everywhere.
//
//   mus  cosines, > 0 to 1, of the reported directional albedos
//
// Cost: about a tenth of a second.
[[nodiscard]] MaterialReport material_report(const Material& material, std::span<const double> mus);

// Summarises the report in words: energy conservation, reciprocity, safety of single precision and
// down to which slope. "Energy: conserved (largest directional albedo 0.931 at 0°). Reciprocal.
// Safe in single precision (largest relative error 3e-07)."
[[nodiscard]] std::string verdict(const MaterialReport& report);

// Returns true if the BRDFs of a material could gain energy although its weights and colours do not
// (those are W1402): a cheap bound that spares energy_gain(). False is certain.
[[nodiscard]] bool may_gain(const Material& material);

// Describes the BRDFs of a material, as "GGX microfacets of a conductor under a coat, Lambert".
[[nodiscard]] std::string brdf_in_words(const Material& material);

}  // namespace panwright::materials
