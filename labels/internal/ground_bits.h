// Samples of terrain, by rays.
#pragma once

#include <cstdint>
#include <optional>

#include "base/axis_box.h"
#include "labels/internal/coverage.h"
#include "labels/internal/sample_bits.h"

namespace panwright::labels {

// Returns a rectangle about the terrain of a target, pixels; none: it reaches behind the camera, or
// a lens bends it.
std::optional<AxisRectangle> ground_rectangle(const trace::Scene& scene, std::uint32_t target,
                                              const ImagePlane& plane);

// Sets the samples that the terrain of a target has, whatever is before it.
//
// Squares of a region whose corners are alike are whole; of the others each sample has a ray. So
// are blocks of 8 × 8 squares outside of the image. Where the image's ids are the target's, and all
// around, there are no rays.
void draw_ground(const Shown& shown, std::uint32_t target, const Region& region, SampleBits& bits);

}  // namespace panwright::labels
