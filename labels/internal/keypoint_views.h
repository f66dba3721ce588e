// Keypoints of targets in a frame: where they are in the image, hidden or not, lit or not.
//
// A keypoint on a surface is tested from there. "On": within `slack`, or within twice the largest
// error of the target's meshes. It faces a direction if the normal of a facet there does: of the
// nearest, and of those within the error of the meshes where that is above `slack`, as at the rims
// of round shapes. On open meshes both sides count. Off surfaces it faces everything.
//
//   occluded  it does not face the camera, or its view ray meets a surface, those nearer than
//             `slack` to it left out. Backs of closed meshes hide nothing, as in images.
//   lit       it faces the Sun, and the ray to its centre meets no body, and nothing beyond
//   `slack`.
#pragma once

#include <cstdint>
#include <vector>

#include "labels/internal/image_plane.h"
#include "labels/labels.h"
#include "trace/scene.h"
#include "world/world.h"

namespace panwright::labels {

// Keypoints of a target, as its model has them.
//
//   placed  of the target
//   slack   metres
std::vector<Keypoint> keypoints_of(const world::World& world, std::uint32_t target,
                                   const trace::PlacedNodes& placed, const trace::Scene& scene,
                                   const ImagePlane& plane, double slack);

}  // namespace panwright::labels
