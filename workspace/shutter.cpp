#include "workspace/shutter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace panwright::workspace {

double Shutter::begin() const {
  return -0.5 * exposure - (stages > 0 ? 0.5 * std::fabs(line_time) * (stages - 1) : 0);
}
double Shutter::end() const { return std::fabs(line_time) * (rows - 1) - begin(); }

ShutterMoments::ShutterMoments(const Shutter& shutter, double speed, double step,
                               std::span<const double> cuts)
    : shutter_(shutter) {
  if (is_scanner()) {
    divide_scan(speed, step);
  } else {
    divide(speed, step);
    if (shutter.line_time != 0) cut(cuts);
  }
}

void ShutterMoments::divide(double speed, double step) {
  const Shutter& shutter = shutter_;
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

// Divides the moments further. Of an image that stands still there is one, of all rows.
void ShutterMoments::cut(std::span<const double> cuts) {
  const double first = length_ > 0 ? first_ : shutter_.begin();
  const double last = std::max(shutter_.end(), first_ + static_cast<double>(count_) * length_);
  std::vector<double> edges{first, last};
  for (std::size_t k = 1; k < count_; ++k)
    edges.push_back(first_ + static_cast<double>(k) * length_);
  const std::size_t whole = edges.size();
  for (const double cut : cuts)
    if (cut > first && cut < last) edges.push_back(cut);
  if (edges.size() == whole) return;
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  edges_ = std::move(edges);
  count_ = edges_.size() - 1;
}

// Times at which the sensor's rows expose, a line time apart, of some moments each.
void ShutterMoments::divide_scan(double speed, double step) {
  const std::size_t times = std::size_t{shutter_.rows} + shutter_.stages - 1;
  const double wanted = std::ceil(speed * shutter_.exposure / step);
  const auto most = static_cast<double>(std::max<std::size_t>(kMostOfScanner / times, 1));
  per_row_ = std::clamp(wanted, 1.0, most);
  length_ = shutter_.exposure / per_row_;
  count_ = times * static_cast<std::size_t>(per_row_);
  step_ = speed * length_;
}

// First row of the image that a moment would expose, were there rows beyond its edges.
std::int64_t ShutterMoments::first_scanned(std::size_t moment) const {
  const auto time = static_cast<std::int64_t>(moment / static_cast<std::size_t>(per_row_));
  return shutter_.line_time > 0 ? time - (std::int64_t{shutter_.stages} - 1)
                                : std::int64_t{shutter_.rows} - 1 - time;
}

double ShutterMoments::sensor_offset(std::size_t moment) const {
  if (!is_scanner()) return 0;
  return 0.5 * (static_cast<double>(shutter_.rows) - shutter_.stages) -
         static_cast<double>(first_scanned(moment));
}

double ShutterMoments::time(std::size_t moment) const {
  if (is_scanner()) {
    const auto parts = static_cast<std::size_t>(per_row_);
    return shutter_.begin() + static_cast<double>(moment / parts) * std::fabs(shutter_.line_time) +
           (static_cast<double>(moment % parts) + 0.5) * length_;
  }
  if (!edges_.empty()) return 0.5 * (edges_[moment] + edges_[moment + 1]);
  return first_ + (static_cast<double>(moment) + 0.5) * length_;
}

double ShutterMoments::begin(std::size_t moment) const {
  return edges_.empty() ? time(moment) - 0.5 * length_ : edges_[moment];
}

double ShutterMoments::end(std::size_t moment) const {
  return edges_.empty() ? time(moment) + 0.5 * length_ : edges_[moment + 1];
}

double ShutterMoments::row_time(std::uint32_t row) const {
  const std::uint32_t place = shutter_.line_time < 0 ? shutter_.rows - 1 - row : row;
  return place * std::fabs(shutter_.line_time);
}

double ShutterMoments::delay(std::uint32_t row) const {
  return length_ == 0 ? 0 : row_time(row) / length_;
}

double ShutterMoments::share(std::size_t moment, std::uint32_t row) const {
  if (is_scanner()) {
    const std::int64_t stage = std::int64_t{row} - first_scanned(moment);
    return stage >= 0 && stage < std::int64_t{shutter_.stages} ? 1 / (per_row_ * shutter_.stages)
                                                               : 0;
  }
  if (!edges_.empty()) return share_of_interval(moment, row);
  const double begin = delay(row);
  const auto at = static_cast<double>(moment);
  // the last one also has what lies after it
  const double end = moment + 1 == count_ ? std::max(at + 1, begin + per_row_) : at + 1;
  constexpr double kNothing = 1e-9;
  const double overlap = std::min(end, begin + per_row_) - std::max(at, begin);
  return overlap > kNothing ? overlap / per_row_ : 0;
}

// Of moments of different lengths.
double ShutterMoments::share_of_interval(std::size_t moment, std::uint32_t row) const {
  const double middle = row_time(row);
  const double low = edges_[moment], high = edges_[moment + 1];
  const double exposure = length_ > 0 ? per_row_ * length_ : shutter_.exposure;
  const bool last = moment + 1 == count_;
  if (exposure == 0) return middle >= low && (middle < high || last) ? 1 : 0;
  const double begin = middle - 0.5 * exposure, end = middle + 0.5 * exposure;
  const double overlap = std::min(last ? end : high, end) - std::max(low, begin);
  constexpr double kNothing = 1e-9;
  return overlap > kNothing * exposure ? std::min(overlap / exposure, 1.0) : 0;
}

ShutterMoments::Rows ShutterMoments::rows(std::size_t moment) const {
  if (is_scanner()) {
    const std::int64_t first = first_scanned(moment);
    return {
        static_cast<std::uint32_t>(std::max<std::int64_t>(first, 0)),
        static_cast<std::uint32_t>(std::min<std::int64_t>(first + shutter_.stages, shutter_.rows))};
  }
  Rows out{shutter_.rows, 0};
  for (std::uint32_t row = 0; row < shutter_.rows; ++row)
    if (share(moment, row) > 0 || middle(row) == moment) {
      out.first = std::min(out.first, row);
      out.end = row + 1;
    }
  return out.end > 0 ? out : Rows{0, 0};
}

std::size_t ShutterMoments::middle(std::uint32_t row) const {
  if (is_scanner()) {
    const std::size_t place = shutter_.line_time < 0 ? shutter_.rows - 1 - row : row;
    const auto parts = static_cast<std::size_t>(per_row_);
    return (place + shutter_.stages / 2) * parts + parts / 2;
  }
  if (!edges_.empty()) {
    const auto after = std::ranges::upper_bound(edges_, row_time(row));
    const auto index = static_cast<std::size_t>(after - edges_.begin());
    return std::clamp<std::size_t>(index, 1, count_) - 1;
  }
  return std::min(static_cast<std::size_t>(delay(row) + 0.5 * per_row_), count_ - 1);
}

}  // namespace panwright::workspace
