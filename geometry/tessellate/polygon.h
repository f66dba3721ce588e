// Polygons in space → triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Cutter of polygons into triangles, which keeps its scratch memory between them.
class PolygonCutter {
 public:
  // Appends the n − 2 triangles of a polygon of n corners, nearly in one plane. Triangles name
  // corners (0 to n − 1), use every corner, and keep the outline's direction. Since they join along
  // whole edges, their area vectors sum to that of the outline.
  //
  // A convex polygon is cut as a fan, a quadrilateral by the inner diagonal with the rounder
  // triangles. Any other polygon is cut in the projection along the axis nearest its normal: no
  // triangle is inverted there, and all have area if the outline is simple. Outlines that touch
  // themselves (holes joined by a double edge) are handled; repeated corners and reversals give
  // triangles without area. Outlines that cross themselves give overlapping triangles. Decisions
  // are exact.
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

// Returns true if the diagonal from b to d cuts the quadrilateral abcd better than the one from a
// to c: the only one inside, else the one with the rounder triangles; ties go to a and c.
bool cuts_better_from_second(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace panwright::geometry
