// Nearest distances of a camera to each part.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Sphere around all places of a part, for any joint values.
struct Reach {
  Vec3 centre{0};       // world: the outermost moving joint's origin, or the part's own centre
  double radius = 0;    // metres: the part always lies within
  bool bounded = true;  // false: a joint slides without limits, or scales
};

// Returns the reach of an instance from its shape's bounds: rotating joints turn everywhere,
// sliding ones go to their limits.
Reach reach_of(const scene::Scene& scene, const std::vector<Mat4>& world, std::size_t instance,
               const Vec3& low, const Vec3& high);

// Returns the distance at which a camera is nearest to a sphere. The camera comes along a frame's z
// axis, within `corridor` radians, and stays `nearest` metres or more from the frame's origin and
// the sphere.
//
//   apex, axis  of the corridor, world; axis unit
double nearest_in_corridor(const Vec3& apex, const Vec3& axis, double corridor, double nearest,
                           const Reach& part);

// Returns the budget's nearest distance of each instance, metres: the same for all without an
// approach.
// Expects: a budget with `nearest`.
//
//   surfaces  one per shape, null if none
std::vector<double> nearest_distances(const scene::Scene& scene, const std::vector<Mat4>& world,
                                      const std::vector<geometry::MeshShape>& surfaces);

}  // namespace panwright::compiler::internal
