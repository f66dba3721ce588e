// Exporter: pan → GLB.
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
  // Joints become AGI_articulations. Their nodes then stand at rest, and viewers with the extension
  // apply the initial values; else all parts stand at their initial values.
  bool articulations = false;
  // One per joint, resolved; none: the model's initial ones.
  std::vector<geometry::JointValues> joint_values;
};

// Converts a model to a binary glTF 2.0 file without findings of the format's validator. Nodes keep
// their names, meshes their sharing and bits. Materials become metallic and roughness with the
// extensions ior, specular, clearcoat and emissive_strength. Textures become PNG, cut-outs alpha
// masks, solar cells textures, frames and keypoints empty nodes with `extras.kind`. Surfaces with
// visible backs are two-sided. A root above all turns z up into glTF's y up.
//
// Expects: model.checked(); values of every joint, or none.
// Fails: E0001; E6002 for more than 4 GiB. Reports W6402 for losses, with the share of the light
// that they change (materials/gltf_surface.h). Same model, same bytes. Cost: O(bytes), some ms for
// each material, and the packing of textures.
[[nodiscard]] Result<std::vector<std::byte>> glb_from(const pan::Model& model, DiagnosticLog& log,
                                                      const Job& job = {},
                                                      const GlbOptions& options = {});

}  // namespace panwright::exporters
