// The tab of the image: which of what is known of its pixels is shown, and how far it is from the reference.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "base/text.h"
#include "studio/window.h"

namespace panwright::studio {
namespace {

// of a flicker, one image
constexpr double kFlickerSeconds = 0.6;

bool shows_reference() { return std::fmod(ImGui::GetTime(), 2 * kFlickerSeconds) >= kFlickerSeconds; }

// The colours from end to end with what they stand for.
void legend(const Pixels& scale, bool of_difference) {
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
      const auto mix = [&](int end) { return static_cast<int>(std::lround(240 + far * (end - 240))); };
      color = share < 0.5 ? IM_COL32(mix(0), mix(114), mix(178), 255) : IM_COL32(mix(213), mix(94), mix(0), 255);
    }
    ImGui::GetWindowDrawList()->AddRectFilled({at.x + wide * static_cast<float>(i) / kSteps, at.y},
                                              {at.x + wide * static_cast<float>(i + 1) / kSteps + 1, at.y + tall}, color);
  }
  ImGui::Dummy({wide, tall});
  // near is bright
  const bool turned = scale.unit == "m";
  const std::string right = fmt::format("{:.4g} {}", turned ? scale.low : scale.high, scale.unit);
  ImGui::TextDisabled("%s%s", fmt::format("{:.4g}", turned ? scale.high : scale.low).c_str(),
                      scale.logarithmic ? " (logarithmic)" : "");
  ImGui::SameLine(std::max(0.0f, wide - ImGui::CalcTextSize(right.c_str()).x));
  ImGui::TextDisabled("%s", right.c_str());
}

}  // namespace

// Colours of levels with what is drawn of each.
void Desk::levels_legend() {
  if (!shown_ || !shown_->exact) return;
  struct Sum {
    std::uint64_t parts = 0, triangles = 0;
  };
  std::map<int, Sum> sums;
  for (const Detail& each : shown_->details) {
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
    ImGui::TextUnformatted(
        fmt::format("{}: {}, {}",
                    level < 0 ? "without levels"
                    : level == 0
                        ? "the finest"
                        : fmt::format("level {}{}", level, level == 6 ? " and beyond" : ""),
                    counted(sum.parts, "part"), counted(sum.triangles, "triangle"))
            .c_str());
  }
}

void Desk::image_tab() {
  ImGui::TextUnformatted("What is shown of each pixel");
  // of a layer and a comparison that do not go together the last one counts
  const auto of_light = [&] { return layer_ == "light" || layer_ == "false colours"; };
  if (widgets_.choice("layer", layer_, kLayers, std::size(kLayers),
                      "All but light and false colours are those of the exact image") &&
      (!of_light() || compare_ == "difference"))
    compare_ = "off";
  if (layer_ == "light") {
    widgets_.check("layer/mark white", mark_white_, "Stripes over pixels at white in a channel");
    ImGui::SameLine();
    ImGui::TextDisabled("%llu pixels", static_cast<unsigned long long>(saturated_));
  }
  widgets_.check("layer/edges of triangles", show_edges_, "Of the finest level, over the exact image");
  if (layer_ != "light" && layer_ != "false colours" && shown_ && !shown_->exact)
    ImGui::TextDisabled("once the image is exact");
  if (compare_ == "off" || !shown_ || !shown_->reference) legend(scale_, false);
  if (layer_ == "levels") levels_legend();
  ImGui::Separator();
  comparison();
}

void Desk::comparison() {
  ImGui::TextUnformatted("Beside the reference renderer");
  if (widgets_.choice("compare", compare_, kComparisons, std::size(kComparisons),
                      "The same view path traced, with ever more samples while nothing moves") &&
      compare_ != "off" && layer_ != "false colours")
    layer_ = "light";
  if (compare_ == "off") return;
  widgets_.check("compare/light between surfaces", bounces_,
                 "Of the reference: three bounces, which the preview does not have; else light straight from the Sun");
  if (compare_ == "split")
    widgets_.slider("compare/at", split_, 0, 1, "%.3f", false,
                    "Left of it the preview, right of it the reference; in parts of the image's width");
  if (compare_ == "difference") {
    widgets_.slider("compare/range", difference_, 1e-4, 1, "%.3g of the RMS", true,
                    "At the ends of the colours");
    if (shown_ && shown_->reference) legend(scale_, true);
  }
  if (compare_ == "flicker" && shown_ && shown_->reference)
    ImGui::TextUnformatted(shows_reference() ? "now: reference" : "now: preview");
  if (!shown_ || !shown_->reference) {
    ImGui::TextDisabled("%s", !shown_ || !shown_->exact           ? "once the image is exact"
                              : artist_.status().comparing ? "under way"
                                                           : "there is none: see the messages below the image");
    return;
  }
  const Comparison& c = shown_->comparison;
  ImGui::TextWrapped("%s", fmt::format("{} samples a pixel, {:.1f} s{}", shown_->reference_samples,
                                       shown_->reference_seconds,
                                       artist_.status().comparing ? "; more are under way" : "")
                               .c_str());
  ImGui::TextWrapped("%s", fmt::format("flux of the preview {:+.3f} % off, the reference's standard error {:.3f} %", 100 * c.flux,
                                       100 * c.flux_error)
                               .c_str());
  ImGui::TextWrapped("%s", fmt::format("RMSE {:.2f} % of the RMS radiance; the reference's own noise {:.2f} %", 100 * c.rmse,
                                       100 * c.noise)
                               .c_str());
}

