// Sun shadows: what they cost, beside how far off their edges and the flux are.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/bench.h"
#include "compiler/compile.h"
#include "pan/model.h"
#include "preview/renderer.h"
#include "pxn/pxn.h"
#include "tests/support/model_renderer.h"
#include "tests/support/sun_rays.h"
#include "workspace/open.h"

namespace panwright::bench::case_shadows {

namespace {

struct Side {
  const char* name;
  Vec3 camera;
  Vec3 to_sun;
};

constexpr double kFieldOfView = 47 * kDegree;

preview::View view_of(const Side& side, std::uint32_t pixels, DiagnosticLog& log) {
  preview::View view;
  world::set_field_of_view(view.camera, pixels, pixels, kFieldOfView);
  view.camera.position = side.camera;
  const auto turn = world::looking_at(side.camera, Vec3(0), {}, log);
  if (turn) view.camera.world_from_camera = *turn;
  view.to_sun = side.to_sun;
  return view;
}

// What an image with shadows is, against rays.
struct Errors {
  double flux = 0;   // relative
  double edge = 0;   // texels across the Sun's rays, 99 of 100 wrong pixels
  double wrong = 0;  // share of the lit pixels that rays answer otherwise, partly shaded ones half
};

Errors errors(const pan::Model& model, const preview::View& view, const image::Image& with,
              const image::Image& without, unsigned side) {
  const support::SunRays rays(model, view);
  const double texel = rays.texel(std::max(side, 16u));
  double drawn = 0;
  double traced = 0;
  double off = 0;
  std::size_t lit = 0;
  std::vector<double> edges;
  for (std::uint32_t y = 0; y < with.height; ++y)
    for (std::uint32_t x = 0; x < with.width; ++x) {
      const std::size_t i = 3 * (std::size_t{y} * with.width + x) + 1;
      const double whole = without.radiance[i];
      if (!(whole > 0)) continue;
      const auto point = rays.seen({x + 0.5, y + 0.5});
      if (!point || !(glm::dot(point->normal, glm::normalize(view.to_sun)) > 0)) continue;
      ++lit;
      const double sun = rays.lit(point->start) ? 1 : 0;
      drawn += with.radiance[i];
      traced += whole * sun;
      const double share = std::fabs(with.radiance[i] / whole - sun);
      off += share;
      if (share > 0.5 && side > 0) edges.push_back(rays.to_edge(*point, texel) / texel);
    }
  std::sort(edges.begin(), edges.end());
  return {std::fabs(drawn / traced - 1), edges.empty() ? 0 : edges[(edges.size() - 1) * 99 / 100],
          off / static_cast<double>(lit)};
}

// renderers: the second keeps its map
void run_side(Context& context, std::array<support::ModelRenderer, 2>& renderers,
              const pan::Model& model, const Side& side, DiagnosticLog& log) {
  const preview::View small = view_of(side, 256, log);
  const preview::View large = view_of(side, context.quick() ? 256 : 1024, log);
  const auto render = [&](const preview::View& view, unsigned texels, std::size_t which = 0) {
    preview::RenderOptions options;
    options.shadow_side = texels;
    auto image = renderers[which].render(view, options, log);
    return image ? *std::move(image) : image::Image{};
  };
  const image::Image without = render(small, 0);
  bool turned = false;
  const auto other_sun = [&](unsigned texels) {
    // another Sun for each image, so that the map is drawn again
    preview::View view = large;
    view.to_sun += Vec3(0, 0, turned ? 1e-9 : 2e-9);
    turned = !turned;
    render(view, texels);
  };
  const std::vector<Variant> variants = {
      {"shadows=off", [&] { render(large, 0); }},
      {"shadows=1024", [&] { other_sun(1024); }},
      {"shadows=2048", [&] { other_sun(2048); }},
      {"shadows=4096", [&] { other_sun(4096); }},
      {"shadows=2048 same Sun", [&] { render(large, 2048, 1); }},
  };
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  const unsigned sides[] = {0, 1024, 2048, 4096, 2048};
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Errors found = errors(model, small, render(small, sides[i]), without, sides[i]);
    const std::string setting = fmt::format("servicer {} {} {}x{}", side.name, variants[i].setting,
                                            large.camera.width, large.camera.height);
    Row row;
    row.case_name = "shadows";
    row.setting = setting;
    row.speed_unit = "ms/frame";
    row.reference = "one ray to the Sun a pixel, 256x256";
    set_time(row, timings[i], 1e3);
    row.error = found.flux;
    row.error_unit = "relative flux";
    context.add(row);
    row.error = found.wrong;
    row.error_unit = "share of lit pixels";
    context.add(row);
    if (sides[i] == 0) continue;
    row.error = found.edge;
    row.error_unit = "texels, 99 % of edges";
    row.must_error = 1.5;
    context.add(row);
  }
}

// Scanned ground: pixels that are dark by themselves, among lit ones, where a ray to the Sun is
// free; and the same of pixels that are lit among dark ones.
void run_ground(Context& context, const std::shared_ptr<preview::Device>& gl, DiagnosticLog& log) {
  const std::filesystem::path file = context.source("../shared/data/small-bodies/67P-CG.obj");
  if (file.empty()) return context.note("67P-CG.obj is not at hand");
  workspace::OpenOptions open;
  open.cad.units = "m";
  const auto model = workspace::open(file, open, log);
  if (!model) return context.note("67P-CG.obj could not be read");
  support::ModelRenderer renderer(gl, **model);
  const auto bounds = (*model)->world_bounds();
  const Vec3 middle = bounds->centre();
  const double size = bounds->diagonal();
  std::size_t dark = 0, bright = 0, lit = 0;
  Timing timing;
  const int suns = context.quick() ? 2 : 12;
  for (int i = 0; i < suns; ++i) {
    preview::View view;
    const std::uint32_t pixels = context.quick() ? 128 : 384;
    world::set_field_of_view(view.camera, pixels, pixels, 24 * kDegree);
    const double around = 2.4 * i;
    view.camera.position =
        middle + 2.4 * size * glm::normalize(Vec3(std::cos(around), std::sin(around), 0.3));
    const auto turn = world::looking_at(view.camera.position, middle, {}, log);
    if (turn) view.camera.world_from_camera = *turn;
    // phase angles from 20 to 140 degrees
    const double phase = (20 + 120.0 * i / std::max(suns - 1, 1)) * kDegree;
    view.to_sun = view.camera.world_from_camera * Vec3(std::sin(phase), 0.2, -std::cos(phase));
    preview::RenderOptions options;
    const auto image = renderer.render(view, options, log);
    options.shadow_side = 0;
    const auto without = renderer.render(view, options, log);
    if (!image || !without) return context.note("67P could not be drawn");
    const support::SunRays rays(**model, view);
    const auto is_lit = [&](std::size_t p) {
      return image->radiance[3 * p + 1] > 0.5f * without->radiance[3 * p + 1];
    };
    for (std::uint32_t y = 1; y + 1 < pixels; ++y)
      for (std::uint32_t x = 1; x + 1 < pixels; ++x) {
        const std::size_t p = std::size_t{y} * pixels + x;
        int neighbours = 0, lit_ones = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const std::size_t q =
                p + static_cast<std::size_t>(dy) * pixels + static_cast<std::size_t>(dx);
            if (q == p || !(without->radiance[3 * q + 1] > 0)) continue;
            ++neighbours;
            lit_ones += is_lit(q);
          }
        if (!(without->radiance[3 * p + 1] > 0) || neighbours < 8) continue;
        lit += is_lit(p);
        const bool alone = is_lit(p) ? lit_ones == 0 : lit_ones == 8;
        if (!alone) continue;
        const auto point = rays.seen({x + 0.5, y + 0.5});
        if (!point || rays.lit(point->start) == is_lit(p)) continue;
        (is_lit(p) ? bright : dark) += 1;
      }
    if (i == 0)
      timing = timed([&] { static_cast<void>(renderer.render(view, {}, log)); }, context.runs());
  }
  Row row{.case_name = "shadows",
          .setting = fmt::format("67P, {} views, phase 20 to 140 deg, {} lit pixels", suns, lit),
          .speed_unit = "ms/frame",
          .error = static_cast<double>(dark),
          .error_unit = "pixels that are dark alone",
          .reference = "one ray to the Sun a pixel",
          .must_error = 0.5};
  set_time(row, timing, 1e3);
  context.add(row);
  row.error = static_cast<double>(bright);
  row.error_unit = "pixels that are lit alone";
  context.add(row);
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context: nothing measured");
  context.set_renderer((*gl)->context().renderer());
  const auto scene = pxn::read(context.source("examples/servicer/servicer.pxn"), {}, log);
  if (!scene) return context.note("the servicer could not be read");
  const auto bytes = compiler::compiled(*scene, {}, log);
  auto model = bytes ? pan::Model::from_bytes(*bytes, "servicer", log) : Result<pan::Model>(failed);
  if (!model || !model->check(log)) return context.note("the servicer could not be compiled");
  std::array<support::ModelRenderer, 2> renderers{support::ModelRenderer(*gl, *model),
                                                  support::ModelRenderer(*gl, *model)};
  for (const Side& side : {Side{"front", {8, -8.5, 5.5}, {1, -0.6, 0.6}},
                           Side{"back", {-8, 8.5, 3.5}, {-1, 1.2, 1.6}}})
    run_side(context, renderers, *model, side, log);
  run_ground(context, *gl, log);
}

const bool kAdded =
    add_case({"shadows", "Sun shadows of the servicer and of scanned ground against rays", run});

}  // namespace

}  // namespace panwright::bench::case_shadows
