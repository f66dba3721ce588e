// One moment of a scenario, as plain data: poses, joints, camera, lens and Sun.
//
// Members that no source gives are absent; the host decides what stands in their place.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "geometry/kinematics/joint.h"
#include "scenario/time.h"
#include "world/camera.h"

namespace panwright::scenario {

// Position and rotation of a target or of the camera in the world.
struct Placement {
  std::optional<Vec3> position;  // metres
  std::optional<Quat> rotation;  // unit: world_from_model, world_from_camera

  // Absent members: at the origin, not turned.
  world::Pose pose() const {
    return {position.value_or(Vec3(0)), rotation.value_or(Quat(1, 0, 0, 0))};
  }
  bool operator==(const Placement&) const = default;
};

// Values of a joint, as geometry::JointValues; of those after `count` nothing is known.
struct JointValue {
  std::string joint;               // its name in the model
  geometry::JointValues values{};  // radians, metres, factors
  std::size_t count = 0;
  bool operator==(const JointValue&) const = default;
};

struct TargetState {
  std::string name;
  Placement placement;
  std::vector<JointValue> joints;
  bool operator==(const TargetState&) const = default;
};

// Lens numbers of a moment.
struct Lens {
  std::optional<double> fov;      // full horizontal angle, radians
  std::optional<Vec2> focal;      // pixels
  std::optional<Vec2> principal;  // pixels, of docs/conventions.md 5
  bool operator==(const Lens&) const = default;
};

struct Frame {
  std::optional<double> time;           // seconds since the epoch
  std::optional<Epoch> epoch;           // of time 0; none: the scenario has no date
  TimeSystem system = TimeSystem::utc;  // in which the epoch is written
  std::string name;                     // empty: none
  std::optional<std::uint64_t> seed;
  std::vector<TargetState> targets;  // in the order of their sources
  Placement camera;
  Lens lens;
  std::optional<Vec3> sun_direction;   // from the origin to the Sun, unit
  std::optional<double> sun_distance;  // AU

  bool operator==(const Frame&) const = default;

  // Returns the state of a target, null where there is none; or adds it.
  const TargetState* find(std::string_view target) const;
  TargetState& target(std::string_view target);
  // Returns a joint of a target, which it adds where it is absent.
  JointValue& joint(std::string_view target, std::string_view joint);
};

}  // namespace panwright::scenario
