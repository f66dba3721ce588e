// Triangles for exact shapes.
#pragma once

#include "base/diagnostic.h"
#include "base/result.h"
#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace panwright::geometry {

struct TessellationOptions {
  double max_error = 1e-3;           // metres, > 0; used where the shape has no explicit counts
  bool texcoords = false;            // makes uv coordinates, with a seam and split poles
  std::uint64_t max_triangles = 1ull << 27;
};

// Triangulates a shape. Explicit counts are obeyed exactly; otherwise no point of the mesh lies
// further than max_error from the shape.
//
//   returns  closed where the shape is closed (texture seams aside); analytic unit normals;
//            error: the largest distance between mesh and shape, metres, measured on the
//            vertices as float32 would store them
//
// A MeshShape is returned as it is, with its triangles' error of rounding to float32.
// Fails: E2003. Cost: O(triangles).
Result<Mesh> tessellated(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                         DiagnosticLog& log);

}  // namespace panwright::geometry
