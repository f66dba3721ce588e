#include "workspace/shutter.h"

#include <algorithm>
#include <cmath>

namespace panwright::workspace {

double Shutter::begin() const { return -0.5 * exposure; }
double Shutter::end() const { return std::fabs(line_time) * (rows - 1) + 0.5 * exposure; }

ShutterMoments::ShutterMoments(const Shutter& shutter, double speed, double step)
    : shutter_(shutter) {
  const double delays = shutter.end() - 0.5 * shutter.exposure;
  const double motion = speed * (shutter.end() - shutter.begin());
  // what moves less than rounding is drawn once
  constexpr double kStill = 1e-9;
  if (!(motion > kStill)) return;
  double exposure = shutter.exposure;
  if (delays > 0) exposure = std::max(exposure, kLeastBlur * step / speed);
  per_row_ = std::max(1.0, std::ceil(speed * exposure / step));
  // the middle of an image at once is the middle of a moment
  if (delays == 0 && std::fmod(per_row_, 2) == 0) ++per_row_;
  constexpr double kMostMoments = kMost;
  if (exposure + delays > kMostMoments * (exposure / per_row_)) {
    per_row_ = std::max(1.0, std::floor((kMostMoments - 1) * exposure / (exposure + delays)));
    if (delays == 0 && std::fmod(per_row_, 2) == 0) --per_row_;
    // one moment a row's exposure: that is as long as they are
    if (per_row_ == 1) exposure = std::max(exposure, delays / (kMostMoments - 1));
  }
  // one that is longer than asked ends with the last moment
  if (exposure > shutter.exposure)
    exposure = per_row_ * delays / std::ceil(per_row_ * delays / exposure);
  length_ = exposure / per_row_;
  first_ = -0.5 * exposure;
  // a quotient of roundings adds no moment
  constexpr double kSlack = 1e-6;
  count_ =
      static_cast<std::size_t>(std::max(per_row_, std::ceil(per_row_ + delays / length_ - kSlack)));
  step_ = speed * length_;
}

double ShutterMoments::time(std::size_t moment) const {
  return first_ + (static_cast<double>(moment) + 0.5) * length_;
}

double ShutterMoments::delay(std::uint32_t row) const {
  if (length_ == 0) return 0;
  const std::uint32_t place = shutter_.line_time < 0 ? shutter_.rows - 1 - row : row;
  return place * std::fabs(shutter_.line_time) / length_;
}

double ShutterMoments::share(std::size_t moment, std::uint32_t row) const {
  const double begin = delay(row);
  const auto at = static_cast<double>(moment);
  // the last one also has what lies after it
  const double end = moment + 1 == count_ ? std::max(at + 1, begin + per_row_) : at + 1;
  constexpr double kNothing = 1e-9;
  const double overlap = std::min(end, begin + per_row_) - std::max(at, begin);
  return overlap > kNothing ? overlap / per_row_ : 0;
}

ShutterMoments::Rows ShutterMoments::rows(std::size_t moment) const {
  Rows out{shutter_.rows, 0};
  for (std::uint32_t row = 0; row < shutter_.rows; ++row)
    if (share(moment, row) > 0 || middle(row) == moment) {
      out.first = std::min(out.first, row);
      out.end = row + 1;
    }
  return out.end > 0 ? out : Rows{0, 0};
}

std::size_t ShutterMoments::middle(std::uint32_t row) const {
  return std::min(static_cast<std::size_t>(delay(row) + 0.5 * per_row_), count_ - 1);
}

}  // namespace panwright::workspace
