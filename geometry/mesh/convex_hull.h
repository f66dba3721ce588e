// Convex hull of points.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// Returns the triangles of the convex hull (Barber, Dobkin and Huhdanpaa, "The quickhull algorithm
// for convex hulls", 1996), counterclockwise from outside, with indices of points. Points that are
// within 1e-11 of the extent of a triangle may be left out. Nothing if all points lie in one plane.
//
// Expects: finite points. Cost: O(n log n) expected, O(n²) at worst.
std::optional<std::vector<Triangle>> convex_hull(std::span<const Vec3> points, const Job& job = {});

}  // namespace panwright::geometry
