// Shadows of the Sun's disc: hard, and as the mean over points of it, against the reference
// renderer.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/model_renderer.h"

namespace panwright::bench::case_penumbra {
namespace {

struct Errors {
  double flux = 0;   // relative
  double rmse = 0;   // over the RMS of the image
  double worst = 0;  // of a pixel, in parts of the brightest of a hundred
  double noise = 0;  // of the reference, as rmse
};

Errors errors(const image::Image& image, const preview::ReferenceImage& truth) {
  double sum = 0;
  double off = 0;
  double square = 0;
  double square_off = 0;
  double noise = 0;
  double most = 0;
  std::vector<float> bright = truth.image.radiance;
  std::sort(bright.begin(), bright.end());
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    const double t = truth.image.radiance[i];
    const double d = image.radiance[i] - t;
    const double e = truth.standard_error[i];
    sum += t;
    off += d;
    square += t * t;
    square_off += d * d;
    noise += e * e;
    // what the reference is sure of
    most = std::max(most, std::fabs(d) - 4 * e);
  }
  return {std::fabs(off / sum), std::sqrt(square_off / square),
          most / bright[bright.size() * 99 / 100], std::sqrt(noise / square)};
}

struct Way {
  const char* name;
  preview::Shadows shadows;
  unsigned points;
  unsigned samples;
  bool disc;  // of the reference
};

constexpr Way kWays[] = {
    {"hard; reference without disc", preview::Shadows::hard, 64, 16, false},
    {"hard", preview::Shadows::hard, 64, 16, true},
    {"8 points", preview::Shadows::soft, 8, 16, true},
    {"16 points", preview::Shadows::soft, 16, 16, true},
    {"32 points", preview::Shadows::soft, 32, 16, true},
    {"64 points", preview::Shadows::soft, 64, 16, true},
    {"auto", preview::Shadows::automatic, 64, 0, true},
};

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*gl)->context().renderer());
  const auto scene = pxn::read(context.source("examples/servicer/servicer.pxn"), {}, log);
  const world::ModelPtr model = scene ? compiled_model(*scene, log) : nullptr;
  if (!model) return context.note("the servicer could not be compiled: " + to_text(log));
  support::ModelRenderer renderer(*gl, *model);
  const std::uint32_t side = context.quick() ? 64 : 256;
  const std::vector<double> distances = context.quick() ? std::vector{5.0} : std::vector{5.0, 13.0};
  const auto ways = std::span(kWays).first(context.quick() ? 3 : std::size(kWays));
  for (const double distance : distances) {
    preview::View view;
    world::set_field_of_view(view.camera, side, side, 45 * kDegree);
    view.camera.position = distance * glm::normalize(Vec3(8, -8.5, 5.5));
    if (const auto turn = world::looking_at(view.camera.position, Vec3(0), {}, log))
      view.camera.world_from_camera = *turn;
    view.to_sun = {1, -0.6, 0.6};
    const world::World world = preview::world_of(model, view);
    std::optional<preview::ReferenceImage> truths[2];
    for (const bool disc : {false, true}) {
      preview::ReferenceOptions exact;
      exact.bounces = 0;
      exact.sun_disc = disc;
      exact.samples = context.quick() ? 16 : 512;
      auto truth = preview::Reference().render(world, view.camera, exact, log);
      if (!truth) return context.note("the reference could not be drawn: " + to_text(log));
      truths[disc] = *std::move(truth);
    }
    const auto options_of = [](const Way& way) {
      preview::RenderOptions options;
      options.samples = way.samples;
      options.shadows = way.shadows;
      options.sun_points = way.points;
      options.levels = false;
      return options;
    };
    bool turned = false;
    std::vector<Variant> variants;
    for (const Way& way : ways)
      variants.push_back({way.name, [&, options = options_of(way)] {
                            // another Sun for each image, so that its maps are drawn again
                            preview::View other = view;
                            other.to_sun.z += turned ? 1e-9 : 2e-9;
                            turned = !turned;
                            static_cast<void>(renderer.render(other, options, log));
                          }});
    const std::vector<Timing> timings = interleaved(variants, context.quick() ? 1 : 3);
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const auto image = renderer.render(view, options_of(kWays[i]), log);
      if (!image) return context.note("a view could not be drawn: " + to_text(log));
      const Errors found = errors(*image, *truths[kWays[i].disc]);
      Row row;
      row.case_name = "penumbra";
      row.setting =
          fmt::format("servicer from {:g} m, {}x{}; {}", distance, side, side, kWays[i].name);
      row.speed_unit = "ms/frame";
      set_time(row, timings[i], 1e3);
      row.reference = "reference renderer; 0 bounces";
      row.error = found.flux;
      row.error_unit = "flux";
      if (kWays[i].shadows == preview::Shadows::soft && kWays[i].points >= 64)
        row.must_error = 1e-3;
      context.add(row);
      row.must_error = 0;
      row.error = found.rmse;
      row.error_unit = "rmse";
      row.reference_error = found.noise;
      context.add(row);
      row.reference_error = 0;
      row.error = found.worst;
      row.error_unit = "worst pixel, of the brightest of a hundred";
      context.add(row);
    }
  }
}

const bool kAdded = add_case({"penumbra", "shadows of the Sun's disc against the reference", run});

}  // namespace
}  // namespace panwright::bench::case_penumbra
