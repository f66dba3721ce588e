// Cache-friendly order of triangles and vertices.
#pragma once

#include "geometry/mesh.h"

namespace panwright::geometry {

// Sorts triangles for early reuse of vertices, in integers: the same everywhere.
void reorder_triangles(Mesh& mesh);

// Sorts vertices by first use, or, with `keep_order`, keeps their order; removes unused ones.
void compact_vertices(Mesh& mesh, bool keep_order);

}  // namespace panwright::geometry
