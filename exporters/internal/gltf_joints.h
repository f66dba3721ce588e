// Joints as AGI_articulations, the vendor extension of glTF for spacecraft articulation.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "base/math.h"
#include "geometry/kinematics/joint.h"

namespace panwright::exporters {

// Stages of a joint on a node whose z is along its axis, or of one that needs no such node.
struct ArticulatedJoint {
  Quat node_from_axis{1, 0, 0,
                      0};  // turns z to the axis; the identity if it is an axis of the node
  nlohmann::ordered_json articulation;  // null: fixed
  bool coupled = false;                 // followed another joint, which is lost
};

// Angles in degrees, about and along axes of the node. Values begin with those given; joints
// without limits get a whole turn, or 1 km.
//
//   values    resolved
//   pointing  in the node's axes; of a joint that aims alone
ArticulatedJoint articulated(const geometry::Joint& joint, const geometry::JointValues& values,
                             std::string_view name, const std::optional<Vec3>& pointing);

}  // namespace panwright::exporters
