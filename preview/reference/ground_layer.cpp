#include "preview/reference/ground_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "preview/reference/internal/path.h"
#include "preview/reference/internal/trace_scene.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview {

using namespace reference;

namespace {

// Depths of targets; where there is none, the largest of the pixels around, else 0.
std::vector<float> depths_of_targets(const image::Image& image) {
  std::vector<float> depths(image.pixels(), 0);
  const auto width = static_cast<std::int64_t>(image.width),
             height = static_cast<std::int64_t>(image.height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      float& depth = depths[static_cast<std::size_t>(y * width + x)];
      depth = image.depth[static_cast<std::size_t>(y * width + x)];
      if (std::isfinite(depth)) continue;
      depth = 0;
      for (std::int64_t j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, width - 1);
             ++i) {
          const float other = image.depth[static_cast<std::size_t>(j * width + i)];
          if (std::isfinite(other)) depth = std::max(depth, other);
        }
    }
  return depths;
}

Vec2 gaussian_of(double u, double v) {
  const double radius = std::sqrt(-2 * det::log(u));
  const det::SinCos turn = det::sincos(2 * kPi * v);
  return radius * Vec2(turn.cos, turn.sin);
}

// One view of terrain.
struct GroundView {
  const TraceScene& scene;
  const world::Camera& camera;
  const GroundOptions& options;
  std::vector<Sun> suns;
  std::vector<Bodies> bodies;
  TraceLamps lamps;
  PathOptions path;

  struct Sums {
    Vec3 before{0}, behind{0};  // radiance
    double before_share = 0, behind_share = 0;
  };

  Sums pixel(std::uint32_t column, std::uint32_t row, double depth) const {
    Sums sums;
    const std::uint32_t side = options.samples, count = side * side;
    const std::uint32_t number = row * camera.width + column;
    const std::array<double, 4> turn = numbers({number, 0, 0, 0}, 0);
    RayCounts counts;
    for (std::uint32_t k = 0; k < count; ++k) {
      // steps of a plane-filling sequence
      const auto step = [&](double at, double by) {
        const double x = at + k * by;
        return x - std::floor(x);
      };
      Vec2 place(column + (k % side + 0.5) / side, row + (k / side + 0.5) / side);
      if (options.psf_sigma > 0)
        place += options.psf_sigma * gaussian_of(1 - step(turn[2], 0.7548776662466927),
                                                 step(turn[3], 0.5698402909980532));
      const auto ray = view_ray(camera, place);
      if (!ray) continue;
      const trace::Hit hit = scene.rays().nearest_ground({*ray, trace::Ray::kObserver});
      if (!hit) continue;
      FirstRandoms first;
      first.sun = {step(turn[0], 0.7548776662466927), step(turn[1], 0.5698402909980532)};
      const Vec3 light =
          traced_from(scene, suns, bodies, hit, first, {number, 0, k, 0}, path, counts).radiance;
      const bool before = ray->origin.z + hit.distance * ray->direction.z < depth;
      (before ? sums.before : sums.behind) += light / double(count);
      (before ? sums.before_share : sums.behind_share) += 1.0 / count;
    }
    return sums;
  }

  void set_truth(std::size_t pixel, std::uint32_t column, std::uint32_t row,
                 image::Image& image) const {
    const auto ray = view_ray(camera, {column + 0.5, row + 0.5});
    if (!ray) return;
    const trace::Hit hit = scene.rays().nearest_ground({*ray, trace::Ray::kObserver});
    const double depth = ray->origin.z + hit.distance * ray->direction.z;
    if (!hit || !(depth < double(image.depth[pixel]))) return;
    const trace::Scene::Placed& placed = scene.rays().targets()[hit.target];
    const Vec3 normal = placed.frame.world_from * placed.target->normal(hit, options.flat);
    const trace::Ids ids = scene.rays().ids(hit);
    image.depth[pixel] = static_cast<float>(depth);
    image.range[pixel] = static_cast<float>(hit.distance);
    for (std::size_t k = 0; k < 3; ++k)
      image.normal[3 * pixel + k] = static_cast<float>(normal[static_cast<int>(k)]);
    image.target_id[pixel] = ids.target;
    image.node_id[pixel] = ids.node;
    image.material_id[pixel] = ids.material;
  }
};

}  // namespace

struct GroundLayer::Impl {
  TraceScene scene{true};
};

GroundLayer::GroundLayer() : impl_(std::make_unique<Impl>()) {}
GroundLayer::GroundLayer(GroundLayer&&) noexcept = default;
GroundLayer& GroundLayer::operator=(GroundLayer&&) noexcept = default;
GroundLayer::~GroundLayer() = default;

bool has_ground(const world::Instance& target) {
  return std::ranges::any_of(target.model()->directory(), [](const auto& entry) {
    return entry.kind == terrain::kTilesSection;
  });
}

bool has_ground(const world::World& world) {
  return std::ranges::any_of(world.instances(),
                             [](const world::Instance& target) { return has_ground(target); });
}

void GroundLayer::add(const world::World& world, const world::Camera& camera,
                      const GroundOptions& options, image::Image& image, const Job& job) {
  TraceScene& scene = impl_->scene;
  scene.update(world, job);
  scene.place_camera(camera, trace::half_pixel(camera));
  GroundView view{scene, camera, options, {}, {}, {}, {}};
  for (const trace::Scene::Placed& placed : scene.rays().targets()) {
    view.suns.emplace_back(world.sun(), placed.frame.world_from, options.sun_disc);
    if (!world.bodies().empty())
      view.bodies.emplace_back(world.bodies(), placed.frame, view.suns.back(),
                               radiance_unit(world));
  }
  view.lamps = trace_lamps(world, camera, scene.rays());
  view.path = {world.lamps().empty() ? nullptr : &view.lamps, 0, options.flat, world.white()};
  const std::vector<float> depths = depths_of_targets(image);
  const auto add_row = [&](std::size_t y) {
    const auto row = static_cast<std::uint32_t>(y);
    for (std::uint32_t column = 0; column < image.width; ++column) {
      const std::size_t pixel = y * image.width + column;
      const float covered = image.coverage[pixel];
      const auto sums = view.pixel(column, row, covered > 0 ? double(depths[pixel]) : 0);
      if (sums.before_share + sums.behind_share == 0) continue;
      const double left = 1 - sums.before_share, open = 1 - double(covered);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<int>(k);
        float& light = image.radiance[3 * pixel + k];
        light = static_cast<float>(double(light) * left + sums.before[i] + open * sums.behind[i]);
      }
      image.coverage[pixel] = static_cast<float>(
          std::min(1.0, double(covered) * left + sums.before_share + open * sums.behind_share));
      view.set_truth(pixel, column, row, image);
    }
  };
  parallel_for(image.height, add_row, job);
}

std::ptrdiff_t GroundLayer::shaded_target(const world::World& world) const {
  const trace::Scene& rays = impl_->scene.rays();
  for (std::size_t i = 0; i < world.size(); ++i) {
    const auto& placed = rays.targets()[i];
    if (placed.target->ground() != nullptr || placed.target->bounds().empty()) continue;
    const AxisBox& box = placed.target->bounds();
    const Vec3 middle = placed.frame.world_from * (0.5 * (box.low + box.high)) +
                        placed.frame.position - rays.observer().position;
    const Vec3 sun = world.sun().direction;
    const trace::Ray ray{{middle * rays.observer().world_from, sun * rays.observer().world_from},
                         trace::Ray::kObserver};
    if (rays.nearest_ground(ray)) return static_cast<std::ptrdiff_t>(i);
  }
  return -1;
}

}  // namespace panwright::preview
