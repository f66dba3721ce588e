// OpenGL against the reference renderer, BRDF by BRDF: a sphere, and the servicer in some of them
// and from twelve sides.
// Three rows each: flux, RMSE, FLIP, beside the time of a frame.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "bench/bench.h"
#include "bench/flip.h"
#include "bench/scenes.h"
#include "materials/spectra.h"
#include "pan/model.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/model_renderer.h"
#include "tests/support/view.h"

namespace panwright::bench::case_accuracy {
namespace {

using materials::DiffuseModel;
using materials::Material;
using materials::SpecularModel;

constexpr unsigned kSamples = 4;  // N×N points a pixel of OpenGL

std::vector<std::pair<std::string, Material>> all_brdfs() {
  std::vector<std::pair<std::string, Material>> all;
  const auto add = [&](const char* name, Material material) {
    material.name = name;
    materials::fit(material);
    all.emplace_back(name, std::move(material));
  };
  const auto diffuse = [](DiffuseModel brdf) {
    Material m;
    m.diffuse = Vec3(0.8, 0.6, 0.4);
    m.diffuse_brdf = materials::default_brdf(brdf);
    return m;
  };
  add("Lambert", diffuse(DiffuseModel::lambert));
  Material m = diffuse(DiffuseModel::oren_nayar);
  m.diffuse_brdf = materials::OrenNayar{0.4};
  add("Oren-Nayar 1994", m);
  m = diffuse(DiffuseModel::eon);
  m.diffuse_brdf = materials::Eon{0.8};
  add("EON", m);
  m = diffuse(DiffuseModel::hapke);
  m.diffuse_brdf = materials::Hapke{
      .w = 0.3, .h = 0.07, .b0 = 1, .roughness = 20 * kDegree, .b = 0.24, .c = 0.3};
  add("Hapke", m);
  m = diffuse(DiffuseModel::lommel_seeliger);
  m.diffuse_brdf = materials::LommelSeeliger{0.3};
  add("Lommel-Seeliger", m);

  const auto glossy = [](SpecularModel brdf, double alpha) {
    Material g;
    g.diffuse = Vec3(0.6, 0.3, 0.1);
    g.specular = Vec3(1);
    g.weights = {0.7, 0.3, 0};
    g.specular_brdf = materials::with_slopes(brdf, Vec2(alpha));
    g.refract = Vec3(1.5);
    return g;
  };
  m = glossy(SpecularModel::blinn_phong, 0.1);
  m.refract = {};
  m.specular_brdf = materials::BlinnPhong{64};
  add("Blinn-Phong", m);
  add("Cook-Torrance", glossy(SpecularModel::cook_torrance, 0.15));
  add("Beckmann", glossy(SpecularModel::beckmann, 0.15));
  add("GGX", glossy(SpecularModel::ggx, 0.15));

  const auto metal = [&](SpecularModel brdf, double alpha, double alpha_y, const char* name) {
    Material g = glossy(brdf, alpha);
    g.weights = {0, 1, 0};
    g.specular_brdf = materials::with_slopes(brdf, {alpha, alpha_y});
    if (const auto constants = materials::metal(name)) {
      g.refract = constants->n;
      g.extinction = constants->k;
    }
    return g;
  };
  add("GGX aluminium 0.3", metal(SpecularModel::ggx, 0.3, 0.3, "Al"));
  add("GGX aluminium 0.08 x 0.32", metal(SpecularModel::ggx, 0.08, 0.32, "Al"));
  add("GGX gold 0.05", metal(SpecularModel::ggx, 0.05, 0.05, "Au"));
  m = metal(SpecularModel::ggx, 0.06, 0.06, "Al");
  m.coat = materials::Coat{1.7, 0.03, Vec3(0.05, 0.2, 3)};
  add("coated aluminium", m);
  m = diffuse(DiffuseModel::lambert);
  m.coat = materials::Coat{1.5, 0.1, Vec3(0)};
  add("coated Lambert", m);
  return all;
}

preview::View view_from(const Vec3& eye, const Vec3& target, double fov, const Vec3& to_sun,
                        std::uint32_t side, DiagnosticLog& log) {
  preview::View view;
  world::set_field_of_view(view.camera, side, side, fov);
  view.camera.position = eye;
  if (const auto turn = world::looking_at(eye, target, {}, log))
    view.camera.world_from_camera = *turn;
  view.to_sun = to_sun;
  return view;
}

std::vector<float> shown(const image::Image& image) {
  std::vector<float> rgb(image.radiance.size());
  std::transform(image.radiance.begin(), image.radiance.end(), rgb.begin(),
                 [](float value) { return static_cast<float>(kPi) * value; });
  return rgb;
}

// The irradiance that an image holds, of its brightest channel.
double flux_of(const image::Image& image, const world::Camera& camera) {
  Vec3 sum(0);
  for (std::uint32_t row = 0; row < image.height; ++row)
    for (std::uint32_t column = 0; column < image.width; ++column) {
      const std::size_t at = 3 * (std::size_t{row} * image.width + column);
      const double solid_angle = world::pixel_solid_angle(camera, column, row);
      for (int k = 0; k < 3; ++k)
        sum[k] +=
            solid_angle * static_cast<double>(image.radiance[at + static_cast<std::size_t>(k)]);
    }
  return std::max({sum.x, sum.y, sum.z});
}

void compare(Context& context, const std::shared_ptr<preview::Device>& gl,
             const std::string& setting, const world::ModelPtr& model, const preview::View& view,
             std::uint32_t bounces, double until_error, DiagnosticLog& log) {
  support::ModelRenderer renderer(gl, *model);
  preview::RenderOptions fast;
  fast.samples = kSamples;
  std::optional<image::Image> image;
  const Timing timing = timed(
      [&] {
        auto drawn = renderer.render(view, fast, log);
        if (drawn) image = *std::move(drawn);
      },
      context.runs());
  preview::ReferenceOptions slow;
  slow.bounces = bounces;
  slow.until_error = context.quick() ? 0 : until_error;
  slow.samples = context.quick() ? 8 : 32;
  slow.max_samples = 256;
  const auto ground_truth =
      preview::Reference().render(world_of(model, view), view.camera, slow, log);
  if (!image || !ground_truth) return;

  const std::vector<float> seen = shown(*image);
  const std::vector<float> wanted = shown(ground_truth->image);
  double squares = 0;
  double noise = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    // note: what a display clips is not counted, or one glint would be all there is
    const double a = std::min(static_cast<double>(seen[i]), 1.0);
    const double b = std::min(static_cast<double>(wanted[i]), 1.0);
    squares += (a - b) * (a - b);
    const double sigma = kPi * static_cast<double>(ground_truth->standard_error[i]);
    if (b < 1) noise += sigma * sigma;
  }
  const auto count = static_cast<double>(seen.size());
  const double true_flux =
      std::max({ground_truth->flux.x, ground_truth->flux.y, ground_truth->flux.z});
  const double flux_error = std::max({ground_truth->flux_error.x, ground_truth->flux_error.y,
                                      ground_truth->flux_error.z}) /
                            true_flux;
  const std::string against =
      fmt::format("reference renderer; {} bounces; {} samples", bounces, ground_truth->samples);
  const auto add = [&](const char* unit, double error, double uncertainty) {
    Row row;
    row.case_name = "accuracy";
    row.setting = setting;
    set_time(row, timing, 1e3);
    row.speed_unit = "ms/frame";
    row.error = error;
    row.error_unit = unit;
    row.reference = against;
    row.reference_error = uncertainty;
    context.add(row);
  };
  add("flux", std::fabs(flux_of(*image, view.camera) / true_flux - 1), flux_error);
  add("rmse", std::sqrt(squares / count), std::sqrt(noise / count));
  add("flip", mean_flip(wanted, seen, image->width, image->height), 0);
}

// The servicer as authored, from the corners of an icosahedron.
void compare_sides(Context& context, const std::shared_ptr<preview::Device>& gl,
                   const world::ModelPtr& model, std::uint32_t side, DiagnosticLog& log) {
  constexpr double kGolden = 1.618033988749895;
  const Vec3 center(0, 0, 0.4);
  const Vec3 to_sun(1, 0.2, 0.5);
  for (int corner = 0; corner < 12; ++corner) {
    Vec3 out(0);
    out[corner / 4] = corner & 1 ? -1 : 1;
    out[(corner / 4 + 1) % 3] = corner & 2 ? -kGolden : kGolden;
    out = glm::normalize(out);
    const preview::View view =
        view_from(center + 15.3 * out, center, 24 * kDegree, to_sun, side, log);
    const double phase = std::acos(glm::dot(out, glm::normalize(to_sun))) / kDegree;
    compare(context, gl,
            fmt::format("servicer from ({:.2f} {:.2f} {:.2f}), phase {:.0f} deg", out.x, out.y,
                        out.z, phase),
            model, view, 0, 2e-3, log);
    if (context.quick()) return;
  }
}

void run_accuracy(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) {
    context.note("there is no OpenGL context, so nothing was measured");
    return;
  }
  context.set_renderer((*gl)->context().renderer());
  const std::uint32_t side = context.quick() ? 64 : 256;
  const Vec3 to_sun(0.8, -0.5, 0.33);
  for (const auto& [name, material] : all_brdfs()) {
    const world::ModelPtr model = compiled_model(sphere_scene({240, 480}, material), log);
    if (!model) return;
    // the sphere fills nine tenths of the image
    const preview::View view =
        view_from({0, -20, 0}, Vec3(0), 2 * std::asin(1.0 / 18), to_sun, side, log);
    compare(context, *gl, "sphere, " + name, model, view, 0, 5e-4, log);
    if (context.quick()) break;
  }
  const auto path = context.source("examples/servicer/servicer.pxn");
  if (path.empty()) return;
  auto scene = pxn::read(path, {}, log);
  if (!scene) return;
  const auto authored = compiled_model(*scene, log);
  const preview::View view =
      view_from({9, -11, 6}, {0, 0, 0.4}, 24 * kDegree, {1, 0.2, 0.5}, side, log);
  if (!authored) return;
  compare(context, *gl, "servicer, as authored", authored, view, 0, 2e-3, log);
  compare(context, *gl, "servicer, as authored, with light between surfaces", authored, view, 3,
          2e-3, log);
  compare_sides(context, *gl, authored, side, log);
  if (context.quick()) return;
  for (const auto& [name, material] : all_brdfs()) {
    const std::string_view shown[] = {"Lambert",           "Hapke",         "Cook-Torrance", "GGX",
                                      "GGX aluminium 0.3", "coated Lambert"};
    if (std::find(std::begin(shown), std::end(shown), name) == std::end(shown)) continue;
    scene::Scene worn = *scene;
    for (materials::Material& each : worn.materials) {
      const std::string own = each.name;
      each = material;
      each.name = own;
    }
    const auto model = compiled_model(worn, log);
    if (model) compare(context, *gl, "servicer, " + name, model, view, 0, 2e-3, log);
  }
}

const bool kAdded =
    add_case({"accuracy", "OpenGL against the reference renderer, BRDF by BRDF", run_accuracy});

}  // namespace
}  // namespace panwright::bench::case_accuracy
