#include "mli/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace panwright::mli {
namespace {

struct View {
  const double* heights;
  std::size_t columns, rows;
  Vec2 spacing;

  const double* row(std::size_t j) const { return heights + j * columns; }
};

struct SlopeMoments {
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void add(double sx, double sy) {
    x += sx;
    y += sy;
    xx += sx * sx;
    xy += sx * sy;
    yy += sy * sy;
  }
  void add(const SlopeMoments& m) {
    x += m.x;
    y += m.y;
    xx += m.xx;
    xy += m.xy;
    yy += m.yy;
  }
  Covariance about_mean(double count) const {
    const double mx = x / count, my = y / count;
    return {std::max(0.0, xx / count - mx * mx), xy / count - mx * my,
            std::max(0.0, yy / count - my * my)};
  }
};

struct RowSums {
  double height = 0, height2 = 0, lowest = 0, highest = 0;
  SlopeMoments slopes, facets;
  Vec3 normal{0, 0, 0};
  std::array<std::uint64_t, Statistics::kBins> tilts{};

  void add(const RowSums& row) {
    height += row.height;
    height2 += row.height2;
    lowest = std::min(lowest, row.lowest);
    highest = std::max(highest, row.highest);
    slopes.add(row.slopes);
    facets.add(row.facets);
    normal += row.normal;
    for (std::size_t k = 0; k < tilts.size(); ++k) tilts[k] += row.tilts[k];
  }
};

// Bins of tilts by squared slopes.
class Bins {
 public:
  Bins() {
    for (std::size_t k = 0; k < kLast; ++k) {
      const double slope = det::tan(static_cast<double>(k + 1) * 0.5 * kDegree);
      bounds_[k] = slope * slope;
    }
    for (std::size_t n = 0; n < kGuesses; ++n) {
      // squared sines from n/kGuesses on, and a little less for what rounds
      const double sine = (static_cast<double>(n) - 1e-6) / kGuesses;
      while (guesses_[n] < kLast && bounds_[guesses_[n]] <= sine / (1 - sine)) ++guesses_[n];
    }
  }

  std::size_t operator()(double square) const {
    const auto guess = static_cast<std::size_t>(square / (1 + square) * kGuesses);
    std::size_t bin = guesses_[std::min(guess, kGuesses - 1)];
    while (bin < kLast && square >= bounds_[bin]) ++bin;
    return bin;
  }

 private:
  static constexpr std::size_t kLast = Statistics::kBins - 1, kGuesses = 2048;
  std::array<double, kLast> bounds_;  // upper; the last bin has none
  std::array<std::size_t, kGuesses> guesses_{};
};

// about: from which heights are measured, so that no digits are lost
void add_heights_and_slopes(const View& view, std::size_t j, double about, RowSums& sums) {
  const double* h = view.row(j);
  sums.lowest = sums.highest = h[0];
  for (std::size_t i = 0; i < view.columns; ++i) {
    sums.height += h[i] - about;
    sums.height2 += (h[i] - about) * (h[i] - about);
    sums.lowest = std::min(sums.lowest, h[i]);
    sums.highest = std::max(sums.highest, h[i]);
  }
  const double* below = view.row(j > 0 ? j - 1 : 0);
  const double* above = view.row(std::min(j + 1, view.rows - 1));
  const double per_x = 0.5 / view.spacing.x;
  const double per_y = (j > 0 && j + 1 < view.rows ? 0.5 : 1.0) / view.spacing.y;
  const std::size_t last = view.columns - 1;
  sums.slopes.add((h[1] - h[0]) * (2 * per_x), (above[0] - below[0]) * per_y);
  for (std::size_t i = 1; i < last; ++i)
    sums.slopes.add((h[i + 1] - h[i - 1]) * per_x, (above[i] - below[i]) * per_y);
  sums.slopes.add((h[last] - h[last - 1]) * (2 * per_x), (above[last] - below[last]) * per_y);
}

RowSums sums_of_row(const View& view, std::size_t j, double about, const Bins& bins) {
  RowSums sums;
  add_heights_and_slopes(view, j, about, sums);
  if (j + 1 == view.rows) return sums;
  const double* h = view.row(j);
  const double* up = view.row(j + 1);
  const double per_x = 1 / view.spacing.x, per_y = 1 / view.spacing.y;
  const auto add_facet = [&](double sx, double sy) {
    sums.facets.add(sx, sy);
    ++sums.tilts[bins(sx * sx + sy * sy)];
  };
  double left = (up[0] - h[0]) * per_y;
  for (std::size_t i = 0; i + 1 < view.columns; ++i) {
    const double below = (h[i + 1] - h[i]) * per_x;
    const double above = (up[i + 1] - up[i]) * per_x, right = (up[i + 1] - h[i + 1]) * per_y;
    add_facet(below, right);
    add_facet(above, left);
    left = right;
  }
  sums.normal = {-sums.facets.x, -sums.facets.y, 2 * static_cast<double>(view.columns - 1)};
  return sums;
}

// Autocorrelations of lines of heights about their mean.
class Correlation {
 public:
  Correlation(const View& view, bool along_x, double mean)
      : view_(view), along_x_(along_x), mean_(mean) {
    length_ = along_x ? view.columns : view.rows;
    const std::size_t all = along_x ? view.rows : view.columns;
    const std::size_t lines = std::min<std::size_t>(all, 64);
    for (std::size_t k = 0; k < lines; ++k) lines_.push_back((2 * k + 1) * all / (2 * lines));
  }

