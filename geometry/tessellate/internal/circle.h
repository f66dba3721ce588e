// Points of circles and the segments that approximate them.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "geometry/tessellate/shape.h"

namespace panwright::geometry::internal {

// sin and cos of 2π·k/n, from the first octant, so that a circle is symmetric to the last bit.
// Expects: k ≤ n < 2^59.
det::SinCos turn(std::uint64_t k, std::uint64_t n);

// The angle of a sector, radians, 2π for a whole one.
double span_of(const Sector& sector);

// Unit vectors at begin + i·(end − begin)/segments: segments + 1 of them, segments for a whole
// turn. Equal sectors and counts give equal bits, and sector ends at quarter turns are exact.
std::vector<det::SinCos> directions(const Sector& sector, std::uint32_t segments);

// A unit vector in the middle of a segment.
det::SinCos middle_direction(const Sector& sector, std::uint32_t segments, std::uint32_t i);

// The fewest segments that make a shape: each spans a third of a turn or less.
std::uint32_t fewest_segments(const Sector& sector);

// The factor on the radius that gives a polygon of segments of `half` their half angle the area of
// its circle: sqrt(2h / sin 2h). At most 1.56 for the fewest segments.
double area_factor(double half);

// The fewest segments for which the outline of a circle of radius 1 misses it by no more than
// max_error, > 0, with vertices on it or by area_factor outside. Saturates at 2^31.
std::uint32_t segments_within(double max_error, const Sector& sector, bool on_shape);

}  // namespace panwright::geometry::internal
