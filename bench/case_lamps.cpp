// Lamps: processor time of a frame with one and with many, beside the error of their sum.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <string>
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

// What a case draws: frame k with a number of lamps.
struct Scene {
  std::string name;
  world::World world;
  world::Camera camera;
  std::function<void(world::World& world, int count, int k)> set;
};

void look(world::Camera& camera, std::uint32_t size, const Vec3& from, const Vec3& at,
          DiagnosticLog& log) {
  world::set_field_of_view(camera, size, size, 50 * kDegree);
  camera.position = from;
  if (const auto turn = world::looking_at(from, at, {}, log)) camera.world_from_camera = *turn;
}

// Docking lamps on a servicer's deck towards a client, floodlights on its own wings and body, and
// navigation lights at its tips: one of 40 degrees first, which lights all of the client.
std::vector<world::Lamp> servicer_lamps(int count) {
  std::vector<world::Lamp> lamps;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.399963 * k;
    const Vec3 round(std::cos(angle), std::sin(angle), 0);
    light::Spot spot{.position = 0.6 * round + Vec3(0, 0, 1.3),
                     .axis = {0, 0, 1},
                     .intensity = Vec3(20),
                     .half_angle = 40 * kDegree,
                     .exponent = 12};
    if (k % 4 == 1) {  // beams to parts of the client
      spot.axis = Vec3(0, 0, 9) + 1.2 * round - spot.position;
      spot.half_angle = 5 * kDegree;
      spot.exponent = 0;
    } else if (k % 4 == 2) {  // floodlights over the servicer
      spot.position = Vec3(2.2 * round.x, 5 * round.y, 0.9);
      spot.axis = Vec3(-round.x, -round.y, -1.2);
      spot.intensity = Vec3(1);
      spot.half_angle = 35 * kDegree;
      spot.exponent = 0;
    } else if (k % 4 == 3) {  // navigation lights
      spot.position = Vec3(2.3 * round.x, 5.2 * round.y, 0.4 * round.x);
      spot.axis = Vec3(round.x, round.y, 0.3);
      spot.intensity = Vec3(0.05);
      spot.half_angle = kPi / 2;
      spot.exponent = 1;
    }
    world::Lamp lamp;
    lamp.source = spot;
    lamp.carrier = world::Lamp::Carrier::node;
    lamp.target = "servicer";
    lamps.push_back(lamp);
  }
  return lamps;
}

std::vector<Scene> scenes(std::uint32_t size, const world::ModelPtr& servicer,
                          const world::ModelPtr& client, DiagnosticLog& log) {
  Scene everywhere{"all on all, at rest", {}, {}, [](world::World& world, int count, int) {
                     world.set_lamps(ring(count, 12, 0));
                   }};
  static_cast<void>(everywhere.world.add("servicer", servicer, log));
  look(everywhere.camera, size, {6, -5, 4}, Vec3(0), log);
  Scene turning = everywhere;
  turning.name = "all on all, turning";
  turning.set = [](world::World& world, int count, int k) {
    world.set_lamps(ring(count, 12, 0.01 * k));
  };
  Scene approach{"approach", {}, {}, [](world::World& world, int count, int k) {
                   world.set_lamps(servicer_lamps(count));
                   world.set_pose(1, {{0, 0, 9 - 0.01 * k}, Quat(0, 0, 1, 0)});
                 }};
  static_cast<void>(approach.world.add("servicer", servicer, log));
  static_cast<void>(approach.world.add("client", client, {{0, 0, 9}, Quat(0, 0, 1, 0)}, log));
  look(approach.camera, size, {9, -6, -1}, {0, 0, 4}, log);
  Scene hold = approach;
  hold.name = "hold";
  hold.set = [](world::World& world, int count, int) { world.set_lamps(servicer_lamps(count)); };
  return {everywhere, turning, hold, approach};
}

void run(Context& context) {
  DiagnosticLog log;
  const auto servicer_file = context.source("examples/servicer/servicer.pxn");
  const auto client_file = context.source("examples/client/client.pxn");
  auto servicer = servicer_file.empty() ? failed : workspace::open(servicer_file, {}, log);
  auto client = client_file.empty() ? failed : workspace::open(client_file, {}, log);
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!servicer || !client || !device) return context.note("no models or no context");
  preview::RenderOptions options;
  options.samples = 2;
  context.set_renderer((*device)->context().renderer());
  for (Scene& scene : scenes(context.quick() ? 96 : 384, *servicer, *client, log)) {
    preview::Renderer renderer(*device);
    double of_one = 0;
    for (const int count : {0, 1, 32}) {
      const int runs = context.runs();
      std::vector<double> seconds;
      for (int k = -1; k < runs; ++k) {
        scene.set(scene.world, count, k);
        const double start = processor_seconds();
        static_cast<void>(renderer.render(scene.world, scene.camera, options, log));
        if (k >= 0) seconds.push_back(processor_seconds() - start);
      }
      std::ranges::sort(seconds);
      const auto image = renderer.render(scene.world, scene.camera, options, log);
      const double want = apart(renderer, scene.world, scene.camera, options, log);
      const auto n = seconds.size();
      Row row{.case_name = "lamps",
              .setting = fmt::format("{}, lamps={}", scene.name, count),
              .speed = 1e3 * seconds[n / 2],
              .speed_unit = "ms of processors",
              .error = image ? std::fabs(sum_of(*image) / want - 1) : NAN,
              .error_unit = "relative, flux",
              .reference = "images of one lamp each",
              .runs = runs,
              .spread = 0.5e3 * (seconds[3 * n / 4] - seconds[n / 4])};
      if (count == 1) of_one = row.speed;
      if (count == 32) {
        row.must = 2 * of_one;
        row.must_is_least = false;
      }
      context.add(std::move(row));
    }
  }
}

const bool kAdded = add_case({"lamps", "frames with one and with 32 lamps", run});

}  // namespace

}  // namespace panwright::bench::case_lamps
