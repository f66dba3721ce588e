#include "importers/gltf/materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "materials/gltf_surface.h"

namespace panwright::importers::gltf {

namespace {

using tinygltf::Value;

// slopes below it are smoother than the Sun's disc lets anyone see
constexpr double kSmoothest = 1e-4;
// reflectances above it are taken for a perfect mirror's
constexpr double kMirror = 0.985;
// Under a reflectance map, of the material's own. Metals of other reflectances rise towards grazing
// in other ways than Schlick's curve; of this one the rise (F − F0)/(1 − F0) is within 0.0073 of
// it, so that what the map says follows it as closely, dark or bright.
constexpr double kUnderMaps = 0.66;

Vec3 color_from(const std::vector<double>& numbers, Vec3 otherwise) {
  return numbers.size() >= 3 ? Vec3(numbers[0], numbers[1], numbers[2]) : otherwise;
}

// One extension of a material; what it does not give has its default.
class Extension {
 public:
  Extension(const tinygltf::Material& material, const std::string& name) {
    const auto found = material.extensions.find(name);
    if (found != material.extensions.end()) value_ = &found->second;
  }
  explicit operator bool() const { return value_ != nullptr; }

  double number(const std::string& key, double otherwise) const {
    return value_ && value_->Has(key) ? value_->Get(key).GetNumberAsDouble() : otherwise;
  }
  static constexpr double kLargest = 2147483648.0;
  Vec3 color(const std::string& key, Vec3 otherwise) const {
    if (!value_ || !value_->Has(key)) return otherwise;
    const Value& list = value_->Get(key);
    for (int k = 0; k < 3; ++k) {
      const double number = list.Get(k).GetNumberAsDouble();
      // tinygltf keeps whole numbers as int, which large ones overflow; none is negative in a file
      otherwise[k] = number < 0 ? kLargest : number;
    }
    return otherwise;
  }
  double fourth(const std::string& key, double otherwise) const {
    return value_ && value_->Has(key) && value_->Get(key).ArrayLen() > 3
               ? value_->Get(key).Get(3).GetNumberAsDouble()
               : otherwise;
  }
  bool has(const std::string& key) const { return value_ && value_->Has(key); }
  tinygltf::TextureInfo texture(const std::string& key) const {
    tinygltf::TextureInfo info;
    if (!has(key)) return info;
    const Value& value = value_->Get(key);
    info.index = value.Get("index").GetNumberAsInt();
    if (value.Has("texCoord")) info.texCoord = value.Get("texCoord").GetNumberAsInt();
    if (value.Has("extensions"))
      for (const std::string& name : value.Get("extensions").Keys())
        info.extensions[name] = value.Get("extensions").Get(name);
    return info;
  }

 private:
  const Value* value_ = nullptr;
};

template <class Info>
TexcoordChoice choice_of(const Info& info) {
  TexcoordChoice choice;
  choice.set = info.texCoord;
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return choice;
  const Value& transform = found->second;
  const auto pair = [&](const char* key, Vec2 otherwise) {
    if (!transform.Has(key)) return otherwise;
    return Vec2(transform.Get(key).Get(0).GetNumberAsDouble(),
                transform.Get(key).Get(1).GetNumberAsDouble());
  };
  choice.offset = pair("offset", Vec2(0));
  choice.scale = pair("scale", Vec2(1));
  if (transform.Has("rotation")) choice.rotation = transform.Get("rotation").GetNumberAsDouble();
  if (transform.Has("texCoord")) choice.set = transform.Get("texCoord").GetNumberAsInt();
  return choice;
}

double schlick(double f0, double cosine) {
  const double x = 1 - cosine, x2 = x * x;
  return f0 + (1 - f0) * x2 * x2 * x;
}

// Unpolarised reflectance of a conductor, exact. R. Cook, K. Torrance 1982.
double reflectance(double cosine, double n, double k) {
  const double sin2 = (1 - cosine) * (1 + cosine), d = n * n - k * k - sin2, nk = 2 * n * k;
  const double size = std::sqrt(d * d + nk * nk);
  const double a = std::sqrt(std::max(0.5 * (size + d), 1e-30)), b = 0.5 * nk / a;
  const double rs = ((cosine - a) * (cosine - a) + b * b) / ((cosine + a) * (cosine + a) + b * b);
  const double t = sin2 / std::max(cosine, 1e-10);
  return 0.5 * rs * (1 + ((a - t) * (a - t) + b * b) / ((a + t) * (a + t) + b * b));
}

double index_of_reflectance(double f0) {
  const double root = std::sqrt(std::min(f0, 0.98));
  return (1 + root) / (1 - root);
}

// ---- the parts of a material

struct Look {
  Vec3 base{1};
  double metallic = 1;
  double roughness = 1;
  double index = 1.5;
  double specular = 1;     // KHR_materials_specular
  Vec3 specular_color{1};  // the same
  std::optional<Vec3> f0;  // KHR_materials_pbrSpecularGlossiness gives it as it is

