#include "workspace/internal/frame_labeller.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "labels/parts.h"
#include "labels/rolling.h"
#include "labels/rolling_flow.h"

namespace panwright::workspace {

bool have_parts(const world::World& world, std::span<const Frame> frames, DiagnosticLog& log) {
  const Labelling* known = nullptr;
  for (const Frame& frame : frames) {
    if (!frame.labels || frame.labels->labelling.get() == known) continue;
    known = frame.labels->labelling.get();
    if (!labels::named_things(world, known->options.parts, log)) return false;
  }
  return true;
}

namespace {

world::Camera camera_of(const Frame& frame, std::size_t moment) {
  world::Camera camera = frame.camera();
  camera.position = frame.moments[moment].position;
  camera.world_from_camera = frame.moments[moment].world_from_camera;
  camera.principal.y -= frame.shutter->sensor_offset(moment);
  return camera;
}

// Moments that a frame with a line time shows, and some around them.
struct ShownMoments {
  std::vector<std::uint32_t> of_row;
  std::vector<labels::ImageRows> rows;  // whose exposure has its middle in a moment, by moment
  std::size_t begin = 0, end = 0;       // those with rows, and one before and after
};

ShownMoments shown_moments(const Frame& frame) {
  ShownMoments out;
  // what a line scanner would see next is no part of its image
  labels::ImageRows none;
  none.beyond = !frame.shutter->is_scanner();
  out.rows.assign(frame.moments.size(), none);
  for (std::uint32_t row = 0; row < frame.camera().height; ++row) {
    const std::size_t middle = frame.shutter->middle(row);
    out.of_row.push_back(static_cast<std::uint32_t>(middle));
    labels::ImageRows& of = out.rows[middle];
    if (of.end == 0) of.first = row;
    of.end = row + 1;
  }
  const auto [first, last] = std::ranges::minmax(out.of_row);
  // those around the first and the last too, between which keypoints are
  out.begin = first > 0 ? first - 1 : 0;
  out.end = std::min<std::size_t>(last + std::size_t{2}, frame.moments.size());
  return out;
}

// All of a frame's moments, or itself where it has none.
labels::RollingPlaces places_of(const Frame& frame, const world::World& world, world::World& shown,
                                const Job& job) {
  labels::RollingPlaces out(frame.camera(), *frame.settings.line_time);
  for (std::size_t k = 0; k < frame.moments.size(); ++k) {
    job.poll();
    show(frame.moments[k], world, shown);
    const world::Camera camera = camera_of(frame, k);
    out.add({shown, camera}, frame.shutter->time(k));
  }
  if (!frame.moments.empty()) return out;
  show(frame, world, shown);
  out.add({shown, frame.camera()}, 0);
  return out;
}

bool has_rolling_flow(const Frame& frame) {
  const auto rolls = [](const std::shared_ptr<const Frame>& other) {
    return other != nullptr && !other->moments.empty();
  };
  const FrameLabelling& of = *frame.labels;
  return *frame.settings.line_time != 0 && (of.previous || of.next) &&
         (!frame.moments.empty() || rolls(of.previous) || rolls(of.next));
}

// Sets the flow of a frame whose rows differ in time, or those of its neighbours.
void add_rolling_flow(const Frame& frame, const world::World& world, const image::Image& image,
                      world::World& shown, labels::FrameLabels& labels, const Job& job) {
  const auto now = places_of(frame, world, shown, job);
  std::vector<std::uint32_t> of_row(frame.camera().height);
  if (frame.shutter && !frame.moments.empty()) of_row = shown_moments(frame).of_row;
  const auto to = [&](const std::shared_ptr<const Frame>& other) -> std::optional<labels::Flow> {
    if (other == nullptr) return std::nullopt;
    return flow_of_rows(now, places_of(*other, world, shown, job), of_row, image, job);
  };
  labels.forward = to(frame.labels->next);
  labels.backward = to(frame.labels->previous);
}

}  // namespace

// Rows of a rolling shutter show the moment in the middle of their exposure, as the image's ids.
Result<labels::FrameLabels> FrameLabeller::rolling(const Frame& frame, const world::World& world,
                                                   const labels::FrameContext& context,
                                                   DiagnosticLog& log, const Job& job) {
  labels::Labeller& labeller = kept_->labeller;
  labels::FrameContext part = context;
  part.rows = labels::ImageRows{};
  auto whole = labeller.label(kept_->shown, frame.camera(), part, log, job);
  if (!whole) return failed;
  labels::RollingLabels rolling(*std::move(whole), *frame.settings.line_time);
  const ShownMoments moments = shown_moments(frame);
  const bool scans = frame.shutter->is_scanner();
  // of several stages of a line scanner one stands for all: rows count from its first moment
  const double start = scans ? frame.shutter->time(std::ranges::min(moments.of_row)) : 0;
  for (std::size_t k = moments.begin; k < moments.end; ++k) {
    if (scans && moments.rows[k].end == 0) continue;
    show(frame.moments[k], world, kept_->shown);
    part.rows = moments.rows[k];
    auto labelled = labeller.label(kept_->shown, camera_of(frame, k), part, log, job);
    if (!labelled) return failed;
    rolling.add(*std::move(labelled), frame.shutter->time(k) - start);
  }
  return rolling.take();
}

Result<labels::FrameLabels> FrameLabeller::label(const Frame& frame, const world::World& world,
                                                 const image::Image& image, DiagnosticLog& log,
                                                 const Job& job) {
  const FrameLabelling& of = *frame.labels;
  if (!kept_ || kept_->labelling != of.labelling || kept_->world != world.stamp())
    kept_ = Kept{of.labelling, labels::Labeller(of.labelling->options), world.stamp(), world, world,
                 world};
  labels::FrameContext context;
  context.layers = &image;
  const bool rolling_flow = has_rolling_flow(frame);
  std::optional<labels::Moment> previous, next;
  if (of.previous && !rolling_flow) {
    show(*of.previous, world, kept_->previous);
    context.previous = &previous.emplace(labels::Moment{kept_->previous, of.previous->camera()});
  }
  if (of.next && !rolling_flow) {
    show(*of.next, world, kept_->next);
    context.next = &next.emplace(labels::Moment{kept_->next, of.next->camera()});
  }
  show(frame, world, kept_->shown);
  auto labelled = frame.moments.empty() || *frame.settings.line_time == 0
                      ? kept_->labeller.label(kept_->shown, frame.camera(), context, log, job)
                      : rolling(frame, world, context, log, job);
  if (!labelled) return failed;
  if (rolling_flow) add_rolling_flow(frame, world, image, kept_->shown, *labelled, job);
  if (frame.imager != nullptr)
    labelled->pixel_um =
        frame.imager->detector.pixel_um * static_cast<double>(frame.imager->detector.binning);
  labelled->name = of.name;
  if (!frame.outputs.empty())
    labelled->image = std::filesystem::path(frame.outputs.front()).filename().string();
  labelled->number = of.number;
  labelled->time = of.time;
  return labelled;
}

}  // namespace panwright::workspace
