// Bodies of the sky beside an image, in words. Private to workspace.
#pragma once

#include <string>
#include <vector>

#include "workspace/frame.h"
#include "world/world.h"

namespace panwright::workspace {

// Returns a text for each body: how far and how wide it is from the camera, and whether that is
// within it or its air; and one for each target that bodies hide from the Sun, in part or wholly.
// Cost: O(bodies · targets).
std::vector<std::string> sky_words(const Frame& frame, const world::World& world);

}  // namespace panwright::workspace
