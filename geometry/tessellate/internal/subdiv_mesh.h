// Triangles over the cells of a cage.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/tessellate/internal/subdiv_cells.h"

namespace panwright::geometry::internal {

// Size of a mesh with given segments on each rail.
struct CellCounts {
  double triangles = 0;
  double vertices = 0;  // upper bound
};
CellCounts counts_of(const Cells& cells, const std::vector<std::uint32_t>& rates);

struct CellMesh {
  Mesh mesh;
  std::vector<double> errors;  // of each cell, measured
};

// Builds a grid for each cell, with the larger segment count of opposite sides; a strip joins a
// side that has fewer. Vertices stand on the limit. Cells that share a side share its positions,
// bit for bit, and the vertices unless normals or texture coordinates differ.
//
// Errors are the largest distances of sampled points of triangles from the surface, with the peak
// of the parabola through them. Borders and sharp edges are compared with their curves. A point's
// distance is that to the surface at its own parameters, or one step of Gauss and Newton beyond.
//
// Expects: kMostSegments at most. Cost: O(triangles), on all cores.
CellMesh mesh_of(const CellSurface& surface, const std::vector<std::uint32_t>& rates,
                 bool texcoords);

}  // namespace panwright::geometry::internal
