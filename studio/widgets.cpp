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

namespace {

constexpr double kDragLimit = 1e9;  // positions, metres

std::string widget_label(const std::string& name) {
  const auto label = name.rfind('=');
  return name.substr((label == std::string::npos ? name.rfind('/') : label) + 1);
}

// What a widget sets, for messages: "joint/wing=" is wing, "joint/ball/0=about x" is ball about x.
std::string widget_subject(const std::string& name) {
  const std::size_t sign = std::min(name.find('='), name.size());
  const std::size_t first = name.find('/') + 1;  // note: npos + 1 is 0
  const std::string path = name.substr(first, sign - first);
  if (sign + 1 >= name.size()) return path;
  const std::string label = name.substr(sign + 1);
  const std::size_t last = path.rfind('/');
  return last == path.npos ? label : path.substr(0, last) + " " + label;
}

// Identifier of Dear ImGui: label and name.
std::string widget_id(const std::string& name) { return widget_label(name) + "###" + name; }

}  // namespace

void Widgets::record(const std::string& name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  if (ImGui::IsItemVisible()) record(name, {low.x, low.y}, {high.x, high.y});
}

void Widgets::record(const std::string& name, const Vec2& low, const Vec2& high) {
  rects_[name.substr(0, name.rfind('='))] = {low, high, frame_};
}

const WidgetRect* Widgets::find(const std::string& name) const {
  const auto at = rects_.find(name);
  return at == rects_.end() || at->second.frame != frame_ ? nullptr : &at->second;
}

std::string Widgets::nearest(const std::string& name) const {
  std::vector<std::string_view> names;
  for (const auto& [each, rect] : rects_)
    if (rect.frame == frame_) names.push_back(each);
  return std::string(nearest_name(name, names).value_or(""));
}

void Widgets::finish(const std::string& name, const char* help) {
  record(name);
  if (help != nullptr) tooltip(help);
}

void Widgets::tooltip(const char* help) {
  if (!ImGui::IsItemHovered()) return;
  // beside the panel, where it covers no widget
  const ImVec2 low = ImGui::GetItemRectMin();
  ImGui::SetNextWindowPos({ImGui::GetWindowPos().x + ImGui::GetWindowWidth() + 8, low.y});
  ImGui::SetTooltip("%s", help);
}

bool contains_text(std::string_view text, std::string_view part) {
  const auto same = [](char a, char b) { return std::tolower(a) == std::tolower(b); };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

bool Widgets::button(const std::string& name, const char* help) {
  const bool pressed = ImGui::Button(widget_id(name).c_str());
  finish(name, help);
  return pressed;
}

bool Widgets::check(const std::string& name, bool& value, const char* help) {
  const bool changed = ImGui::Checkbox(widget_id(name).c_str(), &value);
  finish(name, help);
  return changed;
}

bool Widgets::slider(const std::string& name, double& value, double low, double high,
                     const char* format, bool logarithmic, const char* help, bool bounded) {
  const double before = value;
  bool changed = ImGui::SliderScalar(widget_id(name).c_str(), ImGuiDataType_Double, &value, &low,
                                     &high, format, logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  finish(name, help);
  if (!changed) return false;
  limited_.clear();
  if (!bounded || (value >= low && value <= high)) return true;
  const double typed = value;
  value = std::isnan(typed) ? before : std::clamp(typed, low, high);
  limited_ = fmt::format("{} takes {:.6g} to {:.6g}: {:.6g} was brought to {:.6g}",
                         widget_subject(name), low, high, typed, value);
  return value != before;
}

bool Widgets::drag(const std::string& name, double& value, double step, const char* format,
                   const char* help) {
  const double before = value;
  const bool changed = ImGui::DragScalar(widget_id(name).c_str(), ImGuiDataType_Double, &value,
                                         static_cast<float>(step), nullptr, nullptr, format);
  finish(name, help);
  if (!changed) return false;
  limited_.clear();
  if (std::fabs(value) <= kDragLimit) return true;
  const double typed = value;
  value = std::isnan(typed) ? before : std::clamp(typed, -kDragLimit, kDragLimit);
  limited_ = fmt::format("{} takes {:.6g} to {:.6g}: {:.6g} was brought to {:.6g}",
                         widget_subject(name), -kDragLimit, kDragLimit, typed, value);
  return value != before;
}

bool Widgets::choice(const std::string& name, std::string& value, const char* const* words,
                     std::size_t count, const char* help) {
  bool changed = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string each = name + "/" + words[i];
    const std::string_view entry = words[i];
    const std::string_view word = entry.substr(0, entry.find('='));
    const std::string label = widget_label(each);
    // on the same line while there is room
    const float wide = ImGui::CalcTextSize(label.c_str()).x + ImGui::GetFrameHeight() +
                       2 * ImGui::GetStyle().ItemSpacing.x;
    if (i > 0 && ImGui::GetItemRectMax().x + wide <
                     ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x)
      ImGui::SameLine();
    if (ImGui::RadioButton(widget_id(each).c_str(), value == word) && value != word) {
      value = word;
      changed = true;
    }
    finish(each, help);
  }
  return changed;
}

bool Widgets::text(const std::string& name, std::string& value, const char* hint,
                   const char* help) {
  const bool changed = ImGui::InputTextWithHint(widget_id(name).c_str(), hint, &value);
  finish(name, help);
  return changed;
}

}  // namespace panwright::studio
