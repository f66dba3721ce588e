// Charts of a texture: the pieces of it that a mesh shows. Private to preview; nothing here needs
// OpenGL.
#pragma once

#include "base/math.h"
#include "pan/model.h"

namespace panwright::preview {

// Returns the largest mip level of a texture whose texels mix little of what lies beside a mesh's
// charts into them: an eighth of a chart's width at most, for all but a fiftieth of the mesh's
// area. Infinite: any, as charts of all of a texture hold the same mean.
//
//   repeat  multiplies the texture coordinates
//   sides   of the texture, texels
double largest_level(const pan::MeshView& mesh, const Vec2& repeat, const Vec2& sides);

}  // namespace panwright::preview
