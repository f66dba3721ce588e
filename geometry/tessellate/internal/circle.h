// Points of circles and their polygonal approximations.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "geometry/tessellate/shape.h"

namespace panwright::geometry::internal {

// Returns sin and cos of 2π·k/n, from the first octant, so that a circle is symmetric to the last
// bit.
// Expects: k ≤ n < 2^59.
det::SinCos turn(std::uint64_t k, std::uint64_t n);

// Returns the angle of a sector, radians, 2π for a whole one.
double span_of(const Sector& sector);

// Returns unit vectors at begin + i·(end − begin)/segments: segments + 1 of them, segments for a
// whole turn. Equal sectors and counts give equal bits, and sector ends at quarter turns are exact.
std::vector<det::SinCos> directions(const Sector& sector, std::uint32_t segments);

// Returns a unit vector in the middle of a segment.
det::SinCos middle_direction(const Sector& sector, std::uint32_t segments, std::uint32_t i);

// Returns the fewest valid segments: each spans a third of a turn or less.
std::uint32_t fewest_segments(const Sector& sector);

// Returns the factor on the radius that gives a polygon the area of its circle, for segments of
// half angle `half`: sqrt(2h / sin 2h). At most 1.56 for the fewest segments.
double area_factor(double half);

// Returns the fewest segments whose outline is within max_error, > 0, of a circle of radius 1, with
// vertices on it or by area_factor outside. Saturates at 2^31.
std::uint32_t segments_within(double max_error, const Sector& sector, bool on_shape);

}  // namespace panwright::geometry::internal
