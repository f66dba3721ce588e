// Runs of views, from the models to the files: frames a second, what a second target costs, and
// what goes to the context when a target moves.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bench/bench.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_frames {

namespace {

struct Subject {
  std::string name;
  world::ModelPtr model;
  double range = 0;  // metres to the camera
};

// What may move from frame to frame.
struct Motion {
  const char* name;
  bool camera = false;
  bool sun = false;
  bool target = false;
};

world::Camera camera_at(double angle, const Subject& subject, std::uint32_t size,
                        DiagnosticLog& log) {
  world::Camera camera;
  world::set_field_of_view(camera, size, size, 45 * kDegree);
  camera.position = subject.range * Vec3(std::cos(angle) * 0.9, std::sin(angle) * 0.9, 0.45);
  const auto turn = world::looking_at(camera.position, Vec3(0), {}, log);
  if (turn) camera.world_from_camera = *turn;
  return camera;
}

world::Sun sun_at(int frame) {
  world::Sun sun;
  sun.direction = {1, -0.7 + 0.002 * frame, 0.6};
  return sun;
}

// One frame is the same as another where nothing moves; each is written to a file of its own name.
std::vector<workspace::Frame> frames_of(const Subject& subject, const Motion& motion, int frames,
                                        std::uint32_t size, const std::filesystem::path& folder,
                                        DiagnosticLog& log) {
  std::vector<workspace::Frame> out;
  for (int i = 0; i < frames; ++i) {
    workspace::Frame frame;
    frame.settings.samples = 1;
    frame.instrument = camera_at(motion.camera ? 0.005 * i : 0, subject, size, log);
    frame.sun = sun_at(motion.sun ? i : 0);
    if (motion.target)
      frame.poses.push_back({subject.name, {Vec3(0.002 * i, 0, 0), Quat(1, 0, 0, 0)}});
    frame.outputs = {folder / fmt::format("{}.npy", i)};
    out.push_back(std::move(frame));
  }
  return out;
}

world::World world_of(const std::vector<const Subject*>& subjects, DiagnosticLog& log) {
  world::World world;
  double x = 0;
  for (const Subject* subject : subjects) {
    static_cast<void>(world.add(subject->name, subject->model, {{x, 0, 0}, Quat(1, 0, 0, 0)}, log));
    x += 0.4 * subject->range;
  }
  return world;
}

// The largest difference between a run's last image and the same view drawn by itself.
double largest_difference(const world::World& world, const workspace::Frame& frame,
                          const std::shared_ptr<preview::Device>& device, const image::Image& image,
                          DiagnosticLog& log) {
  world::World own = world;
  own.set_sun(*frame.sun);
  for (const workspace::TargetPose& pose : frame.poses)
    own.set_pose(*own.find(pose.target), pose.pose);
  preview::Renderer renderer(device);
  const auto alone = renderer.render(own, frame.camera(), {}, log);
  if (!alone || alone->radiance.size() != image.radiance.size()) return INFINITY;
  double largest = 0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i)
    largest =
        std::max(largest, std::fabs(static_cast<double>(image.radiance[i]) - alone->radiance[i]));
  return largest;
}

// Whole runs, files included.
void time_runs(Context& context, const Subject& subject, DiagnosticLog& log) {
  const int frames = context.quick() ? 4 : 200;
  const std::uint32_t size = context.quick() ? 64 : 1024;
  const world::World world = world_of({&subject}, log);
  workspace::RunOptions options;
  const Motion motions[] = {{"moving camera", true, false, false},
                            {"moving camera and Sun", true, true, false},
                            {"moving target", false, false, true}};
  std::vector<Variant> variants;
  std::vector<std::vector<workspace::Frame>> views;
  std::vector<bool> complete(std::size(motions), true);
  for (const Motion& motion : motions)
    views.push_back(frames_of(subject, motion, frames, size, context.scratch(), log));
  for (std::size_t i = 0; i < views.size(); ++i)
    variants.push_back({motions[i].name, [&, i] {
                          if (!workspace::run_frames(world, views[i], options, log))
                            complete[i] = false;
                        }});
  const auto timings = interleaved(variants, 1);
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    // the same frames under way two at a time, against frames by themselves
    preview::Renderer renderer(*device);
    world::World moving = world;
    image::Image last;
    for (const std::size_t each : {std::size_t{0}, views[i].size() - 1}) {
      const workspace::Frame& frame = views[i][each];
      moving.set_sun(*frame.sun);
      for (const workspace::TargetPose& pose : frame.poses)
        moving.set_pose(*moving.find(pose.target), pose.pose);
      static_cast<void>(renderer.submit(moving, frame.camera(), {}, log));
    }
    while (renderer.in_flight() > 0)
      if (auto image = renderer.collect(log)) last = *std::move(image);
    Row row;
    row.case_name = "frames";
    row.setting = fmt::format("{} {} {}x{} {} frames, start and .npy included", subject.name,
                              variants[i].setting, size, size, frames);
    row.speed_unit = "frames/s";
    set_rate(row, timings[i], frames);
    row.error =
        complete[i] ? largest_difference(world, views[i].back(), *device, last, log) : INFINITY;
    row.error_unit = "largest difference";
    row.reference = "the last view by itself";
    row.must_error = 1e-300;  // the same bits
    context.add(row);
  }
}

