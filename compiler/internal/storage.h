// Quantised storage of meshes.
#pragma once

#include <span>
#include <vector>

#include "base/job.h"
#include "compiler/compile.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// The share of a mesh's tolerance that storage may take; tessellation has the rest.
inline constexpr double kStorageShare = 0.25;

// Moves the vertices of all meshes to grids of form.bits, or of as many more as a mesh's tolerance
// needs; floats stay if 24 do not suffice. Vertices shared with other instances stay: no crack
// opens. Errors of meshes and levels grow by the displacement.
//
//   tolerances  of instances, in the frame of their meshes, metres; empty: there is no budget
// Cost: O(vertices log vertices).
void snap_meshes(const scene::Scene& scene, const pan::StorageForm& form,
                 std::span<const double> tolerances, pan::Contents& out, StorageReport& report,
                 const Job& job);

// Encodes the present meshes as streams.
void encode_meshes(const pan::StorageForm& form, pan::Contents& out, StorageReport& report,
                   const Job& job);

}  // namespace panwright::compiler::internal
