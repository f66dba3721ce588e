// Lamps of a view, as written.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "workspace/settings.h"
#include "world/world.h"

namespace panwright::workspace {

// Reads a lamp: "spot on camera at 0.3 0 0 toward 0 0 5 intensity 100 half-angle 20deg".
//
//   KIND                  spot, point, disc, or led: a spot of half-angle 90deg and exponent 1
//   on CARRIER            camera, or TARGET/FRAME or TARGET/NODE; without: world axes
//   at X Y Z              metres, in the frame of the carrier
//   toward X Y Z          a point there; without: a metre further along z
//   intensity I | R G B   on the axis; or power P | R G B, of all directions
//   radius R, half-angle A, exponent N
//
// Fails: E0201, E5005, E5011.
std::optional<world::Lamp> lamp_of(std::string_view text, const world::World& world,
                                   DiagnosticLog& log);

// Returns the lamps of settings, beside those of a world.
//
//   file  of the settings, named in the messages; empty: the command line
// Fails: as lamp_of(), E0201 beyond world::World::kMaxLamps; E0203 in its place with a file.
std::optional<std::vector<world::Lamp>> lamps_of(const Settings& settings,
                                                 const world::World& world, std::string_view file,
                                                 DiagnosticLog& log);

}  // namespace panwright::workspace
