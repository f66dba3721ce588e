// The targets of a world as a renderer holds them. Private to preview.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "preview/device.h"
#include "preview/frame/draw_list.h"
#include "preview/gl/device_impl.h"
#include "world/evaluation.h"

namespace panwright::preview {

// One target, in its model's frame.
struct TargetState {
  world::Stamp shape_stamp = 0;                     // of what the rest is made from
  std::shared_ptr<const ModelResources> resources;  // may be null where nothing is visible
  // as the draw list of its model, placed; never changed, so that frames under way share it
  std::shared_ptr<const std::vector<DrawItem>> placed;
  std::optional<world::Bounds> bounds;  // none: nothing of it is visible
  // Where its model has levels of detail: the widths of a pixel on it at which others are visible,
  // ascending, metres; and the width for which `placed` is set.
  std::shared_ptr<const std::vector<double>> steps;
  double pixel = 0;
  std::size_t level = 0;  // of the steps, how many it passed

  const ModelResources::Impl& model() const { return resources->impl(); }
  std::span<const DrawItem> items() const {
    return placed ? std::span<const DrawItem>(*placed) : std::span<const DrawItem>();
  }
};

// Keyed by the shape stamps of the targets: a target that moves as a whole costs nothing here, and
// no model is uploaded but those that were not on the device.
class TargetStates {
 public:
  // Brings all up to date with the world. A hidden target's model is not uploaded.
  //
  // Fails: E5001, E5003, E0001; the next update tries again.
  bool update(const world::World& world, Device& device, DiagnosticLog& log, const Job& job);

  // Chooses the levels of detail of a target that a pixel sees so much of, metres. Expects: up to
  // date. Cost: nothing where they stay; else O(items).
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
