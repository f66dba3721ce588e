#include "importers/vrml/internal/primitives.h"

#include <algorithm>

namespace panwright::importers::vrml {

namespace {

// Boxes: x → x, y → −z, z → y. Surfaces of revolution: x → −z, y → −x, z → y.
const Mat4 kUpright{Vec4(1, 0, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 0, 1)};
const Mat4 kRound{Vec4(0, 0, -1, 0), Vec4(-1, 0, 0, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 0, 1)};

geometry::Counts counts_of(std::uint32_t segments) {
  return {segments > 0 ? std::max(3u, segments) : 0, 0};
}

}  // namespace

Primitive box_of(const Vec3& size, bool textured) {
  geometry::Box box;
  box.size = textured ? Vec3(size.x, size.z, size.y) : size;
  return {box, textured ? kUpright : Mat4(1)};
}

std::optional<Primitive> sheet_of(const Vec3& size) {
  if (glm::any(glm::lessThan(size, Vec3(0)))) return std::nullopt;
  // along the other two, as on the right, top and front of the box
  if (size.x == 0 && size.y > 0 && size.z > 0) {
    const Mat4 right{Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(1, 0, 0, 0), Vec4(0, 0, 0, 1)};
    return Primitive{geometry::Plane{size.z, size.y}, right};
  }
  if (size.y == 0 && size.x > 0 && size.z > 0)
    return Primitive{geometry::Plane{size.x, size.z}, kUpright};
  if (size.z == 0 && size.x > 0 && size.y > 0)
    return Primitive{geometry::Plane{size.x, size.y}, Mat4(1)};
  return std::nullopt;
}

Primitive sphere_of(double radius, std::uint32_t segments) {
  geometry::Sphere sphere;
  sphere.radius = radius;
  if (segments > 0)
    sphere.counts = geometry::SphereCounts{std::max(2u, segments / 2), std::max(3u, segments)};
  return {sphere, kRound};
}

Primitive cylinder_of(double radius, double height, geometry::Caps caps, std::uint32_t segments) {
  return {geometry::Cylinder{radius, height, caps, {}, counts_of(segments)}, kRound};
}

Primitive cone_of(double radius, double height, geometry::Caps caps, std::uint32_t segments) {
  return {geometry::Cone{radius, 0, height, caps, {}, counts_of(segments)}, kRound};
}

Primitive disc_of(double radius, double y, bool up, std::uint32_t segments) {
  Mat4 turned = kRound;
  if (!up) {
    turned[1] = -turned[1];
    turned[2] = -turned[2];
  }
  turned[3] = Vec4(0, y, 0, 1);
  return {geometry::Disc{radius, 0, {}, counts_of(segments)}, turned};
}

}  // namespace panwright::importers::vrml
