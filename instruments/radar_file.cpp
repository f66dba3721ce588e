// Files of RADARs: docs/radar.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "base/config_text.h"
#include "base/text.h"
#include "instruments/radar.h"

namespace panwright::instruments {

namespace {

constexpr Code kRadarCode = Code("E0263");
constexpr std::size_t kMostSurfaces = 4096;

constexpr std::string_view kBeamPatterns[] = {"gaussian", "aperture", "uniform"};
constexpr std::string_view kPolarisations[] = {"horizontal", "vertical"};
constexpr std::string_view kLaws[] = {"metal", "lambert", "cosine", "hagfors"};

// Numbers of one table within bounds.
class RadarTable : public ConfigTable {
 public:
  RadarTable(const ConfigValue& value, std::string_view what, DiagnosticLog& log)
      : ConfigTable(value, what, kRadarCode, log) {}

  // Sets a number, in units of `unit`. Bounds: those of the file, both included.
  bool set(std::string_view name, double& value, double least, double most, double unit = 1) {
    const ConfigValue* member = find(name);
    const auto given = number(member, name);
    if (!given) return false;
    if (*given >= least && *given <= most) {
      value = *given * unit;
      return true;
    }
    fail(*member, fmt::format("{} is {}, expected {} to {}", name, *given, least, most));
    return false;
  }

  void decibels(std::string_view name, double& value, double least, double most) {
    double level = 0;
    if (set(name, level, least, most)) value = det::pow(10, level / 10);
  }

  void whole(std::string_view name, std::uint32_t& value, std::uint32_t least, std::uint32_t most) {
    double number = value;
    if (!set(name, number, least, most)) return;
    if (number == std::floor(number))
      value = static_cast<std::uint32_t>(number);
    else
      fail(*find(name), fmt::format("{} is {}, expected a whole number", name, number));
  }

  // Two numbers; rising: the second above the first.
  void pair(std::string_view name, Vec2& value, double least, double most, bool rising) {
    const ConfigValue* member = require(name);
    const auto given = numbers(member, name, {2});
    if (!given) return;
    const Vec2 pair((*given)[0], (*given)[1]);
    if (!(pair.x >= least && pair.x <= most && pair.y >= least && pair.y <= most))
      fail(*member,
           fmt::format("{} is [{}, {}], expected {} to {}", name, pair.x, pair.y, least, most));
    else if (rising && !(pair.x < pair.y))
      fail(*member, fmt::format("{} is [{}, {}], expected the lower first", name, pair.x, pair.y));
    else
      value = pair;
  }

