// Levels of detail of meshes.
#pragma once

#include "base/job.h"
#include "base/work_cache.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Adds levels of detail (geometry/mesh/levels.h) to the instances of meshes of 512 triangles and
// more that have none yet and no decals. A level is for pixels of which the bound of its error is a
// quarter at most, or what the budget's `pixels` says. Open borders that lie on one of another
// instance, to 1e-6 of the model, stay as they are: no crack opens there. Where the budget says
// what the nearest pixel sees, levels are left out that something coarser serves as well; the mesh
// itself stays, for the reference engine traces it.
//
//   out    with meshes, instances and decals, as written by now
//   cache  of levels that were made before; null: none
//
// Cost: 10 to 200 µs a triangle.
void add_mesh_levels(const scene::Scene& scene, const WorkCache* cache, pan::Contents& out,
                     const Job& job);

}  // namespace panwright::compiler::internal
