#include "materials/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "materials/brdf.h"

namespace panwright::materials {
namespace {

// directional albedos of Oren and Nayar's model of 1994 reach 1.0435 at albedo 1
constexpr double kOrenGain = 1.05;

constexpr double kRounding = 1e-9;

// Directions about +z: polar angles from the zenith to just above the horizon.
std::vector<Vec3> directions(std::span<const double> azimuths) {
  constexpr double kAngles_deg[] = {0, 0.1, 1, 5, 15, 30, 45, 60, 75, 85, 89, 89.9};
  std::vector<Vec3> all;
  for (const double polar : kAngles_deg)
    for (const double azimuth : azimuths) {
      const auto t = det::sincos(polar * kDegree);
      const auto p = det::sincos(azimuth * kDegree);
      // note: in floats, so that both precisions see the same directions
      all.emplace_back(Vec3(glm::vec3(Vec3(t.sin * p.cos, t.sin * p.sin, t.cos))));
      if (polar == 0) break;
    }
  return all;
}

void compare_precisions(const Material& material, MaterialReport& out) {
  constexpr double kViewers_deg[] = {0};
  constexpr double kLights_deg[] = {0, 0.1, 10, 45, 90, 135, 170, 179, 179.9, 180};
  const Vec3 normal(0, 0, 1);
  const Vec3 tangent(1, 0, 0);
  // the range of a reflectance map
  std::vector<ShadingContext> locals{{tangent, {}}};
  if (brdf_model_of(material).mapped)
    for (const double r : {0.0, 0.5, 1.0}) locals.push_back({tangent, Vec3(r)});
  struct Pair {
    Vec3 exact;
    Vec3 single;
  };
  std::vector<Pair> pairs;
  double peak = 0;
  for (const Vec3& viewer : directions(kViewers_deg))
    for (const Vec3& direction : directions(kLights_deg))
      for (const ShadingContext& local : locals) {
        const Incidence light = sunlight(direction);
        Pair pair;
        pair.exact = f64::brdf(material, light, viewer, normal, Vec3(1), local);
        pair.single = Vec3(
            f32::brdf(material, light, glm::vec3(viewer), glm::vec3(normal), glm::vec3(1), local));
        peak = std::max(peak, max_component(pair.exact));
        pairs.push_back(pair);
      }
  double sum = 0;
  std::size_t count = 0;
  for (const Pair& pair : pairs)
    for (int k = 0; k < 3; ++k) {
      if (!(pair.exact[k] > 1e-6 * peak)) continue;
      const double error = std::fabs(pair.single[k] - pair.exact[k]) / pair.exact[k];
      out.f32_error = std::max(out.f32_error, error);
      sum += error * error;
      ++count;
    }
  if (count > 0) out.f32_rms = std::sqrt(sum / static_cast<double>(count));
}

// The material with another slope of its microfacets and its coat, wherever it has one.
Material with_slope(const Material& material, double slope) {
  Material m = material;
  if (slopes_of(m)) m.specular_brdf = with_slopes(m.specular_model(), Vec2(slope));
  if (m.coat && m.coat->alpha > 0) m.coat->alpha = slope;
  fit(m);
  return m;
}

std::optional<double> safe_slope_of(const Material& material, const MaterialReport& report) {
  double own = 0;
  if (const auto slopes = slopes_of(material)) own = std::min(slopes->x, slopes->y);
  if (material.coat && material.coat->alpha > 0)
    own = own > 0 ? std::min(own, material.coat->alpha) : material.coat->alpha;
  if (!(own > 0) || report.f32_error > kSafeInSingle) return std::nullopt;
  double safe = own;
  for (const double slope : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 3e-4, 1e-4}) {
    if (slope >= own) continue;
    MaterialReport one;
    compare_precisions(with_slope(material, slope), one);
    if (one.f32_error > kSafeInSingle) break;
    safe = slope;
  }
  return safe;
}

MaterialReport::Albedo albedo_of(const Material& material, double mu) {
  MaterialReport::Albedo one{mu, directional_albedo(material, mu)};
  one.least = one.largest = one.rgb;
  if (!is_anisotropic(material)) return one;
  // slopes alone are symmetric about both axes
  const double range = material.cells ? 2 * kPi : kPi / 2;
  const int steps = material.cells ? 12 : 6;
  for (int i = 1; i <= steps; ++i) {
    const Vec3 rgb = directional_albedo(material, mu, range * i / steps);
    one.least = glm::min(one.least, rgb);
    one.largest = glm::max(one.largest, rgb);
  }
  return one;
}

}  // namespace