  // Reflectance at normal incidence of what is no metal.
  Vec3 dielectric() const {
    if (f0) return *f0;
    const double root = (index - 1) / (index + 1);
    return specular * glm::min((index > 0 ? root * root : 1.0) * specular_color, Vec3(1));
  }
};

class MaterialBuilder {
 public:
  // ours: of a file that we wrote, whose coats were ours
  MaterialBuilder(const tinygltf::Material& from, std::string name, bool with_textures, bool ours,
                  TextureReader& textures)
      : from_(from), texture_cache_(textures), with_textures_(with_textures), ours_(ours) {
    out_.cad.name = from.name;
    out_.material.name = std::move(name);
  }

  BuiltMaterial build() {
    Look look = read_look();
    read_maps(look);
    set_brdfs(look);
    set_emission();
    set_coat(look);
    set_opacity();
    list_lost();
    out_.cad.base_color = look.base;
    out_.cad.metallic = look.metallic;
    out_.cad.roughness = look.roughness;
    materials::fit(out_.material);
    return out_;
  }

 private:
  void lose(std::string what) { out_.cad.lost.push_back({std::move(what), {}}); }

  Look read_look() {
    Look look;
    const Extension glossy(from_, "KHR_materials_pbrSpecularGlossiness");
    if (glossy) {
      look.base = glossy.color("diffuseFactor", Vec3(1));
      alpha_ = glossy.fourth("diffuseFactor", 1);
      look.metallic = 0;
      look.roughness = 1 - glossy.number("glossinessFactor", 1);
      look.f0 = glossy.color("specularFactor", Vec3(1));
      base_texture_ = glossy.texture("diffuseTexture");
      gloss_texture_ = glossy.texture("specularGlossinessTexture");
      return look;
    }
    const tinygltf::PbrMetallicRoughness& pbr = from_.pbrMetallicRoughness;
    look.base = color_from(pbr.baseColorFactor, Vec3(1));
    if (pbr.baseColorFactor.size() == 4) alpha_ = pbr.baseColorFactor[3];
    look.metallic = pbr.metallicFactor;
    look.roughness = pbr.roughnessFactor;
    base_texture_ = pbr.baseColorTexture;
    rough_texture_ = pbr.metallicRoughnessTexture;
    look.index = Extension(from_, "KHR_materials_ior").number("ior", 1.5);
    const Extension specular(from_, "KHR_materials_specular");
    look.specular = specular.number("specularFactor", 1);
    look.specular_color = specular.color("specularColorFactor", Vec3(1));
    if (specular.has("specularTexture") || specular.has("specularColorTexture"))
      lose("specular textures");
    return look;
  }

  // Whether a texture lies over the coordinates that the surface gets; others are lost.
  template <class Info>
  bool lies_right(const Info& info, const char* name) {
    if (info.index < 0 || !with_textures_) return false;
    const TexcoordChoice choice = choice_of(info);
    if (out_.texcoords.set < 0) out_.texcoords = choice;
    if (choice == out_.texcoords) {
      const std::array<bool, 2> repeats = texture_cache_.repeats(info.index);
      for (std::size_t k = 0; k < 2; ++k) out_.repeats[k] = out_.repeats[k] && repeats[k];
      return true;
    }
    lose(fmt::format("{} texture, over other coordinates than the first", name));
    return false;
  }

