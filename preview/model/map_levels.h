// Mip levels of surface textures; the contents of each channel depend on the image's role. Private
// to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/model/texture_levels.h"

namespace panwright::preview {

enum class TextureRole : std::uint8_t {
  color,          // RGB linear; A 1
  premultiplied,  // RGB linear times A, A: transparent texels contribute no colour
  normal,         // RGB: mean of the unit normals, shorter than 1 where they differ; A: slopes xy
  slopes,         // of the same image, R: slopes xx, G: yy; see below
  roughness,      // R: the red code, linear
  cutout,         // R: alpha − threshold of level 0 only; G: opaque share of the surface
};

// Returns the channels of a role: 1, 2 or 4.
unsigned channels(TextureRole role);

// Returns all levels of a texture, with these contents. Normal and roughness maps are linear
// whatever the file states; cutouts read alpha, which always is.
//
// Normal maps: level 0 holds unit vectors, never inwards. A mean of normals is exact for BRDFs
// linear in the normal: Lambert's, until a texel faces away from the Sun. Slopes are twice the
// covariance of the slopes under a texel about their mean, −n_x/n_z along u and −n_y/n_z along v
// (slope_levels.h): the increase of Beckmann's m² in each azimuth. They include the loss of
// interpolation between the means of texels, so that a level has the total variance of the map. 0
// in level 0.
//
// Cutouts: G of level 0 is the share of each texel's square in which alpha, interpolated between
// centres of repeating texels, reaches the threshold; within 2e-3; the levels above hold its means.
//
//   threshold  for cutouts
// Throws Cancelled.
std::vector<TextureLevel> map_levels(std::span<const std::uint8_t> rgba, std::uint32_t width,
                                     std::uint32_t height, bool linear, TextureRole role,
                                     float threshold, const Job& job = {});

}  // namespace panwright::preview
