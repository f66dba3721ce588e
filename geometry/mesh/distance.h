// Distances of two meshes, with bounds that hold everywhere.
#pragma once

#include <limits>
#include <memory>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// Bounds of a distance, ends included.
struct DistanceInterval {
  double low = 0;   // metres: at a sampled point
  double high = 0;  // metres: no point is further off
};

struct DistanceOptions {
  // Bounds are narrowed until high ≤ (1 + relative) · low or low + absolute, but for rounding.
  double relative = 0.1;
  double absolute = 0;  // metres
  // Limit of nearest-point searches: this many for each triangle of both meshes, and 1024 more for
  // each 4096 of them. Beyond it bounds stay apart.
  double searches = 64;
  // Metres: early exit for larger distances. low is then the distance of some such point, high
  // infinite.
  double give_up = std::numeric_limits<double>::infinity();
};

class SurfaceSearch;

// Mesh prepared for measuring, which must outlive it.
//
// Expects: indices in range, finite positions within ±1e100. Cost: 260 bytes a triangle.
class MeasuredMesh {
 public:
  explicit MeasuredMesh(const Mesh& mesh);
  ~MeasuredMesh();
  MeasuredMesh(MeasuredMesh&&) noexcept;
  MeasuredMesh& operator=(MeasuredMesh&&) noexcept;

  const Mesh& mesh() const;
  const SurfaceSearch& search() const { return *search_; }

 private:
  std::unique_ptr<SurfaceSearch> search_;
};

// The two-sided Hausdorff distance: the largest distance of a point of one surface from the other
// surface. Triangles without area count as segments or points; connectivity does not matter.
//
// Branch and bound: triangles of each mesh are cut until no piece can exceed the interval, at
// midpoints and at the ends of the other mesh's nearby triangles. Two bounds of a piece: its
// corners' distances from any one triangle of the other surface, since the distance from a convex
// set is convex; and its corners' distances plus the radius of its circumcircle, since the distance
// is 1-Lipschitz.
//
//   returns  low: right to rounding, 32 ulps of the largest coordinate. high: with those added both
//            infinite if one mesh has no triangles, 0 if neither has
//
// Equal for any number of threads. Rigid motion keeps both ends to rounding, unless several
// triangles are equally near: then rounding decides the cuts, and the interval may change around
// the same distance. Cost: O((T + searches) log T), expected.
DistanceInterval hausdorff_distance(const MeasuredMesh& a, const MeasuredMesh& b,
                                    const DistanceOptions& options = {}, const Job& job = {});

// Returns the one-sided distance, from points of a mesh to the other.
DistanceInterval distance_from(const MeasuredMesh& from, const MeasuredMesh& to,
                               const DistanceOptions& options = {}, const Job& job = {});

// Difference of the normals of a mesh and of its replacement.
struct NormalError {
  double rms = 0;      // radians, by area
  double largest = 0;  // radians, of the samples
};

// Compares shading normals, or facet normals without them, in the middle of the mesh's triangles
// (of 32768 spread evenly, if there are more). The counterpart is the nearest point within `reach`
// (metres) on facets that look to the same side; else the nearest of all. The two sides of a sheet
// are near each other.
NormalError normal_error(const MeasuredMesh& mesh, const MeasuredMesh& other, double reach,
                         const Job& job = {});

// Returns the largest difference of the projected areas of two meshes, over 64 directions of the
// half sphere, as a share of the first one's largest. Projected area counts every surface along a
// line, halved: the silhouette of a closed convex mesh, more for others.
double projected_area_error(const Mesh& mesh, const Mesh& other, const Job& job = {});

}  // namespace panwright::geometry
