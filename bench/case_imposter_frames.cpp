// Runs of views of two spacecraft, near and far, with shadows: from the models to the files.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bench/bench.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_imposter_frames {

namespace {

// Where the two are, and what moves.
struct Scene {
  const char* name;
  Vec3 client;           // metres
  bool turning = false;  // both, against the Sun
  double must = 0;       // ms/frame
};

// The servicer from 15 m; the client 200 m off, 64 pixels.
std::vector<workspace::Frame> frames_of(const Scene& scene, int frames, double flux_error,
                                        const std::filesystem::path& folder, DiagnosticLog& log) {
  std::vector<workspace::Frame> out;
  for (int i = 0; i < frames; ++i) {
    workspace::Frame frame;
    world::Camera& camera = frame.camera();
    world::set_field_of_view(camera, 1024, 1024, 45 * kDegree);
    camera.position = {0.01 * i, -15 + 0.01 * i, 3};
    const auto turn = world::looking_at(camera.position, Vec3(0), {}, log);
    if (turn) camera.world_from_camera = *turn;
    world::Sun sun;
    sun.direction = {1, -0.7, 0.6};
    frame.sun = sun;
    const double angle = scene.turning ? 0.002 * i : 0;
    const Quat turned(std::cos(angle / 2), 0, 0, std::sin(angle / 2));
    frame.poses.push_back({"servicer", {Vec3(0), turned}});
    frame.poses.push_back({"client", {scene.client + Vec3(0.01 * i, 0, 0), turned}});
    frame.outputs = {folder / fmt::format("{}.npy", i)};
    frame.settings.samples = 1;
    frame.settings.imposters = 100.0;
    frame.settings.flux_error = flux_error;
    out.push_back(std::move(frame));
  }
  return out;
}

void run(Context& context) {
  DiagnosticLog log;
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return context.note("no OpenGL context: nothing was drawn");
  context.set_renderer((*device)->context().renderer());
  world::World world;
  for (const char* name : {"servicer", "client"}) {
    const auto path = context.source(fmt::format("examples/{0}/{0}.pxn", name));
    auto model = path.empty() ? failed : workspace::open(path, {}, log);
    if (!model) return context.note(fmt::format("{} cannot be read", name));
    static_cast<void>(world.add(name, *model, log));
  }
  const Scene scenes[] = {{"client beside the servicer", {40, 200, 10}, false, 100},
                          {"the same, both turn against the Sun", {40, 200, 10}, true},
                          {"client at the servicer's rim", {2, 200, -22}}};
  for (const Scene& scene : scenes)
    for (const double flux_error : {5e-4, 2e-3, 5e-3}) {
      if (context.quick() && (flux_error < 5e-3 || scene.turning)) continue;
      const int frames = context.quick() ? 2 : 40;
      const auto views = frames_of(scene, frames, flux_error, context.scratch(), log);
      double worst = 0;
      int drawn = 0;
      workspace::RunOptions run;
      run.listener.written = [&](const workspace::Written& written) {
        if (!written.sampling || written.sampling->imposters.empty()) return;
        worst = std::max(worst, written.sampling->imposters.back().flux_error);
        ++drawn;
      };
      const Timing timing =
          timed([&] { static_cast<void>(workspace::run_frames(world, views, run, log)); },
                context.quick() ? 1 : 2);
      Row row{.case_name = "imposters_frames",
              .setting = fmt::format("{}, 1024 x 1024, shadows, 1 sample, imposter within {:g} %, "
                                     "start and .npy included, {} frames",
                                     scene.name, 100 * flux_error, frames),
              .speed_unit = "ms/frame",
              .error = drawn > 0 ? worst : 1,
              .error_unit = "relative flux of the client, estimated, at most",
              .reference = "steps between texels",
              .must = flux_error == 5e-3 ? scene.must : 0,
              .must_is_least = false,
              .must_error = flux_error};
      set_time(row, timing, 1e3 / frames);
      context.add(row);
    }
}

const bool kAdded =
    add_case({"imposters_frames", "frames of a near spacecraft and a far one", run});

}  // namespace

}  // namespace panwright::bench::case_imposter_frames
