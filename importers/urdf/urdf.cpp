#include "importers/urdf/urdf.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/text.h"
#include "importers/urdf/internal/robot.h"

namespace panwright::importers::urdf {

namespace {

// Two directions across an axis: for z, x and y; and so on in a circle.
std::array<Vec3, 2> across(const Vec3& axis) {
  int main = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(axis[k]) > std::fabs(axis[main])) main = k;
  Vec3 next(0);
  next[(main + 1) % 3] = 1;
  const Vec3 first = glm::normalize(next - axis * glm::dot(axis, next));
  return {first, glm::cross(axis, first)};
}

class SceneMaker {
 public:
  SceneMaker(const Robot& robot, meshes::ReaderContext& context)
      : robot_(robot),
        c_(context),
        out_(robot.paints, context, Format::urdf),
        leader_(robot.joints.size(), kNone) {}

  Imported made(const std::vector<std::int32_t>& hangs_on) {
    std::vector<std::vector<std::int32_t>> below(robot_.links.size());
    struct Step {
      std::int32_t link, parent;
      std::uint32_t depth;
    };
    std::vector<Step> steps;  // the last one is next
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const std::int32_t joint = hangs_on[i];
      const auto link = static_cast<std::int32_t>(i);
      if (joint == kNone)
        steps.push_back({link, 0, 1});
      else
        below[static_cast<std::size_t>(robot_.joints[static_cast<std::size_t>(joint)].parent)]
            .push_back(joint);
    }
    for (auto& joints : below) std::ranges::sort(joints, std::greater());
    std::ranges::reverse(steps);
    while (!steps.empty() && !c_.full) {
      const Step step = steps.back();
      steps.pop_back();
      const auto link = static_cast<std::size_t>(step.link);
      if (step.depth > c_.options.limits.depth) {
        c_.limit(fmt::format("links are nested more than {} deep", c_.options.limits.depth),
                 robot_.links[link].where);
        break;
      }
      const std::int32_t node = add_link(link, hangs_on[link], step.parent);
      if (node == kNone) break;
      for (const std::int32_t joint : below[link])
        steps.push_back(
            {robot_.joints[static_cast<std::size_t>(joint)].child, node, step.depth + 1});
    }
    couple();
    return out_.finished();
  }

 private:
  scene::Transform& transform_of(std::int32_t node) { return out_.node(node).parent_from_node; }

  std::int32_t add_link(std::size_t index, std::int32_t joint, std::int32_t parent) {
    const Link& link = robot_.links[index];
    const std::int32_t node = out_.assembly.add_node(parent, link.name, "link", link.where);
    if (node == kNone) return kNone;
    if (joint != kNone) {
      const Origin& origin = robot_.joints[static_cast<std::size_t>(joint)].origin;
      transform_of(node).translation = origin.xyz;
      transform_of(node).rotation = origin.rotation;
      add_joint(static_cast<std::size_t>(joint), link, node);
    }
    std::size_t number = 0;
    for (const Visual& visual : link.visuals) {
      ++number;
      std::string name = visual.name;
      if (name.empty())
        name = number == 1 ? link.name + "_visual" : fmt::format("{}_visual{}", link.name, number);
      const std::int32_t place = out_.assembly.add_node(node, name, "visual", visual.where);
      if (place == kNone) return kNone;
      transform_of(place).translation = visual.origin.xyz;
      transform_of(place).rotation = visual.origin.rotation;
      add_visual(visual, place);
    }
    return node;
  }

  // ---- joints

  void add_joint(std::size_t index, const Link& link, std::int32_t node) {
    const RobotJoint& from = robot_.joints[index];
    scene::Joint joint;
    joint.name = scene_name(from.name);
    joint.node = node;
    joint.axis = from.axis;
    joint.source = out_.assembly.source_of(from.where);
    joint.mass = link.mass;
    if (link.mass) joint.centre_of_mass = link.inertial.xyz;
    if (link.inertia) {
      const Mat3 turn = glm::mat3_cast(link.inertial.rotation);
      joint.inertia = turn * *link.inertia * glm::transpose(turn);
    }
    std::vector<scene::Joint>& joints = out_.scene().joints;
    if (from.type == JointType::planar) return add_planar(joint);
    joint.kind = kind_of(from);
    if (from.limits) {
      joint.lower = {from.limits->x};
      joint.upper = {from.limits->y};
      const double begins = std::clamp(0.0, from.limits->x, from.limits->y);
      if (begins != 0) joint.value = {begins};
      if (begins != 0 && !from.mimic)
        c_.log.report(Code("W6221"), from.where,
                      fmt::format("0 is outside the limits of the joint {}: it begins at {:g}",
                                  in_quotes(from.name), begins));
    }
    if (geometry::value_count(joint.kind) == 1)
      leader_[index] = static_cast<std::int32_t>(joints.size());
    joints.push_back(std::move(joint));
  }

