#include "preview/reference/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "base/progress.h"
#include "preview/internal/truth.h"
#include "preview/reference/internal/rounds.h"

namespace panwright::preview {
namespace {

using namespace reference;

constexpr std::uint32_t kMaxSide = 16384;
// enough to know an error to an eighth
constexpr std::uint32_t kLeastRounds = 32;
constexpr std::uint32_t kFewestRounds = 8;
// samples of a round with until_error: fewer would cost more in threads than in rays
constexpr double kRoundWork = 8192;
constexpr double kWidestPsf = 64;  // pixels
// bytes for each pixel that the model may fall on, while it is rendered
constexpr std::uint64_t kPixelBytes = 200;

[[maybe_unused]] bool is_sound(const View& view, const ReferenceOptions& options) {
  const world::Camera& camera = view.camera;
  const auto unit = [](const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; };
  return camera.width > 0 && camera.height > 0 && camera.focal.x > 0 && camera.focal.y > 0 &&
         std::isfinite(camera.focal.x + camera.focal.y) && is_finite(camera.position) &&
         std::isfinite(camera.principal.x + camera.principal.y) && unit(camera.world_from_camera) &&
         unit(view.world_from_model.rotation) && is_finite(view.world_from_model.translation) &&
         is_finite(view.to_sun) && view.to_sun != Vec3(0) && view.sun_distance > 0 &&
         options.samples >= kFewestRounds && options.until_error >= 0 &&
         options.limb_darkening >= 0 && options.limb_darkening <= 1 && options.psf_sigma >= 0 &&
         options.psf_sigma <= kWidestPsf;
}

// the largest grid of powers of two with at most this many samples
void set_grid(Shot& shot, double samples) {
  while (2.0 * shot.round_samples() <= samples && shot.round_samples() < 1u << 20)
    (shot.columns == shot.rows ? shot.columns : shot.rows) *= 2;
}

// Of a pixel in the total flux.
double weight_of(const world::Camera& camera, std::uint32_t column, std::uint32_t row) {
  return camera.projection == world::Projection::perspective
             ? pixel_solid_angle(camera, column, row)
             : pixel_area(camera);
}

// The largest relative standard error of the channels that have any light; 0: none has.
double relative_error(const Rounds& rounds) {
  const Vec3 error = rounds.total().error(0, rounds.rounds());
  double result = 0;
  for (int k = 0; k < 3; ++k) {
    const double flux = rounds.total().mean(0)[k];
    if (flux > 0) result = std::max(result, error[k] / flux);
  }
  return result;
}

// Adds rounds until the total is as good as it is wanted. Whether to go on is asked a few times
// only, after 32 rounds and more, so that it hardly favours rounds that agree by chance.
void refine(Rounds& rounds, const Shot& shot, const ReferenceOptions& options, DiagnosticLog& log) {
  const std::uint64_t most =
      std::max<std::uint64_t>(rounds.rounds(), options.max_samples / shot.round_samples());
  constexpr std::uint32_t kSlices = 16;  // of what is added at once, for a terminal to show
  constexpr double kParts = 1000;
  Progress progress("tracing", static_cast<std::size_t>(kParts));
  double shown = 0;
  for (;;) {
    const double error = relative_error(rounds);
    if (!(error > options.until_error)) return;
    if (rounds.rounds() >= most) {
      log.report_file(Code::W5008, {},
                      fmt::format("the flux is known to {:.2g} of itself after {} samples a pixel; "
                                  "{:.2g} was wanted",
                                  error, std::uint64_t{rounds.rounds()} * shot.round_samples(),
                                  options.until_error));
      return;
    }
    const double ratio = error / options.until_error;
    const double wanted = rounds.rounds() * (1.1 * ratio * ratio - 1) + 1;
    const double step = std::clamp(wanted, 4.0, 3.0 * rounds.rounds());
    auto left = static_cast<std::uint32_t>(
        std::min<double>(step, static_cast<double>(most - rounds.rounds())));
    // errors fall with the square root of the rounds
    const double all = rounds.rounds() * ratio * ratio;
    const std::uint32_t slice = std::max(1u, left / kSlices);
    while (left > 0) {
      const std::uint32_t some = std::min(left, slice);
      rounds.add(some);
      left -= some;
      const double done = std::floor(std::min(1.0, rounds.rounds() / all) * kParts);
      progress.advance(static_cast<std::size_t>(std::max(0.0, done - shown)));
      shown = std::max(shown, done);
    }
  }
}

}  // namespace

struct Reference::Impl {
  explicit Impl(const pan::Model& model_in) : model(model_in), stage(model_in) {}

  Shot shot_for(const View& view, const world::Camera& camera, const Sun& sun,
                const ReferenceOptions& options) const;
  void add_truth(const View& view, const Shot& shot, bool flat, Image& image) const;

