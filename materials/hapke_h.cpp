#include "materials/hapke_h.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace panwright::materials {
namespace {

// On the line of u every singularity is π/2 away from the real axis, so the trapezoidal rule is off
// by exp(−π²/step) = 7e-18.
constexpr double kStep = 0.25;
// the integrand falls by e for each 1 of u beyond u = 0 and beyond its peak at u = −ln x
constexpr double kTail = 42;
// below it H is 1 to the last bit
constexpr double kLeastX = 1e-19;

// 1 − atan(t)/t, t ≥ 0, without cancellation.
double defect(double t) {
  if (t > 0.25) return 1 - det::atan(t) / t;
  const double q = t * t;
  double sum = 0;
  for (int k = 12; k >= 1; --k) sum = 1.0 / (2 * k + 1) - q * sum;
  return q * sum;
}

// Nodes t = exp(u) and 1 − atan(t)/t there: the same for every albedo.
struct Nodes {
  std::vector<double> t;
  std::vector<double> defects;

  Nodes() {
    const double last = kTail - det::log(kLeastX);
    for (double u = -kTail; u <= last; u += kStep) {
      t.push_back(det::exp(u));
      defects.push_back(defect(t.back()));
    }
  }
};

const Nodes& nodes() {
  static const Nodes made;
  return made;
}

}  // namespace

HapkeH::HapkeH(double w) {
  if (!(w > 0)) return;
  w = std::min(w, 1.0);
  for (const double defect : nodes().defects) logs_.push_back(det::log((1 - w) + w * defect));
}

double HapkeH::operator()(double x) const {
  if (!(x > kLeastX)) return 1;
  x = std::min(x, 1.0);
  // ln H = −(x/π) ∫ ln(1 − w·atan(t)/t)/(1 + x²t²) dt, dt = t du
  const std::vector<double>& t = nodes().t;
  double sum = 0;
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const double xt = x * t[i];
    sum += logs_[i] * (xt / (1 + xt * xt));
  }
  return det::exp(-sum * kStep / kPi);
}

double hapke_h(double x, double w) { return HapkeH(w)(x); }

}  // namespace panwright::materials
