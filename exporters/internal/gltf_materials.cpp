#include "exporters/internal/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "exporters/internal/cell_pattern.h"
#include "exporters/internal/gltf_mixture.h"
#include "materials/cells.h"
#include "materials/gltf_surface.h"

namespace panwright::exporters {

namespace {

using Channel = TexturePool::Channel;
using materials::diffuse_curve;
using materials::DiffuseCurve;
using materials::DiffuseModel;
using materials::GltfSurface;
using materials::Material;
using materials::reflectance_of_index;
using materials::SpecularModel;
using materials::SurfacePart;
using nlohmann::ordered_json;

constexpr double kDielectric = 0.04;  // reflectance of glTF's own index, 1.5
// Differences of the light that no property of the material is named for.
constexpr double kWorthSaying = 0.02;
// Mean error of a channel up to which a texture's colours count as a mixture.
constexpr double kMixed = 0.006;
constexpr int kSamples = 64;  // texels a side that a decision looks at

// 0 to 1; what single precision left beside 1 is 1.
double unit(double x) { return x > 1 - 1e-6 ? 1 : std::max(x, 0.0); }
double mean(const Vec3& v) { return (v.x + v.y + v.z) / 3; }
ordered_json list(const Vec3& v) { return ordered_json::array({unit(v.x), unit(v.y), unit(v.z)}); }

bool shines(const Material& m) {
  return m.specular_model() != SpecularModel::none && m.weights.y > 0 && m.specular != Vec3(0);
}

// Reflectance at normal incidence, from inside the coat where there is one.
Vec3 reflectance_at_normal(const Material& m) {
  if (!m.refract) return Vec3(1);
  const double outside = m.coat ? m.coat->index : 1;
  Vec3 f(1);
  for (int c = 0; c < 3; ++c) {
    const double n = (*m.refract)[c], k = m.extinction[c];
    const double less = n - outside, more = n + outside;
    if (n > 0 || k > 0) f[c] = (less * less + k * k) / (more * more + k * k);
  }
  return f;
}

// α of the lobe as it is seen: slopes below a coat look larger by its index.
double slope_of(const Material& m) {
  const double bent = m.coat ? m.coat->index : 1;
  if (const auto slopes = materials::slopes_of(m))
    return bent * (slopes->x == slopes->y ? slopes->x : std::sqrt(slopes->x * slopes->y));
  if (const auto* phong = std::get_if<materials::BlinnPhong>(&m.specular_brdf))
    return bent * std::sqrt(2 / (phong->shine + 2));
  return m.specular_model() == SpecularModel::mirror ? 0 : 1;
}

// How a material is told in glTF's terms.
enum class Form : std::uint8_t {
  diffuse,     // no reflectance
  dielectric,  // reflectance by index, or as KHR_materials_specular's colour
  metal,       // reflectance is the base colour
  mixture      // of a dielectric of 0.04 and a metal
};

class Translation {
 public:
  Translation(TexturePool& textures, const Job& job, Material material, std::int32_t texture,
              bool has_texcoords)
      : textures_(textures), job_(job), m_(std::move(material)) {
    find_sources(texture, has_texcoords);
    curve_ = diffuse_curve(m_);
    if (m_.cells) {
      // the texture has the surface to itself
      pattern_ = CellPattern(*m_.cells, has_texcoords && !m_.maps.any() && colors_.empty());
      average_cells();
    }
    shines_ = shines(m_);
    slope_ = slope_of(m_);
    sample();
    choose();
    write_factors();
    write_textures();
    measure();
  }

  ordered_json json;
  std::set<std::string> extensions;
  std::map<std::string, double> lost;  // share of the light that the whole material loses
  bool takes_colors = true;
  bool mixes_colors = false;

 private:
  // ---- what the pan says

  void find_sources(std::int32_t texture, bool has_texcoords) {
    if (!has_texcoords) {
      if (texture < 0) return;
      named_.insert("textures mapped by longitude and latitude");
      flatten(texture);
      return;
    }
    maps_ = m_.maps;
    color_repeat_ = maps_.repeat;
    if (texture < 0) {
      if (maps_.albedo >= 0) colors_.push_back(maps_.albedo);
      return;
    }
    // the instance's own is not repeated
    const bool alone = maps_.albedo < 0 && maps_.reflectance < 0 && maps_.cutout < 0;
    if (maps_.repeat == Vec2(1) || alone) {
      color_repeat_ = Vec2(1);
      colors_.push_back(texture);
      if (maps_.albedo >= 0) colors_.push_back(maps_.albedo);
      return;
    }
    named_.insert("a second texture over the diffuse colour");
    flatten(texture);
    if (maps_.albedo >= 0) colors_.push_back(maps_.albedo);
  }

