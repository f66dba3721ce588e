// Nodes under any regular matrix. Private to importers.
#pragma once

#include "scene/scene.h"

namespace panwright::importers {

// Adds a node with the transform `parts`; a shear needs a second one below it, "NAME_shear".
//
//   returns  the last added node, for contents
std::int32_t add_placed(std::vector<scene::Node>& nodes, scene::Node node,
                        const scene::Decomposed& parts);

}  // namespace panwright::importers
