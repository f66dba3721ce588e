// Light between surfaces: processor time of a new shape, of another Sun, of a joint's move and of a
// frame, beside the error of the flux of twelve views against the path tracer of eight bounces.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "transport/transport.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_indirect {

namespace {

constexpr const char* kReference = "path tracer of 8 bounces, 12 views";
constexpr int kViews = 12;

double seconds_of_processors() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double milliseconds(int runs, const std::function<void(int)>& work) {
  const double start = seconds_of_processors();
  for (int k = 0; k < runs; ++k) work(k);
  return 1e3 * (seconds_of_processors() - start) / runs;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// From the corners of an icosahedron about a target.
world::Camera camera_at(int corner, const Vec3& centre, double radius, std::uint32_t side) {
  constexpr double kGolden = 1.618033988749895, kField = 24 * kDegree;
  Vec3 out(0);
  out[corner / 4] = (corner & 1) != 0 ? -1 : 1;
  out[(corner / 4 + 1) % 3] = (corner & 2) != 0 ? -kGolden : kGolden;
  world::Camera camera;
  world::set_field_of_view(camera, side, side, kField);
  camera.position = centre + glm::normalize(out) * (radius / std::sin(kField / 2));
  DiagnosticLog log;
  if (const auto turned = world::looking_at(camera.position, centre, {}, log))
    camera.world_from_camera = *turned;
  return camera;
}

double sum(const std::vector<float>& values) {
  double all = 0;
  for (const float value : values) all += static_cast<double>(value);
  return all;
}

// Flux of all views: RMS and largest error relative to the sum over views / their number, so that
// a dark side counts as little as it sends.
struct Errors {
  double without = 0, with = 0, noise = 0;
};

// Those of views that look at lit sides, and at dark ones: across the Sun and beyond, but not so
// far that rims glint.
struct SidesErrors {
  Errors all, dark;
};

SidesErrors errors_of(const world::World& world, const Vec3& centre, double radius,
                      preview::Renderer& renderer, const preview::RenderOptions& lit, bool quick,
                      DiagnosticLog& log) {
  preview::RenderOptions plain = lit;
  plain.indirect.reset();
  preview::ReferenceOptions slow;
  slow.bounces = 8;
  slow.samples = quick ? 8 : 256;
  preview::Reference reference;
  struct Sums {
    double whole = 0, without = 0, with = 0, noise = 0, views = 0;
    Errors errors() const {
      const double mean = whole / views;
      const auto relative = [&](double squares) { return std::sqrt(squares / views) / mean; };
      return {relative(without), relative(with), relative(noise)};
    }
  } all, dark;
  for (int k = 0; k < kViews; ++k) {
    const world::Camera camera = camera_at(k, centre, radius, quick ? 32 : 80);
    const auto a = renderer.render(world, camera, plain, log);
    const auto b = renderer.render(world, camera, lit, log);
    const auto traced = reference.render(world, camera, slow, log);
    if (!a || !b || !traced) return {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
    const double wanted = sum(traced->image.radiance);
    const double share = max_component(traced->flux_error) / max_component(traced->flux);
    const double phase = std::acos(
        glm::dot(glm::normalize(camera.position - centre), glm::normalize(world.sun().direction)));
    for (Sums* sums : {&all, &dark}) {
      if (sums == &dark && !(phase > 100 * kDegree && phase < 150 * kDegree)) continue;
      sums->views += 1;
      sums->whole += wanted;
      sums->without += std::pow(sum(a->radiance) - wanted, 2);
      sums->with += std::pow(sum(b->radiance) - wanted, 2);
      sums->noise += std::pow(share * wanted, 2);
    }
  }
  return {all.errors(), dark.errors()};
}

void run_target(Context& context, const std::string& name, const std::filesystem::path& path,
                preview::Renderer& renderer) {
  DiagnosticLog log;
  const auto model = workspace::open(path, {}, log);
  world::World world;
  if (!model || !world.add(name, *model, log)) {
    context.note(name + " cannot be read");
    return;
  }
  const auto turn_sun = [&](int k) {
    world::Sun sun;
    sun.direction = {1, 0.2 + 0.01 * k, 0.5};
    world.set_sun(sun);
  };
  turn_sun(0);
  trace::Scene scene;
  scene.update(world);
  const AxisBox bounds = scene.targets()[0].target->bounds();
  transport::Transport transport;
  const double first = milliseconds(1, [&](int) { transport.update(world, {}); });
  const double other_sun = milliseconds(context.runs(), [&](int k) {
    turn_sun(k + 1);
    transport.update(world, {});
  });
  turn_sun(0);
  transport.update(world, {});
  preview::RenderOptions options;
  options.samples = 8;  // foil has glints narrower than a pixel
  options.indirect = std::make_shared<const std::vector<light::SurfelLight>>(
      transport.light().begin(), transport.light().end());
  const SidesErrors sides = errors_of(world, bounds.centre(), 0.5 * bounds.diagonal(), renderer,
                                      options, context.quick(), log);
  const Errors &errors = sides.all, &dark = sides.dark;
  context.note(fmt::format("{}: flux of dark sides: without {:.4f}, with {:.4f}, noise {:.4f}",
                           name, dark.without, dark.with, dark.noise));
  const world::Camera camera = camera_at(4, bounds.centre(), 0.5 * bounds.diagonal(), 512);
  options.samples = 4;
  // in turn, and medians: other programs run beside
  preview::RenderOptions off = options;
  off.indirect.reset();
  std::vector<double> with, without;
  for (int k = 0; k <= context.runs(); ++k)
    for (const bool on : {true, false}) {
      const double time = milliseconds(1, [&](int) {
        static_cast<void>(renderer.render(world, camera, on ? options : off, log));
      });
      if (k > 0) (on ? with : without).push_back(time);
    }
  const double lit = median(with), plain = median(without);
  const auto add = [&](const char* what, double speed, double error, double must) {
    context.add({.case_name = "indirect",
                 .setting = fmt::format("{}, {}", name, what),
                 .speed = speed,
                 .speed_unit = "ms of processors",
                 .error = error,
                 .error_unit = "relative, flux, RMS of views",
                 .reference = kReference,
                 .reference_error = errors.noise,
                 .runs = context.runs(),
                 .must = must,
                 .must_is_least = false});
  };
  add("a new shape", first, errors.with, 0);
  add("another Sun", other_sun, errors.with, 50);
  add("a frame of 512 px without", plain, errors.without, 0);
  add("a frame of 512 px with", lit, errors.with, 1.15 * plain);
  if (world[0].joint_values().empty()) return;
  const double moved = milliseconds(3, [&](int k) {
    geometry::JointValues values{};
    values[0] = 0.01 * (k + 1);
    world.set_joint(0, 0, values);
    transport.update(world, {});
  });
  add("a joint moves", moved, errors.with, 200);
}

void run_indirect(Context& context) {
  DiagnosticLog log;
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) {
    context.note("there is no OpenGL context, so nothing was measured");
    return;
  }
  context.set_renderer((*device)->context().renderer());
  preview::Renderer renderer(*device);
  for (const auto& [name, file] : {std::pair{"servicer", "examples/servicer/servicer.pxn"},
                                   std::pair{"client", "examples/client/client.pxn"}}) {
    const auto path = context.source(file);
    if (!path.empty()) run_target(context, name, path, renderer);
    if (context.quick()) return;
  }
}

const bool kAdded =
    add_case({"indirect", "light between surfaces: time of changes, error of flux", run_indirect});

}  // namespace

}  // namespace panwright::bench::case_indirect