  // The mean of a texture stands for it; what it changes counts as lost.
  void flatten(std::int32_t texture) {
    const image::BakeSource from = textures_.source(texture);
    Vec3 sum(0);
    std::vector<Vec3> all;
    each_sample([&](double u, double v) {
      all.emplace_back(nearest_texel(from, u, v));
      sum += all.back();
    });
    const Vec3 middle = sum / static_cast<double>(all.size());
    double off = 0;
    for (const Vec3& texel : all) off += mean(glm::abs(texel - middle));
    flattened_ = off / std::max(mean(sum), 1e-9);
    tint_ = middle;
  }

  template <class Visit>
  static void each_sample(Visit visit) {
    for (int y = 0; y < kSamples; ++y)
      for (int x = 0; x < kSamples; ++x) visit((x + 0.5) / kSamples, (y + 0.5) / kSamples);
  }

  // Cells, grid lines and gaps by their shares of the area.
  void average_cells() {
    const std::array<Material, 3> parts = materials::cell_parts(m_);
    const Vec3& shares = pattern_.mean();
    for (int i = 0; i < 3; ++i) {
      const Material& part = parts[static_cast<std::size_t>(i)];
      if (shares[i] > 0) parts_.push_back({part, shares[i], {}});
      if (i > 0) others_[static_cast<std::size_t>(i - 1)] = diffuse_curve(part)(part.diffuse);
    }
  }

  static bool has_map(std::int32_t map) { return map >= 0; }
  bool mapped() const {
    return shines_ && maps_.reflectance >= 0 && materials::brdf_model_of(m_).mapped;
  }

  // shares: of cells, grid lines and gaps
  Vec3 diffuse(const Vec3& texel, const Vec3& shares) const {
    return shares.x * curve_(m_.diffuse * tint_ * texel) + shares.y * others_[0] +
           shares.z * others_[1];
  }
  // texel: of the reflectance map
  Vec3 reflectance(const Vec3& texel, const Vec3& shares) const {
    if (!shines_) return Vec3(0);
    const Vec3 below = m_.weights.y * m_.specular * (mapped() ? texel : reflectance_at_normal(m_));
    return glm::min(shares.x * materials::reflectance_below_gltf_coat(m_, below), Vec3(1));
  }

  Vec3 color_at(std::span<const image::BakeSource> sources, double u, double v) const {
    Vec3 color(1);
    for (const image::BakeSource& source : sources) color *= Vec3(nearest_texel(source, u, v));
    return color;
  }

  void sample() {
    std::vector<image::BakeSource> colors;
    for (const std::int32_t texture : colors_) colors.push_back(textures_.source(texture));
    const image::BakeSource shine = textures_.source(mapped() ? maps_.reflectance : -1);
    const image::BakeSource rough = textures_.source(maps_.roughness);
    double roughness = 0;
    each_sample([&](double u, double v) {
      const Vec3 texel(nearest_texel(shine, u, v));
      const Vec3 color = color_at(colors, u, v);
      samples_.push_back({diffuse(color, pattern_.mean()), reflectance(texel, pattern_.mean())});
      mean_color_ += color / static_cast<double>(kSamples * kSamples);
      mean_texel_ += texel / static_cast<double>(kSamples * kSamples);
      roughness += nearest_texel(rough, u, v).x / (kSamples * kSamples);
    });
    for (const auto& [d, r] : samples_) {
      mean_diffuse_ += d / static_cast<double>(samples_.size());
      mean_reflectance_ += r / static_cast<double>(samples_.size());
    }
    mean_roughness_ = roughness;
    if (!pattern_.drawn()) return;
    // what the texture has is the parts, not their mean
    samples_.clear();
    for (const Vec3& part : pattern_.parts())
      for (int k = 0; k <= kSamples * glm::dot(part, pattern_.mean()); ++k)
        samples_.push_back({diffuse(Vec3(1), part), reflectance(Vec3(1), part)});
  }

