#include "preview/frame/level_states.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview {
namespace {

// Of an octave, where the coarser levels begin to show.
constexpr double kFadeBegins = 0.5;
constexpr std::size_t kMostExact = 3;
constexpr double kShares = 4;

}  // namespace

LevelStateFinder::Choice LevelStateFinder::choice_of(double pixel, std::span<const double> steps) {
  if (!(pixel > 0)) return {};
  const double begin = std::ldexp(1.0, std::ilogb(pixel));
  Choice choice{begin, 2 * begin, 0};
  const double octave = det::log(pixel / begin) / det::log(2.0);
  choice.share = std::clamp((octave - kFadeBegins) / (1 - kFadeBegins), 0.0, 1.0);
  // nothing changes at its end
  const bool steady = std::upper_bound(steps.begin(), steps.end(), choice.fine) ==
                      std::upper_bound(steps.begin(), steps.end(), choice.coarse);
  if (steady) choice.share = 0;
  return choice;
}

double pixel_on(const world::Camera& camera, const world::Pose& pose, const AxisBox& bounds) {
  const double focal = std::max(camera.focal.x, camera.focal.y);
  if (camera.projection == world::Projection::orthographic) return 1 / focal;
  const Vec3 eye = glm::conjugate(pose.rotation) * (camera.position - pose.translation);
  const Vec3 nearest = glm::clamp(eye, bounds.low, bounds.high);
  return glm::length(eye - nearest) / focal;
}

LevelState& LevelStateFinder::add(std::size_t index, double weight) {
  LevelState& state = index < states_.size() ? states_[index] : states_.emplace_back();
  state.weight = weight;
  state.pixels.resize(choices_.size());
  for (std::size_t i = 0; i < choices_.size(); ++i) state.pixels[i] = choices_[i].fine;
  return state;
}

std::span<const LevelState> LevelStateFinder::find(const world::Camera& camera,
                                                   std::span<const LeveledTarget> targets,
                                                   const std::optional<double>& pixel) {
  choices_.assign(targets.size(), {pixel.value_or(0), 0, 0});
  shares_.clear();
  for (std::size_t i = 0; i < targets.size() && !pixel; ++i) {
    const LeveledTarget& target = targets[i];
    if (!target.bounds || !target.steps) continue;
    choices_[i] = choice_of(pixel_on(camera, *target.pose, *target.bounds), *target.steps);
    if (choices_[i].share > 0) shares_.push_back(choices_[i].share);
  }
  if (shares_.size() > kMostExact) {
    shares_.clear();
    for (Choice& choice : choices_) {
      choice.share = std::round(choice.share * kShares) / kShares;
      if (choice.share > 0) shares_.push_back(choice.share);
    }
  }
  std::sort(shares_.begin(), shares_.end());
  shares_.erase(std::unique(shares_.begin(), shares_.end()), shares_.end());
  std::size_t count = 0;
  double before = 0;
  for (const double share : shares_) {
    LevelState& state = add(count++, share - before);
    for (std::size_t i = 0; i < choices_.size(); ++i)
      if (choices_[i].share >= share) state.pixels[i] = choices_[i].coarse;
    before = share;
  }
  if (before < 1) add(count++, 1 - before);
  return {states_.data(), count};
}

}  // namespace panwright::preview
