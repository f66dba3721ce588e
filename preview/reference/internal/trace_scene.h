// Scene of the path tracer: rays, and the surfaces that they meet with their materials. Private to
// preview/reference.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "preview/reference/internal/trace_model.h"
#include "trace/scene.h"
#include "world/camera.h"

namespace panwright::preview::reference {

class TraceScene {
 public:
  // ground: terrain of pan files is there.
  explicit TraceScene(bool ground = false) : rays_(trace::SceneOptions{0, ground}) {}

  // Updates to a world: parts with unchanged stamps stay.
  void update(const world::World& world, const Job& job);
  // Sets the camera, the observer of the rays; after update().
  //   ground_angle  as trace::Scene::place_observer()
  void place_camera(const world::Camera& camera, double ground_angle = 0);
  void place_observer(const world::Pose& world_from_observer, double ground_angle = 0);

  const trace::Scene& rays() const { return rays_; }

  // Returns the hit visible to the camera: not the insides of closed meshes, and through holes.
  std::optional<trace::Hit> seen(const trace::Ray& ray) const;
  // Returns the nearest surface, except holes; insides of closed meshes count.
  std::optional<trace::Hit> closest(const trace::Ray& ray) const;
  bool any(const trace::Ray& ray, const trace::GroundBeams* beams = nullptr) const {
    return rays_.any(ray, trace::Insides::stop, beams);
  }

  bool is_inside(const trace::Hit& hit) const { return rays_.is_inside(hit); }
  //   size  metres of the ground that albedo maps are a mean of; 0: the finest
  Point point(const trace::Hit& hit, bool flat, double size = 0) const {
    const trace::Target& target = *rays_.targets()[hit.target].target;
    if (hit.part == trace::Hit::kGround)
      return models_[hit.target]->ground_point(target, hit, flat, size);
    return models_[hit.target]->point(target.placement(hit.part), hit, flat);
  }
  const std::shared_ptr<const TraceModel>& model(std::uint32_t target) const {
    return models_[target];
  }

 private:
  using ModelPtr = std::shared_ptr<const TraceModel>;
  trace::Scene rays_;
  std::unordered_map<const trace::Model*, ModelPtr> all_models_;
  std::vector<ModelPtr> models_;  // one for each target of the world
};

}  // namespace panwright::preview::reference
