// Triangulation of flat areas.
#pragma once

#include <span>
#include <vector>

#include "geometry/tessellate/internal/outline.h"

namespace panwright::geometry::internal {

// Triangulates a region without a fault: N + 2·holes − 2 counter-clockwise triangles over its
// points, all of positive area, none added, none unused. A sweep cuts off triangles visible from
// its front (Hertel and Mehlhorn, "Fast triangulation of simple polygons", 1983); then edges are
// flipped towards the Delaunay triangulation (Lawson, 1977), at most 64 times for each triangle.
//
//   space  N points that project to the region along an axis: distances are taken there; empty: in
//          the plane itself
//
// Expects: fault_of(region) found nothing. Cost: O(N log N) and the flips.
std::vector<Triangle> triangulated(const Region& region, std::span<const Vec3> space = {});

}  // namespace panwright::geometry::internal
