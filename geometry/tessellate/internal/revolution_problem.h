// Checks of a shape's numbers.
#pragma once

#include <string_view>

#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

// Checks a size, which must be above 0 and fit single precision: E2011, E2010.
Problem size_problem(double size, std::string_view part, std::string_view what);
// The same, accepting 0.
Problem zero_or_size_problem(double size, std::string_view part, std::string_view what);

Problem sector_problem(const Sector& sector);

// Checks the counts of a shape about an axis; least_along: with fewer chords it has no surface.
Problem counts_problem(const Counts& counts, const Sector& sector, std::uint32_t least_along);

}  // namespace panwright::geometry::internal
