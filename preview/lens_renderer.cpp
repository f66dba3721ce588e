#include "preview/lens_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "preview/frame/imposters.h"
#include "preview/frame/lens_splat.h"
#include "preview/frame/lens_views.h"
#include "preview/frame/texel_areas.h"
#include "world/lamps.h"

namespace panwright::preview {
namespace {

// Of one view.
constexpr double kMostViewTexels = 1 << 23;
// Of a small target's view, along a side.
constexpr std::uint32_t kMostSide = 2044;
// Targets up to so many pixels have views of their own, as imposters do.
constexpr double kSmallTarget = 100;
// Texels a pixel with samples = 0 at first, and at most: drawn once more, finer, if resampling
// takes more than its share of the requested error.
constexpr double kFirstRate = 1.5;
constexpr double kMostRate = 8;
constexpr double kBlurShare = 0.6;
constexpr double kSampledShare = 0.75;
// An error of pixels that asks for two texels at first.
constexpr double kSmallError = 0.02;
// Largest texels a pixel of a given number of samples; beyond, texels have several.
constexpr unsigned kMostGivenRate = 8;
// Sum of squared errors of pixels, in parts of that of neighbours' differences, times rate³: of an
// edge at any place of a pixel (docs/accuracy/lenses.md).
constexpr double kBlur = 1.0 / 107;
// Of a small target whose errors are too large, what is aimed at.
constexpr double kSmallAim = 0.5;

// Texels a pixel, and samples a texel, along a side.
struct Density {
  double rate = 2;
  unsigned samples = 1;
};
Density density_of(const RenderOptions& options) {
  if (options.samples == 0) return {options.pixel_error < kSmallError ? 2 : kFirstRate, 0};
  if (options.adaptive) {
    const double samples = std::ceil(options.samples / kFirstRate);
    return {kFirstRate, static_cast<unsigned>(samples)};
  }
  const unsigned samples = (options.samples + kMostGivenRate - 1) / kMostGivenRate;
  const unsigned rate = (options.samples + samples - 1) / samples;
  return {std::max(kFirstRate, static_cast<double>(rate)), samples};
}

bool has_own_views(const RenderOptions& options) {
  return options.imposters != Imposters::off &&
         (options.imposters == Imposters::always || options.samples == 0 ||
          options.imposter_pixels.has_value());
}

AxisRectangle rectangle_of(const Tile& tile) {
  const Vec2 low(tile.x, tile.y);
  return {low, low + Vec2(tile.width, tile.height)};
}

bool share_area(const AxisRectangle& a, const AxisRectangle& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

// Targets that share a view of their own.
struct Small {
  std::vector<std::uint32_t> targets;
  AxisRectangle area{};  // pixels
  bool alone = true;     // no other target may be visible on its pixels
  bool tried = false;    // larger: kept only if its pixels meet the requested error
  double error = 0;      // of the flux, estimated
  std::optional<LensView> view{};
  image::Image texels{};
  double rate = 0;  // texels a pixel
  double seconds = 0;
};

double light_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.radiance) sum += static_cast<double>(value);
  return sum;
}

double squares_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.radiance)
    sum += static_cast<double>(value) * static_cast<double>(value);
  return sum / 3;
}

}  // namespace

struct LensRenderer::Frame {
  Renderer& renderer;
  const world::World& world;
  const world::Camera& camera;
  const RenderOptions& options;
  DiagnosticLog& log;
  const Job& job;
  image::Image image{};
  std::vector<AxisRectangle> areas{};  // of the targets, pixels; empty: not visible
  std::vector<Small> small{};
  AxisRectangle rest{};         // of the other targets
  Density density{};            // of them
  double squares = 0, sum = 0;  // errors of samples in pixels, absolute

