#include "workspace/internal/image_motion.h"

#include <algorithm>

namespace panwright::workspace {

// A grid over the box of each target, and points of it near the view axis.
void ImageMotion::find_rigid_points(const world::Camera& camera) {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    std::vector<Vec3>& points = rigid_.emplace_back();
    if (!evaluation_[i].bounds) continue;
    const AxisBox& box = *evaluation_[i].bounds;
    for (int k = 0; k < 27; ++k)
      points.push_back(box.low + 0.5 * Vec3(k % 3, k / 3 % 3, k / 9) * (box.high - box.low));
    const world::Pose& pose = shown_[i].pose();
    const Quat model_from_world = glm::conjugate(pose.rotation);
    const Vec3 forward = camera.world_from_camera * Vec3(0, 0, 1);
    const Vec3 centre = pose.translation + pose.rotation * (0.5 * (box.low + box.high));
    const double depth = std::max(glm::dot(centre - camera.position, forward), 0.0);
    for (const double share : {0.5, 1.0, 2.0}) {
      const Vec3 at = camera.position + share * depth * forward;
      points.push_back(glm::clamp(model_from_world * (at - pose.translation), box.low, box.high));
    }
  }
}

void ImageMotion::project_target(std::size_t target, const world::Camera& camera) {
  const world::Pose& pose = shown_[target].pose();
  std::vector<Place>& places = now_.emplace_back();
  const auto add = [&](const Vec3& in_model) {
    const auto at = world::project(camera, pose.translation + pose.rotation * in_model);
    const Vec2 size(camera.width, camera.height);
    const bool near =
        at && at->x > -size.x && at->y > -size.y && at->x < 2 * size.x && at->y < 2 * size.y;
    places.push_back({at.value_or(Vec2(0)), at.has_value(), near});
  };
  for (const Vec3& point : rigid_[target]) add(point);
  const pan::Model& model = *world_[target].model();
  if (model.joints().empty()) return;
  const world::EvaluatedInstance& evaluated = evaluation_[target];
  for (const auto& instance : model.instances()) {
    const auto& mesh = model.meshes()[instance.mesh];
    const Vec3 origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
    const Mat4& matrix = evaluated.model_from_nodes[instance.node];
    for (const auto& corner : {mesh.bounds_min, mesh.bounds_max})
      add(Vec3(matrix * Vec4(origin + Vec3(corner[0], corner[1], corner[2]), 1)));
  }
}

// By the places that corners and the middle of the last image have in this one.
double ImageMotion::of_sky(const world::Camera& camera) const {
  if (!last_ || !(shown_.has_sky() || shown_.stars().catalogue)) return 0;
  world::Camera from = *last_, to = camera;
  from.position = to.position = Vec3(0);  // what is far
  double most = 0;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0}) {
      const Vec2 pixel(x * camera.width, y * camera.height);
      const auto ray = world::distorted_ray(from, pixel);
      const auto there = ray ? world::project(to, ray->direction) : std::nullopt;
      if (there) most = std::max(most, glm::length(*there - pixel));
    }
  return most;
}

double ImageMotion::add(const WorldState& state, const world::Camera& camera) {
  show(state, world_, shown_);
  evaluation_.update(shown_);
  if (rigid_.empty()) find_rigid_points(camera);
  before_.swap(now_);
  now_.clear();
  for (std::size_t i = 0; i < shown_.size(); ++i) project_target(i, camera);
  double most = of_sky(camera);
  last_ = camera;
  for (std::size_t i = 0; i < before_.size(); ++i) {
    double near = 0, any = 0;
    for (std::size_t k = 0; k < before_[i].size(); ++k) {
      const Place& from = before_[i][k];
      const Place& to = now_[i][k];
      if (!from.in_front || !to.in_front) continue;
      const double motion = glm::length(to.pixel - from.pixel);
      any = std::max(any, motion);
      if (from.near || to.near) near = std::max(near, motion);
    }
    most = std::max(most, near > 0 ? near : any);
  }
  return most;
}

}  // namespace panwright::workspace
