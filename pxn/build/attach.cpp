#include "pxn/build/attach.h"

namespace panwright::pxn {

namespace {

// Nodes with something in them: instances that stay, joints, frames, or such nodes below.
std::vector<char> kept_nodes(const scene::Scene& from, const PartImport& place) {
  std::vector<char> kept(from.nodes.size());
  std::vector<char> lost(from.nodes.size());
  for (std::size_t i = 0; i < from.instances.size(); ++i)
    (place.removed[i] ? lost : kept)[static_cast<std::size_t>(from.instances[i].node)] = 1;
  // one that never held anything is there for its name
  for (std::size_t i = from.nodes.size(); i-- > 1;) {
    const auto parent = static_cast<std::size_t>(from.nodes[i].parent);
    if (!lost[i]) kept[i] = 1;
    if (kept[i]) kept[parent] = 1;
    if (lost[i] && !kept[i]) lost[parent] = 1;
  }
  kept[0] = 1;
  return kept;
}

// The shape without vertex colours; itself where it has none.
std::int32_t plain_shape(std::int32_t shape, PlainShapes& plain, scene::Scene& scene) {
  const auto* mesh =
      std::get_if<geometry::MeshShape>(&scene.shapes[static_cast<std::size_t>(shape)]);
  if (!mesh || (*mesh)->colors.empty()) return shape;
  const auto [known, is_new] =
      plain.try_emplace(shape, static_cast<std::int32_t>(scene.shapes.size()));
  if (is_new) {
    auto copy = std::make_shared<geometry::Mesh>(**mesh);
    copy->colors = {};
    scene.shapes.emplace_back(geometry::MeshShape(std::move(copy)));
  }
  return known->second;
}

}  // namespace

void attach(const ImportedModel& model, const PartImport& place,
            std::span<const std::int32_t> materials, std::int32_t below,
            const Mat4& world_from_below, AttachedShapes& shapes, scene::Scene& scene) {
  const scene::Scene& from = model.imported.scene;
  const std::vector<char> kept = kept_nodes(from, place);
  std::vector<std::int32_t> node_of(from.nodes.size(), scene::kNone);
  const bool plain_root = from.nodes[0].parent_from_node == scene::Transform{};
  if (plain_root) node_of[0] = below;
  std::vector<Mat4> world_from(from.nodes.size(), world_from_below);
  for (std::size_t i = plain_root ? 1 : 0; i < from.nodes.size(); ++i) {
    if (!kept[i]) continue;
    const Mat4& outer =
        i == 0 ? world_from_below : world_from[static_cast<std::size_t>(from.nodes[i].parent)];
    world_from[i] = outer * from.nodes[i].parent_from_node.matrix();
    scene::Node node = from.nodes[i];
    node.parent = i == 0 ? below : node_of[static_cast<std::size_t>(node.parent)];
    node_of[i] = static_cast<std::int32_t>(scene.nodes.size());
    scene.nodes.push_back(std::move(node));
  }
  shapes.foiled.clear();
  for (std::size_t i = 0; i < from.instances.size(); ++i) {
    if (place.removed[i]) continue;
    const std::size_t first = scene.instances.size();
    scene::Instance instance = from.instances[i];
    instance.node = node_of[static_cast<std::size_t>(instance.node)];
    instance.shape = model.shapes[static_cast<std::size_t>(instance.shape)];
    instance.material = materials[i];
    if (place.materials[i] >= 0 && !place.keeps_texture[i])
      instance.shape = plain_shape(instance.shape, shapes.plain, scene);
    // a texture may stand in the material that goes: the colour of paint, or that of a metal
    const materials::Maps& maps =
        model.imported.scene.materials[static_cast<std::size_t>(from.instances[i].material)].maps;
    const std::int32_t texture = maps.albedo >= 0 ? maps.albedo : maps.reflectance;
    if (instance.texture == scene::kNone && place.materials[i] >= 0 && texture >= 0) {
      instance.texture = texture;
      instance.mapping = scene::Mapping::texcoords;
    }
    if (instance.texture != scene::kNone)
      instance.texture = place.keeps_texture[i]
                             ? model.textures[static_cast<std::size_t>(instance.texture)]
                             : scene::kNone;
    instance.prunable = !place.keep_hidden;
    shapes.cells.append(std::move(instance),
                        world_from[static_cast<std::size_t>(from.instances[i].node)]);
    if (!place.foils[i].preset.empty())
      for (std::size_t k = first; k < scene.instances.size(); ++k)
        shapes.foiled.emplace_back(static_cast<std::int32_t>(k), static_cast<std::uint32_t>(i));
  }
  for (scene::Joint joint : from.joints) {
    joint.node = node_of[static_cast<std::size_t>(joint.node)];
    if (joint.node != scene::kNone) scene.joints.push_back(std::move(joint));
  }
}

}  // namespace panwright::pxn
