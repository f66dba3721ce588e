// What the steps of one frame share. Private to preview.
#pragma once

#include <cstddef>

#include "preview/frame/target_states.h"
#include "preview/frame/visible_set.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview {

class ShadowMaps;

struct FrameScene {
  const world::World& world;
  const world::Camera& camera;
  const TargetStates& states;
  const VisibleSet& visible;
  const ShadowMaps* shadows = nullptr;  // of the visible targets; null: none
  double pixel = 1;  // of the image, in those of the camera: of imposters, texels
  unsigned soft_side = ~0u;     // texels, most of shadow maps of several points of the Sun's disc
  bool specular_filter = true;  // RenderOptions

  const TargetState& state(std::size_t visible_target) const {
    return states[visible.targets[visible_target].target];
  }
};

}  // namespace panwright::preview
