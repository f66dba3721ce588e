// Statistics of a sheet: heights and slopes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/job.h"
#include "base/math.h"

namespace panwright::mli {

// A symmetric 2 × 2 matrix.
struct Covariance {
  double xx = 0, xy = 0, yy = 0;
};

// Slopes (dh/dx, dh/dy) at a vertex are central differences, one-sided at the edges; means go over
// all vertices with equal weights. Facets are the two triangles of each cell, cut from (i, j) to
// (i + 1, j + 1).
struct Statistics {
  static constexpr std::size_t kBins = 180;

  double lowest = 0, highest = 0;  // metres
  double height_mean = 0;          // metres
  double height_rms = 0;           // metres, about the mean
  Vec2 slope_mean{0, 0};
  Covariance slope_covariance;        // about the mean
  Covariance facet_slope_covariance;  // the same of facets, by their area in the plane
  double slope_rms = 0;               // sqrt(mean(sx² + sy²)), the mean slope included
  double facet_slope_rms = 0;
  Vec3 mean_normal{0, 0, 1};  // unit vector along the sum of the facets' area vectors
  // The lag along x and along y at which the autocorrelation of heights first falls to 1/e, metres;
  // half the sheet if it does not; 0 for a level sheet.
  Vec2 correlation_length{0, 0};
  std::array<std::uint64_t, kBins> tilt_histogram{};  // facets by tilt, bins of half a degree
};

// Returns the root mean squared slope, both axes together. heights: rows*columns, row 0 at the
// lower edge; spacing: metres between columns, rows. Expects: two columns and rows at least.
double slope_rms(std::span<const double> heights, std::size_t columns, const Vec2& spacing,
                 const Job& job = {});

// Measures all statistics. Sums go row by row in one order: the same bits with any number of
// threads. Cost: O(vertices).
Statistics measured(std::span<const double> heights, std::size_t columns, const Vec2& spacing,
                    const Job& job = {});

// Returns the statistics for heights times a factor above 0. Tilts move to other bins by their
// bin's middle, which limits the histogram's accuracy.
Statistics scaled(const Statistics& statistics, double factor);

}  // namespace panwright::mli
