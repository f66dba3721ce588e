// Which levels of detail a view shows, and in what parts. Private to preview; nothing here needs
// OpenGL.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "world/evaluation.h"

namespace panwright::preview {

// A target with levels of detail as a camera sees it.
struct LeveledTarget {
  const world::Pose* pose = nullptr;
  const world::Bounds* bounds = nullptr;       // model frame; null: nothing of it is visible
  const std::vector<double>* steps = nullptr;  // TargetState::steps; null: it has no levels
};

// One choice of levels for all targets, and its part in the image.
struct LevelState {
  double weight = 1;           // they add up to 1
  std::vector<double> pixels;  // metres that a pixel is taken to see of each target
};

// What a pixel sees of a box at its nearest point, metres; 0: the camera is inside. Orthographic
// cameras: the same everywhere.
double pixel_on(const world::Camera& camera, const world::Pose& pose, const world::Bounds& bounds);

// Levels change where a pixel sees a power of two metres, all of a target at once. Over the upper
// half of the octave before, the image is a mean of those with the levels of both, the share of the
// coarser one growing from 0 to 1 with the logarithm of the range: where levels change, nothing
// does. Several targets that fade take one state more each; beyond three, shares are rounded to
// quarters.
class LevelStateFinder {
 public:
  // pixel    in place of what the camera sees, without a fade
  // returns  what stays until the next call, in the same memory; the finest state last
  std::span<const LevelState> find(const world::Camera& camera,
                                   std::span<const LeveledTarget> targets,
                                   const std::optional<double>& pixel);

 private:
  // The levels of one target.
  struct Choice {
    double fine = 0, coarse = 0;  // metres that a pixel is taken to see
    double share = 0;             // of the coarse ones
  };
  static Choice choice_of(double pixel, std::span<const double> steps);
  LevelState& add(std::size_t index, double weight);

  std::vector<Choice> choices_;
  std::vector<double> shares_;  // at which a target changes
  std::vector<LevelState> states_;
};

}  // namespace panwright::preview
