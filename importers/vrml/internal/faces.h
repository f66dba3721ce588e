// Meshes from the faces of VRML nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "geometry/mesh.h"

namespace panwright::importers::vrml {

// List of a node with faces.
enum class List : std::uint8_t {
  none,  // the node as a whole
  points,
  coord_index,
  normals,
  normal_index,
  colors,
  color_index,
  texcoords,
  texcoord_index,
  heights,
  spine,
  cross_section,
  scales,
  orientations,
};

// Problem of a list, once for each kind; the message gives the count.
struct ListProblem {
  Code code;  // E6002, E6107, E6113, W6114
  List list = List::none;
  std::size_t item = 0;  // of the list: the first invalid one; texcoords, points: of whole vectors
  std::string message;   // one lower-case sentence
};
using ListProblems = std::vector<ListProblem>;

// Options not given by the file.
struct FaceOptions {
  double crease_angle = 0;                   // radians, if the node gives none
  std::uint64_t max_triangles = 1ull << 27;  // of the mesh
  std::uint64_t max_memory = 8ull << 30;     // bytes, during construction
  bool texcoords = false;                    // made if the node has none
  std::function<void(List)> served =
      {};  // called when points and coord_index of a face set are no longer needed
};

// IndexedFaceSet of either version of VRML. Lists are as in the file; an empty index list has the
// standard's meaning: the coordinates' own, or one per face in order.
struct FaceSet {
  std::span<const double> points;              // 3*P
  std::span<const std::int32_t> coord_index;   // below 0 ends a face
  std::span<const double> normals;             // 3*N, any length; empty: none
  std::span<const std::int32_t> normal_index;  // like coord_index, or one per face
  bool normal_per_vertex = true;
  std::span<const double> colors;             // 3*C, linear RGB; empty: none
  std::span<const std::int32_t> color_index;  // like coord_index, or one per face
  bool color_per_vertex = true;
  std::span<const double> texcoords;             // 2*T, (0,0) the image's bottom left; empty: none
  std::span<const std::int32_t> texcoord_index;  // like coord_index
  bool ccw = true;
  bool convex = true;  // ignored
  std::optional<double> crease_angle;
};

// Makes the mesh of a face set: n − 2 triangles for each face of n corners, in order of the faces,
// also those without area; see geometry/tessellate/polygon.h. Vertices are distinct (coordinate,
// normal, colour, texcoord), in order of first use; without unused ones.
//
//   returns  colours replace the material's diffuse colour; always normals: the file's, else by
//            crease angle (geometry::compute_normals). closed and error are not set. Faces with
//            invalid indices are left out; lists of normals, colours or texcoords with some are
//            dropped as a whole. No triangles: nothing visible, or E6002.
//
// Reports E6002, E6107, E6113, W6114. Cost: O(corners), and that of the polygons and normals.
geometry::Mesh mesh_of(const FaceSet& faces, const FaceOptions& options, ListProblems& problems);

// Heights over the plane y = 0. Quadrilaterals face up (+y) if ccw is true.
struct ElevationGrid {
  std::int32_t x_dimension = 0;
  std::int32_t z_dimension = 0;
  double x_spacing = 1;
  double z_spacing = 1;
  std::span<const double> heights;  // x_dimension*z_dimension, x runs first
  std::span<const double> normals;  // 3*N; empty: none
  bool normal_per_vertex = true;
  std::span<const double> colors;  // 3*C; empty: none
  bool color_per_vertex = true;
  std::span<const double> texcoords;  // 2*T; empty: none
  bool ccw = true;
  std::optional<double> crease_angle;
};

// As for face sets: two triangles for each quadrilateral.
geometry::Mesh mesh_of(const ElevationGrid& grid, const FaceOptions& options,
                       ListProblems& problems);

// Cross-section swept along a spine.
struct Extrusion {
  std::span<const double> cross_section;  // 2*S, x and z
  std::span<const double> spine;          // 3*P
  std::span<const double> scales;         // 2*(1 or P)
  std::span<const double> orientations;   // 4*(1 or P), axis and angle
  bool begin_cap = true;
  bool end_cap = true;
  bool ccw = true;
  bool convex = true;  // ignored
  std::optional<double> crease_angle;
};

// As for face sets: two triangles for each of (S − 1)(P − 1) quadrilaterals, then the begin cap,
// then the end cap; a closed spine has none.
geometry::Mesh mesh_of(const Extrusion& extrusion, const FaceOptions& options,
                       ListProblems& problems);

}  // namespace panwright::importers::vrml
