#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "studio/panels.h"
#include "studio/play.h"

namespace panwright::studio {

void SunPanel::draw() {
  Widgets& widgets = state_.widgets;
  ViewState& view = state_.view;
  const bool given = view.moment != nullptr;
  if (given) ImGui::TextDisabled("The scenario gives the Sun.");
  ImGui::BeginDisabled(given);
  widgets.slider("sun/azimuth", view.sun_azimuth, -180, 180, "%.3f deg", false,
                 "Direction to the Sun, from +x about +z. Shift + left button over the image");
  widgets.slider("sun/elevation", view.sun_elevation, -90, 90, "%.3f deg");
  widgets.slider("sun/distance", view.sun_distance, 0.05, 50, "%.4g AU", true);
  if (view.camera.frame.empty()) ImGui::TextDisabled("phase angle %.3f deg", view.phase());
  if (widgets.button("sun/behind the camera", "Phase angle 0")) {
    view.sun_azimuth = view.camera.azimuth;
    view.sun_elevation = view.camera.elevation;
  }
  ImGui::EndDisabled();
  ImGui::Separator();
  if (const sensor::Imager* imager = state_.imager())
    detector(*imager);
  else
    exposure();
  histogram();
  ImGui::Separator();
  shadows();
}

void SunPanel::exposure() {
  ViewState& view = state_.view;
  ImGui::TextUnformatted("Exposure");
  double stops = view.auto_ev && state_.result ? state_.result->ev : view.ev;
  if (state_.widgets.check("exposure/auto", view.auto_ev,
                           "Maps 99 % of the lit pixels of the exact image below 0.8 of white"))
    view.ev = stops;
  ImGui::BeginDisabled(view.auto_ev);
  if (state_.widgets.slider("exposure/stops", stops, -12, 20, "%.3f")) view.ev = stops;
  ImGui::EndDisabled();
}

// Exposure time, gain and temperature in place of those of the camera's file, or of the scenario.
void SunPanel::detector(const sensor::Imager& imager) {
  using workspace::Settings;
  Widgets& widgets = state_.widgets;
  Settings& changes = state_.view.detector;
  const sensor::Detector& own = imager.detector;
  const Moment* moment = state_.view.own();
  auto exposure =
      changes.exposure || moment == nullptr ? *changes.exposure : *moment->frame.settings.exposure;
  if (exposure.number == 0.0)
    exposure = imager.auto_exposure ? decltype(exposure)(Settings::Exposure::automatic)
                                    : decltype(exposure)(own.exposure_s);
  ImGui::TextUnformatted("Detector");
  bool automatic = !exposure.number;
  const bool drawn = state_.result && state_.result->imager != nullptr;
  double seconds = exposure.number.value_or(drawn ? state_.result->detected.exposure_s : 1e-3);
  if (widgets.check("detector/auto=automatic exposure", automatic,
                    "99 of 100 lit pixels below 0.8 of the full well and of the largest number")) {
    if (automatic)
      changes.exposure = Settings::Exposure::automatic;
    else
      changes.exposure = seconds;
  }
  ImGui::BeginDisabled(automatic);
  if (widgets.slider("detector/exposure", seconds, std::max(1e-6, 1.001 * own.smear_row_s), 1e3,
                     "%.4g s", true))
    changes.exposure = seconds;
  ImGui::EndDisabled();
  double gain = changes.gain ? *changes.gain : own.dn_per_e;
  if (widgets.slider("detector/gain", gain, 1e-6, 1e4, "%.4g DN/e", true, "Numbers per electron"))
    changes.gain = gain;
  double kelvin = changes.temperature ? *changes.temperature : own.temperature_k;
  if (widgets.slider("detector/temperature", kelvin, 100, 350, "%.1f K", false,
                     "Dark current follows it"))
    changes.temperature = kelvin;
  ImGui::BeginDisabled(!state_.view.changes_detector());
  if (widgets.button("detector/reset=as in the file")) {
    const Settings standard;
    changes.exposure = standard.exposure;
    changes.gain = standard.gain;
    changes.temperature = standard.temperature;
  }
  ImGui::EndDisabled();
  const double dark = own.dark_e_per_s * sensor::dark_ratio(kelvin);
  ImGui::TextDisabled("dark current %.3g e/s, %.3g e in the exposure", dark, dark * seconds);
}

void SunPanel::histogram() {
  const Histogram& histogram = state_.histogram;
  const std::string title =
      fmt::format("{} 0 to {}, log of pixels",
                  state_.imager() != nullptr ? "numbers" : "sRGB codes", histogram.most);
  if (!histogram.bins.empty())
    ImGui::PlotHistogram("##histogram", histogram.bins.data(),
                         static_cast<int>(histogram.bins.size()), 0, title.c_str(), FLT_MAX,
                         FLT_MAX, {ImGui::GetContentRegionAvail().x, 90});
  ImGui::TextDisabled("%llu saturated pixels",
                      static_cast<unsigned long long>(histogram.saturated));
}

void SunPanel::shadows() {
  const auto choice = [&](const char* name, auto& value, std::span<const std::string_view> words) {
    std::vector<const char*> names;
    for (const std::string_view word : words) names.push_back(word.data());
    std::string chosen = names[static_cast<std::size_t>(value)];
    if (state_.widgets.choice(name, chosen, names.data(), names.size()))
      value = static_cast<std::decay_t<decltype(value)>>(std::ranges::find(words, chosen) -
                                                         words.begin());
  };
  ImGui::TextUnformatted("Shadows of the exact image");
  choice("shadows", state_.view.shadows, workspace::kShadowsWords);
  ImGui::TextUnformatted("Imposters of the exact image");
  choice("imposters", state_.view.imposters, workspace::kImpostersWords);
  ImGui::TextUnformatted("Light between surfaces of the exact image");
  choice("indirect", state_.view.indirect, workspace::kIndirectWords);
  if (!state_.result || !state_.result->exact) return;
  if (const auto& between = state_.result->between)
    ImGui::TextDisabled("light between surfaces: %s, about %.2g %% of the flux",
                        between->drawn ? "drawn" : "left out", 100 * between->flux);
  const preview::SamplingReport& report = state_.result->sampling;
  ImGui::TextDisabled("pixel error %.2g %%, flux error %.2g %%", 100 * report.rmse,
                      100 * report.flux);
  ImGui::TextDisabled("shadow edges within %.2g pixels", report.shadow_edge);
  ImGui::TextDisabled("penumbra up to %.2g pixels, %u points of the Sun", report.penumbra,
                      report.sun_points);
  for (const preview::ImposterReport& each : report.imposters)
    ImGui::TextDisabled("imposter of %.3g pixels: %u x %u texels, flux error %.2g %%", each.extent,
                        each.width, each.height, 100 * each.flux_error);
}

}  // namespace panwright::studio
