// Nodes posed by the animations of the file. Private to importers/gltf.
#pragma once

#include <optional>
#include <string>

#include "importers/gltf/document.h"
#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

// Which animation, and when.
struct PoseChoice {
  std::optional<std::string> animation;  // name or number; "none": the nodes stay as they are
  std::optional<double> time;            // seconds; none: the first frame
};

// Puts translations, rotations and scales of nodes where the animations have them (glTF 2.0,
// appendix C: LINEAR, STEP, CUBICSPLINE; rotations by the shorter arc). Without an animation that
// is all of them; without a time as well, the first frame, and only where nodes are elsewhere at
// rest. Of several animations of one property of a node the first counts. Weights of morph targets
// stay. Before the first key and after the last a property is what it is there.
//
//   returns  the number of animations that nodes stand by
// Fails: E6217. Reports N6216; E6206 for samplers that do not fit, whose channels are left out.
Result<std::size_t> pose_nodes(Document& document, tinygltf::Model& model,
                               const PoseChoice& choice);

}  // namespace panwright::importers::gltf
