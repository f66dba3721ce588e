#include "preview/reference/internal/tangents.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

namespace panwright::preview::reference {
namespace {

Vec3 vector3(const pan::layout::Float3& v) { return Vec3(v.x, v.y, v.z); }
Vec2 vector2(const pan::layout::Float2& v) { return Vec2(v.x, v.y); }

Vec3 unit_or_zero(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0)) return Vec3(0);
  const Vec3 scaled = v / largest;
  return scaled / glm::length(scaled);
}

Vec3 in_plane(const Vec3& v, const Vec3& normal) { return v - normal * glm::dot(v, normal); }

Vec3 any_in_plane(const Vec3& normal) {
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::fabs(normal[axis]) < std::fabs(normal[least])) least = axis;
  Vec3 axis(0);
  axis[least] = 1;
  return unit_or_zero(in_plane(axis, normal));
}

// What corners must have in common to share a tangent: place, normal, texel, and handedness.
struct Key {
  std::array<double, 9> value;
  bool operator==(const Key&) const = default;
};
struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t hash = 0;
    for (const double v : key.value) {
      // 0 is −0
      hash ^= std::bit_cast<std::uint64_t>(v == 0 ? 0.0 : v);
      hash *= 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
  }
};

}  // namespace

TangentField::TangentField(const pan::MeshView& mesh) {
  const std::size_t triangles = mesh.indices.size() / 3;
  std::unordered_map<Key, std::uint32_t, KeyHash> groups;
  std::vector<Vec3> normals;  // of the groups
  const auto group = [&](std::uint32_t vertex, double handed) {
    const Vec3 p = vector3(mesh.positions[vertex]);
    const Vec3 n = vector3(mesh.normals[vertex]);
    const Vec2 t = vector2(mesh.texcoords[vertex]);
    const Key key{
        {p.x, p.y, p.z, n.x, n.y, n.z, t.x - std::floor(t.x), t.y - std::floor(t.y), handed}};
    const auto [found, is_new] =
        groups.try_emplace(key, static_cast<std::uint32_t>(tangents_.size()));
    if (is_new) {
      tangents_.emplace_back(0);
      normals.push_back(n);
    }
    return found->second;
  };
  corners_.resize(triangles);
  handed_.assign(triangles, 1);
  std::vector<std::uint32_t> without_area;
  for (std::uint32_t triangle = 0; triangle < triangles; ++triangle) {
    std::array<std::uint32_t, 3> vertex;
    std::array<Vec3, 3> p;
    std::array<Vec2, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      vertex[k] = mesh.indices[3 * std::size_t{triangle} + k];
      p[k] = vector3(mesh.positions[vertex[k]]);
      t[k] = vector2(mesh.texcoords[vertex[k]]);
    }
    // the columns of (b−a, c−a)·inverse(tb−ta, tc−ta) are the directions of u and v
    const glm::dmat2 texture(t[1] - t[0], t[2] - t[0]);
    const double area = glm::determinant(texture);
    if (area < 0) handed_[triangle] = -1;
    for (std::size_t k = 0; k < 3; ++k) corners_[triangle][k] = group(vertex[k], handed_[triangle]);
    if (area == 0) without_area.push_back(triangle);
    if (area == 0) continue;
    // its adjugate's first column, so that nothing overflows
    const Vec3 along = unit_or_zero(std::copysign(1.0, area) *
                                    ((p[1] - p[0]) * texture[1].y - (p[2] - p[0]) * texture[0].y));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 next = unit_or_zero(p[(k + 1) % 3] - p[k]);
      const Vec3 last = unit_or_zero(p[(k + 2) % 3] - p[k]);
      const std::uint32_t at = corners_[triangle][k];
      tangents_[at] += angle_between(next, last) * unit_or_zero(in_plane(along, normals[at]));
    }
  }
  // what has no direction of its own takes that of its neighbours, whichever way round they are
  for (const std::uint32_t triangle : without_area)
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& at = corners_[triangle][k];
      if (tangents_[at] != Vec3(0)) continue;
      at = group(mesh.indices[3 * std::size_t{triangle} + k], -1);
      if (tangents_[at] != Vec3(0)) handed_[triangle] = -1;
    }
  for (std::size_t i = 0; i < tangents_.size(); ++i) {
    tangents_[i] = unit_or_zero(tangents_[i]);
    if (tangents_[i] == Vec3(0)) tangents_[i] = any_in_plane(normals[i]);
  }
}

TangentField::At TangentField::operator()(std::uint32_t triangle, const Vec3& weight) const {
  At result;
  for (std::size_t k = 0; k < 3; ++k)
    result.tangent += weight[static_cast<int>(k)] * tangents_[corners_[triangle][k]];
  result.handed = handed_[triangle];
  return result;
}

}  // namespace panwright::preview::reference
