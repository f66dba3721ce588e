// Levels of detail of blankets over a box: what they send, in the mean over sheets, against the
// finest one, path traced.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "bench/bench.h"
#include "bench/scenes.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/view.h"

namespace panwright::bench {
namespace {

constexpr std::size_t kLevels = 4;

// Directions from the origin, in degrees about z from +x, and up.
struct Way {
  const char* name;
  double sun, sun_up, viewer, viewer_up;
};
constexpr Way kWays[] = {{"phase 0", 20, 15, 20, 15},
                         {"phase 40", 10, 30, 45, 10},
                         {"phase 90, mirrored by a side", 45, 0, -45, 0},
                         {"phase 90, oblique", 70, 40, -30, 35}};

struct Sums {
  double all = 0, wanted = 0, squares = 0;
  std::uint32_t seeds = 0;
  std::vector<double> seconds;
};

Vec3 direction(double around, double up) {
  const auto a = det::sincos(around * kDegree), b = det::sincos(up * kDegree);
  return {b.cos * a.cos, b.cos * a.sin, b.sin};
}

preview::View view_of(const Way& way) {
  DiagnosticLog log;
  preview::View view;
  world::set_orthographic(view.camera, 64, 64, 1.6);
  view.camera.position = 10.0 * direction(way.viewer, way.viewer_up);
  if (const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 0, 1), log))
    view.camera.world_from_camera = *turn;
  view.to_sun = direction(way.sun, way.sun_up);
  return view;
}

std::string box_text(const char* material, const char* preset, std::uint32_t seed) {
  return fmt::format(
      "<pangu_model ver=\"1\"><material name=\"grey\"><diffuse>0.5 0.5 0.5</diffuse></material>"
      "<box name=\"bus\" size=\"1 0.8 0.6\" material=\"grey\"/>"
      "<mli type=\"wrap\" on=\"bus\" standoff=\"2.5cm\" material=\"{}\" seed=\"{}\">"
      "<mli_operations preset=\"{}\"/></mli></pangu_model>",
      material, seed, preset);
}

double sum_of(const preview::Image& image) {
  double sum = 0;
  for (std::size_t i = 1; i < image.radiance.size(); i += 3)
    sum += static_cast<double>(image.radiance[i]);
  return sum;
}

using All = std::array<std::array<Sums, kLevels + 1>, std::size(kWays)>;

bool add_box(const Context& context, const char* material, const char* preset, std::uint32_t seed,
             preview::Renderer& renderer, All& sums) {
  DiagnosticLog log;
  const auto path = write_scratch(context, "wrapped_box.pxn", box_text(material, preset, seed));
  const auto scene = pxn::read(path, {}, log);
  const world::ModelPtr model = scene ? compiled_model(*scene, log) : nullptr;
  if (!model) return false;
  preview::Reference reference;
  for (std::size_t w = 0; w < std::size(kWays); ++w) {
    const preview::View view = view_of(kWays[w]);
    const world::World world = preview::world_of(model, view);
    preview::ReferenceOptions traced;
    traced.samples = 16;
    traced.bounces = 0;
    traced.seed = seed;
    const auto truth = reference.render(world, view.camera, traced, log);
    if (!truth) return false;
    const double want = sum_of(truth->image);
    for (std::size_t k = 0; k <= std::min(kLevels, model->levels().size()); ++k) {
      preview::RenderOptions options;
      options.samples = 6;
      options.level_pixel = k == 0 ? 0 : model->levels()[k - 1].detail;
      const auto start = std::chrono::steady_clock::now();
      const auto image = renderer.render(world, view.camera, options, log);
      if (!image) return false;
      const double got = sum_of(*image);
      Sums& s = sums[w][k];
      s.seconds.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      s.all += got;
      s.wanted += want;
      s.squares += (got - want) * (got - want);
      ++s.seeds;
    }
  }
  return true;
}

void report(Context& context, const char* material, const char* preset, All& sums) {
  for (std::size_t w = 0; w < std::size(kWays); ++w)
    for (std::size_t k = 0; k <= kLevels; ++k) {
      Sums& s = sums[w][k];
      if (s.seeds == 0) continue;
      const double mean = (s.all - s.wanted) / s.seeds;
      const double deviation =
          std::sqrt(std::max(s.squares - s.seeds * mean * mean, 0.0) / std::max(s.seeds - 1, 1u)) *
          s.seeds / s.wanted;
      std::sort(s.seconds.begin(), s.seconds.end());
      Row row{.case_name = "wrap_levels",
              .setting = fmt::format("{}, {}; {}; {}", preset, material, kWays[w].name,
                                     k == 0 ? "finest" : fmt::format("level {}", k)),
              .speed = s.seconds[s.seconds.size() / 2] * 1e3,
              .speed_unit = "ms/frame",
              .error = std::fabs(s.all / s.wanted - 1),
              .error_unit = "flux, mean of blankets",
              .reference =
                  fmt::format("finest blankets, path traced; {} seeds; {}; one box {:.2g}", s.seeds,
                              s.all < s.wanted ? "too dark" : "too bright", deviation),
              .reference_error = deviation / std::sqrt(s.seeds),
              .runs = static_cast<int>(s.seconds.size()),
              .must_error = k > 0 && !context.quick() ? 0.03 : 0};
      context.add(row);
    }
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context");
  context.set_renderer((*gl)->context().renderer());
  preview::Renderer renderer(*gl);
  const std::pair<const char*, const char*> kinds[] = {{"grey", "crinkled"},
                                                       {"mli_gold_kapton", "crinkled"},
                                                       {"mli_beta_cloth", "quilted"},
                                                       {"mli_silver", "smooth"}};
  for (const auto& [material, preset] : kinds) {
    All sums{};
    const std::uint32_t seeds = context.quick() ? 1 : 32;
    for (std::uint32_t seed = 0; seed < seeds; ++seed)
      if (!add_box(context, material, preset, seed, renderer, sums))
        return context.note(fmt::format("{} could not be drawn", material));
    report(context, material, preset, sums);
    if (context.quick()) break;
  }
}

const bool kAdded =
    add_case({"wrap_levels", "levels of detail of blankets, against the finest", run});

}  // namespace
}  // namespace panwright::bench
