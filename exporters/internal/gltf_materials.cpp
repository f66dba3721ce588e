#include "exporters/internal/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace panwright::exporters {

namespace {

using materials::DiffuseModel;
using materials::SpecularModel;
using nlohmann::ordered_json;

double mean(const Vec3& v) { return (v.x + v.y + v.z) / 3; }
double unit(double x) { return std::clamp(x, 0.0, 1.0); }
ordered_json list(const Vec3& v) { return ordered_json::array({unit(v.x), unit(v.y), unit(v.z)}); }

// Reflectance at normal incidence.
Vec3 reflectance_at_normal(const materials::Material& m) {
  if (!m.refract) return Vec3(1);
  Vec3 f(1);
  for (int c = 0; c < 3; ++c) {
    const double n = (*m.refract)[c], k = m.extinction[c];
    if (n > 0 || k > 0) f[c] = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
  }
  return f;
}

double slope_of(const materials::Material& m) {
  if (const auto slopes = materials::slopes_of(m))
    return slopes->x == slopes->y ? slopes->x : std::sqrt(slopes->x * slopes->y);
  if (const auto* phong = std::get_if<materials::BlinnPhong>(&m.specular_brdf))
    return std::sqrt(2 / (phong->shine + 2));
  return m.specular_model() == SpecularModel::mirror ? 0 : 1;
}

void list_lost(const materials::Material& m, std::set<std::string>& lost) {
  if (m.diffuse_model() != DiffuseModel::lambert && m.weights.x > 0)
    lost.insert("diffuse BRDFs other than Lambert's");
  const auto slopes = materials::slopes_of(m);
  if (slopes && slopes->x != slopes->y) lost.insert("slopes that differ along u and v");
  const SpecularModel model = m.specular_model();
  if (model != SpecularModel::none && model != SpecularModel::ggx && model != SpecularModel::mirror)
    lost.insert("specular BRDFs other than GGX");
  if (m.cells) lost.insert("solar cells");
  if (m.coat && (m.coat->index != 1.5 || m.coat->depth != Vec3(0)))
    lost.insert("index and depth of coats");
  if (m.refract && m.extinction != Vec3(0)) lost.insert("complex refractive indices");
}

bool shines(const materials::Material& m) {
  return m.specular_model() != SpecularModel::none && m.weights.y > 0;
}

}  // namespace

bool is_coloured_metal(const materials::Material& m) {
  return m.maps.reflectance >= 0 && materials::brdf_model_of(m).mapped && shines(m) &&
         m.weights.x * m.diffuse == Vec3(0) && !m.cells;
}

ordered_json exported(const materials::Material& m, std::set<std::string>& lost,
                      std::set<std::string>& extensions) {
  list_lost(m, lost);
  ordered_json json = {{"name", m.name}};
  const Vec3 diffuse = m.weights.x * m.diffuse;
  const bool colored = is_coloured_metal(m);
  const Vec3 reflectance = colored ? Vec3(1) : reflectance_at_normal(m);
  const Vec3 f0 = shines(m) ? m.weights.y * m.specular * reflectance : Vec3(0);
  // what reflects more than any clear dielectric, and more than it scatters, is a metal
  const bool metal =
      colored ||
      (shines(m) && (m.extinction != Vec3(0) || (mean(f0) > 0.2 && mean(f0) > mean(diffuse))));
  ordered_json pbr;
  ordered_json more = ordered_json::object();
  if (metal && mean(diffuse) > 0) lost.insert("the diffuse part of metals");
  const Vec3 base = metal ? f0 : diffuse / glm::max(Vec3(1) - f0, Vec3(1e-3));
  pbr["baseColorFactor"] = {unit(base.x), unit(base.y), unit(base.z), 1.0};
  pbr["metallicFactor"] = metal ? 1.0 : 0.0;
  pbr["roughnessFactor"] = unit(std::sqrt(slope_of(m)));
  if (!metal) {
    const bool clear = shines(m) && m.refract && m.extinction == Vec3(0);
    if (!shines(m)) {
      more["KHR_materials_specular"] = {{"specularFactor", 0.0}};
    } else if (clear && m.refract->x >= 1) {
      if (m.refract->x != m.refract->y || m.refract->x != m.refract->z)
        lost.insert("refractive indices that differ by colour");
      more["KHR_materials_ior"] = {{"ior", mean(*m.refract)}};
      const Vec3 strength = m.weights.y * m.specular;
      if (strength != Vec3(1))
        more["KHR_materials_specular"] = {{"specularFactor", unit(mean(strength))}};
    } else {
      // no index: its strength over that of glass
      more["KHR_materials_specular"] = {
          {"specularFactor", 1.0},
          {"specularColorFactor", {f0.x / 0.04, f0.y / 0.04, f0.z / 0.04}}};
    }
  }
  json["pbrMetallicRoughness"] = std::move(pbr);
  if (m.coat)
    more["KHR_materials_clearcoat"] = {
        {"clearcoatFactor", 1.0}, {"clearcoatRoughnessFactor", unit(std::sqrt(m.coat->alpha))}};
  const Vec3 emissive = m.weights.z * m.emissive;
  const double brightest = std::max({emissive.x, emissive.y, emissive.z});
  if (brightest > 0) {
    json["emissiveFactor"] = list(brightest > 1 ? emissive / brightest : emissive);
    if (brightest > 1) more["KHR_materials_emissive_strength"] = {{"emissiveStrength", brightest}};
  }
  for (const auto& [name, value] : more.items()) extensions.insert(name);
  if (!more.empty()) json["extensions"] = std::move(more);
  return json;
}

}  // namespace panwright::exporters
