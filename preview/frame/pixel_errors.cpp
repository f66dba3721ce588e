#include "preview/frame/pixel_errors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include "base/parallel.h"

namespace panwright::preview {
namespace {

// The error of a pixel in parts of its second difference, rms: 0.15 to 0.2 on the views of
// docs/accuracy/sampling.md, the rest is for what varies from pixel to pixel.
constexpr float kShare = 0.3f;
// The same of its neighbours' second differences.
constexpr float kNeighbourShare = 0.05f;
// The same of second differences from the centre to two corners, which lie half as far.
constexpr float kCornerShare = 0.2f;

// of floats ≥ 0, in ascending order: 8 bits of the exponent, 8 of the fraction
constexpr unsigned kBinShift = 15;
constexpr std::size_t kBins = std::size_t{1} << (31 - kBinShift);

std::size_t bin_of(float value) { return std::bit_cast<std::uint32_t>(value) >> kBinShift; }

// The square of a second difference, summed over the channels.
float squared_bend(const std::vector<float>& values, std::size_t i, std::size_t step) {
  float squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float bend =
        values[3 * (i - step) + k] + values[3 * (i + step) + k] - 2 * values[3 * i + k];
    squares += bend * bend;
  }
  return squares;
}

// Errors fall with this power of N, and N grows with this power of the error.
constexpr double kFall = 1.4;
constexpr double kGrowth = 1 / (1 + kFall);

// One sample tells too little of an error for more samples a side at once: they are measured first.
constexpr unsigned kMostAtOnce = 16;

constexpr unsigned kCoarseShift = 18;  // 5 bits of the fraction
constexpr std::size_t kCoarseBins = std::size_t{1} << (31 - kCoarseShift);

float float_of_coarse(std::size_t bin) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << kCoarseShift);
}

}  // namespace

void ErrorPredictor::predict(const image::Image& image, std::span<const float> patternless,
                             const Tile& part, std::vector<float>& errors) {
  const std::size_t stride = part.width + 2;
  const std::size_t count = stride * (part.height + 2);
  values_.resize(3 * count);
  bends_.assign(count, 0.0f);
  errors.resize(std::size_t{part.width} * part.height);

  const bool has_patterns = !patternless.empty();
  means_.resize(has_patterns ? 3 * count : 0);
  flat_.assign(has_patterns ? count : 0, 0);
  // What lies outside the image is taken for a continuation: the value of the border.
  const auto inside = [](std::uint32_t first, std::size_t offset, std::uint32_t size) {
    const std::int64_t at = std::int64_t{first} + static_cast<std::int64_t>(offset) - 1;
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(at, 0, std::int64_t{size} - 1));
  };
  const auto copy_row = [&](std::size_t row) {
    const std::uint32_t y = inside(part.y, row, image.height);
    for (std::size_t column = 0; column < stride; ++column) {
      const std::uint32_t x = inside(part.x, column, image.width);
      const std::size_t i = row * stride + column;
      const float* from = image.radiance.data() + 3 * (std::size_t{y} * image.width + x);
      std::copy_n(from, 3, values_.data() + 3 * i);
      if (!has_patterns) continue;
      // note: unsigned, so that what lies left of the part or above it is far right or below
      const std::uint32_t left = x - part.x;
      const std::uint32_t top = y - part.y;
      const float mean = left < part.width && top < part.height
                             ? patternless[std::size_t{top} * part.width + left]
                             : -1;
      flat_[i] = mean >= 0;
      if (mean >= 0)
        std::fill_n(means_.data() + 3 * i, 3, mean);
      else
        std::copy_n(from, 3, means_.data() + 3 * i);
    }
  };
  parallel_for(part.height + 2, std::ref(copy_row));

  const std::array<std::size_t, 4> steps{1, stride, stride + 1, stride - 1};
  const auto bend_row = [&](std::size_t row) {
    for (std::size_t i = (row + 1) * stride + 1; i < (row + 2) * stride - 1; ++i) {
      float most = 0;
      for (const std::size_t step : steps) {
        if (has_patterns) {
          most = std::max(most, squared_bend(means_, i, step));
          if (flat_[i] + flat_[i - step] + flat_[i + step] == 3) continue;
        }
        most = std::max(most, squared_bend(values_, i, step));
      }
      bends_[i] = std::sqrt(most * (1.0f / 3));
    }
  };
  parallel_for(part.height, std::ref(bend_row));

  const auto error_row = [&](std::size_t row) {
    for (std::size_t column = 0; column < part.width; ++column) {
      const float* here = bends_.data() + (row + 1) * stride + column + 1;
      float around = 0;
      for (const std::size_t step : steps)
        around = std::max({around, *(here - step), *(here + step)});
      errors[row * part.width + column] = std::max(kShare * *here, kNeighbourShare * around);
    }
  };
  parallel_for(part.height, std::ref(error_row));
}

