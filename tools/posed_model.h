// One model with its joints at given values, for commands that show no image.
#pragma once

#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "base/result.h"
#include "tools/shared_options.h"
#include "world/world.h"

namespace panwright::tools {

// Values of joints, and what they aim at.
struct PoseOptions {
  JointOptions joints;
  std::optional<std::string> sun;  // "X Y Z", world axes
};
void declare(Arguments& arguments, PoseOptions& options);

// A world of the model, at the origin, called after its file. Joints that point at the Sun by
// themselves do so where its direction is given, and stay at their initial values else.
//
// Fails: E0201, E5013, E5014; as workspace::read_joints. Reports: W5015.
Result<world::World> posed(const std::string& file, const world::ModelPtr& model,
                           const PoseOptions& options, DiagnosticLog& log);

}  // namespace panwright::tools
