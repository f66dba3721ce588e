#include "preview/reference/internal/scatter.h"

#include <algorithm>
#include <cmath>

#include "materials/brdf.h"
#include "preview/reference/internal/sampling.h"

namespace panwright::preview::reference {
namespace {

// ten angular radii of the Sun: lobes this wide are even over its disc to a percent
constexpr double kNarrowSlope = 0.05;
// as materials/formulas/cook_torrance.glsl
constexpr double kLeastSlope = 1e-6;
constexpr double kLargestSlope = 1000;

double strongest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

Scatter::Scatter(const materials::Material& material) : material_(material) {
  const double diffuse =
      material.weights.x *
      (material.diffuse_law == materials::DiffuseLaw::hapke ? 1.0 : strongest(material.diffuse));
  double facets = 0;
  switch (material.specular_law) {
    case materials::SpecularLaw::none:
      break;
    case materials::SpecularLaw::blinn_phong:
      exponent_ = material.shine;
      narrow_ = std::sqrt(2 / (exponent_ + 2)) < kNarrowSlope;
      facets = material.weights.y * strongest(material.specular);
      break;
    case materials::SpecularLaw::cook_torrance:
      slope_ = std::clamp(material.cook[1], kLeastSlope, kLargestSlope);
      narrow_ = slope_ < kNarrowSlope;
      facets = material.weights.y * strongest(material.specular);
      break;
  }
  if (!(diffuse > 0) && !(facets > 0)) return;
  // either part has its share, whatever angles and Fresnel's law make of the other
  facet_share_ = !(facets > 0)    ? 0
                 : !(diffuse > 0) ? 1
                                  : std::clamp(facets / (facets + diffuse), 0.25, 0.75);
  diffuse_share_ = 1 - facet_share_;
}

Vec3 Scatter::brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
                   const Vec3& tint) const {
  return materials::f64::brdf(material_, to_light, to_viewer, normal, tint);
}

// Density of the facets' normals, changed to that of what they reflect.
double Scatter::facet_pdf(const Vec3& half, const Vec3& to_viewer, const Vec3& normal) const {
  const double cos_nh = glm::dot(normal, half);
  const double cos_vh = glm::dot(to_viewer, half);
  if (!(cos_nh > 0) || !(cos_vh > 0)) return 0;
  if (slope_ > 0) {
    const Vec3 across = glm::cross(normal, half);
    const double cos2 = cos_nh * cos_nh;
    const double x = glm::dot(across, across) / (cos2 * slope_ * slope_);
    if (!(x < 700)) return 0;
    return det::exp(-x) / (kPi * slope_ * slope_ * cos2 * cos_nh) / (4 * cos_vh);
  }
  return (exponent_ + 1) / (2 * kPi) * det::pow(cos_nh, exponent_) / (4 * cos_vh);
}

double Scatter::pdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal) const {
  double result = diffuse_share_ * std::max(0.0, glm::dot(normal, to_light)) / kPi;
  if (facet_share_ > 0) {
    const Vec3 both = to_light + to_viewer;
    const double length = glm::length(both);
    if (length > 0) result += facet_share_ * facet_pdf(both / length, to_viewer, normal);
  }
  return result;
}

std::optional<Scattered> Scatter::sample(const Vec3& to_viewer, const Vec3& normal,
                                         const Vec3& tint, const Vec2& u, double u_lobe) const {
  Scattered result;
  if (u_lobe < diffuse_share_) {
    result.to_light = in_cosine_lobe(normal, u);
  } else {
    const double tan2 = slope_ > 0 ? -slope_ * slope_ * det::log(u.x) : 0;
    const double cosine = slope_ > 0 ? 1 / std::sqrt(1 + tan2) : det::pow(u.x, 1 / (exponent_ + 1));
    const double sine =
        slope_ > 0 ? std::sqrt(tan2) * cosine : std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const det::SinCos turn = det::sincos(2 * kPi * u.y);
    const Frame frame = frame_about(normal);
    const Vec3 half = sine * turn.cos * frame.x + sine * turn.sin * frame.y + cosine * normal;
    const double cos_vh = glm::dot(to_viewer, half);
    if (!(cos_vh > 0)) return std::nullopt;
    result.to_light = 2 * cos_vh * half - to_viewer;
  }
  const double length = glm::length(result.to_light);
  const double cos_nl = glm::dot(normal, result.to_light) / length;
  if (!(cos_nl > 0)) return std::nullopt;
  result.to_light /= length;
  result.pdf = pdf(result.to_light, to_viewer, normal);
  if (!(result.pdf > 0)) return std::nullopt;
  result.weight = brdf(result.to_light, to_viewer, normal, tint) * (cos_nl / result.pdf);
  return result;
}

}  // namespace panwright::preview::reference
