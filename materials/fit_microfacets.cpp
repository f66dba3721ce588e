// The energy that single scattering between microfacets loses, as a few coefficients.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "base/math.h"
#include "materials/energy.h"
#include "materials/internal/fits.h"
#include "materials/internal/formulas.h"

namespace panwright::materials {
namespace {

constexpr std::size_t kMicrofacetTerms = 7;
constexpr std::size_t kMicrofacetNodes = 32;
constexpr int kFittedAzimuths = 8;  // of microfacets that are anisotropic
constexpr double kLeast = 1e-6;     // cosine used for grazing
// where the loss has its bend: the b of albedo_deficit_polynomial; negative ones are tried as well
constexpr std::array kBends{2e-3, 6e-3, 0.016, 0.035, 0.07, 0.1, 0.15,
                            0.2,  0.3,  0.5,   0.8,   1.5,  3.0, 10.0};

struct Loss {
  std::array<double, 8> coefficients{};
  double error = 0;  // largest, of any azimuth
};

using Terms = std::array<double, kMicrofacetTerms>;

double warped(double cosine, double bend) {
  const double c = bend < 0 ? cosine * cosine : cosine;
  const double b = std::fabs(bend);
  return std::sqrt(c * (1 + b) / (c + b));
}

// Chebyshev's polynomials of 2x − 1.
Terms chebyshev(double x) {
  Terms t{1, 2 * x - 1};
  for (std::size_t k = 2; k < kMicrofacetTerms; ++k) t[k] = 2 * t[1] * t[k - 1] - t[k - 2];
  return t;
}

double dot(const Terms& a, const Terms& b) {
  double sum = 0;
  for (std::size_t k = 0; k < kMicrofacetTerms; ++k) sum += a[k] * b[k];
  return sum;
}

// Least squares; the normal equations of Chebyshev's polynomials are well conditioned.
Terms solved(const std::array<Terms, kMicrofacetNodes>& rows,
             const std::array<double, kMicrofacetNodes>& values,
             const std::array<double, kMicrofacetNodes>& weights) {
  std::array<std::array<double, kMicrofacetTerms + 1>, kMicrofacetTerms> a{};
  for (std::size_t i = 0; i < kMicrofacetNodes; ++i)
    for (std::size_t r = 0; r < kMicrofacetTerms; ++r) {
      for (std::size_t c = 0; c < kMicrofacetTerms; ++c)
        a[r][c] += weights[i] * rows[i][r] * rows[i][c];
      a[r][kMicrofacetTerms] += weights[i] * rows[i][r] * values[i];
    }
  // Cholesky's order needs no pivots
  for (std::size_t p = 0; p < kMicrofacetTerms; ++p)
    for (std::size_t r = 0; r < kMicrofacetTerms; ++r) {
      if (r == p) continue;
      const double factor = a[r][p] / a[p][p];
      for (std::size_t c = p; c <= kMicrofacetTerms; ++c) a[r][c] -= factor * a[p][c];
    }
  Terms result{};
  for (std::size_t r = 0; r < kMicrofacetTerms; ++r) result[r] = a[r][kMicrofacetTerms] / a[r][r];
  return result;
}

struct Minimax {
  Terms terms{};
  double error = 1e300;
};

// C. L. Lawson's iteration: weights grow where the error is large.
Minimax minimax(const std::array<double, kMicrofacetNodes>& cosines,
                const std::array<double, kMicrofacetNodes>& values, double bend) {
  std::array<Terms, kMicrofacetNodes> rows;
  for (std::size_t i = 0; i < kMicrofacetNodes; ++i) rows[i] = chebyshev(warped(cosines[i], bend));
  std::array<double, kMicrofacetNodes> weights;
  weights.fill(1.0 / kMicrofacetNodes);
  Minimax best;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Terms terms = solved(rows, values, weights);
    std::array<double, kMicrofacetNodes> errors;
    double largest = 0;
    double sum = 0;
    for (std::size_t i = 0; i < kMicrofacetNodes; ++i) {
      errors[i] = std::fabs(dot(rows[i], terms) - values[i]);
      largest = std::max(largest, errors[i]);
      sum += weights[i] * errors[i];
    }
    if (largest < best.error) best = {terms, largest};
    if (!(sum > 1e-14)) break;
    for (std::size_t i = 0; i < kMicrofacetNodes; ++i)
      weights[i] = weights[i] * errors[i] / sum + 1e-9;
  }
  return best;
}

// From Chebyshev's polynomials of 2x − 1 to powers of x.
Terms powers(const Terms& chebyshevs) {
  std::array<Terms, kMicrofacetTerms> t{};
  t[0] = {1};
  t[1] = {-1, 2};
  for (std::size_t k = 2; k < kMicrofacetTerms; ++k)
    for (std::size_t i = 0; i < kMicrofacetTerms; ++i)
      t[k][i] = 2 * ((i > 0 ? 2 * t[k - 1][i - 1] : 0) - t[k - 1][i]) - t[k - 2][i];
  Terms result{};
  for (std::size_t k = 0; k < kMicrofacetTerms; ++k)
    for (std::size_t i = 0; i < kMicrofacetTerms; ++i) result[i] += chebyshevs[k] * t[k][i];
  return result;
}

// microfacets, a mirror under a rough coat, or a coat's surface, whose loss is fitted.
struct FittedStack {
  Microfacets microfacets;
  std::optional<Coat> coat;  // its depth is ignored
};

// What is missing of the light from one direction, as microfacet_albedo_deficit takes it.
double missing(const FittedStack& stack, const Vec3& v) {
  if (!stack.coat) return 1 - microfacet_albedo(stack.microfacets, v, 16);
  Material white;
  white.weights = {0, 1, 0};
  white.specular = Vec3(1);
  white.specular_brdf =
      with_slopes(stack.microfacets.brdf, {stack.microfacets.slope_x, stack.microfacets.slope_y});
  white.coat = Coat{.index = stack.coat->index, .alpha = stack.coat->alpha};
  const bool round = stack.microfacets.slope_x == stack.microfacets.slope_y;
  const double returned = coated_microfacets_albedo(white, v, round ? 32 : 16);
  if (white.coat->alpha > 0) return 1 - coat_peak_albedo(*white.coat, v, 32) - returned;
  return 1 - returned / (1 - f64::fresnel_dielectric(v.z, white.coat->index));
}

// Fits `value` of (cosine, azimuth), in the mean over `azimuths` of a quarter.
template <class Value>
Loss fitted(int azimuths, Value value) {
  std::array<double, kMicrofacetNodes> cosines;
  std::array<double, kMicrofacetNodes> values{};
  std::array<double, kMicrofacetNodes> spread{};  // of the azimuths about their mean
  for (std::size_t i = 0; i < kMicrofacetNodes; ++i) {
    const double root =
        0.5 - 0.5 * det::cos(kPi * (static_cast<double>(i) + 0.5) / kMicrofacetNodes);
    const double mu = std::max(root * root, kLeast);
    const double sine = std::sqrt((1 - mu) * (1 + mu));
    cosines[i] = mu;
    double least = 1;
    double most = -1;
    for (int k = 0; k < azimuths; ++k) {
      const det::SinCos turn = det::sincos(azimuths == 1 ? 0 : kPi / 2 * (k + 0.5) / azimuths);
      const double albedo_deficit = value(Vec3(sine * turn.cos, sine * turn.sin, mu));
      values[i] += albedo_deficit / azimuths;
      least = std::min(least, albedo_deficit);
      most = std::max(most, albedo_deficit);
    }
    spread[i] = std::max(most - values[i], values[i] - least);
  }
  Minimax best;
  double bend = 1;
  for (const double one : kBends)
    for (const double signed_one : {one, -one}) {
      const Minimax found = minimax(cosines, values, signed_one);
      if (found.error < best.error) {
        best = found;
        bend = signed_one;
      }
    }
  Loss albedo_deficit;
  const Terms terms = powers(best.terms);
  std::copy(terms.begin(), terms.end(), albedo_deficit.coefficients.begin());
  albedo_deficit.coefficients[kMicrofacetTerms] = bend;
  // between nodes it is a little more than at them
  albedo_deficit.error = 1.4 * best.error + *std::max_element(spread.begin(), spread.end());
  return albedo_deficit;
}

// Models have many materials and few kinds of microfacets.
template <class Make>
Loss remembered(const FittedStack& stack, Make make) {
  static std::mutex mutex;
  static std::map<std::tuple<SpecularModel, double, double, double, double>, Loss> all;
  const Coat coat = stack.coat.value_or(Coat{.index = 0});
  const std::tuple key(stack.microfacets.brdf, stack.microfacets.slope_x, stack.microfacets.slope_y,
                       coat.index, coat.alpha);
  {
    const std::lock_guard lock(mutex);
    const auto found = all.find(key);
    if (found != all.end()) return found->second;
  }
  const Loss albedo_deficit = make();
  const std::lock_guard lock(mutex);
  if (all.size() >= 256) all.clear();
  all.emplace(key, albedo_deficit);
  return albedo_deficit;
}

Loss deficit_of(const FittedStack& stack) {
  return remembered(stack, [&] {
    const bool round = stack.microfacets.slope_x == stack.microfacets.slope_y;
    return fitted(round ? 1 : kFittedAzimuths, [&](const Vec3& v) { return missing(stack, v); });
  });
}

// What a rough coat's surface reflects more than a plane.
Loss coat_excess(const Coat& coat) {
  return remembered({{SpecularModel::none, 0, 0}, coat}, [&] {
    return fitted(1, [&](const Vec3& v) {
      return coat_peak_albedo(coat, v, 64) - f64::fresnel_dielectric(v.z, coat.index);
    });
  });
}

double mean_of_cosines(const std::function<double(double)>& f) {
  return 2 * mean_over_cosines([&](double mu) { return Vec3(mu * f(mu)); }).x;
}

// Part of the light from below that is not let out at once which is left after a way down and up.
Vec3 kept_by_depth(const Coat& coat) {
  const double edge = std::sqrt(std::max((1 - 1 / coat.index) * (1 + 1 / coat.index), 0.0));
  return 2.0 * mean_over_cosines([&](double x) {
           const double path = 2 / std::max(edge * x, 1e-10);
           return x * Vec3(det::exp(-coat.depth.x * path), det::exp(-coat.depth.y * path),
                           det::exp(-coat.depth.z * path));
         });
}

}  // namespace

