// Worlds of one target, for cases that show one view by both renderers.
#pragma once

#include <utility>

#include "preview/view.h"
#include "world/world.h"

namespace panwright::bench {

// One target as a view shows it; the camera stays the view's.
inline world::World world_of(world::ModelPtr model, const preview::View& view) {
  DiagnosticLog log;
  world::World world;
  if (world.add("target", std::move(model), view.world_from_model, log))
    world.set_sun({view.to_sun, view.sun_distance, view.sun_irradiance, 0});
  return world;
}

}  // namespace panwright::bench