  // Returns the number of the chosen word.
  std::optional<std::size_t> word(std::string_view name, std::span<const std::string_view> words) {
    const ConfigValue* member = find(name);
    const auto given = text(member, name);
    if (!given) return std::nullopt;
    const auto at = std::ranges::find(words, *given);
    if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
    const auto near = nearest_name(*given, words);
    fail(*member,
         fmt::format("{} is {}, expected {}", name, in_quotes(*given), fmt::join(words, ", ")),
         near ? fmt::format("did you mean '{}'?", *near) : "");
    return std::nullopt;
  }
};

bool read_signal(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[signal]", log);
  for (const char* name : {"frequency_hz", "bandwidth_hz", "dwell_s"}) (void)table.require(name);
  table.set("frequency_hz", radar.frequency, 1e6, 1e13);
  table.set("bandwidth_hz", radar.bandwidth, 1, 1e12);
  table.set("dwell_s", radar.dwell, 1e-9, 1e4);
  table.set("power_w", radar.power, 1e-12, 1e9);
  table.decibels("loss_db", radar.loss, 0, 100);
  if (const auto chosen = table.word("polarisation", kPolarisations)) radar.vertical = *chosen == 1;
  table.finish();
  return table.ok();
}

bool read_antenna(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[antenna]", log);
  if (const auto chosen = table.word("pattern", kBeamPatterns))
    radar.pattern = static_cast<BeamPattern>(*chosen);
  Vec2 degrees(0);
  table.pair("beam_deg", degrees, 1e-4, 160, false);
  radar.beam = kDegree * degrees;
  table.decibels("gain_db", radar.gain, -30, 120);
  table.finish();
  return table.ok();
}

bool read_radar_receiver(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[receiver]", log);
  table.set("temperature_k", radar.temperature, 0, 1e5);
  table.decibels("noise_figure_db", radar.noise_figure, 0, 60);
  table.whole("looks", radar.looks, 1, 1024);
  table.finish();
  return table.ok();
}

bool read_histogram(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[histogram]", log);
  table.pair("range_m", radar.range, 0, 1e10, true);
  table.pair("speed_m_s", radar.speed, -1e6, 1e6, true);
  table.whole("rays", radar.rays, 1, 8192);
  table.whole("bounces", radar.bounces, 1, 16);
  if (table.ok()) {
    const double cells = std::ceil((radar.range.y - radar.range.x) / radar.range_step()) *
                         std::ceil((radar.speed.y - radar.speed.x) / radar.speed_step());
    if (!(cells <= kMostRadarCells))
      table.fail(
          value,
          fmt::format(
              "the histogram has {:.0f} cells of {:.3g} m and {:.3g} m/s, expected at most {}",
              cells, radar.range_step(), radar.speed_step(), kMostRadarCells),
          "a smaller range_m or speed_m_s, bandwidth_hz or dwell_s");
  }
  table.finish();
  return table.ok();
}

bool read_surface(const ConfigMember& member, Radar& radar, DiagnosticLog& log) {
  RadarTable table(member.value, fmt::format("[surfaces.{}]", in_quotes(member.name)), log);
  RadarSurface surface;
  surface.material = member.name;
  (void)table.require("law");
  if (const auto chosen = table.word("law", kLaws)) surface.law = static_cast<ScatterLaw>(*chosen);
  switch (surface.law) {
    case ScatterLaw::metal:
      surface.level = 1;
      table.set("reflectance", surface.level, 1e-6, 1);
      break;
    case ScatterLaw::lambert:
      (void)table.require("albedo");
      table.set("albedo", surface.level, 1e-9, 1);
      break;
    case ScatterLaw::cosine:
      (void)table.require("sigma0_db");
      table.decibels("sigma0_db", surface.level, -100, 60);
      table.set("exponent", surface.exponent, 0, 1000);
      break;
    case ScatterLaw::hagfors: {
      (void)table.require("reflectance");
      (void)table.require("slope_deg");
      table.set("reflectance", surface.level, 1e-6, 1);
      double degrees = 6;
      table.set("slope_deg", degrees, 0.1, 60);
      surface.slope = det::sin(degrees * kDegree) / det::cos(degrees * kDegree);
      break;
    }
  }
  table.finish();
  if (table.ok()) radar.surfaces.push_back(std::move(surface));
  return table.ok();
}

bool read_surfaces(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[surfaces]", log);
  const auto* map = std::get_if<ConfigValue::Map>(&value.data);
  if (map == nullptr || map->size() > kMostSurfaces) {
    table.fail(value, fmt::format("surfaces are not at most {} tables by material", kMostSurfaces));
    return false;
  }
  bool good = true;
  for (const ConfigMember& each : *map) good = read_surface(each, radar, log) && good;
  return good;
}

bool read_altimeter(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  RadarTable table(value, "[altimeter]", log);
  radar.altimeter = 0.5;
  table.set("threshold", radar.altimeter, 0.01, 0.99);
  table.finish();
  return table.ok();
}

}  // namespace

Result<Radar> read_radar(std::string_view text, const std::string& name, DiagnosticLog& log) {
  SourceFile source;
  source.name = name;
  source.bytes = std::make_shared<const std::string>(text);
  const FileId file = log.sources().add(std::move(source));
  const auto root = parse_config(text, ConfigFormat::toml, file, kRadarCode, log);
  if (!root) return failed;
  RadarTable table(*root, "a RADAR", log);
  Radar radar;
  radar.name = table.text("name").value_or("");
  bool good = true;
  const auto part = [&](const char* member, bool required, auto read) {
    const ConfigValue* value = required ? table.require(member) : table.find(member);
    if (value != nullptr) good = read(*value, radar, log) && good;
  };
  part("signal", true, read_signal);
  part("antenna", true, read_antenna);
  part("receiver", false, read_radar_receiver);
  if (good)
    part("histogram", true, read_histogram);
  else
    (void)table.find("histogram");
  part("surfaces", false, read_surfaces);
  part("altimeter", false, read_altimeter);
  table.finish();
  if (!good || !table.ok()) return failed;
  return radar;
}

}  // namespace panwright::instruments
