#include "geometry/mesh/closest.h"

#include <cmath>

#include "geometry/internal/triangle.h"

namespace panwright::geometry {

namespace {

// Shares of the corners in a point of a triangle, each at least 0, their sum 1.
Vec3 barycentric(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 n = glm::cross(b - a, c - a);
  const double squared = glm::dot(n, n);
  if (!(squared > 0)) return {1, 0, 0};
  Vec3 share(glm::dot(glm::cross(b - p, c - p), n), glm::dot(glm::cross(c - p, a - p), n),
             glm::dot(glm::cross(a - p, b - p), n));
  share = glm::max(share, Vec3(0));
  const double sum = share.x + share.y + share.z;
  return sum > 0 ? share / sum : Vec3(1, 0, 0);
}

// zero where it has no direction
Vec3 unit(const Vec3& v) {
  const double length = glm::length(v);
  return length > 1e-9 ? v / length : Vec3(0);
}

Vec3 corner_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = glm::cross(b - a, c - a);
  const double length = glm::length(n);
  return length > 0 ? n / length : Vec3(0, 0, 1);
}

}  // namespace

std::optional<SurfacePoint> closest_point(const Mesh& mesh, const Vec3& point) {
  const Triangle* best = nullptr;
  double best_squared = 0;
  Vec3 best_offset(0);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 offset = nearest_to_origin(
        mesh.positions[t[0]] - point, mesh.positions[t[1]] - point, mesh.positions[t[2]] - point);
    const double squared = glm::dot(offset, offset);
    if (!std::isfinite(squared) || (best && squared >= best_squared)) continue;
    best = &t;
    best_squared = squared;
    best_offset = offset;
  }
  if (!best) return std::nullopt;
  const Triangle& t = *best;
  const Vec3& a = mesh.positions[t[0]];
  const Vec3& b = mesh.positions[t[1]];
  const Vec3& c = mesh.positions[t[2]];
  SurfacePoint result{point + best_offset, Vec3(0), std::sqrt(best_squared)};
  if (!mesh.normals.empty()) {
    const Vec3 share = barycentric(a, b, c, result.position);
    result.normal = unit(share.x * mesh.normals[t[0]] + share.y * mesh.normals[t[1]] +
                         share.z * mesh.normals[t[2]]);
  }
  if (result.normal == Vec3(0)) result.normal = corner_normal(a, b, c);
  return result;
}

Vec3 closest_point(const std::array<Vec3, 3>& triangle, const Vec3& point) {
  return point + nearest_to_origin(triangle[0] - point, triangle[1] - point, triangle[2] - point);
}

}  // namespace panwright::geometry
