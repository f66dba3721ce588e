#include "exporters/internal/gltf_brdf.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "materials/brdf.h"

namespace panwright::exporters {

namespace {

constexpr double kNarrowest = 0.05;  // slope of the narrowest lobe that is compared

double fifth_power(double x) { return x * x * x * x * x; }

double masking(double cosine, double alpha2) {
  return 2 * cosine / (cosine + std::sqrt(alpha2 + (1 - alpha2) * cosine * cosine));
}

// D·G/(4 n·l n·v), 1/sr; h: the half vector
double lobe(double roughness, const Vec3& l, const Vec3& v, const Vec3& h) {
  const double alpha = std::max(roughness * roughness, 1e-4), alpha2 = alpha * alpha;
  const double width = h.z * h.z * (alpha2 - 1) + 1;
  return alpha2 / (kPi * width * width) * masking(l.z, alpha2) * masking(v.z, alpha2) /
         (4 * l.z * v.z);
}

// The same material with lobes that can be compared by a sum of a thousand directions.
materials::Material widened(materials::Material m) {
  if (m.specular_model() == materials::SpecularModel::mirror)
    m.specular_brdf = materials::Ggx{kNarrowest, kNarrowest};
  if (const auto slopes = materials::slopes_of(m))
    m.specular_brdf =
        materials::with_slopes(m.specular_model(), glm::max(*slopes, Vec2(kNarrowest)));
  if (auto* phong = std::get_if<materials::BlinnPhong>(&m.specular_brdf))
    phong->shine = std::min(phong->shine, 2 / (kNarrowest * kNarrowest) - 2);
  if (m.coat) m.coat->alpha = std::max(m.coat->alpha, kNarrowest);
  materials::fit(m);
  return m;
}

struct Compared {
  materials::f64::CompiledBrdf brdf;
  materials::ShadingContext local;
  double share;
};

double changed_for(std::span<const Compared> parts, const GltfSurface& surface, const Vec3& v) {
  constexpr int kRings = 48, kTurns = 24;
  const double first = det::log(kNarrowest / 50), last = det::log(40.0);
  const double step = (last - first) / kRings;
  const Vec3 up(0, 0, 1);
  double changed = 0, reflected = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    // half vectors of tangents that grow by equal factors: a lobe of any width gets as many
    const double t = det::exp(first + (ring + 0.5) * step);
    const double cosine = 1 / std::sqrt(1 + t * t), sine = t * cosine;
    for (int turn = 0; turn < kTurns; ++turn) {
      const det::SinCos around = det::sincos(2 * kPi * (turn + 0.5) / kTurns);
      const Vec3 h(sine * around.cos, sine * around.sin, cosine);
      const double along = glm::dot(v, h);
      const Vec3 l = 2 * along * h - v;
      if (!(along > 0 && l.z > 1e-3)) continue;
      Vec3 ours(0);
      for (const Compared& part : parts)
        ours += part.share * part.brdf.brdf(l, v, up, Vec3(1), part.local);
      const Vec3 off = glm::abs(ours - gltf_brdf(surface, l, v));
      const double weight = along * l.z * t * sine * cosine * cosine;
      changed += weight * (off.x + off.y + off.z);
      reflected += weight * (ours.x + ours.y + ours.z);
    }
  }
  return reflected > 0 ? changed / reflected : changed > 0 ? 1 : 0;
}

}  // namespace

double reflectance_of_index(double index) {
  const double root = (index - 1) / (index + 1);
  return root * root;
}

Vec3 gltf_brdf(const GltfSurface& s, const Vec3& l, const Vec3& v) {
  const Vec3 h = glm::normalize(l + v);
  const double rise = fifth_power(1 - glm::dot(v, h));
  const double shine = lobe(s.roughness, l, v, h);
  const Vec3 f0 = glm::min(reflectance_of_index(s.ior) * s.specular_color, Vec3(1));
  const Vec3 fresnel = f0 + (Vec3(1) - f0) * rise;
  const double passed = 1 - s.specular * std::max({fresnel.x, fresnel.y, fresnel.z});
  const Vec3 dielectric = passed * s.base / kPi + s.specular * shine * fresnel;
  const Vec3 metal = shine * (s.base + (Vec3(1) - s.base) * rise);
  const Vec3 below = glm::mix(dielectric, metal, s.metallic);
  const double coat = s.clearcoat * (0.04 + 0.96 * fifth_power(1 - v.z));
  if (!(coat > 0)) return below;
  return glm::mix(below, Vec3(lobe(s.clearcoat_roughness, l, v, h)), coat);
}

double changed_share(std::span<const SurfacePart> parts, const GltfSurface& surface) {
  std::vector<Compared> compared;
  for (const SurfacePart& part : parts) {
    materials::ShadingContext local;
    if (materials::is_anisotropic(part.material)) local.tangent = Vec3(1, 0, 0);
    local.reflectance = part.reflectance;
    compared.push_back({materials::f64::CompiledBrdf(widened(part.material)), local, part.share});
  }
  GltfSurface wide = surface;
  const double least = std::sqrt(kNarrowest);
  wide.roughness = std::max(wide.roughness, least);
  wide.clearcoat_roughness = std::max(wide.clearcoat_roughness, least);
  double most = 0;
  for (const double mu : {0.95, 0.5})
    most = std::max(most, changed_for(compared, wide, Vec3(std::sqrt(1 - mu * mu), 0, mu)));
  return most;
}

}  // namespace panwright::exporters