  void read_maps(Look& look) {
    materials::Maps& maps = out_.material.maps;
    out_.cad.textured = base_texture_.index >= 0;
    const bool has_base = lies_right(base_texture_, "base colour");
    if (lies_right(from_.normalTexture, "normal")) read_normals();
    const bool has_rough = lies_right(rough_texture_, "roughness");
    if (has_rough)
      maps.roughness = texture_cache_.texture(rough_texture_.index, TextureUse::roughness);
    const bool has_gloss = lies_right(gloss_texture_, "specular-glossiness");
    if (has_gloss) {
      read_gloss(look, has_base);
    } else {
      read_metal(look, has_base, has_rough);
    }
    if (!mapped_ && has_base)
      maps.albedo = texture_cache_.texture(base_texture_.index, TextureUse::color);
    if (from_.alphaMode == "MASK" && has_base) {
      maps.cutout = maps.albedo >= 0
                        ? maps.albedo
                        : texture_cache_.texture(base_texture_.index, TextureUse::color);
      maps.threshold = std::clamp(from_.alphaCutoff / std::max(alpha_, 1e-6), 0.0, 1.0);
    }
  }

  void read_normals() {
    materials::Maps& maps = out_.material.maps;
    const int index = from_.normalTexture.index;
    const double scale = from_.normalTexture.scale;
    if (scale != 1) {
      if (const auto made = texture_cache_.normals(index, scale)) {
        maps.normal = *made;
        return;
      }
      lose("scale of the normal texture");
    }
    maps.normal = texture_cache_.texture(index, TextureUse::normal);
  }

  void use(const RecipeTextures& textures) {
    materials::Maps& maps = out_.material.maps;
    mapped_ = true;
    maps.albedo = textures.albedo;
    maps.reflectance = textures.reflectance;
    if (textures.roughness >= 0) maps.roughness = textures.roughness;
  }

  // Metals take their colour as reflectance. Without room for the textures, or where they lie over
  // other coordinates, means stand for them.
  void read_metal(Look& look, bool has_base, bool has_rough) {
    const double factor = look.metallic;
    const Vec4 parts = texture_cache_.mean(rough_texture_.index, false);
    look.metallic *= parts.z;
    if (!(look.metallic > 0)) return;
    const bool even = texture_cache_.is_even(rough_texture_.index, 2);
    const bool one_place = (has_base || base_texture_.index < 0) && (has_rough || even);
    if (with_textures_ && one_place && (has_base || !even)) {
      MetalRecipe recipe;
      if (has_base) recipe.base = base_texture_.index;
      if (!even) recipe.metal = rough_texture_.index;
      recipe.factor = look.base;
      recipe.metallic = even ? look.metallic : factor;
      recipe.dielectric = look.dielectric();
      if (const auto made = texture_cache_.metal(recipe)) {
        use(*made);
        metal_in_albedo_ = !even;
        return;
      }
    }
    if (!even) lose("metallic texture; its mean is used");
    if (base_texture_.index < 0) return;
    metal_colour_ = Vec3(texture_cache_.mean(base_texture_.index, true));
    if (with_textures_) lose("base colour texture on metal; its mean is used");
  }

  void read_gloss(Look& look, bool has_base) {
    GlossRecipe recipe;
    if (has_base) recipe.diffuse = base_texture_.index;
    recipe.specular = gloss_texture_.index;
    recipe.factor = *look.f0;
    recipe.glossiness = 1 - look.roughness;
    if (const auto made = texture_cache_.gloss(recipe)) {
      use(*made);
      return;
    }
    lose("specular-glossiness texture");
  }

