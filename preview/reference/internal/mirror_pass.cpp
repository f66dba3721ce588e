#include "preview/reference/internal/mirror_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "light/surfels.h"
#include "preview/reference/internal/cells.h"
#include "preview/reference/internal/path.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview::reference {
namespace {

constexpr std::uint32_t kMostMirrors = 8;  // one after the other
constexpr double kLeastShare = 1e-3;       // of white, that mirrors leave of light behind them
constexpr std::uint32_t kMore = 4;         // N: N x N samples of pixels that differ from others
constexpr double kStep = 0.01;             // of white, from pixel to pixel
// Uses of numbers() for mirrors, beyond those of paths.
constexpr std::uint32_t kMirrorUse = 3u << 20;

double mean(const Vec3& rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

// One view of mirrors.
struct MirrorView {
  const TraceScene& scene;
  const world::Camera& camera;
  const MirrorOptions& options;
  std::vector<Sun> suns;
  std::vector<Bodies> bodies;  // of the targets; none: no bodies
  TraceLamps lamps;
  PathOptions path;

  // What a place of the image gets by mirrors of targets.
  Vec3 at(const Vec2& place, const StreamKey& name) const {
    const auto ray = view_ray(camera, place);
    if (!ray) return Vec3(0);
    const auto hit = scene.seen(trace::Ray{*ray});
    if (!hit) return Vec3(0);
    const Point point = scene.point(*hit, options.flat);
    if (point.normal == Vec3(0) || !point.surface().has_mirror) return Vec3(0);
    return shown(*hit, point, Vec3(1), name, 0);
  }

  // What mirrors at a hit send of what they show: of targets, and those that the camera sees of
  // bodies too. Light of bodies in further ones is that of traced_from().
  //
  //   share  of it that reaches the camera
  Vec3 shown(const trace::Hit& hit, const Point& point, const Vec3& share, const StreamKey& from,
             std::uint32_t depth) const {
    const materials::Mirrors mirrors =
        point.surface().scattering.mirrors(-hit.direction, point.normal, point.tangent);
    Vec3 sum(0);
    for (int i = 0; i < mirrors.count; ++i) {
      const materials::Mirrored& one = mirrors.all[static_cast<std::size_t>(i)];
      const Vec3 left = share * one.reflectance;
      if (!(max_component(left) > kLeastShare) || !(glm::dot(one.to_light, point.normal) > 0))
        continue;
      StreamKey name = from;
      name.number = 2 * from.number + static_cast<std::uint32_t>(i) + 1;  // a path of its own
      const auto next = scene.closest({{point.start, one.to_light}, hit.target});
      if (next && !scene.is_inside(*next)) {
        sum += sent(*next, left, name, depth + 1);
      } else if (!next && depth == 0 && !bodies.empty()) {
        const std::array<double, 4> u = numbers(name, kMirrorUse);
        sum += left * bodies[hit.target].light(point.start, one.to_light, {u[0], u[1]});
      }
    }
    return sum;
  }

  // What a surface sends to a mirror.
  Vec3 sent(const trace::Hit& hit, const Vec3& share, const StreamKey& name,
            std::uint32_t depth) const {
    const std::array<double, 4> u = numbers(name, kMirrorUse), v = numbers(name, kMirrorUse + 1);
    RayCounts counts;
    FirstRandoms first{{u[0], u[1]}, {u[2], u[3]}, v[0]};
    Vec3 sum = share * traced_from(scene, suns, bodies, hit, first, name, path, counts).radiance;
    const Point point = scene.point(hit, options.flat);
    if (point.normal == Vec3(0)) return sum;
    const Scatter& surface = point.surface();
    if (hit.target < options.indirect.size()) {
      // as of a sky of even radiance
      const Vec3 even =
          light::irradiance_at(options.indirect[hit.target], point.start, point.normal) / kPi;
      if (max_component(even) > 0)
        if (const auto drawn = surface.scattering.sample(
                -hit.direction, point.normal, point.tangent, point.tint, {v[1], v[2]}, v[3]))
          sum += share * even * drawn->weight;
    }
    if (surface.has_mirror && depth < kMostMirrors) sum += shown(hit, point, share, name, depth);
    return sum;
  }

  // Mean over the samples of a pixel.
  //
  //   side  N: N x N of them
  Vec3 pixel(std::uint32_t column, std::uint32_t row, std::uint32_t side) const {
    Vec3 sum(0);
    for (std::uint32_t k = 0; k < side * side; ++k) {
      const StreamKey name{row * camera.width + column, side, k, 0};
      const std::array<double, 4> u = numbers(name, kMirrorUse + 2);
      const Vec2 place(column + (k % side + u[0]) / side, row + (k / side + u[1]) / side);
      sum += at(place, {name.pixel, side, 1024 * (k + 1), 0});
    }
    return sum / double(side * side);
  }
};

// Pixels that may show a mirror, as marks of the image.
std::vector<std::uint8_t> pixels_of(const TraceScene& scene, const world::Camera& camera) {
  std::vector<std::uint8_t> marks(camera.width * std::size_t{camera.height});
  const auto may_mirror = [&](std::uint32_t target, std::uint32_t part) {
    return scene.model(target)->may_mirror(part);
  };
  for (const Cell& cell : cells_of(scene.rays(), camera, may_mirror))
    marks[cell.row * std::size_t{camera.width} + cell.column] = 1;
  return marks;
}

// Whether a pixel differs from one beside it.
bool differs(const std::vector<Vec3>& light, std::uint32_t width, std::size_t pixel, double step) {
  const std::size_t x = pixel % width, rows = light.size() / width, y = pixel / width;
  for (std::size_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, rows - 1); ++j)
    for (std::size_t i = x > 0 ? x - 1 : 0; i <= std::min<std::size_t>(x + 1, width - 1); ++i)
      if (max_component(glm::abs(light[j * width + i] - light[pixel])) > step) return true;
  return false;
}

// Convolves an image with the discrete Gaussian of a variance, exp(-t) I_n(t). T. Lindeberg,
// "Scale-space for discrete signals", 1990. Beyond the border it is dark.
void blur(image::Image& image, double sigma, std::uint32_t reach, const Job& job) {
  constexpr int kAngles = 256;  // exact for as many terms
  std::vector<double> kernel(reach + 1);
  for (std::uint32_t n = 0; n <= reach; ++n)
    for (int i = 0; i < kAngles; ++i) {
      const double angle = kPi * (i + 0.5) / kAngles;
      kernel[n] += det::exp(sigma * sigma * (det::cos(angle) - 1)) * det::cos(n * angle) / kAngles;
    }
  const std::vector<float> in = image.radiance;
  std::vector<float> across(in.size());
  const auto convolve = [&](std::span<const float> from, std::span<float> to, std::size_t line,
                            std::size_t length, std::size_t next, std::size_t step) {
    for (std::size_t i = 0; i < length; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](std::size_t place) {
          return static_cast<double>(from[line * next + place * step + k]);
        };
        double sum = kernel[0] * at(i);
        for (std::size_t n = 1; n <= reach; ++n)
          sum += kernel[n] * ((i >= n ? at(i - n) : 0) + (i + n < length ? at(i + n) : 0));
        to[line * next + i * step + k] = static_cast<float>(sum);
      }
  };
  const std::size_t pitch = 3 * std::size_t{image.width};
  parallel_for(
      image.height, [&](std::size_t row) { convolve(in, across, row, image.width, pitch, 3); },
      job);
  parallel_for(
      image.width,
      [&](std::size_t column) { convolve(across, image.radiance, column, image.height, 3, pitch); },
      job);
}

}  // namespace

