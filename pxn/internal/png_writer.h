// Pictures as PNG files.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace panwright::pxn {

// A PNG file of 8-bit RGBA texels, row 0 the top row. Lossless: decode_image gives the same texels.
//
// Expects: rgba of 4·width·height bytes; sides of 1 to kMaxTextureSide.
std::string png_file(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

}  // namespace panwright::pxn
