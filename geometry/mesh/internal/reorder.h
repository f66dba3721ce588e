// Cache-friendly order of triangles and vertices.
#pragma once

#include "geometry/mesh.h"

namespace panwright::geometry {

// Sorts triangles so that a vertex is used again soon, in whole numbers: the same everywhere.
void reorder_triangles(Mesh& mesh);

// Sorts vertices by first use, or, for `keep_order`, as they were; unused ones go.
void compact_vertices(Mesh& mesh, bool keep_order);

}  // namespace panwright::geometry
