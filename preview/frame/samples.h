// Tiles of an image, and the box filter over the samples of a tile. Private to preview; nothing
// here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/projection.h"
#include "preview/image.h"

namespace panwright::preview {

// Tiles of at most side × side pixels, row by row, that cover the image.
std::vector<Tile> tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side);

// Sets the radiance and coverage of a tile's pixels to the mean of their N×N samples. Sums are in
// double, samples in rows from the top left: within 2^-24 of the exact mean, relative, whatever N.
//
//   rgba  4*(tile.height*N)*(tile.width*N) linear, from the top left
void average_samples(std::span<const float> rgba, const Tile& tile, unsigned samples, Image& image);

}  // namespace panwright::preview
