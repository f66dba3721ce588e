// Labels of the frames of a run.
#pragma once

#include <optional>
#include <span>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "image/image.h"
#include "labels/compute.h"
#include "workspace/frame.h"
#include "world/world.h"

namespace panwright::workspace {

// True: labels of these frames have the parts that they name. Fails: E9005.
bool have_parts(const world::World& world, std::span<const Frame> frames, DiagnosticLog& log);

// It keeps search trees and placements from frame to frame, also of runs one after the other.
class FrameLabeller {
 public:
  // Returns the labels of a frame.
  //
  //   world  of the run
  //   image  of the frame, with ground truth or without
  // Expects: a frame with labels. Fails: E0001, E9005.
  Result<labels::FrameLabels> label(const Frame& frame, const world::World& world,
                                    const image::Image& image, DiagnosticLog& log, const Job& job);

 private:
  Result<labels::FrameLabels> rolling(const Frame& frame, const world::World& world,
                                      const labels::FrameContext& context, DiagnosticLog& log,
                                      const Job& job);
  struct Kept {
    std::shared_ptr<const Labelling> labelling;
    labels::Labeller labeller;
    world::Stamp world = 0;
    world::World shown, previous, next;
  };
  std::optional<Kept> kept_;
};

}  // namespace panwright::workspace
