// Poses of nodes from the file's animations. Private to importers/gltf.
#pragma once

#include <optional>
#include <string>

#include "importers/gltf/document.h"
#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// Choice of animation and time.
struct PoseChoice {
  std::optional<std::string> animation;  // name or number; "none": the nodes' own transforms
  std::optional<double> time;            // seconds; none: the first frame
};

// Applies animations to translations, rotations and scales of nodes (glTF 2.0, appendix C: LINEAR,
// STEP, CUBICSPLINE; rotations by the shorter arc). Default: all animations at their first frame,
// only for nodes with another pose at rest. The first animation of a property wins. Weights of
// morph targets stay. Before the first key and after the last a property is constant.
//
//   returns  the number of applied animations
// Fails: E6217. Reports N6216; E6206 for samplers that do not fit, whose channels are left out.
Result<std::size_t> pose_nodes(Document& document, tinygltf::Model& model,
                               const PoseChoice& choice);

}  // namespace panwright::importers::gltf
