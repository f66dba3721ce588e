#include "labels/internal/keypoint_views.h"

#include <algorithm>
#include <cmath>

#include "sky/sky.h"

namespace panwright::labels {

namespace {

// Point on the surface nearest to a keypoint, in the target's frame.
struct Footing {
  Vec3 position{0};           // metres
  std::vector<Vec3> normals;  // of the facets there, unit, outwards; empty: on no surface
  bool faces(const Vec3& direction) const {
    return normals.empty() || std::ranges::any_of(normals, [&](const Vec3& normal) {
             return glm::dot(normal, direction) > 0;
           });
  }
};

// Short rays through the point and beside it, so that all facets at a corner are met.
std::vector<trace::Ray> probes(std::uint32_t target, const Vec3& point, double reach) {
  std::vector<trace::Ray> rays;
  const auto add = [&](const Vec3& through, const Vec3& direction) {
    trace::Ray ray;
    ray.frame = target;
    ray.direction = glm::normalize(direction);
    ray.origin = through - 2 * reach * ray.direction;
    ray.max_distance = 4 * reach;
    rays.push_back(ray);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Vec3 direction(0);
      direction[axis] = sign;
      add(point, direction);
      for (const double u : {0.5, -0.5})
        for (const double v : {0.5, -0.5}) {
          Vec3 beside = point;
          beside[(axis + 1) % 3] += u * reach;
          beside[(axis + 2) % 3] += v * reach;
          add(beside, direction);
        }
    }
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, -1.0}) add(point, Vec3(x, y, z));
  return rays;
}

// error: within which facets beside the nearest one count too, metres.
Footing footing_of(const trace::Scene& scene, std::uint32_t target, const Vec3& point, double reach,
                   double error) {
  // what facets at one corner differ by, rounded
  const double same = 1e-6 * std::max(1.0, glm::length(point));
  struct Facet {
    Vec3 normal;
    double height;  // of the point above its plane, metres
  };
  std::vector<Facet> facets;
  for (const trace::Ray& ray : probes(target, point, reach)) {
    const trace::Hit hit = scene.nearest(ray);
    if (!hit || hit.target != target) continue;
    const trace::Surface surface = scene.surface(hit);
    if (surface.facet == Vec3(0)) continue;
    const double height = glm::dot(point - surface.position, surface.facet);
    if (std::fabs(height) <= reach && glm::length(point - surface.position) <= 2 * reach)
      facets.push_back({surface.facet, height});
  }
  Footing result{point, {}};
  if (facets.empty()) return result;
  const auto nearest = std::ranges::min_element(
      facets, {}, [](const Facet& facet) { return std::fabs(facet.height); });
  const double limit = std::max(std::fabs(nearest->height) + same, error);
  result.position = point - nearest->height * nearest->normal;
  for (const Facet& facet : facets)
    if (std::fabs(facet.height) <= limit) result.normals.push_back(facet.normal);
  return result;
}

double mesh_error(const world::Instance& instance) {
  double error = 0;
  for (const auto& mesh : instance.model()->meshes()) error = std::max(error, mesh.error);
  return error;
}

}  // namespace

std::vector<Keypoint> keypoints_of(const world::World& world, std::uint32_t target,
                                   const trace::PlacedNodes& placed, const trace::Scene& scene,
                                   const ImagePlane& plane, double slack) {
  const world::Instance& instance = world[target];
  const pan::Model& model = *instance.model();
  const trace::Affine camera_from_model = scene.observer_from(target);
  const trace::RigidFrame& frame = scene.targets()[target].frame;
  // a row times a matrix: the inverse of a rotation is its transpose
  const Vec3 to_sun = glm::normalize(world.sun().direction) * frame.world_from;
  const sky::Sky sky(world);
  const double error = mesh_error(instance);
  const double reach = std::max(slack, 2 * error);
  const world::Camera& camera = plane.camera();
  std::vector<Keypoint> result;
  for (const auto& record : model.keypoints()) {
    Keypoint& out = result.emplace_back();
    out.name = model.string(record.name);
    out.position = placed.model_from_node[record.node](
        Vec3(record.position[0], record.position[1], record.position[2]));
    out.in_camera = camera_from_model(out.position);
    out.pixel = plane.place(out.in_camera);
    out.truncated = !out.pixel || !(out.pixel->x >= 0 && out.pixel->y >= 0 &&
                                    out.pixel->x < camera.width && out.pixel->y < camera.height);
    const Footing footing =
        footing_of(scene, target, out.position, reach, slack < error ? error : 0);
    trace::Ray to_light;
    to_light.frame = target;
    to_light.origin = footing.position;
    to_light.direction = to_sun;
    to_light.min_distance = slack;
    out.lit = footing.faces(to_sun) &&
              !sky.sun_hidden(frame.world_from * footing.position + frame.position) &&
              !scene.any(to_light, trace::Insides::stop);
    const auto ray = plane.view_ray_to(camera_from_model(footing.position));
    if (!ray) continue;
    trace::Ray line = *ray;
    line.max_distance -= slack;
    const Vec3 towards = -line.direction * camera_from_model.linear;
    out.occluded =
        !footing.faces(towards) || (line.max_distance > 0 && scene.any(line, trace::Insides::pass));
  }
  return result;
}

}  // namespace panwright::labels
