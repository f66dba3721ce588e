// Triangle strips, and computed normals of meshes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Appends the triangles of a strip: the first is (0,1,2), winding alternates. Triangles that repeat
// an index are left out but count for the alternation. Returns the number left out.
std::uint64_t append_strip(std::span<const std::uint32_t> strip, std::vector<Triangle>& triangles);

// Gives a mesh unit normals by angle-weighted averaging over neighbours (Thürmer and Wüthrich,
// "Computing vertex normals from polygonal facets", 1998). Edges whose facets meet at more than
// crease_angle (radians, compared to 1e-9) stay sharp: vertices there are duplicated, with their
// texcoords and colours. Vertices at equal positions are taken as one. Triangles without area do
// not count: their corners take a normal that exists already.
//
//   mesh  normals are replaced; the first group of facets that uses a vertex keeps it, others get
//         copies behind the last vertex, in order of first use; triangles keep their order. A
//         vertex with only degenerate facets gets (0, 0, 1).
//
// Expects: indices in range; V + 3*T < 2^32. Cost: O(V + T log(triangles at a vertex)) expected.
void compute_normals(Mesh& mesh, double crease_angle);

}  // namespace panwright::geometry
