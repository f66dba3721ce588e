// Staggered spheres and ellipsoids: rings of vertices, each half a step from the next.
//
// Vertices stand on a larger ellipsoid, of radii r + o, which lies outside by up to o, since |(r +
// o)·n| ≤ |r·n| + o. The larger one is an affine image of the unit sphere. There a facet has a
// plane of unit normal m and distance d from the centre; its tangent plane there has the distance h
// = 1/|m/(r + o)|, the parallel one of the shape h·|m·r/(r + o)|. The facet lies inside by
// h·(|m·r/(r + o)| − d) at most. Equilateral facets are the fewest: rings of equal counts stand
// half a step apart, and counts fall towards the poles where facets would be too slim.
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
  bool shifted;         // offset by half a step
};

struct Staggered {
  std::vector<StaggeredRing> rings;  // from south to north, without poles
  double out = 0;                    // excess of vertices' radii over the shape's
  double depth = 0;                  // approximate largest depth of facets inside
  double triangles = 0, vertices = 0;
};

// Plans about the fewest triangles within `error` of the shape, both ways; uneven steps about the
// axis exceed it by a little. With texture coordinates a vertex stands on the first meridian in
// each ring. Rings near the poles then have at least 0.7 times the steps of the equator.
//
//   radii    along x, y and the polar axis z
//   around   of the ellipse in x and y
//   returns  nothing if more triangles than `most` are needed
//
// Cost: O(rings), 0.1 ms for 10 rings.
std::optional<Staggered> staggered(const Vec3& radii, const Steps& around, double error,
                                   bool texcoords, double most);

// Placement of a staggered unit sphere.
struct StaggeredPlace {
  Vec3 radii;                  // along x, y and the polar axis
  double out = 0;              // offset of vertices along the normal
  int polar_axis = 2;          // 0 to 2: the axes take turns
  det::SinCos begin = {0, 1};  // of the first meridian, about the polar axis
};

// Builds the mesh: poles first and last, rings from south to north, eastward in each; texture
// coordinates by the angles of the unit sphere. Closed, without error.
//
// Expects: fewer than 2^32 triangles and vertices. Cost: O(triangles).
Mesh staggered_mesh(const Staggered& plan, const StaggeredPlace& place, const Steps& around,
                    bool texcoords);

}  // namespace panwright::geometry::internal
