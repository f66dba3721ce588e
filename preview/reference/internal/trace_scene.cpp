#include "preview/reference/internal/trace_scene.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview::reference {
namespace {

// far more than corners and slabs round by, of a target's size and of the largest distance
constexpr double kSizeSlack = 1e-5;
constexpr double kDistanceSlack = 1e-14;

double largest(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

template <class Visit>
void for_corners(const Vec3& low, const Vec3& high, Visit&& visit) {
  for (const double x : {low.x, high.x})
    for (const double y : {low.y, high.y})
      for (const double z : {low.z, high.z}) visit(Vec3(x, y, z));
}

}  // namespace

TraceTarget::TraceTarget(std::shared_ptr<const TraceModel> model, const world::Instance& instance,
                         const Job& job)
    : model_(std::move(model)) {
  constexpr std::uint32_t kNone = ~0u;
  const PlacedNodes nodes = placed_nodes(instance);
  std::vector<std::uint32_t> number(model_->model()->meshes().size(), kNone);
  for (std::uint32_t i = 0; i < model_->parts().size(); ++i) {
    const TraceModel::Part& part = model_->parts()[i];
    if (!nodes.visible[part.node]) continue;
    const Placement placement = model_->placement(i, nodes);
    std::uint32_t& mesh = number[part.mesh_index];
    if (mesh == kNone) mesh = caster_.add_mesh(model_->search_mesh(part.mesh_index));
    Mat4 matrix(placement.model_from_mesh.linear);
    matrix[3] = Vec4(placement.model_from_mesh.offset, 1);
    // filters are asked where something may not count: holes, and insides for the camera
    caster_.add(mesh, matrix, part.has_holes || part.closed);
    has_holes_ = has_holes_ || part.has_holes;
    for_corners(part.low, part.high,
                [&](const Vec3& corner) { bounds_.add(placement.model_from_mesh(corner)); });
    parts_.push_back(i);
    placements_.push_back(placement);
  }
  caster_.build(job);
}

bool TraceTarget::hole_filter(const void* data, const geometry::InstanceHit& hit) {
  const auto& target = *static_cast<const TraceTarget*>(data);
  return target.model_->is_there(target.parts_[hit.instance], hit);
}

bool TraceTarget::camera_filter(const void* data, const geometry::InstanceHit& hit) {
  return !static_cast<const TraceTarget*>(data)->is_inside(hit) && hole_filter(data, hit);
}

std::optional<geometry::InstanceHit> TraceTarget::closest(const geometry::Ray& ray,
                                                          bool by_camera) const {
  if (by_camera) return caster_.closest(ray, {camera_filter, this});
  return has_holes_ ? caster_.closest(ray, {hole_filter, this}) : caster_.closest(ray);
}

bool TraceTarget::any(const geometry::Ray& ray) const {
  return has_holes_ ? caster_.any(ray, {hole_filter, this}) : caster_.any(ray);
}

std::shared_ptr<const TraceModel> TraceScene::model_of(const world::ModelPtr& model,
                                                       const Job& job) {
  if (const auto found = models_.find(model.get()); found != models_.end()) return found->second;
  auto made = std::make_shared<const TraceModel>(model, job);
  models_[model.get()] = made;
  ++work_.models;
  return made;
}

void TraceScene::update(const world::World& world, const Job& job) {
  std::unordered_map<world::Stamp, std::shared_ptr<const TraceTarget>> states;
  std::unordered_map<world::Stamp, RigidFrame> frames;
  targets_.clear();
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    const world::Instance& instance = world[i];
    std::shared_ptr<const TraceTarget>& state = states[instance.shape_stamp()];
    if (const auto same = states_.find(instance.shape_stamp()); same != states_.end()) {
      state = same->second;
    } else {
      state = std::make_shared<const TraceTarget>(model_of(instance.model(), job), instance, job);
      ++work_.shapes;
    }
    RigidFrame& frame = frames[instance.pose_stamp()];
    if (const auto same = frames_.find(instance.pose_stamp()); same != frames_.end()) {
      frame = same->second;
    } else {
      frame = frame_of(instance.pose());
      ++work_.poses;
    }
    if (!state->parts().empty()) targets_.push_back({state, frame, i, {}});
  }
  states_ = std::move(states);
  frames_ = std::move(frames);
  // no world can ask for a model again that is not held elsewhere
  std::erase_if(models_, [](const auto& entry) { return entry.second->model().use_count() == 1; });
}

