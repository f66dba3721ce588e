#include "geometry/ray/box_tree.h"

namespace panwright::geometry {
namespace {

constexpr std::size_t kLeaf = 2;  // boxes

}  // namespace

void BoxTree::build(std::vector<AxisBox> boxes) {
  boxes_ = std::move(boxes);
  order_.clear();
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
    if (!boxes_[i].empty()) order_.push_back(i);
  nodes_.assign(1, Node{});
  split(0, 0, static_cast<std::uint32_t>(order_.size()));
}

void BoxTree::split(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  AxisBox centres;
  const auto centre = [&](std::uint32_t i) { return boxes_[i].centre(); };
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes_[node].box.add(boxes_[order_[i]]);
    centres.add(centre(order_[i]));
  }
  if (end - begin <= kLeaf) {
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    return;
  }
  const Vec3 size = centres.extent();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double first = centre(a)[axis];
                     const double second = centre(b)[axis];
                     return first != second ? first < second : a < b;
                   });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.resize(nodes_.size() + 2);
  split(left, begin, middle);
  split(left + 1, middle, end);
}

}  // namespace panwright::geometry