  // Over pairs of heights a lag apart.
  double at(std::size_t lag, const Job& job) const {
    std::vector<std::array<double, 3>> sums(lines_.size());
    parallel_for(
        lines_.size(),
        [&](std::size_t k) {
          std::array<double, 3> sum{};
          for (std::size_t i = 0; i + lag < length_; ++i) {
            const double a = height(lines_[k], i), b = height(lines_[k], i + lag);
            sum[0] += a * b;
            sum[1] += a * a;
            sum[2] += b * b;
          }
          sums[k] = sum;
        },
        job);
    std::array<double, 3> total{};
    for (const auto& sum : sums)
      for (std::size_t n = 0; n < 3; ++n) total[n] += sum[n];
    return total[1] + total[2] > 0 ? 2 * total[0] / (total[1] + total[2]) : 0;
  }

  // The first lag, in steps, at which it is 1/e; lags grow by an eighth.
  double length(const Job& job) const {
    const double wanted = det::exp(-1);
    const std::size_t half = (length_ - 1) / 2;
    double before = 1;
    for (std::size_t last = 0, lag = 1; lag <= half;
         last = lag, lag += std::max<std::size_t>(1, lag / 8)) {
      const double here = at(lag, job);
      if (here <= wanted)
        return static_cast<double>(last) +
               static_cast<double>(lag - last) * (before - wanted) / (before - here);
      before = here;
    }
    return static_cast<double>(length_ - 1) / 2;
  }

 private:
  double height(std::size_t line, std::size_t i) const {
    return (along_x_ ? view_.row(line)[i] : view_.row(i)[line]) - mean_;
  }

  View view_;
  bool along_x_;
  double mean_;
  std::size_t length_;
  std::vector<std::size_t> lines_;
};

View view_of(std::span<const double> heights, std::size_t columns, const Vec2& spacing) {
  return {heights.data(), columns, heights.size() / columns, spacing};
}

}  // namespace

double slope_rms(std::span<const double> heights, std::size_t columns, const Vec2& spacing,
                 const Job& job) {
  const View view = view_of(heights, columns, spacing);
  std::vector<double> rows(view.rows);
  parallel_for(
      view.rows,
      [&](std::size_t j) {
        RowSums sums;
        add_heights_and_slopes(view, j, 0, sums);
        rows[j] = sums.slopes.xx + sums.slopes.yy;
      },
      job);
  double sum = 0;
  for (const double row : rows) sum += row;
  return std::sqrt(sum / static_cast<double>(heights.size()));
}

Statistics measured(std::span<const double> heights, std::size_t columns, const Vec2& spacing,
                    const Job& job) {
  const View view = view_of(heights, columns, spacing);
  const Bins bins;
  const double about = heights[0];
  constexpr std::size_t kRows = 64;
  std::vector<RowSums> bands((view.rows + kRows - 1) / kRows);
  parallel_for(
      bands.size(),
      [&](std::size_t band) {
        bands[band] = sums_of_row(view, band * kRows, about, bins);
        for (std::size_t j = band * kRows + 1; j < std::min(view.rows, (band + 1) * kRows); ++j)
          bands[band].add(sums_of_row(view, j, about, bins));
      },
      job);
  RowSums all = bands[0];
  for (std::size_t band = 1; band < bands.size(); ++band) all.add(bands[band]);
  const auto count = static_cast<double>(heights.size());
  const double facets = 2 * static_cast<double>((view.columns - 1) * (view.rows - 1));
  Statistics out;
  out.lowest = all.lowest;
  out.highest = all.highest;
  out.height_mean = about + all.height / count;
  const double mean = all.height / count;
  out.height_rms = std::sqrt(std::max(0.0, all.height2 / count - mean * mean));
  out.slope_mean = {all.slopes.x / count, all.slopes.y / count};
  out.slope_covariance = all.slopes.about_mean(count);
  out.slope_rms = std::sqrt((all.slopes.xx + all.slopes.yy) / count);
  out.facet_slope_covariance = all.facets.about_mean(facets);
  out.facet_slope_rms = std::sqrt((all.facets.xx + all.facets.yy) / facets);
  out.mean_normal = all.normal / glm::length(all.normal);
  out.tilt_histogram = all.tilts;
  if (out.height_rms > 0)
    out.correlation_length = {Correlation(view, true, out.height_mean).length(job) * spacing.x,
                              Correlation(view, false, out.height_mean).length(job) * spacing.y};
  return out;
}

Statistics scaled(const Statistics& statistics, double factor) {
  Statistics out = statistics;
  for (double* length : {&out.lowest, &out.highest, &out.height_mean, &out.height_rms,
                         &out.slope_rms, &out.facet_slope_rms})
    *length *= factor;
  out.slope_mean *= factor;
  for (Covariance* c : {&out.slope_covariance, &out.facet_slope_covariance})
    for (double* entry : {&c->xx, &c->xy, &c->yy}) *entry *= factor * factor;
  const Vec3& n = statistics.mean_normal;
  out.mean_normal = glm::normalize(Vec3(factor * n.x, factor * n.y, n.z));
  out.tilt_histogram = {};
  constexpr double kBin = 0.5 * kDegree;
  for (std::size_t k = 0; k < Statistics::kBins; ++k) {
    const auto middle = det::sincos((static_cast<double>(k) + 0.5) * kBin);
    const double tilt = det::atan2(factor * middle.sin, middle.cos);
    out.tilt_histogram[std::min(Statistics::kBins - 1, static_cast<std::size_t>(tilt / kBin))] +=
        statistics.tilt_histogram[k];
  }
  return out;
}

}  // namespace panwright::mli
