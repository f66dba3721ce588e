#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace panwright::scene {

namespace {

constexpr double kUnitTolerance = 1e-9;  // |q| of a rotation, after normalising in double

bool is_unit(const Quat& q) { return std::abs(glm::length(q) - 1) <= kUnitTolerance; }

bool in_range(std::int32_t index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

bool is_finite(const Mat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

std::string check_nodes(const Scene& scene) {
  if (scene.nodes.empty()) return "no root node";
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    const bool parent_ok = i == 0 ? node.parent == kNone : in_range(node.parent, i);
    if (!parent_ok)
      return fmt::format("node {} has the parent {}, expected a node before it", i, node.parent);
    const Transform& t = node.parent_from_node;
    if (!panwright::is_finite(t.translation) || !panwright::is_finite(t.scale))
      return fmt::format("node {} has a transform that is not finite", i);
    if (!is_unit(t.rotation))
      return fmt::format("node {} has a rotation that is not a unit quaternion", i);
    if (t.scale.x == 0 || t.scale.y == 0 || t.scale.z == 0)
      return fmt::format("node {} has a scale of zero", i);
  }
  return {};
}

std::string check_mesh(const geometry::Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == vertices; };
  if (!fits(mesh.normals.size()) || !fits(mesh.texcoords.size()) || !fits(mesh.colors.size()))
    return "has attribute lists of different length";
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle)
      if (index >= vertices)
        return fmt::format("has the index {}, expected below {}", index, vertices);
  for (const Vec3& p : mesh.positions)
    if (!panwright::is_finite(p)) return "has a position that is not finite";
  for (const Vec3& n : mesh.normals)
    if (!(std::abs(glm::length(n) - 1) <= 1e-6)) return "has a normal that is not of unit length";
  return {};
}

std::string check_shapes(const Scene& scene) {
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    if (const auto* sphere = std::get_if<geometry::Sphere>(&scene.shapes[i])) {
      if (!(sphere->radius > 0) || !std::isfinite(sphere->radius))
        return fmt::format("shape {} is a sphere of radius {}, expected above 0", i,
                           sphere->radius);
      if (sphere->counts && (sphere->counts->rings < 2 || sphere->counts->quads < 3))
        return fmt::format(
            "shape {} is a sphere with too few rings or quads, expected at least 2 and 3", i);
    }
    if (const auto* mesh = std::get_if<geometry::MeshShape>(&scene.shapes[i])) {
      if (!*mesh) return fmt::format("shape {} is a null mesh", i);
      const std::string problem = check_mesh(**mesh);
      if (!problem.empty()) return fmt::format("shape {} {}", i, problem);
    } else if (const auto problem = geometry::problem_of(scene.shapes[i])) {
      return fmt::format("shape {} is a {} with {}", i, geometry::kind_name(scene.shapes[i]),
                         problem->message);
    }
  }
  for (std::size_t i = 0; i < scene.foils.size(); ++i) {
    const std::int32_t shape = scene.foils[i].shape;
    if (!in_range(shape, scene.shapes.size()) ||
        !std::holds_alternative<geometry::MeshShape>(
            scene.shapes[static_cast<std::size_t>(shape)]) ||
        (i > 0 && shape <= scene.foils[i - 1].shape))
      return fmt::format("foil {} has the shape {}, expected a mesh after those before it", i,
                         shape);
  }
  return {};
}

std::string check_instances(const Scene& scene) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (!in_range(instance.node, scene.nodes.size()) ||
        !in_range(instance.shape, scene.shapes.size()) ||
        !in_range(instance.material, scene.materials.size()))
      return fmt::format("instance {} refers to a node, shape or material that does not exist", i);
    if (instance.texture != kNone && !in_range(instance.texture, scene.textures.size()))
      return fmt::format("instance {} refers to the texture {}, which does not exist", i,
                         instance.texture);
    if (!is_finite(instance.texture_from_shape))
      return fmt::format("instance {} has a texture matrix that is not finite", i);
  }
  return {};
}

