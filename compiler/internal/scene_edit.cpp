#include "compiler/internal/scene_edit.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace panwright::compiler::internal {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;

void drop_shapes(scene::Scene& scene) {
  std::vector<std::int32_t> moved(scene.shapes.size(), scene::kNone);
  for (const scene::Instance& instance : scene.instances)
    moved[static_cast<std::size_t>(instance.shape)] = 0;
  std::vector<geometry::Shape> kept;
  for (std::size_t s = 0; s < moved.size(); ++s) {
    if (moved[s] == scene::kNone) continue;
    moved[s] = static_cast<std::int32_t>(kept.size());
    kept.push_back(std::move(scene.shapes[s]));
  }
  scene.shapes = std::move(kept);
  for (scene::Foil& foil : scene.foils) foil.shape = moved[static_cast<std::size_t>(foil.shape)];
  std::erase_if(scene.foils, [](const scene::Foil& f) { return f.shape == scene::kNone; });
  for (scene::Instance& instance : scene.instances)
    instance.shape = moved[static_cast<std::size_t>(instance.shape)];
}

}  // namespace

geometry::MeshShape some_triangles(const geometry::Mesh& mesh, const std::vector<char>& keep) {
  geometry::Mesh out;
  out.error = mesh.error;
  out.closed = mesh.closed;
  std::vector<std::uint32_t> kept(mesh.positions.size(), kUnused);
  for (std::size_t t = 0; t < keep.size(); ++t)
    if (keep[t])
      for (const std::uint32_t v : mesh.triangles[t]) kept[v] = 0;
  std::uint32_t count = 0;
  const auto take = [](auto& to, const auto& from, std::size_t v) {
    if (!from.empty()) to.push_back(from[v]);
  };
  for (std::size_t v = 0; v < kept.size(); ++v) {
    if (kept[v] == kUnused) continue;
    kept[v] = count++;
    take(out.positions, mesh.positions, v);
    take(out.normals, mesh.normals, v);
    take(out.texcoords, mesh.texcoords, v);
    take(out.colors, mesh.colors, v);
  }
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const geometry::Triangle& from = mesh.triangles[t];
    if (keep[t]) out.triangles.push_back({kept[from[0]], kept[from[1]], kept[from[2]]});
  }
  return std::make_shared<const geometry::Mesh>(std::move(out));
}

void keep_instances(scene::Scene& scene, const std::vector<char>& keep) {
  std::vector<std::int32_t> moved(keep.size(), scene::kNone);
  std::vector<scene::Instance> kept;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    moved[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(std::move(scene.instances[i]));
  }
  scene.instances = std::move(kept);
  for (scene::Decal& decal : scene.decals)
    decal.instance = moved[static_cast<std::size_t>(decal.instance)];
  drop_shapes(scene);
}

}  // namespace panwright::compiler::internal