void ErrorPredictor::look_at_corners(const image::Image& image, std::span<const float> patternless,
                                     const image::Image& corners,
                                     std::span<const float> corner_patternless, const Tile& part,
                                     std::span<float> errors) const {
  const auto look_at_row = [&](std::size_t row) {
    // the last ones have no corners behind them
    const std::size_t below = std::min<std::size_t>(row + 1, part.height - 1);
    for (std::size_t column = 0; column < part.width; ++column) {
      const std::size_t right = std::min<std::size_t>(column + 1, part.width - 1);
      const std::size_t places[4] = {row * part.width + column, below * part.width + right,
                                     row * part.width + right, below * part.width + column};
      const auto in_image = [&](std::size_t place) {
        return (part.y + place / part.width) * image.width + part.x + place % part.width;
      };
      const std::size_t here = places[0];
      bool is_pattern = !patternless.empty() && patternless[here] >= 0;
      for (const std::size_t place : places)
        is_pattern = is_pattern && corner_patternless[place] >= 0;
      float most = 0;
      for (int diagonal = 0; diagonal < 2; ++diagonal) {
        const std::size_t a = places[2 * diagonal];
        const std::size_t b = places[2 * diagonal + 1];
        float squares = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const float bend =
              is_pattern
                  ? corner_patternless[a] + corner_patternless[b] - 2 * patternless[here]
                  : corners.radiance[3 * in_image(a) + k] + corners.radiance[3 * in_image(b) + k] -
                        2 * image.radiance[3 * in_image(here) + k];
          squares += bend * bend;
        }
        most = std::max(most, squares);
      }
      errors[here] = std::max(errors[here], kCornerShare * std::sqrt(most * (1.0f / 3)));
    }
  };
  parallel_for(part.height, std::ref(look_at_row));
}

ImageSums sums_of(const image::Image& image) {
  ImageSums sums;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.coverage[i] == 0) continue;
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = image.radiance[3 * i + k];
      sums.radiance += value;
      squares += value * value;
    }
    sums.squares += squares / 3;
  }
  return sums;
}

double taken_relief(double unit, image::Image& image) {
  double relief = 0;
  double light = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    float& coverage = image.coverage[i];
    if (coverage == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) light += image.radiance[3 * i + k] / 3.0;
    if (!(coverage > 1)) continue;
    relief += (coverage - 1.0) * unit;
    coverage = 1;
  }
  return light > 0 ? relief / light : 0;
}

float least_error_above(std::span<const float> errors, double budget) {
  std::vector<double> squares(kBins, 0.0);
  for (const float error : errors)
    if (error > 0)
      squares[bin_of(error)] += static_cast<double>(error) * static_cast<double>(error);
  double sum = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    sum += squares[bin];
    if (sum > budget) return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << kBinShift);
  }
  return INFINITY;
}

Allocation::Allocation(std::span<const float> errors, std::span<const std::uint8_t> levels,
                       std::span<const unsigned> sides, double budget)
    : sides_(sides) {
  const std::size_t last = sides.size() - 1;
  std::vector<double> squares(last * kCoarseBins, 0.0);
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > 0 && levels[i] < last)
      squares[levels[i] * kCoarseBins +
              (std::bit_cast<std::uint32_t>(errors[i]) >> kCoarseShift)] +=
          static_cast<double>(errors[i]) * static_cast<double>(errors[i]);
  const auto left = [&](float least, std::size_t highest) {
    double sum = 0;
    for (std::size_t at = 0; at < last; ++at)
      for (std::size_t bin = 0; bin < kCoarseBins; ++bin) {
        const double square = squares[at * kCoarseBins + bin];
        if (square == 0) continue;
        const std::size_t to = level_above(least, highest, float_of_coarse(bin), at);
        sum += square * std::pow(static_cast<double>(sides[at]) / sides[to], 2 * kFall);
      }
    return sum;
  };
  highest_ = 1;
  while (highest_ < last && left(0, highest_) > budget) ++highest_;
  // the largest that leaves no more than the budget
  std::size_t low = 0;
  std::size_t high = kCoarseBins - 1;
  while (low < high) {
    const std::size_t middle = (low + high + 1) / 2;
    if (left(float_of_coarse(middle), highest_) <= budget)
      low = middle;
    else
      high = middle - 1;
  }
  least_ = float_of_coarse(low);
}

std::size_t Allocation::level_above(float least, std::size_t highest, float error,
                                    std::size_t level) const {
  if (level >= highest || !(error >= least) || !(error > 0)) return level;
  while (level == 0 && highest > 1 && sides_[highest] > kMostAtOnce) --highest;
  std::size_t to = level + 1;
  if (least == 0) return highest;
  const double more = std::pow(static_cast<double>(error) / static_cast<double>(least), kGrowth);
  while (to < highest && more * sides_[level + 1] >= sides_[to + 1]) ++to;
  return to;
}

}  // namespace panwright::preview
