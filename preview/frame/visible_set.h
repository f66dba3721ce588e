// What of a world one camera may see. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/draw_list.h"
#include "preview/frame/projection.h"
#include "world/evaluation.h"

namespace panwright::preview {

// A target in view.
struct VisibleTarget {
  std::uint32_t target = 0;          // index in the world
  std::uint32_t first_id = 0;        // item i of its list has the id first_id + i + 1
  std::vector<std::uint32_t> items;  // of its list, ascending
  std::vector<PlacedBox> boxes;      // of these items
};

// Targets whose depths overlap, with the range that holds them. What stands apart in depth has a
// range of its own, so that no target costs another one precision.
struct DepthGroup {
  DepthRange depth;
  std::vector<std::uint32_t> targets;  // into VisibleSet::targets, ascending
};

struct VisibleSet {
  std::vector<VisibleTarget> targets;  // as they stand in the world
  std::vector<DepthGroup> groups;      // from the farthest to the nearest
};

// A target as the visible set asks for it.
struct TargetShape {
  const world::Pose* pose = nullptr;
  const world::Bounds* bounds = nullptr;  // model frame; null: nothing of it is visible
  std::span<const DrawItem> items;
  std::uint32_t instances = 0;  // of its model, visible or not: the ids that it takes
};

// Finds visible sets, one after the other in the same memory.
class VisibleSetFinder {
 public:
  // Returns what stays until the next call. Cost: O(targets + items of the targets in view).
  const VisibleSet& find(const world::Camera& camera, std::span<const TargetShape> targets);
  const VisibleSet& last() const { return set_; }

 private:
  // Where the depths of one target lie.
  struct Interval {
    DepthRange depth;
    std::uint32_t target = 0;
  };
  void group(world::Projection projection);

  VisibleSet set_;
  std::vector<Interval> intervals_;
  std::vector<PlacedBox> boxes_;
};

}  // namespace panwright::preview
