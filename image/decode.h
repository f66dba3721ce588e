// Decoder of PPM, PNG and JPEG images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::image {

inline constexpr std::uint32_t kMaxTextureSide = 16384;  // pixels, as in the pan file

struct DecodedImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  // 4·width·height, row 0 the top row
};

struct ImageProblem {
  std::optional<Code> code;  // none: success
  std::string message;
};

// Decodes an image, at most max_bytes of pixels (four bytes each). The format follows from the
// first bytes. Sizes are checked before anything is allocated. PNG checksums are verified; 16-bit
// channels keep their upper half. JPEG files with lost pixels are refused. Same bytes, same pixels,
// on any processor. Nothing is printed, and settings of libpng and libjpeg stay as they are.
//
// Problems: E3001 with the place in the file, E3002. Cost: O(bytes + pixels); JPEG: for each scan.
ImageProblem decode_image(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out);

// Judges an image in the place of a normal map: colours stand for unit vectors out of the surface.
// Returns the problem if most of its texels are something else, as in a colour image. Texels of
// alpha 0 are not used.
std::optional<std::string> normal_map_problem(std::span<const std::uint8_t> rgba);

}  // namespace panwright::image
