// Joints that point at something: a wing at the Sun, an antenna at a direction or a place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "world/world.h"

namespace panwright::world {

// What an aim has come to, in radians.
struct Aimed {
  double error = 0;  // between what points and where it should
  double least = 0;  // the same if joints had no limits: an axis alone cannot reach every direction
  bool limited() const { return error > least + 1e-9; }  // the limits keep it from there
};

// Whether a joint of a model can aim: it has a pointing direction, and neither it nor its gimbal
// follows another joint.
bool can_aim(const pan::Model& model, std::uint32_t joint);

// Turns a joint, with its gimbal where it has one, so that its pointing direction goes along a
// direction of the world as closely as the limits allow (geometry::point_one, point_two): the
// angles that are nearest to those it has where several are equally good.
//
//   direction  of any length above 0, in world axes
//   returns    what is left: errors below 1e-12 where the joints reach it
// Expects: can_aim(). Nodes that are scaled unevenly or sheared are aimed as if they were not.
// Cost: O(nodes of the model).
Aimed aim(World& world, std::size_t index, std::uint32_t joint, const Vec3& direction);

// The same towards a point of the world, in metres, from the joint's origin.
Aimed aim_at_point(World& world, std::size_t index, std::uint32_t joint, const Vec3& point);

// Turns every joint that points at the Sun by itself (kJointPointsAtSun), outer ones first, but for
// those that were given values. Call it again when the Sun or a pose has changed.
//
//   unreached  called for each joint that its limits keep from pointing as close as its axis
//              allows, within 1e-9 rad: an axis alone cannot reach every direction
void aim_at_sun(World& world,
                const std::function<void(std::size_t index, std::uint32_t joint, double error)>&
                    unreached = {});

}  // namespace panwright::world