double mean_albedo_deficit(const Material& material) {
  const f64::SurfaceFields s = f64::surface_of(material);
  const bool passed = material.coat && !(s.coat_alpha > 0);
  return mean_of_cosines([&](double mu) {
    return (passed ? 1 - f64::coat_first(s, mu) : 1) * f64::microfacet_albedo_deficit(s, mu);
  });
}

void fit_microfacets(Material& material) {
  const SpecularModel brdf = material.specular_model();
  const bool blurred = brdf == SpecularModel::mirror && material.coat && material.coat->alpha > 0 &&
                       material.coat->index > 1;
  if (!info_of(brdf).smith && !blurred) return;
  if (material.compensation == Compensation::off) return;
  const f64::SurfaceFields s = f64::surface_of(material);
  const f64::Composition composition = f64::composition_of(material);
  const double outer = material.coat ? material.coat->index : 1;
  const auto reflected = [&](double mu) {
    return s.specular * composition.own_fresnel(s, mu, outer);
  };
  const bool always = material.compensation == Compensation::on;
  const double f0 = max_component(s.weights.y * reflected(1));
  // 1 − E_avg stays below 0.6 up to slopes of 1, and below 1 always
  if (!(f0 > 0) || (!always && !(f0 > kWorthCompensation))) return;

  // a mirror takes the slopes of its coat
  const Vec2 alpha = slopes_of(material).value_or(Vec2(0));
  const auto slope = [&](double a) { return blurred ? 0 : f64::microfacet_slope(a); };
  const FittedStack stack{{brdf, slope(alpha.x), slope(alpha.y)}, material.coat};
  const Loss albedo_deficit = deficit_of(stack);
  Material tried = material;
  tried.fits.albedo_deficit = albedo_deficit.coefficients;
  const double lost = mean_albedo_deficit(tried);
  if (!(lost > 1e-9) || (!always && !(f0 * lost > kWorthCompensation))) return;
  const Vec3 mean =
      glm::min(2.0 * mean_over_cosines([&](double mu) { return mu * reflected(mu); }), Vec3(1));
  // of what enters, and of what is reflected repeatedly
  double entering = 1;
  Vec3 round(1);
  if (material.coat) {
    entering = mean_of_cosines([&](double mu) { return 1 - f64::fresnel_dielectric(mu, outer); });
    round = kept_by_depth(*material.coat);
  }
  const double staying = std::min(lost / entering, 1.0);
  for (int k = 0; k < 3; ++k) {
    if (!(s.specular[k] > 0)) continue;
    const double again =
        mean[k] * mean[k] * round[k] * (1 - staying) / (1 - mean[k] * round[k] * staying);
    material.fits.compensation_scale[k] = again / (s.specular[k] * kPi * lost);
  }
  material.fits.albedo_deficit = albedo_deficit.coefficients;
  material.fits.error = std::max(material.fits.error, albedo_deficit.error);
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
  if (coat.alpha > 0 && material.fits.compensation_scale == Vec3(0)) {
    const Loss excess = coat_excess(coat);
    material.fits.albedo_deficit = excess.coefficients;
    material.fits.error = std::max(material.fits.error, excess.error);
    const f64::SurfaceFields s = f64::surface_of(material);
    const double more = mean_of_cosines([&](double mu) {
      return f64::coat_first(s, mu) - f64::fresnel_dielectric(mu, coat.index);
    });
    // n² as much light from below as from outside
    kept += more / (coat.index * coat.index) * passed(1);
  }
  const Vec3 below = mean_diffuse_albedo(material);
  for (int k = 0; k < 3; ++k) {
    const double share = material.diffuse[k] > 0 ? below[k] / material.diffuse[k] : 1;
    material.fits.coat_return[k] = std::clamp(kept[k] * share, 0.0, 1.0);
  }
}

}  // namespace panwright::materials
