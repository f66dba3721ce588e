// What is wrong with a mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

struct MeshReport {
  std::uint64_t bad_indices = 0;           // triangles with an index ≥ V
  std::uint64_t non_finite = 0;            // vertices with a number that is not finite
  std::uint64_t degenerate_triangles = 0;  // 2·area / longest edge² < 1e-7, or an index repeated
  std::uint64_t boundary_edges = 0;        // used by one triangle
  std::uint64_t non_manifold_edges = 0;    // used by three triangles or more
  std::uint64_t misoriented_edges = 0;     // used by two triangles in the same direction
  bool closed = false;                     // edges: each shared by two triangles, oppositely
  double volume = 0;                       // m³, signed: positive when triangles face outwards
  double area = 0;                         // m²
};

// Examines a mesh. Vertices at equal positions count as one, so that seams do not open a mesh.
// Cost: O(V + T) expected.
MeshReport check(const Mesh& mesh);

}  // namespace panwright::geometry
