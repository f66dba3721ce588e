// One light for one receiver. Private to preview; nothing here needs OpenGL.
//
// Samples of a target are placed in world axes, from an origin of their own that is near to what is
// seen: as small numbers, single precision holds them to a fraction of a pixel.
#pragma once

#include "base/axis_box.h"
#include "preview/frame/visible_set.h"
#include "preview/gl/uniforms.h"
#include "world/camera.h"
#include "world/evaluation.h"

namespace panwright::preview {

// Light and shadow map of a receiver, in the frame of its samples.
struct LightView {
  LightBlock block;  // map_from_sample: affine for parallel rays, projective for rays from a point
  unsigned depths = 0;  // arrays of layers, one for each point of the light's disc; 0: none
  unsigned slopes = 0;
};

// Returns the model's frame from that of a target's samples. The origin is the point of the bounds
// nearest to where the middle of the image looks, at the depth of the nearest visible box.
Mat4 model_from_sample(const world::Camera& camera, const world::Pose& pose, const AxisBox& bounds,
                       const VisibleTarget& visible);

}  // namespace panwright::preview
