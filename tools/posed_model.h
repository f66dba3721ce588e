// Model with joints at given values, for commands without an image.
#pragma once

#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "base/result.h"
#include "tools/shared_options.h"
#include "world/world.h"

namespace panwright::tools {

// Joint values, and their aims.
struct PoseOptions {
  JointOptions joints;
  std::optional<std::string> sun;  // "X Y Z", world axes
};
void declare(Arguments& arguments, PoseOptions& options);

// Makes a world of the model, at the origin, named after its file. Joints that track the Sun do so
// if its direction is given, else stay at their initial values.
//
// Fails: E0201, E5013, E5014; as workspace::read_joints. Reports: W5015.
Result<world::World> posed(const std::string& file, const world::ModelPtr& model,
                           const PoseOptions& options, DiagnosticLog& log);

}  // namespace panwright::tools
