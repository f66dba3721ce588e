// Placement of decals. Private to preview; nothing here needs OpenGL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pan/model.h"
#include "preview/model/draw_list.h"

namespace panwright::preview {

// Decal, ready to be drawn over its item.
struct PlacedDecal {
  std::uint32_t item = 0;  // into the draw list
  std::uint32_t texture = 0;
  // rows from the mesh's float positions: texture coordinates, and height over its depth
  std::array<Vec4, 3> place{};
  Vec3 outwards{0};                    // its normal in the mesh's frame
  std::vector<std::uint32_t> indices;  // 3 for each triangle of the mesh that may receive it
};

// Returns all decals of a model, from the lowest to the topmost, without those on no triangle.
// Cost: O(decals · triangles of their meshes).
std::vector<PlacedDecal> placed_decals(const pan::Model& model, std::span<const DrawItem> list);

}  // namespace panwright::preview
