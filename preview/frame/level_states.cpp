#include "preview/frame/level_states.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview {
namespace {

// Of an octave, where the coarser levels begin to show.
constexpr double kFadeBegins = 0.5;
constexpr std::size_t kMostExact = 3;
constexpr double kShares = 4;

// The levels of one target.
struct Choice {
  double fine = 0, coarse = 0;  // metres that a pixel is taken to see
  double share = 0;             // of the coarse ones
};

Choice choice_of(double pixel, std::span<const double> steps) {
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

}  // namespace

double pixel_on(const world::Camera& camera, const world::Pose& pose, const world::Bounds& bounds) {
  const double focal = std::max(camera.focal.x, camera.focal.y);
  if (camera.projection == world::Projection::orthographic) return 1 / focal;
  const Vec3 eye = glm::conjugate(pose.rotation) * (camera.position - pose.translation);
  const Vec3 nearest = glm::clamp(eye, bounds.min, bounds.max);
  return glm::length(eye - nearest) / focal;
}

std::vector<LevelState> level_states(const world::Camera& camera,
                                     std::span<const LeveledTarget> targets,
                                     const std::optional<double>& pixel) {
  LevelState finest;
  finest.pixels.assign(targets.size(), pixel.value_or(0));
  std::vector<Choice> choices(targets.size());
  std::vector<double> shares;  // at which a target changes
  for (std::size_t i = 0; i < targets.size() && !pixel; ++i) {
    const LeveledTarget& target = targets[i];
    if (!target.bounds || !target.steps) continue;
    choices[i] = choice_of(pixel_on(camera, *target.pose, *target.bounds), *target.steps);
    finest.pixels[i] = choices[i].fine;
    if (choices[i].share > 0) shares.push_back(choices[i].share);
  }
  if (shares.size() > kMostExact) {
    shares.clear();
    for (Choice& choice : choices) {
      choice.share = std::round(choice.share * kShares) / kShares;
      if (choice.share > 0) shares.push_back(choice.share);
    }
  }
  std::sort(shares.begin(), shares.end());
  shares.erase(std::unique(shares.begin(), shares.end()), shares.end());
  std::vector<LevelState> states;
  double before = 0;
  for (const double share : shares) {
    LevelState state = finest;
    state.weight = share - before;
    for (std::size_t i = 0; i < choices.size(); ++i)
      if (choices[i].share >= share) state.pixels[i] = choices[i].coarse;
    states.push_back(std::move(state));
    before = share;
  }
  finest.weight = 1 - before;
  if (finest.weight > 0 || states.empty()) states.push_back(std::move(finest));
  return states;
}

}  // namespace panwright::preview
