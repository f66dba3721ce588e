// Runs of the servicer and the client with and without labels: frames a second, and the error of
// masks against the path tracer's coverage.
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <vector>

#include "bench/bench.h"
#include "labels/compute.h"
#include "preview/reference/reference.h"
#include "preview/renderer.h"
#include "workspace/workspace.h"

namespace panwright::bench::case_labels {

namespace {

world::Camera camera_at(double angle, std::uint32_t size, DiagnosticLog& log) {
  world::Camera camera;
  world::set_field_of_view(camera, size, size, 40 * kDegree);
  camera.position = 24.0 * Vec3(std::cos(angle), std::sin(angle), 0.4);
  if (const auto turn = world::looking_at(camera.position, Vec3(3, 0, 0), {}, log))
    camera.world_from_camera = *turn;
  return camera;
}

struct Way {
  const char* name;
  bool labels, flow;
  bool one_sample;  // else --samples auto
};
constexpr Way kWays[] = {
    {"images alone", false, false, false},     {"labels", true, false, false},
    {"labels and flow", true, true, false},    {"images alone, one sample", false, false, true},
    {"labels, one sample", true, false, true}, {"labels and flow, one sample", true, true, true}};

std::vector<workspace::Frame> frames_of(const Way& way, int count, std::uint32_t size,
                                        const std::filesystem::path& folder, DiagnosticLog& log) {
  const auto labelling = std::make_shared<workspace::Labelling>();
  labelling->flow = way.flow;
  std::vector<workspace::Frame> out;
  for (int k = 0; k < count; ++k) {
    workspace::Frame frame;
    if (way.one_sample) frame.settings.samples = 1;
    frame.instrument = workspace::CameraInstrument{camera_at(0.01 * k, size, log)};
    frame.outputs = {folder / fmt::format("{}.png", k)};
    out.push_back(std::move(frame));
  }
  const std::vector<workspace::Frame> plain = out;
  for (std::size_t k = 0; way.labels && k < out.size(); ++k) {
    auto labels = std::make_shared<workspace::FrameLabelling>();
    labels->labelling = labelling;
    labels->name = fmt::format("{}", k);
    labels->number = k;
    if (way.flow && k > 0) labels->previous = std::make_shared<workspace::Frame>(plain[k - 1]);
    if (way.flow && k + 1 < plain.size())
      labels->next = std::make_shared<workspace::Frame>(plain[k + 1]);
    out[k].labels = labels;
  }
  return out;
}

// Relative difference of the visible area of all targets from the path tracer's coverage.
double area_error(const world::World& world, const world::Camera& camera, std::uint32_t rays,
                  DiagnosticLog& log) {
  preview::Reference reference;
  preview::ReferenceOptions traced;
  traced.samples = rays;
  traced.bounces = 0;
  traced.sun_disc = false;
  const auto exact = reference.render(world, camera, traced, log);
  labels::Labeller labeller;
  const auto frame = labeller.label(world, camera, {}, log);
  if (!exact || !frame) return INFINITY;
  double sum = 0, area = 0;
  for (const float value : exact->image.coverage) sum += double{value};
  for (const labels::Thing& thing : frame->things)
    if (thing.label.empty()) area += thing.visible_pixels;
  return std::fabs(area / sum - 1);
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void run_labels(Context& context) {
  const int count = context.quick() ? 4 : 20;
  const std::uint32_t size = context.quick() ? 64 : 1024;
  DiagnosticLog log;
  const auto servicer = context.source("examples/servicer/servicer.pxn");
  const auto client = context.source("examples/client/client.pxn");
  auto world =
      servicer.empty() || client.empty()
          ? failed
          : workspace::open_world(
                std::vector<workspace::TargetFile>{{"servicer", servicer}, {"client", client}}, {},
                log);
  if (!world) return context.note("no servicer or no client: the rows are missing");
  world->set_pose(1, {Vec3(8, 1, 0), glm::angleAxis(0.6, Vec3(0, 1, 0))});
  world::Sun sun;
  sun.direction = {0.5, -1, 0.3};
  world->set_sun(sun);
  std::vector<std::vector<workspace::Frame>> frames;
  for (const Way& way : kWays)
    frames.push_back(frames_of(way, count, size, context.scratch(), log));
  workspace::RunOptions options;
  workspace::Runner runner;  // models are uploaded once
  std::vector<Variant> variants;
  for (std::size_t k = 0; k < std::size(kWays); ++k)
    variants.push_back(
        {fmt::format("servicer and client, {}x{}, {} frames, {}", size, size, count, kWays[k].name),
         [&, k] { static_cast<void>(runner.run(*world, frames[k], options, log)); }});
  for (const Variant& variant : variants) variant.work();
  const double begin = resident_bytes();
  const int runs = context.quick() ? 1 : 3;
  const std::vector<Timing> timings = interleaved(variants, runs);
  context.note(fmt::format("memory grew by {:.0f} bytes a frame over {} frames",
                           (resident_bytes() - begin) / (std::size(kWays) * (runs + 1) * count),
                           std::size(kWays) * (runs + 1) * count));
  const std::uint32_t rays = context.quick() ? 8 : 64;
  double error = 0;
  for (int k = 0; k < count; k += std::max(count / 4, 1))
    error = std::max(
        error, area_error(*world, frames[0][static_cast<std::size_t>(k)].camera(), rays, log));
  double alone = 0;
  for (std::size_t k = 0; k < timings.size(); ++k) {
    Row row;
    row.case_name = "labels";
    row.setting = variants[k].setting;
    row.speed_unit = "frames/s";
    set_rate(row, timings[k], count);
    if (kWays[k].labels)
      row.must = 0.7 * alone;
    else
      alone = row.speed;
    row.error = error;
    row.error_unit = "relative area";
    row.reference = fmt::format("path tracer's coverage, {} rays a pixel", rays);
    row.reference_error = 0.5 / std::sqrt(static_cast<double>(rays)) / size;
    context.add(row);
  }
}

const bool kAdded = add_case({"labels", "runs with and without labels", run_labels});

}  // namespace
}  // namespace panwright::bench::case_labels
