// PNG files as people look at them: a detector's numbers as light.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "image/decode.h"

namespace panwright::image {

// Returns the bits of a detector's numbers in a PNG of write_image(): grey, with a chunk that
// states them. 0: another file, whose pixels are codes.
unsigned bits_of_numbers(std::span<const std::byte> bytes);

// Decodes as decode_image(). A detector's numbers become sRGB codes of grey: 0 is black and the
// largest number of their bits white, so images of one detector are alike.
ImageProblem decode_shown(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out);

}  // namespace panwright::image
