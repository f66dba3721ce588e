// Removal of parts from a scene.
#pragma once

#include <vector>

#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Returns some triangles of a mesh, and the vertices that they use, in their order. The mesh's
// error and closed mark stay.
//
//   keep  T: true for each triangle that stays
geometry::MeshShape some_triangles(const geometry::Mesh& mesh, const std::vector<char>& keep);

// Removes instances, then unused shapes and foils. Nodes stay.
//
//   keep     one per instance
//   Expects  no decal on removed instances
void keep_instances(scene::Scene& scene, const std::vector<char>& keep);

}  // namespace panwright::compiler::internal
