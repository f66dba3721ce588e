// Planetshine, discs, an eclipse and stars behind the servicer: processor time of a frame beside
// the error of its flux against the path tracer.
#include <fmt/core.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "bench/bench.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "sky/planetshine.h"
#include "sky/shine_table.h"
#include "sky/sky.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_planetshine {

namespace {

double seconds_of_processors() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Place {
  const char* name;
  bool earth;
  Vec3 to_sun;
};
constexpr double kAway = 6778e3;

struct Flux {
  double got = 0, want = 0;
};

// The flux of an image and of the path tracer's where targets alone are seen.
Flux flux_of(const image::Image& image, const world::World& world, const world::Camera& camera,
             std::uint32_t rays, DiagnosticLog& log) {
  preview::ReferenceOptions options;
  options.samples = rays;
  options.bounces = 0;
  const auto traced = preview::Reference().render(world, camera, options, log);
  if (!traced) return {NAN, NAN};
  Flux flux;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    if (image.coverage[i / 3] < 1 || traced->image.coverage[i / 3] < 1) continue;
    flux.got += static_cast<double>(image.radiance[i]);
    flux.want += static_cast<double>(traced->image.radiance[i]);
  }
  return flux;
}

void add_frames(Context& context, world::World world, const world::Camera& camera,
                preview::Renderer& renderer, DiagnosticLog& log) {
  light::Body earth = *light::body_preset("earth");
  earth.centre = {0, 0, -kAway};
  const Place places[] = {{"no planet", false, {1, -0.25, 0.6}},
                          {"over the Earth, day", true, {1, -0.25, 0.6}},
                          {"over the Earth, night side", true, {-1, 0.8, 0.6}},
                          {"over the Earth, eclipsed", true, {0.1, 0.2, -1}}};
  preview::RenderOptions options;
  options.samples = 8;  // foil in the Earth's light has glints narrower than a pixel
  double plain = 0, lit = 0;
  for (const Place& place : places) {
    world.set_sky(place.earth ? std::vector{earth} : std::vector<light::Body>{}, false);
    world::Sun sun;
    sun.direction = place.to_sun;
    world.set_sun(sun);
    static_cast<void>(renderer.render(world, camera, options, log));
    const double start = seconds_of_processors();
    for (int k = 0; k < context.runs(); ++k)
      static_cast<void>(renderer.render(world, camera, options, log));
    const double each = (seconds_of_processors() - start) / context.runs();
    if (!place.earth) plain = each;
    const auto image = renderer.render(world, camera, options, log);
    Row row{.case_name = "planetshine",
            .setting = place.name,
            .speed = 1e3 * each,
            .speed_unit = "ms of processors",
            .error_unit = "relative, flux",
            .reference = "path tracer, without light between surfaces",
            .runs = context.runs()};
    const Flux flux =
        image ? flux_of(*image, world, camera, context.quick() ? 4 : 64, log) : Flux{NAN, NAN};
    if (!place.earth) lit = flux.want;
    // in full eclipse there is twilight alone: of the sunlit flux
    row.error = std::fabs(flux.got - flux.want) / (flux.want > 1e-6 * lit ? flux.want : lit);
    if (place.earth) {
      row.must = 1.25e3 * plain;
      row.must_is_least = false;
    }
    context.add(std::move(row));
  }
}

// What the processor prepares for a frame.
void add_tables(Context& context) {
  world::World world;
  light::Body earth = *light::body_preset("earth");
  earth.air = false;  // the closed form is of the ground alone
  earth.centre = {0, 0, -kAway};
  world.set_sky({earth}, false);
  const sky::Sky sky(world);
  const double want = sky::irradiance(sky, Vec3(0), {0, 0, -1}, {400, 800}).x;
  double got = 0;
  double start = seconds_of_processors();
  for (int k = 0; k < context.runs(); ++k) {
    got = 0;
    for (const auto& light : sky::planet_lights(sky, Vec3(0), 16))
      got += light.irradiance.x * std::max(0.0, -light.to_light.z);
  }
  context.add({.case_name = "planetshine",
               .setting = "16 parts, nadir plate",
               .speed = 1e3 * (seconds_of_processors() - start) / context.runs(),
               .speed_unit = "ms of processors",
               .error = std::fabs(got / want - 1),
               .error_unit = "relative, irradiance",
               .reference = "quadrature over the disc",
               .runs = context.runs()});
  start = seconds_of_processors();
  sky::ShineTable table;
  for (int k = 0; k < context.runs(); ++k) table = sky::shine_table(sky, Vec3(0));
  const double each = (seconds_of_processors() - start) / context.runs();
  // towards the nadir, at a corner of the square
  const double at = static_cast<double>(table.rgba[0]);
  const double exact = earth.albedo.x / kPi * std::max(0.0, sky.to_sun().z) * sky.irradiance().x;
  context.add({.case_name = "planetshine",
               .setting = "table of radiance, nadir",
               .speed = 1e3 * each,
               .speed_unit = "ms of processors",
               .error = exact > 0 ? std::fabs(at / exact - 1) : std::fabs(at),
               .error_unit = "relative, radiance",
               .reference = "closed form",
               .runs = context.runs()});
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
  const std::uint32_t size = context.quick() ? 96 : 256;
  world::set_field_of_view(camera, size, size, 60 * kDegree);
  camera.position = {9, -7, 4.4};
  if (const auto turn = world::looking_at(camera.position, {0, -0.7, -0.6}, {}, log))
    camera.world_from_camera = *turn;
  preview::Renderer renderer(*device);
  context.set_renderer((*device)->context().renderer());
  add_frames(context, world, camera, renderer, log);
  add_tables(context);
}

const bool kAdded = add_case({"planetshine", "frames of the servicer over the Earth", run});

}  // namespace

}  // namespace panwright::bench::case_planetshine
