// Means over independent batches, and their standard errors. Private to preview/reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/math.h"

namespace panwright::preview::reference {

// RGB and coverage.
using Light = Vec4;

// Returns one standard error of the mean of `batches` values with this sum of squared deviations,
// widened by √((n−1)/(n−3)). Errors of a mean divided by it then have an RMS of 1, without
// Student's wide tails for few values. 0 for fewer than four batches.
inline double standard_error(double squares, std::uint32_t batches) {
  if (batches < 4) return 0;
  return std::sqrt(std::max(0.0, squares) / (static_cast<double>(batches) * (batches - 3.0)));
}

// Running mean and squared deviations. B. P. Welford, "Note on a method for calculating corrected
// sums of squares and products", 1962.
class RunningStatistics {
 public:
  explicit RunningStatistics(std::size_t count = 0) : mean_(count), squares_(count) {}

  // round: 1 for the first value of each, 2 for the second…
  void add(std::size_t index, const Light& value, std::uint32_t batch) {
    const Light before = value - mean_[index];
    mean_[index] += before / static_cast<double>(batch);
    squares_[index] += Vec3(before) * Vec3(value - mean_[index]);
  }

  std::size_t size() const { return mean_.size(); }
  const Light& mean(std::size_t index) const { return mean_[index]; }
  // sums of squared deviations of RGB from the mean
  const Vec3& squares(std::size_t index) const { return squares_[index]; }
  Vec3 error(std::size_t index, std::uint32_t batches) const {
    const Vec3& squares = squares_[index];
    return Vec3(standard_error(squares.x, batches), standard_error(squares.y, batches),
                standard_error(squares.z, batches));
  }

 private:
  std::vector<Light> mean_;
  std::vector<Vec3> squares_;
};

}  // namespace panwright::preview::reference
