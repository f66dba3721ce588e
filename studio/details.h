// Levels of detail, triangles and errors of the parts of a view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "studio/layers.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::studio {

// Meshes of one node.
struct Detail {
  std::size_t target = 0;  // of the world
  std::uint32_t node = 0;
  int level = -1;               // coarsest level that is drawn; 0: the finest; −1: no levels
  std::uint64_t triangles = 0;  // drawn
  std::uint64_t finest = 0;     // of the finest level
  double error = 0;             // largest distance of the drawn mesh from the shape, metres, world
  double pixels = 0;            // `error` in pixels, at the nearest point of the target's box
  bool visible = false;
};

// Details of nodes with meshes, ordered by target and node. Levels follow the pixel footprint at
// the target (docs/levels.md); in a transition, the finer one. Imposters are drawn from finer
// levels.
//
// Cost: O(nodes + meshes placed).
std::vector<Detail> details_of(const world::World& world, const world::Camera& camera);

// Colours of levels; grey: no levels.
//
// Expects: an image with ground truth, details of its view.
Pixels level_pixels(const image::Image& image, const std::vector<Detail>& details);

// Colour of a level from −1; from 6, the same one.
void level_color(int level, std::uint8_t* rgb);

}  // namespace panwright::studio
