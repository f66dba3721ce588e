#include "labels/flow.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "labels/internal/image_plane.h"
#include "trace/placement.h"

namespace panwright::labels {

namespace {

constexpr std::size_t kRowsAtOnce = 8;

// What carries a point of a node from one camera's axes into those of the other.
struct Carriage {
  trace::Affine map;
  bool there = false;  // it is in the other frame
};

trace::Affine inverse_of(const trace::Affine& affine) {
  const Mat3 linear = glm::inverse(affine.linear);
  return {linear, -(linear * affine.offset)};
}

trace::RigidFrame camera_frame(const world::Camera& camera) {
  return trace::frame_of({camera.position, camera.world_from_camera});
}

std::vector<std::vector<Carriage>> carriages(const Moment& now, const Moment& other) {
  const trace::RigidFrame here = camera_frame(now.camera), there = camera_frame(other.camera);
  std::vector<std::vector<Carriage>> result(now.world.size());
  for (std::size_t t = 0; t < now.world.size(); ++t) {
    const trace::PlacedNodes before = trace::placed_nodes(now.world[t]);
    const trace::PlacedNodes after = trace::placed_nodes(other.world[t]);
    const trace::Affine from = between(here, trace::frame_of(now.world[t].pose()));
    const trace::Affine to = between(there, trace::frame_of(other.world[t].pose()));
    result[t].resize(before.model_from_node.size());
    for (std::size_t n = 0; n < result[t].size(); ++n) {
      Carriage& out = result[t][n];
      out.there = after.visible[n] != 0;
      out.map = (to * after.model_from_node[n]) * inverse_of(from * before.model_from_node[n]);
      out.there = out.there && is_finite(out.map.offset);
    }
  }
  return result;
}

// Surface at a pixel's centre.
struct SurfacePoint {
  Vec3 point;  // metres, camera axes
  std::uint32_t target = 0, node = 0;
};

std::optional<SurfacePoint> by_ray(const trace::Scene& scene, const trace::Ray& ray) {
  const trace::Hit hit = scene.nearest(ray);
  if (!hit) return std::nullopt;
  const auto& part = scene.targets()[hit.target].target->model().parts()[hit.part];
  return SurfacePoint{ray.origin + hit.distance * ray.direction, hit.target, part.node};
}

std::optional<SurfacePoint> by_layers(const image::Image& layers, const ImagePlane& plane,
                                      std::size_t pixel, const trace::Ray& ray) {
  if (layers.target_id[pixel] == 0 || layers.node_id[pixel] == 0) return std::nullopt;
  const double away = plane.orthographic() ? layers.depth[pixel] : layers.range[pixel];
  if (!std::isfinite(away)) return std::nullopt;
  return SurfacePoint{ray.origin + away * ray.direction, layers.target_id[pixel] - 1,
                      layers.node_id[pixel] - 1};
}

}  // namespace

Flow flow_to(const Moment& now, const Moment& other, const trace::Scene& scene,
             const image::Image* layers, const Job& job) {
  assert(now.world.size() == other.world.size());
  const ImagePlane plane(now.camera), other_plane(other.camera);
  const std::size_t width = now.camera.width, height = now.camera.height;
  // the range of layers is to the camera's position
  if (layers != nullptr && !plane.central() && !plane.orthographic()) layers = nullptr;
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
        const auto seen =
            layers != nullptr ? by_layers(*layers, plane, pixel, *ray) : by_ray(scene, *ray);
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
