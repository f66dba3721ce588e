// Motion of a world in an image. Private to workspace.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/math.h"
#include "workspace/frame.h"
#include "world/camera.h"
#include "world/evaluation.h"
#include "world/world.h"

namespace panwright::workspace {

// Largest motion of a world's targets from one time to the next, measured on points of boxes: of
// the whole target, and of its meshes where it has joints; and of a sky, by the camera's turn.
// Points near the image count, or all before the camera where a target has none of these.
class ImageMotion {
 public:
  // Expects: world outlives it.
  explicit ImageMotion(const world::World& world) : world_(world), shown_(world) {}

  // Adds a state after those before it. Returns the motion since the last one, pixels; 0: the
  // first, or nothing in view.
  double add(const WorldState& state, const world::Camera& camera);

 private:
  void find_rigid_points(const world::Camera& camera);
  void project_target(std::size_t target, const world::Camera& camera);

  const world::World& world_;
  world::World shown_;
  world::Evaluation evaluation_;
  std::vector<std::vector<Vec3>> rigid_;  // of each target, in its model's frame
  double of_sky(const world::Camera& camera) const;
  std::optional<world::Camera> last_;
  struct Place {
    Vec2 pixel{0};
    bool in_front = false;
    bool near = false;
  };
  std::vector<std::vector<Place>> before_, now_;  // of each target
};

}  // namespace panwright::workspace
