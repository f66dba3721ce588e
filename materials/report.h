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

// Up to this relative error single precision is called safe: a quarter of a step of an 8-bit image.
inline constexpr double kSafeInSingle = 1e-3;
// Up to this residual a BRDF is called reciprocal.
inline constexpr double kReciprocal = 1e-6;
// Up to this directional albedo energy is called conserved: 1, and what quadratures leave open.
inline constexpr double kConserved = 1 + 1e-4;

struct MaterialReport {
  struct Albedo {
    double mu;    // cosine of the direction
    Vec3 rgb{0};  // directional albedo, of light along the tangent
    // by channel, over all azimuths; both are rgb where the material is isotropic
    Vec3 least{0};
    Vec3 largest{0};
  };
  std::vector<Albedo> directional;
  Vec3 hemispherical{0};  // 2∫E μ dμ
  Gain gain;              // the largest directional albedo found; above 1 the material gains energy
  double reciprocity = 0;  // largest |f(l, v) − f(v, l)|/f in double
  // largest |f32 − f64| over f64, where f64 is above 1e-6 of its largest; directions to 89.9°
  double f32_error = 0;
  double f32_rms = 0;  // root of the mean square of the same
  // the least slope, of 0.3, 0.1, 0.03 … 1e-4 and the material's own, down to which f32_error of
  // the material with that slope in place of its own, the coat's too, stays within kSafeInSingle;
  // none for materials without slopes
  std::optional<double> safe_slope;
  double fit_error = 0;  // of the fits that replace integrals, see Fits
};

// Measures a fitted material. The same numbers everywhere.
//
//   mus  cosines, > 0 to 1, of the directions whose albedo is reported
//
// Cost: about a tenth of a second.
[[nodiscard]] MaterialReport material_report(const Material& material, std::span<const double> mus);

// The report in words: whether energy is conserved, whether light and viewer can be exchanged,
// whether single precision is safe and down to which slope. "Energy: conserved (largest directional
// albedo 0.931 at 0°). Reciprocal. Safe in single precision (largest relative error 3e-07)."
[[nodiscard]] std::string verdict(const MaterialReport& report);

// Whether the BRDFs of a material could gain energy although its weights and colours do not (those
// are W1402): a bound, so that the quadrature of energy_gain() is needed for few. False is certain.
[[nodiscard]] bool may_gain(const Material& material);

// The BRDFs of a material in words, as "GGX microfacets of a conductor under a coat, Lambert".
[[nodiscard]] std::string brdf_in_words(const Material& material);

}  // namespace panwright::materials
