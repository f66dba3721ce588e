// Cylinders, cones, tori and circles through vertices, by least squares.
#pragma once

#include <optional>
#include <span>

#include "geometry/mesh/face_groups.h"
#include "geometry/mesh/revolution_axes.h"

namespace panwright::geometry {

// Fitted surface, in the frame of the faces.
struct RevolvedFit {
  RevolvedKind kind = RevolvedKind::cylinder;
  Vec3 origin{0};      // on the axis; of a torus its middle
  Vec3 axis{0, 0, 1};  // unit
  double radius = 0;   // of a cone at the origin
  double slope = 0;    // of a cone: of the radius along the axis
  double tube = 0;     // of a torus: radius of its tube
  double low = 0;      // of the vertices along the axis
  double high = 0;
  double widest = 0;      // reported radius
  double turn = 2 * kPi;  // radians spanned by normals
  double area = 0;
  double residual = 0;  // root mean square

  // Returns the signed distance from the surface.
  double off(const Vec3& p) const;
  // Returns the surface's unit normal away from the axis (from the tube's middle) nearest to p; 0
  // there.
  Vec3 normal(const Vec3& p) const;
};

// Returns the direction most perpendicular to the normals.
Vec3 axis_across(const Faces& faces, const FaceGroup& group);

// Returns the cylinder of an axis with the best-fitting circle through a group's vertices (Kåsa,
// 1976).
std::optional<RevolvedFit> cylinder_about(const Vec3& axis, const Faces& faces,
                                          const FaceGroup& group);

// Acceptance limits of a fit.
struct FitLimits {
  double off = 5e-3;           // of the radius: of any vertex
  std::size_t directions = 3;  // of normals about the axis
};
// for a part of a group not delimited by its neighbours: four corners always lie on a circle
inline constexpr FitLimits kPartLimits{1e-3, 5};

// Fits a surface through all faces of a group; nothing if none fits.
std::optional<RevolvedFit> fitted(RevolvedKind kind, const Faces& faces, const FaceGroup& group,
                                  const FitLimits& limits = {});

bool is_sphere(const Faces& faces, const FaceGroup& group);

// Fits the circle through all vertices of a loop; nothing if none fits.
std::optional<RevolvedFit> circle_through(const Faces& faces, std::span<const std::uint32_t> loop);

}  // namespace panwright::geometry
