// Checks of meshes.
#pragma once

#include <cstdint>

#include "geometry/mesh.h"

namespace panwright::geometry {

struct MeshReport {
  std::uint64_t bad_lengths = 0;           // of normals, texcoords, colours: neither 0 nor V
  std::uint64_t bad_indices = 0;           // triangles with an index ≥ V
  std::uint64_t non_finite = 0;            // vertices with a number that is not finite
  std::uint64_t bad_normals = 0;           // finite normals whose length is not 1 to 1e-6
  std::uint64_t degenerate_triangles = 0;  // 2·area / longest edge² < 1e-7, or an index repeated
  std::uint64_t boundary_edges = 0;        // used by one triangle
  std::uint64_t non_manifold_edges = 0;    // used by three triangles or more
  std::uint64_t misoriented_edges = 0;     // used by two triangles in the same direction
  bool closed = false;                     // edges: each shared by two triangles, oppositely
  double volume = 0;                       // m³, signed: positive when triangles face outwards
  double area = 0;                         // m²
};

// Examines a mesh. Vertices at equal positions count as one, so that seams do not open a mesh.
//
// Triangles with a bad index count nowhere else; those with a corner that is not finite count for
// edges only; those with two equal corners have no edges. The volume of an open mesh is
// that of the cones from the centre of its bounds. An empty mesh is not closed.
// Cost: O(V + T log(triangles at a vertex)) expected.
MeshReport check(const Mesh& mesh);

// Sets the mesh's closed mark, by the rules of check().
void set_closed(Mesh& mesh);

}  // namespace panwright::geometry
