// Spheres and ellipsoids as rings of vertices, those of one ring between those of the next.
//
// Vertices stand on a larger ellipsoid, of radii r + o, which lies outside by up to o, since
// |(r + o)·n| ≤ |r·n| + o. On the unit sphere, of which the larger one is an affine image, a facet
// has a plane of unit normal m and distance d from the centre; the larger one's tangent plane there
// has the distance h = 1/|m/(r + o)|, the parallel one of the shape h·|m·r/(r + o)|, so that the
// facet lies inside by h·(|m·r/(r + o)| − d) at most.
// Equilateral facets are the fewest: rings of equal counts stand half a step apart, and counts fall
// towards the poles where facets have become too slim.
#pragma once

#include <optional>
#include <vector>

#include "base/math.h"
#include "geometry/mesh.h"
#include "geometry/tessellate/internal/steps.h"

namespace panwright::geometry::internal {

struct StaggeredRing {
  det::SinCos latitude;
  std::uint32_t steps;  // about the axis
  bool shifted;         // vertices half a step on
};

struct Staggered {
  std::vector<StaggeredRing> rings;  // from south to north, without poles
  double out = 0;                    // what vertices' radii have more than the shape
  double depth = 0;                  // facets lie no deeper inside: about as much
  double triangles = 0, vertices = 0;
};

// About the fewest triangles for which the mesh misses the shape by no more than `error`, both
// ways; for uneven steps about the axis it does by a little. With texture coordinates a vertex
// stands on the first meridian in each ring, and rings near the poles have at least 0.7 times the
// steps of the equator, so that textures stay in place.
//
//   radii    along x, y and the polar axis z
//   around   of the ellipse in x and y
//   returns  nothing where more triangles than `most` are needed
//
// Cost: O(rings), 0.1 ms for 10 rings.
std::optional<Staggered> staggered(const Vec3& radii, const Steps& around, double error,
                                   bool texcoords, double most);

// How a staggered unit sphere becomes a shape.
struct StaggeredPlace {
  Vec3 radii;                  // along x, y and the polar axis
  double out = 0;              // how far vertices stand out along the normal
  int polar_axis = 2;          // 0 to 2: the axes take turns
  det::SinCos begin = {0, 1};  // of the first meridian, about the polar axis
};

// Poles first and last, rings from south to north, eastward in each; texture coordinates by the
// angles of the unit sphere. Closed, without error.
//
// Expects: fewer than 2^32 triangles and vertices. Cost: O(triangles).
Mesh staggered_mesh(const Staggered& plan, const StaggeredPlace& place, const Steps& around,
                    bool texcoords);

}  // namespace panwright::geometry::internal
