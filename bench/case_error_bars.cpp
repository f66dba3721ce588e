// The reference renderer's error bars: how many pixels lie within three of them, and how wide they
// are beside the true errors, on twelve scenes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "preview/reference/reference.h"
#include "pxn/pxn.h"
#include "tests/support/view.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_error_bars {
namespace {

struct Scene {
  const char* name;
  const char* file;  // of the source tree, or the text of a model
  Vec3 camera;
  double field_of_view;  // degrees
  Vec3 to_sun;
  bool lambert = false;  // every surface
};

constexpr const char* kLobes = R"(<?xml version="1.0" encoding="UTF-8"?>
<pangu_model ver="1">
  <material name="floor">
    <diffuse> 0.3 0.2 0.1 </diffuse> <specular> 0.9 0.9 0.9 </specular>
    <ggx> 0.03 </ggx> <reflect> 0.5 0.5 0 </reflect>
  </material>
  <material name="ball">
    <specular> 0.9 0.8 0.5 </specular> <ggx> 0.01 </ggx> <reflect> 0 1 0 </reflect>
  </material>
  <material name="post"> <diffuse> 0.5 0.5 0.5 </diffuse> </material>
  <box size="3 3 0.1" translate="0 0 -0.4" material="floor"/>
  <sphere radius="0.5" translate="-0.6 0 0.2" material="ball"/>
  <sphere radius="0.5" translate="0.6 0 0.2" material="floor"/>
  <box size="0.3 0.3 1" translate="0 0.8 0.2" material="post"/>
</pangu_model>
)";
constexpr const char* kEmissive = R"(<?xml version="1.0" encoding="UTF-8"?>
<pangu_model ver="1">
  <material name="lamp">
    <diffuse> 0.2 0.2 0.2 </diffuse> <emissive> 0.9 0.5 0.2 </emissive> <reflect> 0.7 0 0.3 </reflect>
  </material>
  <material name="grey"> <diffuse> 0.6 0.6 0.6 </diffuse> </material>
  <box size="3 3 0.1" translate="0 0 -0.4" material="grey"/>
  <sphere radius="0.25" translate="-0.6 -0.4 0" material="lamp"/>
  <repeat count="5" var="i">
    <box size="0.05 0.2 0.2" translate="{-1 + 0.5*i} 0.5 0.2" material="lamp"/>
  </repeat>
  <box size="0.6 0.3 1" translate="0.4 0 0.2" material="grey"/>
</pangu_model>
)";
constexpr const char* kStruts = R"(<?xml version="1.0" encoding="UTF-8"?>
<pangu_model ver="1">
  <material name="grey"> <diffuse> 0.6 0.6 0.6 </diffuse> </material>
  <material name="metal">
    <specular> 0.9 0.9 0.9 </specular> <ggx> 0.2 </ggx> <reflect> 0 1 0 </reflect>
  </material>
  <repeat count="6" var="i">
    <box size="2.4 0.008 0.008" translate="0 0 {-1 + 0.4*i}" rotate="0 {i*7deg} 0" material="grey"/>
    <box size="0.01 0.01 2.4" translate="{-1 + 0.4*i} 0.1 0" rotate="0 {5deg + i*3deg} 0" material="metal"/>
  </repeat>
  <box size="0.5 0.5 0.5" material="grey"/>
</pangu_model>
)";
constexpr const char* kPlate = R"(<?xml version="1.0" encoding="UTF-8"?>
<pangu_model ver="1">
  <material name="white"> <diffuse> 0.8 0.8 0.8 </diffuse> </material>
  <box size="2 2 0.02" material="white"/>
</pangu_model>
)";

constexpr const char* kServicer = "examples/servicer/servicer.pxn";
constexpr Scene kScenes[] = {
    {"servicer, along its axes", kServicer, {12, 0, 6}, 45, {1, -0.7, 0.6}},
    {"servicer, aslant", kServicer, {8, -8.5, 5.5}, 47, {1, -0.6, 0.6}},
    {"servicer, close", kServicer, {-5, 3, 2.5}, 40, {-0.5, 0.7, 0.6}},
    {"servicer, far", kServicer, {600, 400, 300}, 3, {1, 0, 0.6}},
    {"servicer, Lambert", kServicer, {9, -11, 6}, 28, {1, 0.2, 0.5}, true},
    {"client", "examples/client/client.pxn", {4, -6, 3}, 40, {1, -0.5, 0.4}},
    {"cubesat", "examples/cubesat/cubesat.pxn", {0.5, -0.7, 0.4}, 40, {0.6, -0.8, 0.5}},
    {"calibration spheres", "examples/calibration/spheres.pxn", {0, -12, 0}, 26, {0.6, -0.8, 0.3}},
    {"narrow lobes", kLobes, {2, -4, 2}, 38, {-0.5, 0.6, 0.9}},
    {"emissive", kEmissive, {2, -4, 2}, 38, {-0.5, -0.6, 0.9}},
    {"thin struts", kStruts, {0.5, -5, 0.6}, 32, {-0.5, -0.6, 0.9}},
    {"plate", kPlate, {1, -2, 4}, 34, {0.5, 0.3, 0.9}},
};