  // glTF 2.0 specification, appendix B: a dielectric and a metal, mixed. Facets are the same as
  // there; Schlick's curve becomes the reflectance of a refractive index.
  void set_brdfs(const Look& look) {
    materials::Material& m = out_.material;
    const Vec3 dielectric = look.dielectric();
    const double largest = std::max({dielectric.x, dielectric.y, dielectric.z});
    m.diffuse = look.base;
    // what the albedo's texture says already
    if (!metal_in_albedo_) m.diffuse *= 1 - look.metallic;
    if (!look.f0)
      m.diffuse *= Vec3(1) - dielectric;
    else if (!mapped_)
      m.diffuse *= 1 - largest;
    const double alpha = std::max(look.roughness * look.roughness, kSmoothest);
    m.compensation = materials::Compensation::off;
    if (!mapped_ && look.metallic <= 0 && largest <= 0) return;
    m.specular_brdf = materials::Ggx{alpha, alpha};
    m.weights.y = 1;
    m.specular = Vec3(1);
    if (mapped_) {
      set_reflectance(Vec3(kUnderMaps));
      // of glossiness, the texture has the slopes
      if (look.f0) m.specular_brdf = materials::Ggx{1, 1};
      return;
    }
    if (look.metallic <= 0 && !look.f0) {
      m.specular = Vec3(look.specular);
      Vec3 n(look.index);
      if (look.specular_color != Vec3(1) || look.index <= 0)
        for (int k = 0; k < 3; ++k)
          n[k] = index_of_reflectance(dielectric[k] / std::max(look.specular, 1e-12));
      m.refract = n;
      return;
    }
    const Vec3 f0 = glm::mix(dielectric, look.base * metal_colour_, look.metallic);
    set_reflectance(f0);
  }

  void set_reflectance(const Vec3& f0) {
    materials::Material& m = out_.material;
    if (std::min({f0.x, f0.y, f0.z}) >= kMirror) {
      m.specular = f0;  // F = 1
      return;
    }
    Vec3 n(1);
    for (int k = 0; k < 3; ++k) {
      const ComplexIndex index = index_like_schlick(f0[k]);
      n[k] = index.n;
      m.extinction[k] = index.k;
    }
    m.refract = n;
  }

  void set_emission() {
    Vec3 emissive = color_from(from_.emissiveFactor, Vec3(0));
    emissive *= Extension(from_, "KHR_materials_emissive_strength").number("emissiveStrength", 1);
    if (emissive == Vec3(0)) return;
    if (const int texture = from_.emissiveTexture.index; texture >= 0) {
      // a mean would make all of the surface glow, where the file lights a few windows
      for (int channel = 0; channel < 3; ++channel)
        if (!texture_cache_.is_even(texture, channel)) {
          const Vec3 mean = emissive * Vec3(texture_cache_.mean(texture, true));
          lose(fmt::format("emissive texture of {:.2g} on average, nothing glows",
                           std::max({mean.x, mean.y, mean.z})));
          return;
        }
      emissive *= Vec3(texture_cache_.mean(texture, true));
    }
    out_.material.emissive = glm::min(emissive, Vec3(1e6));
    out_.material.weights.z = 1;
  }

  // What glTF says of the whole surface, textures by their means.
  materials::GltfSurface as_gltf(const Look& look, double strength, double roughness) {
    materials::GltfSurface surface;
    surface.base = look.base * Vec3(texture_cache_.mean(base_texture_.index, true));
    surface.metallic = look.metallic;
    surface.roughness = look.roughness * texture_cache_.mean(rough_texture_.index, false).y;
    surface.ior = look.index;
    surface.specular = look.specular;
    surface.specular_color = look.specular_color;
    surface.clearcoat = strength;
    surface.clearcoat_roughness = roughness;
    return surface;
  }

  // How much of the light a material of ours changes, with a mean diffuse colour.
  double changed(materials::Material m, const Vec3& diffuse,
                 const materials::GltfSurface& surface) {
    m.diffuse = diffuse;
    if (m.maps.roughness >= 0)
      m.specular_brdf = materials::Ggx{surface.roughness * surface.roughness + kSmoothest,
                                       surface.roughness * surface.roughness + kSmoothest};
    materials::fit(m);
    materials::SurfacePart part{std::move(m), 1, {}};
    if (part.material.maps.reflectance >= 0)
      part.reflectance = Vec3(texture_cache_.mean_of(part.material.maps.reflectance));
    part.material.weights.z = 0;
    return materials::changed_share(std::span(&part, 1), surface);
  }

