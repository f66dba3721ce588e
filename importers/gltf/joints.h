// AGI_articulations → joints. Private to importers/gltf.
#pragma once

#include <map>

#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// One joint for each stage of the articulations that nodes name, in their order.
//
//   places  nodes of the scene by glTF's number
//
// Joints begin with the stages' initial values. A stage of several nodes is a joint of the first,
// which those of the others follow. Reports W6215 for names that no articulation has.
void add_joints(Document& document, const tinygltf::Model& model,
                const std::map<int, std::int32_t>& places, scene::Scene& scene);

}  // namespace panwright::importers::gltf
