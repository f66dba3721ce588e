// Surfaces, extents and reflectances of a scene's shapes before tessellation, for estimates from
// afar.
#pragma once

#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "base/math.h"
#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Returns one mesh for each shape: its own, else a coarse one within a fiftieth of its radius of
// curvature; null if it fails.
std::vector<geometry::MeshShape> coarse_surfaces(const scene::Scene& scene, const Job& job);

// A box of a mesh's frame, placed in the world.
struct PlacedBox {
  Vec3 edges[3];
  // Returns the largest projected area of the box in any direction, m².
  double largest_projection() const;
  // Returns the diagonal of the box across its longest edge, metres.
  double width() const;
  double diagonal() const;
};
PlacedBox placed(const AxisBox& box, const Mat4& world_from_mesh);

// Returns the share of uniform light that a material reflects, mean of the channels, with the mean
// of its albedo map or texture; one per instance. Maps of other kinds are ignored.
std::vector<double> reflectances(const scene::Scene& scene, const Job& job);

// Projected areas of a model times the reflectance in front, m²: the least and the largest of 32
// directions of a sphere. Surfaces are visible from both sides. By depth buffers of 192 × 192, so
// good to some percent.
//
//   surfaces, world, reflectance  one per instance; null surfaces show nothing
// Cost: about 2 µs a triangle.
inline constexpr double kLeastShown = 0.1;  // of the largest: lower bound of a direction's area
struct ShownArea {
  double least = 0;
  double largest = 0;
  double mean = 0;  // without the reflectance
  double mean_reflectance = 0;
  Vec3 middle{0};  // world: mean of the visible points, weighted by reflectance
  // Mean share of each surface in the area shown by the model; in directions that show less than a
  // tenth of the most, relative to that tenth.
  std::vector<double> shares;
  double pixel = 0;  // m²: smaller areas may be missed
};
ShownArea shown_area(const std::vector<geometry::MeshShape>& surfaces,
                     const std::vector<Mat4>& world, const std::vector<double>& reflectance,
                     const Job& job);

}  // namespace panwright::compiler::internal