  void find_targets(const world::Evaluation& evaluation);
  void find_small();
  void merge_small();
  AxisRectangle pixels_of(const AxisRectangle& area) const {
    return rectangle_of(touched_pixels(camera, area));
  }
  void tell(const DiagnosticLog& apart);
  Result<image::Image> draw(const world::Camera& view, const RenderOptions& own,
                            SamplingReport& report);
};

// What views report, once; that one of them is empty matters to none.
void LensRenderer::Frame::tell(const DiagnosticLog& apart) {
  for (const Diagnostic& each : apart.entries()) {
    if (each.code == Code("W5006")) continue;
    const auto& known = log.entries();
    if (std::none_of(known.begin(), known.end(), [&](const Diagnostic& one) {
          return one.code == each.code && one.message == each.message;
        }))
      log.report_file(each.code, {}, each.message, each.hint);
  }
}

void LensRenderer::Frame::find_targets(const world::Evaluation& evaluation) {
  const AxisRectangle whole = rectangle_of({0, 0, camera.width, camera.height});
  for (std::size_t i = 0; i < world.size(); ++i) {
    AxisRectangle area;
    if (evaluation[i].bounds) area = lens_area(camera, world[i].pose(), *evaluation[i].bounds);
    areas.push_back(!area.empty() && share_area(area, whole) ? area : AxisRectangle{});
  }
}

// Targets of a few pixels; those whose pixels overlap share a view. A larger one is tried if it
// shares no pixel.
void LensRenderer::Frame::find_small() {
  constexpr double kLargest = kMostSide / kImposterRate;
  const double most = options.imposters == Imposters::always
                          ? kLargest
                          : std::min(kLargest, options.imposter_pixels.value_or(kSmallTarget));
  const bool tries = options.imposters == Imposters::automatic && !options.imposter_pixels;
  if (has_own_views(options))
    for (std::uint32_t i = 0; i < areas.size(); ++i)
      if (!areas[i].empty() && areas[i].longest() > 0 && areas[i].longest() <= most)
        small.push_back({{i}, areas[i]});
  merge_small();
  std::erase_if(small, [&](const Small& one) { return one.area.longest() > most; });
  std::vector<bool> own(areas.size());
  for (const Small& one : small)
    for (const std::uint32_t i : one.targets) own[i] = true;
  const std::size_t settled = small.size();
  for (std::uint32_t i = 0; i < areas.size(); ++i) {
    if (own[i] || areas[i].empty()) continue;
    const auto overlaps = [&](const AxisRectangle& area) {
      return share_area(pixels_of(area), pixels_of(areas[i]));
    };
    std::size_t others = 0;  // itself included
    for (const AxisRectangle& area : areas) others += !area.empty() && overlaps(area);
    for (std::size_t k = 0; k < settled; ++k)
      small[k].alone = small[k].alone && !overlaps(small[k].area);
    if (tries && has_own_views(options) && others == 1 && areas[i].longest() <= kLargest)
      small.push_back({.targets = {i}, .area = areas[i], .tried = true});
    else
      rest.add(areas[i]);
  }
}

void LensRenderer::Frame::merge_small() {
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < small.size(); ++i)
      for (std::size_t k = small.size(); k-- > i + 1;) {
        if (!share_area(pixels_of(small[i].area), pixels_of(small[k].area))) continue;
        small[i].area.add(small[k].area);
        small[i].targets.insert(small[i].targets.end(), small[k].targets.begin(),
                                small[k].targets.end());
        small.erase(small.begin() + static_cast<std::ptrdiff_t>(k));
        merged = true;
      }
  }
}

Result<image::Image> LensRenderer::Frame::draw(const world::Camera& view, const RenderOptions& own,
                                               SamplingReport& report) {
  DiagnosticLog apart = log.apart();
  auto drawn = renderer.render(world, view, own, apart, job);
  tell(apart);
  report = renderer.sampling();
  return drawn;
}

