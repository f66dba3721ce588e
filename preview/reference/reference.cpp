#include "preview/reference/reference.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "base/clock.h"
#include "base/parallel.h"
#include "materials/material.h"
#include "pan/model.h"
#include "preview/reference/internal/backdrop.h"
#include "preview/reference/internal/batches.h"
#include "preview/reference/internal/bodies.h"
#include "preview/reference/internal/mirror_pass.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview {
namespace {

using namespace reference;

constexpr std::uint32_t kMaxReferenceSide = 16384;
// enough to know an error to an eighth
constexpr std::uint32_t kLeastBatches = 32;
constexpr std::uint32_t kFewestBatches = 8;
// samples of a batch with until_error: fewer would cost more in threads than in rays
constexpr double kRoundWork = 8192;
constexpr double kWidestPsf = 64;  // pixels
// bytes for each pixel that a target may fall on, while it is rendered
constexpr std::uint64_t kPixelBytes = 260;

[[maybe_unused]] bool is_sound_request(const world::Camera& camera,
                                       const ReferenceOptions& options) {
  const auto unit = [](const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; };
  return camera.width > 0 && camera.height > 0 && camera.focal.x > 0 && camera.focal.y > 0 &&
         std::isfinite(camera.focal.x + camera.focal.y) && is_finite(camera.position) &&
         std::isfinite(camera.principal.x + camera.principal.y) && unit(camera.world_from_camera) &&
         options.samples >= kFewestBatches && options.until_error >= 0 && options.psf_sigma >= 0 &&
         options.psf_sigma <= kWidestPsf;
}

// the largest grid of powers of two with at most this many samples
void set_grid(ViewSamples& view, double samples) {
  while (2.0 * view.batch_samples() <= samples && view.batch_samples() < 1u << 20)
    (view.columns == view.rows ? view.columns : view.rows) *= 2;
}

// The largest relative standard error of the channels that have any light; 0: none has.
double relative_error(const Batches& batches) {
  const Vec3 error = batches.total().error(0, batches.batches());
  double result = 0;
  for (int k = 0; k < 3; ++k) {
    const double flux = batches.total().mean(0)[k];
    if (flux > 0) result = std::max(result, error[k] / flux);
  }
  return result;
}

constexpr std::uint32_t kSlices = 16;  // of what is added at once, for a terminal to show

void add_in_slices(Batches& batches, std::uint32_t count) {
  Phase phase(batches.job, "tracing", count);
  const std::uint32_t slice = std::max(1u, count / kSlices);
  for (std::uint32_t left = count; left > 0;) {
    const std::uint32_t some = std::min(left, slice);
    batches.add(some);
    left -= some;
    phase.advance(some);
  }
}

// Adds batches until the total is as good as it is wanted. Whether to go on is asked a few times
// only, after 32 batches and more, so that it hardly favours batches that agree by chance.
void refine(Batches& batches, const ViewSamples& view, const ReferenceOptions& options,
            DiagnosticLog& log) {
  const std::uint64_t most =
      std::max<std::uint64_t>(batches.batches(), options.max_samples / view.batch_samples());
  constexpr double kParts = 1000;
  Phase phase(batches.job, "tracing", static_cast<std::uint64_t>(kParts));
  double shown = 0;
  for (;;) {
    const double error = relative_error(batches);
    if (!(error > options.until_error)) return;
    if (batches.batches() >= most) {
      log.report_file(Code("W5008"), {},
                      fmt::format("the relative error of the flux is {:.2g} after {} samples per "
                                  "pixel, expected {:.2g}",
                                  error, std::uint64_t{batches.batches()} * view.batch_samples(),
                                  options.until_error));
      return;
    }
    const double ratio = error / options.until_error;
    const double wanted = batches.batches() * (1.1 * ratio * ratio - 1) + 1;
    const double step = std::clamp(wanted, 4.0, 3.0 * batches.batches());
    auto left = static_cast<std::uint32_t>(
        std::min<double>(step, static_cast<double>(most - batches.batches())));
    // errors fall with the square root of the batches
    const double all = batches.batches() * ratio * ratio;
    const std::uint32_t slice = std::max(1u, left / kSlices);
    while (left > 0) {
      const std::uint32_t some = std::min(left, slice);
      batches.add(some);
      left -= some;
      const double done = std::floor(std::min(1.0, batches.batches() / all) * kParts);
      phase.advance(static_cast<std::uint64_t>(std::max(0.0, done - shown)));
      shown = std::max(shown, done);
    }
  }
}

// what lies at the pixels' centres
void trace_ground_truth(const TraceScene& scene, const world::Camera& camera, bool flat,
                        image::Image& image, const Job& job) {
  reset_ground_truth(image);
  const auto trace_row = [&](std::size_t row) {
    for (std::uint32_t column = 0; column < image.width; ++column) {
      const auto seen = view_ray(camera, {column + 0.5, static_cast<double>(row) + 0.5});
      if (!seen) continue;
      const trace::Ray ray{*seen};
      const auto hit = scene.seen(ray);
      if (!hit) continue;
      const trace::Scene::Placed& placed = scene.rays().targets()[hit->target];
      const std::size_t pixel = row * image.width + column;
      // the ray is of unit length: its part along the boresight is the depth's. A pupil that moves
      // starts it off the plane of the camera
      image.range[pixel] = static_cast<float>(hit->distance);
      image.depth[pixel] = static_cast<float>(ray.origin.z + hit->distance * ray.direction.z);
      const Vec3 normal = placed.frame.world_from * placed.target->normal(*hit, flat);
      for (std::size_t k = 0; k < 3; ++k)
        image.normal[3 * pixel + k] = static_cast<float>(normal[static_cast<int>(k)]);
      const trace::Ids ids = scene.rays().ids(*hit);
      image.node_id[pixel] = ids.node;
      image.material_id[pixel] = ids.material;
      image.target_id[pixel] = ids.target;
    }
  };
  parallel_for(image.height, trace_row, job);
}

// Traces the samples of all cells and writes their means and errors.
//
//   margin  pixels of blur around the camera's image
void add_samples(ViewSamples& view, std::span<const Cell> cells, const world::Camera& camera,
                 std::uint32_t margin, const ReferenceOptions& options, ReferenceImage& result,
                 DiagnosticLog& log, const Job& job) {
  double each = options.samples / static_cast<double>(kLeastBatches);
  if (options.until_error > 0)
    each = std::clamp(kRoundWork / static_cast<double>(cells.size()), each,
                      std::max<double>(each, options.max_samples / kLeastBatches));
  set_grid(view, each);
  const auto weight = [&](std::uint32_t column, std::uint32_t row) {
    return pixel_weight(camera, column, row);
  };
  std::unique_ptr<Batches> batches;
  if (margin > 0) {
    batches = blurred_batches(view, cells, options.psf_sigma, margin, weight);
  } else {
    std::vector<double> weights;
    for (const Cell& cell : cells) weights.push_back(weight(cell.column, cell.row));
    batches = box_batches(view, cells, std::move(weights));
  }
  batches->job = job;
  const std::uint32_t wanted = (options.samples + view.batch_samples() - 1) / view.batch_samples();
  const bool until = options.until_error > 0;
  add_in_slices(*batches, std::max(wanted, until ? kLeastBatches : kFewestBatches));
  if (until) refine(*batches, view, options, log);
  batches->write(result);
  result.batches = batches->batches();
  result.samples = std::uint64_t{batches->batches()} * view.batch_samples() * cells.size();
  result.flux = Vec3(batches->total().mean(0));
  result.flux_error = batches->total().error(0, batches->batches());
  result.camera_rays = batches->counts().camera;
  result.shadow_rays = batches->counts().shadow;
  result.bounce_rays = batches->counts().bounce;
}

// Why an image is empty.
const char* empty_because(const world::World& world, const trace::Scene& scene,
                          std::span<const Cell> cells) {
  if (world.empty()) return "nothing is in view: the world has no targets";
  if (scene.visible().empty()) return "nothing is in view: all targets are hidden or empty";
  if (cells.empty()) return "nothing is in view: no part of the model lies inside the image";
  return "nothing is in view: the camera may be inside a closed mesh, visible from outside only";
}

}  // namespace

