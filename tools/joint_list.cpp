#include "tools/joint_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "workspace/joints.h"
#include "world/aim.h"

namespace panwright::tools {

namespace {

using geometry::JointKind;
using Json = nlohmann::ordered_json;

JointKind kind_of(const pan::layout::Joint& joint) { return static_cast<JointKind>(joint.kind); }

Json numbers_json(const double* values, std::size_t count) {
  return std::vector<double>(values, values + count);
}

Json joint_json(const pan::Model& model, std::size_t i, const geometry::JointValues& values) {
  const pan::layout::Joint& joint = model.joints()[i];
  const std::size_t count = geometry::value_count(kind_of(joint));
  Json out;
  out["name"] = model.joint_name(i);
  out["type"] = geometry::kind_name(kind_of(joint));
  out["node"] = joint.node;
  out["path"] = model.node_path(joint.node);
  out["axis"] = numbers_json(joint.axis, 3);
  const bool limited = (joint.flags & pan::layout::kJointLimited) != 0;
  out["lower"] = limited ? numbers_json(joint.lower, count) : Json();
  out["upper"] = limited ? numbers_json(joint.upper, count) : Json();
  out["initial"] = numbers_json(joint.value, count);
  out["value"] = numbers_json(values.data(), count);
  out["mimic"] = joint.mimic < 0 ? Json() : Json(model.joint_name(joint.mimic));
  if (joint.mimic >= 0) {
    out["multiplier"] = joint.multiplier;
    out["offset"] = joint.offset;
  }
  const bool aims = world::can_aim(model, static_cast<std::uint32_t>(i));
  out["pointing"] = aims ? numbers_json(joint.pointing, 3) : Json();
  out["gimbal"] = joint.gimbal < 0 ? Json() : Json(model.joint_name(joint.gimbal));
  out["point_at"] = joint.flags & pan::layout::kJointPointsAtSun ? "sun" : "nothing";
  return out;
}

// Number of nodes with joints above each node.
std::vector<std::size_t> depths_of(const pan::Model& model) {
  const auto nodes = model.nodes();
  std::vector<char> moves(nodes.size(), 0);
  for (const pan::layout::Joint& joint : model.joints()) moves[joint.node] = 1;
  std::vector<std::size_t> out(nodes.size(), 0);
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const auto parent = static_cast<std::size_t>(nodes[i].parent);
    out[i] = out[parent] + (moves[parent] ? 1 : 0);
  }
  return out;
}

std::string joint_line(const pan::Model& model, std::size_t i, std::size_t depth,
                       const geometry::JointValues& values) {
  const pan::layout::Joint& joint = model.joints()[i];
  const JointKind kind = kind_of(joint);
  std::string line =
      fmt::format("{:{}}{}  {}", "", 2 * depth, model.joint_name(i), geometry::kind_name(kind));
  if (kind == JointKind::revolute || kind == JointKind::continuous ||
      kind == JointKind::prismatic || kind == JointKind::scale)
    line +=
        fmt::format(" {} {:.6g} {:.6g} {:.6g}",
                    kind == JointKind::prismatic || kind == JointKind::scale ? "along" : "about",
                    joint.axis[0], joint.axis[1], joint.axis[2]);
  const std::size_t count = geometry::value_count(kind);
  if (count > 0) line += ", at " + workspace::shown_value(kind, values);
  if ((joint.flags & pan::layout::kJointLimited) != 0) {
    geometry::JointValues lower{}, upper{};
    std::copy_n(joint.lower, count, lower.begin());
    std::copy_n(joint.upper, count, upper.begin());
    line += fmt::format(", {} to {}", workspace::shown_value(kind, lower),
                        workspace::shown_value(kind, upper));
  }
  if (joint.mimic >= 0) {
    line += fmt::format(", follows {}", model.joint_name(static_cast<std::size_t>(joint.mimic)));
    if (joint.multiplier != 1) line += fmt::format(" times {:.6g}", joint.multiplier);
    geometry::JointValues offset{};
    offset[0] = joint.offset;
    if (joint.offset != 0) line += " plus " + workspace::shown_value(kind, offset);
  }
  if (world::can_aim(model, static_cast<std::uint32_t>(i)))
    line += fmt::format(
        ", points {:.6g} {:.6g} {:.6g}{}{}", joint.pointing[0], joint.pointing[1],
        joint.pointing[2],
        joint.gimbal < 0 ? std::string() : fmt::format(" with {}", model.joint_name(joint.gimbal)),
        joint.flags & pan::layout::kJointPointsAtSun ? " at the Sun" : "");
  return line;
}

}  // namespace

std::vector<std::string> joint_lines(const pan::Model& model,
                                     const std::vector<geometry::JointValues>& values) {
  const std::vector<std::size_t> depths = depths_of(model);
  std::vector<std::string> out;
  for (std::size_t i = 0; i < values.size(); ++i)
    out.push_back(joint_line(model, i, depths[model.joints()[i].node], values[i]));
  return out;
}

nlohmann::ordered_json joints_json(const pan::Model& model,
                                   const std::vector<geometry::JointValues>& values) {
  Json out = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) out.push_back(joint_json(model, i, values[i]));
  return out;
}

}  // namespace panwright::tools
