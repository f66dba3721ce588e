// Overlay text in images, in DejaVu Sans Mono.
#pragma once

#include <cstdint>
#include <string_view>

#include "image/image.h"

namespace panwright::tools {

// Place of a line of text, in pixels: its upper left corner, the height of a line, and the width
// that smaller letters keep to.
struct OverlayLine {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

// Writes text in white into an image. Parts outside are clipped; characters that the font lacks
// are boxes.
void write_overlay_text(image::Image& image, const OverlayLine& line, std::string_view utf8);

}  // namespace panwright::tools
