// Levels of detail of foil: what they send, in the mean over sheets and of one sheet as a camera
// comes closer, against the finest sheet.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "bench/bench.h"
#include "bench/far_flux.h"
#include "geometry/mesh/strip.h"
#include "mli/levels.h"
#include "mli/preset.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "preview/renderer.h"
#include "pxn/materials.h"
#include "tests/support/view.h"

namespace panwright::bench::case_levels {
namespace {

constexpr double kWidth = 1.28;  // metres
constexpr double kCrease = 30 * kDegree;

struct Wear {
  std::string name;
  materials::Material material;
};

std::optional<Wear> library(const char* name, DiagnosticLog& log) {
  auto described = pxn::preset(name, log);
  if (!described) return std::nullopt;
  return Wear{name, described->material};
}

Wear lambert() {
  Wear wear{"Lambert 0.5", {}};
  wear.material.diffuse = Vec3(0.5);
  return wear;
}

std::optional<mli::Sheet> sheet_of(std::vector<mli::Operation> operations, std::uint32_t cells,
                                   std::uint32_t seed, DiagnosticLog& log) {
  mli::Recipe recipe;
  recipe.width = recipe.height = kWidth;
  recipe.xgrid = cells;
  recipe.seed = seed;
  recipe.operations = std::move(operations);
  auto sheet = mli::made(recipe, {}, log);
  if (!sheet) return std::nullopt;
  return *std::move(sheet);
}

// A sheet with its levels, which materials share.
struct Meshes {
  geometry::Mesh fine;
  std::vector<mli::Level> levels;
};

std::optional<Meshes> meshes_of(const mli::Sheet& sheet, DiagnosticLog& log) {
  auto fine = mli::formed(sheet, mli::Flat{}, log);
  if (!fine) return std::nullopt;
  geometry::compute_normals(*fine, kCrease);
  return Meshes{*std::move(fine), mli::levels_of(sheet, mli::Flat{}, kCrease, 1e9)};
}

// At the root.
world::ModelPtr model_of(const Meshes& meshes, const Wear& wear, DiagnosticLog& log) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(meshes.fine, "sheet"));
  contents.materials = {wear.material};
  contents.instances.push_back({0, 0, 0, -1});
  for (const mli::Level& level : meshes.levels) {
    const auto mesh = static_cast<std::uint32_t>(contents.meshes.size());
    contents.levels.push_back({level.detail, level.error, 0, mesh, 0, 0});
    contents.meshes.push_back(pan::packed(level.mesh, fmt::format("level {}", mesh)));
  }
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "sheet", log);
  if (!model || !model->check(log)) return nullptr;
  return std::make_shared<const pan::Model>(*std::move(model));
}

world::ModelPtr crinkled(std::uint32_t cells, const Wear& wear, DiagnosticLog& log) {
  const auto operations = mli::preset_operations("crinkled", kWidth);
  const auto sheet = operations ? sheet_of(*operations, cells, 3, log) : std::nullopt;
  const auto meshes = sheet ? meshes_of(*sheet, log) : std::nullopt;
  return meshes ? model_of(*meshes, wear, log) : nullptr;
}

Vec3 direction(double degrees) {
  const auto t = det::sincos(degrees * kDegree);
  return {t.sin, 0, t.cos};
}

preview::View view_from(double viewer, double sun, double width, std::uint32_t side) {
  DiagnosticLog log;
  preview::View view;
  world::set_orthographic(view.camera, side, side, width);
  view.camera.position = 10.0 * direction(viewer);
  if (const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log))
    view.camera.world_from_camera = *turn;
  view.to_sun = direction(sun);
  return view;
}

// Once, for long series.
template <class Work>
Timing clocked(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const double seconds = seconds_since(start);
  return {seconds, seconds, seconds, 1};
}

// ---- the mean over sheets

struct Way {
  const char* name;
  double sun, viewer;  // degrees from the normal
};
constexpr Way kWays[] = {{"phase 0", 0, 0},
                         {"phase 60, 10 degrees off", 40, -20},
                         {"phase 90, mirrored", 45, -45},
                         {"phase 120, mirrored", 60, -60}};

