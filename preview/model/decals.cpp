#include "preview/model/decals.h"

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "base/parallel.h"

namespace panwright::preview {
namespace {

namespace layout = pan::layout;

// more than float coordinates in the shader can be off by, in widths and depths of the decal
constexpr double kMargin = 1e-3;

std::array<Vec4, 3> place_rows(const layout::Decal& decal, const layout::Mesh& mesh) {
  const Quat rotation(decal.rotation[0], decal.rotation[1], decal.rotation[2], decal.rotation[3]);
  const Mat3 mesh_from_decal = glm::mat3_cast(rotation);
  const Vec3 offset = Vec3(mesh.origin[0], mesh.origin[1], mesh.origin[2]) -
                      Vec3(decal.origin[0], decal.origin[1], decal.origin[2]);
  const Vec3 size(decal.width, decal.height, decal.depth);
  const Vec3 centre(0.5, 0.5, 0);
  std::array<Vec4, 3> rows;
  for (int k = 0; k < 3; ++k)
    rows[static_cast<std::size_t>(k)] = Vec4(
        mesh_from_decal[k] / size[k], glm::dot(mesh_from_decal[k], offset) / size[k] + centre[k]);
  return rows;
}

// The triangles whose bounds in the decal's coordinates meet its box and, on a mesh that is not
// seen from behind, that face it somewhere.
std::vector<std::uint32_t> touched(const pan::MeshView& mesh, const PlacedDecal& decal,
                                   bool one_sided) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    AxisBox box;
    bool facing = !one_sided;
    for (std::size_t k = 0; k < 3; ++k) {
      const layout::Float3& p = mesh.positions[mesh.indices[i + k]];
      const layout::Float3& n = mesh.normals[mesh.indices[i + k]];
      const Vec4 position(p.x, p.y, p.z, 1);
      const Vec3 at(glm::dot(decal.place[0], position), glm::dot(decal.place[1], position),
                    glm::dot(decal.place[2], position));
      box.add(at);
      facing = facing || glm::dot(decal.outwards, Vec3(n.x, n.y, n.z)) > -kMargin;
    }
    const auto& [low, high] = box;
    const bool meets = high.x >= -kMargin && high.y >= -kMargin && high.z >= -1 - kMargin &&
                       low.x <= 1 + kMargin && low.y <= 1 + kMargin && low.z <= 1 + kMargin;
    if (!meets || !facing) continue;
    for (std::size_t k = 0; k < 3; ++k) indices.push_back(mesh.indices[i + k]);
  }
  return indices;
}

}  // namespace

std::vector<PlacedDecal> placed_decals(const pan::Model& model, std::span<const DrawItem> list) {
  // of an instance, one or one for each side
  std::vector<std::vector<std::uint32_t>> items_of(model.instances().size());
  for (std::uint32_t i = 0; i < list.size(); ++i) items_of[list[i].instance].push_back(i);
  std::vector<PlacedDecal> decals;
  std::vector<std::size_t> records;
  for (std::size_t i = 0; i < model.decals().size(); ++i)
    for (const std::uint32_t item : items_of[model.decals()[i].instance]) {
      decals.emplace_back().item = item;
      records.push_back(i);
    }
  parallel_for(decals.size(), [&](std::size_t i) {
    const layout::Decal& record = model.decals()[records[i]];
    PlacedDecal& decal = decals[i];
    decal.texture = record.texture;
    const DrawItem& item = list[decal.item];
    decal.place = place_rows(record, model.meshes()[item.mesh]);
    decal.outwards =
        Quat(record.rotation[0], record.rotation[1], record.rotation[2], record.rotation[3]) *
        Vec3(0, 0, 1);
    decal.indices = touched(model.mesh(item.mesh), decal, item.sides == Sides::front);
  });
  std::erase_if(decals, [](const PlacedDecal& decal) { return decal.indices.empty(); });
  return decals;
}

}  // namespace panwright::preview
