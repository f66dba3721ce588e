// Serialisation of meshes for keys and entries of caches (base/work_cache.h).
#pragma once

#include "base/bytes.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// Adds all contents of a mesh.
void add_to_key(const Mesh& mesh, KeyHasher& key);
void write(const Mesh& mesh, ByteWriter& to);

// Reads a mesh of write(). Fails on lists neither empty nor as long as the positions, indices out
// of range, and numbers that are not finite.
Mesh read_mesh(ByteReader& from);

}  // namespace panwright::geometry
