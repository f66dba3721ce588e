// The four operations of the paper.
#include "mli/internal/grid.h"

namespace panwright::mli {

void apply(const Random& random, const Grid& grid, const Job& job) {
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    for (std::size_t j = first; j < end; ++j) {
      double* h = grid.row(j);
      for (std::size_t i = 0; i < grid.columns; i += 4) {
        const auto words =
            grid.words(static_cast<std::uint32_t>(i / 4), static_cast<std::uint32_t>(j));
        const std::size_t count = std::min<std::size_t>(4, grid.columns - i);
        for (std::size_t k = 0; k < count; ++k)
          h[i + k] += random.amplitude * (2 * in_unit(words[k]) - 1);
      }
    }
  });
}

void apply(const Constant& constant, const Grid& grid, const Job& job) {
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    for (double* h = grid.row(first); h != grid.row(end); ++h) *h += constant.height;
  });
}

namespace {

// Factors of a taper along one axis.
std::vector<double> ramp(std::size_t count, double cell, double from, double to) {
  std::vector<double> factors(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double inside = static_cast<double>(std::min(i, count - 1 - i)) * cell;
    if (inside >= to)
      factors[i] = 1;
    else if (inside > from)
      factors[i] = smooth_step((inside - from) / (to - from));
  }
  return factors;
}

// Means of three along a row. Differences keep equal heights equal to the bit.
void smooth_row(const double* h, double* out, std::size_t count) {
  constexpr double kThird = 1.0 / 3.0;
  if (count < 2) {
    if (count == 1) out[0] = h[0];
    return;
  }
  out[0] = h[0] + (h[1] - h[0]) * kThird;
  for (std::size_t i = 1; i + 1 < count; ++i)
    out[i] = h[i] + ((h[i - 1] - h[i]) + (h[i + 1] - h[i])) * kThird;
  out[count - 1] = h[count - 1] + (h[count - 2] - h[count - 1]) * kThird;
}

// Rows of a band with those around it that its passes need.
class Band {
 public:
  Band(std::size_t columns) : columns_(columns), means_(3 * columns) {}

  // The rows [first, end) of a grid, smoothed, into `out`.
  void smooth(const Grid& grid, std::size_t first, std::size_t end, std::size_t passes,
              double* out) {
    const std::size_t from = first > passes ? first - passes : 0;
    const std::size_t to = std::min(grid.rows, end + passes);
    rows_.assign(grid.row(from), grid.row(to));
    // rows whose neighbours are missing are wrong, one more from each cut with each pass
    for (std::size_t pass = 0; pass < passes; ++pass) smooth_once(to - from);
    const double* result = rows_.data() + (first - from) * columns_;
    std::copy(result, result + (end - first) * columns_, out);
  }

 private:
  double* means(std::size_t j) { return means_.data() + j % 3 * columns_; }

  void smooth_once(std::size_t count) {
    constexpr double kThird = 1.0 / 3.0;
    smooth_row(rows_.data(), means(0), columns_);
    for (std::size_t j = 0; j < count; ++j) {
      if (j + 1 < count) smooth_row(rows_.data() + (j + 1) * columns_, means(j + 1), columns_);
      const double* here = means(j);
      const double* below = j > 0 ? means(j - 1) : here;
      const double* above = j + 1 < count ? means(j + 1) : here;
      double* out = rows_.data() + j * columns_;
      for (std::size_t i = 0; i < columns_; ++i)
        out[i] = here[i] + ((below[i] - here[i]) + (above[i] - here[i])) * kThird;
    }
  }

  std::size_t columns_;
  std::vector<double> rows_;
  std::vector<double> means_;  // of three rows at a time
};

}  // namespace

void apply(const Taper& taper, const Grid& grid, const Job& job) {
  const std::vector<double> along = ramp(grid.columns, grid.cell, taper.x0, taper.x1);
  const std::vector<double> up = ramp(grid.rows, grid.cell, taper.y0, taper.y1);
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    for (std::size_t j = first; j < end; ++j)
      for (std::size_t i = 0; i < grid.columns; ++i) grid.row(j)[i] *= along[i] * up[j];
  });
}

void apply(const Smooth& smooth, const Grid& grid, const Job& job) {
  constexpr std::size_t kAtOnce = 8;  // passes while a band is in the cache
  std::vector<double> result(smooth.passes > 0 ? grid.heights->size() : 0);
  for (std::size_t left = smooth.passes; left > 0; left -= std::min(left, kAtOnce)) {
    for_bands(grid, job, [&](std::size_t first, std::size_t end) {
      Band(grid.columns)
          .smooth(grid, first, end, std::min(left, kAtOnce), result.data() + first * grid.columns);
    });
    grid.heights->swap(result);
  }
}

}  // namespace panwright::mli
