// Texels made linear, and their mip chain. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace panwright::preview {

struct TextureLevel {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> rgba;  // 4*H*W linear, row 0 at the bottom of the image
};

// Level 0 is the texels, sRGB-decoded unless `linear`, turned bottom row first as texture
// coordinates count; each further level halves the sides (rounded down, never below 1) down to
// 1×1. Every texel of a level is the mean of the area of the level above that it covers, in linear
// light, partial texels weighted by their share: means are kept for sides of any length.
//
//   rgba  4*H*W codes, row 0 the top row
std::vector<TextureLevel> texture_levels(std::span<const std::uint8_t> rgba, std::uint32_t width,
                                         std::uint32_t height, bool linear);

}  // namespace panwright::preview
