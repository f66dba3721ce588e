// Histogram of a foil sheet's slopes, and its plot. The same bytes for the same sheet.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "mli/sheet.h"

namespace panwright::tools {

// Facets of a sheet by their slope along each axis: the two triangles of each cell, cut as in
// mli::Statistics.
struct SlopeHistogram {
  static constexpr std::size_t kBins = 81;
  struct Axis {
    double mean = 0;
    double deviation = 0;  // standard deviation about the mean
    std::array<std::uint64_t, kBins> counts{};
    std::uint64_t below = 0, above = 0;  // facets outside the bins
  };
  double lowest = 0;  // lower end of the first bin
  double bin = 0;     // of both axes; the middle of all bins is slope 0
  std::uint64_t facets = 0;
  Axis x, y;
};

// Counts slopes. Bins reach at least four standard deviations to either side of both means.
SlopeHistogram slope_histogram(const mli::Sheet& sheet);

// Plots the density over slope, with the Gaussian of the same mean and variance beside each axis,
// as SVG.
std::string slope_plot(const SlopeHistogram& histogram, const std::string& name);

}  // namespace panwright::tools
