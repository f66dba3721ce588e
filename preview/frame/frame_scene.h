// Shared inputs of the steps of one frame. Private to preview.
#pragma once

#include <cstddef>

#include "preview/frame/sun_points.h"
#include "preview/frame/target_states.h"
#include "preview/frame/visible_set.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

class Lights;

struct FrameScene {
  const world::World& world;
  const world::Camera& camera;
  const TargetStates& states;
  const VisibleSet& visible;
  const Lights* lights = nullptr;  // on the visible targets; null: nothing is shaded
  double pixel = 1;                // size in camera pixels: of the image, or of an imposter's texel
  std::uint32_t texels = 0;        // of an imposter, along its longer side; 0: of an image
  bool specular_filter = true;     // RenderOptions
  unsigned sun_points = kMostSunPoints;  // at most

  const TargetState& state(std::size_t visible_target) const {
    return states[visible.targets[visible_target].target];
  }
};

}  // namespace panwright::preview