const char* LensRenderer::refused(const world::Camera& camera) {
  if (camera.distortion == nullptr) return nullptr;
  const auto* cahvore = std::get_if<sensor::Cahvore>(&camera.distortion->distortion());
  return cahvore != nullptr && cahvore->e != decltype(cahvore->e){}
             ? "a lens whose pupil moves (CAHVORE with e) requires --engine reference"
             : nullptr;
}

// All targets without a view of their own.
bool LensRenderer::draw_rest(Frame& frame) {
  const Tile whole = touched_pixels(frame.camera, frame.rest);
  if (whole.width == 0 || whole.height == 0) return true;
  const Density& density = frame.density;
  std::vector<LensPart> parts;
  if (!divide(frame.camera, whole, density.rate, kMostViewTexels, parts)) {
    frame.log.report_file(Code("E5003"), {},
                          "a few pixels of the lens see a wider field than a view can have",
                          "--engine reference draws any lens");
    return false;
  }
  RenderOptions own = frame.options;
  own.samples = density.samples;
  own.adaptive = frame.options.adaptive && density.samples > 1;
  own.imposters = Imposters::off;
  own.imposter_pixels.reset();
  own.psf_sigma = 0;
  own.ground_truth = false;
  own.level_pixels = density.rate;
  // errors of texels are independent
  own.pixel_error = kSampledShare * density.rate * frame.options.pixel_error;
  for (const LensPart& part : parts) {
    own.work = frame.options.work / static_cast<double>(parts.size());
    SamplingReport report;
    auto texels = frame.draw(part.view.camera, own, report);
    if (!texels) return false;
    LensLight light{part.part, 1, {}};
    splat(frame.camera, part.view, *texels, light);
    put(light, 0, frame.image);
    const double per_pixel = 1 / (density.rate * density.rate);
    report_.samples += report.samples * static_cast<double>(texels->pixels()) /
                       static_cast<double>(frame.image.pixels());
    if (report.rmse != kNothingLit) {
      // the texels that make up a pixel, and their independent errors
      frame.squares += report.rmse * report.rmse * squares_of(*texels) * per_pixel * per_pixel;
      frame.sum += report.flux * light_of(*texels) * per_pixel / density.rate;
    }
    report_.limited = report_.limited || report.limited;
    report_.shadow_edge = std::max(report_.shadow_edge, report.shadow_edge / density.rate);
    report_.penumbra = std::max(report_.penumbra, report.penumbra / density.rate);
    report_.sun_points = std::max(report_.sun_points, report.sun_points);
    report_.sun_error = std::max(report_.sun_error, report.sun_error);
    report_.programs += report.programs;
    report_.program_seconds += report.program_seconds;
    frame.renderer.recycle(*std::move(texels));
  }
  return true;
}

// Draws the texels of small targets; once more if their estimated errors are too large. No view is
// left if the pixels of a tried one stay so.
bool LensRenderer::draw_texels(Frame& frame, std::size_t index) {
  Small& small = frame.small[index];
  const auto start = std::chrono::steady_clock::now();
  const RenderOptions& options = frame.options;
  // where others may be visible, the view shows whole pixels
  const AxisRectangle area = small.alone ? small.area : frame.pixels_of(small.area);
  const double extent = area.longest();
  const double flux_asked = flux_error_asked(options, small.tried);
  double texels = std::max<double>(texels_for(flux_asked), kImposterRate * extent);
  RenderOptions own = options;
  own.samples = 1;
  own.adaptive = false;
  own.specular_filter = false;  // texels are many, and their grid is turned
  own.imposters = Imposters::off;
  own.imposter_pixels.reset();
  own.psf_sigma = 0;
  own.ground_truth = false;
  if (options.shadows == Shadows::automatic && options.samples == 0) own.shadows = Shadows::soft;
  constexpr unsigned kSunPoints = 8;
  own.sun_points = std::min(options.sun_points, kSunPoints);
  for (int draw = 0; draw < 2; ++draw) {
    texels = std::min<double>(texels, kMostSide);
    small.rate = texels / extent;
    NoView why = NoView::none;
    small.view = lens_view(frame.camera, area, small.rate, LensTurn::golden, why);
    if (!small.view) return true;
    const world::Camera& view = small.view->camera;
    if (static_cast<double>(view.width) * view.height > kMostViewTexels) {
      small.view.reset();
      return true;
    }
    own.level_pixels = small.rate;
    SamplingReport report;
    auto image = frame.draw(view, own, report);
    if (!image) return false;
    report_.samples +=
        static_cast<double>(image->pixels()) / static_cast<double>(frame.image.pixels());
    report_.programs += report.programs;
    report_.program_seconds += report.program_seconds;
    small.error = flux_error_of(*image);
    small.texels = *std::move(image);
    double over = small.error / flux_asked;
    if (small.tried) {
      const double pixels_over =
          pixel_error_of(small.texels, small.error, small.rate) / options.pixel_error;
      if (pixels_over > (draw > 0 ? 1 : std::pow(kMostSide / texels, 1.5))) {
        small.view.reset();
        return true;
      }
      over = std::max(over, pixels_over);
    }
    if (over <= 1 || texels >= kMostSide) break;
    texels = std::ceil(std::pow(over / kSmallAim, 2.0 / 3.0) * texels);
  }
  small.seconds = seconds_since(start);
  return true;
}

