// Placement of targets and observers, from the records of a pan and the state of a world. All in
// double, and a second text beside world/evaluation.h: each finds the mistakes of the other.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "world/world.h"

namespace panwright::trace {

// Affine map: p' = linear·p + offset.
struct Affine {
  Mat3 linear{1};
  Vec3 offset{0};
  Vec3 operator()(const Vec3& p) const { return linear * p + offset; }
};

// Composes `outer` after `inner`.
inline Affine operator*(const Affine& outer, const Affine& inner) {
  return {outer.linear * inner.linear, outer(inner.offset)};
}

// Returns the rotation of a quaternion of any length but zero.
Mat3 rotation_matrix(const Quat& q);

// Rigid frame in the world, of a target or an observer; metres.
struct RigidFrame {
  Mat3 world_from{1};
  Vec3 position{0};
};
RigidFrame frame_of(const world::Pose& pose);

// Returns `to`'s frame from `from`'s. The positions are subtracted first, so that large ones
// cancel.
Affine between(const RigidFrame& to, const RigidFrame& from);

// Every node of a target in its model's frame, and its visibility.
struct PlacedNodes {
  std::vector<Affine> model_from_node;
  std::vector<std::uint8_t> visible;  // 0 or 1, ancestors included
};
PlacedNodes placed_nodes(const world::Instance& instance);

// Returns the map of outward normals to outward normals, of any length: the inverse transposed up
// to scale, finite for singular matrices.
Mat3 normal_matrix(const Mat3& linear);

}  // namespace panwright::trace
