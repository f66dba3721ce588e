// Joints of a model, for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pan/model.h"

namespace panwright::tools {

// Returns a line of each joint: name, kind, axis, value, limits, leader or aim; indented by the
// joints above.
std::vector<std::string> joint_lines(const pan::Model& model,
                                     const std::vector<geometry::JointValues>& values);

// Returns a list, in SI.
nlohmann::ordered_json joints_json(const pan::Model& model,
                                   const std::vector<geometry::JointValues>& values);

}  // namespace panwright::tools
