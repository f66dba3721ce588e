// Projection from the camera's frame to clip space, tile by tile, and the depth range of a view.
// Private to preview; nothing here needs OpenGL.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "world/camera.h"

namespace panwright::preview {

// Part of an image, rendered at once: pixels [x, x+width) × [y, y+height).
struct Tile {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

// Depths along the boresight, metres. far > near; perspective: near > 0.
struct DepthRange {
  double near = 1;
  double far = 2;
};

// Box of a mesh, with its placement.
struct PlacedBox {
  Mat4 camera_from_mesh{1};
  Vec3 low{0};   // mesh frame
  Vec3 high{0};  // mesh frame
};

std::array<Vec3, 8> corners(const Vec3& low, const Vec3& high);

// Returns the camera's frame from the world, camera-relative: the translations are subtracted in
// double before they are rotated.
Mat4 camera_from(const world::Camera& camera, const Mat4& world_from_mesh);

// Returns the range of all boxes, or of their part in front of the camera, widened by the float32
// rounding of their positions. A camera among the boxes gets a near plane at 2^-30 of the far one,
// where reverse-Z float depth has the usual constant relative resolution. No box in front: any
// valid range.
DepthRange fitted_depth(world::Projection projection, std::span<const PlacedBox> boxes);

// Rows x, y, z, w of clip space from the camera's frame for one tile. Window coordinates (0, 0)
// fall on the tile's upper left corner and grow right and *down*. So rows are read back top first,
// and counter-clockwise triangles are clockwise in the window. Depth is 1 at near, 0 at far:
//   perspective  z_clip = near·(far − Z)/(far − near), w = Z
// The constant far − Z of a far away mesh cancels here, in double, so that depth resolves the
// scene and not the distance.
struct ClipRows {
  Vec4 x, y, z, w;
};
ClipRows clip_rows(const world::Camera& camera, const Tile& tile, const DepthRange& range);

// Returns the whole matrix. camera_from_mesh is decomposed so that far − Z is formed before the
// product.
Mat4 clip_from_mesh(const world::Camera& camera, const Tile& tile, const DepthRange& range,
                    const Mat4& camera_from_mesh);

// Returns true if some part of the box may fall on the tile, to within `margin` pixels around it,
// and in front of the camera. May be true for a box just outside; never false for one that touches.
bool may_touch(const world::Camera& camera, const Tile& tile, double margin, const PlacedBox& box);

// Returns the part of a tile that boxes may cover, in whole pixels with one to spare; the whole
// tile when a box reaches behind the camera. A width or height of 0: none.
Tile touched_part(const world::Camera& camera, const Tile& tile, std::span<const PlacedBox> boxes,
                  std::span<const std::uint32_t> which);

}  // namespace panwright::preview
