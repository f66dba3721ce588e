// The lamps of a world where they are now. No OpenGL.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "light/light.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::world {

// Returns the lamps of a model, on a target of this name. Expects: checked().
std::vector<Lamp> lamps_of(const std::string& target, const pan::Model& model);

// Returns the lamps that are on, in their order and in world axes.
// Cost: O(nodes + meshes) for each target that carries a lamp.
std::vector<light::Source> placed_lamps(const World& world, const Camera& camera);

// Puts a lamp, now in the frame of a target's node or named frame, on the node: by the frame's name
// or the node's path.
//
// Fails: E5005.
bool put_on_node(Lamp& lamp, const World& world, std::size_t target, std::string_view name,
                 DiagnosticLog& log);

// Returns lamps as an exposure has them: the intensity of one with a pulse times the share of the
// exposure in its pulse, and off without any. The results have no pulses.
//
//   begin, end  seconds after the time of the frame, begin <= end; the same: an instant
std::vector<Lamp> lamps_during(std::vector<Lamp> lamps, double begin, double end);

// Takes the lamps of the camera off it: they stay where they are, whatever camera looks.
void fix_lamps(World& world, const Camera& camera);

}  // namespace panwright::world