  const pan::Model& model;
  Stage stage;
};

Reference::Reference(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reference::Reference(Reference&&) noexcept = default;
Reference& Reference::operator=(Reference&&) noexcept = default;
Reference::~Reference() = default;

Result<Reference> Reference::create(const pan::Model& model, DiagnosticLog&) {
  assert(model.checked());
  return Reference(std::make_unique<Impl>(model));
}

Shot Reference::Impl::shot_for(const View& view, const world::Camera& camera, const Sun& sun,
                               const ReferenceOptions& options) const {
  const Quat model_from_world = glm::conjugate(view.world_from_model.rotation);
  Shot shot{stage, sun, camera, Vec3(0), Mat3(1), {}};
  // note: the difference first, so that large translations cancel once
  shot.eye = model_from_world * (camera.position - view.world_from_model.translation);
  shot.model_from_camera = glm::mat3_cast(model_from_world * camera.world_from_camera);
  shot.path = {options.bounces, options.flat};
  shot.seed = options.seed;
  return shot;
}

// what lies at the pixels' centres
void Reference::Impl::add_truth(const View& view, const Shot& shot, bool flat, Image& image) const {
  image.depth.resize(image.pixels(), INFINITY);
  image.range.resize(image.pixels(), INFINITY);
  image.normal.resize(3 * image.pixels());
  image.target_id.resize(image.pixels());
  image.node_id.resize(image.pixels());
  image.material_id.resize(image.pixels());
  Scenery seen = scenery(view, stage.items());
  const TruthTarget target =
      truth_target(model, stage.items(), {0, 0, std::move(seen.items), std::move(seen.boxes)},
                   view.world_from_model);
  constexpr std::uint32_t kBand = 64;  // rows
  std::vector<TriangleId> ids;
  for (std::uint32_t top = 0; top < image.height; top += kBand) {
    const Tile tile{0, top, image.width, std::min(kBand, image.height - top)};
    ids.assign(std::size_t{tile.width} * tile.height, {});
    parallel_for(tile.height, [&](std::size_t row) {
      for (std::uint32_t column = 0; column < tile.width; ++column) {
        const Vec2 centre(column + 0.5, static_cast<double>(top + row) + 0.5);
        const auto hit = stage.seen(ray_through(shot, centre));
        if (hit) ids[row * tile.width + column] = {hit->instance + 1, hit->triangle};
      }
    });
    fill_truth(view.camera, flat, std::span(&target, 1), tile, ids, image);
  }
}

Result<ReferenceImage> Reference::render(const View& view, const ReferenceOptions& options,
                                         DiagnosticLog& log) const {
  assert(is_sound(view, options));
  const auto start = std::chrono::steady_clock::now();
  const world::Camera& camera = view.camera;
  if (camera.width > kMaxSide || camera.height > kMaxSide) {
    log.report_file(Code::E5003, {},
                    fmt::format("an image of {} by {} pixels; a side may have {}", camera.width,
                                camera.height, kMaxSide));
    return failed;
  }
  const std::uint32_t margin = options.psf_sigma > 0 ? blur_margin(options.psf_sigma) : 0;
  View wide = view;
  wide.camera.width += 2 * margin;
  wide.camera.height += 2 * margin;
  wide.camera.principal += static_cast<double>(margin);

  ReferenceImage result;
  Image& image = result.image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = view.sun_irradiance ? "W/(m^2 sr)" : "1/sr";
  const std::vector<Cell> cells = cells_of(impl_->model, wide, impl_->stage.items());
  const std::uint64_t bytes =
      image.pixels() * (options.truth ? 56 : 28) + cells.size() * kPixelBytes;
  if (bytes > options.max_bytes) {
    log.report_file(
        Code::E5003, {},
        fmt::format("an image of {} by {} pixels takes {:.4g} MiB; the limit is {:.4g} MiB",
                    camera.width, camera.height, static_cast<double>(bytes) / 0x1p20,
                    static_cast<double>(options.max_bytes) / 0x1p20));
    return failed;
  }
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  result.standard_error.resize(3 * image.pixels());

  const Mat3 model_from_world = glm::mat3_cast(glm::conjugate(view.world_from_model.rotation));
  const Sun sun(view, model_from_world, options.sun_disc, options.limb_darkening);
  Shot shot = impl_->shot_for(view, wide.camera, sun, options);
  if (!cells.empty()) {
    double each = options.samples / static_cast<double>(kLeastRounds);
    if (options.until_error > 0)
      each = std::clamp(kRoundWork / static_cast<double>(cells.size()), each,
                        std::max<double>(each, options.max_samples / kLeastRounds));
    set_grid(shot, each);
    const auto weight = [&](std::uint32_t column, std::uint32_t row) {
      return weight_of(camera, column, row);
    };
    std::unique_ptr<Rounds> rounds;
    if (margin > 0) {
      rounds = blurred_rounds(shot, cells, options.psf_sigma, margin, weight);
    } else {
      std::vector<double> weights;
      for (const Cell& cell : cells) weights.push_back(weight(cell.column, cell.row));
      rounds = box_rounds(shot, cells, std::move(weights));
    }
    const std::uint32_t wanted =
        (options.samples + shot.round_samples() - 1) / shot.round_samples();
    const bool until = options.until_error > 0;
    rounds->add(until ? std::max(wanted, kLeastRounds) : std::max(wanted, kFewestRounds));
    if (until) refine(*rounds, shot, options, log);
    rounds->write(result);
    result.rounds = rounds->rounds();
    result.samples = std::uint64_t{rounds->rounds()} * shot.round_samples() * cells.size();
    result.flux = Vec3(rounds->total().mean(0));
    result.flux_error = rounds->total().error(0, rounds->rounds());
    result.camera_rays = rounds->counts().camera;
    result.shadow_rays = rounds->counts().shadow;
    result.bounce_rays = rounds->counts().bounce;
  }
  if (options.truth) {
    const Shot plain = impl_->shot_for(view, camera, sun, options);
    impl_->add_truth(view, plain, options.flat, image);
  }
  if (std::all_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code::W5006, {},
                    cells.empty() ? "nothing is in view: no part of the model lies inside the image"
                                  : "nothing is in view: the camera may be inside a closed mesh, "
                                    "which shows its outside only");
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace panwright::preview
