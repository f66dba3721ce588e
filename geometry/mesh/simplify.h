// Simplification of meshes.
#pragma once

#include <cstdint>
#include <memory>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Simplifier of a mesh in steps, each from the one before. Vertices are some of the mesh's,
// unmoved, with their texture coordinates and colours; of the normals at a position, the nearest to
// the facet's. Triangles stay connected by position: a seam of texture coordinates or colours moves
// as one.
//
// Edges collapse by the sum of squared distances from planes (Garland, Heckbert, "Surface
// simplification using quadric error metrics", 1997): meshopt_simplify. Its measure of error is no
// bound (hausdorff_distance() is). It works in single precision on coordinates about the centre of
// the bounds, divided by their largest side: its result may change with its version and under
// rotation.
class Simplifier {
 public:
  // lock_border  edges of one triangle stay as they are, for a neighbouring mesh
  // Expects: indices in range, finite numbers within ±1e100, 3*T < 2^32. The mesh must outlive it.
  Simplifier(const Mesh& mesh, bool lock_border);
  ~Simplifier();
  Simplifier(Simplifier&&) noexcept;
  Simplifier& operator=(Simplifier&&) noexcept;

  // Returns the number of triangles left; at first those with distinct corners.
  std::size_t triangles() const;
  // Returns the largest side of the mesh's bounds, metres.
  double size() const;

  // Collapses edges while there are more triangles than `target`, and each costs up to `error`
  // (metres, by its own measure). Returns the largest cost.
  double step(std::size_t target, double error);

  // Returns the simplified mesh. closed as of check(), error 0. Cost: O(V + T log T) of the whole
  // mesh.
  Mesh mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::geometry
