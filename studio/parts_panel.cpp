#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "studio/panels.h"

namespace panwright::studio {

void PartsPanel::draw() {
  if (!state_.models.world) return;
  Widgets& widgets = state_.widgets;
  widgets.text("parts/search", search_, "part of a name");
  if (!state_.parts.selected.empty()) selection();
  if (widgets.button("parts/show all")) state_.parts.hidden.clear();
  widgets.check("parts/labels of frames=labels", state_.layout.labels,
                "Names of frames and keypoints. Key L");
  ImGui::SameLine();
  widgets.check("parts/triangles", show_triangles_,
                "Triangles and errors of each part of the exact image, in place of the tree");
  if (widgets.check("parts/without hidden geometry=remove hidden geometry", prune_,
                    "Of CAD files, as import and compile do. Takes a while. Images stay the same"))
    state_.project.set_prune(prune_);
  if (show_triangles_)
    budget_table();
  else
    tree();
}

// The selected part, and buttons that hide it or others.
void PartsPanel::selection() {
  PartSelection& parts = state_.parts;
  ImGui::TextWrapped("%s", parts.selected.c_str());
  if (state_.widgets.button("parts/hide", "With the parts below it. Key H"))
    parts.hidden.insert(parts.selected);
  ImGui::SameLine();
  if (state_.widgets.button("parts/isolate", "Hide all other parts of the target")) isolate();
  ImGui::SameLine();
}

void PartsPanel::isolate() {
  PartSelection& parts = state_.parts;
  parts.hidden.clear();
  const world::World& world = *state_.models.world;
  const auto slash = parts.selected.find('/');
  const auto target = world.find(parts.selected.substr(0, slash));
  const std::string path = parts.selected.substr(slash + 1);
  for (std::uint32_t node = 0; target && node < world[*target].model()->nodes().size(); ++node) {
    const std::string other = world[*target].model()->node_path(node);
    const bool ancestor = path == other || path.starts_with(other + "/");
    const auto parent = other.rfind('/');
    if (!ancestor && parent != std::string::npos &&
        (path + "/").starts_with(other.substr(0, parent + 1)))
      parts.hidden.insert(parts.selected.substr(0, slash + 1) + other);
  }
}

void PartsPanel::tree() {
  const world::World& world = *state_.models.world;
  std::vector<std::pair<std::size_t, std::uint32_t>> rows;
  for (std::size_t i = 0; i < world.size(); ++i)
    for (std::uint32_t node = 0; node < world[i].model()->nodes().size(); ++node)
      rows.emplace_back(i, node);
  ImGui::BeginChild("tree");
  if (search_.empty()) {
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()));
    while (clipper.Step())
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
        node_row(rows[static_cast<std::size_t>(i)].first, rows[static_cast<std::size_t>(i)].second);
  } else {
    for (const auto& [target, node] : rows) node_row(target, node);
  }
  ImGui::EndChild();
}

void PartsPanel::node_row(std::size_t target, std::uint32_t node) {
  const world::Instance& instance = (*state_.models.world)[target];
  const std::string path = instance.name() + "/" + instance.model()->node_path(node);
  if (!search_.empty() && !contains_text(path, search_)) return;
  PartSelection& parts = state_.parts;
  bool visible = !parts.hidden.count(path);
  ImGui::PushID(path.c_str());
  if (ImGui::Checkbox("##visible", &visible)) {
    if (visible)
      parts.hidden.erase(path);
    else
      parts.hidden.insert(path);
  }
  state_.widgets.record("visible/" + path);
  ImGui::SameLine();
  std::size_t depth = 0;
  for (std::int32_t up = instance.model()->nodes()[node].parent; up >= 0 && search_.empty();
       up = instance.model()->nodes()[static_cast<std::size_t>(up)].parent)
    ++depth;
  const std::string_view name = instance.model()->node_name(node);
  const std::string label = std::string(2 * std::min<std::size_t>(depth, 12), ' ') +
                            (node == 0      ? instance.name()
                             : name.empty() ? fmt::format("[{}]", node)
                                            : std::string(name));
  if (ImGui::Selectable(label.c_str(), parts.selected == path)) parts.selected = path;
  state_.widgets.record("part/" + path);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path.c_str());
  ImGui::PopID();
}

}  // namespace panwright::studio