std::string check_rest(const Scene& scene) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    if (texture.width == 0 || texture.height == 0 ||
        texture.rgba.size() != std::size_t{4} * texture.width * texture.height)
      return fmt::format("texture {} has {} bytes, expected 4 for each of {} x {} texels", i,
                         texture.rgba.size(), texture.width, texture.height);
  }
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Frame& frame = scene.frames[i];
    if (!in_range(frame.node, scene.nodes.size()) || !panwright::is_finite(frame.origin) ||
        !is_unit(frame.rotation))
      return fmt::format(
          "frame {} has an unknown node, an origin that is not finite or a rotation that is not a "
          "unit quaternion",
          i);
    if (!names.insert(frame.name).second) return fmt::format("duplicate frame name {}", frame.name);
  }
  return {};
}

std::string check_joints(const Scene& scene) {
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = scene.joints[i];
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!in_range(joint.node, scene.nodes.size()) || !panwright::is_finite(joint.axis) ||
        !(std::abs(glm::length(joint.axis) - 1) <= kUnitTolerance) || !finite(joint.value))
      return fmt::format(
          "joint {} has an unknown node, an axis that is not of unit length or a value that is not "
          "finite",
          i);
    if (joint.lower.size() != joint.upper.size() ||
        !std::all_of(joint.lower.begin(), joint.lower.end(), finite) ||
        !std::all_of(joint.upper.begin(), joint.upper.end(), finite))
      return fmt::format("joint {} has limits that are not finite or do not come in pairs", i);
  }
  return {};
}

std::string check_truth(const Scene& scene) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < scene.keypoints.size(); ++i) {
    const Keypoint& point = scene.keypoints[i];
    if (!in_range(point.node, scene.nodes.size()) || !panwright::is_finite(point.position))
      return fmt::format("keypoint {} has an unknown node or a position that is not finite", i);
    if (!names.insert(point.name).second)
      return fmt::format("duplicate keypoint name {}", point.name);
  }
  const auto direction = [](const std::optional<Vec3>& v) {
    return !v || (panwright::is_finite(*v) && *v != Vec3(0));
  };
  for (std::size_t i = 0; i < scene.decals.size(); ++i) {
    const Decal& decal = scene.decals[i];
    if (!in_range(decal.instance, scene.instances.size()) ||
        !in_range(decal.texture, scene.textures.size()) || !panwright::is_finite(decal.at) ||
        !direction(decal.normal) || !direction(decal.up) || !(decal.width > 0) ||
        !(decal.height > 0) || !std::isfinite(decal.width) || !std::isfinite(decal.height))
      return fmt::format(
          "decal {} has an unknown instance or texture, a direction of length 0, or a position or "
          "size out of range",
          i);
  }
  return {};
}

std::string check_budget(const Scene& scene) {
  const Budget& budget = scene.budget;
  for (const auto& term :
       {budget.tolerance, budget.nearest, budget.ifov, budget.pixels, budget.flux, budget.centroid})
    if (term && (!(*term > 0) || !std::isfinite(*term)))
      return fmt::format("the budget has a term of {}, expected above 0", *term);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto& tolerance = scene.instances[i].tolerance;
    if (tolerance && (!(*tolerance > 0) || !std::isfinite(*tolerance)))
      return fmt::format("instance {} has a tolerance of {}, expected above 0", i, *tolerance);
  }
  return {};
}

std::string check_maps(const Scene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const materials::Maps& maps = scene.materials[i].maps;
    for (const std::int32_t map :
         {maps.albedo, maps.normal, maps.roughness, maps.reflectance, maps.cutout})
      if (map != kNone && !in_range(map, scene.textures.size()))
        return fmt::format("material {} refers to the texture {}, which does not exist", i, map);
    if (!std::isfinite(maps.repeat.x) || !std::isfinite(maps.repeat.y) ||
        !(maps.threshold >= 0 && maps.threshold <= 1))
      return fmt::format(
          "material {} has a map repeat that is not finite or a threshold outside 0 to 1", i);
  }
  return {};
}

}  // namespace

std::vector<Mat4> world_from_nodes(const Scene& scene) {
  std::vector<Mat4> world(scene.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const Node& node = scene.nodes[i];
    const Mat4 local = node.parent_from_node.matrix();
    world[i] = node.parent == kNone ? local : world[static_cast<std::size_t>(node.parent)] * local;
  }
  return world;
}

std::string check(const Scene& scene) {
  for (const auto& part : {check_nodes, check_shapes, check_instances, check_rest, check_truth,
                           check_budget, check_maps, check_joints}) {
    const std::string problem = part(scene);
    if (!problem.empty()) return problem;
  }
  return {};
}

}  // namespace panwright::scene
