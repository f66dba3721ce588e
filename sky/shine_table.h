// Radiance of the bodies of a sky by direction, as a table for shaders.
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.h"
#include "light/ground_shine.h"
#include "sky/sky.h"

namespace panwright::sky {

// Layers over the directions of the world, as octahedra unfolded into squares: x + y·side of z ≥ 0
// in the middle. All have a border of one texel that continues them, for linear interpolation.
//
// Each is the radiance, blurred by a Gaussian of kShineWidths, radians along each axis.
struct ShineTable {
  static constexpr int kSide = light::GroundShine::kSide;  // texels
  static constexpr int kRow = kSide + 2;
  static constexpr int kLayers = 4;
  std::vector<float> rgba;  // kLayers·kRow·kRow·4; the last channel is 0
};
// Texels blur the sharpest layer by half of one, 0.02.
inline constexpr double kShineWidths[] = {0, 0.2, 0.4, 0.8};

// Returns the light of all bodies at a point. Those smaller than 6 degrees are as wide as a texel.
//
//   ground  terrain, whose light is added and which hides bodies; null: none
// Error: 2 % of the flux. Cost: 16,000 radiances.
ShineTable shine_table(const Sky& sky, const Vec3& point,
                       const light::GroundShine* ground = nullptr);

}  // namespace panwright::sky
