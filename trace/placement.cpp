#include "trace/placement.h"

#include <algorithm>
#include <cmath>

namespace panwright::trace {
namespace {

Affine from_trs(const Vec3& translation, const Quat& rotation, const Vec3& scale) {
  Affine result{rotation_matrix(rotation), translation};
  for (int axis = 0; axis < 3; ++axis) result.linear[axis] *= scale[axis];
  return result;
}

Affine parent_from(const pan::layout::Node& node) {
  const double* q = node.rotation;
  return from_trs({node.translation[0], node.translation[1], node.translation[2]},
                  Quat(q[0], q[1], q[2], q[3]), {node.scale[0], node.scale[1], node.scale[2]});
}

Quat about(const Vec3& axis, double angle) {
  const auto half = det::sincos(angle / 2);
  return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}

// What a joint does to its node, by quaternions.
Affine moved(const geometry::Joint& joint, const geometry::JointValues& q) {
  using geometry::JointKind;
  const auto turned = [&](std::size_t first) {
    return about({0, 0, 1}, q[first + 2]) * about({0, 1, 0}, q[first + 1]) *
           about({1, 0, 0}, q[first]);
  };
  const Quat still(1, 0, 0, 0);
  switch (joint.kind) {
    case JointKind::fixed:
      break;
    case JointKind::revolute:
    case JointKind::continuous:
      return from_trs(Vec3(0), about(joint.axis, q[0]), Vec3(1));
    case JointKind::prismatic:
      return from_trs(joint.axis * q[0], still, Vec3(1));
    case JointKind::ball:
      return from_trs(Vec3(0), turned(0), Vec3(1));
    case JointKind::general:
      return from_trs({q[6], q[7], q[8]}, turned(3), {q[0], q[1], q[2]});
    case JointKind::scale:
      return from_trs(Vec3(0), still,
                      {joint.axis.x != 0 ? q[0] : 1, joint.axis.y != 0 ? q[0] : 1,
                       joint.axis.z != 0 ? q[0] : 1});
  }
  return {};
}

// The values that the joints of a target take.
std::vector<geometry::JointValues> values_of(const world::Instance& instance,
                                             const geometry::JointSet& joints) {
  std::vector<geometry::JointValues> values(joints.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    std::copy_n(instance.model()->joints()[i].value, values[i].size(), values[i].begin());
  for (const world::JointState& state : instance.joint_states()) values[state.joint] = state.values;
  joints.resolve(values);
  return values;
}

}  // namespace

// Each axis turned by itself: v + 2 (w u×v + u×(u×v)) / |q|², u the vector part.
Mat3 rotation_matrix(const Quat& q) {
  const Vec3 u(q.x, q.y, q.z);
  const double twice = 2 / (q.w * q.w + glm::dot(u, u));
  Mat3 result(1);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3& v = result[axis];
    const Vec3 across = glm::cross(u, v);
    v += twice * (q.w * across + glm::cross(u, across));
  }
  return result;
}

RigidFrame frame_of(const world::Pose& pose) {
  return {rotation_matrix(pose.rotation), pose.translation};
}

Affine between(const RigidFrame& to, const RigidFrame& from) {
  const Mat3 to_from_world = glm::transpose(to.world_from);
  return {to_from_world * from.world_from, to_from_world * (from.position - to.position)};
}

PlacedNodes placed_nodes(const world::Instance& instance) {
  const auto nodes = instance.model()->nodes();
  const geometry::JointSet joints = instance.model()->joint_set();
  const std::vector<geometry::JointValues> values = values_of(instance, joints);
  std::size_t joint = 0;  // in the order of their nodes
  PlacedNodes result;
  result.model_from_node.reserve(nodes.size());
  result.visible.reserve(nodes.size());
  // parents stand before their children
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const world::NodeState* state = instance.node_state(i);
    Affine place = state && state->transform
                       ? from_trs(state->transform->translation, state->transform->rotation,
                                  state->transform->scale)
                       : parent_from(nodes[i]);
    for (; joint < joints.size() && instance.model()->joints()[joint].node == i; ++joint)
      place = place * moved(joints[joint], values[joint]);
    bool visible = instance.visible() && (!state || state->visible);
    if (nodes[i].parent >= 0) {
      const auto parent = static_cast<std::size_t>(nodes[i].parent);
      place = result.model_from_node[parent] * place;
      visible = visible && result.visible[parent] != 0;
    }
    result.model_from_node.push_back(place);
    result.visible.push_back(visible);
  }
  return result;
}

Mat3 normal_matrix(const Mat3& linear) {
  // a normal is the cross product of two directions in its plane: those of the axes' planes
  Mat3 normals;
  for (int axis = 0; axis < 3; ++axis)
    normals[axis] = glm::cross(linear[(axis + 1) % 3], linear[(axis + 2) % 3]);
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, std::fabs(normals[axis][row]));
  const double inwards = glm::dot(linear[0], normals[0]) < 0 ? -1 : 1;
  return largest > 0 ? normals * (inwards / largest) : normals;
}

}  // namespace panwright::trace
