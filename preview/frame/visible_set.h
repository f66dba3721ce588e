// Visible set of one camera. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/projection.h"
#include "preview/model/draw_list.h"
#include "world/evaluation.h"

namespace panwright::preview {

// Target in view.
struct VisibleTarget {
  std::uint32_t target = 0;          // index in the world
  std::uint32_t first_id = 0;        // item i of its list has the id first_id + i + 1
  std::vector<std::uint32_t> items;  // of its list, ascending
  std::vector<PlacedBox> boxes;      // of these items
};

// Targets whose depths overlap, with their range. Targets apart in depth have ranges of their own,
// so that none costs another one precision.
struct DepthGroup {
  DepthRange depth;
  std::vector<std::uint32_t> targets;  // into VisibleSet::targets, ascending
};

struct VisibleSet {
  std::vector<VisibleTarget> targets;  // in the world's order
  std::vector<DepthGroup> groups;      // from the farthest to the nearest
};

// Target as an input of the visible set.
struct TargetShape {
  const world::Pose* pose = nullptr;
  const AxisBox* bounds = nullptr;  // model frame; null: fully hidden
  std::span<const DrawItem> items;
  std::uint32_t instances = 0;  // number of its model's, visible or not: the ids that it takes
};

// Finder of visible sets, one after the other in the same memory.
class VisibleSetFinder {
 public:
  // Returns a set valid until the next call. Cost: O(targets + items of the targets in view).
  const VisibleSet& find(const world::Camera& camera, std::span<const TargetShape> targets);
  const VisibleSet& last() const { return set_; }

 private:
  // Depth interval of one target.
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
