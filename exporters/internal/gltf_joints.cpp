#include "exporters/internal/gltf_joints.h"

#include <cmath>
#include <string>

namespace panwright::exporters {

namespace {

using geometry::Joint;
using geometry::JointKind;
using geometry::JointValues;
using nlohmann::ordered_json;

constexpr double kFreeShift = 1000;  // metres

// Which axis of the node an axis is, and whether it points the other way; −1: none of them.
struct Along {
  int axis = -1;
  double sign = 1;
};
Along along(const Vec3& v) {
  for (int k = 0; k < 3; ++k)
    if (std::fabs(v[k]) == 1 && v[(k + 1) % 3] == 0 && v[(k + 2) % 3] == 0) return {k, v[k]};
  return {};
}

// The shortest turn from z, or from -z after half a turn about x: what is half way between is long.
Quat from_z_to(const Vec3& axis) {
  const double sign = axis.z < 0 ? -1 : 1;
  const Vec3 start(0, 0, sign);
  const Vec3 half = glm::normalize(start + axis);
  const Vec3 v = glm::cross(start, half);
  const Quat turn = glm::normalize(Quat(glm::dot(start, half), v.x, v.y, v.z));
  return sign < 0 ? turn * Quat(0, 1, 0, 0) : turn;
}

class Stages {
 public:
  Stages(const Joint& joint, const JointValues& values) : joint_(joint), values_(values) {}

  // One value about, along or of an axis; sign −1: the other way.
  void add(const char* what, int axis, std::size_t index, double sign = 1) {
    const bool turn = std::string_view(what) == "Rotate";
    const bool limited = joint_.limited && joint_.kind != JointKind::continuous;
    double lower = limited ? joint_.lower[index] : turn ? -kPi : -kFreeShift;
    double upper = limited ? joint_.upper[index] : turn ? kPi : kFreeShift;
    double value = values_[index];
    if (turn && !limited) value = geometry::wrapped_angle(value);
    if (sign < 0) {
      std::swap(lower, upper);
      // 0 − x: of 0 it is 0, not −0
      lower = 0 - lower;
      upper = 0 - upper;
      value = 0 - value;
    }
    const double unit = turn ? 1 / kDegree : 1;
    const std::string type =
        axis < 0 ? std::string("uniformScale") : std::string(1, "xyz"[axis]) + what;
    list_.push_back({{"name", type},
                     {"type", type},
                     {"minimumValue", lower * unit},
                     {"initialValue", value * unit},
                     {"maximumValue", upper * unit}});
  }
  ordered_json take() { return std::move(list_); }

 private:
  const Joint& joint_;
  const JointValues& values_;
  ordered_json list_ = ordered_json::array();
};

// R = Rz·Ry·Rx: the first stage is the outermost.
void add_ball(Stages& stages, std::size_t first) {
  for (int k = 2; k >= 0; --k) stages.add("Rotate", k, first + static_cast<std::size_t>(k));
}

}  // namespace

ArticulatedJoint articulated(const Joint& joint, const JointValues& values, std::string_view name,
                             const std::optional<Vec3>& pointing) {
  ArticulatedJoint out;
  out.coupled = joint.mimic >= 0;
  Stages stages(joint, values);
  switch (joint.kind) {
    case JointKind::fixed:
      return out;
    case JointKind::revolute:
    case JointKind::continuous:
    case JointKind::prismatic: {
      const char* what = joint.kind == JointKind::prismatic ? "Translate" : "Rotate";
      const Along axis = along(joint.axis);
      if (axis.axis < 0) out.node_from_axis = from_z_to(joint.axis);
      stages.add(what, axis.axis < 0 ? 2 : axis.axis, 0, axis.sign);
      break;
    }
    case JointKind::ball:
      add_ball(stages, 0);
      break;
    case JointKind::general:
      for (std::size_t k = 0; k < 3; ++k) stages.add("Translate", static_cast<int>(k), 6 + k);
      add_ball(stages, 3);
      for (std::size_t k = 0; k < 3; ++k) stages.add("Scale", static_cast<int>(k), k);
      break;
    case JointKind::scale:
      if (joint.axis.x != 0 && joint.axis.y != 0 && joint.axis.z != 0) {
        stages.add("Scale", -1, 0);
        break;
      }
      for (int k = 0; k < 3; ++k)
        if (joint.axis[k] != 0) stages.add("Scale", k, 0);
      break;
  }
  out.articulation = {{"name", std::string(name)}, {"stages", stages.take()}};
  if (pointing) {
    const Vec3 v = glm::conjugate(out.node_from_axis) * *pointing;
    out.articulation["pointingVector"] = {v.x, v.y, v.z};
  }
  return out;
}

}  // namespace panwright::exporters
