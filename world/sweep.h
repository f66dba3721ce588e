// Sweeps of joints through their ranges, and collisions of parts on the way.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "base/result.h"
#include "world/evaluation.h"
#include "world/world.h"

namespace panwright::world {

// Two parts that collide in some of the positions.
struct Collision {
  std::uint32_t node_a = 0;  // of the moving part
  std::uint32_t node_b = 0;
  double first = 0;  // values of the joint at the first and the last collision
  double last = 0;
  std::uint32_t positions = 0;  // with a collision
};

struct SweptJoint {
  std::uint32_t joint = 0;
  double from = 0;  // radians, metres or a factor
  double to = 0;
  std::uint32_t positions = 0;
  AxisBox bounds;  // of the moving part, in the model's frame, at all positions together
  std::vector<Collision> collisions;
};

// Moves joints of a target through their ranges, one at a time and in equal steps. Others stay,
// followers move along, continuous joints go once around. Reports pairs of a moving and a resting
// part whose triangles cut each other, except those that cut at the present values. Contacts within
// 1e-9 of the model's size do not count, nor do parts wholly inside another, nor collisions between
// two positions.
//
//   joints   of one value each, that follow no other; none: all such
//   steps    positions, >= 2
// Fails: E0001. Cost: a tree over each mesh once; each position O(moving parts × resting parts)
// boxes, and the triangles where these overlap.
Result<std::vector<SweptJoint>> swept(const World& world, std::size_t target,
                                      std::span<const std::uint32_t> joints, std::uint32_t steps,
                                      DiagnosticLog& log, const Job& job = {});

// Returns true if two triangles cut each other by more than `slack`.
bool triangles_cut(const Vec3 (&a)[3], const Vec3 (&b)[3], double slack);

}  // namespace panwright::world
