// Ways of sampling: what each costs beside one sample a pixel, and what it leaves against 16x16
// samples in full.
#include <fmt/core.h>

#include <cmath>

#include "bench/bench.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_samples {

namespace {

struct Scene {
  const char* name;
  const char* file;
  Vec3 camera;
  double field_of_view;  // degrees
  Vec3 to_sun;
};

constexpr Scene kScenes[] = {
    {"servicer, along its axes", "examples/servicer/servicer.pxn", {12, 0, 6}, 45, {1, -0.7, 0.6}},
    {"servicer, aslant", "examples/servicer/servicer.pxn", {8, -8.5, 5.5}, 47, {1, -0.6, 0.6}},
    {"servicer, close", "examples/servicer/servicer.pxn", {-5, 3, 2.5}, 40, {-0.5, 0.7, 0.6}},
    {"servicer, far", "examples/servicer/servicer.pxn", {60, 40, 30}, 15, {1, 0, 0.6}},
    {"client", "examples/client/client.pxn", {4, -6, 3}, 40, {1, -0.5, 0.4}},
    {"cubesat", "examples/cubesat/cubesat.pxn", {0.5, -0.7, 0.4}, 40, {0.6, -0.8, 0.5}},
};

struct Way {
  const char* name;
  unsigned samples;
  bool adaptive;
  double pixel_error;
  double must;  // times one sample; 0: no bound
};

constexpr Way kWays[] = {{"1 sample", 1, false, 0, 0},
                         {"4x4", 4, false, 0, 0},
                         {"4x4 adaptive", 4, true, 0, 3},
                         {"auto 5%", 0, false, 0.05, 0},
                         {"auto 1%", 0, false, 0.01, 0}};

preview::RenderOptions options_of(const Way& way) {
  preview::RenderOptions options;
  options.samples = way.samples;
  options.adaptive = way.adaptive;
  if (way.samples == 0) options.pixel_error = way.pixel_error;
  return options;
}

struct Errors {
  double rmse = 0;  // in parts of the RMS radiance of the reference
  double flux = 0;
};

Errors errors_of(const image::Image& image, const image::Image& reference) {
  double squares = 0;
  double whole = 0;
  double sum = 0;
  double flux = 0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    const auto value = static_cast<double>(image.radiance[i]);
    const auto right = static_cast<double>(reference.radiance[i]);
    squares += (value - right) * (value - right);
    whole += right * right;
    sum += value;
    flux += right;
  }
  return {std::sqrt(squares / whole), sum / flux - 1};
}

void time_scene(Context& context, const Scene& scene,
                const std::shared_ptr<preview::Device>& device, DiagnosticLog& log) {
  const auto path = context.source(scene.file);
  auto model = path.empty() ? failed : workspace::open(path, {}, log);
  if (!model)
    return context.note(fmt::format("{} cannot be read: its rows are missing", scene.file));
  world::World world;
  static_cast<void>(world.add("target", *model, {}, log));
  world::Sun sun;
  sun.direction = scene.to_sun;
  world.set_sun(sun);
  const std::uint32_t size = context.quick() ? 64 : 1024;
  int frame = 0;
  const auto camera_now = [&] {
    world::Camera camera;
    world::set_field_of_view(camera, size, size, scene.field_of_view * kDegree);
    // a little further on each time
    const double angle = 1e-4 * frame++;
    camera.position = Vec3(scene.camera.x - angle * scene.camera.y,
                           scene.camera.y + angle * scene.camera.x, scene.camera.z);
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log);
    return camera;
  };
  const auto first = [&] {
    frame = 0;
    return camera_now();
  };

  preview::Renderer renderer(device);
  preview::RenderOptions full;
  full.samples = context.quick() ? 8 : 16;
  const auto reference = renderer.render(world, first(), full, log);
  if (!reference) return context.note(fmt::format("{} cannot be drawn", scene.name));
  std::vector<Variant> variants;
  std::vector<Errors> errors;
  for (const Way& way : kWays) {
    const auto image = renderer.render(world, first(), options_of(way), log);
    if (!image) return context.note(fmt::format("{} cannot be drawn", scene.name));
    errors.push_back(errors_of(*image, *reference));
    context.note(fmt::format("{}, {}: flux off by {:.4f} %, {:.3g} samples a pixel", scene.name,
                             way.name, 100 * errors.back().flux, renderer.sampling().samples));
    const auto draw = [&renderer, &world, &camera_now, &log, way] {
      auto drawn = renderer.render(world, camera_now(), options_of(way), log);
      if (drawn) renderer.recycle(*std::move(drawn));
    };
    variants.push_back({way.name, draw});
    // the framebuffers of the way before have other sizes: a run of views makes them once
    if (way.samples != 0) variants.back().before = draw;
  }
  const auto timings = interleaved(variants, context.quick() ? 1 : 5);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    Row row;
    row.case_name = "samples";
    row.setting = fmt::format("{}: {} {}x{}", scene.name, kWays[i].name, size, size);
    row.speed = timings[i].median / timings[0].median;
    row.speed_unit = "of the time of 1 sample";
    row.runs = timings[i].runs;
    row.spread = 0.5 * (timings[i].upper_quartile - timings[i].lower_quartile) / timings[0].median;
    if (!context.quick()) row.must = kWays[i].must;
    row.must_is_least = false;
    row.error = errors[i].rmse;
    row.error_unit = "RMSE over RMS radiance";
    row.reference = "16x16 in full";
    row.must_error = kWays[i].pixel_error;
    context.add(row);
  }
}

void run(Context& context) {
  DiagnosticLog log;
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*device)->context().renderer());
  for (const Scene& scene : kScenes) {
    if (context.quick() && &scene != &kScenes[1]) continue;
    time_scene(context, scene, *device, log);
  }
}

const bool kAdded =
    add_case({"samples", "ways of sampling: time beside one sample, error beside 16x16", run});

}  // namespace

}  // namespace panwright::bench::case_samples
