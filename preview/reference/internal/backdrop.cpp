#include "preview/reference/internal/backdrop.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "preview/reference/internal/bodies.h"
#include "preview/reference/internal/path.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview::reference {
namespace {

// no path has so many surfaces: numbers() of these uses are free
constexpr std::uint32_t kPlaceUse = 1u << 30;

// Two independent numbers of a Gaussian of sigma 1 (Box, Muller).
Vec2 gaussian(double u, double v) {
  const double radius = std::sqrt(-2 * det::log(u));
  const det::SinCos turn = det::sincos(2 * kPi * v);
  return radius * Vec2(turn.cos, turn.sin);
}

class Backdrop {
 public:
  Backdrop(const world::World& world, const TraceScene& scene, const world::Camera& camera,
           const ReferenceOptions& options)
      : scene_(scene),
        camera_(camera),
        options_(options),
        frame_(scene.rays().observer()),
        sun_(world.sun(), frame_.world_from, true),
        bodies_(world.bodies(), frame_, sun_, radiance_unit(world)),
        sun_visible_(world.sun_visible()) {
    while ((side_ + 1) * (side_ + 1) <= options.samples) ++side_;
  }

  std::uint32_t samples() const { return side_ * side_; }

  Vec3 light(std::uint32_t column, std::uint32_t row, std::uint32_t number, bool targets) const {
    StreamKey name{row * camera_.width + column, 0, number, options_.seed};
    const std::array<double, 4> u = numbers(name, kPlaceUse);
    Vec2 place(column + (number % side_ + u[0]) / side_, row + (number / side_ + u[1]) / side_);
    const std::array<double, 4> v = numbers(name, kPlaceUse + 1);
    if (options_.psf_sigma > 0) place += options_.psf_sigma * gaussian(v[0], v[1]);
    const auto ray = view_ray(camera_, place);
    if (!ray) return Vec3(0);
    const auto hit = bodies_.nearest(ray->origin, ray->direction);
    const Vec3 behind = sun_visible_ && !hit ? sun_.radiance(ray->direction) : Vec3(0);
    const Vec3 result = bodies_.light(ray->origin, ray->direction, {u[2], u[3]}, behind);
    if (result == Vec3(0) || !targets) return result;
    const auto surface = scene_.seen(trace::Ray{*ray});
    return surface && !(hit && hit->distance < surface->distance) ? Vec3(0) : result;
  }

 private:
  const TraceScene& scene_;
  const world::Camera& camera_;
  const ReferenceOptions& options_;
  const trace::RigidFrame& frame_;
  Sun sun_;
  Bodies bodies_;
  bool sun_visible_;
  std::uint32_t side_ = 1;
};

}  // namespace

void add_backdrop(const world::World& world, const TraceScene& scene, const world::Camera& camera,
                  std::span<const Cell> cells, const ReferenceOptions& options,
                  ReferenceImage& result, const Job& job) {
  const Backdrop backdrop(world, scene, camera, options);
  const std::uint32_t width = camera.width;
  // with a PSF a ray may meet a target anywhere
  std::vector<char> targets(result.image.pixels(), options.psf_sigma > 0 ? 1 : 0);
  if (options.psf_sigma == 0)
    for (const Cell& cell : cells) targets[std::size_t{cell.row} * width + cell.column] = 1;
  const double count = backdrop.samples();
  const auto add_row = [&](std::size_t row) {
    for (std::uint32_t column = 0; column < width; ++column) {
      const std::size_t pixel = row * width + column;
      Vec3 sum(0), squares(0);
      for (std::uint32_t k = 0; k < backdrop.samples(); ++k) {
        const Vec3 light =
            backdrop.light(column, static_cast<std::uint32_t>(row), k, targets[pixel] != 0);
        sum += light;
        squares += light * light;
      }
      for (int k = 0; k < 3; ++k) {
        const double mean = sum[k] / count;
        const double variance = std::max(0.0, squares[k] / count - mean * mean) / (count - 1);
        const std::size_t at = 3 * pixel + static_cast<std::size_t>(k);
        const double error = result.standard_error[at];
        result.image.radiance[at] += static_cast<float>(mean);
        result.standard_error[at] = static_cast<float>(std::sqrt(error * error + variance));
      }
    }
  };
  parallel_for(camera.height, add_row, job);
}

}  // namespace panwright::preview::reference
