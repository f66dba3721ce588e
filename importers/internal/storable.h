// What a pan can hold. Private to importers.
#pragma once

#include <functional>
#include <string>

#include "base/diagnostic.h"
#include "scene/scene.h"

namespace panwright::importers {

// Takes instances out of a scene, and the decals on them.
//
//   returns  where each instance has gone; scene::kNone for those that were taken out
std::vector<std::int32_t> remove_instances(
    scene::Scene& scene, const std::function<bool(const scene::Instance&)>& unwanted);

// Makes of what a reader found what a pan can hold: meshes of fewer than three vertices or without
// triangles go, numbers beyond single precision and bytes that no name may have are replaced.
// Reports W6009, W6012 for the file `name`.
void make_storable(scene::Scene& scene, const std::string& name, DiagnosticLog& log);

}  // namespace panwright::importers
