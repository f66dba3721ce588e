#include "studio/plot.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace panwright::studio {
namespace {

// M. Okabe and K. Ito, on a dark background
constexpr ImU32 kCurveColors[] = {IM_COL32(230, 159, 0, 255), IM_COL32(86, 180, 233, 255),
                                  IM_COL32(0, 190, 140, 255), IM_COL32(220, 220, 220, 255)};

ImU32 curve_color(const Curve& curve) {
  const ImU32 full = kCurveColors[static_cast<std::size_t>(curve.color) % std::size(kCurveColors)];
  return curve.faint ? (full & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 110) : full;
}

std::optional<double> curve_value(const std::vector<Vec2>& points, double x) {
  const auto after = std::lower_bound(points.begin(), points.end(), x,
                                      [](const Vec2& point, double at) { return point.x < at; });
  if (after == points.begin() || after == points.end()) return std::nullopt;
  const Vec2 &a = after[-1], &b = *after;
  return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
}

}  // namespace

void plot(const Axes& axes, const std::vector<Curve>& curves) {
  const float line = ImGui::GetTextLineHeight();
  ImGui::TextUnformatted(axes.title.c_str());
  for (const Curve& curve : curves) {
    if (curve.name.empty()) continue;
    const float wide = ImGui::CalcTextSize(curve.name.c_str()).x + line;
    if (&curve != curves.data() &&
        ImGui::GetItemRectMax().x + wide <
            ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x)
      ImGui::SameLine(0, line);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(curve_color(curve)), "%s",
                       curve.name.c_str());
  }
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::max(ImGui::GetContentRegionAvail().x, 80.0f), 9.5f * line);
  ImGui::InvisibleButton(axes.title.c_str(), size);
  const bool hovered = ImGui::IsItemHovered();
  const float margin = ImGui::CalcTextSize("1e-4 ").x;
  const Vec2 low(at.x + margin, at.y + size.y - 1.3f * line),
      high(at.x + size.x - 0.7f * line, at.y + 4);
  const auto share_of = [&](double y) {
    return axes.logarithmic
               ? std::log(std::max(y, 1e-300) / axes.bottom) / std::log(axes.top / axes.bottom)
               : (y - axes.bottom) / (axes.top - axes.bottom);
  };
  const auto x_of = [&](double x) {
    return static_cast<float>(low.x +
                              (x - axes.left) / (axes.right - axes.left) * (high.x - low.x));
  };
  const auto y_of = [&](double y) {
    return static_cast<float>(low.y + std::clamp(share_of(y), 0.0, 1.0) * (high.y - low.y));
  };
  ImDrawList* list = ImGui::GetWindowDrawList();
  constexpr ImU32 kGrid = IM_COL32(255, 255, 255, 30), kTextColor = IM_COL32(170, 170, 170, 255);
  const auto y_line = [&](double y, const std::string& text) {
    list->AddLine({static_cast<float>(low.x), y_of(y)}, {static_cast<float>(high.x), y_of(y)},
                  kGrid);
    list->AddText({at.x, y_of(y) - 0.5f * line}, kTextColor, text.c_str());
  };
  if (axes.logarithmic)
    for (double e = std::ceil(std::log10(axes.bottom) - 1e-9); e <= std::log10(axes.top) + 1e-9;
         ++e)
      y_line(std::pow(10, e), fmt::format("1e{:.0f}", e));
  else
    for (int k = 0; k <= 4; ++k) {
      const double y = axes.bottom + 0.25 * k * (axes.top - axes.bottom);
      y_line(y, fmt::format("{:.2f}", y));
    }
  for (const double x : axes.x_ticks) {
    list->AddLine({x_of(x), static_cast<float>(low.y)}, {x_of(x), static_cast<float>(high.y)},
                  kGrid);
    const std::string text = fmt::format("{:.3g}", x);
    list->AddText(
        {x_of(x) - 0.5f * ImGui::CalcTextSize(text.c_str()).x, static_cast<float>(low.y) + 2},
        kTextColor, text.c_str());
  }
  std::vector<ImVec2> places;
  for (const Curve& curve : curves) {
    places.clear();
    for (const Vec2& point : *curve.points)
      if (point.x >= axes.left && point.x <= axes.right)
        places.push_back({x_of(point.x), y_of(point.y)});
    list->AddPolyline(places.data(), static_cast<int>(places.size()), curve_color(curve), 0, 1.5f);
  }
  if (!hovered) return;
  const double x = axes.left + (double{ImGui::GetIO().MousePos.x} - low.x) / (high.x - low.x) *
                                   (axes.right - axes.left);
  if (x < axes.left || x > axes.right) return;
  list->AddLine({x_of(x), static_cast<float>(low.y)}, {x_of(x), static_cast<float>(high.y)},
                kTextColor);
  std::string text = fmt::format("{} {:.1f}", axes.x_name, x);
  for (const Curve& curve : curves)
    if (const auto y = curve_value(*curve.points, x); y && !curve.name.empty())
      text += fmt::format("\n{}: {:.4g}", curve.name, *y);
  ImGui::SetTooltip("%s", text.c_str());
}

}  // namespace panwright::studio
