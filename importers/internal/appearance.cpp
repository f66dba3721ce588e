#include "importers/internal/appearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "base/text.h"
#include "image/decode.h"
#include "image/srgb.h"
#include "importers/internal/lost.h"
#include "importers/internal/storable.h"

namespace panwright::importers {

namespace {

constexpr std::size_t kMostNamed = 8;  // materials in one message
constexpr const char* kOpacity = "opacity";
constexpr double kSumRounding = 1e-9;

bool has_alpha(const scene::Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
    if (texture.rgba[i] != 255) return true;
  return false;
}

// Largest linear value of each channel.
Vec3 brightest(const scene::Texture& texture) {
  std::array<std::uint8_t, 3> most{};
  for (std::size_t i = 0; i + 3 < texture.rgba.size(); i += 4)
    for (std::size_t k = 0; k < 3; ++k) most[k] = std::max(most[k], texture.rgba[i + k]);
  Vec3 out;
  for (std::size_t k = 0; k < 3; ++k)
    out[static_cast<int>(k)] =
        texture.linear ? static_cast<double>(most[k]) / 255 : image::srgb_decoded(most[k]);
  return out;
}

class AppearanceRules {
 public:
  AppearanceRules(Imported& imported, const std::string& name, DiagnosticLog& log)
      : scene_(imported.scene),
        cads_(imported.materials),
        // the reader of glTF knows in which materials the alpha of textures counts
        texture_alpha_(imported.format != Format::gltf),
        is_robot_(imported.format == Format::urdf || imported.format == Format::mjcf),
        name_(name),
        log_(log),
        alphas_(scene_.textures.size(), kUnknown) {}

  void apply() {
    leave_out_invisible();
    mark_see_through();
    limit_energy();
    // materials of robots themselves have none, and those of their meshes are known
    if (!is_robot_) check_normals();
  }

 private:
  enum : char { kUnknown, kOpaque, kAlpha };

  std::string name_of(std::size_t material) const {
    const std::string& name = cads_[material].name;
    return name.empty() ? fmt::format("#{}", material + 1)
                        : in_quotes(to_utf8(name, Encoding::utf8));
  }

  static std::string listed(const std::vector<std::string>& parts) {
    const std::size_t count = std::min(parts.size(), kMostNamed);
    std::string out = fmt::format(
        "{}", fmt::join(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count), ", "));
    if (parts.size() > count) out += fmt::format(" and {} more", parts.size() - count);
    return out;
  }

  // Materials of a message, and the first of them that has a place.
  struct Named {
    std::vector<std::string> parts;
    const CadMaterial* first = nullptr;
    void add(const CadMaterial& cad, std::string part) {
      parts.push_back(std::move(part));
      if (first == nullptr || is_before(cad.where, first->where)) first = &cad;
    }
  };

  void report(Code code, const Named& named, const char* message) {
    if (named.parts.empty()) return;
    if (named.first->where.file == kNoFile)
      log_.report_file(code, name_, message + listed(named.parts));
    else
      log_.report(code, named.first->where, message + listed(named.parts), {}, named.first->object);
  }

  double opacity_of(std::int32_t material) const {
    return material == scene::kNone ? 0 : cads_[static_cast<std::size_t>(material)].opacity;
  }

  void leave_out_invisible() {
    const auto is_invisible = [&](const scene::Instance& one) {
      return opacity_of(one.material) <= 0 && opacity_of(one.back) <= 0;
    };
    const std::size_t before = scene_.instances.size();
    if (std::ranges::any_of(scene_.instances, is_invisible)) remove_instances(scene_, is_invisible);
    if (const std::size_t count = before - scene_.instances.size(); count > 0)
      log_.report_file(Code("N6007"), name_,
                       fmt::format("{} of opacity 0 left out", counted(count, "part")));
  }

  bool is_alpha(std::int32_t texture) {
    if (texture == scene::kNone || !texture_alpha_) return false;
    char& known = alphas_[static_cast<std::size_t>(texture)];
    if (known == kUnknown)
      known = has_alpha(scene_.textures[static_cast<std::size_t>(texture)]) ? kAlpha : kOpaque;
    return known == kAlpha;
  }

  // Whether something shows through a material, by itself or by its texture.
  bool is_see_through(std::int32_t material, std::int32_t texture) {
    if (material == scene::kNone) return false;
    const CadMaterial& cad = cads_[static_cast<std::size_t>(material)];
    const materials::Maps& maps = scene_.materials[static_cast<std::size_t>(material)].maps;
    return cad.opacity < 1 || cad.see_through || is_alpha(texture) ||
           (maps.cutout < 0 && is_alpha(maps.albedo));
  }

