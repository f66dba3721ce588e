#include "compiler/internal/decals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/mesh/closest.h"

namespace panwright::compiler::internal {

namespace {

constexpr double kParallelPlanes = 1e-6;  // radians

// note: divided first, so that squares of very short or long vectors stay numbers
Vec3 unit(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return glm::normalize(v / largest);
}

Vec3 upright(const scene::Decal& decal, const Vec3& normal) {
  for (const auto& up : {decal.up, std::optional(Vec3(0, 0, 1))})
    if (up && glm::length(glm::cross(unit(*up), normal)) > kParallelPlanes) return unit(*up);
  return {0, 1, 0};
}

Quat rotation_to(const Vec3& x, const Vec3& y, const Vec3& z) {
  Quat q = glm::normalize(glm::quat_cast(Mat3(x, y, z)));
  return q.w < 0 ? -q : q;
}

// Whether a triangle meets the cube of half side 1 about the origin.
bool meets_cube(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto apart = [&](const Vec3& axis) {
    const double pa = glm::dot(a, axis), pb = glm::dot(b, axis), pc = glm::dot(c, axis);
    const double reach = std::fabs(axis.x) + std::fabs(axis.y) + std::fabs(axis.z);
    return std::min({pa, pb, pc}) > reach || std::max({pa, pb, pc}) < -reach;
  };
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3& axis : axes)
    if (apart(axis)) return false;
  const Vec3 sides[] = {b - a, c - b, a - c};
  if (apart(glm::cross(sides[0], sides[1]))) return false;
  for (const Vec3& side : sides)
    for (const Vec3& axis : axes)
      if (apart(glm::cross(axis, side))) return false;
  return true;
}

}  // namespace

bool shows(const pan::DecalContent& decal, const geometry::Mesh& mesh) {
  const Quat decal_from_mesh = glm::conjugate(decal.rotation);
  const Vec3 outwards = decal.rotation * Vec3(0, 0, 1);
  const Vec3 half(0.5 * decal.width, 0.5 * decal.height, decal.depth);
  const auto in_box = [&](std::uint32_t vertex) {
    return (decal_from_mesh * (mesh.positions[vertex] - decal.origin)) / half;
  };
  for (const geometry::Triangle& t : mesh.triangles) {
    bool faces = mesh.normals.empty();
    for (const std::uint32_t vertex : t) {
      if (faces) break;
      const double facing = glm::dot(mesh.normals[vertex], outwards);
      faces = facing > 0 || (!mesh.closed && facing < 0);
    }
    if (faces && meets_cube(in_box(t[0]), in_box(t[1]), in_box(t[2]))) return true;
  }
  return false;
}

std::optional<pan::DecalContent> placed(const scene::Decal& decal, const geometry::Mesh& mesh) {
  const auto point = geometry::closest_point(mesh, decal.at);
  if (!point) return std::nullopt;
  const Vec3 z = unit(decal.normal ? *decal.normal : point->normal);
  const Vec3 x = unit(glm::cross(upright(decal, z), z));
  pan::DecalContent out;
  out.name = decal.name;
  out.texture = static_cast<std::uint32_t>(decal.texture);
  out.origin = point->position;
  out.rotation = rotation_to(x, glm::cross(z, x), z);
  out.width = decal.width;
  out.height = decal.height;
  out.depth =
      std::max(0.5 * std::max(decal.width, decal.height), std::numeric_limits<double>::min());
  return out;
}

}  // namespace panwright::compiler::internal
