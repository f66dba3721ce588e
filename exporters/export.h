// Pan → GLB.
#pragma once

#include <cstddef>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "geometry/kinematics/joint.h"
#include "pan/model.h"

namespace panwright::exporters {

struct GlbOptions {
  // Joints become AGI_articulations. Their nodes then stand at rest, and initial values are for
  // viewers that know the extension; else parts stand where the initial values have them, for all.
  bool articulations = false;
  // Of each joint, as resolved; none: the model's initial ones.
  std::vector<geometry::JointValues> joint_values;
};

// A model as a binary glTF 2.0 file that the format's validator finds nothing wrong with: nodes
// with their names, meshes shared as the model shares them, bit for bit, materials as metallic and
// roughness with the extensions ior, specular, clearcoat and emissive_strength, textures as PNG,
// cut-outs as alpha masks, solar cells drawn, frames and keypoints as empty nodes with
// `extras.kind`. Surfaces whose backs are drawn are two-sided. A root above all turns z up into
// glTF's y up.
//
// Expects: model.checked(); values of every joint, or none.
// Fails: E0001; E6002 for more than 4 GiB. Reports W6402 for what is lost, with the share of the
// light that it changes (materials/gltf_surface.h).
// Same model, same bytes. Cost: O(bytes), some ms for each material, and the packing of textures.
[[nodiscard]] Result<std::vector<std::byte>> glb_from(const pan::Model& model, DiagnosticLog& log,
                                                      const Job& job = {},
                                                      const GlbOptions& options = {});

}  // namespace panwright::exporters