// Adds small targets to the image.
void LensRenderer::add_small(Frame& frame) {
  constexpr double kMostCells = 1024;
  const double sigma = frame.options.psf_sigma;
  for (const Small& small : frame.small) {
    if (sigma > 0) clear(touched_pixels(frame.camera, small.area), frame.image);
    const bool lit = light_of(small.texels) > 0;
    report_.imposters.push_back({small.targets, small.area.longest(), small.texels.width,
                                 small.texels.height, lit ? small.error : kNothingLit,
                                 small.seconds, flux_error_asked(frame.options, small.tried)});
  }
  if (sigma > 0 && !frame.rest.empty()) convolve(sigma, frame.image);
  for (const Small& small : frame.small) {
    const Tile pixels = touched_pixels(frame.camera, small.area);
    // cells for the PSF: as fine as texels
    const double cells =
        std::floor(std::min(small.rate, kMostCells / std::max(pixels.width, pixels.height)));
    LensLight light{
        pixels, sigma > 0 ? static_cast<unsigned>(std::clamp(cells, 1.0, 128.0)) : 1, {}};
    splat(frame.camera, *small.view, small.texels, light);
    put(light, sigma, frame.image);
  }
}

// Sums over the image, and the errors of resampling, from differences of neighbours.
LensRenderer::Sums LensRenderer::sums_of(const Frame& frame) {
  const image::Image& image = frame.image;
  std::vector<bool> own(image.pixels());
  for (const Small& small : frame.small) {
    const Tile part = touched_pixels(frame.camera, small.area);
    for (std::uint32_t y = part.y; y < part.y + part.height; ++y)
      for (std::uint32_t x = part.x; x < part.x + part.width; ++x)
        own[std::size_t{y} * image.width + x] = true;
  }
  Sums sums;
  const auto add = [&](std::size_t a, std::size_t b) {
    if (own[a] || own[b]) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const double difference = static_cast<double>(image.radiance[3 * a + k]) -
                                static_cast<double>(image.radiance[3 * b + k]);
      sums.blur += difference * difference / 3;
    }
  };
  for (std::size_t y = 0; y < image.height; ++y)
    for (std::size_t x = 0; x < image.width; ++x) {
      const std::size_t at = y * image.width + x;
      if (image.coverage[at] == 0 && image.radiance[3 * at] == 0 &&
          !(x + 1 < image.width && image.coverage[at + 1] > 0) &&
          !(y + 1 < image.height && image.coverage[at + image.width] > 0))
        continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto value = static_cast<double>(image.radiance[3 * at + k]);
        sums.squares += value * value / 3;
        sums.radiance += value;
      }
      if (x + 1 < image.width) add(at, at + 1);
      if (y + 1 < image.height) add(at, at + image.width);
    }
  const double rate = frame.density.rate;
  sums.blur *= kBlur / (rate * rate * rate);
  return sums;
}