struct Reference::Impl {
  TraceScene scene{true};
};

Reference::Reference() : impl_(std::make_unique<Impl>()) {}
Reference::Reference(Reference&&) noexcept = default;
Reference& Reference::operator=(Reference&&) noexcept = default;
Reference::~Reference() = default;

void Reference::prepare(const world::World& world, const Job& job) {
  impl_->scene.update(world, job);
}

const trace::Work& Reference::work() const { return impl_->scene.rays().work(); }

Result<ReferenceImage> Reference::render(const world::World& world, const world::Camera& camera,
                                         const ReferenceOptions& options, DiagnosticLog& log,
                                         const Job& job) {
  return run_job(job, log, [&] { return rendered(world, camera, options, log, job); });
}

bool Reference::add_ground_truth(const world::World& world, const world::Camera& camera, bool flat,
                                 image::Image& image, DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&] {
    impl_->scene.update(world, job);
    impl_->scene.place_camera(camera);
    trace_ground_truth(impl_->scene, camera, flat, image, job);
    return true;
  });
}

bool has_mirrors(const world::World& world) {
  return std::ranges::any_of(world.instances(), [](const world::Instance& target) {
    return std::ranges::any_of(target.model()->materials(), [](const auto& record) {
      const materials::Material material = pan::material_from(record, {});
      return materials::narrowest_slope(material, materials::Lobes::about_normal) == 0.0;
    });
  });
}

