// Polygons in space → triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Cuts polygons into triangles, one after another; keeps its scratch memory between them.
class PolygonCutter {
 public:
  // Appends the n − 2 triangles of a polygon of n corners, which need not lie quite in one plane.
  // Triangles name corners (0 to n − 1), every corner is used, and all run as the outline does. As
  // they stand on one another along whole edges, their area vectors sum to that of the outline.
  //
  // Whatever its shape is said to be, a convex polygon is cut as a fan, a quadrilateral by the
  // diagonal that lies inside and leaves the rounder triangles, any other polygon as seen along the
  // axis nearest its normal: no triangle turns over there, and all have area where the outline is
  // simple. Outlines that touch themselves (holes joined by a double edge) are cut right too; where
  // they repeat a corner or turn back on themselves, triangles have no area. Outlines that cross
  // themselves are cut somehow, and their triangles overlap. Exact where it decides.
  //
  // Expects: finite corners; n < 2^32. Cost: O(n) for convex ones, O(n log n) for large simple
  // ones, else O(n²) up to 4096·n steps, after which the rest is cut as a fan.
  void cut(std::span<const Vec3> corners, std::vector<Triangle>& triangles);

 private:
  bool project(std::span<const Vec3> corners);
  bool is_strictly_convex() const;
  bool cut_by_sweep(std::span<const Vec3> corners, std::vector<Triangle>& triangles) const;

  std::vector<Vec2> plane_;  // n, counter-clockwise
};

// Whether the diagonal from b to d cuts the quadrilateral abcd better than the one from a to c:
// that lies inside where only one does, else leaves the rounder triangles; ties go to a and c.
bool cuts_better_from_second(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace panwright::geometry
