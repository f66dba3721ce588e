#include "compiler/internal/decals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/closest.h"

namespace panwright::compiler::internal {

namespace {

constexpr double kParallel = 1e-6;  // radians

// note: divided first, so that squares of very short or long vectors stay numbers
Vec3 unit(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return glm::normalize(v / largest);
}

Vec3 upright(const scene::Decal& decal, const Vec3& normal) {
  for (const auto& up : {decal.up, std::optional(Vec3(0, 0, 1))})
    if (up && glm::length(glm::cross(unit(*up), normal)) > kParallel) return unit(*up);
  return {0, 1, 0};
}

Quat rotation_to(const Vec3& x, const Vec3& y, const Vec3& z) {
  Quat q = glm::normalize(glm::quat_cast(Mat3(x, y, z)));
  return q.w < 0 ? -q : q;
}

}  // namespace

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
