// The tab of materials: numbers that stand in the texts, changed there.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "base/text.h"
#include "studio/plot.h"
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

// What the names of sheets begin with.
constexpr std::string_view kFoil = "foil ";
bool is_foil(const pxn::EditableMaterial& material) { return material.name.starts_with(kFoil); }

}  // namespace

void Desk::materials_tab() {
  material_list();
  if (!ImGui::BeginTabBar("of the material")) return;
  const auto tab = [&](const char* name) {
    const bool open = ImGui::BeginTabItem(name);
    widgets_.seen(std::string("materials/") + name);
    return open;
  };
  in_library_ = false;
  if (tab("Numbers")) {
    unsaved_changes();
    for (const std::string& file : project_.files())
      if (file.ends_with(".pan")) {
        ImGui::TextWrapped("%s is a pan file: what changes in its text is seen once it is compiled again.", file.c_str());
        break;
      }
    bool found = false;
    // a copy: a change reads the texts anew
    for (const MaterialFile& file : edits_.files())
      for (const pxn::EditableMaterial& material : file.materials)
        if (!found && place_of(file, material) == material_) {
          found = true;
          if (is_foil(material)) foil_seed(file, material);
          material_numbers(MaterialFile(file), pxn::EditableMaterial(material));
        }
    if (!found && !material_.empty())
      ImGui::TextWrapped("Its numbers stand in no text of these models: its curves can be looked at.");
    ImGui::EndTabItem();
  }
  if (tab("Curves")) {
    const std::string name = material_.substr(material_.rfind('/') + 1);
    if (name.starts_with(kFoil)) {
      foil_curves(name.substr(kFoil.size()));
    } else {
      ask_for_sample();
      material_curves();
    }
    ImGui::EndTabItem();
  }
  if (tab("Library")) {
    in_library_ = true;
    material_library();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

void Desk::material_list() {
  std::size_t count = 0;
  std::set<std::string> in_texts;
  ImGui::BeginChild("list", {0, 0.26f * ImGui::GetWindowHeight()}, true);
  const auto row = [&](const std::string& name, const std::string& key, const std::string& where) {
    if (ImGui::Selectable((name + "###" + key).c_str(), material_ == key)) material_ = key;
    widgets_.seen("material/" + key);
    widgets_.tip(where.c_str());
    ++count;
  };
  std::error_code ignored;
  const std::filesystem::path here = std::filesystem::current_path(ignored);
  for (const MaterialFile& file : edits_.files())
    for (const pxn::EditableMaterial& material : file.materials) {
      row(material.name, place_of(file, material),
          fmt::format("{}:{}", file.path.lexically_proximate(here).string(), material.line));
      in_texts.insert(material.name);
    }
  for (std::size_t i = 0; models_.world && i < models_.world->size(); ++i) {
    const pan::Model& model = *(*models_.world)[i].model();
    for (std::size_t k = 0; k < model.materials().size(); ++k) {
      const std::string name(model.material_name(k));
      if (!name.empty() && in_texts.insert(name).second) row(name, "model/" + name, "of a model alone");
    }
  }
  if (count == 0) ImGui::TextDisabled("no named materials");
  ImGui::EndChild();
}

// The material that is selected, as the models have it, or the preset; once.
void Desk::ask_for_sample() {
  const std::string name = in_library_ ? preset_ : material_.substr(material_.rfind('/') + 1);
  if (name.empty()) return;
  const std::string asked = fmt::format("{} {} {}", in_library_, name, in_library_ ? 0 : models_.readings);
  if (asked == sampled_) return;
  // the same with and without a bar to scroll
  const ImGuiStyle& style = ImGui::GetStyle();
  const auto width = static_cast<std::uint32_t>(
      std::max(96.0f, std::floor(ImGui::GetWindowWidth() - style.ScrollbarSize - 2 * style.WindowPadding.x)));
  DiagnosticLog log;
  if (in_library_) {
    auto described = pxn::preset(name, log);
    if (described) {
      provenance_ = described->provenance;
      samples_.ask(*std::move(described), width);
    }
    sampled_ = asked;
    return;
  }
  for (std::size_t i = 0; models_.world && i < models_.world->size(); ++i) {
    const pan::Model& model = *(*models_.world)[i].model();
    for (std::size_t k = 0; k < model.materials().size(); ++k)
      if (model.material_name(k) == name) {
        pxn::DescribedMaterial described;
        described.material = pan::material_from(model.materials()[k], name);
        described.material.maps = {};
        samples_.ask(std::move(described), width);
        sampled_ = asked;
        return;
      }
  }
}

void Desk::material_curves() {
  const auto& sample = samples_.last();
  if (!sample) {
    ImGui::TextDisabled("%s", samples_.busy() ? "under way" : "select a material");
    return;
  }
  ImGui::Text("%s%s", sample->name.c_str(), samples_.busy() ? " (another is under way)" : "");
  if (widgets_.button("curves/hold", "Keep this one beside what comes next")) {
    held_ = *sample;
    sample_is_new_ = true;
  }
  if (held_) {
    ImGui::SameLine();
    if (widgets_.button("curves/let go")) {
      held_.reset();
      sample_is_new_ = true;
    } else {
      ImGui::SameLine();
      ImGui::TextDisabled("faint and below: %s", held_->name.c_str());
    }
  }
  if (sample_texture_ != 0)
    ImGui::Image(reinterpret_cast<ImTextureID>(sample_texture_),
                 {static_cast<float>(sample_canvas_.width), static_cast<float>(sample_canvas_.height)});
  widgets_.seen("curves/image");
  widgets_.tip("A sphere, a tilted tile and a wrinkled tile under the Sun, path traced, without maps");
  ImGui::TextWrapped("%s. %s", sample->words.c_str(), sample->verdict.c_str());
  ImGui::TextDisabled("hemispherical albedo %.3f %.3f %.3f", sample->hemispherical[0], sample->hemispherical[1],
                      sample->hemispherical[2]);
  double peak = 1e-6;
  std::vector<Curve> lobes, albedos;
  double most = 1;
  std::vector<const Sample*> both{&*sample};
  if (held_) both.insert(both.begin(), &*held_);
  for (const Sample* each : both) {
    const bool faint = each != &*sample;
    for (std::size_t i = 0; i < kSampleLights.size(); ++i) {
      for (const Vec2& point : each->lobes[i]) peak = std::max(peak, point.y);
      lobes.push_back({faint ? "" : fmt::format("light {} deg", kSampleLights[i]), &each->lobes[i],
                       static_cast<int>(i), faint});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (const Vec2& point : each->albedo[k]) most = std::max(most, point.y);
      constexpr const char* kChannels[] = {"650 nm", "550 nm", "450 nm"};
      constexpr int kColors[] = {0, 2, 1};
      albedos.push_back({faint ? "" : kChannels[k], &each->albedo[k], kColors[k], faint});
    }
  }
  const double top = std::pow(10, std::ceil(std::log10(peak)));
  plot({.title = "pi f in the plane of incidence", .x_name = "viewed from, degrees", .left = -90, .right = 90,
        .x_ticks = {-90, -60, -30, 0, 30, 60, 90}, .bottom = top * 1e-5, .top = top, .logarithmic = true},
       lobes);
  widgets_.seen("curves/lobes");
  plot({.title = "directional albedo", .x_name = "from the normal, degrees", .left = 0, .right = 90,
        .x_ticks = {0, 15, 30, 45, 60, 75, 90}, .bottom = 0, .top = most > 1 ? 1.25 * most : 1},
       albedos);
  widgets_.seen("curves/albedo");
}

// Another sheet of the same kind.
void Desk::foil_seed(const MaterialFile& file, const pxn::EditableMaterial& foil) {
  for (const pxn::EditableNumber& number : foil.numbers) {
    if (number.attribute != "seed") continue;
    if (widgets_.button("foil/another seed", "Another sheet of the same kind: the next number")) {
      edits_.change(MaterialFile(file), pxn::EditableMaterial(foil), pxn::EditableNumber(number),
                    number.value < 4294967295.0 ? number.value + 1 : 0);
      edits_.close();
      project_.set_unsaved(edits_.unsaved());
    }
    return;
  }
  ImGui::TextDisabled("Its seed is not written as a number.");
}

void Desk::foil_curves(const std::string& name) {
  const std::string of = fmt::format("{} {}", name, models_.readings);
  if (of != sloped_ && models_.world) {
    slopes_ = {};
    for (std::size_t i = 0; i < models_.world->size(); ++i) {
      SheetSlopes each = slopes_of(*(*models_.world)[i].model(), name);
      if (slopes_.sheets.empty()) slopes_ = std::move(each);
    }
    sloped_ = of;
  }
  if (slopes_.sheets.empty()) ImGui::TextWrapped("No sheet of the models is at a node of that name.");
  for (const std::string& words : slopes_.sheets) ImGui::TextWrapped("%s", words.c_str());
  if (slopes_.density[0].empty()) {
    if (!slopes_.sheets.empty()) ImGui::TextDisabled("slopes are counted of flat sheets");
    return;
  }
  std::vector<Vec2> gaussian;
  double most = 0;
  for (const Vec2& point : slopes_.density[0]) {
    const double over = point.x / slopes_.rms;
    gaussian.emplace_back(point.x, std::exp(-0.5 * over * over) / (slopes_.rms * std::sqrt(2 * kPi)));
    most = std::max({most, point.y, gaussian.back().y});
  }
  const double reach = slopes_.density[0].back().x;
  plot({.title = "slopes", .x_name = "slope", .left = -reach, .right = reach,
        .x_ticks = {-0.5 * reach, 0, 0.5 * reach}, .bottom = 1e-3 * most, .top = 1.1 * most, .logarithmic = true},
       {{"along x", &slopes_.density[0], 0, false},
        {"along y", &slopes_.density[1], 1, false},
        {"Gaussian of that RMS", &gaussian, 3, true}});
  widgets_.seen("curves/slopes");
}

void Desk::material_library() {
  widgets_.text("library/search", preset_search_, "part of a name");
  ImGui::BeginChild("presets", {0, 0.3f * ImGui::GetWindowHeight()}, true);
  for (const std::string_view name : pxn::preset_names()) {
    if (name.find(preset_search_) == std::string_view::npos) continue;
    if (ImGui::Selectable(std::string(name).c_str(), preset_ == name)) preset_ = name;
    widgets_.seen("preset/" + std::string(name));
  }
  ImGui::EndChild();
  if (preset_.empty()) return;
  ask_for_sample();
  const std::string wears = fmt::format("material=\"{}\"", preset_);
  if (widgets_.button("library/copy", "What a shape or node wears it with")) ImGui::SetClipboardText(wears.c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", wears.c_str());
  const std::pair<const char*, const std::string*> lines[] = {{"source", &provenance_.source},
                                                              {"published", &provenance_.published},
                                                              {"fitted", &provenance_.fitted},
                                                              {"indicative", &provenance_.indicative}};
  for (const auto& [what, words] : lines)
    if (!words->empty()) ImGui::TextWrapped("%s: %s", what, words->c_str());
  ImGui::Separator();
  material_curves();
}

const Desk::Canvas* Desk::new_sample_canvas() {
  if (samples_.look()) sample_is_new_ = true;
  if (!sample_is_new_ || !samples_.last() || samples_.last()->rgba.empty()) return nullptr;
  sample_is_new_ = false;
  const Sample& sample = *samples_.last();
  sample_canvas_ = {sample.width, sample.height, sample.rgba};
  if (held_ && held_->width == sample.width) {
    sample_canvas_.height += held_->height;
    sample_canvas_.rgba.insert(sample_canvas_.rgba.end(), held_->rgba.begin(), held_->rgba.end());
  }
  return &sample_canvas_;
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
