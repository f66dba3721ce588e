// What each part of a view costs and how exact it is: levels of detail, triangles, errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "studio/layers.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::studio {

// The meshes of one node.
struct Detail {
  std::size_t target = 0;  // of the world
  std::uint32_t node = 0;
  int level = -1;  // of the coarsest one that is drawn; 0: the finest; −1: it has no levels
  std::uint64_t triangles = 0;  // that are drawn
  std::uint64_t finest = 0;     // of its finest level
  double error = 0;             // metres, world: of what is drawn from the shape, at most
  double pixels = 0;  // the same in pixels of the camera, at the nearest point of the target's box
  bool visible = false;
};

// Of nodes with meshes, by target and node. Levels are those of docs/levels.md for what a pixel
// sees of the target; where two fade into each other, the finer one. Imposters are drawn from finer
// ones.
//
// Cost: O(nodes + meshes placed).
std::vector<Detail> details_of(const world::World& world, const world::Camera& camera);

// 4*H*W bytes: each level a colour, grey where a part has none.
//
// Expects: an image with ground truth; details of its view.
Pixels level_pixels(const preview::Image& image, const std::vector<Detail>& details);

// Of a level, −1 and up; those beyond 6 are alike.
void level_color(int level, std::uint8_t* rgb);

}  // namespace panwright::studio
