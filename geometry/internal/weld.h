// Unique positions of vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace panwright::geometry {

// Returns for each position the first index with an equal one (0 and −0 are equal; NaN equals
// itself). Cost: O(V) expected, O(V log V) whatever the positions.
std::vector<std::uint32_t> welded(std::span<const Vec3> positions);

// The same by sorting, the fallback of welded() when its hash table crowds.
std::vector<std::uint32_t> welded_by_sorting(std::span<const Vec3> positions);

// Returns for each position the index of a kept one: in order, a position joins the first kept one
// within the tolerance (metres), else it is kept.
// Expects: finite positions. Cost: O(V) expected.
std::vector<std::uint32_t> welded_within(std::span<const Vec3> positions, double tolerance);

}  // namespace panwright::geometry
