// The lamps of a world where they are now. No OpenGL.
#pragma once

#include <vector>

#include "light/light.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::world {

// Returns the lamps that are on, in their order and in world axes.
// Cost: O(nodes + meshes) for each target that carries a lamp.
std::vector<light::Source> placed_lamps(const World& world, const Camera& camera);

// Takes the lamps of the camera off it: they stay where they are, whatever camera looks.
void fix_lamps(World& world, const Camera& camera);

}  // namespace panwright::world
