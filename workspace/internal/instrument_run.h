// Run of one kind of instrument. Private to workspace.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "workspace/internal/frame_labeller.h"
#include "workspace/product.h"
#include "workspace/run.h"

namespace panwright::workspace {

// Kept between runs: at most one drawer of each engine, and the maker of labels.
struct Drawers {
  std::optional<Drawer> gl;
  std::optional<Drawer> reference;
  FrameLabeller labels;
  std::optional<Drawer>& of(const DrawOptions& options) {
    return options.engine == Engine::gl ? gl : reference;
  }
};

struct RunScope {
  const world::World& world;
  const RunOptions& options;
  DiagnosticLog& log;
  const Job& job;
};

// Product of a frame and its report.
struct Measurement {
  Written what;  // without index, outputs and targets
  Product product;
};

// Frames of one kind of instrument, in order. What fails is reported.
class InstrumentRun {
 public:
  virtual ~InstrumentRun() = default;
  // Opens what a frame needs.
  virtual bool prepare(const Frame& frame) = 0;
  // Returns the number of frames under way at which a frame waits for their end.
  virtual std::size_t room(const Frame& frame) = 0;
  virtual bool begin(const Frame& frame, const world::World& shown) = 0;
  // Waits for the oldest frame begun; take() then returns it.
  virtual bool collect() = 0;
  virtual Measurement take() = 0;
  // Takes back a written product, to reuse its memory.
  virtual void recycle(const Written&, Product) {}
  // Reports warnings of all frames.
  virtual void finish() {}
};

bool stores_ground_truth(const Frame& frame);

// Returns the first output of a frame; without any, its label.
std::string name_of(const Frame& frame);

// By kind of instrument.
std::unique_ptr<InstrumentRun> run_of(const CameraInstrument& kind, const RunScope& scope,
                                      Drawers& drawers);

}  // namespace panwright::workspace
