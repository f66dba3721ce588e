// Cache of meshes of exact shapes between runs.
#pragma once

#include "base/work_cache.h"
#include "compiler/internal/jobs.h"
#include "geometry/mesh.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/writer.h"

namespace panwright::compiler::internal {

// Returns true if a mesh takes longer to make than to read: a thousand triangles or more, not given
// as triangles.
bool worth_keeping(const MeshJob& job, const geometry::TessellationOptions& tessellation);

// Form of a cached mesh: packed and without its name, or as decals need it.
enum class Kept : std::uint64_t { packed, mesh };

// Returns the hash of all inputs of a job's mesh.
Hash128 mesh_key(const MeshJob& job, const geometry::TessellationOptions& tessellation,
                 Kept kept = Kept::packed);

// Serialisation to bytes and back. The reader fails on a mesh that pan::write() would refuse.
void write_packed(const pan::PackedMesh& mesh, ByteWriter& to);
pan::PackedMesh read_packed(ByteReader& from);

}  // namespace panwright::compiler::internal
