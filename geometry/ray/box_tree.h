// Tree of axis-aligned boxes for rays, points and other trees, in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/axis_box.h"
#include "base/math.h"

namespace panwright::geometry {

// Tree over boxes, halved by number along the longest side of their centres. Callers widen boxes by
// the rounding error: the slabs here are not widened.
//
// Cost: about 130 bytes a box; O(log boxes) a ray, expected.
class BoxTree {
 public:
  // Builds the tree. Empty boxes are left out; the others keep their indices.
  void build(std::vector<AxisBox> boxes);

  // Calls visit(index) for every box that a ray enters at a distance in [from, to], roughly from
  // near to far, until it returns true.
  //
  //   to  may shrink while visit() runs: boxes beyond are then skipped
  template <class Visit>
  void search(const Vec3& origin, const Vec3& direction, double from, const double& to,
              Visit&& visit) const;

  // The same for every box that a ray of a bundle may enter: of one origin, within bounds of their
  // directions.
  template <class Visit>
  void search(const Vec3& origin, const AxisBox& directions, double from, const double& to,
              Visit&& visit) const;

  // Returns true if a ray enters a box at a distance in [from, to].
  //
  //   inverse  inverse_of() its direction
  bool enters(std::uint32_t box, const Vec3& origin, const Vec3& inverse, double from,
              double to) const {
    return entry(boxes_[box], origin, inverse, from, to) < kInfinity;
  }
  // Returns 1 / direction, finite, so that 0 times it is a number on the face of a box.
  static Vec3 inverse_of(const Vec3& direction) {
    Vec3 inverse;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = direction[axis];
      inverse[axis] = 1 / (std::fabs(d) < 1e-300 ? std::copysign(1e-300, d) : d);
    }
    return inverse;
  }

  // Calls visit(index) for every box within a distance of a point, roughly from near to far.
  //
  //   squared  m²: of the distance; may shrink while visit() runs
  template <class Visit>
  void near(const Vec3& point, const double& squared, Visit&& visit) const;

  // Calls visit(index, other index) for pairs of boxes that may meet, all that do among them, until
  // it returns true; returns whether it did.
  //
  //   moved  gives the box here around a box of the other tree
  template <class Move, class Visit>
  bool meet(const BoxTree& other, Move&& moved, Visit&& visit) const;

  // The box around all. Expects: built.
  const AxisBox& box() const { return nodes_[0].box; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  // Children, or boxes order_[first, first + count).
  struct Node {
    AxisBox box;
    std::uint32_t first = 0;  // count 0: the left child; the right one follows it
    std::uint32_t count = 0;
  };

  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t end);

  // Returns the distance at which a ray enters a box; infinity: not within [from, to].
  static double entry(const AxisBox& box, const Vec3& origin, const Vec3& inverse, double from,
                      double to) {
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.low[axis] - origin[axis]) * inverse[axis];
      const double b = (box.high[axis] - origin[axis]) * inverse[axis];
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    return from <= to ? from : kInfinity;
  }

  template <class Enter, class Visit>
  void walk(const Enter& enter, const double& to, Visit&& visit) const;

  static double squared_distance(const AxisBox& box, const Vec3& point) {
    const Vec3 off = glm::max(glm::max(box.low - point, point - box.high), Vec3(0));
    return glm::dot(off, off);
  }

  std::vector<AxisBox> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;  // 0: the root
};

template <class Visit>
void BoxTree::near(const Vec3& point, const double& squared, Visit&& visit) const {
  if (order_.empty()) return;
  struct Waiting {
    std::uint32_t node;
    double squared;
  };
  std::array<Waiting, 40> waiting;  // enough, as in search()
  std::size_t count = 0;
  waiting[count++] = {0, squared_distance(nodes_[0].box, point)};
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (next.squared > squared) continue;
    const Node& node = nodes_[next.node];
    if (node.count == 0) {
      Waiting near{node.first, squared_distance(nodes_[node.first].box, point)};
      Waiting far{node.first + 1, squared_distance(nodes_[node.first + 1].box, point)};
      if (far.squared < near.squared) std::swap(near, far);
      if (far.squared <= squared) waiting[count++] = far;
      if (near.squared <= squared) waiting[count++] = near;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (squared_distance(boxes_[order_[i]], point) <= squared) visit(order_[i]);
  }
}