  // ---- how it is told

  double mixture_error() const {
    double sum = 0;
    for (const auto& [d, r] : samples_) sum += mixture_of(d, r, kDielectric, 255).error;
    return sum / static_cast<double>(samples_.size());
  }

  void choose() {
    if (!shines_ || max_component(mean_reflectance_) <= 0) {
      form_ = Form::diffuse;
      return;
    }
    const bool clear = m_.refract && m_.extinction == Vec3(0) && !mapped() && !m_.coat &&
                       reflectance_of_index(max_component(*m_.refract)) < 0.2;
    if (clear) {
      form_ = Form::dielectric;
    } else if (max_component(mean_diffuse_) <= 0) {
      form_ = Form::metal;
    } else {
      // metal and roughness share a texture
      const bool apart = has_map(maps_.roughness) && color_repeat_ != maps_.repeat;
      // a faint reflectance that is the same everywhere needs no texture
      const bool even = colored() && !mapped() && max_component(mean_reflectance_) < 0.2;
      form_ = !apart && !even && mixture_error() <= kMixed ? Form::mixture : Form::dielectric;
    }
  }

  Vec3 base_of(const Vec3& d, const Vec3& r) const {
    switch (form_) {
      case Form::diffuse:
        return d;
      case Form::dielectric:
        return d / std::max(1 - max_component(r), 1e-3);
      case Form::metal:
        return r;
      case Form::mixture:
        return mixture_of(d, r, kDielectric, varied_ ? 255 : 0).base;
    }
    return d;
  }

  bool colored() const { return !colors_.empty(); }

  void write_factors() {
    surface_.roughness = unit(std::sqrt(slope_));
    surface_.metallic = form_ == Form::metal ? 1 : 0;
    varied_ = form_ == Form::mixture && (colored() || mapped() || pattern_.drawn());
    if (varied_) surface_.metallic = 1;
    // textures lie below what the parts of the surface have without them
    surface_.base = Vec3(0);
    for (const Vec3& shares : pattern_.parts()) {
      const Vec3 d = diffuse(Vec3(1), shares), r = reflectance(Vec3(1), shares);
      peak_ = glm::max(peak_, r);
      surface_.base = glm::max(surface_.base, varied_ ? r + d / (1 - kDielectric) : base_of(d, r));
    }
    surface_.base = glm::min(surface_.base, Vec3(1));
    if (form_ == Form::mixture && !varied_)
      surface_.metallic = mixture_of(diffuse(Vec3(1), pattern_.mean()),
                                     reflectance(Vec3(1), pattern_.mean()), kDielectric)
                              .metallic;
    if (form_ == Form::dielectric) write_dielectric(peak_);
    if (form_ == Form::diffuse) surface_.specular = 0;
    if (m_.coat) {
      surface_.clearcoat =
          materials::gltf_coat_strength(m_) * (pattern_.drawn() ? 1 : 1 - pattern_.mean().z);
      surface_.clearcoat_roughness = unit(std::sqrt(m_.coat->alpha));
    }
  }

  // One index with a strength where it is so, else the reflectance as a colour over that of 1.5.
  void write_dielectric(const Vec3& reflectance) {
    const Vec3 strength = m_.weights.y * m_.specular;
    const bool one = m_.refract && m_.extinction == Vec3(0) && !mapped() && !m_.coat && !m_.cells &&
                     strength.x == strength.y && strength.x == strength.z && strength.x <= 1 &&
                     m_.refract->x == m_.refract->y && m_.refract->x == m_.refract->z;
    if (one && m_.refract->x >= 1) {
      surface_.ior = m_.refract->x;
      surface_.specular = strength.x;
    } else {
      surface_.specular_color = reflectance / kDielectric;
      // ours and glTF's differ by rounding where a file came from glTF
      if (max_component(glm::abs(surface_.specular_color - Vec3(1))) < 2e-3)
        surface_.specular_color = Vec3(1);
    }
  }

  // ---- textures

  ordered_json texture_info(std::size_t place, const Vec2& repeat) {
    ordered_json info = {{"index", place}};
    if (repeat != Vec2(1)) {
      extensions.insert("KHR_texture_transform");
      // ours turns about the bottom left corner
      info["extensions"]["KHR_texture_transform"] = {{"offset", {0.0, 1 - repeat.y}},
                                                     {"scale", {repeat.x, repeat.y}}};
    }
    return info;
  }

