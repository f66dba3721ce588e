// Outlines of masks. Private to labels.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "labels/internal/pixels.h"

namespace panwright::labels {

// Returns one polygon along the edges of the pixels that are set, in pixels, clockwise in the
// image: borders of parts and of holes, joined by ways there and back from the first point. Its
// area, even and odd, is the mask.
std::vector<std::pair<std::uint32_t, std::uint32_t>> outline_of(const PixelMask& mask);

}  // namespace panwright::labels
