// Cache of meshes of exact shapes between runs.
#pragma once

#include <functional>
#include <optional>

#include "base/work_cache.h"
#include "compiler/internal/jobs.h"
#include "geometry/mesh.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/writer.h"

namespace panwright::compiler::internal {

// Returns true if a mesh takes longer to make than to read: a thousand triangles or more, not given
// as triangles.
bool worth_keeping(const MeshJob& job, const geometry::TessellationOptions& tessellation);

// Returns the hash of all inputs of a job's mesh.
Hash128 mesh_key(const MeshJob& job, const geometry::TessellationOptions& tessellation);

// Returns a mesh without its name, packed by `make` or from the cache.
//
//   cache  null: none
std::optional<pan::PackedMesh> kept_or_packed(
    const WorkCache* cache, const MeshJob& job, const geometry::TessellationOptions& tessellation,
    const std::function<std::optional<pan::PackedMesh>()>& make);

// Returns the same before packing, as decals need it.
std::optional<geometry::Mesh> kept_or_made(
    const WorkCache* cache, const MeshJob& job, const geometry::TessellationOptions& tessellation,
    const std::function<std::optional<geometry::Mesh>()>& make);

// Serialisation to bytes and back. The reader fails on a mesh that pan::write() would refuse.
void write(const pan::PackedMesh& mesh, ByteWriter& to);
pan::PackedMesh read_packed(ByteReader& from);

}  // namespace panwright::compiler::internal
