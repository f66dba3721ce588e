// Targets of any size: flux, flicker and photocentre beside the time of a frame, by imposters and
// by samples; a spacecraft from 1,000 km to where it fills the image.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "preview/renderer.h"
#include "tests/support/oracles.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_imposters {

namespace {

constexpr double kPhase = 60 * kDegree;
constexpr double kRange = 1e6;  // of spheres of radius 1
constexpr std::uint32_t kSide = 1024;

struct Way {
  const char* name;
  unsigned samples;
  preview::Imposters imposters;
  int offsets;           // that are drawn
  bool cropped = false;  // to the target's own pixels
};
constexpr Way kWays[] = {{"imposter", 0, preview::Imposters::automatic, 200},
                         {"1 sample", 1, preview::Imposters::off, 200},
                         {"4x4", 4, preview::Imposters::off, 100},
                         {"8x8", 8, preview::Imposters::off, 60},
                         {"16x16", 16, preview::Imposters::off, 40},
                         {"imposter, cropped", 0, preview::Imposters::automatic, 40, true},
                         {"auto, no imposters", 0, preview::Imposters::off, 40},
                         {"16x16, cropped", 16, preview::Imposters::off, 40, true},
                         {"64x64, cropped", 64, preview::Imposters::off, 40, true}};

// Software takes seconds where hardware takes milliseconds: fewer shifts and times of what is full
// of samples.
struct Effort {
  int offsets;
  int runs;
};
Effort effort_of(const Context& context, const Way& way, bool imposter) {
  if (context.quick()) return {8, 2};
  const bool software = context.renderer().find("llvmpipe") != std::string::npos;
  if (!software || imposter || way.cropped) return {way.offsets, 5};
  return {std::max(way.offsets / 5, 8), way.samples >= 8 ? 2 : 5};
}

preview::RenderOptions options_of(const Way& way) {
  preview::RenderOptions options;
  options.samples = way.samples;
  options.imposters = way.imposters;
  options.flux_error_of_large = true;
  return options;
}

struct Sums {
  double flux = 0;
  Vec2 centre{0};
};

Sums sums_of(const image::Image& image) {
  Sums sums;
  for (std::size_t y = 0; y < image.height; ++y) {
    double row = 0;
    double across = 0;
    for (std::size_t x = 0; x < image.width; ++x) {
      const auto light = static_cast<double>(image.radiance[3 * (y * image.width + x) + 1]);
      row += light;
      across += light * (static_cast<double>(x) + 0.5);
    }
    sums.flux += row;
    sums.centre += Vec2(across, row * (static_cast<double>(y) + 0.5));
  }
  if (sums.flux > 0) sums.centre /= sums.flux;
  return sums;
}

// Where the photocentre of an image of a Lambert sphere lies that is integrated over pixels, along
// one axis, by sums over the sphere's light in double.
class BoxImage {
 public:
  // along: towards the Sun's side of the image, or across it
  explicit BoxImage(bool along) {
    constexpr int kSteps = 4000;
    constexpr int kPoints = 1500;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double t = -1 + 2 * (i + 0.5) / kSteps;
      const double half = std::sqrt(1 - t * t);
      double light = 0;
      for (int k = 0; k < kPoints; ++k) {
        const double u = half * (-1 + 2 * (k + 0.5) / kPoints);
        const double depth = std::sqrt(std::max(0.0, 1 - t * t - u * u));
        light += std::max(0.0, std::sin(kPhase) * (along ? t : u) + std::cos(kPhase) * depth);
      }
      sum += light * half;
      below_.push_back(sum);
    }
    for (double& value : below_) value /= sum;
  }

  double centre(double at, double radius) const {
    double sum = 0;
    for (double pixel = std::floor(at - radius); pixel < at + radius; ++pixel)
      sum += (pixel + 0.5) * (share((pixel + 1 - at) / radius) - share((pixel - at) / radius));
    return sum;
  }

 private:
  double share(double t) const {
    const double at = (t + 1) / 2 * static_cast<double>(below_.size());
    if (at <= 0) return 0;
    if (at >= static_cast<double>(below_.size())) return 1;
    const auto i = static_cast<std::size_t>(at);
    const double before = i == 0 ? 0 : below_[i - 1];
    return before + (at - static_cast<double>(i)) * (below_[i] - before);
  }
  std::vector<double> below_;
};

// What images of one target at several places of the pixels' grid add up to.
struct Spread {
  double flux_rms = 0, flicker = 0, centre_rms = 0;
  Timing timing;
};

struct Target {
  world::World world;
  world::Camera camera;
  double flux = 0;  // expected
};

