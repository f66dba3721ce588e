// The tab of materials: numbers that stand in the texts, changed there.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "studio/window.h"

namespace panwright::studio {
namespace {

std::string place_of(const MaterialFile& file, const pxn::EditableMaterial& material) {
  return file.path.filename().string() + "/" + material.name;
}

// What a slider goes to where the language's bound is none or far away; more may be typed.
double far_from(double value) { return std::fabs(value) <= 1 ? 1 : 10 * std::fabs(value); }

std::string trimmed(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : line.substr(begin);
}

}  // namespace

void Desk::materials_tab() {
  std::size_t count = 0;
  ImGui::BeginChild("list", {0, 0.34f * ImGui::GetWindowHeight()}, true);
  for (const MaterialFile& file : edits_.files())
    for (const pxn::EditableMaterial& material : file.materials) {
      const std::string name = place_of(file, material);
      if (ImGui::Selectable((material.name + "###" + name).c_str(), material_ == name))
        material_ = name;
      widgets_.seen("material/" + name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s:%u", file.path.c_str(), material.line);
      ++count;
    }
  if (count == 0) ImGui::TextDisabled("no named materials in these files");
  ImGui::EndChild();
  unsaved_changes();
  // a copy: a change reads the texts anew
  for (const MaterialFile& file : edits_.files())
    for (const pxn::EditableMaterial& material : file.materials)
      if (place_of(file, material) == material_)
        return material_numbers(MaterialFile(file), pxn::EditableMaterial(material));
}

void Desk::material_numbers(const MaterialFile& file, const pxn::EditableMaterial& material) {
  ImGui::Text("%s", material.name.c_str());
  if (!material.preset.empty()) ImGui::TextDisabled("starts from the preset %s", material.preset.c_str());
  if (!material.base.empty()) ImGui::TextDisabled("starts from %s", material.base.c_str());
  if (material.numbers.empty())
    ImGui::TextWrapped("No number stands in its text: it is its preset's, or of expressions.");
  std::string heading;
  for (const pxn::EditableNumber& number : material.numbers) {
    const std::string of =
        number.element + (number.attribute.empty() ? "" : " " + number.attribute);
    if (of != heading) ImGui::TextUnformatted(of.c_str());
    heading = of;
    const std::string label = !number.name.empty() ? number.name
                              : number.count > 1   ? std::to_string(number.index + 1)
                                                   : of;
    const std::string name = fmt::format("number/{}/{}/{}={}", material.name, of, number.index, label);
    double value = number.value;
    const double low = std::isfinite(number.low) ? number.low : -far_from(number.value);
    const double high = std::min(number.high, far_from(number.value));
    const std::string format = (number.integer ? "%.0f" : "%.6g") +
                               (number.unit.empty() ? "" : " " + number.unit);
    if (widgets_.slider(name, value, low, high, format.c_str(), false,
                        "As it stands in the text. Ctrl and a click: type it, larger ones too", false) &&
        !(number.above && value <= number.low) && value >= number.low && value <= number.high) {
      edits_.change(file, material, number, value);
      project_.set_unsaved(edits_.unsaved());
    }
    if (ImGui::IsItemDeactivated()) edits_.close();
  }
}

void Desk::unsaved_changes() {
  ImGui::BeginDisabled(!edits_.any());
  if (widgets_.button("materials/undo", "The last change")) {
    edits_.undo();
    project_.set_unsaved(edits_.unsaved());
  }
  ImGui::SameLine();
  if (widgets_.button("materials/save", "Write the lines below into their files")) {
    DiagnosticLog log;
    const std::size_t before = edits_.size();
    edited_ = edits_.save(log) ? fmt::format("saved {}", counted(before, "change"))
                               : log.entries().empty() ? "not saved" : log.entries()[0].message;
    project_.set_unsaved(edits_.unsaved());
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::TextDisabled("%s", edits_.any() ? counted(edits_.size(), "change").c_str() : edited_.c_str());
  if (!edits_.said().empty()) ImGui::TextWrapped("%s", edits_.said().c_str());
  if (edits_.any() && !edited_.empty() && edited_.rfind("saved", 0) != 0)
    ImGui::TextWrapped("%s", edited_.c_str());
  const auto difference = edits_.difference();
  if (difference.empty()) return;
  ImGui::BeginChild("difference", {0, 0.2f * ImGui::GetWindowHeight()}, true,
                    ImGuiWindowFlags_HorizontalScrollbar);
  for (const auto& [path, lines] : difference) {
    ImGui::TextDisabled("%s", path.filename().c_str());
    for (const ChangedLine& line : lines) {
      ImGui::TextColored({0.95f, 0.6f, 0.3f, 1}, "%u - %s", line.number, trimmed(line.before).c_str());
      ImGui::TextColored({0.4f, 0.75f, 1, 1}, "%u + %s", line.number, trimmed(line.after).c_str());
    }
  }
  ImGui::EndChild();
}

}  // namespace panwright::studio
