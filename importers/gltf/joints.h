// Conversion of AGI_articulations to joints. Private to importers/gltf.
#pragma once

#include <map>

#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// Adds one joint for each stage of the articulations of nodes, in their order.
//
//   places  nodes of the scene by glTF's number
//   axes    rotations of stages against these nodes; none: as the node
//
// Joints begin with the stages' initial values. A stage of several nodes is a joint of the first,
// followed by those of the others. Reports W6215 for names that no articulation has.
void add_joints(Document& document, const tinygltf::Model& model,
                const std::map<int, std::int32_t>& places, const std::map<int, Quat>& axes,
                scene::Scene& scene);

}  // namespace panwright::importers::gltf
