// Table of the panel "Parts": triangles and errors of each part, beside the accuracy budget.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/text.h"
#include "studio/panels.h"

namespace panwright::studio {
namespace {

std::string budget_text(const pan::layout::Budget& budget) {
  std::string out = "budget:";
  const auto add = [&](bool given, const std::string& text) {
    if (given) out += (out.back() == ':' ? " " : ", ") + text;
  };
  add(budget.nearest > 0, fmt::format("nearest {:.4g} m", budget.nearest));
  add(budget.ifov > 0, fmt::format("{:.4g} mrad per pixel", 1e3 * budget.ifov));
  add(budget.pixels > 0, fmt::format("outlines to {:.3g} px", budget.pixels));
  add(budget.flux > 0, fmt::format("flux to {:.3g} %", 100 * budget.flux));
  add(budget.centroid > 0, fmt::format("photocentre to {:.3g} px", budget.centroid));
  add(budget.tolerance > 0, fmt::format("tolerance {:.4g} mm", 1e3 * budget.tolerance));
  return out;
}

}  // namespace

void PartsPanel::budget_table() {
  const RenderResult* result = state_.result.get();
  const world::World& world = *state_.models.world;
  if (result == nullptr || !result->exact || result->request.world != state_.models.world) {
    ImGui::TextDisabled("available once the image is exact");
    return;
  }
  std::uint64_t drawn = 0, finest = 0;
  std::vector<const Detail*> rows;
  for (const Detail& each : result->details) {
    if (!each.visible) continue;
    drawn += each.triangles;
    finest += each.finest;
    const world::Instance& target = world[each.target];
    if (!search_.empty() &&
        !contains_text(target.name() + "/" + target.model()->node_path(each.node), search_))
      continue;
    rows.push_back(&each);
  }
  for (const world::Instance& target : world.instances()) {
    const pan::layout::Budget* budget = target.model()->budget();
    ImGui::TextWrapped("%s: %s", target.name().c_str(),
                       budget ? budget_text(*budget).c_str() : "no budget");
  }
  ImGui::TextWrapped("%s drawn of %s", counted(drawn, "triangle").c_str(),
                     fmt::format("{}", finest).c_str());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Detail* a, const Detail* b) { return a->triangles > b->triangles; });
  if (!ImGui::BeginTable(
          "costs", 4,
          ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerV))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("part", ImGuiTableColumnFlags_WidthStretch);
  for (const char* name : {"triangles", "%", "error px"})
    ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthFixed);
  ImGui::TableHeadersRow();
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
      budget_row(*rows[static_cast<std::size_t>(i)], drawn);
  ImGui::EndTable();
}

void PartsPanel::budget_row(const Detail& detail, std::uint64_t drawn) {
  const world::World& world = *state_.models.world;
  const world::Instance& target = world[detail.target];
  const std::string path = target.name() + "/" + target.model()->node_path(detail.node);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushID(path.c_str());
  const std::string own = path.substr(path.rfind('/') + 1);
  const std::string label = world.size() > 1 ? target.name() + ": " + own : own;
  std::string& selected = state_.parts.selected;
  if (ImGui::Selectable(label.c_str(), selected == path, ImGuiSelectableFlags_SpanAllColumns))
    selected = path;
  state_.widgets.record("cost/" + path);
  if (ImGui::IsItemHovered())
    state_.widgets.tooltip(
        fmt::format("{}\n{} of {}; error {:.3g} mm{}", path, counted(detail.triangles, "triangle"),
                    detail.finest, 1e3 * detail.error,
                    detail.level > 0 ? fmt::format("; level {}", detail.level) : "")
            .c_str());
  ImGui::PopID();
  ImGui::TableNextColumn();
  ImGui::Text("%llu", static_cast<unsigned long long>(detail.triangles));
  ImGui::TableNextColumn();
  ImGui::Text(
      "%.1f",
      drawn > 0 ? 100.0 * static_cast<double>(detail.triangles) / static_cast<double>(drawn) : 0.0);
  ImGui::TableNextColumn();
  ImGui::Text("%.2g", detail.pixels);
}

}  // namespace panwright::studio
