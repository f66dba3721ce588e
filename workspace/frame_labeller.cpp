#include "workspace/internal/frame_labeller.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "labels/parts.h"
#include "labels/rolling.h"

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

// Rows whose exposure has its middle in a moment, by moment.
std::vector<labels::ImageRows> rows_of_moments(const Frame& frame) {
  std::vector<labels::ImageRows> rows(frame.moments.size());
  for (std::uint32_t row = 0; row < frame.camera().height; ++row) {
    labels::ImageRows& of = rows[frame.shutter->middle(row)];
    if (of.end == 0) of.first = row;
    of.end = row + 1;
  }
  return rows;
}

}  // namespace

// Rows of a rolling shutter show the moment in the middle of their exposure, as the image's ids.
Result<labels::FrameLabels> FrameLabeller::label(const Frame& frame, const world::World& world,
                                                 const labels::FrameContext& context,
                                                 DiagnosticLog& log, const Job& job) {
  show(frame, world, kept_->shown);
  labels::Labeller& labeller = kept_->labeller;
  if (frame.moments.empty() || *frame.settings.line_time == 0)
    return labeller.label(kept_->shown, frame.camera(), context, log, job);
  labels::FrameContext part = context;
  part.rows = labels::ImageRows{};
  auto whole = labeller.label(kept_->shown, frame.camera(), part, log, job);
  if (!whole) return failed;
  labels::RollingLabels rolling(*std::move(whole), *frame.settings.line_time);
  const auto rows = rows_of_moments(frame);
  const auto has_rows = [](const labels::ImageRows& each) { return each.end > 0; };
  // those around the first and the last too, between which keypoints are
  const auto first = std::ranges::find_if(rows, has_rows) - rows.begin();
  const auto last = std::find_if(rows.rbegin(), rows.rend(), has_rows).base() - rows.begin();
  const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(first - 1, 0));
  const auto end = std::min(static_cast<std::size_t>(last) + 1, rows.size());
  for (std::size_t k = begin; k < end; ++k) {
    const Moment& moment = frame.moments[k];
    show(moment, world, kept_->shown);
    world::Camera camera = frame.camera();
    camera.position = moment.position;
    camera.world_from_camera = moment.world_from_camera;
    part.rows = rows[k];
    auto labelled = labeller.label(kept_->shown, camera, part, log, job);
    if (!labelled) return failed;
    rolling.add(*std::move(labelled), frame.shutter->time(k));
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
  std::optional<labels::Moment> previous, next;
  if (of.previous) {
    show(*of.previous, world, kept_->previous);
    previous.emplace(labels::Moment{kept_->previous, of.previous->camera()});
  }
  if (of.next) {
    show(*of.next, world, kept_->next);
    next.emplace(labels::Moment{kept_->next, of.next->camera()});
  }
  labels::FrameContext context;
  context.layers = &image;
  context.previous = previous ? &*previous : nullptr;
  context.next = next ? &*next : nullptr;
  auto labelled = label(frame, world, context, log, job);
  if (!labelled) return failed;
  labelled->name = of.name;
  if (!frame.outputs.empty())
    labelled->image = std::filesystem::path(frame.outputs.front()).filename().string();
  labelled->number = of.number;
  labelled->time = of.time;
  return labelled;
}

}  // namespace panwright::workspace