// Two targets at once against the sum of each by itself; what a move uploads.
void time_two(Context& context, const Subject& a, const Subject& b, DiagnosticLog& log) {
  auto device = preview::Device::create(preview::ContextKind::automatic, log);
  if (!device) return;
  const std::uint32_t size = context.quick() ? 64 : 1024;
  const std::vector<const Subject*> sets[] = {{&a}, {&b}, {&a, &b}};
  std::vector<world::World> worlds;
  std::vector<preview::Renderer> renderers;
  for (const auto& set : sets) {
    worlds.push_back(world_of(set, log));
    renderers.emplace_back(*device);
  }
  // each stands where it stands beside the other, so that the single views show the same of it
  worlds[1].set_pose(0, worlds[2][1].pose());
  int frame = 0;
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < 3; ++i)
    variants.push_back({"", [&, i] {
                          const auto camera = camera_at(0.001 * ++frame, a, size, log);
                          worlds[i].set_sun(sun_at(0));
                          static_cast<void>(renderers[i].render(worlds[i], camera, {}, log));
                        }});
  const auto timings = interleaved(variants, context.runs());
  const auto before = (*device)->counts();
  worlds[2].set_pose(1, {Vec3(0.41 * a.range, 0, 0), Quat(1, 0, 0, 0)});
  static_cast<void>(renderers[2].render(worlds[2], camera_at(0, a, size, log), {}, log));
  const auto after = (*device)->counts();
  Row row;
  row.case_name = "frames";
  row.setting = fmt::format("{} and {} {}x{}", a.name, b.name, size, size);
  row.speed = timings[2].median / (timings[0].median + timings[1].median);
  row.speed_unit = "of the single times' sum";
  row.runs = timings[2].runs;
  row.spread = 0.5 * (timings[2].upper_quartile - timings[2].lower_quartile) /
               (timings[0].median + timings[1].median);
  row.must = 1.15;
  row.must_is_least = false;
  row.error = static_cast<double>(after.model_bytes - before.model_bytes);
  row.error_unit = "bytes of models uploaded by a move";
  row.reference = "counted";
  row.must_error = 0.5;
  context.add(row);
  context.note(fmt::format("a frame after a move uploads {} bytes in all and makes {} objects",
                           after.uploaded_bytes - before.uploaded_bytes,
                           after.allocations - before.allocations));
}

std::optional<Subject> subject(Context& context, const char* name, const char* file, double range,
                               DiagnosticLog& log) {
  const auto path = context.source(file);
  if (path.empty()) {
    context.note(fmt::format("{} is not there: its rows are missing", file));
    return std::nullopt;
  }
  workspace::OpenOptions options;
  options.prune = false;
  auto model = workspace::open(path, options, log);
  if (!model) {
    context.note(fmt::format("{} cannot be read: its rows are missing", file));
    return std::nullopt;
  }
  return Subject{name, *std::move(model), range};
}

void run(Context& context) {
  DiagnosticLog log;
  {
    auto device = preview::Device::create(preview::ContextKind::automatic, log);
    if (!device) return context.note("no OpenGL context: nothing measured");
    context.set_renderer((*device)->context().renderer());
  }
  const auto servicer = subject(context, "servicer", "examples/servicer/servicer.pxn", 13.4, log);
  const auto client = subject(context, "client", "examples/client/client.pxn", 13.4, log);
  if (!servicer || !client) return;
  time_runs(context, *servicer, log);
  time_two(context, *servicer, *client, log);
  if (context.quick()) return;
  if (const auto iss =
          subject(context, "ISS", "../shared/data/spacecraft-gltf/iss-draco-webp.glb", 134, log))
    time_runs(context, *iss, log);
}

const bool kAdded =
    add_case({"frames", "runs of views: frames a second, two targets, uploads of a move", run});

}  // namespace

}  // namespace panwright::bench::case_frames
