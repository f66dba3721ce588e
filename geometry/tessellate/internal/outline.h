// Flat areas bounded by an outline and holes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry::internal {

// Region bounded by loops of consecutive points: the outline first, then the holes. An edge has the
// index of its first point. After fault_of() found nothing, next and prev run so that the area lies
// to the left, whatever the authored direction.
struct Region {
  std::vector<Vec2> points;          // N, scaled to below 1 by a power of two
  std::vector<std::uint32_t> loops;  // L + 1: loop i holds the points [loops[i], loops[i + 1])
  std::vector<std::uint32_t> loop;   // N: the loop of each point
  std::vector<std::uint32_t> next;   // N
  std::vector<std::uint32_t> prev;   // N

  std::uint32_t size() const { return static_cast<std::uint32_t>(points.size()); }
};

// Makes a region of N finite points in loops, each of 3 or more. Coordinates below 1e-60 of the
// largest become 0, so that every decision is exact.
Region region_of(std::span<const Vec2> points, std::vector<std::uint32_t> loops);

struct RegionFault {
  enum class Kind : std::uint8_t {
    coincident,  // the ends of an edge, to 1e-9 of the whole
    crossing,    // two edges cross, touch or lie on one another
    outside,     // a hole is not inside the outline
    nested,      // a hole lies in another
  } kind;
  std::uint32_t edge = 0;
  std::uint32_t other = 0;  // nested: an edge of the hole around it
};

// Finds the first fault of a region, from left to right; nothing: all loops are simple and apart,
// holes inside the outline, and next and prev are set. Shamos and Hoey, "Geometric intersection
// problems", 1976. Cost: O(N log N).
std::optional<RegionFault> fault_of(Region& region);

// Returns the order by x, then y, then index.
std::vector<std::uint32_t> sweep_order(const std::vector<Vec2>& points);

}  // namespace panwright::geometry::internal
