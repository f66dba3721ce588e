// Instruments of frames.
#pragma once

#include <variant>

#include "world/camera.h"

namespace panwright::workspace {

// Camera, whose product is an image.
struct CameraInstrument {
  CameraInstrument(const world::Camera& from = {}, bool keeps_field = false)
      : camera(from), field_of_view(keeps_field) {}
  world::Camera camera;
  bool field_of_view;  // the lens was given as one, or fitted: with another size it stays
};

using Instrument = std::variant<CameraInstrument>;

}  // namespace panwright::workspace
