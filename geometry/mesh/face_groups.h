// Connected faces of a mesh over welded vertices, in groups.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

inline constexpr std::uint32_t kNoNeighbour = std::numeric_limits<std::uint32_t>::max();

// Chosen triangles over welded vertices; those without area are left out.
struct Faces {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> source;  // indices in the mesh
  std::vector<Vec3> normals;          // unit
  std::vector<double> areas;          // m²
  std::vector<std::array<std::uint32_t, 3>>
      neighbours;                  // across the edge from corner k; or kNoNeighbour
  std::vector<bool> non_manifold;  // touches a non-manifold edge
  std::size_t without_area = 0;
};

//   weld    metres within which vertices are welded; 0: 1e-6 of the diagonal of the chosen
//           triangles
//
// Expects: finite positions, indices in range, `chosen` ascending and not empty. Cost: O(T log T).
Faces chosen_faces(const Mesh& mesh, std::span<const std::uint32_t> chosen, double weld);

using FaceGroup = std::vector<std::uint32_t>;  // indices of Faces::triangles, ascending

// Returns faces of `among` connected over edges whose normals' cosine is `least` or more.
std::vector<FaceGroup> connected(const Faces& faces, const FaceGroup& among, double least);

// Returns the connected flat parts of a group with `share` of its area or more.
std::vector<FaceGroup> flat_parts(const Faces& faces, const FaceGroup& group, double share,
                                  double tolerance);

double area_of(const Faces& faces, const FaceGroup& group);
double diagonal_of(const Faces& faces, const FaceGroup& group);  // of its bounds

}  // namespace panwright::geometry