// Draws all targets without a view of their own, so finely that errors are as requested.
bool LensRenderer::draw_to_error(Frame& frame) {
  frame.density = density_of(frame.options);
  const SamplingReport before = report_;
  if (!draw_rest(frame)) return false;
  if (frame.options.samples > 0 || frame.rest.empty()) return true;
  const Sums sums = sums_of(frame);
  const double most = kBlurShare * frame.options.pixel_error;
  if (!(sums.blur > most * most * sums.squares)) return true;
  // errors of edges fall with the texels to 3/2
  const double finer = std::pow(std::sqrt(sums.blur / sums.squares) / most, 2.0 / 3.0);
  frame.density.rate = std::min(kMostRate, std::ceil(2.2 * finer * frame.density.rate) / 2);
  frame.squares = frame.sum = 0;
  const double samples = std::exchange(report_, before).samples;
  report_.samples = samples;
  return draw_rest(frame);
}

void LensRenderer::estimate(const Frame& frame) {
  if (frame.options.samples > 0 && !frame.options.adaptive) return;
  if (frame.rest.empty() && !frame.small.empty()) return;  // their errors are reported apart
  const Sums sums = sums_of(frame);
  if (!(sums.squares > 0)) {
    report_.rmse = report_.flux = kNothingLit;
    return;
  }
  report_.rmse = std::sqrt((frame.squares + sums.blur) / sums.squares);
  report_.flux = frame.sum / sums.radiance;
}

Result<image::Image> LensRenderer::render(Renderer& renderer, const world::World& world,
                                          const world::Camera& camera, const RenderOptions& options,
                                          DiagnosticLog& log, const Job& job) {
  assert(renderer.in_flight() == 0 && camera.distortion != nullptr && !refused(camera));
  report_ = {};
  constexpr std::uint32_t kMaxSide = 16384;
  const std::uint64_t bytes =
      std::uint64_t{camera.width} * camera.height * (options.ground_truth ? 48 : 16);
  if (camera.width > kMaxSide || camera.height > kMaxSide || bytes > options.max_bytes) {
    log.report_file(
        Code("E5003"), {},
        fmt::format("an image of {} by {} pixels, expected at most {} a side and {:.4g} "
                    "GB of memory",
                    camera.width, camera.height, kMaxSide,
                    static_cast<double>(options.max_bytes) / 1e9),
        "--max-image-memory allows more");
    return failed;
  }
  // lamps of the camera stay with it, wherever the views look
  world::World fixed = world;
  world::fix_lamps(fixed, camera);
  Frame frame{renderer, fixed, camera, options, log, job};
  image::Image& image = frame.image;
  image.width = camera.width;
  image.height = camera.height;
  image.unit = world.sun().irradiance ? "W/(m^2 sr)" : "1/sr";
  image.radiance.assign(3 * image.pixels(), 0.0f);
  image.coverage.assign(image.pixels(), 0.0f);
  evaluation_.update(world);
  frame.find_targets(evaluation_);
  frame.find_small();
  for (std::size_t i = 0; i < frame.small.size(); ++i) {
    if (!draw_texels(frame, i)) return failed;
    if (!frame.small[i].view) frame.rest.add(frame.small[i].area);
  }
  std::erase_if(frame.small, [](const Small& one) { return !one.view; });
  if (!draw_to_error(frame)) return failed;
  add_small(frame);
  estimate(frame);
  if (std::all_of(image.coverage.begin(), image.coverage.end(), [](float a) { return a == 0; }))
    log.report_file(Code("W5006"), {},
                    "nothing is in view: no part of a target lies inside the image, or samples "
                    "missed it");
  return std::move(image);
}

}  // namespace panwright::preview
