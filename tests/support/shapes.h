// Meshes of simple shapes, for models of tests.
#pragma once

#include <cstdint>
#include <utility>

#include "geometry/mesh.h"

namespace panwright::support {

// A rectangle about the origin in z = 0, its normal +z.
inline geometry::Mesh plate(double width, double height) {
  geometry::Mesh mesh;
  const double x = width / 2;
  const double y = height / 2;
  mesh.positions = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// A closed box about the origin with flat normals.
inline geometry::Mesh box(const Vec3& sides) {
  geometry::Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vec3 p(0);
        p[axis] = sign * sides[axis] / 2;
        p[u] = a * sides[u] / 2;
        p[v] = b * sides[v] / 2;
        mesh.positions.push_back(p);
        Vec3 n(0);
        n[axis] = sign;
        mesh.normals.push_back(n);
      }
      if (sign > 0) {
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
      } else {
        mesh.triangles.push_back({first, first + 2, first + 1});
        mesh.triangles.push_back({first, first + 3, first + 2});
      }
    }
  mesh.closed = true;
  return mesh;
}

}  // namespace panwright::support
