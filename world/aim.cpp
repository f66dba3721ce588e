#include "world/aim.h"

#include <cassert>
#include <cmath>

#include "world/evaluation.h"

namespace panwright::world {
namespace {

bool turns(const pan::layout::Joint& joint) {
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  return kind == geometry::JointKind::revolute || kind == geometry::JointKind::continuous;
}

// The frame in which a joint turns: its node's, with the node's earlier joints applied and its own
// not.
Mat4 frame_of(const pan::Model& model, const std::vector<Mat4>& nodes,
              const std::vector<geometry::JointValues>& values, std::uint32_t joint) {
  const auto joints = model.joints();
  const std::uint32_t node = joints[joint].node;
  const std::int64_t parent = model.nodes()[node].parent;
  Mat4 frame = pan::parent_from_node(model.nodes()[node]);
  if (parent >= 0) frame = nodes[static_cast<std::size_t>(parent)] * frame;
  std::uint32_t first = joint;
  while (first > 0 && joints[first - 1].node == node) --first;
  for (; first < joint; ++first)
    frame = frame * geometry::motion(pan::kinematic(joints[first]), values[first]);
  return frame;
}

// The pointing direction in the joint's frame when it is at rest: later joints of the node turn it.
Vec3 direction_of(const pan::Model& model, const std::vector<geometry::JointValues>& values,
                  std::uint32_t joint) {
  const auto joints = model.joints();
  Mat3 later(1);
  for (std::uint32_t j = joint + 1; j < joints.size() && joints[j].node == joints[joint].node; ++j)
    later = later * Mat3(geometry::motion(pan::kinematic(joints[j]), values[j]));
  const double* p = joints[joint].pointing;
  return later * Vec3(p[0], p[1], p[2]);
}

// The rotation, with a reflection where there is one, of a matrix that also scales evenly.
Mat3 without_scale(const Mat3& m) {
  Mat3 out = m;
  for (int k = 0; k < 3; ++k) {
    const double length = glm::length(out[k]);
    if (length > 0) out[k] /= length;
  }
  return out;
}

// Between two directions that turn about an axis of their own each, what no angle takes away.
double cones_apart(const Vec3& axis, const Vec3& v, const Vec3& target) {
  return std::fabs(angle_between(axis, v) - angle_between(axis, target));
}

Aimed turn(World& world, std::size_t index, std::uint32_t joint, const Vec3& direction,
           bool aimed) {
  const pan::Model& model = *world[index].model();
  assert(can_aim(model, joint));
  const auto values = world[index].joint_values();
  const std::vector<Mat4> nodes = evaluated(world[index]).model_from_nodes;
  const Vec3 in_model = glm::inverse(world[index].pose().rotation) * direction;
  const pan::layout::Joint& record = model.joints()[joint];
  const geometry::Joint inner = pan::kinematic(record);
  const Mat4 inner_frame = frame_of(model, nodes, values, joint);
  const Vec3 v = direction_of(model, values, joint);
  const auto in_frame = [&](const Mat4& frame) {
    return glm::transpose(without_scale(Mat3(frame))) * in_model;
  };
  if (record.gimbal < 0) {
    const auto found = geometry::point_one(inner, v, in_frame(inner_frame), values[joint][0]);
    world.set_joint(index, joint, found.values, aimed);
    return {found.error, cones_apart(inner.axis, v, in_frame(inner_frame))};
  }
  const auto gimbal = static_cast<std::uint32_t>(record.gimbal);
  const geometry::Joint outer = pan::kinematic(model.joints()[gimbal]);
  const Mat4 outer_frame = frame_of(model, nodes, values, gimbal);
  const Mat3 turned =
      without_scale(Mat3(outer_frame)) * Mat3(geometry::motion(outer, values[gimbal]));
  const Mat3 between = glm::transpose(turned) * without_scale(Mat3(inner_frame));
  const auto found = geometry::point_two(outer, between, inner, v, in_frame(outer_frame),
                                         values[gimbal][0], values[joint][0]);
  geometry::JointValues one{}, two{};
  one[0] = found.outer;
  two[0] = found.inner;
  world.set_joint(index, gimbal, one, aimed);
  world.set_joint(index, joint, two, aimed);
  geometry::Joint free_outer = outer, free_inner = inner;
  free_outer.limited = free_inner.limited = false;
  const auto best = geometry::point_two(free_outer, between, free_inner, v, in_frame(outer_frame),
                                        found.outer, found.inner);
  return {found.error, best.error};
}

}  // namespace

bool can_aim(const pan::Model& model, std::uint32_t joint) {
  const pan::layout::Joint& record = model.joints()[joint];
  const double* p = record.pointing;
  if (record.mimic >= 0 || !turns(record) || (p[0] == 0 && p[1] == 0 && p[2] == 0)) return false;
  return record.gimbal < 0 || model.joints()[static_cast<std::size_t>(record.gimbal)].mimic < 0;
}

Aimed aim(World& world, std::size_t index, std::uint32_t joint, const Vec3& direction) {
  return turn(world, index, joint, direction, false);
}

Aimed aim_at_point(World& world, std::size_t index, std::uint32_t joint, const Vec3& point) {
  const pan::Model& model = *world[index].model();
  const std::uint32_t node = model.joints()[joint].node;
  const auto towards = [&] {
    const Pose& pose = world[index].pose();
    const Vec3 at(evaluated(world[index]).model_from_nodes[node][3]);
    return point - (pose.translation + pose.rotation * at);
  };
  // a gimbal may carry the joint's origin along: what that shifts shrinks from turn to turn by its
  // share of the distance
  Aimed found;
  for (int i = 0; i < 32; ++i) {
    const Vec3 direction = towards();
    if (direction == Vec3(0)) return found;
    found = turn(world, index, joint, direction, false);
    if (angle_between(direction, towards()) < 1e-15) break;
  }
  return found;
}

void aim_at_sun(World& world,
                const std::function<void(std::size_t, std::uint32_t, double)>& unreached) {
  for (std::size_t i = 0; i < world.size(); ++i) {
    const pan::Model& model = *world[i].model();
    for (std::uint32_t j = 0; j < model.joints().size(); ++j) {
      const pan::layout::Joint& joint = model.joints()[j];
      if ((joint.flags & pan::layout::kJointPointsAtSun) == 0 || !can_aim(model, j)) continue;
      const auto given = [&](std::uint32_t k) {
        const JointState* state = world[i].joint_state(k);
        return state != nullptr && !state->aimed;
      };
      if (given(j) || (joint.gimbal >= 0 && given(static_cast<std::uint32_t>(joint.gimbal))))
        continue;
      // with what it begins with, so that what came before does not matter
      world.set_joint(i, j, std::nullopt);
      if (joint.gimbal >= 0) world.set_joint(i, static_cast<std::uint32_t>(joint.gimbal), {});
      const Aimed found = turn(world, i, j, world.sun().direction, true);
      if (unreached && found.limited()) unreached(i, j, found.error);
    }
  }
}

}  // namespace panwright::world