// Needs another expected place where the camera is another one.
template <class Centre>
std::optional<Spread> spread_of(preview::Renderer& renderer, const Target& target,
                                const preview::RenderOptions& options, const Effort& effort,
                                const Centre& expected, DiagnosticLog& log) {
  const int offsets = effort.offsets;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-0.5, 0.5);
  world::Camera camera = target.camera;
  Spread spread;
  double sum = 0;
  double squares = 0;
  int lit = 0;
  bool good = true;
  const auto draw = [&] {
    camera.principal = target.camera.principal + Vec2(offset(random), offset(random));
    auto image = renderer.render(target.world, camera, options, log);
    good = good && image;
    if (!image) return;
    const Sums sums = sums_of(*image);
    const double off = sums.flux / target.flux - 1;
    sum += off;
    squares += off * off;
    if (sums.flux > 0) {
      ++lit;
      const Vec2 apart = sums.centre - expected(camera);
      spread.centre_rms += glm::dot(apart, apart);
    }
    renderer.recycle(*std::move(image));
  };
  for (int i = 0; i < offsets && good; ++i) draw();
  if (!good) return std::nullopt;
  spread.flux_rms = std::sqrt(squares / offsets);
  const double mean = sum / offsets;
  // where no sample met the target there is no flux to flicker
  spread.flicker =
      mean > -1 ? std::sqrt(std::max(squares / offsets - mean * mean, 0.0)) / (1 + mean) : 0;
  spread.centre_rms = std::sqrt(spread.centre_rms / std::max(lit, 1));
  spread.timing = timed(draw, effort.runs);
  return spread;
}

// The same target by a camera of its own pixels alone.
Target cropped(const Target& target, double radius) {
  Target out = target;
  out.camera.width = out.camera.height = 2 * static_cast<std::uint32_t>(std::ceil(radius)) + 4;
  out.camera.principal = Vec2(out.camera.width / 2.0);
  return out;
}

// Frames of a camera that turns by a third of a pixel each: what the flux does.
template <class Turn>
void add_drift(Context& context, preview::Renderer& renderer, const Target& target,
               const std::string& setting, const preview::RenderOptions& options, const Turn& turn,
               DiagnosticLog& log) {
  const int frames = context.quick() ? 5 : 100;
  double sum = 0, squares = 0;
  for (int i = 0; i < frames; ++i) {
    world::Camera camera = target.camera;
    camera.world_from_camera = turn(camera, 0.37 * (i - frames / 2) / camera.focal.x);
    const auto image = renderer.render(target.world, camera, options, log);
    if (!image) return context.note("a drift could not be drawn");
    const double off = sums_of(*image).flux / target.flux - 1;
    sum += off;
    squares += off * off;
  }
  const double mean = sum / frames;
  context.add({.case_name = "imposters",
               .setting = fmt::format("{}, {} frames, a third of a pixel each", setting, frames),
               .speed = 0,
               .speed_unit = "-",
               .error = std::sqrt(std::max(squares / frames - mean * mean, 0.0)),
               .error_unit = "relative flux, standard deviation",
               .reference = "the mean of the frames",
               .runs = frames,
               .must_error = 1e-5});
}

void add_rows(Context& context, const std::string& case_name, const std::string& setting,
              const Spread& spread, double flux, double flicker, double centre,
              const std::string& reference, double reference_error) {
  const auto add = [&](const char* what, double error, const char* unit, double must) {
    Row row{.case_name = case_name,
            .setting = setting + what,
            .speed_unit = "ms/frame",
            .error = error,
            .error_unit = unit,
            .reference = reference,
            .reference_error = reference_error,
            .must_error = must};
    set_time(row, spread.timing, 1e3);
    context.add(row);
  };
  add("", spread.flux_rms, "relative flux, rms", flux);
  add(", flicker", spread.flicker, "relative, standard deviation", flicker);
  add(", photocentre", spread.centre_rms, "px, rms", centre);
}

Target sphere_target(const world::ModelPtr& model, double radius, DiagnosticLog& log) {
  Target target;
  static_cast<void>(target.world.add("sphere", model, log));
  target.camera.width = target.camera.height = kSide;
  target.camera.focal = Vec2(radius * kRange);
  target.camera.principal = Vec2(kSide / 2.0);
  target.camera.position = {0, -kRange, 0};
  target.camera.world_from_camera = *world::looking_at(target.camera.position, Vec3(0), {}, log);
  world::Sun sun = target.world.sun();
  sun.direction = {std::sin(kPhase), -std::cos(kPhase), 0};
  target.world.set_sun(sun);
  return target;
}

