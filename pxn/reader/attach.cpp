#include "pxn/reader/attach.h"

#include <optional>

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

// Where a joint stands between a node and its parent, with axes of the import and a given origin;
// and the node below it. Nothing where that takes a shear.
struct Hinge {
  scene::Transform parent_from_joint;
  scene::Transform joint_from_node;
};
std::optional<Hinge> hinge_of(const Mat4& import_from_parent, const Mat4& import_from_node,
                              const Vec3& origin) {
  Mat4 import_from_joint(1), joint_from_import(1);
  import_from_joint[3] = Vec4(origin, 1);
  joint_from_import[3] = Vec4(-origin, 1);
  const bool plain = import_from_parent == Mat4(1);
  const auto outer = scene::decomposed(
      plain ? import_from_joint : glm::inverse(import_from_parent) * import_from_joint);
  const auto inner = scene::decomposed(joint_from_import * import_from_node);
  if (!outer || !inner || outer->sheared || inner->sheared) return std::nullopt;
  return Hinge{outer->outer, inner->outer};
}

// Joints of the file, at their nodes as attached. What follows or aims with one that is gone stays
// where it is, by itself.
void attach_joints(const scene::Scene& from, const std::vector<std::int32_t>& node_of,
                   const std::string& prefix, scene::Scene& scene) {
  std::vector<std::int32_t> joint_of(from.joints.size(), scene::kNone);
  auto next = static_cast<std::int32_t>(scene.joints.size());
  for (std::size_t i = 0; i < from.joints.size(); ++i)
    if (node_of[static_cast<std::size_t>(from.joints[i].node)] != scene::kNone)
      joint_of[i] = next++;
  for (std::size_t i = 0; i < from.joints.size(); ++i) {
    if (joint_of[i] == scene::kNone) continue;
    scene::Joint joint = from.joints[i];
    joint.node = node_of[static_cast<std::size_t>(joint.node)];
    if (!joint.name.empty()) joint.name = prefix + joint.name;
    for (std::int32_t* other : {&joint.mimic, &joint.gimbal})
      if (*other != scene::kNone) *other = joint_of[static_cast<std::size_t>(*other)];
    scene.joints.push_back(std::move(joint));
  }
}

// Nodes of a file in the scene.
struct AttachedNodes {
  std::vector<std::int32_t> node_of;  // kNone: not kept
  std::vector<Mat4> world_from;
};

// Nodes that a joint moves get a node for it above.
AttachedNodes attach_nodes(const scene::Scene& from, const PartImport& place, std::int32_t below,
                           const Mat4& world_from_below, AttachedShapes& shapes,
                           scene::Scene& scene) {
  const std::vector<char> kept = kept_nodes(from, place);
  AttachedNodes out{std::vector<std::int32_t>(from.nodes.size(), scene::kNone),
                    std::vector<Mat4>(from.nodes.size(), world_from_below)};
  auto& [node_of, world_from] = out;
  const bool plain_root = from.nodes[0].parent_from_node == scene::Transform{};
  if (plain_root) node_of[0] = below;
  std::vector<Mat4> import_from(from.nodes.size(), Mat4(1));
  std::map<std::size_t, std::size_t> moved;  // by node
  for (std::size_t k = 0; k < place.moved.size(); ++k)
    for (const std::uint32_t node : place.moved[k].nodes) moved[node] = k;
  std::vector<std::optional<Vec3>> origins(place.moved.size());
  shapes.moving.clear();
  shapes.sheared.clear();
  for (std::size_t i = plain_root ? 1 : 0; i < from.nodes.size(); ++i) {
    if (!kept[i]) continue;
    const Mat4& outer =
        i == 0 ? world_from_below : world_from[static_cast<std::size_t>(from.nodes[i].parent)];
    const Mat4 local = from.nodes[i].parent_from_node.matrix();
    const Mat4 import_from_parent =
        i == 0 ? Mat4(1) : import_from[static_cast<std::size_t>(from.nodes[i].parent)];
    world_from[i] = outer * local;
    import_from[i] = import_from_parent * local;
    scene::Node node = from.nodes[i];
    node.parent = i == 0 ? below : node_of[static_cast<std::size_t>(node.parent)];
    if (const auto found = moved.find(i); found != moved.end()) {
      auto& origin = origins[found->second];
      if (!origin) origin = place.moved[found->second].origin.value_or(Vec3(import_from[i][3]));
      if (const auto hinge = hinge_of(import_from_parent, import_from[i], *origin)) {
        scene::Node joint = node;
        joint.name = node.name + "_joint";
        joint.parent_from_node = hinge->parent_from_joint;
        node.parent_from_node = hinge->joint_from_node;
        node.parent = static_cast<std::int32_t>(scene.nodes.size());
        shapes.moving.emplace_back(found->second, node.parent);
        scene.nodes.push_back(std::move(joint));
      } else {
        shapes.sheared.push_back(found->second);
      }
    }
    node_of[i] = static_cast<std::int32_t>(scene.nodes.size());
    scene.nodes.push_back(std::move(node));
  }
  return out;
}

