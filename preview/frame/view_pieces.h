// Visible parts of boxes and triangles in light space, for a part of a view. Private to preview;
// nothing here needs OpenGL.
#pragma once

#include <array>
#include <cstdint>

#include "base/axis_box.h"
#include "world/camera.h"

namespace panwright::preview {

// Part of a view: a rectangle of its image, pixels, and a range of depths along the boresight,
// metres (perspective: near > 0).
struct ViewCell {
  Vec2 low{0};
  Vec2 high{0};
  double near = 0;
  double far = 0;
};

// Inputs that seldom change between queries.
struct ViewFrame {
  const world::Camera* camera = nullptr;
  Mat4 light_from_camera{1};  // rigid: across the Sun's rays, across, towards the Sun; metres
};

// A box, or a triangle if there are 3 corners. Camera frame; a box's in the order of corners().
struct ViewPiece {
  std::array<Vec3, 8> corners;
  unsigned count = 8;
  // in light space, as a whole, metres: x or y, z
  double across = 0;
  double deep = 0;
};
// Measures a piece as a whole.
void measure(const ViewFrame& view, ViewPiece& piece);

// Bounds of the part of a piece that a cell shows.
struct ShownPart {
  AxisBox light;  // light space, metres
  AxisBox view;   // pixel x, pixel y, depth

  bool empty() const { return light.empty(); }
  void add(const ShownPart& other) {
    light.add(other.light);
    view.add(other.view);
  }
};

// Returns the visible part. Exact for convex pieces, in double. Cost: some 100 plane tests at most.
ShownPart shown_part(const ViewFrame& view, const ViewCell& cell, const ViewPiece& piece);

}  // namespace panwright::preview
