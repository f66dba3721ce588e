#include "preview/reference/internal/trace_scene.h"

namespace panwright::preview::reference {
namespace {

std::optional<trace::Hit> found(const trace::Hit& hit) {
  return hit ? std::optional(hit) : std::nullopt;
}

}  // namespace

void TraceScene::update(const world::World& world, const Job& job) {
  rays_.update(world, job);
  models_.clear();
  for (const trace::Scene::Placed& placed : rays_.targets()) {
    const std::shared_ptr<const trace::Model>& traced = placed.target->shared_model();
    if (!all_models_.contains(traced.get()))
      all_models_[traced.get()] = std::make_shared<const TraceModel>(traced, job);
    models_.push_back(all_models_[traced.get()]);
  }
  // as the rays do with their own
  std::erase_if(all_models_,
                [](const auto& entry) { return entry.second->traced().use_count() == 1; });
}

void TraceScene::place_camera(const world::Camera& camera, double ground_angle) {
  rays_.place_observer({camera.position, camera.world_from_camera}, ground_angle);
}

void TraceScene::place_observer(const world::Pose& world_from_observer, double ground_angle) {
  rays_.place_observer(world_from_observer, ground_angle);
}

std::optional<trace::Hit> TraceScene::seen(const trace::Ray& ray) const {
  return found(rays_.nearest(ray, trace::Insides::pass));
}

std::optional<trace::Hit> TraceScene::closest(const trace::Ray& ray) const {
  return found(rays_.nearest(ray, trace::Insides::stop));
}

}  // namespace panwright::preview::reference
