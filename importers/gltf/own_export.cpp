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
  if (!kind || !kind->is(Json::Kind::string) || !found.matrix.empty() || found.skin >= 0)
    return NodeKind::part;
  const bool alone = found.children.empty() && found.extensions.empty();
  const bool moved = !found.translation.empty() || !found.scale.empty();
  if (kind->text == "origin" && alone && found.mesh >= 0 && found.rotation.empty() &&
      found.scale.empty())
    return NodeKind::origin;
  if (kind->text == "frame" && alone && found.mesh < 0 && found.scale.empty())
    return NodeKind::frame;
  if (kind->text == "keypoint" && alone && found.mesh < 0 && found.scale.empty())
    return NodeKind::keypoint;
  if (kind->text == "motion" && found.extensions.empty()) return NodeKind::motion;
  if (kind->text == "axis" && !moved) return NodeKind::axis;
  return NodeKind::part;
}

std::string label_of(const Document& document, const tinygltf::Model& model, int node) {
  if (!is_ours(model)) return {};
  const Json* extras = document.root.list("nodes")[static_cast<std::size_t>(node)].find("extras");
  const Json* label = extras ? extras->find("label") : nullptr;
  return label && label->is(Json::Kind::string) ? std::string(label->text) : std::string();
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
