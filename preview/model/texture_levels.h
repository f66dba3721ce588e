// Linear texels, and their mip chain. Private to preview; nothing here needs OpenGL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"

namespace panwright::preview {

struct TextureLevel {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> rgba;  // 4*H*W linear, row 0 at the bottom of the image
};

// Decodes the texels to linear numbers, bottom row first as in texture coordinates.
//
//   rgba    4*H*W codes, row 0 the top row
//   linear  RGB is not sRGB encoded; A never is
TextureLevel decoded_level(std::span<const std::uint8_t> rgba, std::uint32_t width,
                           std::uint32_t height, bool linear, const Job& job = {});

// Texels of a row or column covered by one of the next level, and their shares of it.
struct Footprint {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::array<double, 4> share{};  // halving rounded down covers at most 3 + rounding
};

// Expects: to = max(1, from / 2), index < to.
Footprint footprint(std::uint32_t index, std::uint32_t from, std::uint32_t to);

// Returns the level and all below, each of half the sides, rounded down, never below 1, down to
// 1×1. Every texel is the mean of the area of the level above that it covers, partial texels
// weighted by their share: means are kept for sides of any length.
std::vector<TextureLevel> with_levels_below(TextureLevel first, const Job& job = {});

}  // namespace panwright::preview
