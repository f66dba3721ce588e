// Levels of detail of blankets over a box: what they send, in the mean over sheets, against the
// finest one, path traced.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "bench/bench.h"
#include "bench/far_flux.h"
#include "bench/scenes.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/view.h"

namespace panwright::bench::case_wrap_levels {
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
      "<pangu_model ver=\"1\"><material name=\"grey\"><diffuse>0.5 0.5 0.5</diffuse></material>{}"
      "<box name=\"bus\" size=\"1 0.8 0.6\" material=\"grey\"/>"
      "<mli type=\"wrap\" on=\"bus\" standoff=\"2.5cm\" material=\"{}\" seed=\"{}\">"
      "<mli_operations preset=\"{}\"/></mli></pangu_model>",
      std::string_view(material) == "grey"
          ? ""
          : fmt::format("<material name=\"{0}\" preset=\"{0}\"/>", material),
      material, seed, preset);
}

using All = std::array<std::array<FarFlux, kLevels + 1>, std::size(kWays)>;

bool add_box(const Context& context, const char* material, const char* preset, std::uint32_t seed,
             preview::Renderer& renderer, All& sums) {
  DiagnosticLog log;
  const auto path = write_scratch(context, "wrapped_box.pxn", box_text(material, preset, seed));
  const auto scene = pxn::read(path, {}, log);
  const world::ModelPtr model = scene && !log.has_errors() ? compiled_model(*scene, log) : nullptr;
  if (!model) return false;
  for (std::size_t w = 0; w < std::size(kWays); ++w) {
    const preview::View view = view_of(kWays[w]);
    const world::World world = preview::world_of(model, view);
    const auto want = traced_flux(world, view.camera, seed, 0);
    if (!want) return false;
    for (std::size_t k = 0; k <= std::min(kLevels, model->levels().size()); ++k)
      if (!sums[w][k].add(renderer, world, view.camera, *model, k, 6, *want)) return false;
  }
  return true;
}

void report(Context& context, const char* material, const char* preset, const All& sums) {
  for (std::size_t w = 0; w < std::size(kWays); ++w)
    for (std::size_t k = 0; k <= kLevels; ++k)
      if (const FarFlux& one = sums[w][k]; one.seeds() > 0)
        context.add(one.row("wrap_levels",
                            fmt::format("{}, {}; {}; {}", preset, material, kWays[w].name,
                                        k == 0 ? "finest" : fmt::format("level {}", k)),
                            "blanket", k > 0 && !context.quick() ? 0.03 : 0));
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
}  // namespace panwright::bench::case_wrap_levels
