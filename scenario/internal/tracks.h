// Source of samples: positions, rotations, joints and numbers that share their times. Private to
// scenario.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenario/internal/track.h"
#include "scenario/source.h"

namespace panwright::scenario {

struct PositionTrack {
  std::string target;  // empty: the camera
  std::vector<Vec3> values;
  std::vector<Vec3> velocities;  // as many, or none
};

struct RotationTrack {
  std::string target;  // empty: the camera
  std::vector<Quat> values;
};

struct JointTrack {
  std::string target;
  std::string joint;
  std::size_t component = 0;  // below geometry::kMaxJointValues
  std::vector<double> values;
};

enum class LensNumber : std::uint8_t { fov, focal_x, focal_y, principal_x, principal_y };

struct LensTrack {
  LensNumber number = LensNumber::fov;
  std::vector<double> values;
};

// All lists have one value for each frame, or none.
struct Tracks {
  std::vector<double> times;  // empty: frames by order
  std::size_t frames = 0;
  Method method = Method::linear;
  std::size_t degree = 1;
  std::vector<PositionTrack> positions;
  std::vector<RotationTrack> rotations;
  std::vector<JointTrack> joints;
  std::vector<LensTrack> lens;
  std::vector<Vec3> sun_directions;  // unit
  std::vector<double> sun_distances;
  std::vector<std::string> names;
  std::vector<std::uint64_t> seeds;
};

// info: name, epoch, system, frame and centre; the rest follows from the tracks.
SourcePtr track_source(SourceInfo info, Tracks tracks);

}  // namespace panwright::scenario