  // The texture that is the base colour but for a factor; −1: it has to be computed, or is none.
  std::int32_t plain_texture() const {
    const bool metal = form_ == Form::metal;
    if (form_ == Form::mixture || (!metal && (m_.coat || m_.cells || mapped()))) return -1;
    const std::int32_t only = metal ? (mapped() && !m_.coat && !m_.cells ? maps_.reflectance : -1)
                                    : (colors_.size() == 1 ? colors_[0] : -1);
    return maps_.cutout < 0 || maps_.cutout == only ? only : -1;
  }

  std::ptrdiff_t copied(std::int32_t texture, Channel channel) {
    return static_cast<std::ptrdiff_t>(textures_.copied(texture, channel));
  }

  struct Wanted {
    bool base = false;
    bool specular = false;  // KHR_materials_specular's colour
    bool rough = false;     // metallic and roughness
    bool coat = false;      // KHR_materials_clearcoat's strength
  };

  void write_textures() {
    const bool metal = form_ == Form::metal;
    const std::int32_t plain = plain_texture();
    if (plain >= 0) base_texture_ = copied(plain, Channel::color);
    Wanted wanted;
    const bool depends = metal ? mapped() : colored() || (mapped() && form_ != Form::diffuse);
    wanted.base = plain < 0 && (depends || pattern_.drawn() || has_map(maps_.cutout));
    wanted.specular = form_ == Form::dielectric && (mapped() || pattern_.drawn());
    wanted.coat = pattern_.drawn() && m_.coat;
    wanted.rough = shines_ && (has_map(maps_.roughness) || varied_);
    if (wanted.base || wanted.specular || wanted.rough || wanted.coat) bake(wanted);
    if (has_map(maps_.normal)) normal_texture_ = copied(maps_.normal, Channel::number);
    write_json();
  }

  void bake(const Wanted& wanted) {
    const bool whole = wanted.base || wanted.specular || varied_;
    const auto at = [&](std::size_t i) {
      return textures_.source(whole && i < colors_.size() ? colors_[i] : -1);
    };
    const image::BakeSource sources[] = {
        at(0),
        at(1),
        textures_.source(whole && mapped() ? maps_.reflectance : -1),
        textures_.source(wanted.rough ? maps_.roughness : -1),
        textures_.source(wanted.base ? maps_.cutout : -1),
        pattern_.source()};
    // base, specular colour, metal and roughness, coat
    constexpr bool kCodes[] = {true, true, false, false};
    const Vec3 peak = glm::max(peak_, Vec3(1e-9));
    const Vec3 factor = glm::max(surface_.base, Vec3(1e-9));
    const bool cut = has_map(maps_.cutout);
    image::Baked made = image::baked(
        sources, kCodes,
        [&](std::span<const Vec4> from, std::span<Vec4> to) {
          const Vec3 shares = pattern_.shares(from[5]);
          const Vec3 d = diffuse(Vec3(from[0]) * Vec3(from[1]), shares);
          const Vec3 r = reflectance(Vec3(from[2]), shares);
          double metallic = 1;
          Vec3 base;
          if (form_ == Form::mixture && varied_) {
            const Mixture mixture = mixture_of(d, r, kDielectric, 255);
            base = mixture.base;
            metallic = mixture.metallic;
          } else {
            base = base_of(d, r);
          }
          to[0] = Vec4(base / factor, cut ? from[4].w : 1);
          to[1] = Vec4(r / peak, 1);
          to[2] = Vec4(1, std::sqrt(from[3].x), metallic, 1);
          to[3] = Vec4(Vec3(1 - shares.z), 1);
        },
        job_);
    const auto add = [&](std::size_t i, const char* what) {
      return static_cast<std::ptrdiff_t>(
          textures_.added(m_.name + what, made.width, made.height, std::move(made.textures[i])));
    };
    if (wanted.base) base_texture_ = add(0, ".base");
    if (wanted.specular) specular_texture_ = add(1, ".specular");
    if (wanted.rough) rough_texture_ = add(2, ".roughness");
    if (wanted.coat) coat_texture_ = add(3, ".coat");
  }

  // ---- the JSON

