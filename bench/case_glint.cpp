// The Sun's glint on a flat plate: OpenGL against a quadrature over the Sun's disc, in the plane of
// incidence and across it, 1° about the specular direction; and single against double precision.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/random.h"
#include "bench/bench.h"
#include "compiler/compile.h"
#include "geometry/tessellate/shape.h"
#include "materials/brdf.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "preview/renderer.h"
#include "tests/support/disc_quadrature.h"
#include "tests/support/model_renderer.h"
#include "tests/support/view.h"

namespace panwright::bench::case_glint {
namespace {

using namespace disc_quadrature;
using materials::Material;
using materials::SpecularModel;

struct BrdfRow {
  const char* name;
  Brdf brdf;
  SpecularModel model;
  Long index;
};
constexpr BrdfRow kBrdfs[] = {
    {"Cook-Torrance", Brdf::cook_torrance, SpecularModel::cook_torrance, 1.5L},
    {"Beckmann", Brdf::beckmann, SpecularModel::beckmann, 1.5L},
    {"GGX", Brdf::ggx, SpecularModel::ggx, 1.5L},
    {"Blinn-Phong", Brdf::blinn_phong, SpecularModel::blinn_phong, 0}};

Material material_of(const BrdfRow& brdf, double slope) {
  Material m;
  m.name = "plate";
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  if (brdf.index > 0) m.refract = Vec3(static_cast<double>(brdf.index));
  m.specular_brdf = brdf.model == SpecularModel::blinn_phong
                        ? materials::SpecularBrdf(materials::BlinnPhong{2 / (slope * slope)})
                        : materials::with_slopes(brdf.model, Vec2(slope));
  materials::fit(m);
  return m;
}

// A square of 8 m in the plane z = 0.
world::ModelPtr plate_of(const Material& material, DiagnosticLog& log) {
  pan::Contents contents;
  geometry::Mesh mesh;
  mesh.positions = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
  mesh.normals = std::vector<Vec3>(4, Vec3(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  contents.meshes.push_back(pan::packed(mesh, "plate"));
  contents.materials = {material};
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({0, 0, 0, -1});
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "plate", log);
  if (!model || !model->check(log)) return nullptr;
  return std::make_shared<const pan::Model>(*std::move(model));
}

struct Errors {
  double peak = 0;      // relative, at the specular direction
  double profile = 0;   // over the largest of the profile
  double integral = 0;  // of the profile in the image, relative
  std::string where;    // of the profile's
  Timing timing;
};

// One image; whole: all of its pixels, else those in the plane of incidence and across it.
void compare(Context& context, const std::shared_ptr<preview::Device>& gl, const BrdfRow& brdf,
             Long slope, double theta_deg, Long au, Long limb, bool whole, Errors& worst) {
  DiagnosticLog log;
  const auto model = plate_of(material_of(brdf, static_cast<double>(slope)), log);
  if (!model) return context.note("the plate was refused");
  const std::uint32_t side = whole ? 41 : 81;
  const double theta = theta_deg * kDegree;
  preview::View view;
  world::set_field_of_view(view.camera, side, side, 2 * kDegree);
  view.camera.position = Vec3(std::sin(theta), 1e-9, std::cos(theta));
  if (const auto turn = world::looking_at(view.camera.position, Vec3(0), {}, log))
    view.camera.world_from_camera = *turn;
  view.to_sun = Vec3(-std::sin(theta), 0, std::cos(theta));
  view.sun_distance = static_cast<double>(au);
  world::World world = preview::world_of(model, view);
  world::Sun sun = world.sun();
  sun.limb_darkening = static_cast<double>(limb);
  world.set_sun(sun);
  preview::Renderer renderer(gl);
  preview::RenderOptions options;
  options.samples = 1;
  options.shadow_side = 0;
  std::optional<image::Image> image;
  worst.timing = timed(
      [&] {
        auto drawn = renderer.render(world, view.camera, options, log);
        if (drawn) image = *std::move(drawn);
      },
      1);
  if (!image) return context.note("no image");
  double largest = 0, error = 0, want_sum = 0, got_sum = 0;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      if (!whole && x != side / 2 && y != side / 2) continue;
      const Vec2 plane = (Vec2(x + 0.5, y + 0.5) - view.camera.principal) / view.camera.focal;
      const Vec3 v = view.camera.world_from_camera * -glm::normalize(Vec3(plane, 1));
      const auto want = static_cast<double>(over_disc({brdf.brdf, slope, slope, brdf.index},
                                                      {view.to_sun.x, 0, view.to_sun.z},
                                                      {v.x, v.y, v.z}, kRadius / au, limb));
      const auto got = static_cast<double>(image->radiance[3 * (std::size_t{y} * side + x)]);
      largest = std::max(largest, want);
      error = std::max(error, std::fabs(got - want));
      if (!whole && x == side / 2 && y == side / 2)
        worst.peak = std::max(worst.peak, std::fabs(got / want - 1));
      want_sum += want;
      got_sum += got;
    }
  if (whole) {
    worst.integral = std::max(worst.integral, std::fabs(got_sum / want_sum - 1));
    return;
  }
  if (error / largest <= worst.profile) return;
  worst.profile = error / largest;
  worst.where = fmt::format("slope {:g}; {:g}°", static_cast<double>(slope), theta_deg);
}

void run_plate(Context& context, const std::shared_ptr<preview::Device>& gl, const BrdfRow& brdf,
               Long au, Long limb) {
  Errors worst;
  for (const Long slope : {0.001L, 0.003L, 0.01L, 0.03L, 0.1L})
    for (const double theta : {0.0, 30.0, 60.0, 75.0, 85.0}) {
      if (context.quick() && (slope != 0.003L || theta != 75)) continue;
      compare(context, gl, brdf, slope, theta, au, limb, false, worst);
      if (!context.quick() && (theta == 0 || theta == 75) && (slope == 0.001L || slope == 0.01L))
        compare(context, gl, brdf, slope, theta, au, limb, true, worst);
    }
  Row row{
      .case_name = "glint",
      .setting = fmt::format("{}; Sun at {:g} AU; limb darkening {:g}", brdf.name,
                             static_cast<double>(au), static_cast<double>(limb)),
      .speed_unit = "ms/frame",
      .error_unit = "",
      .reference = "quadrature over the disc in long double; slopes 0.001 to 0.1; 0 to 85 degrees",
      .reference_error = 1e-5};
  set_time(row, worst.timing, 1e3);
  const auto add = [&](const char* unit, double error, double must) {
    row.error = error;
    row.error_unit = unit;
    row.must_error = context.quick() ? 0 : must;
    context.add(row);
  };
  add("peak, relative", worst.peak, 0.02);
  add("profile, of its largest", worst.profile, 0.02);
  if (!context.quick()) add("integral, relative", worst.integral, 1e-3);
  if (!worst.where.empty())
    context.note(fmt::format("{}: the profile is worst at {}", row.setting, worst.where));
}

// The largest |f32 - f64|/f64 where f64 is above 1e-6 of its largest, lights and viewers up to an
// angle.
double single_precision(const Material& m, double most_deg, int count) {
  const materials::f32::CompiledBrdf single(m);
  const materials::f64::CompiledBrdf twice(m);
  const materials::ShadingContext local{Vec3(1, 0, 0)};
  struct Pair {
    double got, want;
  };
  std::vector<Pair> all;
  double largest = 0;
  const double slope = std::max(materials::slopes_of(m).value_or(Vec2(0.1)).x, 2e-3);
  for (int i = 0; i < count; ++i) {
    const auto words = philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {7, 0});
    const double theta = most_deg * kDegree * (i % 4 == 0 ? 1.0 : in_unit(words[0]));
    const auto t = det::sincos(theta);
    const Vec3 l(-t.sin, 0, t.cos);
    // about the mirrored direction, as far as the lobe goes
    const double in = theta + 6 * slope * (in_unit(words[1]) - 0.5);
    const double out = 6 * slope * (in_unit(words[2]) - 0.5) * t.cos;
    if (!(in < most_deg * kDegree)) continue;
    const auto a = det::sincos(in);
    const auto b = det::sincos(out);
    const glm::vec3 viewer(Vec3(a.sin * b.cos, b.sin, a.cos * b.cos));
    const materials::Incidence light = materials::sunlight(Vec3(glm::vec3(l)));
    const double want = twice.brdf(light, Vec3(viewer), Vec3(0, 0, 1), Vec3(1), local).x;
    const auto got =
        static_cast<double>(single.brdf(light, viewer, glm::vec3(0, 0, 1), glm::vec3(1), local).x);
    all.push_back({got, want});
    largest = std::max(largest, want);
  }
  double worst = 0;
  for (const Pair& one : all)
    if (one.want > 1e-6 * largest)
      worst = std::max(worst, std::fabs(one.got - one.want) / one.want);
  return worst;
}

void run_precision(Context& context) {
  const int count = context.quick() ? 500 : 20000;
  for (const BrdfRow& brdf : kBrdfs)
    for (const double slope : {0.001, 0.01, 0.1}) {
      const Material m = material_of(brdf, slope);
      for (const double most : {80.0, 85.0, 89.9}) {
        double worst = 0;
        const Timing timing = timed([&] { worst = single_precision(m, most, count); }, 1);
        Row row{.case_name = "glint",
                .setting = fmt::format("precision; {}; slope {:g}; to {:g} degrees", brdf.name,
                                       slope, most),
                .speed_unit = "ns/pair",
                .error = worst,
                .error_unit = "single precision, relative",
                .reference = "the same text in double",
                .reference_error = 1e-12};
        set_time(row, timing, 1e9 / count);
        context.add(row);
      }
    }
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context");
  const std::shared_ptr<preview::Device> device = *std::move(gl);
  context.set_renderer(device->context().renderer());
  for (const BrdfRow& brdf : kBrdfs)
    for (const auto& [au, limb] : {std::pair{0.3L, 0.0L}, std::pair{1.0L, 0.0L},
                                   std::pair{1.0L, 0.6L}, std::pair{5.0L, 0.0L}})
      run_plate(context, device, brdf, au, limb);
  run_precision(context);
}

const bool kAdded =
    add_case({"glint", "the Sun's glint on a flat plate against a quadrature over its disc", run});

}  // namespace
}  // namespace panwright::bench::case_glint
