#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/text.h"
#include "light/body.h"
#include "studio/panels.h"
#include "workspace/lamp_text.h"
#include "workspace/quantities.h"

namespace panwright::studio {
namespace {

using workspace::SettingId;

constexpr double kFaintest = 9;                      // end of the slider; Hipparcos reaches 8
constexpr double kFarthestBody = 1e6;                // thousand kilometres
constexpr double kMegametre = 1e6;                   // a thousand kilometres
constexpr double kEarthAt = 6778e3;                  // 400 km above the ground
constexpr double kMoonAt = 384400e3;                 // metres
constexpr double kDimmest = 1e-3, kBrightest = 1e5;  // W/sr

// The text of a planet: its centre, and what follows it.
struct PlacedBody {
  Vec3 centre{0};
  std::string more;  // a quaternion, radius=, albedo=, law=, map=
};

std::optional<PlacedBody> placed_body(const std::string& text) {
  const std::vector<std::string_view> words = workspace::words_of(text);
  if (words.size() < 3) return std::nullopt;
  PlacedBody out;
  for (int k = 0; k < 3; ++k) {
    const auto length = workspace::parse_length(words[static_cast<std::size_t>(k)]);
    if (!length || !std::isfinite(*length)) return std::nullopt;
    out.centre[k] = *length;
  }
  const char* const end = words[2].data() + words[2].size();
  out.more = text.substr(static_cast<std::size_t>(end - text.data()));
  out.more.erase(0, std::min(out.more.find_first_not_of(' '), out.more.size()));
  return out;
}

std::string text_of(const PlacedBody& body) {
  const Vec3& p = body.centre;
  const std::string place = fmt::format("{:.9g} {:.9g} {:.9g}", p.x, p.y, p.z);
  return body.more.empty() ? place : place + " " + body.more;
}

std::string* entry_of(std::vector<std::pair<std::string, std::string>>& planets,
                      const std::string& name) {
  const auto at = std::ranges::find(planets, name, &std::pair<std::string, std::string>::first);
  return at == planets.end() ? nullptr : &at->second;
}

bool has_word(const std::string& words, std::string_view word) {
  const auto all = workspace::words_of(words);
  return std::ranges::find(all, word) != all.end();
}

std::string with_word(const std::string& words, std::string_view word, bool there) {
  std::string out;
  for (const std::string_view each : workspace::words_of(words))
    if (each != word) out += (out.empty() ? "" : " ") + std::string(each);
  if (there) out += (out.empty() ? "" : " ") + std::string(word);
  return out;
}

Vec3 intensity_of(const light::Source& source) {
  return std::visit(
      [](const auto& one) {
        if constexpr (requires { one.intensity; })
          return one.intensity;
        else
          return Vec3(0);
      },
      source);
}

std::string bands_text(const Vec3& v) {
  return v.x == v.y && v.y == v.z ? fmt::format("{:.9g}", v.x)
                                  : fmt::format("{:.9g} {:.9g} {:.9g}", v.x, v.y, v.z);
}

}  // namespace

workspace::Settings SkyPanel::effective() {
  DiagnosticLog ignored;
  const workspace::Settings* scene =
      state_.models.world ? state_.scene.read(*state_.models.world, ignored) : nullptr;
  const workspace::Settings& own = state_.view.sky.settings;
  return scene == nullptr ? own : workspace::with_defaults(own, *scene);
}

void SkyPanel::draw() {
  const bool given = state_.view.own() != nullptr;
  if (given) ImGui::TextDisabled("The scenario gives the sky and the lamps.");
  ImGui::BeginDisabled(given);
  const workspace::Settings now = effective();
  sun_and_stars(now);
  ImGui::Separator();
  ImGui::TextUnformatted("Planets and moons");
  std::vector<std::string> names = {"earth", "moon"};
  for (const auto& [name, text] : *now.planet)
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  for (const std::string& name : names) planet(name, now);
  ImGui::Separator();
  lamps();
  ImGui::EndDisabled();
}

void SkyPanel::sun_and_stars(const workspace::Settings& now) {
  Widgets& widgets = state_.widgets;
  workspace::Settings& own = state_.view.sky.settings;
  bool disc = has_word(*now.sky, "sun");
  if (widgets.check("sky/the Sun's disc", disc, "Drawn where it is in view"))
    own.sky = with_word(*now.sky, "sun", disc);
  bool light = !now.sun_irradiance || max_component(*now.sun_irradiance) > 0;
  if (widgets.check("sky/sunlight", light, "Off: an irradiance of 0, for lamps alone")) {
    own.sun_irradiance = workspace::Settings().sun_irradiance;
    const bool dark = effective().sun_irradiance && max_component(*effective().sun_irradiance) == 0;
    if (!light)
      own.sun_irradiance = Vec3(0);
    else if (dark)
      own.sun_irradiance = light::kSolarIrradiance;
  }
  bool stars = now.stars->number.has_value();
  double faintest = now.stars->number.value_or(6);
  const bool switched = widgets.check("sky/stars", stars, "Of Hipparcos, behind the targets");
  ImGui::BeginDisabled(!stars);
  const bool moved = widgets.slider("sky/down to magnitude", faintest, -1, kFaintest, "V %.2f");
  ImGui::EndDisabled();
  if (switched || moved) {
    if (stars)
      own.stars = workspace::NumberOr<workspace::Settings::Stars, double>(
          std::stod(fmt::format("{:.9g}", faintest)));
    else
      own.stars = workspace::Settings::Stars::off;
  }
  std::string date = *now.date;
  if (widgets.text("sky/date", date, "2026-01-01T12:00:00", "UTC; stars move to it")) {
    own.date = workspace::Settings().date;
    if (!date.empty()) own.date = date;
  }
}

void SkyPanel::planet(const std::string& name, const workspace::Settings& now) {
  Widgets& widgets = state_.widgets;
  auto planets = *state_.view.sky.settings.planet;
  const auto set = [&](const std::string& text) {
    if (std::string* const known = entry_of(planets, name))
      *known = text;
    else
      planets.emplace_back(name, text);
    state_.view.sky.settings.planet = planets;
  };
  auto all = *now.planet;
  const std::string* const text = entry_of(all, name);
  auto body = text != nullptr ? placed_body(*text) : std::nullopt;
  bool shown = text != nullptr && *text != "off";
  if (widgets.check("planet/" + name, shown)) {
    if (!shown) {
      set("off");
      return;
    }
    // the Earth below, others behind what is looked at
    body = PlacedBody{
        name == "earth" ? Vec3(0, 0, -kEarthAt) : -kMoonAt * state_.view.camera.direction(),
        light::body_preset(name) ? "" : "radius=1000km"};
    set(text_of(*body));
  }
  if (!shown) return;
  if (!body) {
    ImGui::TextDisabled("%s", text->c_str());
    return;
  }
  ImGui::PushID(name.c_str());
  ImGui::Indent();
  const std::string path = "planet/" + name + "/";
  double distance = glm::length(body->centre) / kMegametre;
  const Vec3 toward = distance > 0 ? body->centre / (distance * kMegametre) : Vec3(0, 0, -1);
  double azimuth = std::atan2(toward.y, toward.x) / kDegree,
         elevation = std::atan2(toward.z, std::hypot(toward.x, toward.y)) / kDegree;
  bool moved = widgets.slider(path + "distance", distance, 1e-3, kFarthestBody, "%.7g Mm", true,
                              "Of its centre from the origin, in thousands of kilometres");
  moved |= widgets.slider(path + "azimuth", azimuth, -180, 180, "%.3f deg");
  moved |= widgets.slider(path + "elevation", elevation, -90, 90, "%.3f deg");
  if (moved) body->centre = distance * kMegametre * direction_of(azimuth, elevation);
  moved |= widgets.text(path + "more", body->more, "albedo=0.3 map=FILE.png",
                        "Quaternion, radius=, albedo=, law= and last map= (docs/sky.md)");
  if (moved) set(text_of(*body));
  ImGui::Unindent();
  ImGui::PopID();
}

void SkyPanel::lamps() {
  Widgets& widgets = state_.widgets;
  auto& camera = state_.view.sky.camera_lamp;
  bool on = camera.has_value();
  if (widgets.check("lamp/at the camera", on, "A spot of 30 degrees beside the boresight"))
    camera = on ? std::optional(1.0) : std::nullopt;
  if (camera) {
    double intensity = *camera;
    if (widgets.slider("intensity/at the camera=intensity", intensity, kDimmest, kBrightest, "%.4g",
                       true, "W/sr, or parts of the Sun's irradiance at 1 m"))
      camera = std::stod(fmt::format("{:.9g}", intensity));
  }
  if (!state_.models.world) return;
  const auto all = state_.models.world->lamps();
  if (all.empty()) {
    ImGui::TextDisabled("The models have no lamps of their own.");
    return;
  }
  const bool every_on = widgets.button("lamps/all on");
  ImGui::SameLine();
  const bool every_off = widgets.button("lamps/all off");
  for (const world::Lamp& lamp : all) lamp_row(lamp, every_on, every_off);
}

void SkyPanel::lamp_row(const world::Lamp& original, bool every_on, bool every_off) {
  Widgets& widgets = state_.widgets;
  auto& changes = state_.view.sky.lamps;
  const std::string path = workspace::lamp_path(original);
  std::vector<world::Lamp> one{original};
  if (const auto at = changes.find(path); at != changes.end()) {
    DiagnosticLog ignored;
    workspace::set_lamp(path + " " + at->second, *state_.models.world, one, ignored);
  }
  bool on = one[0].on;
  const Vec3 standard = intensity_of(original.source);
  const double brightest = max_component(standard);
  double intensity = max_component(intensity_of(one[0].source));
  ImGui::PushID(path.c_str());
  bool changed = widgets.check("lamp/" + path + "=" + path, on) || every_on || every_off;
  if (every_on || every_off) on = every_on;
  if (on)
    changed |= widgets.slider("intensity/" + path + "=intensity", intensity, kDimmest, kBrightest,
                              "%.4g", true, "On the axis, of its brightest band");
  ImGui::PopID();
  if (!changed) return;
  const Vec3 bands = brightest > 0 ? standard * (intensity / brightest) : Vec3(intensity);
  if (!on)
    changes[path] = "off";
  else if (intensity != brightest)
    changes[path] = "intensity " + bands_text(bands);
  else
    changes[path] = "on";
  if (on == original.on && (!on || intensity == brightest)) changes.erase(path);
}

}  // namespace panwright::studio
