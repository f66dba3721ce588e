// Plates between points of a surface, which part it. Private to transport.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "light/surfels.h"
#include "trace/scene.h"
#include "transport/surfels.h"

namespace panwright::transport {

// Numbers the groups of points that see the first of their group and the farthest from it, a little
// above the surface: those that a plate stands between have other numbers, and none goes round a
// corner.
//
//   side  of the cube that holds them, metres
// Returns the group of each point, from 0; kNoGroup: beyond kMostGroups.
// Cost: two rays a point, and more for each further group.
inline constexpr std::uint8_t kNoGroup = 255, kMostGroups = 6;
std::vector<std::uint8_t> groups_of(const trace::Target& target, std::span<const Point> points,
                                    double side);

// Sets the limits of surfels: planes between them and those that they reach, but do not see.
//
//   first  of the points of each surfel; one more at the end
//   reach  the largest radius of a surfel, metres
// Throws Cancelled. Cost: a ray a pair of neighbours.
void find_limits(const trace::Target& target, std::span<const Point> points,
                 std::span<const std::uint32_t> first, double reach,
                 std::span<light::Surfel> surfels, const Job& job);

}  // namespace panwright::transport
