// Optical flow: where the surface at each pixel's centre is in another frame.
#pragma once

#include "base/job.h"
#include "image/image.h"
#include "labels/labels.h"
#include "trace/scene.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::labels {

// State of a world, and its camera.
struct Moment {
  const world::World& world;
  const world::Camera& camera;
};

// Returns the flow of a frame into another one of the same targets: poses, joints, nodes and the
// camera may differ.
//
//   scene   updated to the frame, its observer the frame's camera
//   layers  image of the frame with ground truth, of its camera's size; null: rays are cast
// Throws Cancelled.
Flow flow_to(const Moment& now, const Moment& other, const trace::Scene& scene,
             const image::Image* layers, const Job& job = {});

}  // namespace panwright::labels