  static geometry::JointKind kind_of(const RobotJoint& joint) {
    using geometry::JointKind;
    switch (joint.type) {
      case JointType::revolute:
        return joint.limits ? JointKind::revolute : JointKind::continuous;
      case JointType::continuous:
        return JointKind::continuous;
      case JointType::prismatic:
        return JointKind::prismatic;
      case JointType::floating:
        return JointKind::general;
      case JointType::fixed:
      case JointType::planar:
        break;
    }
    return JointKind::fixed;
  }

  // Two directions of one node: the first one is the outer one, and moves the other's frame along.
  void add_planar(const scene::Joint& joint) {
    const auto directions = across(joint.axis);
    for (std::size_t k = 0; k < 2; ++k) {
      scene::Joint one = joint;
      one.name += k == 0 ? " x" : " y";
      one.kind = geometry::JointKind::prismatic;
      one.axis = directions[k];
      if (k == 0) {  // what hangs on both is counted once
        one.mass.reset();
        one.centre_of_mass.reset();
        one.inertia.reset();
      }
      out_.scene().joints.push_back(std::move(one));
    }
  }

  // Joints that follow others.
  void couple() {
    std::unordered_map<std::string_view, std::size_t> named;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) named.emplace(robot_.joints[i].name, i);
    std::vector<scene::Joint>& joints = out_.scene().joints;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const auto& mimic = robot_.joints[i].mimic;
      if (!mimic) continue;
      const auto found = named.find(mimic->joint);
      const std::int32_t leader = found == named.end() ? kNone : leader_[found->second];
      if (leader == kNone || leader_[i] == kNone) {
        const std::string problem =
            found == named.end()
                ? fmt::format("there is no joint {}", in_quotes(mimic->joint))
                : fmt::format("{} cannot follow {}, expected joints of one value each",
                              in_quotes(robot_.joints[i].name), in_quotes(mimic->joint));
        c_.log.report(Code("E6220"), mimic->where, problem + "; the joint moves independently");
        continue;
      }
      scene::Joint& joint = joints[static_cast<std::size_t>(leader_[i])];
      joint.mimic = leader;
      joint.multiplier = mimic->multiplier;
      joint.offset = mimic->offset;
      joint.value.clear();
    }
    cut_rings(joints);
    // what follows nothing after all begins within its limits
    for (scene::Joint& joint : joints)
      if (joint.mimic == kNone && joint.value.empty() && joint.lower.size() == 1 &&
          std::clamp(0.0, joint.lower[0], joint.upper[0]) != 0)
        joint.value = {std::clamp(0.0, joint.lower[0], joint.upper[0])};
  }

  void cut_rings(std::vector<scene::Joint>& joints) {
    std::vector<std::uint32_t> seen(joints.size(), 0);  // the walk that came by
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      if (leader_[i] == kNone) continue;
      const auto walk = static_cast<std::uint32_t>(i) + 1;
      auto at = static_cast<std::size_t>(leader_[i]);
      while (seen[at] == 0) {
        seen[at] = walk;
        if (joints[at].mimic == kNone) break;
        at = static_cast<std::size_t>(joints[at].mimic);
      }
      if (seen[at] != walk || joints[at].mimic == kNone) continue;
      joints[at].mimic = kNone;
      joints[at].multiplier = 1;
      joints[at].offset = 0;
      c_.log.report(Code("E6220"), robot_.joints[i].mimic->where,
                    fmt::format("the joint {} follows itself; it moves independently",
                                in_quotes(joints[at].name)));
    }
  }

  // ---- what is seen

  void add_visual(const Visual& visual, std::int32_t node) {
    const Cover cover = out_.painter.cover_of(visual.paint);
    if (const auto* mesh = std::get_if<MeshFile>(&visual.geometry)) {
      transform_of(node).scale = mesh->scale;
      return out_.meshes.attach(*mesh, node, cover);
    }
    (void)out_.add_shape(std::get<geometry::Shape>(visual.geometry), node, cover, visual.where);
  }

  const Robot& robot_;
  meshes::ReaderContext& c_;
  RobotScene out_;
  std::vector<std::int32_t> leader_;  // of each joint of the robot, of one value: in the scene
};

}  // namespace

bool is_robot(std::string_view text) { return first_element_is(text, "robot"); }

Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log) {
  const auto made = [](XmlText& text, meshes::ReaderContext& context) -> std::optional<Imported> {
    const Robot robot = read_robot(text, context);
    if (robot.links.empty()) return std::nullopt;
    return SceneMaker(robot, context).made(tree_of(robot, context));
  };
  return read_robot_file(files, file, options, log, made,
                         "the robot has no link, expected at least one");
}

}  // namespace panwright::importers::urdf
