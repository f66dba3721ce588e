// Levels of detail of sheets of foil.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "compiler/internal/jobs.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Adds the levels of sheets: meshes and their instances. If the budget gives the footprint of the
// nearest pixel, finer levels are left out, unless the budget's flux is below the error of levels.
// Instances with decals or uneven scale keep the finest mesh alone.
//
//   mesh_of_job  index in out.meshes; beyond them: none
//   place        of the scene's instances in out.instances; beyond them: none
//   out          with meshes, instances, materials and decals, as written by now
//
// Reports: N2024. Cost: O(vertices of the levels).
void add_foil_levels(const scene::Scene& scene, const Plan& plan,
                     std::span<const std::uint32_t> mesh_of_job,
                     std::span<const std::uint32_t> place, pan::Contents& out, DiagnosticLog& log,
                     const Job& job);

}  // namespace panwright::compiler::internal