world::ModelPtr model_of(const Context& context, const Scene& scene, DiagnosticLog& log) {
  const bool is_text = scene.file[0] == '<';
  const auto path = is_text ? write_scratch(context, fmt::format("{}.pxn", scene.name), scene.file)
                            : context.source(scene.file);
  if (path.empty()) return nullptr;
  if (!scene.lambert) {
    auto model = workspace::open(path, {}, log);
    return model ? *model : nullptr;
  }
  auto read = pxn::read(path, {}, log);
  if (!read) return nullptr;
  double albedo = 0.2;
  for (materials::Material& each : read->materials) {
    const std::string own = each.name;
    each = lambert_material(albedo);
    each.name = own;
    albedo = albedo > 0.7 ? 0.2 : albedo + 0.07;
  }
  return compiled_model(*read, log);
}

// What the bars of some images are worth.
struct Bars {
  std::size_t values = 0;  // pixels and channels that have light
  std::size_t within = 0;  // three standard errors
  double stated = 0;       // sums over pixels and channels
  double actual = 0;
  double seconds = 0;  // of one image
};

// `count` images of `samples` each against one of another seed and many more. A pixel's true error
// is the RMS over the images, less the reference's own.
Bars bars_of(const world::World& world, const world::Camera& camera,
             const preview::ReferenceImage& truth, preview::Reference& renderer,
             std::uint32_t samples, unsigned count, DiagnosticLog& log) {
  Bars bars;
  preview::ReferenceOptions options;
  options.samples = samples;
  const std::vector<float>& wanted = truth.image.radiance;
  std::vector<double> squares(wanted.size());
  for (unsigned seed = 0; seed < count; ++seed) {
    options.seed = seed;
    const auto image = renderer.render(world, camera, options, log);
    if (!image) return {};
    bars.seconds += image->seconds / count;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (!(wanted[i] > 0)) continue;
      const double error =
          static_cast<double>(image->image.radiance[i]) - static_cast<double>(wanted[i]);
      const double noise = static_cast<double>(truth.standard_error[i]);
      const double stated = static_cast<double>(image->standard_error[i]);
      ++bars.values;
      bars.within += std::fabs(error) <= 3 * std::sqrt(stated * stated + noise * noise);
      bars.stated += stated / count;
      squares[i] += (error * error - noise * noise) / count;
    }
  }
  for (const double square : squares) bars.actual += std::sqrt(std::max(0.0, square));
  return bars;
}

void measure(Context& context, const Scene& scene, DiagnosticLog& log) {
  const world::ModelPtr model = model_of(context, scene, log);
  if (!model)
    return context.note(fmt::format("{} cannot be read: its rows are missing", scene.name));
  const std::uint32_t side = context.quick() ? 16 : 48;
  preview::View view;
  world::set_field_of_view(view.camera, side, side, scene.field_of_view * kDegree);
  view.camera.position = scene.camera;
  view.camera.world_from_camera = *world::looking_at(scene.camera, Vec3(0), {}, log);
  view.to_sun = scene.to_sun;
  const world::World world = preview::world_of(model, view);

  preview::Reference renderer;
  preview::ReferenceOptions many;
  many.samples = context.quick() ? 256 : 4096;
  many.seed = 1'000'000;
  const auto truth = renderer.render(world, view.camera, many, log);
  if (!truth) return context.note(fmt::format("{} cannot be drawn", scene.name));
  for (const std::uint32_t samples : {8u, 16u, 32u, 64u}) {
    if (context.quick() && samples > 8) break;
    // as many samples in all, of which each pixel's true error is known to a tenth or better
    const unsigned count = context.quick() ? 4 : std::max(16u, 512 / samples);
    const Bars bars = bars_of(world, view.camera, *truth, renderer, samples, count, log);
    if (bars.values == 0) return context.note(fmt::format("{} shows nothing", scene.name));
    Row row;
    row.case_name = "error_bars";
    row.setting = fmt::format("{}: {} samples", scene.name, samples);
    row.speed = 1e3 * bars.seconds;
    row.speed_unit = "ms";
    row.runs = static_cast<int>(count);
    row.reference = fmt::format("{} samples; another seed", many.samples);
    row.error = 1 - static_cast<double>(bars.within) / static_cast<double>(bars.values);
    row.error_unit = "share of lit pixels beyond 3 sigma";
    row.must_error = context.quick() ? 0 : 0.01;
    context.add(row);
    row.error = bars.stated / bars.actual;
    row.error_unit = "mean stated over mean true error";
    row.must_error = context.quick() ? 0 : 1.5;
    context.add(row);
  }
}

void run(Context& context) {
  DiagnosticLog log;
  for (const Scene& scene : kScenes) {
    if (context.quick() && scene.file != kPlate) continue;
    measure(context, scene, log);
  }
}

const bool kAdded =
    add_case({"error_bars", "the reference renderer's error bars against true errors", run});

}  // namespace
}  // namespace panwright::bench::case_error_bars
