// Chandrasekhar's H function, for multiple scattering in Hapke's model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace panwright::materials {

// H of isotropic scattering with one albedo, the same bits everywhere.
// S. Chandrasekhar, "Radiative transfer", 1960, chapter 5; his integral over t = exp(u).
class HapkeH {
 public:
  // w: single-scattering albedo, 0..1. Cost: some 500 logarithms.
  explicit HapkeH(double w);

  // x: cosine, 0..1. Within 1e-13 of the solution of the integral equation; 1 at x = 0.
  double operator()(double x) const;

 private:
  std::vector<double> logs_;  // ln(1 − w·atan(t)/t), one per t
};

// HapkeH(w)(x), for few x.
[[nodiscard]] double hapke_h(double x, double w);

// Coefficients of hapke_h_function in materials/formulas/hapke.glsl for the H of one albedo.
struct HFit {
  std::array<double, 8> coefficients{};
  double error = 0;  // largest relative error of H over x in [0, 1]
};

// Cost: a tenth of a millisecond.
[[nodiscard]] HFit hapke_h_fit(double w);

// Correction factor of a fit of H: together they are H within 1e-10.
class HapkeHCorrection {
 public:
  // coefficients: of hapke_h_fit(w), or as stored. Cost: a fraction of a millisecond.
  HapkeHCorrection(double w, const std::array<double, 8>& coefficients);

  // x: cosine, 0..1
  double operator()(double x) const {
    const double at = std::sqrt(std::sqrt(std::clamp(x, 0.0, 1.0))) * kSteps;
    const int below = static_cast<int>(at), whole = below < kSteps - 1 ? below : kSteps - 1;
    const double t = at - whole;
    const double* r = ratios_.data() + whole;
    // Lagrange's cubic through four nodes
    return r[0] * (-t * (t - 1) * (t - 2) / 6) + r[1] * ((t + 1) * (t - 1) * (t - 2) / 2) -
           r[2] * ((t + 1) * t * (t - 2) / 2) + r[3] * ((t + 1) * t * (t - 1) / 6);
  }

 private:
  static constexpr int kSteps = 512;  // of the fourth root of x: the slope is infinite at 0
  std::vector<double> ratios_;        // at even steps of x's fourth root; one more at each end
};

}  // namespace panwright::materials
