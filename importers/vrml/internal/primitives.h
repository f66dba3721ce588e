// Surfaces of revolution and boxes of both versions, which stand on y, as ours, which stand on z.
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/tessellate/shape.h"

namespace panwright::importers::vrml {

struct Primitive {
  geometry::Shape shape;
  Mat4 theirs_from_shape{1};
};

// textured: rotated, as textures are upright along the z of our boxes.
Primitive box_of(const Vec3& size, bool textured);

// Returns the sheet of a box with one side of 0 and two above: open, and upright as that side of
// the box. Nothing for other boxes.
std::optional<Primitive> sheet_of(const Vec3& size);

// Surfaces of revolution begin their texture at −z (ISO/IEC 14772-1, 6.13, 6.41).
//
//   segments  around the shape; 0: exact
Primitive sphere_of(double radius, std::uint32_t segments);
Primitive cylinder_of(double radius, double height, geometry::Caps caps, std::uint32_t segments);
Primitive cone_of(double radius, double height, geometry::Caps caps, std::uint32_t segments);
// Returns a disc at height y, facing up or down, with the outline of the surfaces of revolution.
Primitive disc_of(double radius, double y, bool up, std::uint32_t segments);

}  // namespace panwright::importers::vrml
