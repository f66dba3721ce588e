// Axes of cylinders, cones and tori in meshes, and of their circular holes.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "geometry/mesh.h"

namespace panwright::geometry {

enum class RevolvedKind : std::uint8_t { cylinder, cone, torus, circle };
std::string_view name_of(RevolvedKind kind);  // "cylinder"…

// Connected faces on one surface of revolution, or a circular hole or border without a wall.
struct RevolvedFaces {
  RevolvedKind kind = RevolvedKind::cylinder;
  Vec3 origin{0};      // on the axis, in the middle of the faces along it, metres
  Vec3 axis{0, 0, 1};  // unit; its largest component is positive
  double low = 0;      // metres from the origin along the axis: range of the faces
  double high = 0;
  double radius = 0;      // metres: of a cone its largest one, of a torus that of the ring
  double turn = 2 * kPi;  // radians spanned by the faces' normals about the axis
  double area = 0;        // m² of the faces, of a circle of its disc
  double residual = 0;    // metres: root mean square distance of the vertices from the surface
};

// Returns true if two share an axis: within 0.5 degrees, and 1 % of the larger radius at the second
// one.
bool share_axis(const RevolvedFaces& a, const RevolvedFaces& b);

// Finds the faces, the largest area first; of equal areas the one whose faces come first. Holes and
// borders count only without faces on such a surface. Spheres have no axis and are ignored.
//
// Faces whose normals differ by at most 50 degrees across their common edge are a group. A first
// guess of the axis comes from the normals: perpendicular to those of a cylinder, at one angle to
// those of a cone, met by the lines along those of a torus (Pottmann and Randrup, "Rotational and
// helical surface approximation for reverse engineering", Computing 60, 1998). Gauss-Newton steps
// then minimise the distances of the vertices, which lie on the surface however coarse the facets.
// If a whole group is none of these, as with a fillet, cylinders are grown inside it from
// neighbouring faces. They extend over faces with normals perpendicular to their axis. A surface is
// accepted if vertices are within 0.5 % of the radius and normals within 32 degrees. Normals must
// span 40 degrees in three directions at least: of a cylinder of 8 sides, of a quarter of one. Of
// grown parts it is 0.1 % and five directions. A circle needs 6 vertices.
//
// Of exact vertices axes are within 1e-9 rad and 1e-9 of the size. A moved, turned, mirrored or
// scaled mesh gives the moved axis, to rounding. Equal input gives equal bits.
//
// Expects: finite positions, indices in range. Cost: O(T log T), for each of up to 64 guesses in a
// group that is none O(its faces).
std::vector<RevolvedFaces> revolved_faces(const Mesh& mesh);

}  // namespace panwright::geometry