  void write_json() {
    json = {{"name", m_.name}};
    ordered_json pbr;
    pbr["baseColorFactor"] = {unit(surface_.base.x), unit(surface_.base.y), unit(surface_.base.z),
                              1.0};
    const auto info = [&](std::ptrdiff_t place, const Vec2& repeat) {
      return texture_info(static_cast<std::size_t>(place), repeat);
    };
    if (base_texture_ >= 0) pbr["baseColorTexture"] = info(base_texture_, color_repeat_);
    pbr["metallicFactor"] = surface_.metallic;
    pbr["roughnessFactor"] = surface_.roughness;
    if (rough_texture_ >= 0)
      pbr["metallicRoughnessTexture"] =
          info(rough_texture_, has_map(maps_.roughness) ? maps_.repeat : color_repeat_);
    json["pbrMetallicRoughness"] = std::move(pbr);
    if (normal_texture_ >= 0) json["normalTexture"] = info(normal_texture_, maps_.repeat);
    if (has_map(maps_.cutout)) {
      json["alphaMode"] = "MASK";
      json["alphaCutoff"] = maps_.threshold;
    }
    ordered_json more = ordered_json::object();
    if (surface_.ior != 1.5) more["KHR_materials_ior"] = {{"ior", surface_.ior}};
    ordered_json specular = ordered_json::object();
    if (surface_.specular != 1) specular["specularFactor"] = unit(surface_.specular);
    const Vec3& color = surface_.specular_color;
    if (color != Vec3(1)) specular["specularColorFactor"] = {color.x, color.y, color.z};
    if (specular_texture_ >= 0)
      specular["specularColorTexture"] = info(specular_texture_, color_repeat_);
    if (!specular.empty()) more["KHR_materials_specular"] = std::move(specular);
    if (surface_.clearcoat > 0) {
      ordered_json& coat = more["KHR_materials_clearcoat"];
      coat = {{"clearcoatFactor", unit(surface_.clearcoat)},
              {"clearcoatRoughnessFactor", surface_.clearcoat_roughness}};
      if (coat_texture_ >= 0) coat["clearcoatTexture"] = info(coat_texture_, color_repeat_);
    }
    write_emission(more);
    for (const auto& [name, value] : more.items()) extensions.insert(name);
    if (!more.empty()) json["extensions"] = std::move(more);
  }

  void write_emission(ordered_json& more) {
    const Vec3 emissive = m_.weights.z * m_.emissive;
    const double brightest = max_component(emissive);
    if (!(brightest > 0)) return;
    json["emissiveFactor"] = list(brightest > 1 ? emissive / brightest : emissive);
    if (brightest > 1) more["KHR_materials_emissive_strength"] = {{"emissiveStrength", brightest}};
  }

  // ---- what is lost

  void name_losses() {
    const auto slopes = materials::slopes_of(m_);
    const SpecularModel model = m_.specular_model();
    if (m_.diffuse_model() != DiffuseModel::lambert && m_.weights.x > 0)
      named_.insert("diffuse BRDFs other than Lambert's");
    if (shines_ && slopes && slopes->x != slopes->y)
      named_.insert("slopes that differ along u and v");
    if (shines_ && model != SpecularModel::ggx && model != SpecularModel::mirror)
      named_.insert("specular BRDFs other than GGX");
    if (m_.cells && !pattern_.drawn()) named_.insert("the pattern of solar cells");
    if (m_.cells && m_.cells->tilt != Vec2(0)) named_.insert("the tilt of solar cells");
    if (m_.coat && (m_.coat->index != 1.5 || m_.coat->depth != Vec3(0)))
      named_.insert("index and depth of coats");
    if (shines_ && materials::brdf_model_of(m_).compensated)
      named_.insert("multiple scattering between microfacets");
  }

