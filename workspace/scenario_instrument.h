// Instruments that measure the frames of a scenario beside its camera.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "world/world.h"

namespace panwright::workspace {

enum class InstrumentKind : std::uint8_t { lidar, radar };

struct ScenarioInstrument {
  InstrumentKind kind = InstrumentKind::lidar;
  std::string name;                // in names of files, after that of the frame
  std::string file;                // docs/lidar.md, docs/radar.md
  std::vector<std::string> types;  // extensions of its files
  std::string frame;               // axes of points: "instrument", "world", or a target's name
  bool ideal = false;
  world::Pose mount{Vec3(0), Quat(1, 0, 0, 0)};  // camera_from_instrument
};

}  // namespace panwright::workspace
