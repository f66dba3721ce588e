// Decals: from the authored placement to a frame on the mesh.
#pragma once

#include <optional>

#include "geometry/mesh.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Returns the decal's frame on the mesh of its instance, at the mesh point nearest to its authored
// position. Upright is the first of the decal's own, +z and +y that is further than 1e-6 rad from
// the normal. `instance` is left to the caller. None: the mesh has no surface.
std::optional<pan::DecalContent> placed(const scene::Decal& decal, const geometry::Mesh& mesh);

// Returns true if some triangle of the mesh lies partly in the decal's box and faces its texture;
// from behind too if the mesh is open. Akenine-Möller, "Fast 3D triangle-box overlap testing",
// 2001.
bool shows(const pan::DecalContent& decal, const geometry::Mesh& mesh);

}  // namespace panwright::compiler::internal
