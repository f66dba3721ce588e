#include "importers/internal/placed_node.h"

namespace panwright::importers {

std::int32_t add_placed(std::vector<scene::Node>& nodes, scene::Node node,
                        const scene::Decomposed& parts) {
  node.parent_from_node = parts.outer;
  nodes.push_back(std::move(node));
  if (parts.sheared) {
    scene::Node inner = nodes.back();
    inner.parent = static_cast<std::int32_t>(nodes.size() - 1);
    inner.parent_from_node = parts.inner;
    inner.name += "_shear";
    nodes.push_back(std::move(inner));
  }
  return static_cast<std::int32_t>(nodes.size() - 1);
}

}  // namespace panwright::importers
