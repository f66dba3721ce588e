// Structs → scene. Private to importers/gltf.
#pragma once

#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// Builds the scene that the options ask for. Every mesh of the file is read, so that what is wrong
// with any of them is reported. posing: number of animations that nodes stand by.
//
// Fails: E6205 for a scene that is not there. Reports E6002, E6207, E6210, W6009, N6007, W6008,
// N6214.
Result<Imported> scene_of(Document& document, const tinygltf::Model& model, std::size_t posing);

}  // namespace panwright::importers::gltf
