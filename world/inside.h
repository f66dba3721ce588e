// Closed parts around a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "world/evaluation.h"

namespace panwright::world {

struct Part {
  std::size_t target = 0;  // index in the world
  std::uint32_t node = 0;  // of its model
};

// Returns a visible part with a closed mesh that has a point (world frame, metres) inside: the
// first by target and instance. A point on the surface may be in or out. Open meshes have no
// inside. Expects: the evaluation is up to date. Cost: O(targets), O(instances) of a target whose
// box holds the point, and O(triangles) of a mesh whose box does.
std::optional<Part> closed_part_around(const World& world, const Evaluation& evaluation,
                                       const Vec3& point);

}  // namespace panwright::world
