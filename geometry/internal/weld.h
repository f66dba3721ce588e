// Which vertices stand at the same place.
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

}  // namespace panwright::geometry
