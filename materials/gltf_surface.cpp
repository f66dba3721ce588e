#include "materials/gltf_surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "materials/brdf.h"
#include "materials/energy.h"

namespace panwright::materials {

namespace {

constexpr double kNarrowest = 0.05;  // slope of the narrowest lobe that is compared

double fifth_power(double x) { return x * x * x * x * x; }

// D·G/(4 n·l n·v) of GGX with Smith's correlated masking, 1/sr; h: the half vector
double gltf_lobe(double roughness, const Vec3& l, const Vec3& v, const Vec3& h) {
  const double alpha = std::max(roughness * roughness, 1e-4), alpha2 = alpha * alpha;
  const double width = h.z * h.z * (alpha2 - 1) + 1;
  const double toward_v = l.z * std::sqrt(v.z * v.z * (1 - alpha2) + alpha2);
  const double toward_l = v.z * std::sqrt(l.z * l.z * (1 - alpha2) + alpha2);
  return alpha2 / (kPi * width * width) / (2 * (toward_v + toward_l));
}

// The same material with lobes that can be compared by a sum of a thousand directions.
Material widened(const Material& given) {
  Material m = given;
  // slopes below a coat look larger by its index
  const double least = m.coat ? kNarrowest / m.coat->index : kNarrowest;
  if (m.specular_model() == SpecularModel::mirror) m.specular_brdf = Ggx{least, least};
  if (const auto slopes = slopes_of(m))
    if (std::min(slopes->x, slopes->y) < least)
      m.specular_brdf = with_slopes(m.specular_model(), glm::max(*slopes, Vec2(least)));
  if (auto* phong = std::get_if<BlinnPhong>(&m.specular_brdf))
    phong->shine = std::min(phong->shine, 2 / (kNarrowest * kNarrowest));
  // what a smooth coat mirrors is compared by itself
  if (m.coat && m.coat->alpha > 0) m.coat->alpha = std::max(m.coat->alpha, kNarrowest);
  // fits cost up to 0.2 s, and those of what is wide enough hold
  if (m.specular_brdf != given.specular_brdf || m.coat != given.coat) fit(m);
  return m;
}

struct Compared {
  f64::CompiledBrdf brdf;
  ShadingContext local;
  double share;
  double smooth_index;  // of a coat without slopes; 0: none
};

// What a smooth boundary to an index reflects, exact.
double fresnel(double cosine, double index) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (index * index));
  const double across = (cosine - index * inside) / (cosine + index * inside);
  const double along = (index * cosine - inside) / (index * cosine + inside);
  return 0.5 * (across * across + along * along);
}

// The share of the light that glTF's coat reflects.
double coat_share(const GltfSurface& s, const Vec3& v) {
  return s.clearcoat * (0.04 + 0.96 * fifth_power(1 - v.z));
}

// The BRDF, or what is left of it without what the coat reflects.
Vec3 gltf_rough(const GltfSurface& s, const Vec3& l, const Vec3& v, bool smooth_coat) {
  const Vec3 h = glm::normalize(l + v);
  const double rise = fifth_power(1 - glm::dot(v, h));
  const double shine = gltf_lobe(s.roughness, l, v, h);
  const Vec3 f0 = glm::min(reflectance_of_index(s.ior) * s.specular_color, Vec3(1));
  const Vec3 fresnel = f0 + (Vec3(1) - f0) * rise;
  const double passed = 1 - s.specular * std::max({fresnel.x, fresnel.y, fresnel.z});
  const Vec3 dielectric = passed * s.base / kPi + s.specular * shine * fresnel;
  const Vec3 metal = shine * (s.base + (Vec3(1) - s.base) * rise);
  const Vec3 below = glm::mix(dielectric, metal, s.metallic);
  const double coat = coat_share(s, v);
  if (!(coat > 0)) return below;
  if (smooth_coat) return (1 - coat) * below;
  return glm::mix(below, Vec3(gltf_lobe(s.clearcoat_roughness, l, v, h)), coat);
}

double changed_for(std::span<const Compared> parts, const GltfSurface& surface, const Vec3& v) {
  constexpr int kRings = 48, kTurns = 24;
  const double first = det::log(kNarrowest / 50), last = det::log(40.0);
  const double step = (last - first) / kRings;
  const Vec3 up(0, 0, 1);
  double changed = 0, reflected = 0, mirrored = 0;
  const bool smooth = surface.clearcoat > 0 && !(surface.clearcoat_roughness > 0);
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
      const Vec3 off = glm::abs(ours - gltf_rough(surface, l, v, smooth));
      const double weight = 4 * along * l.z * t * sine * cosine * cosine * step * 2 * kPi / kTurns;
      changed += weight * (off.x + off.y + off.z);
      reflected += weight * (ours.x + ours.y + ours.z);
    }
  }
  for (const Compared& part : parts)
    if (part.smooth_index > 0) mirrored += part.share * fresnel(v.z, part.smooth_index);
  changed += 3 * std::fabs(mirrored - (smooth ? coat_share(surface, v) : 0));
  reflected += 3 * mirrored;
  return reflected > 0 ? changed / reflected : changed > 0 ? 1 : 0;
}

}  // namespace

