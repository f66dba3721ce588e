// Conversion of structs to a scene. Private to importers/gltf.
#pragma once

#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// Builds the scene chosen by the options. Reads every mesh of the file, to report all problems.
// posing: number of applied animations.
//
// Fails: E6205 for a missing scene. Reports E6002, E6207, E6210, W6009, N6007, W6008, N6214.
Result<Imported> scene_of(Document& document, const tinygltf::Model& model, std::size_t posing);

}  // namespace panwright::importers::gltf
