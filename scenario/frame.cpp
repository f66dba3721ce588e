#include "scenario/frame.h"

#include <algorithm>

namespace panwright::scenario {

const TargetState* Frame::find(std::string_view wanted) const {
  const auto found = std::ranges::find(targets, wanted, &TargetState::name);
  return found == targets.end() ? nullptr : &*found;
}

TargetState& Frame::target(std::string_view wanted) {
  const auto found = std::ranges::find(targets, wanted, &TargetState::name);
  if (found != targets.end()) return *found;
  targets.push_back({std::string(wanted), {}, {}});
  return targets.back();
}

JointValue& Frame::joint(std::string_view of, std::string_view joint) {
  std::vector<JointValue>& joints = target(of).joints;
  const auto found = std::ranges::find(joints, joint, &JointValue::joint);
  if (found != joints.end()) return *found;
  joints.push_back({std::string(joint), {}, 0});
  return joints.back();
}

}  // namespace panwright::scenario
