// Triangles between two rings of vertices.
#pragma once

#include <cstdint>

#include "geometry/mesh.h"

namespace panwright::geometry::internal {

// Vertices at equal steps of a turn or sector. Shifted ones are offset by half a step; open ones
// have one more at either end.
struct RingOfVertices {
  std::uint64_t start;  // the first vertex
  std::uint64_t count;  // vertices
  std::uint64_t steps;  // < 2^30
  bool shifted;
  bool open;  // the last vertex does not join the first: a sector, or a seam of texture coordinates

  std::uint64_t segments() const { return open ? count - 1 : count; }
  std::uint64_t vertex(std::uint64_t i) const { return start + (i < count ? i : 0); }
  // the middle of a segment, in quarters of a step
  std::uint64_t middle(std::uint64_t i) const {
    if (!shifted) return 4 * i + 2;
    if (!open) return 4 * i + 4;
    return i == 0 ? 1 : i == steps ? 4 * steps - 1 : 4 * i;
  }
};

// Joins segments of both rings in the order of their middles, each with the vertex of the other
// ring nearest to its middle. With equal segments that is within half a segment. Counter-clockwise
// if low is south of high. Returns the end of its output.
//
// Cost: O(segments of both).
inline Triangle* zip(const RingOfVertices& low, const RingOfVertices& high, Triangle* out) {
  const auto triangle = [](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    return Triangle{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                    static_cast<std::uint32_t>(c)};
  };
  std::uint64_t i = 0, j = 0;
  while (i < low.segments() || j < high.segments()) {
    const bool along_low =
        j == high.segments() ||
        (i < low.segments() && low.middle(i) * high.steps <= high.middle(j) * low.steps);
    if (along_low) {
      *out++ = triangle(low.vertex(i), low.vertex(i + 1), high.vertex(j));
      ++i;
    } else {
      *out++ = triangle(low.vertex(i), high.vertex(j + 1), high.vertex(j));
      ++j;
    }
  }
  return out;
}

}  // namespace panwright::geometry::internal
