// tinygltf's structs and its JSON reader. Private to importers/gltf.
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// Converts the tree to tinygltf's structs: nodes, meshes, materials, textures, samplers, skins and
// scenes, at their indices, without unreadable ones. Buffers, views, accessors and images stay with
// the document: tinygltf would read them unchecked.
//
//   problem  not empty: tinygltf refused, which the schema pass should have prevented
bool structs_of(const Document& document, tinygltf::Model& model, std::string& problem);

}  // namespace panwright::importers::gltf
