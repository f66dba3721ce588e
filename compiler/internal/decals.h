// Decals: from what an author wrote to a frame on the mesh.
#pragma once

#include <optional>

#include "geometry/mesh.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// The decal's frame on the mesh of its instance: at the point of the mesh that is nearest to where
// it was put. The texture's upright is the first of the decal's own, +z and +y that is further than
// 1e-6 rad from the normal. `instance` is left to the caller. None: the mesh has no surface.
std::optional<pan::DecalContent> placed(const scene::Decal& decal, const geometry::Mesh& mesh);

// Whether some triangle of the mesh lies in part within the decal's box and faces its texture, from
// behind too where the mesh is open. Akenine-Möller, "Fast 3D triangle-box overlap testing", 2001.
bool shows(const pan::DecalContent& decal, const geometry::Mesh& mesh);

}  // namespace panwright::compiler::internal
