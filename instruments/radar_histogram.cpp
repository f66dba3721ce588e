// Cells of a RADAR's histogram.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/math.h"
#include "base/parallel.h"
#include "instruments/internal/radar_grid.h"
#include "sensor/draws.h"

namespace panwright::instruments {

namespace {

constexpr int kCellReach = 12;           // half steps: the response is 4e-6 there
constexpr int kMargin = kCellReach + 2;  // and the reach of the interpolation
constexpr double kBoltzmannJPerK = 1.380649e-23;
constexpr std::uint32_t kRadarStage = 64;  // stages of random numbers: one each look from here

// Amplitude at half steps from the centre: its square is 1/2 at two of them.
double response(double half_steps) {
  return det::exp(-0.125 * std::numbers::ln2 * half_steps * half_steps);
}

// Weights of four points about a place between the second and the third: the cubic through them.
std::array<double, 4> cubic(double f) {
  return {-f * (f - 1) * (f - 2) / 6, (f + 1) * (f - 1) * (f - 2) / 2, -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

}  // namespace

double RadarGrid::Axis::place(double value) const { return 2 * (value - first) / step + kMargin; }

RadarGrid::Axis RadarGrid::axis_of(const Vec2& window, double step) {
  Axis axis;
  axis.count = static_cast<std::uint32_t>(std::ceil((window.y - window.x) / step - 1e-9));
  axis.step = step;
  axis.first = window.x + 0.5 * step;
  axis.fine = 2 * axis.count + 2 * kMargin;
  return axis;
}

RadarGrid::RadarGrid(const Radar& radar)
    : radar_(radar),
      range_(axis_of(radar.range, radar.range_step())),
      speed_(axis_of(radar.speed, radar.speed_step())) {
  for (auto& plane : fine_) plane.assign(std::size_t{range_.fine} * speed_.fine, 0);
}

bool RadarGrid::Axis::holds(double value) const {
  return value >= first - 0.5 * step && value <= first + (count - 0.5) * step;
}

void RadarGrid::add(const RadarEcho& echo) {
  const double x = range_.place(echo.range), y = speed_.place(echo.speed);
  if (!(x >= 1 && x < range_.fine - 2 && y >= 1 && y < speed_.fine - 2)) return;
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const double fx = x - static_cast<double>(column), fy = y - static_cast<double>(row);
  const auto put = [&](Plane plane, std::size_t at, double value) {
    fine_[plane][at] += value;
    fine_[plane + 3][at] += value * echo.azimuth;
    fine_[plane + 6][at] += value * echo.elevation;
  };
  if (echo.amplitude != 0) {
    const auto wx = cubic(fx), wy = cubic(fy);
    const double cosine = echo.amplitude * det::cos(echo.phase);
    const double sine = echo.amplitude * det::sin(echo.phase);
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t at = (row + j - 1) * range_.fine + column + i - 1;
        put(re, at, wx[i] * wy[j] * cosine);
        put(im, at, wx[i] * wy[j] * sine);
      }
  }
  if (echo.power > 0)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t i = 0; i < 2; ++i)
        put(power, (row + j) * range_.fine + column + i,
            (i == 0 ? 1 - fx : fx) * (j == 0 ? 1 - fy : fy) * echo.power);
}

void RadarGrid::smooth(std::size_t plane, std::vector<double>& out) const {
  std::array<double, 2 * kCellReach + 1> weights{};
  for (int i = -kCellReach; i <= kCellReach; ++i) {
    const double w = response(i);
    weights[static_cast<std::size_t>(i + kCellReach)] = plane % 3 == power ? w * w : w;
  }
  const std::vector<double>& fine = fine_[plane];
  const std::size_t width = range_.fine;
  std::vector<double> rows(std::size_t{range_.count} * speed_.fine, 0.0);
  for (std::size_t y = 0; y < speed_.fine; ++y) {
    const double* from = &fine[y * width];
    if (std::all_of(from, from + width, [](double v) { return v == 0; })) continue;
    for (std::size_t x = 0; x < range_.count; ++x) {
      double sum = 0;
      for (std::size_t k = 0; k < weights.size(); ++k)
        sum += weights[k] * from[2 * x + kMargin - kCellReach + k];
      rows[y * range_.count + x] = sum;
    }
  }
  out.assign(std::size_t{range_.count} * speed_.count, 0.0);
  for (std::size_t y = 0; y < speed_.count; ++y)
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double* from = &rows[(2 * y + kMargin - kCellReach + k) * range_.count];
      for (std::size_t x = 0; x < range_.count; ++x)
        out[y * range_.count + x] += weights[k] * from[x];
    }
}

// Averages of looks: the field of metal and a Gaussian one of the rest.
void RadarGrid::draw(const RadarOptions& options, RadarHistogram& out,
                     const std::array<std::vector<double>, kPlanes>& planes) const {
  const std::size_t cells = out.mean_power.size();
  out.power.assign(cells, 0);
  std::vector<double> a(cells), b(cells);
  for (std::uint32_t look = 0; look < radar_.looks; ++look) {
    const sensor::Stream stream{
        {static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32)},
        options.frame,
        kRadarStage + look};
    sensor::draw_normal_pairs(0, stream, a, b);
    for (std::size_t i = 0; i < cells; ++i) {
      const double sigma = std::sqrt(0.5 * (planes[power][i] + out.noise));
      const double x = planes[re][i] + sigma * a[i], y = planes[im][i] + sigma * b[i];
      out.power[i] += (x * x + y * y) / radar_.looks;
    }
  }
}

void RadarGrid::finish(const RadarOptions& options, RadarHistogram& out, const Job& job) {
  std::array<std::vector<double>, kPlanes> planes;
  parallel_for(
      kPlanes, [&](std::size_t plane) { smooth(plane, planes[plane]); }, job);
  out.ranges = range_.count;
  out.speeds = speed_.count;
  out.first_range = range_.first;
  out.range_step = range_.step;
  out.first_speed = speed_.first;
  out.speed_step = speed_.step;
  double sum = 0;  // over whole steps
  for (int i = -kCellReach; i <= kCellReach; i += 2) sum += response(i) * response(i);
  out.response_sum = sum * sum;
  if (!options.ideal)
    out.noise = kBoltzmannJPerK * radar_.temperature * radar_.noise_figure / radar_.dwell;
  const std::size_t cells = planes[power].size();
  const double none = std::numeric_limits<double>::quiet_NaN();
  out.mean_power.resize(cells);
  out.azimuth.assign(cells, none);
  out.elevation.assign(cells, none);
  for (std::size_t i = 0; i < cells; ++i) {
    const double x = planes[re][i], y = planes[im][i];
    const double mean = out.mean_power[i] = x * x + y * y + planes[power][i];
    if (!(mean > 0)) continue;
    const auto angle = [&](std::size_t at) {
      return (x * planes[re + at][i] + y * planes[im + at][i] + planes[power + at][i]) / mean;
    };
    out.azimuth[i] = angle(3);
    out.elevation[i] = angle(6);
  }
  if (options.ideal)
    out.power = out.mean_power;
  else
    draw(options, out, planes);
}

}  // namespace panwright::instruments