void add_mirrored(const TraceScene& scene, const world::World& world, const world::Camera& camera,
                  const MirrorOptions& options, image::Image& image, const Job& job) {
  // a PSF takes light from beyond the border
  constexpr double kReach = 4;  // of it, in sigma
  const auto margin = static_cast<std::uint32_t>(std::ceil(kReach * options.psf_sigma));
  world::Camera wide = camera;
  wide.width += 2 * margin;
  wide.height += 2 * margin;
  wide.principal += static_cast<double>(margin);
  const std::vector<std::uint8_t> marks = pixels_of(scene, wide);
  if (std::ranges::find(marks, 1) == marks.end()) return;
  MirrorView view{scene, wide, options, {}, {}, {}, {}};
  for (const trace::Scene::Placed& placed : scene.rays().targets()) {
    view.suns.emplace_back(world.sun(), placed.frame.world_from, true);
    if (!world.bodies().empty())
      view.bodies.emplace_back(world.bodies(), placed.frame, view.suns.back(),
                               radiance_unit(world));
  }
  view.lamps = trace_lamps(world, camera, scene.rays());
  view.path = {world.lamps().empty() ? nullptr : &view.lamps, 0, options.flat, world.white()};
  const std::uint32_t width = wide.width;
  std::vector<Vec3> first(marks.size(), Vec3(0));
  const auto each = [&](const auto& use) {
    parallel_for(
        wide.height,
        [&](std::size_t row) {
          for (std::uint32_t column = 0; column < width; ++column)
            if (marks[row * width + column] != 0) use(column, static_cast<std::uint32_t>(row));
        },
        job);
  };
  each([&](std::uint32_t column, std::uint32_t row) {
    first[row * std::size_t{width} + column] = view.pixel(column, row, 1);
  });
  image::Image layer;
  layer.width = wide.width;
  layer.height = wide.height;
  layer.radiance.resize(3 * layer.pixels());
  const double step = kStep * mean(world.white()) / kPi;
  each([&](std::uint32_t column, std::uint32_t row) {
    const std::size_t pixel = row * std::size_t{width} + column;
    const Vec3 light =
        differs(first, width, pixel, step) ? view.pixel(column, row, kMore) : first[pixel];
    for (std::size_t k = 0; k < 3; ++k)
      layer.radiance[3 * pixel + k] = static_cast<float>(light[static_cast<int>(k)]);
  });
  if (options.psf_sigma > 0) blur(layer, options.psf_sigma, margin, job);
  for (std::size_t row = 0; row < camera.height; ++row)
    for (std::size_t i = 0; i < 3 * std::size_t{camera.width}; ++i)
      image.radiance[3 * row * camera.width + i] +=
          layer.radiance[3 * ((row + margin) * width + margin) + i];
}

}  // namespace panwright::preview::reference
