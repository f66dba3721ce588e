// Textures computed from others, texel by texel.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/math.h"

namespace panwright::image {

struct BakeSource {
  std::span<const std::uint8_t> rgba;  // 4·width·height, row 0 the top row; empty: 1 everywhere
  std::uint32_t width = 0;             // texels, 1 or more; 0 where it is empty
  std::uint32_t height = 0;
  bool srgb = false;  // RGB is decoded; A never is
};

struct Baked {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::vector<std::uint8_t>> textures;  // each 4·width·height, row 0 the top row
};

// Returns the resolution of the baked textures: the largest of the sources.
std::uint32_t baked_width(std::span<const BakeSource> sources);
std::uint32_t baked_height(std::span<const BakeSource> sources);

// Computes textures as large as the largest source; smaller ones are read bilinear, repeated.
//
//   sources  one or more with a texture
//   srgb     for each texture made, whether its RGB is stored as sRGB codes
//   texel    computes the textures' texels from those of the sources, 0 to 1; clamped to 0 to 1.
//            Pure, called from several threads.
//
// Expects: a source that is not empty. Cost: O(texels made).
Baked baked(std::span<const BakeSource> sources, std::span<const bool> srgb,
            const std::function<void(std::span<const Vec4>, std::span<Vec4>)>& texel,
            const Job& job = {});

}  // namespace panwright::image