// What samples take for the error of an imposter, by their law: the error of a disc's area falls as
// samples^(-3/4).
//
//   took  seconds, by the samples whose error is known
void add_equal_error(Context& context, double radius, const Spread& imposter, const Spread& samples,
                     double took, const std::string& name, double must) {
  if (samples.flux_rms < imposter.flux_rms) return;  // fewer of them do
  const double more = std::pow(samples.flux_rms / imposter.flux_rms, 4.0 / 3.0);
  Row row{.case_name = "imposters",
          .setting = fmt::format("Lambert sphere r={}px: {} at the imposter's error", radius, name),
          .speed = more * took / imposter.timing.median,
          .speed_unit = "times the imposter's time",
          .error = imposter.flux_rms,
          .error_unit = "relative flux, rms",
          .reference = "closed form, box image",
          .reference_error = 4e-5,
          .runs = imposter.timing.runs,
          .must = must};
  context.add(row);
}

// What 4×4 samples of each pixel of an image take, where a sphere fills it.
std::optional<Timing> time_of_full_image(const Context& context, preview::Renderer& renderer,
                                         const world::ModelPtr& model, DiagnosticLog& log) {
  Target target = sphere_target(model, 1, log);
  target.camera.focal = Vec2(2.0 * kSide * kRange);
  preview::RenderOptions options;
  options.samples = 4;
  options.imposters = preview::Imposters::off;
  options.shadows = preview::Shadows::hard;
  bool good = true;
  const Timing timing = timed(
      [&] {
        auto image = renderer.render(target.world, target.camera, options, log);
        good = good && image;
        if (image) renderer.recycle(*std::move(image));
      },
      context.quick() ? 1 : 5);
  return good ? std::optional(timing) : std::nullopt;
}

void run_spheres(Context& context, preview::Renderer& renderer, DiagnosticLog& log) {
  const auto model = compiled_model(sphere_scene({200, 400}, lambert_material(1)), log);
  if (!model) return context.note("the sphere could not be compiled");
  const BoxImage along(true);
  const BoxImage across(false);
  const auto full_image = time_of_full_image(context, renderer, model, log);
  if (!full_image) return context.note("a sphere that fills the image could not be drawn");
  const std::vector<double> radii =
      context.quick() ? std::vector{0.3, 4.0}
                      : std::vector{0.03, 0.1, 0.3, 1.0, 2.0, 4.0, 16.0, 30.0, 100.0};
  for (const double radius : radii) {
    Target target = sphere_target(model, radius, log);
    target.flux = oracles::lambert_sphere_intensity(kPhase) * radius * radius;
    const auto box = [&](const world::Camera& camera) {
      return Vec2(along.centre(camera.principal.x, radius),
                  across.centre(camera.principal.y, radius));
    };
    const auto truth = [&](const world::Camera& camera) {
      return camera.principal + Vec2(radius * oracles::lambert_sphere_photocentre(kPhase), 0);
    };
    std::optional<Spread> by_imposter, whole_imposter;
    for (const Way& way : kWays) {
      const bool own = way.imposters != preview::Imposters::off;
      if (context.quick() && !own && way.samples != 8) continue;
      if (way.cropped && radius > 4) continue;
      if (way.samples == 16 && !way.cropped && radius > 4 && effort_of(context, way, own).runs < 5)
        continue;
      const Effort effort = effort_of(context, way, own);
      const Target seen = way.cropped ? cropped(target, radius) : target;
      const auto spread = spread_of(renderer, seen, options_of(way), effort, box, log);
      if (!spread) return context.note("a sphere could not be drawn");
      add_rows(context, "imposters", fmt::format("Lambert sphere r={}px {}", radius, way.name),
               *spread, own ? 5e-4 : 0, own ? 1e-5 : 0, own && !way.cropped ? 0.02 : 0,
               "closed form, box image", 4e-5);
      if (own) (way.cropped ? by_imposter : whole_imposter) = *spread;
      if (!own && way.cropped && by_imposter)
        add_equal_error(context, radius, *by_imposter, *spread, spread->timing.median, way.name, 1);
      // their time goes with their number
      if (way.samples == 16 && way.cropped && whole_imposter)
        add_equal_error(context, radius, *whole_imposter, *spread,
                        16 * 16 / (4 * 4) * full_image->median, "samples of the whole image", 50);
      if (!own || way.cropped) continue;
      preview::RenderOptions options = options_of(way);
      options.psf_sigma = 0.5;
      const auto blurred = spread_of(renderer, target, options, effort, truth, log);
      if (blurred)
        add_rows(context, "imposters",
                 fmt::format("Lambert sphere r={}px imposter, PSF 0.5px", radius), *blurred, 5e-4,
                 1e-5, 5e-3, "closed form", 4e-5);
    }
    if (radius >= 0.3 && radius <= 4)
      add_drift(
          context, renderer, target, fmt::format("Lambert sphere r={}px imposter", radius),
          options_of(kWays[0]),
          [](const world::Camera& camera, double angle) {
            return camera.world_from_camera * glm::angleAxis(angle, Vec3(0, 1, 0));
          },
          log);
  }
}

