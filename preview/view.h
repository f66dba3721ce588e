// One camera and Sun state of one model.
#pragma once

#include <optional>

#include "world/camera.h"

namespace panwright::preview {

struct View {
  world::Camera camera;
  world::Pose world_from_model;
  Vec3 to_sun{0, 0, 1};                // world direction to the Sun, any non-zero length
  std::optional<Vec3> sun_irradiance;  // W/m² per band at the target; none: 1, radiance in 1/sr
  double sun_distance = 1;  // AU; sets the Sun's angular size, the irradiance stands as given
};

}  // namespace panwright::preview
