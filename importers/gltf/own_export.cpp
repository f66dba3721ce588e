#include "importers/gltf/own_export.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace panwright::importers::gltf {

namespace {

using tinygltf::Node;

bool is_ours(const tinygltf::Model& model) { return model.asset.generator == "panwright"; }

bool holds_nothing(const Node& node) {
  return node.mesh < 0 && node.skin < 0 && node.extensions.empty();
}

}  // namespace

NodeKind kind_of(const Document& document, const tinygltf::Model& model, int node) {
  if (!is_ours(model)) return NodeKind::part;
  const Json* extras = document.root.list("nodes")[static_cast<std::size_t>(node)].find("extras");
  const Json* kind = extras ? extras->find("kind") : nullptr;
  const Node& found = model.nodes[static_cast<std::size_t>(node)];
  const bool plain = found.children.empty() && found.extensions.empty() && found.matrix.empty() &&
                     found.scale.empty() && found.skin < 0;
  if (!kind || !kind->is(Json::Kind::string) || !plain) return NodeKind::part;
  if (kind->text == "origin" && found.mesh >= 0 && found.rotation.empty()) return NodeKind::origin;
  if (kind->text == "frame" && found.mesh < 0) return NodeKind::frame;
  if (kind->text == "keypoint" && found.mesh < 0) return NodeKind::keypoint;
  return NodeKind::part;
}

std::optional<int> exported_root(const tinygltf::Model& model, const std::vector<int>& roots) {
  if (!is_ours(model) || roots.size() != 1) return std::nullopt;
  const Node& top = model.nodes[static_cast<std::size_t>(roots[0])];
  constexpr double kRounding = 1e-12;
  const double half = std::sqrt(0.5);
  const double turn[] = {-half, 0, 0, half};
  const bool turned = std::ranges::equal(
      top.rotation, turn, [](double a, double b) { return std::fabs(a - b) <= kRounding; });
  if (top.name != "panwright" || !turned || !top.translation.empty() || !top.scale.empty() ||
      !holds_nothing(top) || top.children.size() != 1)
    return std::nullopt;
  const Node& root = model.nodes[static_cast<std::size_t>(top.children[0])];
  if (!root.translation.empty() || !root.rotation.empty() || !root.scale.empty() ||
      !root.matrix.empty() || root.skin >= 0 || !root.extensions.empty())
    return std::nullopt;
  return top.children[0];
}

}  // namespace panwright::importers::gltf