// A lobe of Cook-Torrance of slope 0.02 alone.
void run_glossy(Context& context, preview::Renderer& renderer, DiagnosticLog& log) {
  materials::Material glossy;
  glossy.weights = {0, 1, 0};
  glossy.specular = Vec3(1);
  glossy.specular_brdf =
      materials::with_slopes(materials::SpecularModel::cook_torrance, Vec2(0.02));
  materials::fit(glossy);
  const auto model = compiled_model(sphere_scene({200, 400}, glossy), log);
  if (!model) return context.note("the glossy sphere could not be compiled");
  for (const double radius : {1.0, 4.0, 16.0}) {
    Target target = sphere_target(model, radius, log);
    // the Beckmann lobe's closed form (Fresnel 1, no self-shadowing there)
    target.flux = radius * radius * 0.250049990;
    for (const Way& way : kWays) {
      const bool own = way.imposters != preview::Imposters::off;
      if (way.cropped || (!own && way.samples != 8)) continue;
      const auto middle = [](const world::Camera& camera) { return camera.principal; };
      const auto spread =
          spread_of(renderer, target, options_of(way), {context.quick() ? 4 : 40, 5}, middle, log);
      if (!spread) return context.note("a glossy sphere could not be drawn");
      Row row{.case_name = "imposters",
              .setting = fmt::format("Cook-Torrance 0.02 sphere r={}px {}", radius, way.name),
              .speed_unit = "ms/frame",
              .error = spread->flux_rms,
              .error_unit = "relative flux, rms",
              .reference = "closed form",
              .reference_error = 1e-5,
              .must_error = own ? 0.02 : 0};
      set_time(row, spread->timing, 1e3);
      context.add(row);
    }
  }
}

std::optional<Target> spacecraft_target(Context& context, double range, double extent_px,
                                        DiagnosticLog& log) {
  static const auto model = [&] {
    const auto path = context.source("examples/servicer/servicer.pxn");
    return path.empty() ? failed : workspace::open(path, {}, log);
  }();
  if (!model) return std::nullopt;
  Target target;
  static_cast<void>(target.world.add("servicer", *model, log));
  const AxisBox box = box_of(**model);
  target.camera.width = target.camera.height = kSide;
  target.camera.position = box.centre() + range * glm::normalize(Vec3(1, -1.1, 0.7));
  target.camera.world_from_camera =
      *world::looking_at(target.camera.position, box.centre(), {}, log);
  target.camera.focal = Vec2(extent_px * range / box.diagonal());
  target.camera.principal = Vec2(kSide / 2.0);
  world::Sun sun = target.world.sun();
  sun.direction = {1, -0.4, 0.6};
  target.world.set_sun(sun);
  return target;
}

// The flux that the pixels of a camera should see: of an image of a thousand pixels, 64 samples
// each, the finest levels and shadows.
double flux_of(preview::Renderer& renderer, const Target& target, double diagonal_px, Vec2& centre,
               DiagnosticLog& log) {
  world::Camera camera = target.camera;
  const bool near = diagonal_px > 600;  // what is beyond the image's rim does not count
  const double zoom = near ? 1 : 1000 / diagonal_px;
  camera.focal *= zoom;
  preview::RenderOptions options;
  options.samples = near ? 16 : 8;  // twice as many change less than 1e-4
  options.specular_filter = !near;
  options.levels = false;
  options.shadow_side = 8192;
  options.max_shadow_bytes = 1ull << 30;
  const auto image = renderer.render(target.world, camera, options, log);
  if (!image) return 0;
  const Sums sums = sums_of(*image);
  centre = (sums.centre - camera.principal) / zoom;
  return sums.flux / (zoom * zoom);
}

