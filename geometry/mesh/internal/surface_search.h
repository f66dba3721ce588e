// Search for the nearest triangle of a mesh, with distances accurate for needles and points too.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"
#include "geometry/ray/box_tree.h"

namespace panwright::geometry {

// A triangle in axes of its own: its longest edge along x, from the origin; the third corner at (u,
// h). Distances are accurate to some ulps of the edge, however thin the triangle: without area it
// is a segment, without length a point.
class FramedTriangle {
 public:
  FramedTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  double squared_distance(const Vec3& point) const;

 private:
  Vec3 origin_;
  Vec3 along_{0}, across_{0}, normal_{0};  // unit; 0 if undefined
  double length_ = 0, u_ = 0, h_ = 0;
};

// Search tree over a mesh, which must outlive it.
//
// Expects: indices in range, finite positions within ±1e100. Cost: 260 bytes a triangle.
class SurfaceSearch {
 public:
  struct Nearest {
    std::uint32_t triangle = 0;
    double squared = std::numeric_limits<double>::infinity();  // m²
  };

  explicit SurfaceSearch(const Mesh& mesh);

  const Mesh& mesh() const { return *mesh_; }
  const std::vector<FramedTriangle>& triangles() const { return triangles_; }
  // Of all coordinates, metres.
  double largest_coordinate() const { return largest_; }
  // 2-norm of the sides of the bounds, metres.
  double diagonal() const { return diagonal_; }

  // Returns the nearest triangle; of equally near ones the first.
  //
  //   hint     a triangle that may be near
  //   Expects  at least one triangle
  Nearest nearest(const Vec3& point, std::uint32_t hint = 0) const;

  // The same among triangles within `reach` (metres) whose facets face along a direction, if there
  // are any.
  Nearest nearest_facing(const Vec3& point, const Vec3& direction, double reach,
                         std::uint32_t hint) const;

  // Returns for each of the mesh's vertices, in order, the nearest triangle of another one. Unused
  // vertices have an infinite distance.
  std::vector<Nearest> nearest_of_vertices(const Mesh& other, const Job& job) const;

 private:
  const Mesh* mesh_;
  std::vector<FramedTriangle> triangles_;
  BoxTree tree_;
  double largest_ = 0;
  double diagonal_ = 0;
};

}  // namespace panwright::geometry
