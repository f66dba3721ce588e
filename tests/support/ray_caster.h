// Ray caster over placed meshes, with normals: geometry::InstanceCaster for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/ray/instances.h"

namespace panwright::support {

struct RayHit {
  double distance = 0;         // metres from the ray's origin
  std::uint32_t instance = 0;  // as returned by add()
  std::uint32_t triangle = 0;  // in the mesh
  Vec2 barycentric{0};         // weights of the second and third corner, in the triangle
  Vec3 normal{0};  // geometric, unit, world, outwards (counter-clockwise in the mesh's frame)
};

class RayCaster {
 public:
  // Returns 0, 1, 2… Expects: before build().
  std::uint32_t add(const geometry::Mesh& mesh, const Mat4& world_from_mesh) {
    const std::uint32_t index = caster_.add_mesh(mesh.positions, mesh.triangles);
    instances_.push_back({mesh.positions, mesh.triangles, world_from_mesh});
    return caster_.add(index, world_from_mesh, false);
  }
  void build() { caster_.build(); }

  std::optional<RayHit> closest(const geometry::Ray& ray) const {
    const geometry::Ray unit = with_unit_direction(ray);
    const auto found = caster_.closest(unit);
    if (!found) return std::nullopt;
    const Instance& instance = instances_[found->instance];
    const geometry::Triangle& t = instance.triangles[found->triangle];
    const auto corner = [&](int k) {
      return Vec3(instance.world_from_mesh * Vec4(instance.positions[t[k]], 1));
    };
    const Vec3 a = corner(0);
    const double side = glm::determinant(Mat3(instance.world_from_mesh)) < 0 ? -1 : 1;
    const Vec3 normal = side * glm::normalize(glm::cross(corner(1) - a, corner(2) - a));
    return RayHit{found->distance, found->instance, found->triangle, found->barycentric, normal};
  }
  bool any(const geometry::Ray& ray) const { return caster_.any(with_unit_direction(ray)); }

 private:
  struct Instance {
    std::vector<Vec3> positions;
    std::vector<geometry::Triangle> triangles;
    Mat4 world_from_mesh;
  };

  static geometry::Ray with_unit_direction(geometry::Ray ray) {
    const Vec3& d = ray.direction;
    const double largest = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    ray.direction = glm::normalize(d / largest);
    return ray;
  }

  geometry::InstanceCaster caster_;
  std::vector<Instance> instances_;
};

}  // namespace panwright::support
