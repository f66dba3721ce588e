// Files of RADARs: docs/radar.md.
#include <cmath>
#include <memory>

#include "instruments/internal/bounded_table.h"
#include "instruments/radar.h"

namespace panwright::instruments {

namespace {

constexpr Code kRadarCode = Code("E0263");
constexpr std::size_t kMostSurfaces = 4096;

constexpr std::string_view kBeamPatterns[] = {"gaussian", "aperture", "uniform"};
constexpr std::string_view kPolarisations[] = {"horizontal", "vertical"};
constexpr std::string_view kLaws[] = {"metal", "lambert", "cosine", "hagfors"};

// Two required numbers, the lower first.
void set_interval(BoundedTable& table, std::string_view name, Vec2& value, double least,
                  double most) {
  const ConfigValue* member = table.require(name);
  if (member == nullptr) return;
  Vec2 given = value;
  table.set_pair(name, given, least, most);
  if (table.ok() && !(given.x < given.y))
    table.fail(*member,
               fmt::format("{} is [{}, {}], expected the lower first", name, given.x, given.y));
  else
    value = given;
}

bool read_signal(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  BoundedTable table(value, "[signal]", kRadarCode, log);
  for (const char* name : {"frequency_hz", "bandwidth_hz", "dwell_s"}) (void)table.require(name);
  table.set("frequency_hz", radar.frequency, 1e6, 1e13);
  table.set("bandwidth_hz", radar.bandwidth, 1, 1e12);
  table.set("dwell_s", radar.dwell, 1e-9, 1e4);
  table.set("power_w", radar.power, 1e-12, 1e9);
  table.set_decibels("loss_db", radar.loss, 0, 100);
  table.choose("polarisation", kPolarisations, radar.vertical);
  table.finish();
  return table.ok();
}

bool read_antenna(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  BoundedTable table(value, "[antenna]", kRadarCode, log);
  table.choose("pattern", kBeamPatterns, radar.pattern);
  (void)table.require("beam_deg");
  table.set_pair("beam_deg", radar.beam, 1e-4, 160, kDegree);
  table.set_decibels("gain_db", radar.gain, -30, 120);
  table.finish();
  return table.ok();
}

bool read_radar_receiver(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  BoundedTable table(value, "[receiver]", kRadarCode, log);
  table.set("temperature_k", radar.temperature, 0, 1e5);
  table.set_decibels("noise_figure_db", radar.noise_figure, 0, 60);
  table.set_count("looks", radar.looks, 1, 1024);
  table.finish();
  return table.ok();
}

bool read_histogram(const ConfigValue& value, Radar& radar, DiagnosticLog& log) {
  BoundedTable table(value, "[histogram]", kRadarCode, log);
  set_interval(table, "range_m", radar.range, 0, 1e10);
  set_interval(table, "speed_m_s", radar.speed, -1e6, 1e6);
  table.set_count("rays", radar.rays, 1, 8192);
  table.set_count("bounces", radar.bounces, 1, 16);
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
  BoundedTable table(member.value, fmt::format("[surfaces.{}]", in_quotes(member.name)), kRadarCode,
                     log);
  RadarSurface surface;
  surface.material = member.name;
  (void)table.require("law");
  table.choose("law", kLaws, surface.law);
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
      table.set_decibels("sigma0_db", surface.level, -100, 60);
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
  BoundedTable table(value, "[surfaces]", kRadarCode, log);
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
  BoundedTable table(value, "[altimeter]", kRadarCode, log);
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
  BoundedTable table(*root, "a RADAR", kRadarCode, log);
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
