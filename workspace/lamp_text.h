// Lamps of a view, as written.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "workspace/settings.h"
#include "world/camera.h"
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
//   pulse BEGIN END       on in this time alone, seconds after that of the frame
//
// Fails: E0201, E5005, E5011.
std::optional<world::Lamp> lamp_of(std::string_view text, const world::World& world,
                                   DiagnosticLog& log);

// Adds the lamp of a text to others, or changes one of them that is of a model: "docking off",
// "servicer/docking intensity 20". Names may be patterns ("nav_* off"): '*' stands for any
// characters. A lamp that is named is on, unless "off" follows.
//
//   NAME, TARGET/NAME     a pattern, or the name alone where only one target has it
//   on | off
//   intensity I | R G B, power P | R G B, radius R, half-angle A, exponent N, pulse BEGIN END
//
// False: E0201, E5005, E5011.
bool set_lamp(std::string_view text, const world::World& world, std::vector<world::Lamp>& lamps,
              DiagnosticLog& log);

// Returns "TARGET/NAME" of a lamp of a model.
std::string lamp_path(const world::Lamp& lamp);

// Returns the text of a lamp that stands in the world, as lamp_of() reads it.
// Expects: a carrier of the world, no lamp at infinity.
std::string lamp_text(const world::Lamp& lamp);

// Returns the texts of settings, those of lamps on the camera as lamps of the world, where they are
// with a camera.
//
//   lamps  those that lamps_of() made of the texts
std::vector<std::string> fixed_lamp_texts(const std::vector<std::string>& texts,
                                          const std::vector<world::Lamp>& lamps,
                                          const world::Camera& camera);

// Returns the lamps of a world, those of settings added or changed.
//
//   file  of the settings, named in the messages; empty: the command line
// Fails: as set_lamp(), E0201 for more than world::World::kMaxLamps that are on; E0203 in its place
// with a file.
std::optional<std::vector<world::Lamp>> lamps_of(const Settings& settings,
                                                 const world::World& world, std::string_view file,
                                                 DiagnosticLog& log);

}  // namespace panwright::workspace
