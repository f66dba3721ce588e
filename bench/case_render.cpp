// Images of spheres: flux and photocentre against closed forms and facet sums; throughput.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "compiler/compile.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/model.h"
#include "preview/renderer.h"
#include "tests/support/model_renderer.h"
#include "tests/support/oracles.h"

namespace panwright::bench::case_render {

namespace {

// far enough for the closed forms of distant bodies: 1e-5 of the flux
constexpr double kRange = 1e5;
// R = 419 px at 1024 px
constexpr double kFieldOfView = 0.0014 * kDegree;

// What one image adds up to.
struct Measured {
  Vec3 intensity{0};  // per unit irradiance, m²/sr
  double offset = 0;  // of the green photocentre towards the Sun, pixels
  double focal = 0;   // pixels
  Timing timing;
};

class Studio {
 public:
  Studio(const std::shared_ptr<preview::Device>& gl, const geometry::SphereCounts& counts,
         const materials::Material& material, DiagnosticLog& log)
      : log_(log) {
    auto bytes = compiler::compiled(sphere_scene(counts, material), {}, log);
    if (!bytes) return;
    auto model = pan::Model::from_bytes(*bytes, "sphere", log);
    if (!model || !model->check(log)) return;
    model_ = std::make_unique<pan::Model>(*std::move(model));
    renderer_ = std::make_unique<support::ModelRenderer>(gl, *model_);
  }

  bool ready() const { return renderer_ != nullptr; }
  support::ModelRenderer& renderer() { return *renderer_; }

  // The camera on −y, the Sun at a phase angle towards +x, which is right in the image.
  static preview::View view(double phase, DiagnosticLog& log) {
    preview::View view;
    world::set_field_of_view(view.camera, 1024, 1024, kFieldOfView);
    view.camera.position = {0, -kRange, 0};
    const auto turn = world::looking_at(view.camera.position, Vec3(0), {}, log);
    if (turn) view.camera.world_from_camera = *turn;
    view.to_sun = {std::sin(phase), -std::cos(phase), 0};
    return view;
  }

  std::optional<Measured> measure(double phase, unsigned samples, bool flat, int runs,
                                  bool shadows = true) {
    const preview::View view_here = view(phase, log_);
    preview::RenderOptions options;
    options.samples = samples;
    options.flat = flat;
    if (!shadows) options.shadow_side = 0;
    std::optional<image::Image> kept;
    Measured out;
    out.timing = timed(
        [&] {
          auto image = renderer_->render(view_here, options, log_);
          if (image) kept = *std::move(image);
        },
        runs);
    if (!kept) return std::nullopt;
    const oracles::Image image{static_cast<int>(kept->width), static_cast<int>(kept->height),
                               std::move(kept->radiance)};
    out.focal = view_here.camera.focal.x;
    const oracles::ImageSum sum =
        oracles::pinhole_sum(image, out.focal, view_here.camera.principal);
    if (sum.not_finite > 0) return std::nullopt;
    out.intensity = sum.sum * kRange * kRange;
    out.offset = sum.centre[1].x - view_here.camera.principal.x;
    return out;
  }

