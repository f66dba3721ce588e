// Structure of the files that our exporter writes. Private to importers/gltf.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// Meaning of a node of an exported file, from `extras.kind`.
enum class NodeKind : std::uint8_t {
  part,      // a node of the model, as every node of other programs
  origin,    // the place of a mesh's origin at the node above
  frame,     // a frame of the node above
  keypoint,  // a keypoint of the node above
  motion,    // the motion of a joint, part of the transform of the node above
  axis,      // the axis of a joint of the node above, or the way back from it
};

NodeKind kind_of(const Document& document, const tinygltf::Model& model, int node);

// Returns the part that a node of an exported file is labelled as; empty: none.
std::string label_of(const Document& document, const tinygltf::Model& model, int node);

// Returns the node of the model's root, which stands below one that turns z up into y up. Nothing
// for a file of another program, or one that was changed.
std::optional<int> exported_root(const tinygltf::Model& model, const std::vector<int>& roots);

}  // namespace panwright::importers::gltf
