// Narrow highlights on curved surfaces: flux and pixels with and without the mean over what normals
// turn from sample to sample, by radius in pixels; what it costs.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_specular {

namespace {

constexpr double kRange = 1e5;

struct Shape {
  const char* name;
  const char* pxn;  // of radius 1
  double extent;    // of its image, in radii
};
constexpr Shape kShapes[] = {
    {"sphere", "<sphere radius=\"1\"/>", 2.2},
    {"rod", "<cylinder radius=\"1\" height=\"12\" rotate=\"0 37 0\"/>", 13},
    {"ring", "<torus radius=\"6\" tube_radius=\"1\" rotate=\"62 10 0\"/>", 15},
};

struct Paint {
  const char* name;
  const char* pxn;
};
constexpr Paint kPaints[] = {
    {"Cook-Torrance 0.02",
     "<cook> 1 0.02 1 1 </cook><specular>1 1 1</specular><reflect>0 1 0</reflect>"},
    {"GGX 0.06", "<ggx> 0.06 </ggx><specular>1 1 1</specular><reflect>0 1 0</reflect>"},
    {"Beckmann 0.1",
     "<beckmann> 0.1 </beckmann><specular>1 1 1</specular><reflect>0 1 0</reflect>"},
    {"GGX 0.05 x 0.2", "<ggx> 0.05 0.2 </ggx><specular>1 1 1</specular><reflect>0 1 0</reflect>"},
    {"coat 0.02 over Lambert", "<coat n=\"1.5\" slope=\"0.02\"/><diffuse>0.3 0.3 0.3</diffuse>"},
};

double flux_of(const image::Image& image) {
  double sum = 0;
  for (std::size_t i = 1; i < image.radiance.size(); i += 3)
    sum += static_cast<double>(image.radiance[i]);
  return sum;
}

// RMS of the difference over the RMS.
double apart(const image::Image& image, const image::Image& truth) {
  double off = 0, all = 0;
  for (std::size_t i = 1; i < image.radiance.size(); i += 3) {
    const auto is = static_cast<double>(image.radiance[i]);
    const auto should = static_cast<double>(truth.radiance[i]);
    off += (is - should) * (is - should);
    all += should * should;
  }
  return std::sqrt(off / all);
}

struct Errors {
  double flux = 0;    // rms over the offsets
  double bias = 0;    // mean
  double pixels = 0;  // rms over the offsets
  Timing timing;
};

struct Subject {
  world::World world;
  world::Camera camera;
};

std::optional<Subject> subject_of(Context& context, const Shape& shape, const Paint& paint,
                                  DiagnosticLog& log) {
  const auto path =
      write_scratch(context, "specular.pxn",
                    fmt::format("<pangu_model ver=\"1\"><material name=\"m\">{}</material><node "
                                "material=\"m\">{}</node></pangu_model>",
                                paint.pxn, shape.pxn));
  const auto model = workspace::open(path, {}, log);
  if (!model) return std::nullopt;
  Subject subject;
  static_cast<void>(subject.world.add("it", *model, log));
  subject.camera.position = {0, -kRange, 0};
  subject.camera.world_from_camera = *world::looking_at(subject.camera.position, Vec3(0), {}, log);
  world::Sun sun = subject.world.sun();
  // the half vector stands upright on the rod's axis, 22 degrees from the line of sight
  sun.direction = {std::cos(37 * kDegree), -1, -std::sin(37 * kDegree)};
  subject.world.set_sun(sun);
  return subject;
}

void set_radius(Subject& subject, const Shape& shape, double pixels) {
  const auto side = static_cast<std::uint32_t>(std::ceil(shape.extent * pixels) + 4);
  subject.camera.width = subject.camera.height = side;
  subject.camera.focal = Vec2(pixels * kRange);
}

preview::RenderOptions options_of(unsigned samples, bool filter) {
  preview::RenderOptions options;
  options.samples = samples;
  options.specular_filter = filter;
  options.imposters = preview::Imposters::off;
  return options;
}

void run_shape(Context& context, preview::Renderer& renderer, const Shape& shape,
               const Paint& paint, DiagnosticLog& log) {
  auto subject = subject_of(context, shape, paint, log);
  if (!subject)
    return context.note(fmt::format("{} of {} could not be compiled", shape.name, paint.name));
  const std::vector<double> radii =
      context.quick() ? std::vector{2.0} : std::vector{0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
  const int offsets = context.quick() ? 4 : 12;
  struct Way {
    const char* name;
    unsigned samples;
    bool filter;
  };
  constexpr Way kWays[] = {{"points", 1, false},
                           {"filtered", 1, true},
                           {"4x4 points", 4, false},
                           {"4x4 filtered", 4, true}};
  for (const double radius : radii) {
    set_radius(*subject, shape, radius);
    std::array<Errors, std::size(kWays)> errors;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> offset(-0.5, 0.5);
    for (int i = 0; i < offsets; ++i) {
      subject->camera.principal =
          Vec2(subject->camera.width / 2.0) + Vec2(offset(random), offset(random));
      const auto truth = renderer.render(subject->world, subject->camera,
                                         options_of(radius < 8 ? 64 : 32, false), log);
      if (!truth) return context.note("a highlight could not be drawn");
      for (std::size_t w = 0; w < std::size(kWays); ++w) {
        const auto image = renderer.render(subject->world, subject->camera,
                                           options_of(kWays[w].samples, kWays[w].filter), log);
        if (!image) return context.note("a highlight could not be drawn");
        const double off = flux_of(*image) / flux_of(*truth) - 1;
        const double each = apart(*image, *truth);
        errors[w].flux += off * off / offsets;
        errors[w].bias += off / offsets;
        errors[w].pixels += each * each / offsets;
      }
    }
    std::vector<Variant> variants;
    for (const Way& way : kWays)
      variants.push_back({way.name, [&] {
                            static_cast<void>(renderer.render(subject->world, subject->camera,
                                                              options_of(way.samples, way.filter),
                                                              log));
                          }});
    const std::vector<Timing> timings = interleaved(variants, 5);
    for (std::size_t w = 0; w < std::size(kWays); ++w) {
      const auto add = [&](const char* what, double error, const char* unit) {
        Row row{.case_name = "specular",
                .setting = fmt::format("{} {} r={}px {}{}", paint.name, shape.name, radius,
                                       kWays[w].name, what),
                .speed_unit = "ms/frame",
                .error = error,
                .error_unit = unit,
                .reference = radius < 8 ? "64x64 points" : "32x32 points",
                .reference_error = 1e-4};
        set_time(row, timings[w], 1e3);
        context.add(row);
      };
      add("", std::sqrt(errors[w].flux), "relative flux, rms");
      add(", bias", errors[w].bias, "relative flux, mean");
      add(", pixels", std::sqrt(errors[w].pixels), "of the RMS radiance, rms");
    }
  }
}

void run(Context& context) {
  DiagnosticLog log;
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return context.note("no OpenGL: nothing measured");
  context.set_renderer((*device)->context().renderer());
  preview::Renderer renderer(*device);
  for (const Shape& shape : kShapes)
    for (const Paint& paint : kPaints) {
      if (context.quick() && &paint != kPaints) continue;
      run_shape(context, renderer, shape, paint, log);
    }
  for (const Diagnostic& one : log.entries())
    if (one.severity() == Severity::error) context.note(one.message);
}

const bool kAdded =
    add_case({"specular", "narrow highlights on curved surfaces, averaged or at points", run});

}  // namespace

}  // namespace panwright::bench::case_specular
