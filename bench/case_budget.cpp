// Budgets: what models become for cameras far and near, and what their images lose by it.
#include <fmt/core.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "bench/bench.h"
#include "bench/scenes.h"
#include "compiler/compile.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/model.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "tests/support/view.h"
#include "workspace/budget.h"
#include "workspace/open.h"

namespace panwright::bench::case_budget {
namespace {

constexpr double kIfov = 1e-4;
constexpr double kFlux = 1e-3, kCentroid = 0.01;
constexpr double kMostSide = 128;  // pixels

struct Built {
  world::ModelPtr model;
  compiler::Report report;
  double seconds = 0;
};

Built built(Context& context, const scene::Scene& scene, const compiler::Options& options,
            DiagnosticLog& log) {
  Built out;
  static int made = 0;  // models are read from their files while others are made
  const auto path = context.scratch() / fmt::format("budget{}.pan", made++);
  const auto start = std::chrono::steady_clock::now();
  auto report = compiler::compile(scene, options, path, log);
  out.seconds = seconds_since(start);
  if (!report) return out;
  out.report = *std::move(report);
  auto model = pan::Model::open(path, log);
  if (model && model->check(log)) out.model = std::make_shared<const pan::Model>(*std::move(model));
  return out;
}

// What the budget's camera sees from some direction at its nearest: the model, or a part of it.
preview::View view_of(const pan::Model& model, const AxisBox& box, double nearest, int direction,
                      double phase) {
  const std::array<Vec3, 3> from = {glm::normalize(Vec3(0.7, 0.5, 0.4)),
                                    glm::normalize(Vec3(-0.2, 0.9, -0.3)),
                                    glm::normalize(Vec3(0.1, -0.4, 0.9))};
  const Vec3 to_camera = from[static_cast<std::size_t>(direction)];
  const double radius = box.diagonal() / 2;
  double front = -HUGE_VAL;
  const auto nodes = model.world_from_nodes();
  for (const pan::layout::Instance& instance : model.instances()) {
    const Vec3 origin(model.meshes()[instance.mesh].origin[0],
                      model.meshes()[instance.mesh].origin[1],
                      model.meshes()[instance.mesh].origin[2]);
    for (const auto& p : model.mesh(instance.mesh).positions)
      front = std::max(front,
                       glm::dot(Vec3(nodes[instance.node] * Vec4(origin + Vec3(p.x, p.y, p.z), 1)) -
                                    box.centre(),
                                to_camera));
  }
  const double range = nearest + front;
  const double across = 2 * radius / ((range - radius > 0 ? range - radius : nearest) * kIfov);
  const auto side = static_cast<std::uint32_t>(std::clamp(std::ceil(across) + 6, 8.0, kMostSide));
  preview::View view;
  world::set_pixel_angle(view.camera, side, side, kIfov);
  view.camera.position = box.centre() + range * to_camera;
  DiagnosticLog log;
  view.camera.world_from_camera =
      *world::looking_at(view.camera.position, box.centre(), std::nullopt, log);
  const Vec3 beside = glm::normalize(glm::cross(to_camera, Vec3(0.3, 0.2, 1)));
  view.to_sun = std::cos(phase) * to_camera + std::sin(phase) * beside;
  return view;
}

struct Seen {
  double flux = 0, flux_error = 0;
  Vec2 centre{0};  // pixels
};

std::optional<Seen> seen(preview::Reference& reference, const world::ModelPtr& model,
                         const preview::View& view, std::uint32_t samples) {
  const world::World world = preview::world_of(model, view);
  preview::ReferenceOptions options;
  options.bounces = 0;
  options.samples = samples;
  options.until_error = 2e-4;
  options.max_samples = 4 * samples;
  options.sun_disc = false;
  DiagnosticLog log;
  const auto image = reference.render(world, view.camera, options, log);
  if (!image) return std::nullopt;
  Seen out;
  out.flux = image->flux.x + image->flux.y + image->flux.z;
  out.flux_error = (image->flux_error.x + image->flux_error.y + image->flux_error.z) / out.flux;
  double sum = 0;
  const std::uint32_t side = view.camera.width;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        const double value =
            static_cast<double>(image->image.radiance[3 * (std::size_t{y} * side + x) + k]);
        sum += value;
        out.centre += value * Vec2(x + 0.5, y + 0.5);
      }
  out.centre /= sum;
  return out;
}

double milliseconds(preview::Renderer& renderer, const world::ModelPtr& model,
                    const preview::View& view, int runs) {
  const world::World world = preview::world_of(model, view);
  preview::RenderOptions options;
  options.samples = 4;
  DiagnosticLog log;
  const Timing timing =
      timed([&] { static_cast<void>(renderer.render(world, view.camera, options, log)); }, runs);
  return 1e3 * timing.median;
}

// The fewest triangles that a shape can have: polygons of a circle's area about the axis, and rows
// of equilateral triangles on a sphere. 0: no formula here.
double fewest(const geometry::Shape& shape, double error) {
  if (const auto* ball = std::get_if<geometry::Sphere>(&shape); ball && ball->whole())
    return 16 * kPi * ball->radius / (std::sqrt(3.0) * 12 * error);
  const auto segments = [&](double radius, double e) { return kPi * std::sqrt(radius / (3 * e)); };
  if (const auto* torus = std::get_if<geometry::Torus>(&shape))
    return 2 * segments(torus->radius + torus->tube_radius, error / 2) *
           segments(torus->tube_radius, error / 2);
  if (const auto* tube = std::get_if<geometry::Cylinder>(&shape))
    return 4 * segments(tube->radius, error) - 4;
  return 0;
}

void run_model(Context& context, preview::Renderer* renderer, const std::string& name,
               const std::filesystem::path& path, double finest, bool foil = true) {
  if (path.empty()) return context.note(name + " is not there");
  DiagnosticLog log;
  workspace::OpenOptions open;
  if (!foil) open.parameters.emplace_back("foil", "0");
  auto scene = workspace::read_scene(path, open, log);
  if (!scene) return context.note(name + " could not be read");
  static_cast<void>(workspace::prune(*scene, {}, log));
  // glints of a few pixels hide a thousandth of the flux behind their noise
  for (materials::Material& material : scene->materials) {
    material.specular_brdf = materials::NoSpecular{};
    material.coat.reset();
  }
  scene->budget = {};
  compiler::Options as_given;
  if (finest > 0) as_given.max_error = finest;
  const Built full = built(context, *scene, as_given, log);
  if (!full.model) return context.note(name + " was refused");
  const AxisBox box = box_of(*full.model);
  const std::uint32_t samples = context.quick() ? 16 : 128;
  preview::Reference reference;
  const std::vector<double> ranges =
      context.quick() ? std::vector{5e3} : std::vector{5.0, 50.0, 5e3, 5e5};
  for (const double nearest : ranges) {
    scene->budget =
        *workspace::budget_of_text(fmt::format("nearest={} ifov={}mrad flux={} centroid={}",
                                               nearest, 1e3 * kIfov, kFlux, kCentroid),
                                   log);
    const Built fitted = built(context, *scene, {}, log);
    if (!fitted.model) return context.note(name + " was refused with a budget");
    double flux = 0, noise = 0, centre = 0;
    for (int direction = 0; direction < (context.quick() ? 1 : 2); ++direction)
      for (const double phase : {30 * kDegree, 90 * kDegree}) {
        const preview::View view = view_of(*full.model, box, nearest, direction, phase);
        const auto a = seen(reference, full.model, view, samples);
        const auto b = seen(reference, fitted.model, view, samples);
        if (!a || !b) return context.note(name + ": no image");
        flux = std::max(flux, std::fabs(b->flux / a->flux - 1));
        noise = std::max(noise, std::hypot(a->flux_error, b->flux_error));
        centre = std::max(centre, glm::length(b->centre - a->centre));
      }
    const preview::View view = view_of(*full.model, box, nearest, 0, 30 * kDegree);
    const double ms = renderer ? milliseconds(*renderer, fitted.model, view, context.runs()) : 0;
    const std::string setting = fmt::format(
        "{}; nearest {:g} m, {:g} mrad; {} triangles of {}, {:.3g} MB of {:.3g}, {} of {} parts "
        "left "
        "out; compiled in {:.2g} s",
        name, nearest, 1e3 * kIfov, fitted.report.triangles, full.report.triangles,
        1e-6 * static_cast<double>(fitted.report.bytes),
        1e-6 * static_cast<double>(full.report.bytes), fitted.report.fit.pieces_left_out,
        fitted.report.fit.pieces, fitted.seconds);
    const auto add = [&](double error, const char* unit, double uncertainty, double must) {
      context.add({.case_name = "budget",
                   .setting = setting,
                   .speed = ms,
                   .speed_unit = "ms/frame",
                   .error = error,
                   .error_unit = unit,
                   .reference = "the reference renderer, matte, every triangle; largest of 4 views",
                   .reference_error = uncertainty,
                   .runs = context.runs(),
                   .must_is_least = false,
                   .must_error = context.quick() ? 0 : must});
    };
    add(flux, "flux, relative", noise, kFlux);
    add(centre, "px, photocentre", 0, kCentroid);
  }
}

// Triangles of shapes against closed forms, for one tolerance.
void run_shapes(Context& context) {
  const std::vector<std::pair<std::string, geometry::Shape>> shapes = {
      {"sphere", geometry::Sphere{}},
      {"torus", geometry::Torus{}},
      {"cylinder", geometry::Cylinder{}}};
  for (const auto& [name, shape] : shapes)
    for (const double error : {1e-2, 1e-3, 1e-4, 1e-5}) {
      geometry::TessellationOptions options;
      options.max_error = error;
      DiagnosticLog log;
      const auto mesh = geometry::tessellated(shape, options, {}, log);
      if (!mesh) continue;
      const auto triangles = static_cast<double>(mesh->triangles.size());
      context.add({.case_name = "budget",
                   .setting = fmt::format("{}, radius 1 m, within {:g} m", name, error),
                   .speed = triangles,
                   .speed_unit = "triangles",
                   .error = triangles / fewest(shape, error),
                   .error_unit = "of the closed form",
                   .reference = "polygons of a circle's area, equilateral triangles on a sphere",
                   .runs = 1,
                   .must_is_least = false,
                   .must_error = 1.3});
    }
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  std::optional<preview::Renderer> renderer;
  if (gl) {
    context.set_renderer((*gl)->context().renderer());
    renderer.emplace(*gl);
  }
  preview::Renderer* const draws = renderer ? &*renderer : nullptr;
  run_shapes(context);
  const auto servicer = context.source("examples/servicer/servicer.pxn");
  run_model(context, draws, "servicer without foil", servicer, context.quick() ? 1e-4 : 5e-6,
            false);
  if (context.quick()) return;
  run_model(context, draws, "servicer", servicer, 5e-6);
  run_model(context, draws, "ISS",
            context.source("../shared/data/spacecraft-gltf/iss-draco-webp.glb"), 0);
}

const bool kAdded = add_case({"budget", "models as budgets near and far need them", run});

}  // namespace
}  // namespace panwright::bench::case_budget
