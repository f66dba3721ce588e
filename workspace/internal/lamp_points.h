// Images of lamps, as points of light. Private to workspace.
#pragma once

#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "preview/reference/reference.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::workspace {

struct LampPoint {
  Vec2 pixel{0};       // of docs/conventions.md 4
  Vec3 irradiance{0};  // at the camera, in the lamps' unit
};

// Returns the lamps that look at a perspective camera, and that nothing hides: a point each, or
// several of equal light on the face of one that is wider than a fifth of a pixel.
//
//   margin  pixels around the image
// Throws Cancelled. Cost: a ray a point, and Reference::prepare() where one is in the image.
std::vector<LampPoint> lamp_points(const world::World& world, const world::Camera& camera,
                                   double margin, preview::Reference& reference, const Job& job);

}  // namespace panwright::workspace
