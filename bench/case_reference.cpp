// The reference renderer: rays a second, beside what the image is off by.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "bench/bench.h"
#include "geometry/ray/instances.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/writer.h"
#include "preview/reference/reference.h"
#include "tests/support/oracles.h"
#include "tests/support/view.h"

namespace panwright::bench::case_reference {

namespace {

constexpr double kDistance = 1e5;  // radii

world::ModelPtr ball(std::uint32_t rings) {
  DiagnosticLog log;
  const auto mesh =
      geometry::tessellated(geometry::Sphere{1, geometry::SphereCounts{rings, rings}}, {}, {}, log);
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(*mesh, "ball"));
  contents.materials.push_back({});
  contents.instances.push_back({0, 0, 0, -1});
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "ball.pan", log);
  model->check(log);
  return std::make_shared<const pan::Model>(std::move(*model));
}

// The ball fills the image but for its corners; radius in pixels.
preview::View view_of(double radius, std::uint32_t size, double phase) {
  DiagnosticLog log;
  preview::View view;
  view.camera.width = view.camera.height = size;
  view.camera.focal = Vec2(radius * kDistance);
  view.camera.principal = Vec2(size / 2.0);
  view.camera.position = Vec3(0, -kDistance, 0);
  view.camera.world_from_camera = *world::looking_at(view.camera.position, Vec3(0), {}, log);
  view.to_sun = view.camera.world_from_camera * Vec3(det::sin(phase), 0, -det::cos(phase));
  return view;
}

double flux_error(const preview::ReferenceImage& image, double phase) {
  const double exact = 0.8 * oracles::lambert_sphere_intensity(phase);
  return std::fabs(image.flux.x * kDistance * kDistance / exact - 1);
}

// Whole images: camera rays are those of a ball that is lit from behind, where nothing else is
// to do; shadow rays come with the camera rays of a ball that is lit from the camera.
void images(Context& context, const world::ModelPtr& model, double mesh_error) {
  DiagnosticLog log;
  preview::Reference reference;
  const std::uint32_t size = context.quick() ? 64 : 512;
  preview::ReferenceOptions options;
  options.samples = context.quick() ? 8 : 16;
  options.sun_disc = false;
  options.bounces = 0;
  preview::ReferenceImage lit, dark, full;
  const auto render = [&](double phase, const preview::ReferenceOptions& how) {
    const preview::View view = view_of(0.41 * size, size, phase);
    return *reference.render(world_of(model, view), view.camera, how, log);
  };
  preview::ReferenceOptions all;
  all.samples = options.samples;
  const std::vector<Timing> timings = interleaved({{"dark", [&] { dark = render(kPi, options); }},
                                                   {"lit", [&] { lit = render(0, options); }},
                                                   {"full", [&] { full = render(kPi / 3, all); }}},
                                                  context.quick() ? 2 : 5);
  const auto row = [&](std::string setting, const Timing& timing, double rays, double error,
                       double uncertainty) {
    Row result{.case_name = "reference",
               .setting = std::move(setting),
               .speed_unit = "Mray/s",
               .error = error,
               .error_unit = "relative flux",
               .reference = "closed form of the Lambert sphere",
               .reference_error = mesh_error + uncertainty};
    set_rate(result, timing, 1e-6 * rays);
    return result;
  };
  Row camera =
      row("camera rays, whole image", timings[0], static_cast<double>(dark.camera_rays), 0, 0);
  context.add(camera);
  Row shadow = row("shadow rays, beside as many camera rays, whole image", timings[1],
                   static_cast<double>(lit.shadow_rays), flux_error(lit, 0),
                   3 * lit.flux_error.x / lit.flux.x);
  if (!context.quick()) shadow.must_error = 1e-4;
  context.add(shadow);
  context.add(row("all rays, Sun disc and 3 bounces, phase 60, whole image", timings[2],
                  static_cast<double>(full.camera_rays + full.shadow_rays + full.bounce_rays),
                  flux_error(full, kPi / 3), 3 * full.flux_error.x / full.flux.x));
}

