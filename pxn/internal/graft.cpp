#include "pxn/internal/graft.h"

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

}  // namespace

void graft(const ImportedModel& model, const PartImport& place,
           std::span<const std::int32_t> materials, std::int32_t below, scene::Scene& scene) {
  const scene::Scene& from = model.imported.scene;
  const std::vector<char> kept = kept_nodes(from, place);
  std::vector<std::int32_t> node_of(from.nodes.size(), scene::kNone);
  const bool plain_root = from.nodes[0].parent_from_node == scene::Transform{};
  if (plain_root) node_of[0] = below;
  for (std::size_t i = plain_root ? 1 : 0; i < from.nodes.size(); ++i) {
    if (!kept[i]) continue;
    scene::Node node = from.nodes[i];
    node.parent = i == 0 ? below : node_of[static_cast<std::size_t>(node.parent)];
    node_of[i] = static_cast<std::int32_t>(scene.nodes.size());
    scene.nodes.push_back(std::move(node));
  }
  for (std::size_t i = 0; i < from.instances.size(); ++i) {
    if (place.removed[i]) continue;
    scene::Instance instance = from.instances[i];
    instance.node = node_of[static_cast<std::size_t>(instance.node)];
    instance.shape = model.shapes[static_cast<std::size_t>(instance.shape)];
    instance.material = materials[i];
    // a picture may stand in the material that goes
    const materials::Maps& maps =
        model.imported.scene.materials[static_cast<std::size_t>(from.instances[i].material)].maps;
    if (instance.texture == scene::kNone && place.materials[i] >= 0 && maps.albedo >= 0) {
      instance.texture = maps.albedo;
      instance.mapping = scene::Mapping::texcoords;
    }
    if (instance.texture != scene::kNone)
      instance.texture = place.keeps_picture[i]
                             ? model.textures[static_cast<std::size_t>(instance.texture)]
                             : scene::kNone;
    instance.prunable = !place.keep_hidden;
    scene.instances.push_back(std::move(instance));
  }
  for (scene::Joint joint : from.joints) {
    joint.node = node_of[static_cast<std::size_t>(joint.node)];
    if (joint.node != scene::kNone) scene.joints.push_back(std::move(joint));
  }
}

}  // namespace panwright::pxn
