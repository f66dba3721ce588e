// tinygltf's structs, its JSON reader and nothing else of it. Private to importers/gltf.
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// The tree without what cannot be read as tinygltf's structs: nodes, meshes, materials, textures,
// samplers, skins and scenes, at their places. Buffers, views, accessors and images stay with the
// document: tinygltf would read them unchecked.
//
//   problem  not empty: tinygltf refused, which the schema pass should have prevented
bool structs_of(const Document& document, tinygltf::Model& model, std::string& problem);

}  // namespace panwright::importers::gltf