constexpr std::size_t kLevels = 3;
constexpr std::uint32_t kFineSeeds = 8;  // the finest sheets say what rays and pixels miss

struct Far {
  Wear wear;
  std::array<std::array<FarFlux, kLevels + 1>, std::size(kWays)> sums{};
  double bounced = 0, direct = 0;  // of the first seed
};

// Adds a sheet, as traced and as drawn. False: it could not be drawn.
bool add_sheet(const world::ModelPtr& model, std::uint32_t seed, preview::Renderer& renderer,
               Far& far) {
  for (std::size_t w = 0; w < std::size(kWays); ++w) {
    const preview::View view = view_from(kWays[w].viewer, kWays[w].sun, 1.5, 48);
    const world::World world = preview::world_of(model, view);
    const auto want = traced_flux(world, view.camera, seed, 0);
    if (!want) return false;
    if (seed == 0) {
      far.bounced += traced_flux(world, view.camera, seed, 3).value_or(0);
      far.direct += *want;
    }
    for (std::size_t k = seed < kFineSeeds ? 0 : 1; k <= std::min(kLevels, model->levels().size());
         ++k)
      if (!far.sums[w][k].add(renderer, world, view.camera, *model, k, 4, *want)) return false;
  }
  return true;
}

void report_far(Context& context, const Far& far, double slope) {
  for (std::size_t w = 0; w < std::size(kWays); ++w)
    for (std::size_t k = 0; k <= kLevels; ++k) {
      const FarFlux& one = far.sums[w][k];
      if (one.seeds() == 0) continue;
      const bool promised = slope <= 0.2 && kWays[w].sun - kWays[w].viewer <= 90 && k > 0;
      context.add(one.row(
          "levels",
          fmt::format("far; {}; slope {:g}; {}; level {}", far.wear.name, slope, kWays[w].name, k),
          "sheet", promised && !context.quick() ? 0.03 : 0));
    }
  context.note(
      fmt::format("{}, slope {:g}: light between facets, which OpenGL leaves out, adds "
                  "{:.2g} to the flux of the finest sheet",
                  far.wear.name, slope, far.bounced / far.direct - 1));
}

void run_far(Context& context, preview::Renderer& renderer, std::vector<Far> fars, double slope) {
  const std::uint32_t seeds = context.quick() ? 2 : 64;
  DiagnosticLog log;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    const auto sheet = sheet_of(
        {mli::Random{1e-3}, mli::Smooth{8}, mli::SlopeRms{slope * std::sqrt(2.0)}}, 256, seed, log);
    const auto meshes = sheet ? meshes_of(*sheet, log) : std::nullopt;
    if (!meshes) return context.note("a sheet was refused");
    for (Far& far : fars) {
      const auto model = model_of(*meshes, far.wear, log);
      if (!model || !add_sheet(model, seed, renderer, far))
        return context.note("a sheet could not be drawn");
    }
  }
  for (const Far& far : fars) report_far(context, far, slope);
}

// ---- one sheet, as a camera comes closer