MaterialReport material_report(const Material& material, std::span<const double> mus) {
  MaterialReport out;
  for (const double mu : mus) out.directional.push_back(albedo_of(material, mu));
  out.hemispherical = hemispherical_albedo(material);
  out.gain = energy_gain(material);
  out.reciprocity = reciprocity_residual(material);
  out.fit_error = material.fits.error;
  compare_precisions(material, out);
  out.safe_slope = safe_slope_of(material, out);
  return out;
}

std::string verdict(const MaterialReport& report) {
  const double angle = det::acos(std::clamp(report.gain.mu, 0.0, 1.0)) / kDegree;
  std::string words;
  if (report.gain.albedo <= kConserved)
    words = fmt::format("Energy: conserved (largest directional albedo {:.3f} at {:.3g}°).",
                        report.gain.albedo, angle);
  else
    words = fmt::format(
        "Energy: GAINED, up to {:.2g} % more light leaves than came (directional albedo {:.4g} at "
        "{:.3g}°).",
        100 * (report.gain.albedo - 1), report.gain.albedo, angle);
  words +=
      report.reciprocity <= kReciprocal
          ? " Reciprocal."
          : fmt::format(" NOT reciprocal: exchanging light and viewer changes it by up to {:.2g}.",
                        report.reciprocity);
  if (report.f32_error > kSafeInSingle)
    words += fmt::format(" NOT safe in single precision: off by up to {:.2g}.", report.f32_error);
  else if (report.safe_slope)
    words += fmt::format(" Safe in single precision down to slope {:.4g}.", *report.safe_slope);
  else
    words += " Safe in single precision.";
  if (report.fit_error > 0)
    words += fmt::format(" Approximations: off by at most {:.1g}.", report.fit_error);
  return words;
}

bool may_gain(const Material& m) {
  // note: under a coat both parts are weakened by it, and the coat's own share is what it takes
  const auto* cook = std::get_if<CookTorrance>(&m.specular_brdf);
  const double factor = cook != nullptr ? cook->d_scale * cook->f_scale * cook->g_scale : 1;
  double diffuse = 1;
  if (m.diffuse_model() == DiffuseModel::oren_nayar) diffuse = kOrenGain;
  // plane albedo 1 − γH is at most 1 but for the opposition effects, which come on top
  const auto* hapke = std::get_if<Hapke>(&m.diffuse_brdf);
  if (hapke != nullptr) diffuse = hapke->w * (1 + hapke->b0) * (1 + hapke->b_c0) < 0.5 ? 0.5 : 1e9;
  // microfacets that are anisotropic are balanced in the mean over the azimuth; a rough
  // coat over microfacets that scatter more than once reflects up to 6 % of what diffuse light has
  // passed
  constexpr double kNearlyAll = 0.9;
  const Vec2 alpha = slopes_of(m).value_or(Vec2(0));
  const bool brushed = alpha.x != alpha.y && (m.coat || !m.refract || m.maps.reflectance >= 0);
  const bool twice = m.coat && m.coat->alpha > 0 && m.fits.compensation_scale != Vec3(0);
  const bool uneven = brushed || (twice && m.weights.x * max_component(m.diffuse) > 0);
  bool gain = false;
  for (int k = 0; k < 3; ++k) {
    const double d = m.weights.x * m.diffuse[k];
    const double s = m.weights.y * m.specular[k];
    if (hapke == nullptr && d + s > 1 + kRounding) return false;
    gain = gain || d * diffuse + s * factor > (uneven ? kNearlyAll : 1 + kRounding);
  }
  return gain;
}

std::string brdf_in_words(const Material& m) {
  std::string words;
  const BrdfModel brdf_model = brdf_model_of(m);
  if (brdf_model.specular != SpecularModel::none) {
    words = info_of(brdf_model.specular).title;
    if (brdf_model.fresnel == FresnelModel::conductor) words += " of a conductor";
    if (brdf_model.fresnel == FresnelModel::dielectric) words += " of a dielectric";
    if (brdf_model.mapped) words += " of mapped reflectance";
    if (brdf_model.compensated) words += ", with multiple scattering";
  }
  if (m.weights.x > 0 && m.diffuse != Vec3(0)) {
    if (!words.empty()) words += " over ";
    words += info_of(brdf_model.diffuse).title;
  }
  if (words.empty()) words = "black";
  if (brdf_model.coated) words += ", under a clear coat";
  if (m.cells) words += ", laid out as cells";
  return words;
}

}  // namespace panwright::materials
