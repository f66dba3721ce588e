// Files of LiDARs: docs/lidar.md.
#include <cmath>
#include <memory>

#include "base/number_rows.h"
#include "instruments/internal/bounded_table.h"
#include "instruments/lidar.h"

namespace panwright::instruments {

namespace {

constexpr Code kLidarCode = Code("E0261");
constexpr Code kRowsCode = Code("E0262");

constexpr std::string_view kPatterns[] = {"flash",     "raster",   "spiral",
                                          "lissajous", "rotating", "file"};
constexpr std::string_view kMethods[] = {"threshold", "fraction", "peak", "centroid"};
constexpr std::string_view kChoices[] = {"first", "strongest", "last", "all"};
constexpr std::string_view kBands[] = {"red", "green", "blue"};
constexpr std::string_view kModes[] = {"linear", "photon"};
constexpr double kMostAngle = 180;  // degrees

void read_channels(BoundedTable& table, Scan& scan) {
  const ConfigValue* member = table.require("elevations_deg");
  if (member == nullptr) return;
  const auto* list = std::get_if<ConfigValue::List>(&member->data);
  if (list == nullptr || list->empty() || list->size() > 1024) {
    table.fail(*member, "elevations_deg is not a list of 1 to 1024 angles");
    return;
  }
  for (const ConfigValue& each : *list) {
    const double* angle = std::get_if<double>(&each.data);
    if (angle == nullptr || !(std::fabs(*angle) <= 90)) {
      table.fail(each, "elevations_deg has another member than an angle from -90 to 90");
      return;
    }
    scan.channels.push_back(*angle * kDegree);
  }
}

bool read_table(BoundedTable& table, const std::filesystem::path& folder, Scan& scan,
                DiagnosticLog& log) {
  const ConfigValue* member = table.require("file");
  const auto file = table.text(member, "file");
  if (!file) return false;
  const auto rows = read_number_rows(folder / *file, 3, kRowsCode, log);
  if (!rows) return false;
  for (std::size_t i = 0; i + 2 < rows->size(); i += 3) {
    const Vec3 row((*rows)[i], (*rows)[i + 1] * kDegree, (*rows)[i + 2] * kDegree);
    const bool rises = scan.table.empty() || row.x >= scan.table.back().x;
    if (!rises || !(row.x >= 0) || std::fabs(row.y) > 2 * kPi || std::fabs(row.z) > kPi / 2) {
      table.fail(
          *member,
          fmt::format("row {} of {} is {} s, {} deg, {} deg; expected times that do not "
                      "fall, from 0, azimuths to 360 and elevations to 90 degrees",
                      i / 3 + 1, in_quotes(*file), (*rows)[i], (*rows)[i + 1], (*rows)[i + 2]));
      return false;
    }
    scan.table.push_back(row);
  }
  if (scan.table.empty()) table.fail(*member, in_quotes(*file) + " has no pulses");
  return true;
}

bool read_scan(const ConfigValue& value, const std::filesystem::path& folder, Scan& scan,
               DiagnosticLog& log) {
  BoundedTable table(value, "[scan]", kLidarCode, log);
  if (table.require("pattern") == nullptr) return false;
  table.choose("pattern", kPatterns, scan.pattern);
  const auto pulses = static_cast<std::uint32_t>(kMostPulses);
  bool good = true;
  if (scan.pattern != ScanPattern::flash && scan.pattern != ScanPattern::file)
    table.set("rate_hz", scan.rate_hz, 1e-3, 1e9);
  switch (scan.pattern) {
    case ScanPattern::flash:
      table.set_count("columns", scan.columns, 1, 8192);
      table.set_count("rows", scan.rows, 1, 8192);
      table.set("fov_deg", scan.fov, 1e-4, 170, kDegree);
      break;
    case ScanPattern::raster:
      table.set_count("columns", scan.columns, 1, pulses);
      table.set_count("rows", scan.rows, 1, pulses);
      table.set_pair("azimuth_deg", scan.azimuth, -kMostAngle, kMostAngle, kDegree);
      table.set_pair("elevation_deg", scan.elevation, -90, 90, kDegree);
      table.set_flag("zigzag", scan.zigzag);
      break;
    case ScanPattern::spiral:
      table.set_count("pulses", scan.pulses, 1, pulses);
      table.set("radius_deg", scan.radius, 0, 90, kDegree);
      table.set("turns", scan.turns, 0, 1e6);
      break;
    case ScanPattern::lissajous:
      table.set_count("pulses", scan.pulses, 1, pulses);
      table.set_pair("amplitude_deg", scan.amplitude, 0, 90, kDegree);
      table.set_pair("frequency_hz", scan.frequency_hz, 0, 1e9, 1);
      table.set("phase_deg", scan.phase, -360, 360, kDegree);
      break;
    case ScanPattern::rotating:
      scan.azimuth = Vec2(-kPi, kPi);
      table.set_count("columns", scan.columns, 1, pulses);
      table.set_pair("azimuth_deg", scan.azimuth, -360, 360, kDegree);
      read_channels(table, scan);
      break;
    case ScanPattern::file:
      good = read_table(table, folder, scan, log);
      break;
  }
  const bool grid = scan.pattern == ScanPattern::flash || scan.pattern == ScanPattern::raster;
  const std::size_t rows = grid ? scan.rows : std::max<std::size_t>(scan.channels.size(), 1);
  if (good && std::size_t{scan.columns} * rows > kMostPulses)
    table.fail(value, fmt::format("the scan has {} pulses, expected at most {}",
                                  std::size_t{scan.columns} * rows, kMostPulses));
  if (table.ok()) table.finish();
  return good && table.ok();
}

bool read_beam(const ConfigValue& value, Lidar& lidar, DiagnosticLog& log) {
  BoundedTable table(value, "[beam]", kLidarCode, log);
  table.set("wavelength_nm", lidar.wavelength, 200, 20000, 1e-9);
  table.set("pulse_energy_j", lidar.pulse_energy, 1e-15, 1e3);
  table.set("eye_safe_energy_j", lidar.eye_safe_energy, 1e-15, 1e3);
  table.set("pulse_ns", lidar.pulse_fwhm, 1e-3, 1e6, 1e-9);
  if (lidar.scan.pattern != ScanPattern::flash)
    table.set("divergence_mrad", lidar.divergence, 0, 200, 1e-3);
  table.set_count("sub_rays", lidar.sub_rays, 1, 1024);
  table.choose("band", kBands, lidar.band);
  table.finish();
  return table.ok();
}

bool read_receiver(const ConfigValue& value, Lidar& lidar, DiagnosticLog& log) {
  BoundedTable table(value, "[receiver]", kLidarCode, log);
  int mode = lidar.photon_counting ? 1 : 0;
  table.choose("mode", kModes, mode);
  lidar.photon_counting = mode == 1;
  table.set("aperture_mm", lidar.aperture, 0.1, 1e4, 1e-3);
  table.set("efficiency", lidar.efficiency, 1e-6, 1);
  table.set("quantum_efficiency", lidar.quantum_efficiency, 1e-6, 1);
  if (lidar.scan.pattern != ScanPattern::flash) table.set("field_mrad", lidar.field, 0, 1000, 1e-3);
  table.set("filter_nm", lidar.filter_nm, 0, 1000);
  table.set("response_ns", lidar.response_fwhm, 0, 1e6, 1e-9);
  table.set("sample_ns", lidar.sample, 1e-4, 1e6, 1e-9);
  table.set("saturation_e", lidar.saturation_e, 0, 1e15);
  table.set("recovery_m", lidar.recovery, 0, 1e6);
  if (lidar.scan.pattern == ScanPattern::flash) {
    table.set_count("bloom_pixels", lidar.bloom_pixels, 0, 32);
    table.set("bloom_share", lidar.bloom_share, 0, 1);
  }
  const double fwhm =
      std::sqrt(lidar.pulse_fwhm * lidar.pulse_fwhm + lidar.response_fwhm * lidar.response_fwhm);
  if (lidar.sample > 0 && lidar.sample < fwhm / 1000)
    table.fail(value, "sample_ns is below a thousandth of the pulse's width");
  if (lidar.sample > fwhm)
    table.fail(value, "sample_ns is above the pulse's width: echoes would fall between samples");
  table.finish();
  return table.ok();
}

bool read_noise(const ConfigValue& value, Lidar& lidar, DiagnosticLog& log) {
  BoundedTable table(value, "[noise]", kLidarCode, log);
  table.set("electronics_e", lidar.electronics_e, 0, 1e12);
  table.set("excess_noise", lidar.excess_noise, 0, 1e4);
  table.set("dark_e_per_s", lidar.dark_e_per_s, 0, 1e15);
  table.set_flag("sun", lidar.sun);
  table.set("sun_w_m2_nm", lidar.sun_w_m2_nm, 0, 100);
  table.set("jitter_mm", lidar.jitter, 0, 1e6, 1e-3);
  table.set("drop_outs", lidar.drop_outs, 0, 1);
  table.finish();
  return table.ok();
}

bool read_detection(const ConfigValue& value, Lidar& lidar, DiagnosticLog& log) {
  BoundedTable table(value, "[detection]", kLidarCode, log);
  table.choose("method", kMethods, lidar.method);
  table.set("threshold_e", lidar.threshold_e, 1e-6, 1e15);
  table.choose("echoes", kChoices, lidar.echoes);
  table.set_count("max_echoes", lidar.max_echoes, 1, 16);
  table.set_pair("gate_m", lidar.gate, 0, 1e9, 1);
  if (!(lidar.gate.x < lidar.gate.y))
    table.fail(value, "gate_m has no length, expected [nearest, farthest]");
  table.set("walk_reference", lidar.walk_reference, 1, 1e9);
  table.set("walk_residual", lidar.walk_residual, 0, 1);
  table.set("bias_mm", lidar.bias, -1e6, 1e6, 1e-3);
  table.set("resolution_mm", lidar.resolution, 0, 1e6, 1e-3);
  table.finish();
  return table.ok();
}

}  // namespace

Result<Lidar> read_lidar(std::string_view text, const std::string& name,
                         const std::filesystem::path& folder, DiagnosticLog& log) {
  SourceFile source;
  source.name = name;
  source.bytes = std::make_shared<const std::string>(text);
  const FileId file = log.sources().add(std::move(source));
  const auto root = parse_config(text, ConfigFormat::toml, file, kLidarCode, log);
  if (!root) return failed;
  BoundedTable table(*root, "a LiDAR", kLidarCode, log);
  Lidar lidar;
  lidar.name = table.text("name").value_or("");
  const ConfigValue* scan = table.require("scan");
  if (scan == nullptr) return failed;
  bool good = read_scan(*scan, folder, lidar.scan, log);
  const auto part = [&](const char* member, auto read) {
    if (const ConfigValue* value = table.find(member)) good = read(*value, lidar, log) && good;
  };
  part("beam", read_beam);
  part("receiver", read_receiver);
  part("noise", read_noise);
  part("detection", read_detection);
  table.finish();
  if (!good || !table.ok()) return failed;
  return lidar;
}

}  // namespace panwright::instruments