  // Ours refracts and sends light back and forth: colours, reflectance and slopes below it become
  // those that look the same. Where that changes more of the light than no coat does, as over
  // metals, there is none.
  void set_coat(const Look& look) {
    const Extension coat(from_, "KHR_materials_clearcoat");
    double strength = coat.number("clearcoatFactor", 0);
    double roughness = coat.number("clearcoatRoughnessFactor", 0);
    if (!(strength > 0)) return;
    if (coat.has("clearcoatTexture") || coat.has("clearcoatRoughnessTexture"))
      lose("clearcoat textures; their means are used");
    if (coat.has("clearcoatNormalTexture") || out_.material.maps.normal >= 0)
      lose("clearcoat normals of their own");
    strength *= texture_cache_.mean(coat.texture("clearcoatTexture").index, false).x;
    roughness *= texture_cache_.mean(coat.texture("clearcoatRoughnessTexture").index, false).y;
    const materials::GltfSurface surface = as_gltf(look, strength, roughness);
    std::optional<materials::Material> coated;
    if (!mapped_ && !look.f0) coated = with_coat(look, strength, roughness);
    if (coated && ours_) {
      out_.material = *std::move(coated);
      return;
    }
    Vec3 diffuse = out_.material.diffuse;
    if (out_.material.maps.albedo >= 0)
      diffuse *= Vec3(texture_cache_.mean_of(out_.material.maps.albedo));
    const double without = changed(out_.material, diffuse, surface);
    double with = without;
    if (coated)
      with = changed(*coated, materials::diffuse_curve(*coated).inverse(diffuse), surface);
    out_.coat_changed = std::min(with, without);
    lose("clearcoat");
    if (coated && with < without) out_.material = *std::move(coated);
  }

  std::optional<materials::Material> with_coat(const Look& look, double strength,
                                               double roughness) {
    materials::Material m = out_.material;
    materials::Coat coat;
    coat.index = materials::coat_index_of_strength(strength);
    coat.alpha = roughness * roughness;
    m.coat = coat;
    const materials::DiffuseCurve curve = materials::diffuse_curve(m);
    if (m.maps.albedo >= 0) {
      const auto made = texture_cache_.below_coat(base_texture_.index, m.diffuse, curve);
      if (!made) return std::nullopt;
      m.maps.albedo = *made;
      if (m.maps.cutout >= 0) m.maps.cutout = *made;
      m.diffuse = Vec3(1);
    } else {
      m.diffuse = curve.inverse(m.diffuse);
    }
    if (const auto slopes = materials::slopes_of(m))
      m.specular_brdf = materials::Ggx{std::max(slopes->x / coat.index, kSmoothest),
                                       std::max(slopes->y / coat.index, kSmoothest)};
    if (!m.refract) return m;
    const bool metal = m.extinction != Vec3(0);
    const Vec3 dielectric = look.dielectric() / std::max(look.specular, 1e-12);
    const Vec3 f0 =
        metal ? glm::mix(look.dielectric(), look.base * metal_colour_, look.metallic) : dielectric;
    const Vec3 below = materials::reflectance_below_our_coat(coat, f0);
    Vec3 n(1);
    for (int k = 0; k < 3; ++k) {
      const ComplexIndex index =
          metal ? index_like_schlick(below[k]) : ComplexIndex{index_of_reflectance(below[k]), 0};
      n[k] = coat.index * index.n;
      m.extinction[k] = coat.index * index.k;
    }
    m.refract = n;
    return m;
  }

  void set_opacity() {
    out_.invisible = (from_.alphaMode == "BLEND" && alpha_ <= 0) ||
                     (from_.alphaMode == "MASK" && alpha_ < from_.alphaCutoff);
    if (out_.invisible) return;
    if (Extension(from_, "KHR_materials_transmission").number("transmissionFactor", 0) > 0) {
      lose("transmission");
      out_.cad.see_through = true;
    }
    if (from_.alphaMode != "BLEND") return;
    out_.cad.opacity = std::clamp(alpha_, 0.0, 1.0);
    if (texture_cache_.mean(base_texture_.index, false).w < 1) out_.cad.see_through = true;
  }

