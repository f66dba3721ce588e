#include <fmt/core.h>

#include "base/text.h"
#include "importers/urdf/internal/robot.h"

namespace panwright::importers::urdf {

namespace {

// Takes one joint out of each ring of links.
void cut_rings(const Robot& robot, std::vector<std::int32_t>& hangs_on,
               meshes::ReaderContext& context) {
  std::vector<std::int32_t> seen(robot.links.size(), 0);  // 0: not yet; else the walk that came by
  for (std::size_t begin = 0; begin < robot.links.size(); ++begin) {
    const auto walk = static_cast<std::int32_t>(begin) + 1;
    std::size_t link = begin;
    while (seen[link] == 0) {
      seen[link] = walk;
      const std::int32_t joint = hangs_on[link];
      if (joint == kNone) break;
      link = static_cast<std::size_t>(robot.joints[static_cast<std::size_t>(joint)].parent);
    }
    if (seen[link] == walk && hangs_on[link] != kNone) {
      const RobotJoint& joint = robot.joints[static_cast<std::size_t>(hangs_on[link])];
      context.log.report(Code("E6220"), joint.where,
                         fmt::format("the joint {} makes the link {} its own ancestor, expected a "
                                     "tree; the joint is left out",
                                     in_quotes(joint.name), in_quotes(robot.links[link].name)));
      hangs_on[link] = kNone;
    }
  }
}

}  // namespace

std::vector<std::int32_t> tree_of(const Robot& robot, meshes::ReaderContext& context) {
  std::vector<std::int32_t> hangs_on(robot.links.size(), kNone);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const RobotJoint& joint = robot.joints[j];
    std::int32_t& place = hangs_on[static_cast<std::size_t>(joint.child)];
    if (place != kNone) {
      context.log.report(
          Code("E6220"), joint.where,
          fmt::format("the link {} is the child of joint {} already, expected one joint for each "
                      "link; the joint {} is left out",
                      in_quotes(robot.links[static_cast<std::size_t>(joint.child)].name),
                      in_quotes(robot.joints[static_cast<std::size_t>(place)].name),
                      in_quotes(joint.name)));
      continue;
    }
    place = static_cast<std::int32_t>(j);
  }
  cut_rings(robot, hangs_on, context);
  std::int32_t root = kNone;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (hangs_on[i] != kNone) continue;
    if (root != kNone) {
      context.log.report(Code("E6220"), robot.links[i].where,
                         fmt::format("the link {} has no parent joint, like {}, expected one root "
                                     "link; both are at the origin",
                                     in_quotes(robot.links[i].name),
                                     in_quotes(robot.links[static_cast<std::size_t>(root)].name)));
      continue;
    }
    root = static_cast<std::int32_t>(i);
  }
  return hangs_on;
}

}  // namespace panwright::importers::urdf
