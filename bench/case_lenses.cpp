// Lenses with distortion in OpenGL beside the pinhole of the same focal length: time, and errors
// against the reference's rays.
#include <fmt/core.h>

#include <cmath>

#include "bench/bench.h"
#include "preview/lens_renderer.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_lenses {

namespace {

struct Lens {
  const char* name;
  double focal;  // in parts of the image's width
  sensor::Distortion distortion;
};

const Lens kLenses[] = {
    {"brown, mild", 1.6, sensor::Brown{{-0.1, 0.02, 5e-4, -3e-4}}},
    {"brown, barrel", 0.86, sensor::Brown{{-0.3, 0.1, 4e-3, -3e-3, -0.01}}},
    {"fisheye, 120 degrees", 0.48, sensor::Fisheye{{-0.02, 0.005, 0, 0}}},
    {"CAHVOR", 0.94,
     sensor::Cahvore{.axis = glm::normalize(Vec3(0.02, -0.01, 1)), .r = {0, -0.1, 0.02}}},
};

struct Way {
  const char* name;
  unsigned samples;
  bool adaptive;
  double pixel_error;
};
constexpr Way kWays[] = {
    {"draft", 4, true, 0}, {"auto 5%", 0, false, 0.05}, {"auto 1%", 0, false, 0.01}};

preview::RenderOptions options_of(const Way& way) {
  preview::RenderOptions options;
  options.samples = way.samples;
  options.adaptive = way.adaptive;
  if (way.samples == 0) options.pixel_error = way.pixel_error;
  options.shadows = preview::Shadows::hard;
  return options;
}

struct Errors {
  double rms = 0;          // in parts of the RMS radiance
  double flux = 0;         // relative
  double photocentre = 0;  // pixels
};

Errors errors_of(const image::Image& image, const image::Image& reference) {
  double squares = 0, whole = 0, sum = 0, flux = 0;
  Vec2 moment(0), exact(0);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const Vec2 at(static_cast<double>(i % image.width) + 0.5,
                  static_cast<double>(i / image.width) + 0.5);
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const auto value = static_cast<double>(image.radiance[k]);
      const auto right = static_cast<double>(reference.radiance[k]);
      squares += (value - right) * (value - right);
      whole += right * right;
      sum += value;
      flux += right;
      moment += value * at;
      exact += right * at;
    }
  }
  return {std::sqrt(squares / whole), sum / flux - 1, glm::length(moment / sum - exact / flux)};
}

// Standard error of the reference's pixels, as Errors::rms.
double noise_of(const preview::ReferenceImage& traced) {
  double squares = 0, whole = 0;
  for (std::size_t i = 0; i < traced.standard_error.size(); ++i) {
    squares += std::pow(static_cast<double>(traced.standard_error[i]), 2);
    whole += std::pow(static_cast<double>(traced.image.radiance[i]), 2);
  }
  return std::sqrt(squares / whole);
}

class Scene {
 public:
  Scene(Context& context, const std::shared_ptr<preview::Device>& device, world::ModelPtr model)
      : context_(context), renderer_(device) {
    static_cast<void>(world_.add("target", std::move(model), {}, log_));
    world::Sun sun;
    sun.direction = Vec3(0.5, -1, 0.3);
    world_.set_sun(sun);
  }

  // distance: metres; near: the target fills the image, far: it has a few pixels in a corner
  void time(const Lens& lens, bool far) {
    const std::uint32_t size = context_.quick() ? 64 : 512;
    world::Camera camera;
    camera.width = camera.height = size;
    camera.focal = Vec2(lens.focal * size);
    camera.principal = Vec2(size / 2.0);
    camera.position = far ? Vec3(40, -180, 60) : Vec3(2, -5 * lens.focal - 2, 3);
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log_);
    if (far)
      camera.world_from_camera =
          camera.world_from_camera *
          glm::angleAxis(std::atan(0.5 / lens.focal), glm::normalize(Vec3(1, -1, 0)));
    world::Camera distorted = camera;
    distorted.distortion = std::make_shared<sensor::DistortionMap>(lens.distortion);
    preview::ReferenceOptions traced;
    traced.samples = context_.quick() ? 8 : far ? 1024 : 64;
    traced.bounces = 0;
    traced.sun_disc = false;
    const auto exact = reference_.render(world_, distorted, traced, log_);
    const auto plain = reference_.render(world_, camera, traced, log_);
    if (!exact || !plain) return context_.note(fmt::format("{} cannot be traced", lens.name));
    std::vector<Variant> variants;
    std::vector<Errors> errors;
    for (const Way& way : kWays)
      for (const bool with : {false, true}) {
        const auto draw = [this, way, with, camera, distorted] {
          return with ? lens_.render(renderer_, world_, distorted, options_of(way), log_)
                      : renderer_.render(world_, camera, options_of(way), log_);
        };
        const auto image = draw();
        if (!image) return context_.note(fmt::format("{} cannot be drawn", lens.name));
        errors.push_back(errors_of(*image, with ? exact->image : plain->image));
        variants.push_back(
            {fmt::format("lens={} target={} way={} {}", lens.name, far ? "far" : "near", way.name,
                         with ? "distorted" : "pinhole"),
             [draw] { static_cast<void>(draw()); }});
        context_.note(fmt::format("{}: flux off by {:+.2e}, photocentre by {:.4f} px",
                                  variants.back().setting, errors.back().flux,
                                  errors.back().photocentre));
      }
    const std::vector<Timing> timings = interleaved(variants, context_.runs());
    for (std::size_t i = 0; i < timings.size(); ++i) {
      Row row;
      row.case_name = "lenses";
      row.setting = variants[i].setting;
      row.speed_unit = "ms";
      set_time(row, timings[i], 1e3);
      row.error = errors[i].rms;
      row.error_unit = "relative RMS";
      row.reference = fmt::format("path tracer, {} rays a pixel", traced.samples);
      row.reference_error = noise_of(i % 2 == 1 ? *exact : *plain);
      context_.add(row);
    }
  }

 private:
  Context& context_;
  preview::Renderer renderer_;
  preview::LensRenderer lens_;
  preview::Reference reference_;
  world::World world_;
  DiagnosticLog log_;
};

void run_lenses(Context& context) {
  DiagnosticLog log;
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  const auto path = context.source("examples/client/client.pxn");
  auto model = path.empty() ? failed : workspace::open(path, {}, log);
  if (!device || !model) return context.note("no context or no client: the rows are missing");
  context.set_renderer((*device)->context().renderer());
  Scene scene(context, *device, *model);
  for (const bool far : {false, true})
    for (const Lens& lens : kLenses) {
      scene.time(lens, far);
      if (context.quick()) return;
    }
}

const bool kAdded =
    add_case({"lenses", "lenses with distortion beside pinholes: time, errors", run_lenses});

}  // namespace

}  // namespace panwright::bench::case_lenses
