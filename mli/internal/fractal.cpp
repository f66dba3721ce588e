#include <cmath>

#include "base/math.h"
#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

// Weights of a uniform cubic B-spline at t in [0, 1) behind the second of four knots.
std::array<double, 4> spline(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
          t * t * t / 6};
}

// Knots and their weights at each vertex along one axis.
struct Axis {
  std::vector<std::size_t> knots;
  std::vector<std::array<double, 4>> weights;
  std::size_t count = 0;  // of knots

  Axis(std::size_t vertices, double cell, double spacing, double shift) {
    for (std::size_t i = 0; i < vertices; ++i) {
      const double x = static_cast<double>(i) * cell / spacing + shift;
      const double knot = std::floor(x);
      knots.push_back(static_cast<std::size_t>(knot));
      weights.push_back(spline(x - knot));
    }
    count = knots.back() + 4;
  }
};

void add_octave(std::uint32_t octave, double spacing, double amplitude, const Grid& grid,
                const Job& job) {
  const auto shift = grid.words(0, 0, octave, 1);
  const Axis x(grid.columns, grid.cell, spacing, in_unit(shift[0]));
  const Axis y(grid.rows, grid.cell, spacing, in_unit(shift[1]));
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    // rows of knots that the band meets
    const std::size_t low = y.knots[first], high = y.knots[end - 1] + 4;
    std::vector<double> knots((high - low) * x.count);
    for (std::size_t k = low; k < high; ++k)
      for (std::size_t i = 0; i < x.count; i += 4) {
        const auto words =
            grid.words(static_cast<std::uint32_t>(i / 4), static_cast<std::uint32_t>(k), octave);
        for (std::size_t n = 0; n < std::min<std::size_t>(4, x.count - i); ++n)
          knots[(k - low) * x.count + i + n] = amplitude * (2 * in_unit(words[n]) - 1);
      }
    std::vector<double> row(x.count);
    for (std::size_t j = first; j < end; ++j) {
      const double* k = knots.data() + (y.knots[j] - low) * x.count;
      const std::array<double, 4>& v = y.weights[j];
      for (std::size_t i = 0; i < x.count; ++i)
        row[i] = (v[0] * k[i] + v[1] * k[i + x.count]) +
                 (v[2] * k[i + 2 * x.count] + v[3] * k[i + 3 * x.count]);
      double* h = grid.row(j);
      for (std::size_t i = 0; i < grid.columns; ++i) {
        const double* r = row.data() + x.knots[i];
        const std::array<double, 4>& w = x.weights[i];
        h[i] += (w[0] * r[0] + w[1] * r[1]) + (w[2] * r[2] + w[3] * r[3]);
      }
    }
  });
}

}  // namespace

void apply(const Fractal& fractal, const Grid& grid, const Job& job) {
  const double ratio = det::pow(2, -2 * fractal.hurst);  // of variances, octave to octave
  double spacing = fractal.longest > 0 ? fractal.longest : grid.width() / 4;
  // a spline through heights uniform in [-1, 1]: the mean of its variance over the knots' places is
  // 1/3 · (151/315)²
  double amplitude = fractal.rms * std::sqrt(3 * (1 - ratio)) * (315.0 / 151.0);
  for (std::uint32_t octave = 0; spacing >= 2 * grid.cell; ++octave) {
    add_octave(octave, spacing, amplitude, grid, job);
    spacing /= 2;
    amplitude *= std::sqrt(ratio);
  }
}

}  // namespace panwright::mli
