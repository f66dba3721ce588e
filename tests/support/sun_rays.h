// Visibility of the Sun, by rays in double, to validate shadow maps. Meshes without holes.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/math.h"
#include "pan/model.h"
#include "preview/frame/light_space.h"
#include "tests/support/ray_caster.h"
#include "tests/support/view.h"

namespace panwright::support {

class SunRays {
 public:
  // Expects: model.checked(); it outlives this.
  SunRays(const pan::Model& model, const preview::View& view)
      : model_(model), camera_(view.camera), to_sun_(glm::normalize(view.to_sun)) {
    const std::vector<Mat4> nodes = model.world_from_nodes();
    for (const pan::layout::Instance& instance : model.instances()) {
      const pan::layout::Mesh& record = model.meshes()[instance.mesh];
      const pan::MeshView mesh = model.mesh(instance.mesh);
      geometry::Mesh exact;
      for (const auto& p : mesh.positions) exact.positions.emplace_back(p.x, p.y, p.z);
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        exact.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
      Mat4 placed = nodes[instance.node];
      placed[3] = placed * Vec4(record.origin[0], record.origin[1], record.origin[2], 1);
      world_from_mesh_.push_back(view.world_from_model.matrix() * placed);
      caster_.add(exact, world_from_mesh_.back());
    }
    caster_.build();
  }

  // Returns the width of a texel of the preview's shadow map, metres, for a model at rest.
  double texel(unsigned side) const {
    const preview::LightSpace frame =
        preview::fitted_light_space(preview::draw_list(model_), to_sun_, side);
    return std::max(frame.extent.x, frame.extent.y) / side;
  }

  // Hit of a camera ray.
  struct Point {
    double distance = 0;  // from the camera ray's start
    Vec3 normal{0};       // smooth, unit, on the visible side
    Vec3 start{0};        // of the ray to the Sun: offset by twice the mesh's error
    std::size_t instance = 0;
  };
  std::optional<Point> seen(const Vec2& pixel, bool flat = false) const {
    const geometry::Ray ray = world::pixel_ray(camera_, pixel);
    const auto hit = caster_.closest(ray);
    if (!hit) return std::nullopt;
    const std::size_t mesh_index = model_.instances()[hit->instance].mesh;
    const pan::MeshView mesh = model_.mesh(mesh_index);
    const Mat4& world_from_mesh = world_from_mesh_[hit->instance];
    const Mat3 linear(world_from_mesh);
    const Vec3 weight(1 - hit->barycentric.x - hit->barycentric.y, hit->barycentric);
    Vec3 normal(0);
    for (int k = 0; k < 3; ++k) {
      const auto& n =
          mesh.normals[mesh.indices[std::size_t{3} * hit->triangle + static_cast<std::size_t>(k)]];
      normal += weight[k] * Vec3(n.x, n.y, n.z);
    }
    Point point;
    point.distance = hit->distance;
    point.instance = hit->instance;
    const double away = glm::dot(hit->normal, ray.direction) > 0 ? -1 : 1;
    const Vec3 smooth =
        glm::normalize(cofactor(linear) * normal) * (glm::determinant(linear) < 0 ? -1.0 : 1.0);
    point.normal = away * (flat ? hit->normal : smooth);
    point.start = ray.origin + glm::normalize(ray.direction) * hit->distance;
    if (!flat)
      point.start +=
          away * (linear * (glm::normalize(normal) * 2.0 * model_.meshes()[mesh_index].error));
    return point;
  }

  bool lit(const Vec3& start) const {
    return !caster_.any({.origin = start, .direction = to_sun_, .min_distance = kSkip});
  }

  // Returns the distance, across the Sun's rays, to a different answer, metres; in eighths of
  // `step`, up to 8 of it. 1e30: the same all round. Approximates the surface by its tangent plane.
  double to_edge(const Point& point, double step) const {
    const bool here = lit(point.start);
    const Vec3 across = glm::normalize(
        glm::cross(to_sun_, std::fabs(to_sun_.z) < 0.8 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
    const Vec3 along = glm::cross(to_sun_, across);
    const double cos_nl = glm::dot(point.normal, to_sun_);
    for (int ring = 1; ring <= 64; ++ring)
      for (int spoke = 0; spoke < 16; ++spoke) {
        const double angle = spoke * kPi / 8;
        const Vec3 off = (across * std::cos(angle) + along * std::sin(angle)) * (step * ring / 8.0);
        const Vec3 moved = off - to_sun_ * (glm::dot(point.normal, off) / cos_nl);
        if (lit(point.start + moved) != here) return step * ring / 8.0;
      }
    return 1e30;
  }

 private:
  static constexpr double kSkip = 1e-6;  // metres: offset of a ray's start

  const pan::Model& model_;
  world::Camera camera_;
  Vec3 to_sun_;
  std::vector<Mat4> world_from_mesh_;
  RayCaster caster_;
};

}  // namespace panwright::support
