// T-junctions: vertices on an edge that are not one of its ends.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/mesh/internal/edges.h"

namespace panwright::geometry {

struct Junction {
  std::uint32_t vertex = 0;     // a unique position
  std::uint32_t half_edge = 0;  // see Edges
  bool operator==(const Junction&) const = default;
};

// Returns positions at the border within a distance of the inside of another border edge: each with
// the first such side, in order of positions. Ends, and positions within the distance of them, do
// not count.
//
//   Cost: O(border) expected; gives up on crowded positions after 64 tries for each border edge,
//   with an incomplete result.
std::vector<Junction> junctions_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
                                   const Edges& edges, double distance);

}  // namespace panwright::geometry
