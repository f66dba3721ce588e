// Connected faces of a mesh, for blankets.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::mli {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Chosen triangles over welded vertices; those without area are left out.
struct Faces {
  std::vector<Vec3> points;
  std::vector<geometry::Triangle> triangles;
  std::vector<std::uint32_t> source;                     // indices in the mesh
  std::vector<Vec3> normals;                             // unit
  std::vector<double> areas;                             // m²
  std::vector<std::array<std::uint32_t, 3>> neighbours;  // across the edge from corner k; or kNone
  std::vector<bool> non_manifold;                        // touches an edge that is
  std::size_t without_area = 0;
};

// Expects: finite positions, indices in range, `chosen` ascending.
Faces chosen_faces(const geometry::Mesh& mesh, std::span<const std::uint32_t> chosen, double weld);

using Group = std::vector<std::uint32_t>;  // indices of Faces::triangles, ascending

// Faces of `among` that are connected over edges whose normals' cosine is `least` or more.
std::vector<Group> connected(const Faces& faces, const Group& among, double least);

// The connected flat parts of a group that hold `share` of its area or more.
std::vector<Group> flat_parts(const Faces& faces, const Group& group, double share,
                              double tolerance);

double area_of(const Faces& faces, const Group& group);
double diagonal_of(const Faces& faces, const Group& group);  // of its bounds

}  // namespace panwright::mli
