// The table of the tab Parts: where triangles go, and how exact each part is, beside what its
// budget asks.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <vector>

#include "base/text.h"
#include "studio/window.h"

namespace panwright::studio {
namespace {

std::string budget_words(const pan::layout::Budget& budget) {
  std::string words = "budget:";
  const auto add = [&](bool given, const std::string& text) {
    if (given) words += (words.back() == ':' ? " " : ", ") + text;
  };
  add(budget.nearest > 0, fmt::format("nearest {:.4g} m", budget.nearest));
  add(budget.ifov > 0, fmt::format("{:.4g} mrad a pixel", 1e3 * budget.ifov));
  add(budget.pixels > 0, fmt::format("outlines to {:.3g} px", budget.pixels));
  add(budget.flux > 0, fmt::format("flux to {:.3g} %", 100 * budget.flux));
  add(budget.centroid > 0, fmt::format("photocentre to {:.3g} px", budget.centroid));
  add(budget.tolerance > 0, fmt::format("tolerance {:.4g} mm", 1e3 * budget.tolerance));
  return words;
}

}  // namespace

void Desk::budget_table() {
  if (!shown_ || !shown_->exact || shown_->order.world != models_.world) {
    ImGui::TextDisabled("once the image is exact");
    return;
  }
  std::uint64_t drawn = 0, finest = 0;
  std::vector<const Detail*> rows;
  for (const Detail& each : shown_->details) {
    if (!each.visible) continue;
    drawn += each.triangles;
    finest += each.finest;
    const world::Instance& target = (*models_.world)[each.target];
    if (!search_.empty() &&
        !holds(target.name() + "/" + target.model()->node_path(each.node), search_))
      continue;
    rows.push_back(&each);
  }
  for (const world::Instance& target : models_.world->instances()) {
    const pan::layout::Budget* budget = target.model()->budget();
    ImGui::TextWrapped("%s: %s", target.name().c_str(),
                       budget ? budget_words(*budget).c_str() : "no budget");
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
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const Detail& each = *rows[static_cast<std::size_t>(i)];
      const world::Instance& target = (*models_.world)[each.target];
      const std::string path = target.name() + "/" + target.model()->node_path(each.node);
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      const auto slash = path.rfind('/');
      ImGui::PushID(path.c_str());
      const std::string own = path.substr(slash + 1);
      const std::string shown = models_.world->size() > 1 ? target.name() + ": " + own : own;
      if (ImGui::Selectable(shown.c_str(), selected_ == path, ImGuiSelectableFlags_SpanAllColumns))
        selected_ = path;
      widgets_.seen("cost/" + path);
      if (ImGui::IsItemHovered())
        widgets_.tip(fmt::format("{}\n{} of {}; error {:.3g} mm{}", path,
                                 counted(each.triangles, "triangle"), each.finest, 1e3 * each.error,
                                 each.level > 0 ? fmt::format("; level {}", each.level) : "")
                         .c_str());
      ImGui::PopID();
      ImGui::TableNextColumn();
      ImGui::Text("%llu", static_cast<unsigned long long>(each.triangles));
      ImGui::TableNextColumn();
      ImGui::Text("%.1f", drawn > 0 ? 100.0 * static_cast<double>(each.triangles) /
                                          static_cast<double>(drawn)
                                    : 0.0);
      ImGui::TableNextColumn();
      ImGui::Text("%.2g", each.pixels);
    }
  ImGui::EndTable();
}

}  // namespace panwright::studio
