// Levels of detail of meshes.
#pragma once

#include "base/job.h"
#include "base/work_cache.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Adds levels of detail (geometry/mesh/levels.h) to the instances of meshes of 512 triangles and
// more that have none yet and no decals. A level serves pixels of which its error bound is at most
// a quarter, or the budget's `pixels`. Open borders that meet those of another instance, to 1e-6 of
// the model, stay unchanged: no crack opens. If the budget gives the footprint of the nearest
// pixel, levels finer than needed are left out. The mesh itself stays for the reference engine.
//
//   out    with meshes, instances and decals, as written so far
//   cache  of earlier levels; null: none
//
// Cost: 10 to 200 µs a triangle.
void add_mesh_levels(const scene::Scene& scene, const WorkCache* cache, pan::Contents& out,
                     const Job& job);

}  // namespace panwright::compiler::internal
