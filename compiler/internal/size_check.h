// Warnings about sizes that suggest a wrong unit.
#pragma once

#include "base/diagnostic.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Reports a model of more than 200 m or less than 5 cm (W2022), or instances whose sizes differ by
// more than 1e5 (W2023, instead of W2022). Sizes are the largest extents along the axes of the
// world.
//
// A single sphere, ellipsoid or mesh may be a celestial body and is never reported.
//
//   contents  of `scene`: meshes and instances
//
// Cost: O(vertices of instances).
void check_size(const scene::Scene& scene, const pan::Contents& contents, DiagnosticLog& log);

}  // namespace panwright::compiler::internal
