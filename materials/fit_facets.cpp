// What mirror facets lose by single reflections, as a few coefficients.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include "base/math.h"
#include "materials/energy.h"
#include "materials/internal/fits.h"
#include "materials/internal/formulas.h"

namespace panwright::materials {
namespace {

constexpr std::size_t kTerms = 7;
constexpr std::size_t kNodes = 24;
constexpr double kLeast = 1e-6;  // cosine that stands for grazing
// where the loss has its bend: the b of facet_loss
constexpr std::array kBends{0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.5, 3.0, 10.0};

struct Loss {
  std::array<double, 8> coefficients{};
  double mean = 0;   // 1 − E_avg of the fit itself
  double error = 0;  // largest, of any azimuth
};

using Terms = std::array<double, kTerms>;

double warped(double cosine, double bend) {
  return std::sqrt(cosine * (1 + bend) / (cosine + bend));
}

// Chebyshev's polynomials of 2x − 1.
Terms chebyshev(double x) {
  Terms t{1, 2 * x - 1};
  for (std::size_t k = 2; k < kTerms; ++k) t[k] = 2 * t[1] * t[k - 1] - t[k - 2];
  return t;
}

double dot(const Terms& a, const Terms& b) {
  double sum = 0;
  for (std::size_t k = 0; k < kTerms; ++k) sum += a[k] * b[k];
  return sum;
}

// Least squares; the normal equations of Chebyshev's polynomials are well conditioned.
Terms solved(const std::array<Terms, kNodes>& rows, const std::array<double, kNodes>& values,
             const std::array<double, kNodes>& weights) {
  std::array<std::array<double, kTerms + 1>, kTerms> a{};
  for (std::size_t i = 0; i < kNodes; ++i)
    for (std::size_t r = 0; r < kTerms; ++r) {
      for (std::size_t c = 0; c < kTerms; ++c) a[r][c] += weights[i] * rows[i][r] * rows[i][c];
      a[r][kTerms] += weights[i] * rows[i][r] * values[i];
    }
  // Cholesky's order needs no pivots
  for (std::size_t p = 0; p < kTerms; ++p)
    for (std::size_t r = 0; r < kTerms; ++r) {
      if (r == p) continue;
      const double factor = a[r][p] / a[p][p];
      for (std::size_t c = p; c <= kTerms; ++c) a[r][c] -= factor * a[p][c];
    }
  Terms result{};
  for (std::size_t r = 0; r < kTerms; ++r) result[r] = a[r][kTerms] / a[r][r];
  return result;
}

struct Minimax {
  Terms terms{};
  double error = 1e300;
};

// C. L. Lawson's iteration: weights grow where the error is large.
Minimax minimax(const std::array<double, kNodes>& cosines, const std::array<double, kNodes>& values,
                double bend) {
  std::array<Terms, kNodes> rows;
  for (std::size_t i = 0; i < kNodes; ++i) rows[i] = chebyshev(warped(cosines[i], bend));
  std::array<double, kNodes> weights;
  weights.fill(1.0 / kNodes);
  Minimax best;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Terms terms = solved(rows, values, weights);
    std::array<double, kNodes> errors;
    double largest = 0;
    double sum = 0;
    for (std::size_t i = 0; i < kNodes; ++i) {
      errors[i] = std::fabs(dot(rows[i], terms) - values[i]);
      largest = std::max(largest, errors[i]);
      sum += weights[i] * errors[i];
    }
    if (largest < best.error) best = {terms, largest};
    if (!(sum > 1e-14)) break;
    for (std::size_t i = 0; i < kNodes; ++i) weights[i] = weights[i] * errors[i] / sum + 1e-9;
  }
  return best;
}

// From Chebyshev's polynomials of 2x − 1 to powers of x.
Terms powers(const Terms& chebyshevs) {
  std::array<Terms, kTerms> t{};
  t[0] = {1};
  t[1] = {-1, 2};
  for (std::size_t k = 2; k < kTerms; ++k)
    for (std::size_t i = 0; i < kTerms; ++i)
      t[k][i] = 2 * ((i > 0 ? 2 * t[k - 1][i - 1] : 0) - t[k - 1][i]) - t[k - 2][i];
  Terms result{};
  for (std::size_t k = 0; k < kTerms; ++k)
    for (std::size_t i = 0; i < kTerms; ++i) result[i] += chebyshevs[k] * t[k][i];
  return result;
}

Loss fitted_loss(const Facets& facets) {
  const bool round = facets.slope_x == facets.slope_y;
  const int azimuths = round ? 1 : 3;
  std::array<double, kNodes> cosines;
  std::array<double, kNodes> values{};
  std::array<double, kNodes> spread{};  // of the azimuths about their mean
  for (std::size_t i = 0; i < kNodes; ++i) {
    const double root = 0.5 - 0.5 * det::cos(kPi * (static_cast<double>(i) + 0.5) / kNodes);
    const double mu = std::max(root * root, kLeast);
    const double sine = std::sqrt((1 - mu) * (1 + mu));
    cosines[i] = mu;
    double least = 1;
    double most = 0;
    for (int k = 0; k < azimuths; ++k) {
      const det::SinCos turn = det::sincos(round ? 0 : kPi / 2 * (k + 0.5) / azimuths);
      const double loss = 1 - facet_albedo(facets, {sine * turn.cos, sine * turn.sin, mu}, 16);
      values[i] += loss / azimuths;
      least = std::min(least, loss);
      most = std::max(most, loss);
    }
    spread[i] = std::max(most - values[i], values[i] - least);
  }
  Minimax best;
  double bend = 1;
  for (const double one : kBends) {
    const Minimax found = minimax(cosines, values, one);
    if (found.error < best.error) {
      best = found;
      bend = one;
    }
  }
  Loss loss;
  const Terms terms = powers(best.terms);
  std::copy(terms.begin(), terms.end(), loss.coefficients.begin());
  loss.coefficients[kTerms] = bend;
  loss.mean = mean_loss(loss.coefficients);
  // between nodes it is a little more than at them
  loss.error = 1.4 * best.error + *std::max_element(spread.begin(), spread.end());
  return loss;
}

// Models have many materials and few kinds of facets.
Loss remembered_loss(const Facets& facets) {
  static std::mutex mutex;
  static std::map<std::tuple<SpecularLaw, double, double>, Loss> all;
  const std::tuple key(facets.law, facets.slope_x, facets.slope_y);
  {
    const std::lock_guard lock(mutex);
    const auto found = all.find(key);
    if (found != all.end()) return found->second;
  }
  const Loss loss = fitted_loss(facets);
  const std::lock_guard lock(mutex);
  if (all.size() >= 256) all.clear();
  all.emplace(key, loss);
  return loss;
}

double largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

double mean_loss(const std::array<double, 8>& coefficients) {
  f64::SurfaceFields s{};
  s.loss0 = coefficients[0];
  s.loss1 = coefficients[1];
  s.loss2 = coefficients[2];
  s.loss3 = coefficients[3];
  s.loss4 = coefficients[4];
  s.loss5 = coefficients[5];
  s.loss6 = coefficients[6];
  s.loss7 = coefficients[7];
  return 2 * mean_over_cosines([&](double mu) { return Vec3(mu * f64::facet_loss(s, mu)); }).x;
}

void fit_facets(Material& material) {
  const SpecularLaw law = material.specular_law;
  if (law != SpecularLaw::beckmann && law != SpecularLaw::ggx) return;
  if (material.compensation == Compensation::off) return;
  const f64::SurfaceFields s = f64::surface_of(material);
  const f64::Composition laws = f64::composition_of(material);
  const double outer = material.coat ? material.coat->index : 1;
  const auto reflected = [&](double mu) { return s.specular * laws.fresnel(s, mu, outer); };
  const bool always = material.compensation == Compensation::on;
  const double facing = largest(s.weights.y * reflected(1));
  // 1 − E_avg stays below 0.6 up to slopes of 1, and below 1 always
  if (!(facing > 0) || (!always && !(facing > kWorthCompensation))) return;

  Facets facets{law, f64::facet_slope(material.cook[1], 0), f64::facet_slope(material.alpha_y, 0)};
  const Loss loss = remembered_loss(facets);
  if (!(loss.mean > 1e-9) || (!always && !(facing * loss.mean > kWorthCompensation))) return;
  const Vec3 mean =
      glm::min(2.0 * mean_over_cosines([&](double mu) { return mu * reflected(mu); }), Vec3(1));
  for (int k = 0; k < 3; ++k) {
    if (!(s.specular[k] > 0)) continue;
    const double again = mean[k] * mean[k] * (1 - loss.mean) / (1 - mean[k] * loss.mean);
    material.fits.many_scale[k] = again / (s.specular[k] * kPi * loss.mean);
  }
  material.fits.loss = loss.coefficients;
  material.fits.error = std::max(material.fits.error, loss.error);
}

void fit_coat(Material& material) {
  if (!material.coat) return;
  const Coat& coat = *material.coat;
  // beyond the critical angle all is kept; up to it the square root of the distance from it counts
  const double edge = std::sqrt(std::max((1 - 1 / coat.index) * (1 + 1 / coat.index), 0.0));
  const auto passed = [&](double mu) {
    const double path = 2 / std::max(mu, 1e-10);
    return Vec3(det::exp(-coat.depth.x * path), det::exp(-coat.depth.y * path),
                det::exp(-coat.depth.z * path));
  };
  Vec3 kept(0);
  for (int part = 0; part < 2; ++part)
    kept += mean_over_cosines([&](double x) {
      if (part == 0) return 2 * edge * (edge * x) * passed(edge * x);
      const double mu = edge + (1 - edge) * x * x;
      const double inner = f64::fresnel_dielectric(mu, 1 / coat.index);
      return 4 * x * (1 - edge) * mu * inner * passed(mu);
    });
  const Vec3 below = mean_diffuse_albedo(material);
  for (int k = 0; k < 3; ++k) {
    const double share = material.diffuse[k] > 0 ? below[k] / material.diffuse[k] : 1;
    material.fits.coat_return[k] = std::clamp(kept[k] * share, 0.0, 1.0);
  }
}

}  // namespace panwright::materials
