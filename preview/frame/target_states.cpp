#include "preview/frame/target_states.h"

#include <algorithm>
#include <unordered_map>

namespace panwright::preview {
namespace {

// null: no levels
std::shared_ptr<const std::vector<double>> steps_of(std::span<const DrawItem> items) {
  std::vector<double> steps;
  for (const DrawItem& item : items)
    if (item.from > 0) steps.push_back(item.from);
  if (steps.empty()) return nullptr;
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  return std::make_shared<const std::vector<double>>(std::move(steps));
}

}  // namespace

void TargetStates::set_pixel(std::size_t index, double metres) {
  TargetState& state = states_[index];
  if (!state.steps) return;
  const auto level = static_cast<std::size_t>(
      std::upper_bound(state.steps->begin(), state.steps->end(), metres) - state.steps->begin());
  state.pixel = metres;
  if (level == state.level) return;
  state.level = level;
  std::vector<DrawItem> items(state.placed->begin(), state.placed->end());
  for (DrawItem& item : items) item.set_pixel(metres);
  state.placed = std::make_shared<const std::vector<DrawItem>>(std::move(items));
}

bool TargetStates::update(const world::World& world, Device& device, DiagnosticLog& log,
                          const Job& job) {
  if (stamp_ == world.stamp() && states_.size() == world.size()) return true;
  // poses and the Sun alone
  if (stamp_ != 0 && std::equal(states_.begin(), states_.end(), world.instances().begin(),
                                world.instances().end(), [](const auto& state, const auto& target) {
                                  return state.shape_stamp == target.shape_stamp();
                                })) {
    stamp_ = world.stamp();
    return true;
  }
  stamp_ = 0;
  evaluation_.update(world);
  // note: until they are replaced, the old states hold the models of targets that are hidden now
  std::vector<TargetState> old = std::move(states_);
  states_.clear();
  std::unordered_map<world::Stamp, std::size_t> old_index;
  for (std::size_t i = 0; i < old.size(); ++i) old_index.emplace(old[i].shape_stamp, i);
  states_.resize(world.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    TargetState& state = states_[i];
    const auto kept = old_index.find(world[i].shape_stamp());
    if (kept != old_index.end()) {
      // note: copies of a world may hold the same state twice
      state = old[kept->second];
      continue;
    }
    const world::EvaluatedInstance& at = evaluation_[i];
    state.resources = device.find(world[i].model());
    if (at.bounds) {
      if (!state.resources) {
        auto uploaded = device.resources(world[i].model(), log, job);
        if (!uploaded) {
          states_.resize(i);
          return false;
        }
        state.resources = *std::move(uploaded);
      }
      state.placed = std::make_shared<const std::vector<DrawItem>>(
          preview::placed(state.model().list, *world[i].model(), at));
      state.bounds = at.bounds;
      state.steps = steps_of(*state.placed);
      ++placed_;
    }
    state.shape_stamp = at.shape_stamp;
  }
  stamp_ = world.stamp();
  return true;
}

}  // namespace panwright::preview
