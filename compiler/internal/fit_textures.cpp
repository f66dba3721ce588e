// Textures that the nearest pixel cannot tell from smaller ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "base/parallel.h"
#include "compiler/internal/fit.h"
#include "geometry/tessellate/tessellate.h"
#include "image/srgb.h"

namespace panwright::compiler::internal {
namespace {

using geometry::Mesh;
using geometry::MeshShape;

constexpr double kTexels = 2;           // for a pixel at the nearest
constexpr double kFineShare = 0.01;     // of the area may have finer texels than what counts
constexpr double kTextureShare = 0.25;  // of the budget's flux
constexpr double kMostLight = 0.01;     // relative, where the budget has no flux
constexpr double kLeastSamples = 4;     // of a texture, in each triangle
constexpr double kSamples = 1e6;        // of a mesh
constexpr double kCoarseShapes = 0.02;  // of the radius of curvature: meshes of exact shapes

// The mesh of a shape, with texture coordinates; null: none.
MeshShape textured_surface(const geometry::Shape& shape) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape))
    return (*mesh)->texcoords.empty() ? nullptr : *mesh;
  geometry::TessellationOptions options;
  const auto radius = radius_of_curvature(shape);
  options.max_error = radius && *radius > 0 ? kCoarseShapes * *radius : 1e30;
  options.texcoords = true;
  options.max_triangles = 1u << 20;
  DiagnosticLog ignored;  // the compilation reports the same
  if (geometry::planned_triangles(shape, options) > static_cast<double>(options.max_triangles))
    return nullptr;
  auto mesh = geometry::tessellated(shape, options, {}, ignored);
  if (!mesh || mesh->texcoords.empty()) return nullptr;
  return std::make_shared<const Mesh>(*std::move(mesh));
}

// World metres that a texel covers where texels are finest, but for kFineShare of the area; 0: not
// known.
double texel_size(const Mesh& mesh, double stretch, const scene::Texture& texture, double repeats) {
  struct Piece {
    double size = 0, area = 0;
  };
  std::vector<Piece> pieces;
  double whole = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t[0]];
    const double area =
        glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) / 2;
    const Vec2 u = mesh.texcoords[t[1]] - mesh.texcoords[t[0]];
    const Vec2 v = mesh.texcoords[t[2]] - mesh.texcoords[t[0]];
    const double texels =
        std::fabs(u.x * v.y - u.y * v.x) / 2 * texture.width * texture.height * repeats;
    if (!(area > 0)) continue;
    whole += area;
    if (texels > 0) pieces.push_back({std::sqrt(area / texels) * stretch, area});
  }
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    return a.size != b.size ? a.size < b.size : a.area < b.area;
  });
  double area = 0;
  for (const Piece& piece : pieces) {
    area += piece.area;
    if (area >= kFineShare * whole) return piece.size;
  }
  return 0;
}

// The mean of the channels' light in each texel.
struct LightMap {
  std::size_t width = 0, height = 0;
  std::vector<float> texels;

  explicit LightMap(const scene::Texture& texture) : width(texture.width), height(texture.height) {
    texels.reserve(width * height);
    for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint8_t code = texture.rgba[i + k];
        sum += texture.linear ? code / 255.0 : image::srgb_decoded(code);
      }
      texels.push_back(static_cast<float>(sum / 3));
    }
  }

  // Bilinear between the middles of texels, repeated.
  double at(const Vec2& place) const {
    const double x = place.x * static_cast<double>(width) - 0.5;
    const double y = (1 - place.y) * static_cast<double>(height) - 0.5;
    const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
    const auto wrapped = [](double from, std::size_t count) {
      const auto size = static_cast<double>(count);
      return std::min(static_cast<std::size_t>(from - size * std::floor(from / size)), count - 1);
    };
    const std::size_t i0 = wrapped(x0, width), i1 = i0 + 1 == width ? 0 : i0 + 1;
    const std::size_t j0 = wrapped(y0, height), j1 = j0 + 1 == height ? 0 : j0 + 1;
    const float* const upper = &texels[j0 * width];
    const float* const lower = &texels[j1 * width];
    return (1 - v) * ((1 - u) * double{upper[i0]} + u * double{upper[i1]}) +
           v * ((1 - u) * double{lower[i0]} + u * double{lower[i1]});
  }
};

bool opaque(const scene::Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
    if (texture.rgba[i] != 255) return false;
  return true;
}

