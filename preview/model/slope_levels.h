// Slope variance lost in the levels of a normal map: that of the normals under each texel. Private
// to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <vector>

#include "preview/model/texture_levels.h"

namespace panwright::preview {

// Limit of slopes: longer ones are clamped, as they lie in the surface's own shadow.
inline constexpr double kSteepestSlope = 4;

// Mean and covariance of the slopes −n_x/n_z, −n_y/n_z over an area of the map.
struct SlopeMoments {
  double x = 0;
  double y = 0;
  double xx = 0;  // E[s_x²] − E[s_x]², never below 0
  double xy = 0;  // xy² ≤ xx·yy
  double yy = 0;
};

struct SlopeLevel {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<SlopeMoments> texels;  // H*W, row 0 at the bottom
};

// Returns the moments at every level below the first, with the shares of with_levels_below(): each
// is the mean of the covariances of the texels above and the covariance of their means. So it is
// the covariance of the first level's texels for any sides (M. Olano, D. Baker, "LEAN mapping",
// 2010, without the cancellation of raw moments).
//
//   normals  the first level; RGB: normals of any length, never inwards
// Throws Cancelled.
std::vector<SlopeLevel> slope_levels(const TextureLevel& normals, const Job& job = {});

}  // namespace panwright::preview
