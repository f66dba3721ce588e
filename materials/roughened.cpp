#include "materials/roughened.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace panwright::materials {
namespace {

// The largest that the format takes.
constexpr double kMostSigma = 1.5, kMostSlope = 1;

double wider(double alpha, double variance) {
  return std::min(std::sqrt(alpha * alpha + 2 * variance), kMostSlope);
}

// The σ whose eon_roughness() this is, as a variance.
double variance_of_eon(double roughness) {
  double low = 0, high = kMostSigma;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (eon_roughness(middle) < roughness ? low : high) = middle;
  }
  return low * low;
}

// What V-cavities of such slopes have as the deviation of their angle.
double angle_of(double variance) { return std::min(det::atan(std::sqrt(variance)), kMostSigma); }

DiffuseBrdf wider(const DiffuseBrdf& brdf, double variance) {
  if (std::holds_alternative<Lambert>(brdf)) return OrenNayar{.sigma = angle_of(variance)};
  if (const auto* oren = std::get_if<OrenNayar>(&brdf)) {
    const double t = det::tan(std::min(oren->sigma, kMostSigma));
    return OrenNayar{.sigma = angle_of(t * t + variance)};
  }
  if (const auto* eon = std::get_if<Eon>(&brdf))
    return Eon{.roughness = std::min(
                   eon_roughness(angle_of(variance_of_eon(eon->roughness) + variance)), 1.0)};
  if (const auto* hapke = std::get_if<Hapke>(&brdf)) {
    // tan θ̄ is the mean slope of Gaussian slopes: √(2/π) times their deviation along one axis
    Hapke out = *hapke;
    const double t = det::tan(out.roughness);
    out.roughness =
        std::min(det::atan(std::sqrt(t * t + (2 / kPi) * (variance / 2))), 60 * kDegree);
    return out;
  }
  return brdf;
}

SpecularBrdf wider(const SpecularBrdf& brdf, const Vec2& variance) {
  const double mean = (variance.x + variance.y) / 2;
  if (const auto* phong = std::get_if<BlinnPhong>(&brdf))
    return BlinnPhong{.shine = std::max(2 / (2 / (phong->shine + 2) + 2 * mean) - 2, 0.0)};
  if (const auto* cook = std::get_if<CookTorrance>(&brdf)) {
    CookTorrance out = *cook;
    out.alpha = wider(out.alpha, mean);
    return out;
  }
  if (const auto* beckmann = std::get_if<Beckmann>(&brdf))
    return Beckmann{wider(beckmann->alpha_x, variance.x), wider(beckmann->alpha_y, variance.y)};
  if (const auto* ggx = std::get_if<Ggx>(&brdf)) {
    const Vec2 alpha(wider(ggx->alpha_x, variance.x), wider(ggx->alpha_y, variance.y));
    if (4 * mean > ggx->alpha_x * ggx->alpha_x + ggx->alpha_y * ggx->alpha_y)
      return Beckmann{alpha.x, alpha.y};
    return Ggx{alpha.x, alpha.y};
  }
  if (std::holds_alternative<Mirror>(brdf))
    return Beckmann{std::max(wider(0, variance.x), 1e-4), std::max(wider(0, variance.y), 1e-4)};
  return brdf;
}

}  // namespace

Material roughened(const Material& material, const Vec2& variance) {
  const double mean = (variance.x + variance.y) / 2;
  if (!(mean > 0)) return material;
  const bool alike = std::fabs(variance.x - variance.y) < 0.1 * mean;
  Material out = material;
  const bool diffuse = out.weights.x > 0 && out.diffuse != Vec3(0);
  if (diffuse) out.diffuse_brdf = wider(out.diffuse_brdf, 2 * mean);
  out.specular_brdf = wider(out.specular_brdf, alike ? Vec2(mean) : variance);
  if (out.coat) out.coat->alpha = wider(out.coat->alpha, mean);
  out.fits = {};
  fit(out);
  return out;
}

}  // namespace panwright::materials
