// What a scene's shapes look like from afar, before they are made: surfaces, extents, reflectances.
#pragma once

#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// One mesh for each shape: its own, else a coarse one, within a fiftieth of its radius of
// curvature; null where none can be made.
std::vector<geometry::MeshShape> coarse_surfaces(const scene::Scene& scene, const Job& job);

// Half-open boxes are empty: low > high.
struct Extent {
  Vec3 low{HUGE_VAL}, high{-HUGE_VAL};
  void add(const Vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool empty() const { return !(low.x <= high.x); }
};

// A box of a mesh's frame as it stands in the world.
struct PlacedBox {
  Vec3 edges[3];
  // The largest area that the box shows in any direction, m².
  double largest_projection() const;
  // The largest area of any direction's, less the longest edge: what the box is across, metres.
  double width() const;
  double diagonal() const;
};
PlacedBox placed(const Extent& extent, const Mat4& world_from_mesh);

// The share of an even light that a material sends back, mean of the channels, with the mean of its
// albedo map or texture; one per instance. What maps of other kinds change is left out.
std::vector<double> reflectances(const scene::Scene& scene, const Job& job);

// The area that a model shows, times the reflectance of what is in front, m²: of the directions of
// a sphere, the least and the largest of 32. Surfaces are seen from both sides. By depth buffers of
// 192 × 192, so that it is good to some percent.
//
//   surfaces, world, reflectance  one per instance; null surfaces show nothing
// Cost: about 2 µs a triangle.
inline constexpr double kLeastShown = 0.1;  // of the most: less in a direction counts as so much
struct ShownArea {
  double least = 0;
  double largest = 0;
  double mean = 0;  // without the reflectance
  double mean_reflectance = 0;
  Vec3 middle{0};  // world: the mean place of what is shown, by reflectance
  // Of each surface, its mean share of what the model shows in a direction; of directions in which
  // it shows less than a tenth of the most, of that tenth.
  std::vector<double> shares;
  double pixel = 0;  // m²: what is smaller may be missed
};
ShownArea shown_area(const std::vector<geometry::MeshShape>& surfaces,
                     const std::vector<Mat4>& world, const std::vector<double>& reflectance,
                     const Job& job);

}  // namespace panwright::compiler::internal
