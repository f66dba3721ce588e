// Joints that point at something: a wing at the Sun, an antenna at a direction or a place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "world/world.h"

namespace panwright::world {

// Result of an aim, in radians.
struct Aimed {
  double error = 0;  // between the pointing direction and its target
  double least = 0;  // the same if joints had no limits: an axis alone cannot reach every direction
  bool limited() const { return error > least + 1e-9; }  // the limits keep it away
};

// Returns true if a joint of a model can aim: it has a pointing direction, and neither it nor its
// gimbal follows another joint.
bool can_aim(const pan::Model& model, std::uint32_t joint);

// Turns a joint, with its gimbal if any, so that it points along a direction of the world as
// closely as limits allow (geometry::point_one, point_two). Of equally good angles, takes the
// nearest to the present ones.
//
//   direction  of any length above 0, in world axes
//   returns    the remaining error: below 1e-12 where the joints reach it
// Expects: can_aim(). Nodes that are scaled unevenly or sheared are aimed as if they were not.
// Cost: O(nodes of the model).
Aimed aim(World& world, std::size_t index, std::uint32_t joint, const Vec3& direction);

// The same towards a point of the world, in metres, from the joint's origin.
Aimed aim_at_point(World& world, std::size_t index, std::uint32_t joint, const Vec3& point);

// Turns every joint that tracks the Sun (kJointPointsAtSun), outer ones first, except those with
// given values. Call again when the Sun or a pose has changed.
//
//   unreached  called for each joint whose limits keep it more than 1e-9 rad from the best its axis
//              allows: an axis alone cannot reach every direction
void aim_at_sun(World& world,
                const std::function<void(std::size_t index, std::uint32_t joint, double error)>&
                    unreached = {});

}  // namespace panwright::world
