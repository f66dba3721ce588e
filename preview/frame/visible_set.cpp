#include "preview/frame/visible_set.h"

#include <algorithm>

namespace panwright::preview {

std::vector<DepthGroup> depth_groups(world::Projection projection,
                                     std::span<const VisibleTarget> targets) {
  struct Interval {
    DepthRange depth;
    std::uint32_t target = 0;
  };
  std::vector<Interval> intervals;
  for (std::uint32_t i = 0; i < targets.size(); ++i)
    intervals.push_back({fitted_depth(projection, targets[i].boxes), i});
  std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) {
    return a.depth.near != b.depth.near ? a.depth.near < b.depth.near : a.target < b.target;
  });
  std::vector<DepthGroup> groups;
  for (const Interval& interval : intervals) {
    if (groups.empty() || interval.depth.near > groups.back().depth.far)
      groups.push_back({interval.depth, {}});
    DepthGroup& group = groups.back();
    group.depth.far = std::max(group.depth.far, interval.depth.far);
    group.targets.push_back(interval.target);
  }
  std::reverse(groups.begin(), groups.end());
  for (DepthGroup& group : groups) {
    std::sort(group.targets.begin(), group.targets.end());
    if (group.targets.size() == 1) continue;
    std::vector<PlacedBox> boxes;
    for (const std::uint32_t target : group.targets)
      boxes.insert(boxes.end(), targets[target].boxes.begin(), targets[target].boxes.end());
    group.depth = fitted_depth(projection, boxes);
  }
  return groups;
}

VisibleSet visible_set(const world::Camera& camera, std::span<const TargetShape> targets) {
  const Tile whole{0, 0, camera.width, camera.height};
  VisibleSet result;
  std::uint32_t first_id = 0;
  for (std::uint32_t index = 0; index < targets.size(); ++index) {
    const TargetShape& target = targets[index];
    VisibleTarget visible;
    visible.target = index;
    visible.first_id = first_id;
    first_id += target.instances;
    if (!target.bounds) continue;
    // note: camera from model first, so that large translations of both cancel before the small
    // ones of the nodes join in
    const Mat4 camera_from_model = camera_from(camera, target.pose->matrix());
    const bool several = targets.size() > 1;
    if (several &&
        !may_touch(camera, whole, 1.0, {camera_from_model, target.bounds->min, target.bounds->max}))
      continue;
    for (std::uint32_t i = 0; i < target.items.size(); ++i) {
      const DrawItem& item = target.items[i];
      if (!item.visible) continue;
      const PlacedBox box{camera_from_model * item.model_from_mesh, item.low, item.high};
      if (!may_touch(camera, whole, 1.0, box)) continue;
      visible.items.push_back(i);
      visible.boxes.push_back(box);
    }
    if (!visible.items.empty()) result.targets.push_back(std::move(visible));
  }
  result.groups = depth_groups(camera.projection, result.targets);
  return result;
}

}  // namespace panwright::preview
