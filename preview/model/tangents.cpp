#include "preview/model/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/math.h"

namespace panwright::preview {
namespace {

Vec3 vec3(const pan::layout::Float3& v) { return Vec3(v.x, v.y, v.z); }
Vec2 vec2(const pan::layout::Float2& v) { return Vec2(v.x, v.y); }

Vec3 unit_or_zero(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0)) return Vec3(0);
  const Vec3 scaled = v / largest;
  return scaled / glm::length(scaled);
}

// The vertices that share a tangent: one number for each vertex.
std::vector<std::uint32_t> groups(const pan::MeshView& mesh) {
  using Key = std::array<double, 8>;
  const auto key = [&](std::uint32_t i) {
    const Vec3 p = vec3(mesh.positions[i]);
    const Vec3 n = vec3(mesh.normals[i]);
    const Vec2 t = vec2(mesh.texcoords[i]);
    return Key{p.x, p.y, p.z, n.x, n.y, n.z, t.x - std::floor(t.x), t.y - std::floor(t.y)};
  };
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key first = key(a);
    const Key second = key(b);
    return first != second ? first < second : a < b;
  });
  std::vector<std::uint32_t> group(order.size());
  for (std::size_t i = 1; i < order.size(); ++i)
    group[order[i]] = group[order[i - 1]] + (key(order[i]) != key(order[i - 1]));
  return group;
}

// The direction in which u grows over a triangle, and how its texture lies.
struct Direction {
  Vec3 along{0};     // unit; 0: none
  int mirrored = 0;  // 0 or 1
};

Direction direction(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& t) {
  const Vec2 t1 = t[1] - t[0];
  const Vec2 t2 = t[2] - t[0];
  const double area = t1.x * t2.y - t2.x * t1.y;
  if (area == 0) return {};
  const Vec3 along = (p[1] - p[0]) * t2.y - (p[2] - p[0]) * t1.y;
  return {unit_or_zero(area > 0 ? along : -along), area < 0};
}

Vec3 any_in_plane(const Vec3& normal) {
  const Vec3 n = glm::abs(normal);
  const Vec3 axis = n.x <= n.y && n.x <= n.z ? Vec3(1, 0, 0)
                    : n.y <= n.z             ? Vec3(0, 1, 0)
                                             : Vec3(0, 0, 1);
  return unit_or_zero(axis - normal * glm::dot(axis, normal));
}

}  // namespace

Tangents tangents(const pan::MeshView& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  const std::vector<std::uint32_t> group = groups(mesh);
  std::array<std::vector<Vec3>, 2> sums;  // by Direction::mirrored
  for (auto& sum : sums) sum.resize(count);
  std::array<std::vector<bool>, 2> used{std::vector<bool>(count), std::vector<bool>(count)};
  std::vector<char> mirrored(mesh.indices.size() / 3, -1);
  for (std::size_t triangle = 0; triangle < mirrored.size(); ++triangle) {
    std::array<std::uint32_t, 3> index;
    std::array<Vec3, 3> p;
    std::array<Vec2, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      index[k] = mesh.indices[3 * triangle + k];
      p[k] = vec3(mesh.positions[index[k]]);
      t[k] = vec2(mesh.texcoords[index[k]]);
    }
    const Direction here = direction(p, t);
    if (here.along == Vec3(0)) continue;
    mirrored[triangle] = static_cast<char>(here.mirrored);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 normal = vec3(mesh.normals[index[k]]);
      const Vec3 along = unit_or_zero(here.along - normal * glm::dot(here.along, normal));
      const Vec3 next = unit_or_zero(p[(k + 1) % 3] - p[k]);
      const Vec3 last = unit_or_zero(p[(k + 2) % 3] - p[k]);
      const double angle = det::atan2(glm::length(glm::cross(next, last)), glm::dot(next, last));
      const auto side = static_cast<std::size_t>(here.mirrored);
      sums[side][group[index[k]]] += angle * along;
      used[side][index[k]] = true;
    }
  }

  Tangents result;
  const auto add = [&](std::uint32_t vertex, std::size_t side) {
    const Vec3 normal = vec3(mesh.normals[vertex]);
    Vec3 along = unit_or_zero(sums[side][group[vertex]]);
    if (along == Vec3(0)) along = any_in_plane(normal);
    for (int k = 0; k < 3; ++k) result.tangents.push_back(static_cast<float>(along[k]));
    result.tangents.push_back(side == 1 ? -1.0f : 1.0f);
  };
  for (std::uint32_t i = 0; i < count; ++i) add(i, used[1][i] && !used[0][i] ? 1 : 0);
  std::vector<std::uint32_t> repeat_of(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    repeat_of[i] = i;
    if (!used[0][i] || !used[1][i]) continue;
    repeat_of[i] = count + static_cast<std::uint32_t>(result.repeats.size());
    result.repeats.push_back(i);
    add(i, 1);
  }
  if (result.repeats.empty()) return result;
  result.indices.resize(mesh.indices.size());
  for (std::size_t i = 0; i < result.indices.size(); ++i) {
    const std::uint32_t index = mesh.indices[i];
    result.indices[i] = mirrored[i / 3] == 1 ? repeat_of[index] : index;
  }
  return result;
}

}  // namespace panwright::preview
