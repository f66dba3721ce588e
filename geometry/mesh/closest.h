// Nearest point of a mesh to another point.
#pragma once

#include <array>
#include <optional>

#include "geometry/mesh.h"

namespace panwright::geometry {

struct SurfacePoint {
  Vec3 position{0};  // on the mesh, metres
  Vec3 normal{0};    // unit: of the vertices, interpolated, or of the facet
  double distance;   // metres
};

// Returns the point of a mesh nearest to a point, on a face, a side or a corner; of equally near
// triangles the first. The normal is the facet's if the mesh has none or they cancel.
//
//   returns  nothing for a mesh without a triangle of finite positions
//
// Expects: indices in range. Exact to rounding: a few ulps of the largest coordinate. Cost: O(T).
std::optional<SurfacePoint> closest_point(const Mesh& mesh, const Vec3& point);

// Returns the nearest point of one triangle, to rounding.
Vec3 closest_point(const std::array<Vec3, 3>& triangle, const Vec3& point);

}  // namespace panwright::geometry
