#include "preview/frame/visible_set.h"

#include <algorithm>

namespace panwright::preview {
namespace {

// Element i of a list whose elements, and the memory in them, are used again.
template <class T>
T& element(std::vector<T>& list, std::size_t i) {
  return i < list.size() ? list[i] : list.emplace_back();
}

}  // namespace

void VisibleSetFinder::group(world::Projection projection) {
  const std::vector<VisibleTarget>& targets = set_.targets;
  intervals_.clear();
  for (std::uint32_t i = 0; i < targets.size(); ++i)
    intervals_.push_back({fitted_depth(projection, targets[i].boxes), i});
  std::sort(intervals_.begin(), intervals_.end(), [](const Interval& a, const Interval& b) {
    return a.depth.near != b.depth.near ? a.depth.near < b.depth.near : a.target < b.target;
  });
  std::size_t count = 0;
  for (const Interval& interval : intervals_) {
    if (count == 0 || interval.depth.near > set_.groups[count - 1].depth.far) {
      DepthGroup& begun = element(set_.groups, count++);
      begun.depth = interval.depth;
      begun.targets.clear();
    }
    DepthGroup& group = set_.groups[count - 1];
    group.depth.far = std::max(group.depth.far, interval.depth.far);
    group.targets.push_back(interval.target);
  }
  set_.groups.resize(count);
  std::reverse(set_.groups.begin(), set_.groups.end());
  for (DepthGroup& group : set_.groups) {
    std::sort(group.targets.begin(), group.targets.end());
    if (group.targets.size() == 1) continue;
    boxes_.clear();
    for (const std::uint32_t target : group.targets)
      boxes_.insert(boxes_.end(), targets[target].boxes.begin(), targets[target].boxes.end());
    group.depth = fitted_depth(projection, boxes_);
  }
}

const VisibleSet& VisibleSetFinder::find(const world::Camera& camera,
                                         std::span<const TargetShape> targets) {
  const Tile whole{0, 0, camera.width, camera.height};
  std::size_t count = 0;
  std::uint32_t first_id = 0;
  for (std::uint32_t index = 0; index < targets.size(); ++index) {
    const TargetShape& target = targets[index];
    const std::uint32_t id = first_id;
    first_id += target.instances;
    if (!target.bounds) continue;
    // note: camera from model first, so that large translations of both cancel before the small
    // ones of the nodes join in
    const Mat4 camera_from_model = camera_from(camera, target.pose->matrix());
    const bool several = targets.size() > 1;
    if (several && !may_touch(camera, whole, 1.0,
                              {camera_from_model, target.bounds->low, target.bounds->high}))
      continue;
    VisibleTarget& visible = element(set_.targets, count);
    visible.target = index;
    visible.first_id = id;
    visible.items.clear();
    visible.boxes.clear();
    for (std::uint32_t i = 0; i < target.items.size(); ++i) {
      const DrawItem& item = target.items[i];
      if (!item.visible) continue;
      const PlacedBox box{camera_from_model * item.model_from_mesh, item.low, item.high};
      if (!may_touch(camera, whole, 1.0, box)) continue;
      visible.items.push_back(i);
      visible.boxes.push_back(box);
    }
    if (!visible.items.empty()) ++count;
  }
  set_.targets.resize(count);
  group(camera.projection);
  return set_;
}

}  // namespace panwright::preview
