// Scenes of models: settings of views that say nothing of them.
#pragma once

#include <string>

#include "base/diagnostic.h"
#include "scene/scene.h"
#include "workspace/settings.h"
#include "world/world.h"

namespace panwright::workspace {

// Scene of the first target of a world that has one.
class SceneReader {
 public:
  // Returns its settings; without a scene none is given. Files of it are beside the model.
  //
  // Fails (nullptr): E0203. Reports once for a model: N1314.
  const Settings* read(const world::World& world, DiagnosticLog& log);
  const std::string& target() const { return target_; }

 private:
  world::ModelPtr model_;
  std::string target_;
  Settings settings_;
  bool sound_ = true;
};

// Checks what the reader of pxn leaves to the readers of settings: dates and laws.
//
// Fails: E0203.
bool check_scene(const scene::Scene& scene, DiagnosticLog& log);

}  // namespace panwright::workspace