void run_spacecraft(Context& context, preview::Renderer& renderer, DiagnosticLog& log) {
  const std::vector<double> sizes =
      context.quick() ? std::vector{3.0} : std::vector{0.1, 1.0, 3.0, 10.0, 30.0, 60.0, 200.0};
  auto target = spacecraft_target(context, 1e4, 1, log);
  if (!target) return context.note("the servicer cannot be read: its rows are missing");
  const Vec2 focal = target->camera.focal;
  for (const double pixels : sizes) {
    target->camera.focal = pixels * focal;
    Vec2 centre(0);
    target->flux = flux_of(renderer, *target, pixels, centre, log);
    const auto expected = [&](const world::Camera& camera) { return camera.principal + centre; };
    for (const Way& way : kWays) {
      const bool own = way.imposters != preview::Imposters::off;
      if (context.quick() && !own) continue;
      // where pixels are larger than the target their photocentre is theirs
      preview::RenderOptions options = options_of(way);
      options.levels = false;
      if (own) options.psf_sigma = 0.5;
      if (way.cropped) continue;
      Effort effort = effort_of(context, way, own);
      effort.offsets = context.quick() ? 4 : std::min(effort.offsets, 40);
      const auto spread = spread_of(renderer, *target, options, effort, expected, log);
      if (!spread) return context.note("the servicer could not be drawn");
      add_rows(context, "imposters_craft",
               fmt::format("servicer {} px {}{}", pixels, way.name, own ? ", PSF 0.5px" : ""),
               *spread, own ? 5e-4 : 0, own ? 1e-5 : 0, own ? 0.02 : 0,
               "1000 pixels, 64 samples each", 1e-4);
    }
  }
}

// From 1,000 km to 20 m with one camera: flux against that of a magnified image, and the largest
// step from one range to the next.
void run_ranges(Context& context, preview::Renderer& renderer, DiagnosticLog& log) {
  auto target = spacecraft_target(context, 1, 1, log);
  if (!target) return;
  const Vec3 middle = target->camera.position - glm::normalize(Vec3(1, -1.1, 0.7));
  const AxisBox box = box_of(*target->world[0].model());
  const int steps = context.quick() ? 2 : 60;
  const int more = context.quick() ? 0 : 11;  // as long, to where the camera is about to be inside
  double before = 0;
  double worst_step = 0;
  for (int i = 0; i <= steps + more; ++i) {
    const double range = 1e6 * std::pow(20 / 1e6, static_cast<double>(i) / steps);
    target->camera.position = middle + range * glm::normalize(Vec3(1, -1.1, 0.7));
    target->camera.focal = Vec2(1000);
    Vec2 centre(0);
    const double expected = flux_of(renderer, *target, 1000 * box.diagonal() / range, centre, log);
    preview::RenderOptions options;
    options.samples = 0;
    options.levels = false;
    options.flux_error_of_large = true;
    std::optional<image::Image> kept;
    const Timing timing = timed(
        [&] {
          auto image = renderer.render(target->world, target->camera, options, log);
          if (image) kept = *std::move(image);
        },
        1);
    if (!kept || !(expected > 0)) return context.note("an approach could not be drawn");
    const double off = sums_of(*kept).flux / expected - 1;
    if (i > 0) worst_step = std::max(worst_step, std::fabs(off - before));
    before = off;
    Row row{.case_name = "imposters_craft",
            .setting = fmt::format("servicer at {:.4g} m, {:.3g} px{}", range,
                                   1000 * box.diagonal() / range,
                                   renderer.sampling().imposters.empty() ? ", samples" : ""),
            .speed_unit = "ms/frame",
            .error = std::fabs(off),
            .error_unit = "relative flux",
            .reference = i <= steps ? "1000 pixels, 64 samples each, finest levels"
                                    : "256 samples a pixel, finest levels",
            .reference_error = 3e-5,
            .must_error = 1e-3};
    set_time(row, timing, 1e3);
    context.add(row);
    if (i == steps + more) {
      row.setting =
          fmt::format("servicer from 1e6 to {:.2g} m: largest step of the flux error", range);
      row.error = worst_step;
      context.add(row);
    }
  }
}

template <class... Runs>
std::function<void(Context&)> with_renderer(Runs... runs) {
  return [=](Context& context) {
    DiagnosticLog log;
    auto device = preview::Device::create(preview::ContextKind::automatic, log);
    if (!device) return context.note("no OpenGL context: nothing was drawn");
    context.set_renderer((*device)->context().renderer());
    preview::Renderer renderer(*device);
    (runs(context, renderer, log), ...);
  };
}

const bool kAdded =
    add_case({"imposters", "spheres of any size: flux, flicker and photocentre beside samples'",
              with_renderer(run_spheres, run_glossy)}) &&
    add_case({"imposters_craft", "a spacecraft of any size, and from 1,000 km to 20 m",
              with_renderer(run_spacecraft, run_ranges)});

}  // namespace

}  // namespace panwright::bench::case_imposters
