#include "scene/scene.h"

#include <fmt/core.h>

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
    if (instance.back != kNone) {
      if (!in_range(instance.back, scene.materials.size()))
        return fmt::format("instance {} has a back of material {}, which does not exist", i,
                           instance.back);
      if (!same_holes(scene.materials[static_cast<std::size_t>(instance.material)],
                      scene.materials[static_cast<std::size_t>(instance.back)]))
        return fmt::format("instance {} has other holes on its back", i);
    }
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

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

std::string check_joint(const Scene& scene, const Joint& joint) {
  const auto count = geometry::value_count(joint.kind);
  if (!in_range(joint.node, scene.nodes.size()) || !panwright::is_finite(joint.axis) ||
      !(std::abs(glm::length(joint.axis) - 1) <= kUnitTolerance))
    return "has an unknown node or an axis that is not of unit length";
  if (joint.lower.size() != joint.upper.size() || !all_finite(joint.lower) ||
      !all_finite(joint.upper) || (!joint.lower.empty() && joint.lower.size() != count))
    return "has limits that are not finite, do not come in pairs or are not one of each value";
  if (!all_finite(joint.value) || (!joint.value.empty() && joint.value.size() != count))
    return "has values that are not finite or not as many as it takes";
  for (std::size_t i = 0; i < joint.lower.size(); ++i) {
    const double value = initial_values(joint)[i];
    if (!(joint.lower[i] <= joint.upper[i])) return "has a lower limit above the upper one";
    if (joint.mimic == kNone && joint.kind != JointKind::continuous &&
        !(value >= joint.lower[i] && value <= joint.upper[i]))
      return "has an initial value outside its limits";
  }
  for (std::size_t i = 0; i < count; ++i)
    if (geometry::unit_of(joint.kind, i) == geometry::JointUnit::factor &&
        initial_values(joint)[i] == 0)
      return "has an initial factor of 0";
  if (!std::isfinite(joint.multiplier) || !std::isfinite(joint.offset))
    return "follows another by numbers that are not finite";
  if (joint.pointing && !(std::abs(glm::length(*joint.pointing) - 1) <= kUnitTolerance))
    return "has a pointing direction that is not of unit length";
  const auto turns = [](const Joint& one) {
    return one.kind == JointKind::revolute || one.kind == JointKind::continuous;
  };
  if (joint.pointing ? !turns(joint) : joint.gimbal != kNone || joint.point_at != PointAt::nothing)
    return "aims without turning or without a pointing direction";
  if (joint.gimbal == kNone) return {};
  if (!in_range(joint.gimbal, scene.joints.size())) return "has an unknown gimbal";
  const Joint& outer = scene.joints[static_cast<std::size_t>(joint.gimbal)];
  std::int32_t node = joint.node;
  while (node != kNone && node != outer.node)
    node = scene.nodes[static_cast<std::size_t>(node)].parent;
  const bool further_out = node != joint.node || &outer < &joint;
  if (!turns(outer) || node == kNone || !further_out)
    return "has a gimbal that does not turn or is not above it";
  return {};
}

std::string check_joints(const Scene& scene) {
  std::vector<geometry::Joint> joints;
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const std::string problem = check_joint(scene, scene.joints[i]);
    if (!problem.empty()) return fmt::format("joint {} {}", i, problem);
    joints.push_back(kinematic(scene.joints[i]));
  }
  std::size_t wrong = 0;
  if (!geometry::JointSet::of(std::move(joints), &wrong))
    return fmt::format("joint {} has an invalid joint to follow", wrong);
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

