#include "tools/foil_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "tools/plot.h"

namespace panwright::tools {
namespace {

// Calls `visit` with the slopes of every facet, row by row.
template <class Visit>
void each_facet(const mli::Sheet& sheet, const Visit& visit) {
  for (std::uint32_t row = 0; row + 1 < sheet.rows; ++row)
    for (std::uint32_t column = 0; column + 1 < sheet.columns; ++column) {
      const double a = sheet.at(column, row), b = sheet.at(column + 1, row);
      const double c = sheet.at(column + 1, row + 1), d = sheet.at(column, row + 1);
      visit((b - a) / sheet.spacing.x, (c - b) / sheet.spacing.y);
      visit((c - d) / sheet.spacing.x, (d - a) / sheet.spacing.y);
    }
}

void count(SlopeHistogram::Axis& axis, double slope, double lowest, double bin) {
  const double at = std::floor((slope - lowest) / bin);
  if (at < 0)
    ++axis.below;
  else if (at >= static_cast<double>(SlopeHistogram::kBins))
    ++axis.above;
  else
    ++axis.counts[static_cast<std::size_t>(at)];
}

}  // namespace

SlopeHistogram slope_histogram(const mli::Sheet& sheet) {
  SlopeHistogram out;
  each_facet(sheet, [&](double x, double y) {
    ++out.facets;
    out.x.mean += x;
    out.y.mean += y;
  });
  const double facets = std::max(1.0, static_cast<double>(out.facets));
  out.x.mean /= facets;
  out.y.mean /= facets;
  each_facet(sheet, [&](double x, double y) {
    out.x.deviation += (x - out.x.mean) * (x - out.x.mean);
    out.y.deviation += (y - out.y.mean) * (y - out.y.mean);
  });
  double reach = 0;
  for (SlopeHistogram::Axis* axis : {&out.x, &out.y}) {
    axis->deviation = std::sqrt(axis->deviation / facets);
    reach = std::max(reach, std::fabs(axis->mean) + 4 * axis->deviation);
  }
  if (!(reach > 1e-12)) reach = 1e-3;  // a level sheet
  out.lowest = -reach;
  out.bin = 2 * reach / static_cast<double>(SlopeHistogram::kBins);
  each_facet(sheet, [&](double x, double y) {
    count(out.x, x, out.lowest, out.bin);
    count(out.y, y, out.lowest, out.bin);
  });
  return out;
}

std::string slope_plot(const SlopeHistogram& histogram, const std::string& name) {
  const double reach = -histogram.lowest;
  const double scale = 1 / (std::max(1.0, static_cast<double>(histogram.facets)) * histogram.bin);
  double peak = 0;
  for (const SlopeHistogram::Axis* axis : {&histogram.x, &histogram.y}) {
    for (const std::uint64_t count : axis->counts)
      peak = std::max(peak, static_cast<double>(count) * scale);
    if (axis->deviation > 0) peak = std::max(peak, 0.4 / axis->deviation);
  }
  if (!(peak > 0)) peak = 1;
  Plot plot{.title = fmt::format(
                "{}: slopes of facets, standard deviation {:.3g} along x, {:.3g} along y", name,
                histogram.x.deviation, histogram.y.deviation),
            .x_name = "slope dh/dx, dh/dy",
            .y_name = "share of facets per unit of slope",
            .left = -reach,
            .right = reach,
            .top = 1.05 * peak};
  const auto draw = [&](const SlopeHistogram::Axis& axis, const char* color, const char* pale,
                        const char* words) {
    PlotPoints steps;
    for (std::size_t k = 0; k < SlopeHistogram::kBins; ++k) {
      const double left = histogram.lowest + static_cast<double>(k) * histogram.bin;
      const double density = static_cast<double>(axis.counts[k]) * scale;
      steps.emplace_back(left, density);
      steps.emplace_back(left + histogram.bin, density);
    }
    plot.curves.push_back({steps, color, fmt::format("along {}", words)});
    if (!(axis.deviation > 0)) return;
    PlotPoints bell;
    for (int k = -200; k <= 200; ++k) {
      const double slope = reach * k / 200;
      const double z = (slope - axis.mean) / axis.deviation;
      bell.emplace_back(slope, det::exp(-0.5 * z * z) / (axis.deviation * std::sqrt(2 * kPi)));
    }
    plot.curves.push_back({bell, pale, fmt::format("Gaussian {}", words)});
  };
  draw(histogram.x, "#c0392b", "#e8a9a2", "x");
  draw(histogram.y, "#2c6fbb", "#a3c4e6", "y");
  return svg_of(plot);
}

}  // namespace panwright::tools
