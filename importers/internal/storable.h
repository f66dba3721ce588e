// Restriction of scenes to the contents of a pan. Private to importers.
#pragma once

#include <functional>
#include <string>

#include "base/diagnostic.h"
#include "scene/scene.h"

namespace panwright::importers {

// Removes instances from a scene, with their decals.
//
//   returns  the new index of each instance; scene::kNone for removed ones
std::vector<std::int32_t> remove_instances(
    scene::Scene& scene, const std::function<bool(const scene::Instance&)>& unwanted);

// Makes a read scene storable. Removes meshes of fewer than three vertices or without triangles.
// Replaces numbers beyond single precision, invalid bytes in names, values of joints outside their
// limits, and transforms that overflow. Reports W6009, W6012, E2010 for the file `name`.
void make_storable(scene::Scene& scene, const std::string& name, DiagnosticLog& log);

}  // namespace panwright::importers
