// The parts of an image where a target may be seen. Private to preview/reference.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "preview/reference/internal/trace_scene.h"
#include "world/camera.h"

namespace panwright::preview::reference {

// The part of a pixel that is sampled; outside of it there is background.
struct Cell {
  std::uint32_t column = 0;
  std::uint32_t row = 0;
  Vec2 low{0};   // in the pixel, 0 to 1
  Vec2 high{1};  // > low
};

// Cells by rows, from the left: in each pixel the bounding rectangle of what of the targets' parts
// may fall there, by their boxes, or, where those are smaller than a few pixels, by their vertices.
// Cost: O(parts + pixels); O(vertices) for small parts.
std::vector<Cell> cells_of(const TraceScene& scene, const world::Camera& camera);

}  // namespace panwright::preview::reference
