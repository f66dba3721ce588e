#include "studio/material_curves.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "studio/plot.h"

namespace panwright::studio {
namespace {

// Pixels of a sample in the panel, the same with and without a scroll bar.
std::uint32_t sample_width() {
  const ImGuiStyle& style = ImGui::GetStyle();
  return static_cast<std::uint32_t>(std::max(
      96.0f,
      std::floor(ImGui::GetWindowWidth() - style.ScrollbarSize - 2 * style.WindowPadding.x)));
}

}  // namespace

void SampleView::request_preset(const std::string& name) {
  const std::string key = fmt::format("preset {}", name);
  if (name.empty() || key == requested_) return;
  DiagnosticLog log;
  auto described = pxn::preset(name, log);
  if (described) {
    provenance_ = described->provenance;
    samples_.request(*std::move(described), sample_width());
  }
  requested_ = key;
}

void SampleView::request_material(const std::string& name) {
  const std::string key = fmt::format("material {} {}", name, state_.models.readings);
  if (name.empty() || key == requested_) return;
  const auto& world = state_.models.world;
  for (std::size_t i = 0; world && i < world->size(); ++i) {
    const pan::Model& model = *(*world)[i].model();
    for (std::size_t k = 0; k < model.materials().size(); ++k)
      if (model.material_name(k) == name) {
        pxn::DescribedMaterial described;
        described.material = pan::material_from(model.materials()[k], name);
        described.material.maps = {};
        samples_.request(std::move(described), sample_width());
        requested_ = key;
        return;
      }
  }
}

void SampleView::draw() {
  const auto& last = samples_.last();
  if (!last) {
    ImGui::TextDisabled("%s", samples_.busy() ? "computing" : "select a material");
    return;
  }
  const MaterialSample& sample = *last;
  ImGui::Text("%s%s", sample.name.c_str(), samples_.busy() ? " (computing the next one)" : "");
  hold_buttons(sample);
  if (texture_ != 0)
    ImGui::Image(reinterpret_cast<ImTextureID>(texture_),
                 {static_cast<float>(canvas_.width), static_cast<float>(canvas_.height)});
  state_.widgets.record("curves/image");
  state_.widgets.tooltip(
      "A sphere, a tilted tile and a wrinkled tile under the Sun, path traced, without maps");
  ImGui::TextWrapped("%s. %s", sample.description.c_str(), sample.verdict.c_str());
  ImGui::TextDisabled("hemispherical albedo %.3f %.3f %.3f", sample.hemispherical[0],
                      sample.hemispherical[1], sample.hemispherical[2]);
  plots(sample);
}

void SampleView::hold_buttons(const MaterialSample& sample) {
  if (state_.widgets.button("curves/hold", "Keep this sample beside the next one")) {
    held_ = sample;
    changed_ = true;
  }
  if (!held_) return;
  ImGui::SameLine();
  if (state_.widgets.button("curves/let go=release")) {
    held_.reset();
    changed_ = true;
  } else {
    ImGui::SameLine();
    ImGui::TextDisabled("held (faint, below): %s", held_->name.c_str());
  }
}

void SampleView::plots(const MaterialSample& sample) {
  double peak = 1e-6, largest = 1;
  std::vector<Curve> lobes, albedos;
  std::vector<const MaterialSample*> samples{&sample};
  if (held_) samples.insert(samples.begin(), &*held_);
  for (const MaterialSample* each : samples) {
    const bool faint = each != &sample;
    for (std::size_t i = 0; i < kSampleLights.size(); ++i) {
      for (const Vec2& point : each->lobes[i]) peak = std::max(peak, point.y);
      lobes.push_back({faint ? "" : fmt::format("light {} deg", kSampleLights[i]), &each->lobes[i],
                       static_cast<int>(i), faint});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (const Vec2& point : each->albedo[k]) largest = std::max(largest, point.y);
      constexpr const char* kChannels[] = {"650 nm", "550 nm", "450 nm"};
      constexpr int kColors[] = {0, 2, 1};
      albedos.push_back({faint ? "" : kChannels[k], &each->albedo[k], kColors[k], faint});
    }
  }
  const double top = std::pow(10, std::ceil(std::log10(peak)));
  plot({.title = "pi f in the plane of incidence",
        .x_name = "viewing angle, degrees",
        .left = -90,
        .right = 90,
        .x_ticks = {-90, -60, -30, 0, 30, 60, 90},
        .bottom = top * 1e-5,
        .top = top,
        .logarithmic = true},
       lobes);
  state_.widgets.record("curves/lobes");
  plot({.title = "directional albedo",
        .x_name = "angle from the normal, degrees",
        .left = 0,
        .right = 90,
        .x_ticks = {0, 15, 30, 45, 60, 75, 90},
        .bottom = 0,
        .top = largest > 1 ? 1.25 * largest : 1},
       albedos);
  state_.widgets.record("curves/albedo");
}

const Canvas* SampleView::new_canvas() {
  if (samples_.poll()) changed_ = true;
  if (!changed_ || !samples_.last() || samples_.last()->rgba.empty()) return nullptr;
  changed_ = false;
  const MaterialSample& sample = *samples_.last();
  canvas_ = {sample.width, sample.height, sample.rgba};
  if (held_ && held_->width == sample.width) {
    canvas_.height += held_->height;
    canvas_.rgba.insert(canvas_.rgba.end(), held_->rgba.begin(), held_->rgba.end());
  }
  return &canvas_;
}

void FoilSlopesView::update(const std::string& name) {
  const std::string key = fmt::format("{} {}", name, state_.models.readings);
  const auto& world = state_.models.world;
  if (key == computed_for_ || !world) return;
  computed_for_ = key;
  slopes_ = {};
  for (std::size_t i = 0; i < world->size(); ++i) {
    SheetSlopes each = slopes_of(*(*world)[i].model(), name);
    if (slopes_.sheets.empty()) slopes_ = std::move(each);
  }
}

void FoilSlopesView::draw(const std::string& name) {
  update(name);
  if (slopes_.sheets.empty()) {
    ImGui::TextWrapped("No node of that name has a sheet.");
    return;
  }
  for (const std::string& sheet : slopes_.sheets) ImGui::TextWrapped("%s", sheet.c_str());
  if (slopes_.density[0].empty()) {
    ImGui::TextDisabled("slopes are measured on flat sheets only");
    return;
  }
  std::vector<Vec2> gaussian;
  double largest = 0;
  for (const Vec2& point : slopes_.density[0]) {
    const double t = point.x / slopes_.rms;
    gaussian.emplace_back(point.x, std::exp(-0.5 * t * t) / (slopes_.rms * std::sqrt(2 * kPi)));
    largest = std::max({largest, point.y, gaussian.back().y});
  }
  const double reach = slopes_.density[0].back().x;
  plot({.title = "slopes",
        .x_name = "slope",
        .left = -reach,
        .right = reach,
        .x_ticks = {-0.5 * reach, 0, 0.5 * reach},
        .bottom = 1e-3 * largest,
        .top = 1.1 * largest,
        .logarithmic = true},
       {{"along x", &slopes_.density[0], 0, false},
        {"along y", &slopes_.density[1], 1, false},
        {"Gaussian of the same RMS", &gaussian, 3, true}});
  state_.widgets.record("curves/slopes");
}

}  // namespace panwright::studio
