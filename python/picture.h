// Image of one frame as Python holds it.
#pragma once

#include <optional>
#include <string>

#include "labels/labels.h"
#include "workspace/run.h"

namespace panwright::python {

struct Picture {
  workspace::Written what;
  workspace::ImageProduct product;
  std::optional<labels::FrameLabels> labels;
  world::Camera camera;
  std::string name;
  std::uint64_t number = 0;
  double time = 0;  // seconds, of the sequence
};

}  // namespace panwright::python
