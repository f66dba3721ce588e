// Triangles for exact shapes.
#pragma once

#include <span>

#include "base/diagnostic.h"
#include "base/result.h"
#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace panwright::geometry {

// Single precision holds coordinates up to this; beyond it products of them overflow.
inline constexpr double kMaxCoordinate = 1e30;  // metres
// A sphere smaller than this loses its shape to single precision's smallest numbers.
inline constexpr double kMinRadius = 1e-30;  // metres

struct TessellationOptions {
  double max_error = 1e-3;  // metres, > 0; used where the shape has no explicit counts
  bool texcoords = false;   // makes uv coordinates, with a seam and split poles
  std::uint64_t max_triangles = 1ull << 27;
};

// Triangulates a shape. Explicit counts are obeyed exactly, with vertices on the shape; otherwise
// the mesh has the fewest triangles for which none of its points lies further than max_error from
// the shape, and vertices lie outside by as much as facets dip inside.
//
//   returns  closed where the shape is closed (texture seams aside); analytic unit normals;
//            error: the largest distance between a point of the mesh and the shape, metres,
//            measured on the vertices as float32 would store them about the mesh's own origin
//
// Sphere: vertices run from the south pole, ring by ring, eastward from +x. Without texcoords each
// place is one vertex. With them the meridian at +x stands twice (u = 0 and 1) and each pole once
// for each triangle; u = longitude/2π eastward from +x, v = 0 at the south pole, 1 at the north.
// A MeshShape is returned as it is, with its error of rounding to float32.
//
// Fails: E2003 before anything is allocated; E2010 for a radius outside [kMinRadius,
// kMaxCoordinate] or a coordinate beyond ±kMaxCoordinate.
// Cost: O(triangles).
Result<Mesh> tessellated(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                         DiagnosticLog& log);

// What tessellated() asks of an authored mesh, for callers that need no copy of it.
//
// Fails: E2003, E2010.
bool within_limits(const Mesh& mesh, const TessellationOptions& options, SourceSpan where,
                   DiagnosticLog& log);

// The fewest rings and quads that keep a balanced sphere of radius 1 within an error, > 0, in
// exact arithmetic. Counts saturate at 2^31.
SphereCounts sphere_counts(double max_error);

// The largest distance between a point of the mesh and the sphere about the mesh's origin,
// measured on float32 positions relative to `origin`. Exact to a few ulps of the radius.
// Cost: O(V + T). Expects: indices in range.
double sphere_error(const Mesh& mesh, double radius, const Vec3& origin);

// The largest distance by which float32 positions relative to `origin` miss the given ones. No
// point of a mesh over these positions moves further.
double rounding_error(std::span<const Vec3> positions, const Vec3& origin);

}  // namespace panwright::geometry