  void measure() {
    takes_colors = form_ != Form::metal;
    mixes_colors = form_ == Form::mixture;
    name_losses();
    // of the mean texels, as parts() has them
    GltfSurface middle = surface_;
    const Vec3 shares = pattern_.drawn() ? Vec3(1, 0, 0) : pattern_.mean();
    const Vec3 d = diffuse(mean_color_, shares), r = reflectance(mean_texel_, shares);
    middle.base = glm::min(base_of(d, r), Vec3(1));
    if (form_ == Form::mixture) middle.metallic = mixture_of(d, r, kDielectric).metallic;
    if (form_ == Form::dielectric && surface_.specular_color != Vec3(1))
      middle.specular_color = r / kDielectric;
    middle.roughness *= std::sqrt(mean_roughness_);
    double share = materials::changed_share(parts(), middle) + flattened_;
    if (form_ == Form::mixture && varied_)
      share += mixture_error() / std::max(mean(mean_diffuse_ + mean_reflectance_), 1e-6);
    if (named_.empty() && share > kWorthSaying)
      named_.insert(
          "exact Fresnel reflectances (it uses Schlick's approximation, which also attenuates "
          "diffuse light)");
    for (const std::string& what : named_) lost[what] = share;
  }

  std::vector<SurfacePart> parts() const {
    std::vector<SurfacePart> all = parts_;
    if (all.empty() || pattern_.drawn()) all = {{m_, 1, {}}};
    for (SurfacePart& part : all) {
      Material& m = part.material;
      m.cells.reset();
      if (m.maps.reflectance >= 0) part.reflectance = mean_texel_;
      if (&part == &all.front()) m.diffuse *= tint_ * mean_color_;
      const auto slopes = materials::slopes_of(m);
      if (!slopes || mean_roughness_ == 1) continue;
      m.specular_brdf = materials::with_slopes(m.specular_model(),
                                               glm::max(*slopes * mean_roughness_, Vec2(1e-6)));
      materials::fit(m);
    }
    return all;
  }

  TexturePool& textures_;
  const Job& job_;
  Material m_;
  materials::Maps maps_;              // those that lie over the surface
  std::vector<std::int32_t> colors_;  // textures over the diffuse colour, 0 to 2
  Vec2 color_repeat_{1};              // of what the colours are laid on by
  Vec3 tint_{1};                      // mean of a texture that cannot be laid on
  double flattened_ = 0;              // share of the diffuse light that it moved
  DiffuseCurve curve_;
  std::vector<SurfacePart> parts_;                // of cells
  CellPattern pattern_;                           // shares of cells, grid lines and gaps
  std::array<Vec3, 2> others_{Vec3(0), Vec3(0)};  // diffuse albedos of grid lines and gaps
  Vec3 peak_{0};                                  // reflectance without its texture
  bool shines_ = false;
  double slope_ = 1;
  std::vector<std::pair<Vec3, Vec3>> samples_;  // diffuse albedo and reflectance
  Vec3 mean_diffuse_{0}, mean_reflectance_{0}, mean_color_{0}, mean_texel_{0};
  double mean_roughness_ = 1;
  Form form_ = Form::diffuse;
  bool varied_ = false;  // metal comes from a texture
  GltfSurface surface_;
  std::ptrdiff_t base_texture_ = -1, specular_texture_ = -1, rough_texture_ = -1,
                 coat_texture_ = -1, normal_texture_ = -1;
  std::set<std::string> named_;
};

}  // namespace

std::size_t MaterialWriter::place(std::size_t material, std::int32_t texture, bool has_texcoords,
                                  Faces faces) {
  const auto [known, is_new] = places_.try_emplace(
      {material, texture, has_texcoords, faces == Faces::one_side}, json_.size());
  const std::size_t at = known->second;
  if (is_new) {
    job_.poll();
    Translation done(
        textures_, job_,
        pan::material_from(model_.materials()[material], model_.material_name(material)), texture,
        has_texcoords);
    json_.push_back(std::move(done.json));
    takes_colors_.push_back(done.takes_colors);
    mixes_colors_.push_back(done.mixes_colors);
    extensions_.merge(done.extensions);
    for (const auto& [what, share] : done.lost) lose(what, share, model_.material_name(material));
  }
  if (faces == Faces::both) json_[at]["doubleSided"] = true;
  return at;
}

void MaterialWriter::note_colors(std::size_t place) {
  if (mixes_colors_[place])
    lose("vertex colours of diffuse light only", 1, json_[place]["name"].get<std::string>());
  mixes_colors_[place] = false;
}

void MaterialWriter::lose(const std::string& what, double share, std::string_view name) {
  Loss& loss = losses_[what];
  ++loss.materials;
  if (loss.materials > 1 && share <= loss.share) return;
  loss.share = share;
  loss.worst = name;
}

}  // namespace panwright::exporters
