// Closed borders of a mesh, by half-edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/mesh/internal/edges.h"

namespace panwright::geometry {

struct BoundaryLoop {
  std::vector<std::uint32_t>
      unique_positions;        // in the direction in which faces that fill it run its edges
  std::uint32_t triangle = 0;  // one that it bounds
  double length = 0;           // metres
};

// Returns the loops of border edges around one hole each, in order of their first sides. Edges are
// in no loop where three or more surfaces meet at a vertex or edge, so that the border is
// ambiguous.
//
// Expects: neighbours across edges wound alike. Cost: O(T). Half-edges: OpenMesh (Botsch,
// Steinberg, Bischoff, Kobbelt, "OpenMesh: a generic and efficient polygon mesh data structure",
// 2002).
std::vector<BoundaryLoop> boundary_loops_of(const Mesh& mesh,
                                            std::span<const std::uint32_t> unique_position,
                                            const Edges& edges);

// Fills a boundary loop with triangles: those of least area together for up to 64 vertices, else a
// fan about the middle, which becomes the mesh's last vertex. New triangles use the first vertex at
// a position.
void fill(Mesh& mesh, const BoundaryLoop& loop);

}  // namespace panwright::geometry
