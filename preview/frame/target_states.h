// Targets of a world in a renderer. Private to preview.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "preview/device.h"
#include "preview/model/device_impl.h"
#include "preview/model/draw_list.h"
#include "world/evaluation.h"

namespace panwright::preview {

// Target, in its model's frame.
struct TargetState {
  world::Stamp shape_stamp = 0;                     // of the inputs of the rest
  std::shared_ptr<const ModelResources> resources;  // may be null if fully hidden
  // its model's draw list, placed; never changed, so that frames under way share it
  std::shared_ptr<const std::vector<DrawItem>> placed;
  std::optional<AxisBox> bounds;  // none: fully hidden
  // With levels of detail: the pixel footprints at which levels change, ascending, metres; and the
  // footprint of `placed`.
  std::shared_ptr<const std::vector<double>> steps;
  double pixel = 0;
  std::size_t level = 0;  // number of steps passed

  const ModelResources::Impl& model() const { return resources->impl(); }
  std::span<const DrawItem> items() const {
    return placed ? std::span<const DrawItem>(*placed) : std::span<const DrawItem>();
  }
};

// States of targets, keyed by their shape stamps: a rigid motion costs nothing here, and only
// models missing on the device are uploaded.
class TargetStates {
 public:
  // Updates all to the world. A hidden target's model is not uploaded.
  //
  // Fails: E5001, E5003, E0001; the next update tries again.
  bool update(const world::World& world, Device& device, DiagnosticLog& log, const Job& job);

  // Chooses the levels of detail of a target for a pixel footprint, metres. Expects: up to date.
  // Cost: nothing if unchanged; else O(items).
  void set_pixel(std::size_t index, double metres);

  const TargetState& operator[](std::size_t index) const { return states_[index]; }
  std::size_t size() const { return states_.size(); }
  std::uint64_t placed() const { return placed_; }  // targets placed so far

 private:
  world::Evaluation evaluation_;
  std::vector<TargetState> states_;
  world::Stamp stamp_ = 0;  // of the world; 0: not up to date
  std::uint64_t placed_ = 0;
};

}  // namespace panwright::preview
