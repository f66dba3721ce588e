// Camera and Sun of one model, for tests and benches with a single target.
#pragma once

#include <optional>
#include <utility>

#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

struct View {
  world::Camera camera;
  world::Pose world_from_model;
  Vec3 to_sun{0, 0, 1};                // world direction to the Sun, any non-zero length
  std::optional<Vec3> sun_irradiance;  // W/m² per band at the target; none: 1, radiance in 1/sr
  std::optional<Vec3> white;           // irradiance of emission 1; none: as world::World::white()
  double sun_distance = 1;             // AU; sets the Sun's angular size, not the irradiance
  double limb_darkening = 0;
};

// Applies a view to target 0 of a world and its Sun.
inline void set_view(world::World& world, const View& view) {
  world.set_pose(0, view.world_from_model);
  world::Sun sun = world.sun();
  sun.direction = view.to_sun;
  sun.distance = view.sun_distance;
  sun.irradiance = view.sun_irradiance;
  sun.limb_darkening = view.limb_darkening;
  world.set_sun(sun);
  world.set_white(view.white);
}

// Makes a world of one target.
inline world::World world_of(world::ModelPtr model, const View& view) {
  world::World world;
  DiagnosticLog log;
  static_cast<void>(world.add("target", std::move(model), log));
  set_view(world, view);
  return world;
}

}  // namespace panwright::preview