 private:
  DiagnosticLog& log_;
  std::unique_ptr<pan::Model> model_;
  std::unique_ptr<support::ModelRenderer> renderer_;
};

double worst_relative(const Vec3& measured, const Vec3& expected) {
  const Vec3 ratio = glm::abs(measured / expected - Vec3(1));
  return std::max({ratio.x, ratio.y, ratio.z});
}

Row flux_row(const std::string& setting, const Measured& measured, const Vec3& expected,
             double must, const std::string& reference, double reference_error) {
  Row row{.case_name = "render",
          .setting = setting,
          .speed_unit = "ms/frame",
          .error = worst_relative(measured.intensity, expected),
          .error_unit = "relative flux",
          .reference = reference,
          .reference_error = reference_error,
          .must_error = must};
  set_time(row, measured.timing, 1e3);
  return row;
}

Vec3 figure8_closed_form(double phase_deg) {
  const materials::Material material = figure8_material();
  return material.weights.x * material.diffuse *
             oracles::lambert_sphere_intensity(phase_deg * kDegree) +
         material.weights.y * material.specular * *oracles::seed_lobe_intensity(phase_deg);
}

void run_figure8(Context& context, const std::shared_ptr<preview::Device>& gl, DiagnosticLog& log) {
  const geometry::SphereCounts counts{100, 60};
  const materials::Material material = figure8_material();
  Studio studio(gl, counts, material, log);
  const auto mesh = geometry::tessellated(geometry::Sphere{1, counts}, {}, {}, log);
  if (!studio.ready() || !mesh) return context.note("figure 8 could not be set up");
  const oracles::Brdf brdf = [&](const Vec3& n, const Vec3& l, const Vec3& v) {
    return material.weights.x * material.diffuse / kPi +
           material.weights.y * material.specular * oracles::seed_lobe(n, l, v);
  };
  const Vec3 to_viewer(0, -1, 0);
  for (const double phase_deg : {0.0, 60.0, 90.0}) {
    const Vec3 to_sun(std::sin(phase_deg * kDegree), -std::cos(phase_deg * kDegree), 0);
    const auto smooth = studio.measure(phase_deg * kDegree, 4, false, context.quick() ? 1 : 3);
    const auto flat = studio.measure(phase_deg * kDegree, 4, true, context.quick() ? 1 : 3);
    if (!smooth || !flat) {
      context.note(fmt::format("figure 8 at phase {} was not rendered", phase_deg));
      continue;
    }
    const std::string setting = fmt::format("figure8 phase={} samples=4", phase_deg);
    context.add(flux_row(setting, *smooth, figure8_closed_form(phase_deg), 3e-3,
                         "closed form and table", 1e-6));
    const oracles::FarField facets = oracles::facet_sum(*mesh, brdf, to_sun, to_viewer);
    context.add(flux_row(setting + " flat", *flat, facets.intensity, 1e-4, "facet sum", 1e-12));
    const oracles::FarField field = oracles::smooth_sum(*mesh, brdf, to_sun, to_viewer, 1e-6);
    context.add(flux_row(setting + " smooth", *smooth, field.intensity, 1e-4,
                         "sum over facets with interpolated normals",
                         field.error / field.intensity.z));
  }
}

void run_lambert(Context& context, const std::shared_ptr<preview::Device>& gl, DiagnosticLog& log,
                 std::uint32_t side, unsigned samples, bool bound) {
  Studio studio(gl, {side, side}, lambert_material(1), log);
  if (!studio.ready()) return context.note("a Lambert sphere could not be set up");
  for (const double phase_deg : {0.0, 60.0, 90.0}) {
    if (!bound && phase_deg != 60) continue;
    const double phase = phase_deg * kDegree;
    const auto measured = studio.measure(phase, samples, false, context.quick() ? 1 : 5);
    if (!measured) {
      context.note(fmt::format("a Lambert sphere at phase {} was not rendered", phase_deg));
      continue;
    }
    const std::string setting = fmt::format("lambert phase={} triangles={} samples={}", phase_deg,
                                            2 * side * (side - 1), samples);
    context.add(flux_row(setting, *measured, Vec3(oracles::lambert_sphere_intensity(phase)),
                         bound ? 5e-4 : 0, "closed form", 1e-5));
    const double expected = oracles::lambert_sphere_photocentre(phase) * measured->focal / kRange;
    Row row = context.rows().back();
    row.error = std::fabs(measured->offset - expected);
    row.error_unit = "px photocentre";
    row.reference_error = 1e-3;  // 0.16 R²/d at 419 px, and the float of the pixel sums
    row.must_error = bound ? 0.02 : 0;
    context.add(row);
  }
}

// Without shadows, against the same context's draw of the same triangles with the shortest shader
// there is.
void run_throughput(Context& context, const std::shared_ptr<preview::Device>& gl,
                    DiagnosticLog& log) {
  const std::uint32_t side = context.quick() ? 100 : 708;  // 708: 1,001,112 triangles
  Studio studio(gl, {side, side}, lambert_material(1), log);
  if (!studio.ready()) return context.note("the throughput model could not be set up");
  const double phase = 60 * kDegree;
  const preview::View view = Studio::view(phase, log);
  std::vector<double> ratios;
  std::optional<Measured> measured;
  for (int run = 0; run < context.runs(); ++run) {
    const double bare = studio.renderer().seconds_of_bare_draw(view);
    measured = studio.measure(phase, 1, false, 1, false);
    if (!measured) return context.note("the throughput model was not rendered");
    // note: the first pass warms up
    if (run > 0) ratios.push_back(bare / measured->timing.median);
  }
  std::sort(ratios.begin(), ratios.end());
  Row row =
      flux_row(fmt::format("throughput triangles={} 1024x1024", 2 * side * (side - 1)), *measured,
               Vec3(oracles::lambert_sphere_intensity(phase)), 5e-4, "closed form", 1e-5);
  row.speed = ratios[ratios.size() / 2];
  row.speed_unit = "bare/full";
  row.spread = 0.5 * (ratios[ratios.size() * 3 / 4] - ratios[ratios.size() / 4]);
  row.runs = static_cast<int>(ratios.size());
  row.must = context.quick() ? 0 : 0.6;
  context.add(row);
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) {
    context.note("no OpenGL context: nothing measured");
    return;
  }
  context.set_renderer((*gl)->context().renderer());
  run_figure8(context, *gl, log);
  run_lambert(context, *gl, log, context.quick() ? 100 : 400, 4, !context.quick());
  for (const std::uint32_t side : {25u, 50u, 100u, 200u, 800u})
    if (!context.quick()) run_lambert(context, *gl, log, side, 4, false);
  for (const unsigned samples : {1u, 2u, 8u})
    if (!context.quick()) run_lambert(context, *gl, log, 400, samples, false);
  run_throughput(context, *gl, log);
}

const bool kAdded = add_case({"render", "images of spheres against closed forms; throughput", run});

}  // namespace

}  // namespace panwright::bench::case_render
