// Topology of a Catmull-Clark cage.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

inline constexpr std::uint32_t kNoCorner = 0xffffffffu;

// Cage. Corners are numbered face by face; side i of a face runs from its corner i to the next.
struct Cage {
  struct Edge {
    std::uint32_t a, b;       // vertices, in the first face's direction
    std::uint32_t corner[2];  // begin of its side, in each face; the second kNoCorner: a border
    float sharpness = 0;      // 0 to kInfinitelySharp
    bool border() const { return corner[1] == kNoCorner; }
    bool splits() const {  // normals differ across it
      return border() || sharpness >= static_cast<float>(kInfinitelySharp);
    }
  };

  std::vector<std::uint32_t> first;     // F + 1: the first corner of each face
  std::vector<std::uint32_t> vertex;    // C
  std::vector<std::uint32_t> edge;      // C: of the side beginning there
  std::vector<Edge> edges;              // E, in the order of their vertices
  std::vector<float> vertex_sharpness;  // V
  bool all_quads = true;

  std::size_t faces() const { return first.size() - 1; }
  std::uint32_t sides(std::size_t face) const { return first[face + 1] - first[face]; }
  std::uint32_t next(std::size_t face, std::uint32_t corner) const {
    return corner + 1 == first[face + 1] ? first[face] : corner + 1;
  }
};

// Reads the faces, creases and corners of a shape.
//
// Fails: the first problem, see problem_of(). Cost: O(C log C).
Problem read_cage(const Subdiv& shape, Cage& cage);

// Returns the largest finite sharpness, rounded up.
int sharp_levels(const Cage& cage);

}  // namespace panwright::geometry::internal
