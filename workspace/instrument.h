// Instruments of frames.
#pragma once

#include <string>
#include <variant>

#include "base/diagnostic.h"
#include "world/camera.h"

namespace panwright::workspace {

// Camera, whose product is an image.
struct CameraInstrument {
  CameraInstrument(const world::Camera& from = {}, bool keeps_field = false)
      : camera(from), field_of_view(keeps_field) {}
  world::Camera camera;
  bool field_of_view;  // the lens was given as one, or fitted: with another size it stays
};

// Checks the name of an output. Fails: E0202 for a file that the instrument does not make.
void check_output(const CameraInstrument& kind, const std::string& output, DiagnosticLog& log);

using Instrument = std::variant<CameraInstrument>;

}  // namespace panwright::workspace