void attach_instances(const ImportedModel& model, const PartImport& place,
                      const AttachedSides& sides, const AttachedNodes& nodes,
                      AttachedShapes& shapes, scene::Scene& scene) {
  const scene::Scene& from = model.imported.scene;
  const auto& [node_of, world_from] = nodes;
  shapes.foiled.clear();
  for (std::size_t i = 0; i < from.instances.size(); ++i) {
    if (place.removed[i]) continue;
    const std::size_t first = scene.instances.size();
    scene::Instance instance = from.instances[i];
    instance.node = node_of[static_cast<std::size_t>(instance.node)];
    instance.shape = model.shapes[static_cast<std::size_t>(instance.shape)];
    instance.material = sides.materials[i];
    instance.back = sides.backs[i];
    if (place.materials[i] >= 0 && !place.keeps_texture[i])
      instance.shape = plain_shape(instance.shape, shapes.plain, scene);
    // a texture may stand in the material that goes
    const std::int32_t texture = base_texture(model.imported, from.instances[i]);
    if (instance.texture == scene::kNone && place.materials[i] >= 0 && texture >= 0) {
      instance.texture = texture;
      instance.mapping = scene::Mapping::texcoords;
    }
    if (instance.texture != scene::kNone)
      instance.texture = place.keeps_texture[i]
                             ? model.textures[static_cast<std::size_t>(instance.texture)]
                             : scene::kNone;
    instance.prunable = !place.keep_hidden;
    // an assigned material is opaque
    instance.see_through = instance.see_through && place.materials[i] < 0;
    shapes.cells.append(std::move(instance),
                        world_from[static_cast<std::size_t>(from.instances[i].node)]);
    if (!place.foils[i].preset.empty())
      for (std::size_t k = first; k < scene.instances.size(); ++k)
        shapes.foiled.emplace_back(static_cast<std::int32_t>(k), static_cast<std::uint32_t>(i));
  }
}

}  // namespace

void attach(const ImportedModel& model, const PartImport& place, const AttachedSides& sides,
            std::int32_t below, const Mat4& world_from_below, const std::string& prefix,
            AttachedShapes& shapes, scene::Scene& scene) {
  const scene::Scene& from = model.imported.scene;
  const AttachedNodes nodes = attach_nodes(from, place, below, world_from_below, shapes, scene);
  const std::vector<std::int32_t>& node_of = nodes.node_of;
  attach_instances(model, place, sides, nodes, shapes, scene);
  attach_joints(from, node_of, prefix, scene);
  shapes.frames.clear();
  for (scene::Frame frame : from.frames) {
    frame.node = node_of[static_cast<std::size_t>(frame.node)];
    if (frame.node == scene::kNone) continue;
    frame.name = prefix + frame.name;
    shapes.frames.push_back(std::move(frame));
  }
}

}  // namespace panwright::pxn
