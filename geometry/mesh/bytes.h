// Meshes in keys and entries of caches (base/work_cache.h).
#pragma once

#include "base/bytes.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// All that a mesh holds.
void add_to_key(const Mesh& mesh, KeyHasher& key);
void write(const Mesh& mesh, ByteWriter& to);

// A mesh as write() had it. The reader fails where lists are neither empty nor as long as the
// positions, an index is out of range or a number is not finite.
Mesh read_mesh(ByteReader& from);

}  // namespace panwright::geometry
