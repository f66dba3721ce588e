#include "labels/flow.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "labels/internal/flow_parts.h"

namespace panwright::labels {

namespace {

constexpr std::size_t kRowsAtOnce = 8;

// What carries a point of a node from one camera's axes into those of the other.
struct Carriage {
  trace::Affine map;
  bool there = false;  // it is in the other frame
};

std::vector<std::vector<Carriage>> carriages(const Moment& now, const Moment& other) {
  const auto before = nodes_in_camera(now), after = nodes_in_camera(other);
  std::vector<std::vector<Carriage>> result(before.size());
  for (std::size_t t = 0; t < before.size(); ++t) {
    result[t].resize(before[t].visible.size());
    for (std::size_t n = 0; n < result[t].size(); ++n) {
      Carriage& out = result[t][n];
      out.map = after[t].camera_from_node[n] * inverse_of(before[t].camera_from_node[n]);
      out.there = after[t].visible[n] != 0 && is_finite(out.map.offset);
    }
  }
  return result;
}

std::optional<SurfacePoint> by_ray(const trace::Scene& scene, const trace::Ray& ray) {
  const trace::Hit hit = scene.nearest(ray);
  if (!hit) return std::nullopt;
  return SurfacePoint{ray.origin + hit.distance * ray.direction, hit.target, scene.node_of(hit)};
}

}  // namespace

trace::Affine inverse_of(const trace::Affine& affine) {
  const Mat3 linear = glm::inverse(affine.linear);
  return {linear, -(linear * affine.offset)};
}

std::vector<NodesInCamera> nodes_in_camera(const Moment& moment) {
  const trace::RigidFrame here =
      trace::frame_of({moment.camera.position, moment.camera.world_from_camera});
  std::vector<NodesInCamera> result;
  for (const world::Instance& target : moment.world.instances()) {
    const trace::PlacedNodes nodes = trace::placed_nodes(target);
    const trace::Affine camera_from = between(here, trace::frame_of(target.pose()));
    NodesInCamera& out = result.emplace_back();
    out.visible = nodes.visible;
    for (const trace::Affine& node : nodes.model_from_node)
      out.camera_from_node.push_back(camera_from * node);
  }
  return result;
}

std::optional<SurfacePoint> surface_of_layers(const image::Image& layers, const ImagePlane& plane,
                                              std::size_t pixel, const trace::Ray& ray) {
  if (layers.target_id[pixel] == 0 || layers.node_id[pixel] == 0) return std::nullopt;
  double away = plane.orthographic() ? layers.depth[pixel] : layers.range[pixel];
  if (!plane.orthographic() && !plane.central()) {
    // the range is to the camera's position, and the ray begins beside it
    const double along = glm::dot(ray.origin, ray.direction);
    away = std::sqrt(along * along + away * away - glm::dot(ray.origin, ray.origin)) - along;
  }
  if (!std::isfinite(away)) return std::nullopt;
  return SurfacePoint{ray.origin + away * ray.direction, layers.target_id[pixel] - 1,
                      layers.node_id[pixel] - 1};
}

Flow flow_to(const Moment& now, const Moment& other, const trace::Scene& scene,
             const image::Image* layers, const Job& job) {
  assert(now.world.size() == other.world.size());
  const ImagePlane plane(now.camera), other_plane(other.camera);
  const std::size_t width = now.camera.width, height = now.camera.height;
  Flow flow;
  flow.width = now.camera.width;
  flow.height = now.camera.height;
  flow.motion.assign(2 * width * height, std::numeric_limits<float>::quiet_NaN());
  const auto carried = carriages(now, other);
  const auto rows = [&](std::size_t chunk) {
    const std::size_t end = std::min(height, (chunk + 1) * kRowsAtOnce);
    for (std::size_t y = chunk * kRowsAtOnce; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t pixel = y * width + x;
        if (layers != nullptr && layers->target_id[pixel] == 0) continue;
        const Vec2 centre(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        const auto ray = plane.view_ray(centre);
        if (!ray) continue;
        const auto seen = layers != nullptr ? surface_of_layers(*layers, plane, pixel, *ray)
                                            : by_ray(scene, *ray);
        if (!seen) continue;
        const Carriage& carriage = carried[seen->target][seen->node];
        if (!carriage.there) continue;
        const auto place = other_plane.place(carriage.map(seen->point));
        if (!place) continue;
        const Vec2 motion = *place - centre;
        flow.motion[2 * pixel] = static_cast<float>(motion.x);
        flow.motion[2 * pixel + 1] = static_cast<float>(motion.y);
      }
  };
  parallel_for((height + kRowsAtOnce - 1) / kRowsAtOnce, rows, job);
  return flow;
}

}  // namespace panwright::labels
