// Patterns of scans.
#include <algorithm>
#include <cmath>

#include "instruments/lidar.h"

namespace panwright::instruments {

namespace {

Vec3 direction_of(double azimuth, double elevation) {
  const auto a = det::sincos(azimuth), e = det::sincos(elevation);
  return {e.cos * a.sin, -e.sin, e.cos * a.cos};
}

// Of k of n even steps from the first to the last, both included.
double between(const Vec2& ends, std::uint32_t k, std::uint32_t n) {
  return n < 2 ? 0.5 * (ends.x + ends.y) : ends.x + (ends.y - ends.x) * k / (n - 1);
}

std::vector<Pulse> flash(const Scan& scan) {
  std::vector<Pulse> out;
  out.reserve(std::size_t{scan.columns} * scan.rows);
  const double focal = 0.5 * scan.columns / det::tan(0.5 * scan.fov);
  for (std::uint32_t row = 0; row < scan.rows; ++row)
    for (std::uint32_t column = 0; column < scan.columns; ++column)
      out.push_back({0,
                     glm::normalize(Vec3((column + 0.5 - 0.5 * scan.columns) / focal,
                                         (row + 0.5 - 0.5 * scan.rows) / focal, 1)),
                     row, column});
  return out;
}

std::vector<Pulse> raster(const Scan& scan) {
  std::vector<Pulse> out;
  out.reserve(std::size_t{scan.columns} * scan.rows);
  for (std::uint32_t row = 0; row < scan.rows; ++row)
    for (std::uint32_t k = 0; k < scan.columns; ++k) {
      const std::uint32_t column = scan.zigzag && row % 2 == 1 ? scan.columns - 1 - k : k;
      out.push_back({static_cast<double>(out.size()) / scan.rate_hz,
                     direction_of(between(scan.azimuth, column, scan.columns),
                                  between(scan.elevation, row, scan.rows)),
                     row, column});
    }
  return out;
}

// r = p θ / 2π at constant speed: both grow as the root of time.
std::vector<Pulse> spiral(const Scan& scan) {
  std::vector<Pulse> out;
  out.reserve(scan.pulses);
  for (std::uint32_t k = 0; k < scan.pulses; ++k) {
    const double root = std::sqrt(k / std::max(1.0, scan.pulses - 1.0));
    const auto off = det::sincos(scan.radius * root);
    const auto turn = det::sincos(2 * kPi * scan.turns * root);
    out.push_back({k / scan.rate_hz, Vec3(off.sin * turn.cos, -off.sin * turn.sin, off.cos), 0, k});
  }
  return out;
}

std::vector<Pulse> lissajous(const Scan& scan) {
  std::vector<Pulse> out;
  out.reserve(scan.pulses);
  for (std::uint32_t k = 0; k < scan.pulses; ++k) {
    const double time = k / scan.rate_hz;
    const double a = det::sin(2 * kPi * scan.frequency_hz.x * time + scan.phase);
    const double b = det::sin(2 * kPi * scan.frequency_hz.y * time);
    out.push_back({time, direction_of(scan.amplitude.x * a, scan.amplitude.y * b), 0, k});
  }
  return out;
}

// All channels in turn, column by column.
std::vector<Pulse> rotating(const Scan& scan) {
  std::vector<Pulse> out;
  const auto channels = static_cast<std::uint32_t>(scan.channels.size());
  out.reserve(std::size_t{scan.columns} * channels);
  for (std::uint32_t column = 0; column < scan.columns; ++column)
    for (std::uint32_t row = 0; row < channels; ++row) {
      // the head turns on between the channels of a column
      const double at = column + static_cast<double>(row) / channels;
      const double azimuth = scan.azimuth.x + (scan.azimuth.y - scan.azimuth.x) * at / scan.columns;
      out.push_back({at / scan.rate_hz, direction_of(azimuth, scan.channels[row]), row, column});
    }
  return out;
}

std::vector<Pulse> of_table(const Scan& scan) {
  std::vector<Pulse> out;
  out.reserve(scan.table.size());
  for (const Vec3& each : scan.table)
    out.push_back(
        {each.x, direction_of(each.y, each.z), 0, static_cast<std::uint32_t>(out.size())});
  return out;
}

}  // namespace

std::vector<Pulse> pulses_of(const Scan& scan) {
  switch (scan.pattern) {
    case ScanPattern::flash:
      return flash(scan);
    case ScanPattern::raster:
      return raster(scan);
    case ScanPattern::spiral:
      return spiral(scan);
    case ScanPattern::lissajous:
      return lissajous(scan);
    case ScanPattern::rotating:
      return rotating(scan);
    case ScanPattern::file:
      return of_table(scan);
  }
  return {};
}

}  // namespace panwright::instruments
