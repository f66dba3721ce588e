// Triangles for exact shapes.
#pragma once

#include <span>

#include "base/diagnostic.h"
#include "base/result.h"
#include "geometry/mesh.h"
#include "geometry/tessellate/shape.h"

namespace panwright::geometry {

// Largest coordinate, metres; products of larger ones overflow single precision.
inline constexpr double kMaxCoordinate = 1e30;  // metres
// Smallest radius of a sphere, metres; smaller ones lose their shape to single precision's smallest
// numbers.
inline constexpr double kMinRadius = 1e-30;  // metres

struct TessellationOptions {
  double max_error = 1e-3;  // metres, > 0; used without explicit counts
  bool texcoords = false;   // makes uv coordinates; no triangle runs across a seam
  std::uint64_t max_triangles = 1ull << 27;
  // Segments about the axis of circular edges shared with other shapes; 0: none is shared. Shared
  // edges stand on the shape, at the angles begin + i·(end − begin)/segments, and equal ones of two
  // shapes are equal bit for bit. With fewer than segments_of() the mesh's error may exceed
  // max_error.
  std::uint32_t edge_segments = 0;
};

// Triangulates a shape. Explicit counts are obeyed exactly, with vertices on the shape; otherwise
// the mesh has about the fewest triangles within max_error of the shape. Round outlines then keep
// their area: vertices lie outside so that a polygon has the area of its circle (and a sphere's by
// the depth of its facets), unless edge_segments requires shared circular edges.
//
//   returns  closed where the shape is closed (texture seams aside), counter-clockwise seen from
//            outside; analytic unit normals; no degenerate triangles; error: largest distance of
//            the mesh from the shape, metres, after rounding to float32 about the centre of the
//            mesh's bounds; 0 for flat shapes exact in float32. It holds for round outlines both
//            ways. Triangles are degenerate only where the shape is thinner than 1e-7 of its size
//
// Spheres and ellipsoids without explicit counts are staggered rings of vertices, fewer towards the
// poles; ellipsoids without texcoords have their poles on the axis whose rings are the roundest.
// Cones and rings whose ends are unlike may have fewer segments at the smaller one.
//
// Sphere: vertices run from the south pole, ring by ring, eastward from +x or half a step beyond.
// Without texcoords each position is one vertex. With them a vertex of each ring stands on the
// meridian at +x, twice (u = 0 and 1), and each pole once for each triangle; u = longitude/2π
// eastward from +x, v = 0 at the south pole, 1 at the north; textures of spheres move by no more
// than four times max_error between vertices. A MeshShape is returned as it is, with its error of
// rounding to float32.
//
// Expects: no problem_of(shape). Fails: E2003 before anything is allocated, and if float32 cannot
// keep max_error on a curved shape; E2010 for a radius outside [kMinRadius, kMaxCoordinate] or a
// coordinate beyond ±kMaxCoordinate. Cost: O(triangles).
Result<Mesh> tessellated(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                         DiagnosticLog& log);

// Returns the number of triangles of tessellated() without making them: exact for shapes by
// formula, at most a tenth too low for the others.
double planned_triangles(const Shape& shape, const TessellationOptions& options);

// Round edge or end of a shape, at which another shape may stand.
struct CircularEdge {
  Vec3 centre{0};
  Vec3 axis{0};   // unit; the circular edge runs counter-clockwise about it
  Vec3 start{0};  // from the centre to the circular edge's first point: its length is the radius
  double sector = 2 * kPi;
};

// Returns the circular edges of a shape: those of cylinder, cone, disc, dish, lathe, sphere
// sectors, and the ends of tubes. Empty for shapes without, and for those with explicit counts.
std::vector<CircularEdge> circular_edges_of(const Shape& shape);

// Returns the fewest segments about the axis that, as edge_segments, keep max_error on a shape with
// circular edges: a few more than without shared edges, which stand on the shape. 2^31 if no number
// does.
std::uint32_t segments_of(const Shape& shape, const TessellationOptions& options);

// Checks an authored mesh as tessellated() does, without a copy.
//
// Fails: E2003, E2010.
bool within_limits(const Mesh& mesh, const TessellationOptions& options, SourceSpan where,
                   DiagnosticLog& log);

// Returns the largest distance between a point of the mesh and the sphere about the mesh's origin,
// measured on float32 positions relative to `origin`. Exact to a few ulps of the radius. Cost: O(V
// + T). Expects: indices in range.
double sphere_error(const Mesh& mesh, double radius, const Vec3& origin);

// Returns the largest distance between float32 positions relative to `origin` and the given ones.
// No point of a mesh over these positions moves further.
double rounding_error(std::span<const Vec3> positions, const Vec3& origin);

}  // namespace panwright::geometry