// Means over the pixels' boxes, of light.
scene::Texture reduced(const scene::Texture& from, std::uint32_t width, std::uint32_t height) {
  std::array<double, 256> light;
  for (std::size_t code = 0; code < light.size(); ++code)
    light[code] = from.linear ? static_cast<double>(code) / 255
                              : image::srgb_decoded(static_cast<std::uint8_t>(code));
  // along x, then along y: each box over the texels that it overlaps
  const auto overlaps = [](std::uint32_t cells, std::uint32_t texels, std::uint32_t cell,
                           const auto& visit) {
    const double low = static_cast<double>(cell) * texels / cells;
    const double high = static_cast<double>(cell + 1) * texels / cells;
    const auto end = std::min(static_cast<std::uint32_t>(std::ceil(high)), texels);
    for (auto i = static_cast<std::uint32_t>(low); i < end; ++i)
      visit(i, (std::min(high, i + 1.0) - std::max(low, double{1.0} * i)) / (high - low));
  };
  std::vector<double> rows(std::size_t{3} * width * from.height);
  for (std::uint32_t y = 0; y < from.height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      overlaps(width, from.width, x, [&](std::uint32_t i, double share) {
        for (std::size_t k = 0; k < 3; ++k)
          rows[3 * (std::size_t{y} * width + x) + k] +=
              share * light[from.rgba[4 * (std::size_t{y} * from.width + i) + k]];
      });
  scene::Texture out{from.name, width, height, {}, from.linear};
  out.rgba.assign(std::size_t{4} * width * height, 255);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      Vec3 sum(0);
      overlaps(height, from.height, y, [&](std::uint32_t j, double share) {
        for (int k = 0; k < 3; ++k)
          sum[k] += share * rows[3 * (std::size_t{j} * width + x) + static_cast<std::size_t>(k)];
      });
      for (int k = 0; k < 3; ++k)
        out.rgba[4 * (std::size_t{y} * width + x) + static_cast<std::size_t>(k)] =
            from.linear ? static_cast<std::uint8_t>(std::floor(sum[k] * 255 + 0.5))
                        : image::srgb_code(sum[k]);
    }
  return out;
}

// A mesh that wears a texture.
struct User {
  MeshShape mesh;
  Vec2 repeat{1};
};

// The mean light on each triangle of a mesh, by so many samples as it has texels of a texture of
// `fine` by fine.
std::vector<double> means_on(const User& user, const LightMap& light, const scene::Texture& fine,
                             const Job& job) {
  const Mesh& mesh = *user.mesh;
  const double most =
      std::max(kLeastSamples, kSamples / static_cast<double>(mesh.triangles.size()));
  std::vector<double> means(mesh.triangles.size());
  parallel_for(
      means.size(),
      [&](std::size_t index) {
        const geometry::Triangle& t = mesh.triangles[index];
        const Vec2 p = mesh.texcoords[t[1]] - mesh.texcoords[t[0]];
        const Vec2 q = mesh.texcoords[t[2]] - mesh.texcoords[t[0]];
        const double texels = std::fabs(p.x * q.y - p.y * q.x) / 2 * user.repeat.x * user.repeat.y *
                              fine.width * fine.height;
        const auto samples = static_cast<std::size_t>(std::clamp(texels, kLeastSamples, most));
        double sum = 0;
        for (std::size_t i = 0; i < samples; ++i) {
          // an even set of the square, folded into the triangle (plastic number)
          double u = 0.5 + 0.7548776662466927 * static_cast<double>(i);
          double v = 0.5 + 0.5698402909980532 * static_cast<double>(i);
          u -= std::floor(u);
          v -= std::floor(v);
          if (u + v > 1) u = 1 - u, v = 1 - v;
          sum += light.at(user.repeat * ((1 - u - v) * mesh.texcoords[t[0]] +
                                         u * mesh.texcoords[t[1]] + v * mesh.texcoords[t[2]]));
        }
        means[index] = sum / static_cast<double>(samples);
      },
      job);
  return means;
}

// The largest share by which the mean light of a texture changes, of the faces of a mesh that look
// along one axis; relative to the mean over all of it. Texels of an atlas belong to many pieces,
// and those of a coarse one to several of them.
double light_difference(const Mesh& mesh, const std::vector<double>& fine,
                        const std::vector<double>& coarse) {
  std::array<double, 6> areas{}, before{}, after{};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const geometry::Triangle& t = mesh.triangles[i];
    const Vec3& a = mesh.positions[t[0]];
    const Vec3 cross = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::fabs(cross[static_cast<int>(k)]) > std::fabs(cross[static_cast<int>(axis)]))
        axis = k;
    const std::size_t face = 2 * axis + (cross[static_cast<int>(axis)] < 0 ? 1 : 0);
    const double area = glm::length(cross) / 2;
    areas[face] += area;
    before[face] += area * fine[i];
    after[face] += area * coarse[i];
  }
  double area = 0, light = 0;
  for (std::size_t face = 0; face < 6; ++face) {
    area += areas[face];
    light += before[face];
  }
  double largest = 0;
  if (!(light > 0)) return largest;
  for (std::size_t face = 0; face < 6; ++face)
    if (areas[face] > kFineShare * area)
      largest =
          std::max(largest, std::fabs(after[face] - before[face]) / areas[face] * area / light);
  return largest;
}

