#include "trace/mesh_point.h"

#include <algorithm>
#include <cmath>

namespace panwright::trace {
namespace {

Vec3 in_double(const pan::layout::Float3& v) { return Vec3(v.x, v.y, v.z); }
Vec2 in_double(const pan::layout::Float2& v) { return Vec2(v.x, v.y); }

}  // namespace

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double square = glm::dot(v, v);
  // neither under- nor overflow
  if (square > 1e-200 && square < 1e200) return v * (1 / std::sqrt(square));
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return otherwise;
  const Vec3 scaled = v / largest;
  return scaled / glm::length(scaled);
}

Place place_of(const pan::MeshView& mesh, std::uint32_t triangle, const Vec2& barycentric) {
  Place result;
  for (std::size_t k = 0; k < 3; ++k)
    result.corner[k] = mesh.indices[std::size_t{3} * triangle + k];
  result.weight = Vec3(1 - barycentric.x - barycentric.y, barycentric);
  return result;
}

MeshPoint point_of(const pan::MeshView& mesh, const Place& place, bool flat) {
  std::array<Vec3, 3> corner;
  Vec3 smooth(0);
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = in_double(mesh.positions[place.corner[k]]);
    smooth += place.weight[static_cast<int>(k)] * in_double(mesh.normals[place.corner[k]]);
  }
  const Vec3 ab = corner[1] - corner[0];
  const Vec3 ac = corner[2] - corner[0];
  MeshPoint result;
  result.position = corner[0] + place.weight.y * ab + place.weight.z * ac;
  result.facet = unit_or(glm::cross(ab, ac), Vec3(0, 0, 1));
  result.smooth = flat ? result.facet : smooth;
  return result;
}

Vec2 texcoord_of(const pan::MeshView& mesh, const Place& place) {
  Vec2 at(0);
  for (int k = 0; k < 3; ++k)
    at += place.weight[k] * in_double(mesh.texcoords[place.corner[static_cast<std::size_t>(k)]]);
  return at;
}

}  // namespace panwright::trace
