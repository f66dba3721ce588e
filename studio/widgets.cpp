#include "studio/widgets.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::studio {

constexpr double kMostDragged = 1e9;  // places, metres
namespace {

std::string label_of(const std::string& name) {
  const auto label = name.rfind('=');
  return name.substr((label == std::string::npos ? name.rfind('/') : label) + 1);
}

// What ImGui goes by: the label is shown, the name tells it from others of that label.
std::string tag(const std::string& name) { return label_of(name) + "###" + name; }

}  // namespace

void Widgets::seen(const std::string& name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  if (ImGui::IsItemVisible()) seen(name, {low.x, low.y}, {high.x, high.y});
}

void Widgets::seen(const std::string& name, const Vec2& low, const Vec2& high) {
  places_[name.substr(0, name.rfind('='))] = {low, high, frame_};
}

const Place* Widgets::find(const std::string& name) const {
  const auto at = places_.find(name);
  return at == places_.end() || at->second.frame != frame_ ? nullptr : &at->second;
}

std::string Widgets::nearest(const std::string& name) const {
  std::vector<std::string_view> names;
  for (const auto& [each, place] : places_)
    if (place.frame == frame_) names.push_back(each);
  return std::string(nearest_name(name, names).value_or(""));
}

void Widgets::explain(const std::string& name, const char* help) {
  seen(name);
  if (help != nullptr) tip(help);
}

void Widgets::tip(const char* help) {
  if (!ImGui::IsItemHovered()) return;
  // beside the panel: it hides no widget
  const ImVec2 low = ImGui::GetItemRectMin();
  ImGui::SetNextWindowPos({ImGui::GetWindowPos().x + ImGui::GetWindowWidth() + 8, low.y});
  ImGui::SetTooltip("%s", help);
}

bool holds(std::string_view name, std::string_view wanted) {
  const auto same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
  return std::search(name.begin(), name.end(), wanted.begin(), wanted.end(), same) != name.end();
}

bool Widgets::button(const std::string& name, const char* help) {
  const bool pressed = ImGui::Button(tag(name).c_str());
  explain(name, help);
  return pressed;
}

bool Widgets::check(const std::string& name, bool& value, const char* help) {
  const bool changed = ImGui::Checkbox(tag(name).c_str(), &value);
  explain(name, help);
  return changed;
}

bool Widgets::slider(const std::string& name, double& value, double low, double high,
                     const char* format, bool logarithmic, const char* help, bool bounded) {
  const double before = value;
  bool changed = ImGui::SliderScalar(tag(name).c_str(), ImGuiDataType_Double, &value, &low, &high,
                                     format, logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  explain(name, help);
  if (!changed) return false;
  limited_.clear();
  if (!bounded || (value >= low && value <= high)) return true;
  const double typed = value;
  value = std::isnan(typed) ? before : std::clamp(typed, low, high);
  limited_ = fmt::format("{} takes {:.6g} to {:.6g}: {:.6g} was brought to {:.6g}", label_of(name),
                         low, high, typed, value);
  return value != before;
}

bool Widgets::drag(const std::string& name, double& value, double step, const char* format,
                   const char* help) {
  const double before = value;
  const bool changed = ImGui::DragScalar(tag(name).c_str(), ImGuiDataType_Double, &value,
                                         static_cast<float>(step), nullptr, nullptr, format);
  explain(name, help);
  if (!changed) return false;
  limited_.clear();
  if (std::fabs(value) <= kMostDragged) return true;
  const double typed = value;
  value = std::isnan(typed) ? before : std::clamp(typed, -kMostDragged, kMostDragged);
  limited_ = fmt::format("{} takes {:.6g} to {:.6g}: {:.6g} was brought to {:.6g}", label_of(name),
                         -kMostDragged, kMostDragged, typed, value);
  return value != before;
}

bool Widgets::choice(const std::string& name, std::string& value, const char* const* words,
                     std::size_t count, const char* help) {
  bool changed = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string each = name + "/" + words[i];
    // on the same line while there is room
    const float wide = ImGui::CalcTextSize(words[i]).x + ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().ItemSpacing.x;
    if (i > 0 && ImGui::GetItemRectMax().x + wide < ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x)
      ImGui::SameLine();
    if (ImGui::RadioButton(tag(each).c_str(), value == words[i]) && value != words[i]) {
      value = words[i];
      changed = true;
    }
    explain(each, help);
  }
  return changed;
}

bool Widgets::text(const std::string& name, std::string& value, const char* hint,
                   const char* help) {
  const bool changed = ImGui::InputTextWithHint(tag(name).c_str(), hint, &value);
  explain(name, help);
  return changed;
}

}  // namespace panwright::studio
