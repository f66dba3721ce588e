// Outlines of targets on the image. Private to preview; nothing here needs OpenGL.
#pragma once

#include <span>
#include <vector>

#include "preview/frame/projection.h"

namespace panwright::preview {

// Convex hull of boxes on the image plane, pixels.
class Outline {
 public:
  // Cost: O(n log n) of the boxes. Memory is kept from call to call.
  void find(const world::Camera& camera, std::span<const PlacedBox> boxes);

  // Smallest distance of two parallels around it; infinite if a box reaches behind the camera.
  double width() const { return width_; }
  // Distance of a point from it; 0 inside.
  double distance(const Vec2& point) const;

 private:
  std::vector<Vec2> all_;     // corners of the boxes
  std::vector<Vec2> points_;  // in order around it
  double width_ = 0;
};

}  // namespace panwright::preview
