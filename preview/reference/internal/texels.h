// Pictures at a point, bilinear between texel centres. Private to preview/reference.
#pragma once

#include "base/math.h"
#include "preview/internal/texture_levels.h"

namespace panwright::preview::reference {

// at: texture coordinates, (0, 0) the bottom left corner. Beyond [0, 1] the picture repeats, or
// its edge goes on.
Vec4 repeated_texel(const TextureLevel& picture, const Vec2& at);
Vec4 clamped_texel(const TextureLevel& picture, const Vec2& at);

}  // namespace panwright::preview::reference
