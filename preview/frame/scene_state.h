// Targets of a world in a view: their levels of detail, and those in sight. Private to preview.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "preview/device.h"
#include "preview/frame/level_states.h"
#include "preview/frame/target_states.h"
#include "preview/frame/visible_set.h"
#include "preview/renderer.h"

namespace panwright::preview {

// State derived from a world and kept between frames, keyed by the world's stamps.
class SceneState {
 public:
  // Updates the targets to a world, and their levels of detail to a camera; shows all targets.
  // Fails: as TargetStates::update().
  bool update(const world::World& world, const world::Camera& camera, const RenderOptions& options,
              Device& device, DiagnosticLog& log, const Job& job);

  const TargetStates& targets() const { return targets_; }
  // Choices of levels whose weighted images are the image; valid until the next update().
  std::span<const LevelState> levels() const { return levels_; }

  // Targets that shown() leaves out.
  void hide(std::uint32_t target, bool hidden) { hidden_[target] = hidden; }
  void show_all();

  // Finds the visible set of all targets, or of those that are not hidden; each is valid until the
  // next call of its function. Null: more instances than an image takes, E5003.
  //
  // Expects: the world of the last update()
  const VisibleSet* find_all(const world::World& world, const world::Camera& camera,
                             const LevelState& levels, DiagnosticLog& log);
  const VisibleSet* find_shown(const world::World& world, const world::Camera& camera,
                               const LevelState& levels, DiagnosticLog& log);
  const VisibleSet& all() const { return all_.last(); }

  // Reason why an image without anything is empty, for W5006.
  const char* why_empty(const world::World& world) const;

 private:
  bool set_shapes(const world::World& world, const LevelState& levels, bool all,
                  DiagnosticLog& log);

  TargetStates targets_;
  LevelStateFinder level_finder_;
  std::span<const LevelState> levels_;  // of level_finder_
  VisibleSetFinder all_;
  VisibleSetFinder shown_;
  std::vector<std::uint8_t> hidden_;  // of the world's targets
  // of one call, kept for the next one
  std::vector<LeveledTarget> leveled_;
  std::vector<TargetShape> shapes_;
};

}  // namespace panwright::preview