void Desk::paint_canvas() {
  const DrawnImage& finished = *shown_;
  canvas_.width = finished.image.width;
  canvas_.height = finished.image.height;
  canvas_.smooth = canvas_.width < finished.order.width;
  scale_ = {};
  if (compare_ == "difference" && finished.reference) {
    scale_ = difference_pixels(finished.image, finished.reference->image, finished.comparison.rms,
                               difference_);
    canvas_.rgba = std::move(scale_.rgba);
  } else if (layer_ != "light" &&
             (layer_ == "false colours" || finished.image.has_ground_truth())) {
    scale_ = layer_ == "levels" ? level_pixels(finished.image, finished.details)
                                : layer_pixels(finished.image, layer_);
    canvas_.rgba = std::move(scale_.rgba);
  } else {
    canvas_.rgba = finished.rgba;
  }
  const bool both = (compare_ == "split" || compare_ == "flicker") && finished.reference;
  if (both && (layer_ == "light" || layer_ == "false colours")) {
    const preview::Image& traced = finished.reference->image;
    const std::vector<std::uint8_t> other =
        layer_ == "light" ? shown_pixels(traced, finished.ev) : layer_pixels(traced, layer_).rgba;
    const std::size_t from = compare_ == "flicker" ? (shows_reference() ? 0 : canvas_.width)
                                                   : static_cast<std::size_t>(split_ * canvas_.width);
    for (std::size_t y = 0; y < canvas_.height; ++y) {
      for (std::size_t x = from; x < canvas_.width; ++x)
        std::copy_n(&other[4 * (y * canvas_.width + x)], 4, &canvas_.rgba[4 * (y * canvas_.width + x)]);
      if (compare_ == "split" && from > 0 && from < canvas_.width) {
        std::uint8_t* line = &canvas_.rgba[4 * (y * canvas_.width + from)];
        line[0] = line[1] = line[2] = 160;
      }
    }
  }
  if (finished.edges.size() == finished.image.pixels())
    for (std::size_t i = 0; i < finished.edges.size(); ++i) {
      std::uint8_t* p = &canvas_.rgba[4 * i];
      constexpr std::uint8_t kLine[] = {0, 220, 220};
      for (std::size_t k = 0; k < 3 && finished.edges[i] != 0; ++k)
        p[k] = static_cast<std::uint8_t>((p[k] + kLine[k]) / 2);
    }
  if (mark_white_ && layer_ == "light" && compare_ != "difference") mark_white(canvas_.width, canvas_.rgba);
}

// What the canvas shows, where that is not the light that is saved.
std::string Desk::canvas_words() const {
  if (!shown_ || shown_->rgba.empty()) return "";
  if (compare_ == "difference" && shown_->reference)
    return fmt::format("preview less reference: blue {:.3g} %, orange +{:.3g} % of the RMS radiance", -100 * difference_,
                       100 * difference_);
  std::string words = layer_ == "light" ? "" : layer_;
  if ((compare_ == "split" || compare_ == "flicker") && shown_->reference)
    words += (words.empty() ? "" : ", ") +
             std::string(compare_ == "split" ? "left preview, right reference" : shows_reference() ? "reference" : "preview");
  return words;
}

const Desk::Canvas* Desk::new_canvas() {
  const bool other = take_image();
  if (!shown_ || shown_->rgba.empty()) return nullptr;
  const std::string as =
      fmt::format("{} {} {} {} {} {}", layer_, mark_white_, compare_, split_, difference_,
                  compare_ == "flicker" && shows_reference());
  if (!other && as == shown_as_) return nullptr;
  shown_as_ = as;
  paint_canvas();
  return &canvas_;
}

std::optional<SavedToImage> Desk::saved_to_image() {
  if (models_.saved == measured_ || !shown_ || shown_->order.world != models_.world) return {};
  measured_ = models_.saved;
  if (models_.saved == 0) return {};
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto later =
      std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - models_.saved;
  return SavedToImage{models_.noticed, models_.read, 1e-9 * static_cast<double>(later)};
}

}  // namespace panwright::studio
