// Visible edges of triangles in an image.
#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "image/image.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::studio {

// H*W: 255 where the edge of a visible triangle crosses a pixel, else 0. Triangles are those of the
// finest level, of visible nodes; occlusion follows the depth of the image, to a pixel.
//
// Expects: an image with ground truth of that world and camera. Cost: O(triangles + length of their
// edges, pixels).
std::vector<std::uint8_t> edges_of(const world::World& world, const world::Camera& camera,
                                   const image::Image& image, const Job& job = {});

}  // namespace panwright::studio
