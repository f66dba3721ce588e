// Unique positions of vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace panwright::geometry {

// For each position the first index with an equal one (0 and −0 are equal; NaN equals itself).
// Cost: O(V) expected, O(V log V) whatever the positions.
std::vector<std::uint32_t> welded(std::span<const Vec3> positions);

// The same by sorting: what welded() falls back to when its hash table crowds.
std::vector<std::uint32_t> welded_by_sorting(std::span<const Vec3> positions);

// For each position the index of one that stays: in order, a position goes to the first one that
// stayed within the tolerance (metres), and stays where there is none.
// Expects: finite positions. Cost: O(V) expected.
std::vector<std::uint32_t> welded_within(std::span<const Vec3> positions, double tolerance);

}  // namespace panwright::geometry
