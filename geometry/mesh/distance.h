// How far two meshes are apart, with bounds that hold everywhere.
#pragma once

#include <limits>
#include <memory>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// What is known of a distance: it lies between the two, ends included.
struct DistanceInterval {
  double low = 0;   // metres: at a point that was looked at
  double high = 0;  // metres: no point is further off
};

struct DistanceOptions {
  // Bounds are narrowed until high ≤ (1 + relative) · low or low + absolute, but for rounding.
  double relative = 0.1;
  double absolute = 0;  // metres
  // Nearest points that are looked for at most, for each triangle of both meshes, and 1024 more for
  // each 4096 of them. Where they don't suffice, bounds stay apart.
  double searches = 64;
  // Metres: the distance is of no interest where it is more. low is then any point's that is off so
  // far, high infinite.
  double give_up = std::numeric_limits<double>::infinity();
};

class SurfaceSearch;

// A mesh that is prepared for measuring, which must outlive it.
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
// surface. Triangles without area count as the segments and points that they are; it doesn't matter
// how triangles hang together.
//
// Branch and bound: triangles of each mesh are cut at midpoints and where the triangle of the
// other mesh next to a corner ends, until no piece can be further off than the interval says. A
// piece is at most as far from the other surface as its corners are from any one triangle of it,
// since the distance from a convex set is convex; and at most as far as its corners, plus the
// radius of the circle around it, since the distance is 1-Lipschitz.
//
//   returns  low: right to rounding, 32 ulps of the largest coordinate. high: with those added
//            both infinite where one mesh has no triangles, 0 where neither has
//
// Equal for any number of threads. Under rigid motion both ends stay the same to rounding, but
// where several triangles are equally near: there rounding decides how pieces are cut, and the
// interval may become another one around the same distance. Cost: O((T + searches) log T),
// expected.
DistanceInterval hausdorff_distance(const MeasuredMesh& a, const MeasuredMesh& b,
                                    const DistanceOptions& options = {}, const Job& job = {});

// One side of it: from points of a mesh to the other.
DistanceInterval distance_from(const MeasuredMesh& from, const MeasuredMesh& to,
                               const DistanceOptions& options = {}, const Job& job = {});

// How much the normals of a mesh and of what stands for it differ.
struct NormalError {
  double rms = 0;      // radians, by area
  double largest = 0;  // radians, of what was looked at
};

// Shading normals, of facets where there are none: in the middle of the mesh's triangles (of 32768
// spread evenly, where there are more) against those of the other one at the nearest point of the
// facets within `reach` (metres) that look to the same side, for the two sides of a sheet are near
// each other; at the nearest of all where there is none.
NormalError normal_error(const MeasuredMesh& mesh, const MeasuredMesh& other, double reach,
                         const Job& job = {});

// The largest difference that the projected areas of two meshes have, over 64 directions spread
// over the half sphere, as a share of the first one's largest. Projected area counts every surface
// that a line meets, halved: of a closed convex mesh it is that of the silhouette, of others more.
double projected_area_error(const Mesh& mesh, const Mesh& other, const Job& job = {});

}  // namespace panwright::geometry