void run_approach(Context& context, preview::Renderer& renderer, const Wear& wear) {
  const int frames = context.quick() ? 12 : 200;
  DiagnosticLog log;
  const auto model = crinkled(512, wear, log);
  if (!model) return context.note("the crinkled sheet was refused");
  const auto range_of = [&](std::size_t frame) {
    return 26 * std::pow(400.0 / 26, static_cast<double>(frame) / (frames - 1));
  };
  struct Draw {
    bool levels;
    unsigned samples;  // 0: as many as pixel_error asks for
    double pixel_error;
    const char* name;
  };
  for (const Draw& draw : {Draw{false, 16, 0, "524288 triangles; 16x16 samples"},
                           Draw{true, 16, 0, "levels; 16x16 samples"},
                           Draw{true, 0, 0.05, "levels; as many samples as needed"},
                           Draw{true, 0, 0.02, "levels; as many samples as 2 % needs"}}) {
    std::vector<double> flux;
    std::vector<double> seconds;
    for (int i = 0; i < frames; ++i) {
      const double range = range_of(static_cast<std::size_t>(i));
      preview::View view = view_from(0, 0, 1, 128);
      world::set_pixel_angle(view.camera, 128, 128, 0.5e-3);
      view.camera.position = range * glm::normalize(Vec3(0.1, -0.2, 0.97));
      if (const auto turn = world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log))
        view.camera.world_from_camera = *turn;
      view.to_sun = glm::normalize(Vec3(0.5, 0.3, 1));
      const world::World world = preview::world_of(model, view);
      preview::RenderOptions options;
      options.samples = draw.samples;
      if (draw.samples == 0) options.pixel_error = draw.pixel_error;
      options.levels = draw.levels;
      const Timing timing = clocked([&] {
        auto image = renderer.render(world, view.camera, options, log);
        if (image) flux.push_back(flux_of(*image) * range * range);
      });
      seconds.push_back(timing.median);
    }
    if (flux.size() != static_cast<std::size_t>(frames)) return context.note("no image");
    // beyond the trend: half the second difference of the logarithm
    double step = 0;
    std::size_t at = 0;
    for (std::size_t i = 1; i + 1 < flux.size(); ++i) {
      const double one = std::fabs(std::log(flux[i - 1] * flux[i + 1] / (flux[i] * flux[i]))) / 2;
      if (one > step) at = i;
      step = std::max(step, one);
    }
    const auto slowest = std::max_element(seconds.begin(), seconds.end());
    context.note(fmt::format(
        "{}: the largest step at {:.0f} m; all frames {:.1f} s, the slowest {:.2f} s at {:.0f} m",
        draw.name, range_of(at), std::accumulate(seconds.begin(), seconds.end(), 0.0), *slowest,
        range_of(static_cast<std::size_t>(slowest - seconds.begin()))));
    std::nth_element(seconds.begin(), seconds.begin() + frames / 2, seconds.end());
    Row row{.case_name = "levels",
            .setting = fmt::format("approach of {} frames, 400 to 26 m; {}; {}", frames, wear.name,
                                   draw.name),
            .speed = seconds[static_cast<std::size_t>(frames) / 2] * 1e3,
            .speed_unit = "ms/frame",
            .error = step,
            .error_unit = "flux step beyond the trend",
            .reference = "the frames before and after",
            .reference_error = 0,
            .runs = frames,
            .must_error = draw.levels && draw.samples == 0 && !context.quick() ? 0.005 : 0};
    context.add(row);
  }
}

// ---- glints

constexpr std::size_t kShares = 4;
constexpr std::size_t kPercents[kShares] = {50, 75, 90, 99};

struct Glints {
  double peaks = 0;  // of a pixel over the sweep: local maxima above twice its mean
  std::array<double, kShares> quantiles{};  // of the radiance of all pixels and frames
  double mean = 0;
};

// side: pixels across
std::optional<Glints> glints(preview::Renderer& renderer, const world::ModelPtr& model,
                             double level, int degrees, std::uint32_t side) {
  std::vector<std::vector<float>> frames;
  DiagnosticLog log;
  for (int i = 0; i < degrees; ++i) {
    const preview::View view = view_from(-15, 15 + i - degrees / 2.0, kWidth, side);
    preview::RenderOptions options;
    options.samples = 8;
    options.level_pixel = level;
    auto image = renderer.render(preview::world_of(model, view), view.camera, options, log);
    if (!image) return std::nullopt;
    std::vector<float>& frame = frames.emplace_back();
    for (std::size_t p = 1; p < image->radiance.size(); p += 3) frame.push_back(image->radiance[p]);
  }
  Glints out;
  std::vector<float> all;
  for (std::size_t p = 0; p < frames.front().size(); ++p) {
    double mean = 0;
    for (const auto& frame : frames) mean += static_cast<double>(frame[p]);
    mean /= degrees;
    for (std::size_t i = 1; i + 1 < frames.size(); ++i)
      if (frames[i][p] > frames[i - 1][p] && frames[i][p] >= frames[i + 1][p] &&
          static_cast<double>(frames[i][p]) > 2 * mean)
        ++out.peaks;
    out.mean += mean;
  }
  for (const auto& frame : frames) all.insert(all.end(), frame.begin(), frame.end());
  for (std::size_t k = 0; k < kShares; ++k) {
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(all.size() * kPercents[k] / 100);
    std::nth_element(all.begin(), at, all.end());
    out.quantiles[k] = static_cast<double>(*at);
  }
  return out;
}