// The rays alone, without what is done at their ends: on a grid over the ball from far away, and
// from its surface to the Sun.
void rays(Context& context, std::uint32_t rings) {
  DiagnosticLog log;
  const auto mesh =
      geometry::tessellated(geometry::Sphere{1, geometry::SphereCounts{rings, rings}}, {}, {}, log);
  geometry::InstanceCaster caster;
  caster.add(caster.add_mesh(mesh->positions, mesh->triangles), Mat4(1), false);
  caster.build();
  const int side = context.quick() ? 64 : 1024;
  std::vector<geometry::Ray> camera, shadow;
  double worst = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec3 aside(2.2 * (x + 0.5) / side - 1.1, 2.2 * (y + 0.5) / side - 1.1, 0);
      camera.push_back({aside + Vec3(0, 0, kDistance), Vec3(0, 0, -1)});
      const auto hit = caster.closest(camera.back());
      if (!hit) continue;
      const Vec3 at = aside + Vec3(0, 0, kDistance - hit->distance);
      worst = std::max(worst, std::fabs(glm::length(at) - 1));
      shadow.push_back({at * (1 + 2 * mesh->error), glm::normalize(Vec3(0.6, 0, 0.8))});
    }
  const auto cast = [&](const std::vector<geometry::Ray>& all, bool any) {
    constexpr std::size_t kChunk = 4096;
    std::vector<std::size_t> hits((all.size() + kChunk - 1) / kChunk);
    parallel_for(hits.size(), [&](std::size_t task) {
      const std::size_t end = std::min(all.size(), (task + 1) * kChunk);
      for (std::size_t i = task * kChunk; i < end; ++i)
        hits[task] += any ? caster.any(all[i]) : caster.closest(all[i]).has_value();
    });
    return std::accumulate(hits.begin(), hits.end(), std::size_t{0});
  };
  std::size_t seen = 0, dark = 0;
  const std::vector<Timing> timings = interleaved({{"camera", [&] { seen = cast(camera, false); }},
                                                   {"shadow", [&] { dark = cast(shadow, true); }}},
                                                  context.quick() ? 2 : 5);
  if (dark == 0 || seen != shadow.size()) context.note("rays of the ball miss it");
  for (const bool is_shadow : {false, true}) {
    Row row{.case_name = "reference",
            .setting = fmt::format("{} rays alone, {} triangles", is_shadow ? "shadow" : "camera",
                                   mesh->triangles.size()),
            .speed_unit = "Mray/s",
            .error = worst,
            .error_unit = "m",
            .reference = "sphere of radius 1 m; the mesh's own error is included",
            .reference_error = mesh->error,
            .must = is_shadow ? 4.0 : 8.0,
            .must_error = mesh->error + 1e-9};
    set_rate(row, timings[is_shadow],
             1e-6 * static_cast<double>((is_shadow ? shadow : camera).size()));
    context.add(row);
  }
}

// A ball whose disc is 1 % of a pixel, to 0.1 %.
void small_ball(Context& context, const world::ModelPtr& model, double mesh_error) {
  DiagnosticLog log;
  preview::Reference reference;
  preview::ReferenceOptions options;
  options.until_error = context.quick() ? 1e-2 : 1e-3 / 3;
  preview::ReferenceImage image;
  preview::View view = view_of(0.1 / std::sqrt(kPi), 16, kPi / 3);
  view.camera.principal = Vec2(8.13, 8.81);
  const world::World world = world_of(model, view);
  const Timing timing = timed([&] { image = *reference.render(world, view.camera, options, log); },
                              context.quick() ? 2 : 5);
  Row row{.case_name = "reference",
          .setting = fmt::format("a ball over 1 % of a pixel, --until-error {:.2g}%",
                                 100 * options.until_error),
          .speed_unit = "ms",
          .error = flux_error(image, kPi / 3),
          .error_unit = "relative flux",
          .reference = "closed form of the Lambert sphere",
          .reference_error = mesh_error,
          .must = 2000,
          .must_is_least = false};
  if (!context.quick()) row.must_error = 1e-3;
  set_time(row, timing, 1e3);
  context.add(row);
}

void run(Context& context) {
  const std::uint32_t rings = context.quick() ? 60 : 400;
  const world::ModelPtr model = ball(rings);
  // what chords take off the disc
  const double mesh_error = 1 - std::sin(2 * kPi / rings) / (2 * kPi / rings);
  rays(context, rings);
  images(context, model, mesh_error);
  small_ball(context, model, mesh_error);
}

const bool kAdded = add_case({"reference", "the path tracer's rays and errors", run});

}  // namespace

}  // namespace panwright::bench::case_reference
