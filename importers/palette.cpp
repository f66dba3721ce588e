#include "importers/palette.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "base/text.h"
#include "geometry/mesh/check.h"
#include "image/srgb.h"

namespace panwright::importers {

namespace {

constexpr std::uint64_t kMostTexels = 4096;
constexpr std::size_t kMostColors = 256;
constexpr int kLossy = 16;  // 8-bit codes between texels of one colour, after lossy compression

using Code3 = std::array<std::uint8_t, 3>;
using Code6 = std::array<std::uint8_t, 6>;  // of the albedo and the reflectance map

struct Sample {
  Code3 code;
  Vec3 linear;
};

// The colour at a place, between the four texels around it as in an image; nothing where these
// differ by more than lossy compression makes them.
std::optional<Sample> color_at(const scene::Texture& image, const Vec2& at) {
  const double size[2] = {static_cast<double>(image.width), static_cast<double>(image.height)};
  // v grows upwards, rows downwards
  const double place[2] = {at.x * size[0] - 0.5, (1 - at.y) * size[1] - 0.5};
  Vec3 sum(0);
  Code3 least{255, 255, 255}, most{0, 0, 0};
  for (const int dx : {0, 1})
    for (const int dy : {0, 1}) {
      std::size_t texel[2];
      double weight = 1;
      for (int k = 0; k < 2; ++k) {
        const int step = k == 0 ? dx : dy;
        const double below = std::floor(place[k]);
        weight *= step == 1 ? place[k] - below : 1 - (place[k] - below);
        const double index = below + step - size[k] * std::floor((below + step) / size[k]);
        if (!(index >= 0 && index < size[k])) return std::nullopt;
        texel[k] = static_cast<std::size_t>(index);
      }
      const std::uint8_t* code = image.rgba.data() + 4 * (texel[1] * image.width + texel[0]);
      for (std::size_t k = 0; k < 3; ++k) {
        least[k] = std::min(least[k], code[k]);
        most[k] = std::max(most[k], code[k]);
        sum[static_cast<int>(k)] += weight * image::srgb_decoded(code[k]);
      }
    }
  for (std::size_t k = 0; k < 3; ++k)
    if (most[k] - least[k] > kLossy) return std::nullopt;
  return Sample{{image::srgb_code(sum.x), image::srgb_code(sum.y), image::srgb_code(sum.z)}, sum};
}

// The colours of a mesh's triangles; nothing where one has not a single colour. reflectance: may be
// null. exact: gets the linear colours of codes of the albedo map.
std::optional<std::vector<Code6>> colors_of(const geometry::Mesh& mesh, const scene::Texture& image,
                                            const scene::Texture* reflectance, const Vec2& repeat,
                                            std::map<Code3, Vec3>& exact) {
  if (mesh.texcoords.size() != mesh.positions.size()) return std::nullopt;
  std::vector<Code6> out;
  std::set<Code6> different;
  for (const geometry::Triangle& t : mesh.triangles) {
    Vec2 at[3];
    for (std::size_t k = 0; k < 3; ++k) at[k] = mesh.texcoords[t[k]] * repeat;
    for (std::size_t k = 1; k < 3; ++k)
      if (!(std::fabs(at[k].x - at[0].x) * image.width <= 0.5 &&
            std::fabs(at[k].y - at[0].y) * image.height <= 0.5))
        return std::nullopt;
    Code6 both{};
    for (const scene::Texture* each : {&image, reflectance}) {
      if (!each) continue;
      const auto color = color_at(*each, at[0]);
      if (!color) return std::nullopt;
      for (std::size_t k = 1; k < 3; ++k) {
        const auto other = color_at(*each, at[k]);
        if (!other || other->code != color->code) return std::nullopt;
      }
      std::ranges::copy(color->code, both.begin() + (each == reflectance ? 3 : 0));
      if (each == &image) exact.try_emplace(color->code, color->linear);
    }
    out.push_back(both);
    if (different.insert(both).second && different.size() > kMostColors) return std::nullopt;
  }
  if (out.empty()) return std::nullopt;
  return out;
}

// The triangles of one colour, with the vertices that they have.
geometry::MeshShape part_of(const geometry::Mesh& mesh, const std::vector<Code6>& colors,
                            const Code6& color) {
  auto out = std::make_shared<geometry::Mesh>();
  constexpr std::uint32_t kNew = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(mesh.positions.size(), kNew);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (colors[i] != color) continue;
    geometry::Triangle triangle = mesh.triangles[i];
    for (std::uint32_t& v : triangle) {
      const std::uint32_t from = v;
      if (number[from] == kNew) {
        number[from] = static_cast<std::uint32_t>(out->positions.size());
        out->positions.push_back(mesh.positions[from]);
        if (!mesh.normals.empty()) out->normals.push_back(mesh.normals[from]);
        if (!mesh.texcoords.empty()) out->texcoords.push_back(mesh.texcoords[from]);
        if (!mesh.colors.empty()) out->colors.push_back(mesh.colors[from]);
      }
      v = number[from];
    }
    out->triangles.push_back(triangle);
  }
  geometry::set_closed(*out);
  return out;
}

class Splitter {
 public:
  Splitter(Imported& imported, const Job& job)
      : imported_(imported), scene_(imported.scene), job_(job) {}

