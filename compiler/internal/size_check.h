// Warnings of sizes that tell of a unit mistaken.
#pragma once

#include "base/diagnostic.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Reports a model of more than 200 m or less than 5 cm (W2022), and parts, which are instances, of
// which one is more than 1e5 times as large as another (W2023, in the place of W2022). Sizes are
// the largest extents along the axes of the world.
//
// What is one sphere, ellipsoid or mesh alone may be a celestial body and is never wrong.
//
//   contents  of `scene`: meshes and instances
//
// Cost: O(vertices of instances).
void check_size(const scene::Scene& scene, const pan::Contents& contents, DiagnosticLog& log);

}  // namespace panwright::compiler::internal
