#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "studio/panels.h"

namespace panwright::studio {
namespace {

constexpr std::string_view kFoil = "foil ";  // prefix of the names of sheets

bool is_foil(const pxn::EditableMaterial& material) { return material.name.starts_with(kFoil); }

std::string material_key(const MaterialFile& file, const pxn::EditableMaterial& material) {
  return file.path.filename().string() + "/" + material.name;
}

// End of a slider where the language has no bound or a far one; larger values may be typed.
double slider_reach(double value) { return std::fabs(value) <= 1 ? 1 : 10 * std::fabs(value); }

std::string without_indent(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : line.substr(begin);
}

}  // namespace

std::string MaterialsPanel::material_name() const {
  return selected_.substr(selected_.rfind('/') + 1);
}

void MaterialsPanel::draw() {
  list();
  if (!ImGui::BeginTabBar("of the material")) return;
  const auto tab = [&](const char* name) {
    const bool open = ImGui::BeginTabItem(name);
    state_.widgets.record(std::string("materials/") + name);
    return open;
  };
  if (tab("Numbers")) {
    numbers();
    ImGui::EndTabItem();
  }
  if (tab("Curves")) {
    const std::string name = material_name();
    if (name.starts_with(kFoil)) {
      foil_.draw(name.substr(kFoil.size()));
    } else {
      sample_.request_material(name);
      sample_.draw();
    }
    ImGui::EndTabItem();
  }
  if (tab("Library")) {
    library();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

// Materials of the texts, then those of models without a text.
void MaterialsPanel::list() {
  std::size_t count = 0;
  std::set<std::string> in_texts;
  ImGui::BeginChild("list", {0, 0.26f * ImGui::GetWindowHeight()}, true);
  const auto row = [&](const std::string& name, const std::string& key, const std::string& where) {
    if (ImGui::Selectable((name + "###" + key).c_str(), selected_ == key)) selected_ = key;
    state_.widgets.record("material/" + key);
    state_.widgets.tooltip(where.c_str());
    ++count;
  };
  std::error_code ignored;
  const std::filesystem::path here = std::filesystem::current_path(ignored);
  for (const MaterialFile& file : edits_.files())
    for (const pxn::EditableMaterial& material : file.materials) {
      row(material.name, material_key(file, material),
          fmt::format("{}:{}", file.path.lexically_proximate(here).string(), material.line));
      in_texts.insert(material.name);
    }
  const auto& world = state_.models.world;
  for (std::size_t i = 0; world && i < world->size(); ++i) {
    const pan::Model& model = *(*world)[i].model();
    for (std::size_t k = 0; k < model.materials().size(); ++k) {
      const std::string name(model.material_name(k));
      if (!name.empty() && in_texts.insert(name).second)
        row(name, "model/" + name, "In a model without a source text");
    }
  }
  if (count == 0) ImGui::TextDisabled("no named materials");
  ImGui::EndChild();
}

void MaterialsPanel::numbers() {
  unsaved_changes();
  for (const std::string& file : state_.models.targets)
    if (file.ends_with(".pan")) {
      ImGui::TextWrapped("%s is a pan file: changes of its text appear once it is compiled again.",
                         file.c_str());
      break;
    }
  for (const MaterialFile& file : edits_.files())
    for (const pxn::EditableMaterial& material : file.materials)
      if (material_key(file, material) == selected_) {
        // copies: a change reads the texts again
        const MaterialFile file_now = file;
        const pxn::EditableMaterial material_now = material;
        if (is_foil(material_now)) foil_seed(file_now, material_now);
        material_numbers(file_now, material_now);
        return;
      }
  if (!selected_.empty())
    ImGui::TextWrapped("No source text of these models holds its numbers; see its curves.");
}

// A button for another sheet of the same kind.
void MaterialsPanel::foil_seed(const MaterialFile& file, const pxn::EditableMaterial& foil) {
  for (const pxn::EditableNumber& number : foil.numbers) {
    if (number.attribute != "seed") continue;
    if (state_.widgets.button("foil/another seed", "Another sheet of the same kind: seed + 1")) {
      edits_.change(file, foil, number, number.value < 4294967295.0 ? number.value + 1 : 0);
      edits_.close();
      state_.project.set_unsaved(edits_.unsaved());
    }
    return;
  }
  ImGui::TextDisabled("Its seed is not written as a number.");
}

void MaterialsPanel::material_numbers(const MaterialFile& file,
                                      const pxn::EditableMaterial& material) {
  ImGui::Text("%s", material.name.c_str());
  if (!material.preset.empty())
    ImGui::TextDisabled("based on the preset %s", material.preset.c_str());
  if (!material.base.empty()) ImGui::TextDisabled("based on %s", material.base.c_str());
  if (material.numbers.empty() && material.inherited.empty())
    ImGui::TextWrapped("Its text holds no numbers: they come from expressions.");
  number_sliders(file, material, material.numbers,
                 "As in the text. Ctrl + click to type, also larger values");
  if (material.inherited.empty()) return;
  ImGui::Separator();
  ImGui::TextDisabled("of the preset; a change writes the element into the text");
  number_sliders(file, material, material.inherited,
                 "Of the preset. Ctrl + click to type, also larger values");
}

void MaterialsPanel::number_sliders(const MaterialFile& file, const pxn::EditableMaterial& material,
                                    const std::vector<pxn::EditableNumber>& numbers,
                                    const char* help) {
  std::string heading;
  for (const pxn::EditableNumber& number : numbers) {
    const std::string of =
        number.element + (number.attribute.empty() ? "" : " " + number.attribute);
    if (of != heading) ImGui::TextUnformatted(of.c_str());
    heading = of;
    const std::string label = !number.name.empty() ? number.name
                              : number.count > 1   ? std::to_string(number.index + 1)
                                                   : of;
    const std::string name =
        fmt::format("number/{}/{}/{}={}", material.name, of, number.index, label);
    double value = number.value;
    const double low = std::isfinite(number.low) ? number.low : -slider_reach(number.value);
    const double high = std::min(number.high, slider_reach(number.value));
    const std::string format =
        (number.integer ? "%.0f" : "%.6g") + (number.unit.empty() ? "" : " " + number.unit);
    if (state_.widgets.slider(name, value, low, high, format.c_str(), false, help, false) &&
        !(number.above && value <= number.low) && value >= number.low && value <= number.high) {
      edits_.change(file, material, number, value);
      state_.project.set_unsaved(edits_.unsaved());
    }
    if (ImGui::IsItemDeactivated()) edits_.close();
  }
}

void MaterialsPanel::unsaved_changes() {
  ImGui::BeginDisabled(!edits_.any());
  if (state_.widgets.button("materials/undo", "Undo the last change")) {
    edits_.undo();
    state_.project.set_unsaved(edits_.unsaved());
  }
  ImGui::SameLine();
  if (state_.widgets.button("materials/save", "Write the lines below to their files")) {
    DiagnosticLog log;
    const std::size_t before = edits_.size();
    save_message_ = edits_.save(log)        ? fmt::format("saved {}", counted(before, "change"))
                    : log.entries().empty() ? "not saved"
                                            : log.entries()[0].message;
    state_.project.set_unsaved(edits_.unsaved());
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::TextDisabled(
      "%s", edits_.any() ? counted(edits_.size(), "change").c_str() : save_message_.c_str());
  if (!edits_.message().empty()) ImGui::TextWrapped("%s", edits_.message().c_str());
  if (edits_.any() && !save_message_.empty() && !save_message_.starts_with("saved"))
    ImGui::TextWrapped("%s", save_message_.c_str());
  const auto difference = edits_.difference();
  if (difference.empty()) return;
  ImGui::BeginChild("difference", {0, 0.2f * ImGui::GetWindowHeight()}, true,
                    ImGuiWindowFlags_HorizontalScrollbar);
  for (const auto& [path, lines] : difference) {
    ImGui::TextDisabled("%s", path.filename().c_str());
    for (const ChangedLine& line : lines) {
      ImGui::TextColored({0.95f, 0.6f, 0.3f, 1}, "%u - %s", line.number,
                         without_indent(line.before).c_str());
      ImGui::TextColored({0.4f, 0.75f, 1, 1}, "%u + %s", line.number,
                         without_indent(line.after).c_str());
    }
  }
  ImGui::EndChild();
}

void MaterialsPanel::library() {
  state_.widgets.text("library/search", preset_search_, "part of a name");
  ImGui::BeginChild("presets", {0, 0.3f * ImGui::GetWindowHeight()}, true);
  for (const std::string_view name : pxn::preset_names()) {
    if (name.find(preset_search_) == std::string_view::npos) continue;
    if (ImGui::Selectable(std::string(name).c_str(), preset_ == name)) preset_ = name;
    state_.widgets.record("preset/" + std::string(name));
  }
  ImGui::EndChild();
  if (preset_.empty()) return;
  sample_.request_preset(preset_);
  const std::string attribute = fmt::format("material=\"{}\"", preset_);
  if (state_.widgets.button("library/copy", "Copy the attribute for a shape or node"))
    ImGui::SetClipboardText(attribute.c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", attribute.c_str());
  const pxn::Provenance& provenance = sample_.provenance();
  const std::pair<const char*, const std::string*> lines[] = {
      {"source", &provenance.source},
      {"published", &provenance.published},
      {"fitted", &provenance.fitted},
      {"indicative", &provenance.indicative}};
  for (const auto& [name, text] : lines)
    if (!text->empty()) ImGui::TextWrapped("%s: %s", name, text->c_str());
  ImGui::Separator();
  sample_.draw();
}

}  // namespace panwright::studio
