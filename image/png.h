// PNG files in memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace panwright::image {

struct Image;
struct PngExposure;

// Returns the codes that write_image() writes into a PNG: 3·width·height, sRGB.
std::vector<std::uint8_t> png_codes(const Image& image, const PngExposure& exposure);

struct PngOptions {
  int channels = 4;               // of the pixels given: 1 (grey), 3 (RGB) or 4 (RGBA)
  int bytes = 1;                  // of a channel; 2: 16 bits, the high byte first
  bool drop_opaque_alpha = true;  // writes RGB where every alpha is 255
  unsigned bits = 0;              // in use, stated by a chunk; 0: all
  bool says_srgb = false;         // a chunk states that the numbers are sRGB codes
  std::string comment;            // ASCII, a text chunk "Comment"; empty: none
};

// Returns a PNG file. pixels: bytes·channels·width·height bytes, row 0 the top row. Lossless.
// The bytes depend on the arguments and on the versions of libpng and zlib alone.
//
// Expects: sides of 1 to 2^31 − 1, and pixels of that size. Cost: O(pixels).
// Throws std::bad_alloc where memory is out.
std::string png_file(std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels, const PngOptions& options = {});

}  // namespace panwright::image
