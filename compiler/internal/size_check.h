// Warnings about sizes that suggest a wrong unit.
#pragma once

#include "base/diagnostic.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// check_sizes() of a compiled scene.
//
//   contents  of `scene`: meshes and instances
//
// Cost: O(vertices of instances).
void check_size(const scene::Scene& scene, const pan::Contents& contents, DiagnosticLog& log);

}  // namespace panwright::compiler::internal
