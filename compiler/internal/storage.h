// Storage of meshes in few bits.
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
// asks for; floats stay where 24 do not do. Vertices that lie on those of other instances stay
// where they are: no crack opens. Errors of meshes and levels grow by what moved.
//
//   tolerances  of instances, in the frame of their meshes, metres; empty: there is no budget
// Cost: O(vertices log vertices).
void snap_meshes(const scene::Scene& scene, const pan::StorageForm& form,
                 std::span<const double> tolerances, pan::Contents& out, StorageReport& report,
                 const Job& job);

// Makes the streams, of meshes as they are by now.
void encode_meshes(const pan::StorageForm& form, pan::Contents& out, StorageReport& report,
                   const Job& job);

}  // namespace panwright::compiler::internal
