// Overlay text in images, with a bitmap font.
#pragma once

#include <cstdint>
#include <string_view>

#include "preview/image.h"

namespace panwright::tools {

// Writes text in white into an image; letters of 5 × 7 dots, `size` pixels a dot, with two rows of
// dots for descenders. Parts outside are clipped; each non-ASCII character is a box.
void write_overlay_text(preview::Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t size,
                        std::string_view words);

}  // namespace panwright::tools
