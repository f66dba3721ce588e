// Taking parts out of a scene.
#pragma once

#include <vector>

#include "geometry/tessellate/shape.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Some triangles of a mesh, and the vertices that they use, in their order. The mesh's error, and
// whether it counts as closed, stay.
//
//   keep  T: whether a triangle stays
geometry::MeshShape some_triangles(const geometry::Mesh& mesh, const std::vector<char>& keep);

// Removes instances, then the shapes and the foils that nobody uses. Nodes stay.
//
//   keep     one per instance
//   Expects  that no decal lies on what goes
void keep_instances(scene::Scene& scene, const std::vector<char>& keep);

}  // namespace panwright::compiler::internal
