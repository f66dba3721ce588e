#include "sky/internal/pixel_shares.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace panwright::sky {

PixelShares::PixelShares(double sigma, std::size_t uses) : sigma_(sigma) {
  if (sigma == 0) return;
  constexpr double kNodes = 64;  // a sigma: cubics between them are within (1/64)^4·0.55/384
  const double nodes = std::ceil(kNodes / sigma) + 1;
  if (!(nodes < static_cast<double>(uses))) return;
  nodes_ = static_cast<std::size_t>(nodes);
  low_ = static_cast<std::int64_t>(std::floor(-kReach * sigma));
  const auto high = static_cast<std::int64_t>(std::floor(1 + kReach * sigma)) + 1;
  edges_ = static_cast<std::size_t>(high - low_ + 1);
  const double scale = 1 / (sigma * std::numbers::sqrt2);
  const double peak = scale / std::sqrt(std::numbers::pi) / nodes;
  for (std::size_t j = 0; j <= nodes_; ++j)
    for (std::int64_t edge = low_; edge <= high; ++edge) {
      const double at = (static_cast<double>(edge) - static_cast<double>(j) / nodes) * scale;
      values_.push_back(0.5 * std::erf(at));
      slopes_.push_back(-peak * std::exp(-at * at));  // a node's distance
    }
}

void PixelShares::find(double centre, Shares& out) const {
  out.first = static_cast<std::int64_t>(std::floor(centre - kReach * sigma_));
  const auto last = static_cast<std::int64_t>(std::floor(centre + kReach * sigma_));
  const auto count = static_cast<std::size_t>(last - out.first + 1);
  out.of.resize(count);
  if (sigma_ == 0) {
    out.of[0] = 1;
    return;
  }
  if (nodes_ == 0) {
    const double scale = 1 / (sigma_ * std::numbers::sqrt2);
    double before = std::erf((static_cast<double>(out.first) - centre) * scale);
    for (std::size_t i = 0; i < count; ++i) {
      const double after = std::erf(
          (static_cast<double>(out.first + static_cast<std::int64_t>(i) + 1) - centre) * scale);
      out.of[i] = 0.5 * (after - before);
      before = after;
    }
    return;
  }
  const double whole = std::floor(centre);
  const double place = (centre - whole) * static_cast<double>(nodes_);
  const auto node = std::min(static_cast<std::size_t>(place), nodes_ - 1);
  const double t = place - static_cast<double>(node);
  // cubics of Hermite
  const double t2 = t * t, t3 = t2 * t;
  const double late = 3 * t2 - 2 * t3, early = 1 - late, leave = t3 - 2 * t2 + t, meet = t3 - t2;
  const auto skipped =
      static_cast<std::size_t>(out.first - static_cast<std::int64_t>(whole) - low_);
  const double* value = values_.data() + node * edges_ + skipped;
  const double* slope = slopes_.data() + node * edges_ + skipped;
  const auto at = [&](std::size_t i) {
    return early * value[i] + late * value[edges_ + i] + leave * slope[i] +
           meet * slope[edges_ + i];
  };
  double before = at(0);
  for (std::size_t i = 0; i < count; ++i) {
    const double after = at(i + 1);
    out.of[i] = after - before;
    before = after;
  }
}

}  // namespace panwright::sky
