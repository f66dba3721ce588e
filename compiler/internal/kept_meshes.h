// Meshes of exact shapes, kept between runs.
#pragma once

#include <functional>
#include <optional>

#include "base/work_cache.h"
#include "compiler/internal/jobs.h"
#include "geometry/mesh.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/writer.h"

namespace panwright::compiler::internal {

// Whether a mesh takes longer to make than to read: one of a thousand triangles or more that is
// not given as triangles.
bool worth_keeping(const MeshJob& job, const geometry::TessellationOptions& tessellation);

// Of all that the mesh of a job follows from.
Hash128 mesh_key(const MeshJob& job, const geometry::TessellationOptions& tessellation);

// A mesh without its name, as `make` packs it, or the same from a cache.
//
//   cache  null: none
std::optional<pan::PackedMesh> kept_or_packed(
    const WorkCache* cache, const MeshJob& job, const geometry::TessellationOptions& tessellation,
    const std::function<std::optional<pan::PackedMesh>()>& make);

// The same before it is packed: decals lie on this.
std::optional<geometry::Mesh> kept_or_made(
    const WorkCache* cache, const MeshJob& job, const geometry::TessellationOptions& tessellation,
    const std::function<std::optional<geometry::Mesh>()>& make);

// As bytes and back. The reader fails where it is no mesh that pan::write() takes.
void write(const pan::PackedMesh& mesh, ByteWriter& to);
pan::PackedMesh read_packed(ByteReader& from);

}  // namespace panwright::compiler::internal