double reflectance_of_index(double index) {
  const double root = (index - 1) / (index + 1);
  return root * root;
}

Vec3 gltf_brdf(const GltfSurface& s, const Vec3& l, const Vec3& v) {
  return gltf_rough(s, l, v, false);
}

double changed_share(std::span<const SurfacePart> parts, const GltfSurface& surface) {
  std::vector<Compared> compared;
  for (const SurfacePart& part : parts) {
    ShadingContext local;
    if (is_anisotropic(part.material)) local.tangent = Vec3(1, 0, 0);
    local.reflectance = part.reflectance;
    const bool smooth = part.material.coat && !(part.material.coat->alpha > 0);
    compared.push_back({f64::CompiledBrdf(widened(part.material)), local, part.share,
                        smooth ? part.material.coat->index : 0});
  }
  GltfSurface wide = surface;
  const double least = std::sqrt(kNarrowest);
  wide.roughness = std::max(wide.roughness, least);
  if (wide.clearcoat_roughness > 0)
    wide.clearcoat_roughness = std::max(wide.clearcoat_roughness, least);
  double most = 0;
  for (const double mu : {0.95, 0.5})
    most = std::max(most, changed_for(compared, wide, Vec3(std::sqrt(1 - mu * mu), 0, mu)));
  return most;
}

// ---- coats

namespace {

constexpr double kThere = 0.8;            // the cosine at which light from below the coats is equal
constexpr double kGltfCoat = 0.04;        // reflectance of a coat of strength 1
constexpr double kReflected = 0.0403072;  // the same at kThere: 0.04 + 0.96·0.2⁵

}  // namespace

double passed_by_gltf_coat(double strength) { return 1 - kReflected * strength; }

double gltf_coat_strength(const Material& m) {
  return m.coat ? std::min(reflectance_of_index(m.coat->index) / kGltfCoat, 1.0) : 0;
}

double coat_index_of_strength(double strength) {
  const double root = std::sqrt(kGltfCoat * strength);
  return (1 + root) / (1 - root);
}

Vec3 DiffuseCurve::operator()(const Vec3& x) const {
  return gain * x / glm::max(Vec3(1) - back * x, Vec3(1e-6));
}

Vec3 DiffuseCurve::inverse(const Vec3& albedo) const {
  return albedo / glm::max(gain + back * albedo, Vec3(1e-6));
}

DiffuseCurve diffuse_curve(const Material& m) {
  DiffuseCurve curve;
  if (!(m.weights.x > 0)) return curve;
  Material part = m;
  part.weights = {m.weights.x, 0, 0};
  part.specular_brdf = NoSpecular{};
  part.cells.reset();
  part.maps = {};
  const auto albedo = [&](double diffuse) {
    part.diffuse = Vec3(diffuse);
    fit(part);
    return m.coat ? directional_albedo(part, kThere) : hemispherical_albedo(part);
  };
  if (!m.coat) {
    curve.gain = m.diffuse_model() == DiffuseModel::lambert ? Vec3(m.weights.x) : albedo(1);
    return curve;
  }
  // two points make the two numbers: E(1)/E(½) = (2 − back)/(1 − back)
  const Vec3 dark = albedo(0), half = albedo(0.5) - dark, all = albedo(1) - dark;
  for (int c = 0; c < 3; ++c) {
    if (!(half[c] > 1e-9)) continue;
    const double ratio = all[c] / half[c];
    curve.back[c] = std::max((ratio - 2) / (ratio - 1), 0.0);
    curve.gain[c] = all[c] * (1 - curve.back[c]) / passed_by_gltf_coat(gltf_coat_strength(m));
  }
  return curve;
}

Vec3 reflectance_below_gltf_coat(const Material& m, const Vec3& reflectance) {
  if (!m.coat) return reflectance;
  const double first = reflectance_of_index(m.coat->index);
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    const double twice = det::exp(-2 * m.coat->depth[c]);
    out[c] = (1 - first) * (1 - first) * twice * reflectance[c] /
             (1 - first * twice * std::min(reflectance[c], 1.0));
  }
  return out / passed_by_gltf_coat(gltf_coat_strength(m));
}

Vec3 reflectance_below_our_coat(const Coat& coat, const Vec3& reflectance) {
  const double first = reflectance_of_index(coat.index);
  const Vec3 out = reflectance * passed_by_gltf_coat(first / kGltfCoat);
  return out / ((1 - first) * (1 - first) + first * out);
}

}  // namespace panwright::materials
