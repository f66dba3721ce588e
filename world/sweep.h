// What joints sweep on their way through their ranges, and where parts meet.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/job.h"
#include "base/result.h"
#include "world/evaluation.h"
#include "world/world.h"

namespace panwright::world {

// Two parts that meet in some of the positions.
struct Collision {
  std::uint32_t node_a = 0;  // of the part that moves
  std::uint32_t node_b = 0;
  double first = 0;  // values of the joint: the first and the last one at which they meet
  double last = 0;
  std::uint32_t positions = 0;  // at which they do
};

struct SweptJoint {
  std::uint32_t joint = 0;
  double from = 0;  // radians, metres or a factor
  double to = 0;
  std::uint32_t positions = 0;
  Bounds bounds;  // of what moves, in the model's frame, at all positions together
  std::vector<Collision> collisions;
};

// Moves joints of a target through their ranges, one at a time and in equal steps, the others where
// they are and followers along; continuous joints once around. Where triangles of a part that moves
// cut those of one that does not move along, both are named, but for parts that cut each other
// where the joints are now. Triangles that touch within 1e-9 of the model's size do not cut; what
// is wholly inside another part does not meet it either. What happens between two positions is not
// seen.
//
//   joints   of one value each, that follow no other; none: all such
//   steps    positions, >= 2
// Fails: E0001.
// Cost: a tree over each mesh once; each position O(parts that move × parts that do not) boxes, and
// the triangles where these overlap.
Result<std::vector<SweptJoint>> swept(const World& world, std::size_t target,
                                      std::span<const std::uint32_t> joints, std::uint32_t steps,
                                      DiagnosticLog& log, const Job& job = {});

// Whether two triangles cut each other: more than touch, by `slack`.
bool triangles_cut(const Vec3 (&a)[3], const Vec3 (&b)[3], double slack);

}  // namespace panwright::world
