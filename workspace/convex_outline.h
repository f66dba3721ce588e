// Convex outlines of targets in images.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "world/world.h"

namespace panwright::workspace {

// Returns points of a target, metres in its frame, whose hull is nearly its own: the farthest in
// 400 directions. Its visible nodes count, as its joints stand. Cost: O(vertices), at worst 400
// sums each.
std::vector<Vec3> extreme_points(const world::Instance& target);

struct HullArea {
  double whole = 0;   // pixels
  double within = 0;  // of these inside the image
};
// Returns the area of the convex hull of places in an image, pixels; fewer than three have none.
HullArea hull_area(std::vector<Vec2> points, std::uint32_t width, std::uint32_t height);

}  // namespace panwright::workspace
