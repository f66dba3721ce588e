#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "base/text.h"
#include "studio/image_view.h"
#include "studio/panels.h"

namespace panwright::studio {
namespace {

// Bar of the colours of a layer, with the values of its ends.
void color_legend(const Pixels& scale, bool of_difference) {
  if (scale.low == 0 && scale.high == 0) return;
  const float wide = ImGui::GetContentRegionAvail().x, tall = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps;
    std::uint8_t rgb[3];
    scale_color(share, rgb);
    ImU32 color = IM_COL32(rgb[0], rgb[1], rgb[2], 255);
    if (of_difference) {
      const double far = std::fabs(2 * share - 1);
      const auto mix = [&](int end) {
        return static_cast<int>(std::lround(240 + far * (end - 240)));
      };
      color = share < 0.5 ? IM_COL32(mix(0), mix(114), mix(178), 255)
                          : IM_COL32(mix(213), mix(94), mix(0), 255);
    }
    ImGui::GetWindowDrawList()->AddRectFilled(
        {at.x + wide * static_cast<float>(i) / kSteps, at.y},
        {at.x + wide * static_cast<float>(i + 1) / kSteps + 1, at.y + tall}, color);
  }
  ImGui::Dummy({wide, tall});
  // near is bright
  const bool reversed = scale.unit == "m";
  const std::string right = fmt::format("{:.4g} {}", reversed ? scale.low : scale.high, scale.unit);
  ImGui::TextDisabled("%s%s", fmt::format("{:.4g}", reversed ? scale.high : scale.low).c_str(),
                      scale.logarithmic ? " (logarithmic)" : "");
  ImGui::SameLine(std::max(0.0f, wide - ImGui::CalcTextSize(right.c_str()).x));
  ImGui::TextDisabled("%s", right.c_str());
}

}  // namespace

void ImagePanel::draw() {
  Widgets& widgets = state_.widgets;
  Layout& layout = state_.layout;
  ImageSettings& image = state_.image;
  const bool exact = state_.result && state_.result->exact;
  ImGui::TextUnformatted("Layer");
  const auto of_light = [&] { return layout.layer == "light" || layout.layer == "false colours"; };
  // where a layer and a comparison exclude each other, the last choice counts
  if (widgets.choice("layer", layout.layer, kLayers, std::size(kLayers),
                     "All but light and false colours need the exact image") &&
      (!of_light() || image.comparison == "difference"))
    image.comparison = "off";
  if (layout.layer == "light") {
    widgets.check("layer/mark white=mark saturation", layout.mark_white,
                  "Stripes over pixels that are white in a channel");
    ImGui::SameLine();
    ImGui::TextDisabled("%llu pixels", static_cast<unsigned long long>(state_.histogram.saturated));
  }
  widgets.check("layer/edges of triangles", image.edges,
                "Of the finest level, over the exact image");
  if (!of_light() && state_.result && !exact)
    ImGui::TextDisabled("available once the image is exact");
  if (image.comparison == "off" || !state_.result || !state_.result->reference)
    color_legend(state_.color_scale, false);
  if (layout.layer == "levels") levels_legend();
  ImGui::Separator();
  comparison();
}

// Colours of the levels of detail, with the parts and triangles drawn of each.
void ImagePanel::levels_legend() {
  if (!state_.result || !state_.result->exact) return;
  struct Sum {
    std::uint64_t parts = 0, triangles = 0;
  };
  std::map<int, Sum> sums;
  for (const Detail& each : state_.result->details) {
    if (!each.visible) continue;
    ++sums[std::min(each.level, 6)].parts;
    sums[std::min(each.level, 6)].triangles += each.triangles;
  }
  for (const auto& [level, sum] : sums) {
    std::uint8_t rgb[3];
    level_color(level, rgb);
    const float side = ImGui::GetFontSize();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + side, at.y + side},
                                              IM_COL32(rgb[0], rgb[1], rgb[2], 255));
    ImGui::Dummy({side, side});
    ImGui::SameLine();
    const std::string name =
        level < 0    ? "without levels"
        : level == 0 ? "finest level"
                     : fmt::format("level {}{}", level, level == 6 ? " and coarser" : "");
    ImGui::TextUnformatted(fmt::format("{}: {}, {}", name, counted(sum.parts, "part"),
                                       counted(sum.triangles, "triangle"))
                               .c_str());
  }
}

void ImagePanel::comparison() {
  Widgets& widgets = state_.widgets;
  ImageSettings& image = state_.image;
  ImGui::TextUnformatted("Comparison with the reference renderer");
  if (state_.imager() != nullptr)
    return ImGui::TextDisabled("of radiance: not of the numbers of a detector");
  if (widgets.choice("compare", image.comparison, kComparisons, std::size(kComparisons),
                     "The same view path traced, with more samples while nothing moves") &&
      image.comparison != "off" && state_.layout.layer != "false colours")
    state_.layout.layer = "light";
  if (image.comparison == "off") return;
  widgets.check("compare/light between surfaces", image.interreflections,
                "Three bounces in the reference, none in the preview. Off: direct sunlight only");
  if (image.comparison == "split")
    widgets.slider("compare/at=split position", image.split, 0, 1, "%.3f", false,
                   "Preview on the left, reference on the right; fraction of the width");
  const bool referenced = state_.result && state_.result->reference;
  if (image.comparison == "difference") {
    widgets.slider("compare/range", image.difference_range, 1e-4, 1, "%.3g of the RMS", true,
                   "Difference at the ends of the colours");
    if (referenced) color_legend(state_.color_scale, true);
  }
  if (image.comparison == "flicker" && referenced)
    ImGui::TextUnformatted(flicker_shows_reference() ? "now: reference" : "now: preview");
  comparison_result();
}

void ImagePanel::comparison_result() {
  const RenderResult* result = state_.result.get();
  const bool comparing = state_.renderer.status().comparing;
  if (result == nullptr || !result->reference) {
    ImGui::TextDisabled("%s", result == nullptr || !result->exact
                                  ? "available once the image is exact"
                              : comparing ? "rendering"
                                          : "no reference image: see the messages below the image");
    return;
  }
  const Comparison& c = result->comparison;
  ImGui::TextWrapped("%s",
                     fmt::format("{} samples per pixel, {:.1f} s{}", result->reference_samples,
                                 result->reference_seconds, comparing ? "; refining" : "")
                         .c_str());
  ImGui::TextWrapped(
      "%s", fmt::format("flux difference {:+.3f} %, standard error of the reference {:.3f} %",
                        100 * c.flux, 100 * c.flux_error)
                .c_str());
  ImGui::TextWrapped(
      "%s", fmt::format("RMSE {:.2f} % of the RMS radiance; noise of the reference {:.2f} %",
                        100 * c.rmse, 100 * c.noise)
                .c_str());
}

}  // namespace panwright::studio
