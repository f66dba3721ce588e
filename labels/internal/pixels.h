// Masks of whole pixels: those of which more than half is covered. Private to labels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "labels/labels.h"

namespace panwright::labels {

// Smallest rectangle of the pixels that are set.
struct PixelMask {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;
  std::vector<std::uint8_t> set;  // height*width: 0 or 1
  std::uint64_t count = 0;        // of those set

  bool empty() const { return count == 0; }
  bool at(std::int64_t x, std::int64_t y) const {  // pixels of the image
    const std::int64_t i = x - left, j = y - top;
    return i >= 0 && j >= 0 && i < width && j < height &&
           set[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)] != 0;
  }
};

inline constexpr std::uint8_t kMoreThanHalf = 128;  // of 255

PixelMask pixels_of(const Mask& mask);

// Run-length code of COCO, of a whole image: columns from the left, the first run is of zeros.
std::vector<std::uint32_t> rle_counts(const PixelMask& mask, std::uint32_t width,
                                      std::uint32_t height);
// Its compressed text: from the fourth on the difference from the one two before, in groups of five
// bits, the lowest first, 0x20 where more follow, 48 more.
std::string rle_text(const std::vector<std::uint32_t>& counts);

// Returns an image of the mask: width*height bytes of 0 or 255.
std::vector<std::uint8_t> mask_image(const PixelMask& mask, std::uint32_t width,
                                     std::uint32_t height);

}  // namespace panwright::labels