// At a pixel as wide as the cells of the first level, where it is shown first, and at twice that.
void run_glints(Context& context, preview::Renderer& renderer, const Wear& wear) {
  DiagnosticLog log;
  const auto model = crinkled(256, wear, log);
  if (!model || model->levels().size() < 2) return context.note("the crinkled sheet was refused");
  const int degrees = context.quick() ? 5 : 40;
  for (const std::uint32_t side : {128u, 64u}) {
    std::optional<Glints> fine;
    for (std::size_t k = 0; k < 3; ++k) {
      const double level = k == 0 ? 0 : model->levels()[k - 1].detail;
      std::optional<Glints> got;
      const Timing timing = clocked([&] { got = glints(renderer, model, level, degrees, side); });
      if (!got) return context.note("no image");
      if (k == 0) fine = got;
      const auto add = [&](std::string unit, double value, double want) {
        Row row{.case_name = "levels",
                .setting = fmt::format("glints, Sun through {} degrees; {}; cells of {:g} m under "
                                       "pixels of {:g} m",
                                       degrees, wear.name, k == 0 ? 0.005 : level, kWidth / side),
                .speed_unit = "ms/frame",
                .error = std::fabs(value / want - 1),
                .error_unit = std::move(unit),
                .reference = fmt::format("the finest sheet, {:.5g}", want),
                .reference_error = 0,
                .must_error = k == 1 && side == 128 && !context.quick() ? 0.1 : 0};
        set_time(row, timing, 1e3 / degrees);
        context.add(row);
      };
      if (k == 0) continue;
      add("number of peaks", got->peaks, fine->peaks);
      for (std::size_t q = 0; q < kShares; ++q)
        add(fmt::format("radiance, quantile of {} %", kPercents[q]), got->quantiles[q],
            fine->quantiles[q]);
      add("flux of the sweep", got->mean, fine->mean);
    }
  }
}

// Each part is a case: whole, all would take twenty minutes and more.
template <class Part>
void with_renderer(Context& context, const Part& part) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context");
  context.set_renderer((*gl)->context().renderer());
  preview::Renderer renderer(*gl);
  const auto gold = library("mli_gold_kapton", log);
  if (!gold) return context.note("the library has no mli_gold_kapton");
  part(renderer, *gold);
}

void run_far(Context& context, double slope) {
  with_renderer(context, [&](preview::Renderer& renderer, const Wear& gold) {
    run_far(context, renderer, {Far{lambert()}, Far{gold}}, slope);
  });
}

void run_near(Context& context) {
  with_renderer(context, [&](preview::Renderer& renderer, const Wear& gold) {
    run_approach(context, renderer, gold);
  });
}

void run_all_glints(Context& context) {
  with_renderer(context, [&](preview::Renderer& renderer, const Wear& gold) {
    run_glints(context, renderer, gold);
  });
}

const bool kAdded =
    add_case({"levels_near", "levels of detail of foil: coming closer", run_near}) &&
    add_case({"levels_glints", "levels of detail of foil: glints of a sweep", run_all_glints}) &&
    add_case({"levels_005", "levels of foil against the finest sheets from afar, slope 0.05",
              [](Context& context) { run_far(context, 0.05); }}) &&
    add_case({"levels_01", "levels of foil against the finest sheets from afar, slope 0.1",
              [](Context& context) { run_far(context, 0.1); }}) &&
    add_case({"levels_02", "levels of foil against the finest sheets from afar, slope 0.2",
              [](Context& context) { run_far(context, 0.2); }}) &&
    add_case({"levels_03", "levels of foil against the finest sheets from afar, slope 0.3",
              [](Context& context) { run_far(context, 0.3); }});

}  // namespace
}  // namespace panwright::bench::case_levels
