// Coarser sheets.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mli/sheet.h"

namespace panwright::mli {
namespace {

// Weights of consecutive heights.
struct Window {
  std::size_t first = 0;
  std::vector<double> weights;
};

// ∫ of the hat max(0, 1 - |t|) from -1 to t.
double hat_integral(double t) {
  t = std::min(1.0, std::max(-1.0, t));
  return t < 0 ? (1 + t) * (1 + t) / 2 : 1 - (1 - t) * (1 - t) / 2;
}

// For each coarse vertex the weights of `fine` + 1 heights that make the mean of what is linear
// between them, over a box as wide as a coarse cell, mirrored at both ends.
std::vector<Window> windows(std::size_t fine, std::size_t coarse) {
  const double cell = static_cast<double>(fine) / static_cast<double>(coarse);  // in fine cells
  const auto last = static_cast<long long>(fine);
  std::vector<Window> all(coarse + 1);
  for (std::size_t k = 0; k <= coarse; ++k) {
    const double low = (static_cast<double>(k) - 0.5) * cell, high = low + cell;
    const auto from = static_cast<long long>(std::floor(low)),
               to = from + static_cast<long long>(cell) + 3;
    const auto mirrored = [&](long long i) { return i < 0 ? -i : i > last ? 2 * last - i : i; };
    Window& window = all[k];
    long long first = last, end = 0;
    for (long long i = from; i <= to; ++i) {
      first = std::min(first, std::max(0LL, mirrored(i)));
      end = std::max(end, mirrored(i));
    }
    window.first = static_cast<std::size_t>(first);
    window.weights.assign(static_cast<std::size_t>(end - first + 1), 0.0);
    for (long long i = from; i <= to; ++i) {
      const double x = static_cast<double>(i);
      const double weight = (hat_integral(high - x) - hat_integral(low - x)) / cell;
      if (weight > 0) window.weights[static_cast<std::size_t>(mirrored(i) - first)] += weight;
    }
  }
  return all;
}

Covariance less(const Covariance& a, const Covariance& b) {
  return {a.xx - b.xx, a.xy - b.xy, a.yy - b.yy};
}

}  // namespace

Sheet filtered(const Sheet& sheet, std::uint32_t cells, const Job& job) {
  const std::uint32_t across = sheet.columns - 1, up = sheet.rows - 1;
  if (cells >= across) return sheet;
  Sheet out;
  // as many rows of cells as keep them nearest to square
  const double square = up * sheet.spacing.y / (across * sheet.spacing.x) * cells;
  const auto coarse_up =
      std::min(up, std::max(1u, static_cast<std::uint32_t>(std::floor(square + 0.5))));
  out.columns = cells + 1;
  out.rows = coarse_up + 1;
  out.spacing = {across * sheet.spacing.x / cells, up * sheet.spacing.y / coarse_up};
  const std::vector<Window> along = windows(across, cells), rows = windows(up, coarse_up);
  out.heights.resize(std::size_t{out.columns} * out.rows);
  parallel_for(
      out.rows,
      [&](std::size_t j) {
        std::vector<double> mean(sheet.columns);
        for (std::size_t k = 0; k < rows[j].weights.size(); ++k) {
          const double* h = sheet.heights.data() + (rows[j].first + k) * sheet.columns;
          for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += rows[j].weights[k] * h[i];
        }
        for (std::size_t i = 0; i < out.columns; ++i) {
          double sum = 0;
          for (std::size_t k = 0; k < along[i].weights.size(); ++k)
            sum += along[i].weights[k] * mean[along[i].first + k];
          out.heights[j * out.columns + i] = sum;
        }
      },
      job);
  out.statistics = measured(out.heights, out.columns, out.spacing, job);
  const Covariance lost =
      less(sheet.statistics.facet_slope_covariance, out.statistics.facet_slope_covariance);
  const Covariance& before = sheet.removed_slope_covariance;
  out.removed_slope_covariance = {before.xx + lost.xx, before.xy + lost.xy, before.yy + lost.yy};
  return out;
}

}  // namespace panwright::mli
