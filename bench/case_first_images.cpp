// First images of spacecraft, from the model's file to the image's, and frames of the example of a
// rendezvous, with default settings: time beside the stated error.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "bench/bench.h"
#include "workspace/scenario.h"
#include "workspace/session.h"
#include "workspace/settings.h"
#include "workspace/views.h"

namespace panwright::bench::case_first_images {

namespace {

// Largest stated errors of images.
struct Stated {
  double pixels = 0;
  double flux = 0;

  workspace::RunListener listener() {
    workspace::RunListener out;
    out.written = [this](const workspace::Written& written) {
      if (!written.sampling) return;
      pixels = std::max(pixels, written.sampling->rmse);
      flux = std::max(flux, written.sampling->flux);
      for (const auto& imposter : written.sampling->imposters)
        flux = std::max(flux, imposter.flux_error);
    };
    return out;
  }
};

Row row_of(std::string setting, const char* unit, double must, const Stated& stated) {
  return {.case_name = "first_images",
          .setting = std::move(setting),
          .speed_unit = unit,
          .error = stated.pixels,
          .error_unit = "RMS radiance, as stated",
          .reference = "spread of samples",
          .must = must,
          .must_is_least = false};
}

// A session of its own each time: context, upload and shaders, which OpenGL keeps on disk. The
// first image finds no work in the user's cache folder, the next one does.
void time_model(Context& context, const std::filesystem::path& file, DiagnosticLog& log) {
  const unsigned side = context.quick() ? 64 : 1024;
  workspace::View view;
  if (!workspace::read_setting(workspace::SettingId::targets, file.string(), view.settings, log) ||
      !workspace::read_setting(workspace::SettingId::size, fmt::format("{0}x{0}", side),
                               view.settings, log))
    return context.note(fmt::format("no view of {}", file.string()));
  view.settings.outputs = {(context.scratch() / "a.png").string()};
  workspace::OpenOptions options;
  options.cache = context.scratch() / "cache";
  options.prune = false;  // as `render`
  Stated stated;
  bool good = true;
  const auto draw = [&] {
    workspace::ViewSession session(options, preview::ContextKind::automatic);
    good = good && session.run({&view, 1}, stated.listener(), log);
  };
  const auto timings = interleaved(
      {{"first", draw, [&] { std::filesystem::remove_all(options.cache); }}, {"next", draw}},
      context.quick() ? 1 : 5);
  if (!good) return context.note(fmt::format("{} was not drawn", file.string()));
  for (std::size_t i = 0; i < 2; ++i) {
    Row row = row_of(fmt::format("{}, {} x {}, from file to image, {}", file.stem().string(), side,
                                 side, i == 0 ? "first" : "next"),
                     "s", context.quick() ? 0 : 2, stated);
    set_time(row, timings[i], 1);
    context.add(std::move(row));
  }
}

void time_rendezvous(Context& context, const char* quality, double must, DiagnosticLog& log) {
  auto scenario =
      workspace::open_scenario(context.source("examples/rendezvous/rendezvous.toml"), {}, log);
  if (!scenario) return context.note("no rendezvous");
  if (!workspace::read_setting(workspace::SettingId::quality, quality, scenario->settings, log))
    return;
  workspace::ViewSession session({}, preview::ContextKind::automatic);
  const world::World* world = session.world(workspace::View(scenario->settings), {}, log);
  const auto times =
      workspace::frame_times(*scenario, {.every = context.quick() ? 500.0 : 50.0}, log);
  if (world == nullptr || !times) return context.note("the rendezvous cannot be opened");
  std::vector<workspace::View> views;
  for (std::size_t i = 0; i < times->size(); ++i) {
    const auto frame = workspace::frame_at(*scenario, (*times)[i], log);
    auto view = frame ? workspace::view_of(*scenario, *frame, i, *world, log)
                      : Result<workspace::View>(failed);
    if (!view) return context.note("a frame of the rendezvous is not there");
    view->settings.outputs = {(context.scratch() / fmt::format("{}.png", i)).string()};
    if (context.quick()) view->settings.size = {64, 48};
    views.push_back(*std::move(view));
  }
  Stated stated;
  bool good = true;
  const Timing timing = timed([&] { good = good && session.run(views, stated.listener(), log); },
                              context.quick() ? 1 : 2);
  if (!good) return context.note("the rendezvous was not drawn");
  Row row = row_of(fmt::format("rendezvous, {} frames, quality {}", views.size(), quality),
                   "ms/frame", context.quick() ? 0 : must, stated);
  set_time(row, timing, 1e3 / static_cast<double>(views.size()));
  context.add(std::move(row));
}

void run(Context& context) {
  DiagnosticLog log;
  const auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return context.note("no OpenGL context: nothing was drawn");
  context.set_renderer((*device)->context().renderer());
  for (const char* name : {"servicer", "client"})
    time_model(context, context.source(fmt::format("examples/{0}/{0}.pxn", name)), log);
  const char* corpus = std::getenv("PANWRIGHT_CORPUS");
  for (const char* name : {"iss-draco-webp", "jwst-draco-webp"}) {
    const auto file = std::filesystem::path(corpus != nullptr ? corpus : "") / "spacecraft-gltf" /
                      fmt::format("{}.glb", name);
    if (context.quick() || !std::filesystem::exists(file))
      context.note(fmt::format("{} was not drawn", name));
    else
      time_model(context, file, log);
  }
  time_rendezvous(context, "draft", 500, log);
  if (!context.quick()) time_rendezvous(context, "standard", 500, log);
}

const bool kAdded =
    add_case({"first_images", "first images of spacecraft, frames of a rendezvous", run});

}  // namespace

}  // namespace panwright::bench::case_first_images
