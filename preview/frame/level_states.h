// Choice of levels of detail for a view, and their shares in it. Private to preview; nothing here
// needs OpenGL.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "world/evaluation.h"

namespace panwright::preview {

// Target with levels of detail in a view.
struct LeveledTarget {
  const world::Pose* pose = nullptr;
  const AxisBox* bounds = nullptr;             // model frame; null: fully hidden
  const std::vector<double>* steps = nullptr;  // TargetState::steps; null: no levels
};

// A choice of levels for all targets, and its share in the image.
struct LevelState {
  double weight = 1;           // they add up to 1
  std::vector<double> pixels;  // assumed pixel footprint on each target, metres
};

// Returns the pixel footprint at the nearest point of a box, metres; 0: the camera is inside.
// Orthographic cameras: the same everywhere.
double pixel_on(const world::Camera& camera, const world::Pose& pose, const AxisBox& bounds);

// Choice of levels without visible steps. Levels change at footprints of a power of two metres, all
// of a target at once. Over the upper half of the octave before, the image is a mean of both
// levels. The share of the coarser one grows from 0 to 1 with the logarithm of the range. Each
// fading target takes one more state; beyond three, shares are rounded to quarters.
class LevelStateFinder {
 public:
  // pixel    replaces the camera's footprint, without a fade
  // returns  valid until the next call, in the same memory; the finest state last
  std::span<const LevelState> find(const world::Camera& camera,
                                   std::span<const LeveledTarget> targets,
                                   const std::optional<double>& pixel);

 private:
  // Levels of one target.
  struct Choice {
    double fine = 0, coarse = 0;  // assumed pixel footprints, metres
    double share = 0;             // of the coarse ones
  };
  static Choice choice_of(double pixel, std::span<const double> steps);
  LevelState& add(std::size_t index, double weight);

  std::vector<Choice> choices_;
  std::vector<double> shares_;  // at which a target changes
  std::vector<LevelState> states_;
};

}  // namespace panwright::preview