// enter: the distance at which a box is entered; infinity: it is not
template <class Enter, class Visit>
void BoxTree::walk(const Enter& enter, const double& to, Visit&& visit) const {
  if (order_.empty()) return;
  if (order_.size() == 1) {
    if (enter(nodes_[0].box) < kInfinity) visit(order_[0]);
    return;
  }
  struct Waiting {
    std::uint32_t node;
    double entry;
  };
  // note: the tree is halved at each level, so 2^32 boxes need no more
  std::array<Waiting, 40> waiting;
  std::size_t count = 0;
  const double first = enter(nodes_[0].box);
  if (first < kInfinity) waiting[count++] = {0, first};
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (next.entry > to) continue;
    const Node& node = nodes_[next.node];
    if (node.count == 0) {
      Waiting near{node.first, enter(nodes_[node.first].box)};
      Waiting far{node.first + 1, enter(nodes_[node.first + 1].box)};
      if (far.entry < near.entry) std::swap(near, far);
      if (far.entry < kInfinity) waiting[count++] = far;
      if (near.entry < kInfinity) waiting[count++] = near;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t box = order_[i];
      if (node.count > 1 && enter(boxes_[box]) == kInfinity) continue;
      if (visit(box)) return;
    }
  }
}

template <class Visit>
void BoxTree::search(const Vec3& origin, const Vec3& direction, double from, const double& to,
                     Visit&& visit) const {
  const Vec3 inverse = inverse_of(direction);
  walk([&](const AxisBox& box) { return entry(box, origin, inverse, from, to); }, to, visit);
}

template <class Visit>
void BoxTree::search(const Vec3& origin, const AxisBox& directions, double from, const double& to,
                     Visit&& visit) const {
  const Vec3 &least = directions.low, &most = directions.high;
  const Vec3 by_least = inverse_of(least), by_most = inverse_of(most);
  // at a distance t the rays cover [t·least, t·most] of each axis about the origin
  const auto enter = [&](const AxisBox& box) {
    double begin = from, end = to;
    for (int axis = 0; axis < 3; ++axis) {
      const double reaches = (box.low[axis] - origin[axis]) * by_most[axis];
      const double leaves = (box.high[axis] - origin[axis]) * by_least[axis];
      if (by_most[axis] > 0)
        begin = std::max(begin, reaches);
      else
        end = std::min(end, reaches);
      if (by_least[axis] > 0)
        end = std::min(end, leaves);
      else
        begin = std::max(begin, leaves);
    }
    return begin <= end ? begin : kInfinity;
  };
  walk(enter, to, visit);
}

template <class Move, class Visit>
bool BoxTree::meet(const BoxTree& other, Move&& moved, Visit&& visit) const {
  if (order_.empty() || other.order_.empty()) return false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, 0}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Node &x = nodes_[a], &y = other.nodes_[b];
    if (!x.box.meets(moved(y.box))) continue;
    if (x.count > 0 && y.count > 0) {
      for (std::uint32_t j = y.first; j < y.first + y.count; ++j)
        for (std::uint32_t i = x.first; i < x.first + x.count; ++i)
          if (visit(order_[i], other.order_[j])) return true;
    } else if (y.count > 0 || (x.count == 0 && x.box.diagonal() >= y.box.diagonal())) {
      open.emplace_back(x.first, b);
      open.emplace_back(x.first + 1, b);
    } else {
      open.emplace_back(a, y.first);
      open.emplace_back(a, y.first + 1);
    }
  }
  return false;
}

}  // namespace panwright::geometry