void TraceScene::place_camera(const world::Camera& camera) {
  camera_ = frame_of(camera);
  for (Placed& placed : targets_) placed.from_camera = between(placed.frame, camera_);
  std::vector<AxisBox> boxes(targets_.size());
  double far = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Placed& placed = targets_[i];
    const Vec3 offset = placed.frame.position - camera_.position;
    const AxisBox& bounds = placed.target->bounds();
    for_corners(bounds.low, bounds.high, [&](const Vec3& corner) {
      boxes[i].add(placed.frame.world_from * corner + offset);
    });
    far = std::max({far, largest(boxes[i].low), largest(boxes[i].high), largest(bounds.low),
                    largest(bounds.high)});
  }
  for (AxisBox& box : boxes)
    box.widen(kSizeSlack * largest(box.high - box.low) + kDistanceSlack * far);
  tree_.build(std::move(boxes));
}

// A ray in the frame of a target's model. Expects: not that target's already.
geometry::Ray TraceScene::local(const TraceRay& ray, std::uint32_t target) const {
  const Placed& to = targets_[target];
  if (ray.frame == TraceRay::kCamera)
    return {to.from_camera(ray.ray.origin), to.from_camera.linear * ray.ray.direction,
            ray.ray.min_distance, ray.ray.max_distance};
  const RigidFrame& from = targets_[ray.frame].frame;
  // a row times a matrix: the inverse of a rotation is its transpose
  return {(from.world_from * ray.ray.origin + (from.position - to.frame.position)) *
              to.frame.world_from,
          (from.world_from * ray.ray.direction) * to.frame.world_from, ray.ray.min_distance,
          ray.ray.max_distance};
}

// Calls look(target, ray in its frame) for the targets that a ray may hit, that whose frame it is
// in first, until it returns true.
template <class Look>
void TraceScene::visit(const TraceRay& ray, const double& limit, const Look& look) const {
  const bool by_camera = ray.frame == TraceRay::kCamera;
  if (!by_camera && look(ray.frame, ray.ray)) return;
  const RigidFrame& from = by_camera ? camera_ : targets_[ray.frame].frame;
  tree_.search(from.world_from * ray.ray.origin + (from.position - camera_.position),
               from.world_from * ray.ray.direction, ray.ray.min_distance, limit,
               [&](std::uint32_t target) {
                 if (target == ray.frame) return false;
                 geometry::Ray there = local(ray, target);
                 there.max_distance = limit;
                 return look(target, there);
               });
}

std::optional<TraceHit> TraceScene::nearest(const TraceRay& ray, bool by_camera) const {
  std::optional<TraceHit> best;
  double limit = ray.ray.max_distance;
  visit(ray, limit, [&](std::uint32_t target, const geometry::Ray& there) {
    const auto hit = targets_[target].target->closest(there, by_camera);
    // at equal distances the lower target
    if (hit && (!best || hit->distance < limit || target < best->target)) {
      best = TraceHit{target, *hit, there.direction};
      limit = hit->distance;
    }
    return false;
  });
  return best;
}

std::optional<TraceHit> TraceScene::closest(const TraceRay& ray) const {
  if (targets_.size() != 1) return nearest(ray, false);
  const auto search = [&](const geometry::Ray& there) -> std::optional<TraceHit> {
    const auto hit = targets_[0].target->closest(there, false);
    if (!hit) return std::nullopt;
    return TraceHit{0, *hit, there.direction};
  };
  return ray.frame == 0 ? search(ray.ray) : search(local(ray, 0));
}

std::optional<TraceHit> TraceScene::seen(const TraceRay& ray) const {
  const auto hit = closest(ray);
  if (!hit || !is_inside(*hit)) return hit;
  return nearest(ray, true);
}

bool TraceScene::any(const TraceRay& ray) const {
  if (targets_.size() == 1) {
    const TraceTarget& only = *targets_[0].target;
    return ray.frame == 0 ? only.any(ray.ray) : only.any(local(ray, 0));
  }
  bool found = false;
  visit(ray, ray.ray.max_distance, [&](std::uint32_t target, const geometry::Ray& there) {
    return found = targets_[target].target->any(there);
  });
  return found;
}

}  // namespace panwright::preview::reference
