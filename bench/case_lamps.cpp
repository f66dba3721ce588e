// Lamps: processor time of a frame with one and with many, beside the error of their sum.
#include <fmt/core.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "bench/bench.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_lamps {

namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// On a ring about the target, all at the same distance.
std::vector<world::Lamp> ring(int count, double radius, double turn) {
  std::vector<world::Lamp> lamps;
  for (int k = 0; k < count; ++k) {
    const double angle = turn + 2.399963 * k;  // the golden angle
    world::Lamp lamp;
    lamp.source = light::Spot{.position = radius * Vec3(std::cos(angle), std::sin(angle), 0.6),
                              .axis = -Vec3(std::cos(angle), std::sin(angle), 0.6),
                              .intensity = Vec3(radius * radius / count),
                              .half_angle = 1};
    lamps.push_back(lamp);
  }
  return lamps;
}

double sum_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.radiance) sum += static_cast<double>(value);
  return sum;
}

// The sum of images with one lamp each, of what they bring beside the Sun.
double apart(preview::Renderer& renderer, world::World world, const world::Camera& camera,
             const preview::RenderOptions& options, DiagnosticLog& log) {
  const std::vector<world::Lamp> lamps(world.lamps().begin(), world.lamps().end());
  world.set_lamps({});
  const auto sun = renderer.render(world, camera, options, log);
  if (!sun) return NAN;
  double sum = sum_of(*sun);
  for (const world::Lamp& lamp : lamps) {
    world.set_lamps({lamp});
    const auto one = renderer.render(world, camera, options, log);
    if (!one) return NAN;
    sum += sum_of(*one) - sum_of(*sun);
  }
  return sum;
}

void run(Context& context) {
  DiagnosticLog log;
  const auto path = context.source("examples/servicer/servicer.pxn");
  auto model = path.empty() ? failed : workspace::open(path, {}, log);
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!model || !device) return context.note("no model or no context");
  world::World world;
  static_cast<void>(world.add("servicer", *model, log));
  world::Camera camera;
  const std::uint32_t size = context.quick() ? 96 : 384;
  world::set_field_of_view(camera, size, size, 50 * kDegree);
  camera.position = {6, -5, 4};
  if (const auto turn = world::looking_at(camera.position, Vec3(0), {}, log))
    camera.world_from_camera = *turn;
  preview::RenderOptions options;
  options.samples = 2;
  preview::Renderer renderer(*device);
  context.set_renderer((*device)->context().renderer());
  for (const bool moving : {false, true}) {
    std::vector<double> seconds(3);
    const int counts[] = {0, 1, 32};
    const int runs = moving ? 2 : context.runs();
    for (int k = 0; k < runs + 1; ++k)
      for (std::size_t i = 0; i < std::size(counts); ++i) {
        world.set_lamps(ring(counts[i], 12, moving ? 0.01 * k : 0));
        if (k > 0 && !moving) static_cast<void>(renderer.render(world, camera, options, log));
        const double start = processor_seconds();
        static_cast<void>(renderer.render(world, camera, options, log));
        if (k > 0) seconds[i] += processor_seconds() - start;
      }
    for (std::size_t i = 0; i < std::size(counts); ++i) {
      world.set_lamps(ring(counts[i], 12, 0));
      const auto image = renderer.render(world, camera, options, log);
      const double want = apart(renderer, world, camera, options, log);
      Row row{.case_name = "lamps",
              .setting = fmt::format("lamps={} {}", counts[i], moving ? "moving" : "at rest"),
              .speed = 1e3 * seconds[i] / runs,
              .speed_unit = "ms of processors",
              .error = image ? std::fabs(sum_of(*image) / want - 1) : NAN,
              .error_unit = "relative, flux",
              .reference = "images of one lamp each",
              .runs = runs};
      if (counts[i] == 32) {
        row.must = 2 * 1e3 * seconds[1] / runs;
        row.must_is_least = false;
      }
      context.add(std::move(row));
    }
  }
}

const bool kAdded = add_case({"lamps", "frames with one and with 32 lamps", run});

}  // namespace

}  // namespace panwright::bench::case_lamps
