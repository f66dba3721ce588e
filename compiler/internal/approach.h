// How near a camera comes to each part.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// How far a part can be from where it stands at rest, whatever its joints do.
struct Reach {
  Vec3 centre{0};       // world: the outermost moving joint's origin, or the part's own centre
  double radius = 0;    // metres: the part always lies within
  bool bounded = true;  // false: a joint slides without limits, or scales
};

// One per instance, of its shape's bounds: rotating joints turn everywhere, sliding ones go to
// their limits.
Reach reach_of(const scene::Scene& scene, const std::vector<Mat4>& world, std::size_t instance,
               const Vec3& low, const Vec3& high);

// The distance at which a camera is nearest to a sphere: that comes along a frame's z axis, within
// `corridor` radians of it, and never nearer to the frame's origin, nor to the sphere, than
// `nearest` metres.
//
//   apex, axis  of the corridor, world; axis unit
double nearest_in_corridor(const Vec3& apex, const Vec3& axis, double corridor, double nearest,
                           const Reach& part);

// The budget's nearest distance of each instance, metres: the same for all without an approach.
// Expects: a budget with `nearest`.
//
//   surfaces  one per shape, null where there is none
std::vector<double> nearest_distances(const scene::Scene& scene, const std::vector<Mat4>& world,
                                      const std::vector<geometry::MeshShape>& surfaces);

}  // namespace panwright::compiler::internal