  void run(DiagnosticLog& log) {
    std::vector<scene::Instance> instances;
    for (scene::Instance& one : scene_.instances) {
      job_.poll();
      const Split* split = split_of(one);
      if (!split) {
        instances.push_back(std::move(one));
        continue;
      }
      for (const auto& [color, shape] : *split) {
        scene::Instance part = one;
        part.shape = shape;
        part.material = material_of(one.material, color);
        instances.push_back(std::move(part));
      }
    }
    scene_.instances = std::move(instances);
    if (materials_.empty()) return;
    drop_unused();
    std::set<std::int32_t> palettes;
    for (const auto& [key, index] : materials_) palettes.insert(key.first);
    log.report_file(Code("N6301"), {},
                    fmt::format("replaced {} by {} of one colour each",
                                counted(palettes.size(), "palette image"),
                                counted(materials_.size(), "material")));
  }

 private:
  using Split = std::map<Code6, std::int32_t>;  // shapes by colours

  // Null: it stays as it is.
  const Split* split_of(const scene::Instance& one) {
    const materials::Maps& maps = scene_.materials[static_cast<std::size_t>(one.material)].maps;
    const auto* shape =
        std::get_if<geometry::MeshShape>(&scene_.shapes[static_cast<std::size_t>(one.shape)]);
    if (!shape || maps.albedo < 0 || maps.normal >= 0 || maps.cutout >= 0 ||
        one.texture != scene::kNone)
      return nullptr;
    const scene::Texture& image = scene_.textures[static_cast<std::size_t>(maps.albedo)];
    if (image.linear || std::uint64_t{image.width} * image.height > kMostTexels) return nullptr;
    const auto [known, fresh] = splits_.try_emplace({one.shape, one.material});
    if (fresh) {
      const geometry::MeshShape mesh = *shape;  // note: shapes grow below
      const scene::Texture* reflectance =
          maps.reflectance < 0 ? nullptr
                               : &scene_.textures[static_cast<std::size_t>(maps.reflectance)];
      if (const auto colors =
              colors_of(*mesh, image, reflectance, maps.repeat, exact_[maps.albedo])) {
        const std::set<Code6> different(colors->begin(), colors->end());
        for (const Code6& color : different) {
          std::int32_t part = one.shape;
          if (different.size() > 1) {
            const auto [at, added] = parts_.try_emplace({one.shape, maps.albedo, color}, 0);
            if (added) {
              at->second = static_cast<std::int32_t>(scene_.shapes.size());
              scene_.shapes.emplace_back(part_of(*mesh, *colors, color));
            }
            part = at->second;
          }
          known->second.emplace(color, part);
        }
      }
    }
    return known->second.empty() ? nullptr : &known->second;
  }

  std::int32_t material_of(std::int32_t palette, const Code6& color) {
    const auto next = static_cast<std::int32_t>(scene_.materials.size());
    const auto [known, fresh] = materials_.try_emplace({palette, color}, next);
    if (!fresh) return known->second;
    materials::Material material = scene_.materials[static_cast<std::size_t>(palette)];
    CadMaterial cad = imported_.materials[static_cast<std::size_t>(palette)];
    const auto decoded = [&](std::size_t first) {
      return Vec3(image::srgb_decoded(color[first]), image::srgb_decoded(color[first + 1]),
                  image::srgb_decoded(color[first + 2]));
    };
    const Vec3 linear = exact_.at(material.maps.albedo).at({color[0], color[1], color[2]});
    // metals have their colour in the reflectance
    const Vec3 both = glm::min(linear + decoded(3), Vec3(1));
    const std::string code = fmt::format("_{:02x}{:02x}{:02x}", image::srgb_code(both.x),
                                         image::srgb_code(both.y), image::srgb_code(both.z));
    material.diffuse *= linear;
    cad.palette = material.maps.albedo;
    material.maps.albedo = -1;
    material.name += code;
    cad.name += code;
    cad.base_color = both;
    cad.textured = false;  // its colour is known
    materials::fit(material);
    scene_.materials.push_back(std::move(material));
    imported_.materials.push_back(std::move(cad));
    return next;
  }

  // Palettes of which nothing is left.
  void drop_unused() {
    std::vector<char> keep(scene_.materials.size(), 1);
    for (const auto& [key, index] : materials_) keep[static_cast<std::size_t>(key.first)] = 0;
    for (const scene::Instance& one : scene_.instances)
      for (const std::int32_t side : {one.material, one.back})
        if (side != scene::kNone) keep[static_cast<std::size_t>(side)] = 1;
    std::vector<std::int32_t> place(keep.size());
    std::int32_t next = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      place[i] = next;
      if (!keep[i]) continue;
      const auto to = static_cast<std::size_t>(next++);
      if (to == i) continue;
      scene_.materials[to] = std::move(scene_.materials[i]);
      imported_.materials[to] = std::move(imported_.materials[i]);
    }
    scene_.materials.resize(static_cast<std::size_t>(next));
    imported_.materials.resize(static_cast<std::size_t>(next));
    for (scene::Instance& one : scene_.instances)
      for (std::int32_t* side : {&one.material, &one.back})
        if (*side != scene::kNone) *side = place[static_cast<std::size_t>(*side)];
  }

  Imported& imported_;
  scene::Scene& scene_;
  const Job& job_;
  std::map<std::pair<std::int32_t, std::int32_t>, Split> splits_;  // by shape and material
  std::map<std::tuple<std::int32_t, std::int32_t, Code6>, std::int32_t> parts_;
  std::map<std::pair<std::int32_t, Code6>, std::int32_t> materials_;
  std::map<std::int32_t, std::map<Code3, Vec3>> exact_;  // by image, of codes
};

}  // namespace

void split_palettes(Imported& imported, DiagnosticLog& log, const Job& job) {
  Splitter(imported, job).run(log);
}

}  // namespace panwright::importers
