#include "preview/frame/scene_state.h"

#include <fmt/core.h>

#include <algorithm>

#include "preview/gl/uniforms.h"

namespace panwright::preview {

bool SceneState::update(const world::World& world, const world::Camera& camera,
                        const RenderOptions& options, Device& device, DiagnosticLog& log,
                        const Job& job) {
  if (!targets_.update(world, device, log, job)) return false;
  leveled_.clear();
  for (std::size_t i = 0; i < world.size(); ++i)
    leveled_.push_back({&world[i].pose(), targets_[i].bounds ? &*targets_[i].bounds : nullptr,
                        targets_[i].steps.get()});
  world::Camera coarser = camera;
  coarser.focal /= options.level_pixels;
  levels_ = level_finder_.find(coarser, leveled_,
                               options.levels ? options.level_pixel : std::optional<double>(0));
  hidden_.assign(world.size(), 0);
  return true;
}

void SceneState::show_all() { std::fill(hidden_.begin(), hidden_.end(), std::uint8_t{0}); }

bool SceneState::set_shapes(const world::World& world, const LevelState& levels, bool all,
                            DiagnosticLog& log) {
  shapes_.clear();
  std::uint64_t items = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    targets_.set_pixel(i, levels.pixels[i]);
    const TargetState& state = targets_[i];
    const auto count = static_cast<std::uint32_t>(world[i].model()->instances().size() +
                                                  world[i].model()->levels().size());
    const bool shown = state.bounds && (all || !hidden_[i]);
    shapes_.push_back({&world[i].pose(), shown ? &*state.bounds : nullptr, state.items(), count});
    items += count;
  }
  if (items <= kMostItems) return true;
  log.report_file(Code("E5003"), {},
                  fmt::format("the targets of the world have {} instances in all; one image "
                              "takes {}",
                              items, kMostItems));
  return false;
}

const VisibleSet* SceneState::find_all(const world::World& world, const world::Camera& camera,
                                       const LevelState& levels, DiagnosticLog& log) {
  return set_shapes(world, levels, true, log) ? &all_.find(camera, shapes_) : nullptr;
}

const VisibleSet* SceneState::find_shown(const world::World& world, const world::Camera& camera,
                                         const LevelState& levels, DiagnosticLog& log) {
  return set_shapes(world, levels, false, log) ? &shown_.find(camera, shapes_) : nullptr;
}

const char* SceneState::why_empty(const world::World& world) const {
  if (world.empty()) return "nothing is in view: the world has no targets";
  bool any = false;
  for (std::size_t i = 0; i < world.size(); ++i) any = any || targets_[i].bounds;
  if (!any) return "nothing is in view: no target is visible";
  if (!all().targets.empty())
    return "nothing is in view: targets are thinner than the sample spacing (--samples), or the "
           "camera is inside a closed mesh, visible from outside only";
  return world.size() > 1 ? "nothing is in view: no part of a target lies inside the image"
                          : "nothing is in view: no part of the model lies inside the image";
}

}  // namespace panwright::preview
