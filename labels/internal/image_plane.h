// Image plane of a camera: places of points and triangles in its axes, with distortion.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/axis_box.h"
#include "base/math.h"
#include "trace/scene.h"
#include "world/camera.h"

namespace panwright::labels {

// Points in camera axes, metres, and places in pixels.
class ImagePlane {
 public:
  // Expects: the camera outlives the plane.
  explicit ImagePlane(const world::Camera& camera) : camera_(camera) {}

  const world::Camera& camera() const { return camera_; }
  bool distorted() const { return camera_.distortion != nullptr; }
  bool orthographic() const { return camera_.projection == world::Projection::orthographic; }
  // True: all view rays meet in the camera's position.
  bool central() const;

  // Returns the place of a point; none: behind the camera, or outside the domain of its lens.
  std::optional<Vec2> place(const Vec3& point) const;
  // Returns the view ray of a place, from an observer at the camera's pose; none: the
  // lens has none there.
  std::optional<trace::Ray> view_ray(const Vec2& place) const;
  // Returns the view ray that ends in a point, as far as the point.
  std::optional<trace::Ray> view_ray_to(const Vec3& point) const;

 private:
  const world::Camera& camera_;
};

using PlacedTriangle = std::array<Vec2, 3>;  // pixels

// Triangles on the image plane. Of what reaches behind the camera or outside the lens's domain, the
// rest.
struct PlacedTriangles {
  std::vector<PlacedTriangle> triangles;
  std::vector<std::uint32_t> numbers;  // of each in its mesh; empty unless asked for
  AxisRectangle box;
  bool cut = false;  // there was a rest
};

// Point of a mesh on the plane; a place that is not a number: none.
struct PlacedPoint {
  Vec3 point{0};  // metres, camera axes
  Vec2 place{std::numeric_limits<double>::quiet_NaN()};
  bool placed() const { return !std::isnan(place.x); }
};

PlacedPoint placed_point(const ImagePlane& plane, const Vec3& point);

// Adds a triangle. A curved edge becomes a chain, less than 1/200 of a pixel from it; triangles
// that share an edge share the chain.
void add_triangle(const ImagePlane& plane, const PlacedPoint& a, const PlacedPoint& b,
                  const PlacedPoint& c, std::optional<std::uint32_t> number, PlacedTriangles& out);

}  // namespace panwright::labels