  void mark_see_through() {
    std::set<std::int32_t> found;
    for (scene::Instance& one : scene_.instances) {
      one.see_through = false;
      for (const std::int32_t material : {one.material, one.back})
        if (is_see_through(material, one.texture)) {
          one.see_through = true;
          found.insert(material);
        }
    }
    Named named;
    for (const std::int32_t material : found) {
      const auto index = static_cast<std::size_t>(material);
      CadMaterial& cad = cads_[index];
      if (std::ranges::find(cad.lost, kOpacity, &LostProperty::what) != cad.lost.end()) continue;
      cad.lost.push_back({kOpacity, cad.where});
      named.add(cad, cad.opacity < 1 ? fmt::format("{} ({:.3g})", name_of(index), cad.opacity)
                                     : name_of(index));
    }
    // a reader may have a material in several versions
    std::ranges::sort(named.parts);
    named.parts.erase(std::unique(named.parts.begin(), named.parts.end()), named.parts.end());
    report(Code("W6008"), named, "unsupported: opacity, drawn opaque: ");
  }

  // Lobes without a Fresnel term reflect their colour in all directions; the others share the light
  // with the diffuse part in their readers.
  void limit_energy() {
    Named named;
    std::vector<Vec3> factors;
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      materials::Material& m = scene_.materials[i];
      if (m.specular_model() != materials::SpecularModel::blinn_phong) continue;
      Vec3 diffuse = m.weights.x * m.diffuse;
      const auto sum = [&] {
        const Vec3 both = diffuse + m.weights.y * m.specular;
        return std::max({both.x, both.y, both.z});
      };
      if (sum() > 1 + kSumRounding) {
        if (factors.empty()) factors = diffuse_factors();
        diffuse *= factors[i];
        if (m.maps.albedo >= 0)
          diffuse *= brightest(scene_.textures[static_cast<std::size_t>(m.maps.albedo)]);
      }
      const double most = sum();
      if (!(most > 1 + kSumRounding)) continue;
      m.diffuse /= most;
      m.specular /= most;
      materials::fit(m);
      named.add(cads_[i], fmt::format("{} ({:.3g})", name_of(i), most));
    }
    report(Code("W1402"), named,
           "diffuse and specular colours add up to more than 1, and are scaled to 1, in ");
  }

  // Of each material, the largest factor of its diffuse colour: vertex colours, and textures of
  // instances.
  std::vector<Vec3> diffuse_factors() const {
    std::vector<Vec3> out(scene_.materials.size(), Vec3(0));
    std::vector<Vec3> colors, textures(scene_.textures.size(), Vec3(-1));
    for (const geometry::Shape& shape : scene_.shapes) {
      const auto* mesh = std::get_if<geometry::MeshShape>(&shape);
      Vec3& most = colors.emplace_back(1);
      if (mesh == nullptr || (*mesh)->colors.empty()) continue;
      most = Vec3(0);
      for (const Vec3& color : (*mesh)->colors) most = glm::max(most, color);
    }
    for (const scene::Instance& one : scene_.instances) {
      Vec3 factor = colors[static_cast<std::size_t>(one.shape)];
      if (one.texture != scene::kNone) {
        const auto index = static_cast<std::size_t>(one.texture);
        if (textures[index].x < 0) textures[index] = brightest(scene_.textures[index]);
        factor *= textures[index];
      }
      Vec3& front = out[static_cast<std::size_t>(one.material)];
      front = glm::max(front, factor);
      if (one.back != scene::kNone) out[static_cast<std::size_t>(one.back)] = Vec3(1);
    }
    return out;
  }

  void check_normals() {
    std::set<std::int32_t> maps;
    for (const materials::Material& m : scene_.materials)
      if (m.maps.normal >= 0) maps.insert(m.maps.normal);
    for (const std::int32_t map : maps) {
      const scene::Texture& texture = scene_.textures[static_cast<std::size_t>(map)];
      if (const auto problem = image::normal_map_problem(texture.rgba))
        log_.report_file(Code("W3003"), name_,
                         fmt::format("{}: {}", in_quotes(texture.name), *problem));
    }
  }

  scene::Scene& scene_;
  std::vector<CadMaterial>& cads_;
  const bool texture_alpha_;
  const bool is_robot_;
  const std::string& name_;
  DiagnosticLog& log_;
  std::vector<char> alphas_;  // of each texture
};

}  // namespace

void settle_appearance(Imported& imported, const std::string& name, DiagnosticLog& log) {
  AppearanceRules(imported, name, log).apply();
}

}  // namespace panwright::importers
