// Records of joints, each alone and all together.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/kinematics/joint.h"
#include "pan/internal/report.h"

namespace panwright::pan::internal {

namespace {

// Of one joint alone.
std::string one_joint_problem(const layout::Joint& joint) {
  const auto is_unit3 = [](const double* v) {
    return std::fabs(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - 1.0) <= kUnitQuaternionTolerance;
  };
  if (!is_unit3(joint.axis)) return "has an axis that is not of unit length";
  const double* p = joint.pointing;
  if ((p[0] != 0 || p[1] != 0 || p[2] != 0) && !is_unit3(p))
    return "has a pointing direction that is neither 0 nor of unit length";
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  const bool limited = (joint.flags & layout::kJointLimited) != 0;
  const std::size_t count = geometry::value_count(kind);
  for (std::size_t i = 0; i < geometry::kMaxJointValues; ++i) {
    const double lower = joint.lower[i], upper = joint.upper[i], value = joint.value[i];
    if ((i >= count || !limited) && (lower != 0 || upper != 0))
      return fmt::format("has limits of value {}, which its kind does not have", i);
    if (i >= count && value != 0) return fmt::format("has a value {} beyond those of its kind", i);
    if (i >= count) continue;
    if (limited && !(lower <= upper)) return "has a lower limit above the upper one";
    if (limited && joint.mimic == -1 && kind != geometry::JointKind::continuous &&
        !(value >= lower && value <= upper))
      return "has an initial value outside its limits";
    if (value == 0 && geometry::unit_of(kind, i) == geometry::JointUnit::factor)
      return "has an initial factor of 0";
  }
  return {};
}

bool turns(const layout::Joint& joint) {
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  return kind == geometry::JointKind::revolute || kind == geometry::JointKind::continuous;
}

// Expects: references that hold, nodes in order.
std::string aim_problem(const Model& model, const layout::Joint& joint) {
  const double* p = joint.pointing;
  const bool points = p[0] != 0 || p[1] != 0 || p[2] != 0;
  if (points && !turns(joint)) return "points without turning";
  if (!points && (joint.gimbal >= 0 || (joint.flags & layout::kJointPointsAtSun)))
    return "aims without a pointing direction";
  if (joint.gimbal < 0) return {};
  const layout::Joint& outer = model.joints()[static_cast<std::size_t>(joint.gimbal)];
  if (!turns(outer)) return "has a gimbal that does not turn";
  std::int64_t node = joint.node;
  while (node >= 0 && node != outer.node)
    node = model.nodes()[static_cast<std::size_t>(node)].parent;
  return node < 0 || &outer >= &joint ? "has a gimbal that is not above it" : "";
}

}  // namespace

std::optional<Problem> joint_problem(const Model& model) {
  const auto joints = model.joints();
  std::vector<geometry::Joint> all;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    std::string problem = one_joint_problem(joints[i]);
    if (problem.empty() && i > 0 && joints[i].node < joints[i - 1].node)
      problem = "is out of order, expected them ascending by node";
    const std::string_view name = unchecked_string(model, joints[i].name);
    if (problem.empty() && name.empty()) problem = "has no name";
    if (problem.empty()) problem = aim_problem(model, joints[i]);
    if (!problem.empty()) return Problem{Code("E4012"), fmt::format("joints[{}] {}", i, problem)};
    names.push_back(name);
    all.push_back(kinematic(joints[i]));
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    return Problem{Code("E4012"), fmt::format("two joints have the name {}", in_quotes(*twice))};
  std::size_t wrong = 0;
  if (!geometry::JointSet::of(std::move(all), &wrong))
    return Problem{Code("E4012"),
                   fmt::format("joints[{}].mimic is a joint that it cannot follow", wrong)};
  return {};
}

}  // namespace panwright::pan::internal
