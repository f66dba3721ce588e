// Words in images.
#pragma once

#include <cstdint>
#include <string_view>

#include "preview/image.h"

namespace panwright::tools {

// Writes words in white into an image, capitals and digits of 5 × 7 dots, `size` pixels a dot. What
// falls outside is left out; what has no glyph is a space.
void write_overlay_text(preview::Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t size,
                        std::string_view words);

}  // namespace panwright::tools