  void list_lost() {
    if (from_.occlusionTexture.index >= 0) lose("occlusion texture");
    const std::pair<const char*, const char*> names[] = {
        {"KHR_materials_unlit", "unlit"},
        {"KHR_materials_sheen", "sheen"},
        {"KHR_materials_volume", "volume"},
        {"KHR_materials_anisotropy", "anisotropy"},
        {"KHR_materials_iridescence", "iridescence"},
        {"KHR_materials_dispersion", "dispersion"},
        {"KHR_materials_diffuse_transmission", "diffuse transmission"},
        {"KHR_techniques_webgl", "shaders"}};
    for (const auto& [extension, what] : names)
      if (from_.extensions.contains(extension)) lose(what);
  }

  const tinygltf::Material& from_;
  TextureReader& texture_cache_;
  bool with_textures_;
  bool ours_;
  BuiltMaterial out_;
  double alpha_ = 1;
  Vec3 metal_colour_{1};
  bool mapped_ = false;  // has a reflectance map
  bool metal_in_albedo_ = false;
  tinygltf::TextureInfo base_texture_;
  tinygltf::TextureInfo gloss_texture_;
  tinygltf::TextureInfo rough_texture_;
};

}  // namespace

ComplexIndex index_like_schlick(double f0) {
  const double r = std::clamp(f0, 0.0, kMirror);
  if (!(r > 0)) return {};
  // all n and k of this reflectance lie between these two; which of them bends like Schlick's
  // curve?
  const double least = (1 - r) / (1 + r), most = index_of_reflectance(r);
  constexpr int kSteps = 100, kAngles = 45;
  ComplexIndex best;
  double smallest = 2;
  for (int step = 0; step <= kSteps; ++step) {
    const double n = most + (least - most) * step / kSteps;
    const double k =
        std::sqrt(std::max(0.0, (r * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - r)));
    double worst = 0;
    for (int i = 1; i <= kAngles && worst < smallest; ++i) {
      const double cosine = static_cast<double>(i) / kAngles;
      worst = std::max(worst, std::fabs(reflectance(cosine, n, k) - schlick(r, cosine)));
    }
    if (worst >= smallest) continue;
    smallest = worst;
    best = {n, k};
  }
  return best;
}

TexcoordChoice texcoords_of(const tinygltf::Model& model, int index) {
  if (index < 0) return {};
  const tinygltf::Material& material = model.materials[static_cast<std::size_t>(index)];
  if (const Extension glossy(material, "KHR_materials_pbrSpecularGlossiness"); glossy) {
    const tinygltf::TextureInfo diffuse = glossy.texture("diffuseTexture");
    if (diffuse.index >= 0) return choice_of(diffuse);
    if (material.normalTexture.index >= 0) return choice_of(material.normalTexture);
    const tinygltf::TextureInfo specular = glossy.texture("specularGlossinessTexture");
    return specular.index >= 0 ? choice_of(specular) : TexcoordChoice{};
  }
  const tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  if (pbr.baseColorTexture.index >= 0) return choice_of(pbr.baseColorTexture);
  if (material.normalTexture.index >= 0) return choice_of(material.normalTexture);
  if (pbr.metallicRoughnessTexture.index >= 0) return choice_of(pbr.metallicRoughnessTexture);
  return {};
}

BuiltMaterial material_of(const tinygltf::Model& model, int index, bool with_textures,
                          TextureReader& textures) {
  if (index < 0) {
    BuiltMaterial none;
    none.material.name = "none";
    materials::fit(none.material);
    return none;
  }
  const tinygltf::Material& from = model.materials[static_cast<std::size_t>(index)];
  const std::string name = from.name.empty() ? fmt::format("material{}", index) : from.name;
  const bool ours = model.asset.generator == "panwright";
  return MaterialBuilder(from, name, with_textures, ours, textures).build();
}

}  // namespace panwright::importers::gltf
