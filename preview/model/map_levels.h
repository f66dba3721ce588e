// The levels of the textures that a surface reads: what each channel holds depends on what the
// image is for. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/model/texture_levels.h"

namespace panwright::preview {

enum class TextureRole : std::uint8_t {
  color,          // RGB linear; A 1
  premultiplied,  // RGB linear times A, A: the colour of a transparent texel counts nowhere
  normal,         // RGB: mean of the unit normals, shorter than 1 where they differ; A: slopes xy
  slopes,         // of the same image, R: slopes xx, G: yy; see below
  roughness,      // R: the red code as it is
  cutout,         // R: alpha − threshold of level 0 only; G: share of the surface that is there
};

// Channels that a texture of the role needs: 1, 2 or 4.
unsigned channels(TextureRole role);

// All levels of a texture, with these contents. Normal and roughness maps are linear whatever the
// file says, cutouts read alpha, which always is.
//
// Normal maps: level 0 holds unit vectors, never inwards. A mean of normals is exact for what is
// linear in the normal: Lambert's BRDF, until a texel faces away from the Sun. Slopes are twice the
// covariance of the slopes under a texel about their mean, −n_x/n_z along u and −n_y/n_z along v
// (slope_levels.h): what Beckmann's m² becomes larger by, in each azimuth; and of what
// interpolation between the means of texels hides, so that a level shows as much as the map on the
// whole. 0 in level 0.
//
// Cutouts: G of level 0 is the share of each texel's square where alpha, interpolated between the
// centres of texels that repeat, reaches the threshold, within 2e-3; the levels above hold its
// means.
//
//   threshold  for cutouts
// Throws Cancelled.
std::vector<TextureLevel> map_levels(std::span<const std::uint8_t> rgba, std::uint32_t width,
                                     std::uint32_t height, bool linear, TextureRole role,
                                     float threshold, const Job& job = {});

}  // namespace panwright::preview
