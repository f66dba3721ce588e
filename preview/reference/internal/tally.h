// Means over independent rounds, and what they tell of their errors. Private to preview/reference.
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

// One standard error of the mean of `rounds` values with this sum of squared deviations, widened by
// √((n−1)/(n−3)): errors of a mean divided by it have an RMS of 1, where those divided by the usual
// estimate, of few values, have Student's wide tails. 0 for fewer than four rounds.
inline double standard_error(double squares, std::uint32_t rounds) {
  if (rounds < 4) return 0;
  return std::sqrt(std::max(0.0, squares) / (static_cast<double>(rounds) * (rounds - 3.0)));
}

// B. P. Welford, "Note on a method for calculating corrected sums of squares and products", 1962.
class Tally {
 public:
  explicit Tally(std::size_t count = 0) : mean_(count), squares_(count) {}

  // round: 1 for the first value of each, 2 for the second…
  void add(std::size_t index, const Light& value, std::uint32_t round) {
    const Light before = value - mean_[index];
    mean_[index] += before / static_cast<double>(round);
    squares_[index] += Vec3(before) * Vec3(value - mean_[index]);
  }

  std::size_t size() const { return mean_.size(); }
  const Light& mean(std::size_t index) const { return mean_[index]; }
  Vec3 error(std::size_t index, std::uint32_t rounds) const {
    const Vec3& squares = squares_[index];
    return Vec3(standard_error(squares.x, rounds), standard_error(squares.y, rounds),
                standard_error(squares.z, rounds));
  }

 private:
  std::vector<Light> mean_;
  std::vector<Vec3> squares_;
};

}  // namespace panwright::preview::reference
