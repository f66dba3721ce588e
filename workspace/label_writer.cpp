#include "workspace/internal/label_writer.h"

#include <filesystem>
#include <utility>

#include "labels/frame_files.h"
#include "labels/parts.h"

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

bool LabelWriter::write(const Frame& frame, const world::World& world, const image::Image& image,
                        DiagnosticLog& log, double* sync, const Job& job) {
  const FrameLabelling& of = *frame.labels;
  if (!kept_ || kept_->labelling != of.labelling || kept_->world != world.stamp())
    kept_ = Kept{of.labelling, labels::Labeller(of.labelling->options), world.stamp(), world, world,
                 world};
  show(frame, world, kept_->shown);
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
  auto labelled = kept_->labeller.label(kept_->shown, frame.camera(), context, log, job);
  if (!labelled) return false;
  const std::filesystem::path output = frame.outputs.front();
  labelled->name = of.name;
  labelled->image = output.filename().string();
  labelled->number = of.number;
  labelled->time = of.time;
  return labels::write_frame(output.parent_path(), *labelled, log, sync);
}

}  // namespace panwright::workspace
