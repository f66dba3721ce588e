// Edges of a mesh, and the triangles at them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Edges by half-edges: 3·triangle + k runs from corner k to the next one.
struct Edges {
  static constexpr std::uint32_t kBorder = 0xffffffffu;       // of one triangle
  static constexpr std::uint32_t kNonManifold = 0xfffffffeu;  // of three triangles or more
  std::vector<std::uint32_t> twin;    // 3*T: the other half-edge of an edge of two triangles
  std::vector<std::uint32_t> border;  // half-edges, ascending
  std::vector<std::uint32_t> many;    // the first half-edge of each non-manifold edge, ascending
  std::vector<std::uint32_t> many_count;  // their triangles
  std::uint64_t misoriented = 0;          // edges with two triangles in the same direction
};

// Finds the edges of triangles between unique positions. Triangles with two equal corners have
// none: the twin of their half-edges is kNonManifold.
//
//   unique_position  V, the first vertex at the same position
//   Cost: O(T log(triangles at a vertex))
Edges edges_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position);

}  // namespace panwright::geometry
