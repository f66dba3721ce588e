// Words in images.
#pragma once

#include <cstdint>
#include <string_view>

#include "preview/image.h"

namespace panwright::tools {

// Writes words as they are in white into an image, letters of 5 × 7 dots, two rows of dots below
// the line for g, j, p, q, y and _, `size` pixels a dot. What falls outside is left out; what is
// not ASCII is a box, one for each character.
void write_overlay_text(preview::Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t size,
                        std::string_view words);

}  // namespace panwright::tools
