// Parts of an image in which a target may be visible. Private to preview/reference.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/math.h"
#include "trace/scene.h"
#include "world/camera.h"

namespace panwright::preview::reference {

// Sampled part of a pixel; background outside.
struct Cell {
  std::uint32_t column = 0;
  std::uint32_t row = 0;
  Vec2 low{0};   // in the pixel, 0 to 1
  Vec2 high{1};  // > low
};

// Returns cells by rows, from the left: in each pixel the bounding rectangle of the targets'
// possible parts, by their boxes, or, for boxes below a few pixels, by their vertices. Cost:
// O(parts + pixels); O(vertices) for small parts.
//
//   wanted  whether a part of a target counts; none: all do, and terrain
std::vector<Cell> cells_of(
    const trace::Scene& scene, const world::Camera& camera,
    const std::function<bool(std::uint32_t target, std::uint32_t part)>& wanted = {});

}  // namespace panwright::preview::reference