std::string check_lamps(const Scene& scene) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < scene.lamps.size(); ++i) {
    const Lamp& lamp = scene.lamps[i];
    const Vec3& intensity = lamp.intensity;
    if (!in_range(lamp.node, scene.nodes.size()) || !panwright::is_finite(lamp.position) ||
        !(std::abs(glm::length(lamp.axis) - 1) <= kUnitTolerance))
      return fmt::format(
          "lamp {} has an unknown node, a position that is not finite or an axis "
          "that is not of unit length",
          i);
    if (!panwright::is_finite(intensity) ||
        !(std::min({intensity.x, intensity.y, intensity.z}) >= 0) || !(lamp.exponent >= 0) ||
        !(lamp.radius >= 0) || !std::isfinite(lamp.exponent + lamp.radius) ||
        (lamp.kind == Lamp::Kind::spot && !(lamp.half_angle > 0 && lamp.half_angle <= kPi)) ||
        (lamp.kind == Lamp::Kind::disc && lamp.radius == 0) ||
        (lamp.pulse &&
         !(lamp.pulse->x < lamp.pulse->y && std::isfinite(lamp.pulse->y - lamp.pulse->x))))
      return fmt::format("lamp {} has numbers out of range", i);
    if (lamp.name.empty() || !names.insert(lamp.name).second)
      return fmt::format("duplicate lamp name {}", lamp.name);
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

bool same_holes(const materials::Material& a, const materials::Material& b) {
  return a.maps.cutout == b.maps.cutout &&
         (a.maps.cutout < 0 ||
          (a.maps.threshold == b.maps.threshold && a.maps.repeat == b.maps.repeat));
}

double steradians(const Lamp& lamp) {
  if (lamp.kind == Lamp::Kind::point) return 4 * kPi;
  if (lamp.kind == Lamp::Kind::disc) return kPi;
  if (lamp.exponent == 0) return 2 * kPi * (1 - det::cos(lamp.half_angle));
  const double edge = std::max(det::cos(std::min(lamp.half_angle, kPi / 2)), 0.0);
  const double lost = edge > 0 ? det::exp((lamp.exponent + 1) * det::log(edge)) : 0;
  return 2 * kPi * (1 - lost) / (lamp.exponent + 1);
}

bool can_move(const Joint& joint) {
  return joint.kind != JointKind::fixed && (joint.lower.empty() || joint.lower != joint.upper);
}

geometry::Joint kinematic(const Joint& joint) {
  geometry::Joint out;
  out.kind = joint.kind;
  out.axis = joint.axis;
  out.limited = !joint.lower.empty();
  std::ranges::copy(joint.lower, out.lower.begin());
  std::ranges::copy(joint.upper, out.upper.begin());
  out.mimic = joint.mimic;
  out.multiplier = joint.multiplier;
  out.offset = joint.offset;
  return out;
}

geometry::JointValues initial_values(const Joint& joint) {
  geometry::JointValues out = geometry::rest_values(joint.kind);
  std::ranges::copy(joint.value, out.begin());
  return out;
}

std::vector<std::string> joint_names(const Scene& scene) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Joint& joint : scene.joints) {
    std::string base = joint.name;
    if (base.empty()) base = scene.nodes[static_cast<std::size_t>(joint.node)].name;
    if (base.empty()) base = "joint";
    std::string name = base;
    for (std::size_t n = 2; !taken.insert(name).second; ++n) name = fmt::format("{}#{}", base, n);
    names.push_back(std::move(name));
  }
  return names;
}

std::vector<Mat4> world_from_nodes(const Scene& scene) {
  std::vector<geometry::Joint> joints;
  std::vector<geometry::JointValues> values;
  for (const Joint& joint : scene.joints) {
    joints.push_back(kinematic(joint));
    values.push_back(initial_values(joint));
  }
  const auto set = geometry::JointSet::of(std::move(joints));
  if (set) set->resolve(values);
  std::vector<Mat4> local(scene.nodes.size());
  for (std::size_t i = 0; i < local.size(); ++i)
    local[i] = scene.nodes[i].parent_from_node.matrix();
  for (std::size_t j = 0; set && j < set->size(); ++j) {
    Mat4& matrix = local[static_cast<std::size_t>(scene.joints[j].node)];
    matrix = matrix * geometry::motion((*set)[j], values[j]);
  }
  std::vector<Mat4> world(scene.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const std::int32_t parent = scene.nodes[i].parent;
    world[i] = parent == kNone ? local[i] : world[static_cast<std::size_t>(parent)] * local[i];
  }
  return world;
}

std::string check(const Scene& scene) {
  for (const auto& part : {check_nodes, check_shapes, check_instances, check_rest, check_truth,
                           check_lamps, check_budget, check_maps, check_joints}) {
    const std::string problem = part(scene);
    if (!problem.empty()) return problem;
  }
  return {};
}

}  // namespace panwright::scene
