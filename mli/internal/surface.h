// Developable surfaces through groups of faces.
#pragma once

#include <optional>
#include <span>

#include "mli/internal/groups.h"

namespace panwright::mli {

// A plane, or a cylinder or a cone about an axis, with unrolled coordinates.
struct Surface {
  enum class Kind { plane, cylinder, cone };
  Kind kind = Kind::plane;
  // Right-handed. plane: z its normal, the origin on it. Else z is the axis and x the direction of
  // angle 0; cylinder: the origin on the axis; cone: its apex, which lies at z < 0 of all faces.
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0};
  double outwards = 1;          // −1: the faces look at the axis
  double radius = 0;            // of a cylinder, metres
  double sine = 0, cosine = 1;  // of a cone's half angle
  double begin = 0;      // radians at which the unrolled surface starts: angles count from there
  double narrowest = 0;  // metres from the axis to the nearest vertex; 0 for planes
  bool around = false;   // the faces go all around the axis
  Vec2 low{0}, high{0};  // unrolled bounds of the faces, metres

  double angle(const Vec3& p) const;   // from `begin`, in [0, 2π); 0 for planes
  double across(const Vec3& p) const;  // metres to the axis; 0 for planes
  // Returns unrolled coordinates, metres on surface or facets. turns: added to the angle.
  Vec2 flat(const Vec3& p, double turns = 0) const;
  Vec3 normal(const Vec3& p) const;   // away from the faces, unit
  double above(const Vec3& p) const;  // metres along the normal to the surface: chords lie below it
};

// Fits a surface through a group's vertices, each within `tolerance`; nothing if none fits.
//
// A plane lies along the mean normal, and x along the long side of the smallest rectangle about the
// vertices. The axis of a cylinder is the direction most perpendicular to the facets' normals, its
// radius that of the circle through the vertices (Kåsa, 1976, by least squares); the apex of a cone
// is the place nearest to the planes of all facets. Equal input gives equal bits; a moved one the
// moved surface, to rounding.
std::optional<Surface> surface_through(const Faces& faces, const Group& group, double tolerance);

}  // namespace panwright::mli