// Halves a texture up to `halvings` times, as long as the light of its users changes by at most
// `most`.
void reduce_texture(scene::Texture& texture, double halvings, const std::vector<User>& users,
                    double most, const Job& job) {
  std::vector<std::vector<double>> fine;
  {
    const LightMap light(texture);
    for (const User& user : users) fine.push_back(means_on(user, light, texture, job));
  }
  const auto looks_alike = [&](const scene::Texture& smaller) {
    const LightMap light(smaller);
    for (std::size_t u = 0; u < users.size(); ++u)
      if (light_difference(*users[u].mesh, fine[u], means_on(users[u], light, texture, job)) > most)
        return false;
    return true;
  };
  for (int k = static_cast<int>(std::min(halvings, 32.0)); k > 0; --k) {
    const auto side = [&](std::uint32_t texels) {
      return static_cast<std::uint32_t>(std::max(1.0, std::ceil(std::ldexp(texels, -k))));
    };
    const std::uint32_t width = side(texture.width), height = side(texture.height);
    if (width == texture.width && height == texture.height) continue;
    scene::Texture smaller = reduced(texture, width, height);
    if (!looks_alike(smaller)) continue;
    texture = std::move(smaller);
    return;
  }
}

}  // namespace

void reduce_textures(scene::Scene& scene, const Allotment& allotment, FitReport& report,
                     const Job& job) {
  constexpr double kUnknown = -1;
  std::vector<double> halvings(scene.textures.size(), HUGE_VAL);
  const auto use = [&](std::int32_t texture, double value) {
    if (texture < 0) return;
    double& known = halvings[static_cast<std::size_t>(texture)];
    known = std::min(known, value);
  };
  // maps of other kinds have statistics of their own at every size (preview/model/map_levels.h)
  for (const materials::Material& material : scene.materials)
    for (const std::int32_t map :
         {material.maps.normal, material.maps.roughness, material.maps.cutout})
      use(map, kUnknown);
  for (const scene::Decal& decal : scene.decals) use(decal.texture, kUnknown);
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  std::vector<MeshShape> surfaces(scene.shapes.size());
  std::vector<char> made(scene.shapes.size());
  std::vector<std::vector<User>> users(scene.textures.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    job.poll();
    const scene::Instance& instance = scene.instances[i];
    std::vector<std::pair<std::int32_t, Vec2>> maps{{instance.texture, Vec2(1)}};
    for (const std::int32_t side : {instance.material, instance.back}) {
      if (side == scene::kNone) continue;
      const materials::Maps& all = scene.materials[static_cast<std::size_t>(side)].maps;
      maps.insert(maps.end(), {{all.albedo, all.repeat}, {all.reflectance, all.repeat}});
    }
    std::erase_if(maps, [](const auto& map) { return map.first < 0; });
    if (maps.empty()) continue;
    const auto shape = static_cast<std::size_t>(instance.shape);
    if (!made[shape]) surfaces[shape] = textured_surface(scene.shapes[shape]);
    made[shape] = 1;
    const Stretch stretch = stretch_of(world[static_cast<std::size_t>(instance.node)]);
    const scene::Budget budget = allotment.of(scene.budget, i);
    const double pixel = *budget.nearest * *budget.ifov;
    for (const auto& [map, repeat] : maps) {
      const scene::Texture& texture = scene.textures[static_cast<std::size_t>(map)];
      const bool known = surfaces[shape] && instance.mapping == scene::Mapping::texcoords;
      const double size =
          known ? texel_size(*surfaces[shape], stretch.smallest, texture, repeat.x * repeat.y)
                : 0.0;
      if (known) users[static_cast<std::size_t>(map)].push_back({surfaces[shape], repeat});
      use(map, size > 0 ? std::floor(det::log(pixel / kTexels / size) / det::log(2.0)) : kUnknown);
    }
  }
  for (const scene::Texture& texture : scene.textures) report.texels_before += texture.rgba.size();
  parallel_for(
      halvings.size(),
      [&](std::size_t i) {
        scene::Texture& texture = scene.textures[i];
        if (!(halvings[i] >= 1) || halvings[i] == HUGE_VAL || !opaque(texture)) return;
        const double most = scene.budget.flux ? kTextureShare * *scene.budget.flux : kMostLight;
        reduce_texture(texture, halvings[i], users[i], most, job);
      },
      job);
  for (const scene::Texture& texture : scene.textures) report.texels_after += texture.rgba.size();
}

}  // namespace panwright::compiler::internal