bool Reference::add_mirrored(const world::World& world, const world::Camera& camera,
                             const MirrorOptions& options, image::Image& image, DiagnosticLog& log,
                             const Job& job) {
  return run_job(job, log, [&] {
    impl_->scene.update(world, job);
    impl_->scene.place_camera(camera);
    reference::add_mirrored(impl_->scene, world, camera, options, image, job);
    return true;
  });
}

std::vector<std::uint8_t> Reference::hidden(const world::World& world, const world::Camera& camera,
                                            std::span<const Vec3> points,
                                            std::span<const double> beside, const Job& job) {
  assert(points.size() == beside.size());
  impl_->scene.update(world, job);
  impl_->scene.place_camera(camera);
  std::vector<trace::Ray> rays;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 to = glm::conjugate(camera.world_from_camera) * (points[i] - camera.position);
    const double distance = glm::length(to);
    rays.push_back({{Vec3(0), distance > 0 ? to / distance : Vec3(0, 0, 1), 0,
                     std::max(distance - beside[i], 0.0)},
                    trace::Ray::kObserver});
  }
  std::vector<std::uint8_t> found(rays.size());
  impl_->scene.rays().any(rays, found, trace::Insides::pass, job);
  return found;
}

Result<ReferenceImage> Reference::rendered(const world::World& world, const world::Camera& camera,
                                           const ReferenceOptions& options, DiagnosticLog& log,
                                           const Job& job) {
  assert(is_sound_request(camera, options));
  if (camera.width > kMaxReferenceSide || camera.height > kMaxReferenceSide) {
    log.report_file(Code("E5003"), {},
                    fmt::format("an image of {} by {} pixels, expected at most {} a side",
                                camera.width, camera.height, kMaxReferenceSide));
    return failed;
  }
  const std::uint32_t margin = options.psf_sigma > 0 ? blur_margin(options.psf_sigma) : 0;
  world::Camera wide = camera;
  wide.width += 2 * margin;
  wide.height += 2 * margin;
  wide.principal += static_cast<double>(margin);
  TraceScene& scene = impl_->scene;
  scene.update(world, job);
  const auto start = std::chrono::steady_clock::now();
  scene.place_camera(camera);

  ReferenceImage result;
  image::Image& image = result.image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  const std::vector<Cell> cells = cells_of(scene.rays(), wide);
  const std::uint64_t bytes =
      image.pixels() * (options.ground_truth ? 60 : 28) + cells.size() * kPixelBytes;
  if (bytes > options.max_bytes) {
    log.report_file(
        Code("E5003"), {},
        fmt::format("an image of {} by {} pixels takes {:.4g} GB of memory; the limit is {:.4g} GB",
                    camera.width, camera.height, static_cast<double>(bytes) / 1e9,
                    static_cast<double>(options.max_bytes) / 1e9),
        "--max-image-memory allows more");
    return failed;
  }
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  result.standard_error.resize(3 * image.pixels());

  std::vector<Sun> suns;
  for (const trace::Scene::Placed& placed : scene.rays().targets())
    suns.emplace_back(world.sun(), placed.frame.world_from, options.sun_disc);
  std::vector<Bodies> bodies;
  if (!world.bodies().empty()) {
    const auto targets = scene.rays().targets();
    for (std::size_t i = 0; i < targets.size(); ++i)
      bodies.emplace_back(world.bodies(), targets[i].frame, suns[i], radiance_unit(world));
    const trace::RigidFrame& observer = scene.rays().observer();
    bodies.emplace_back(world.bodies(), observer,
                        Sun(world.sun(), observer.world_from, options.sun_disc),
                        radiance_unit(world));
  }
  const TraceLamps lamps = trace_lamps(world, camera, scene.rays());
  ViewSamples view{
      scene,
      suns,
      bodies,
      wide,
      {world.lamps().empty() ? nullptr : &lamps, options.bounces, options.flat, world.white()},
      options.seed};
  if (!cells.empty()) add_samples(view, cells, camera, margin, options, result, log, job);
  if (world.has_sky()) add_backdrop(world, scene, camera, cells, options, result, job);
  if (options.ground_truth) trace_ground_truth(scene, camera, options.flat, image, job);
  if (std::all_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code("W5006"), {}, empty_because(world, scene.rays(), cells));
  scene.rays().report_damaged(log);
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace panwright::preview
