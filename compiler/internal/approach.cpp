#include "compiler/internal/approach.h"

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "compiler/internal/surfaces.h"

namespace panwright::compiler::internal {
namespace {

Vec3 origin_of(const Mat4& matrix) { return Vec3(matrix[3]); }

}  // namespace

Reach reach_of(const scene::Scene& scene, const std::vector<Mat4>& world, std::size_t instance,
               const Vec3& low, const Vec3& high) {
  const auto node = static_cast<std::size_t>(scene.instances[instance].node);
  Reach out;
  out.centre = Vec3(world[node] * Vec4((low + high) / 2.0, 1));
  out.radius = placed({low, high}, world[node]).diagonal() / 2;
  if (scene.joints.empty()) return out;
  for (std::int32_t n = scene.instances[instance].node; n != scene::kNone;
       n = scene.nodes[static_cast<std::size_t>(n)].parent) {
    double slides = 0;
    bool moves = false;
    for (const scene::Joint& joint : scene.joints) {
      if (joint.node != n || !scene::can_move(joint)) continue;
      moves = true;
      const bool turns = joint.kind == scene::JointKind::revolute ||
                         joint.kind == scene::JointKind::continuous ||
                         joint.kind == scene::JointKind::ball;
      if (turns) continue;
      if (joint.kind == scene::JointKind::prismatic && !joint.lower.empty()) {
        const double scale = stretch_of(world[static_cast<std::size_t>(n)]).largest;
        // from where it stands, to either end
        slides += scale * (joint.upper.front() - joint.lower.front());
      } else {
        out.bounded = false;
      }
    }
    if (!moves) continue;
    const Vec3 origin = origin_of(world[static_cast<std::size_t>(n)]);
    out.radius += glm::length(out.centre - origin) + slides;
    out.centre = origin;
  }
  return out;
}

double nearest_in_corridor(const Vec3& apex, const Vec3& axis, double corridor, double nearest,
                           const Reach& part) {
  const Vec3 p = part.centre - apex;
  const double along = glm::dot(p, axis), across = glm::length(p - along * axis);
  const double distance = std::sqrt(along * along + across * across);
  const double angle = det::atan2(across, along);
  double to_centre = 0;
  if (angle <= corridor) {
    to_centre = std::max(nearest - distance, 0.0);
  } else {
    const double between = angle - corridor;
    const double foot = distance * det::cos(std::min(between, kPi));
    to_centre = foot >= nearest ? distance * det::sin(between)
                                : std::sqrt(std::max(distance * distance + nearest * nearest -
                                                         2 * nearest * distance * det::cos(between),
                                                     0.0));
  }
  return std::max(to_centre - part.radius, nearest);
}

std::vector<double> nearest_distances(const scene::Scene& scene, const std::vector<Mat4>& world,
                                      const std::vector<geometry::MeshShape>& surfaces) {
  const double nearest = *scene.budget.nearest;
  std::vector<double> out(scene.instances.size(), nearest);
  const auto found = std::find_if(scene.frames.begin(), scene.frames.end(), [&](const auto& frame) {
    return frame.name == scene.budget.approach;
  });
  if (scene.budget.approach.empty() || found == scene.frames.end()) return out;
  const Mat4& node = world[static_cast<std::size_t>(found->node)];
  const Vec3 apex(node * Vec4(found->origin, 1));
  const Vec3 axis = glm::normalize(Vec3(node * Vec4(found->rotation * Vec3(0, 0, 1), 0)));
  std::vector<AxisBox> extents(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (surfaces[s])
      for (const Vec3& p : surfaces[s]->positions) extents[s].add(p);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const AxisBox& extent = extents[static_cast<std::size_t>(scene.instances[i].shape)];
    if (extent.empty()) continue;
    const Reach reach = reach_of(scene, world, i, extent.low, extent.high);
    if (reach.bounded)
      out[i] = nearest_in_corridor(apex, axis, scene.budget.corridor, nearest, reach);
  }
  return out;
}

}  // namespace panwright::compiler::internal
