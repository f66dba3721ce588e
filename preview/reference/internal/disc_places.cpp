#include "preview/reference/internal/disc_places.h"

#include <algorithm>
#include <cmath>

#include "preview/reference/internal/sampling.h"

namespace panwright::preview::reference {
namespace {

// A density on [low, high] that is never much below exp(-((x - centre)/width)²) over its integral:
// beyond the centre an exponential as steep as the Gaussian is at the nearer end, else Student's
// with two degrees of freedom. Both have inverses in closed form.
class Flank {
 public:
  Flank(double centre, double width, double low, double high)
      : centre_(centre), width_(width), low_(low), high_(high) {
    const double before = (low - centre) / width;   // > 0: the centre lies below
    const double behind = (centre - high) / width;  // > 0: it lies above
    if (std::max(before, behind) > 1) {
      rate_ = 2 * std::max(before, behind) / width;
      from_high_ = behind > before;
      norm_ = 1 - det::exp(-rate_ * (high - low));
      return;
    }
    first_ = spread((low - centre) / width);
    last_ = spread((high - centre) / width);
  }

  double sample(double u) const {
    if (rate_ > 0) {
      const double depth = std::clamp(-det::log(1 - u * norm_) / rate_, 0.0, high_ - low_);
      return from_high_ ? high_ - depth : low_ + depth;
    }
    const double s = first_ + u * (last_ - first_);
    const double t = s * std::sqrt(2 / std::max(1 - s * s, 1e-12));
    return std::clamp(centre_ + width_ * t, low_, high_);
  }
  double pdf(double x) const {
    if (rate_ > 0) return rate_ / norm_ * det::exp(-rate_ * (from_high_ ? high_ - x : x - low_));
    const double t = (x - centre_) / width_;
    const double square = 2 + t * t;
    return 2 / (square * std::sqrt(square) * width_ * (last_ - first_));
  }

 private:
  // t/sqrt(2 + t²), whose derivative is 2/(2 + t²)^(3/2)
  static double spread(double t) { return t / std::sqrt(2 + t * t); }

  double centre_, width_, low_, high_;
  double rate_ = 0;
  bool from_high_ = false;
  double norm_ = 1;
  double first_ = 0, last_ = 1;
};

constexpr double kRim = 1 - 1e-9;

Flank across_of(const materials::DiscLobe& lobe) {
  const double centre = glm::dot(lobe.peak, lobe.axis);
  return {centre, lobe.narrow, -kRim, kRim};
}

Flank along_of(const materials::DiscLobe& lobe, double across) {
  const double half = std::sqrt((1 - across) * (1 + across));
  return {lobe.peak.y * lobe.axis.x - lobe.peak.x * lobe.axis.y, lobe.wide, -half, half};
}

// Whether only the flank of a lobe lies on the disc, and falls by e⁴ there. Others are found by
// even places, and by directions that the lobe draws.
bool is_flank(const materials::DiscLobe& lobe) {
  const double centres[] = {std::fabs(glm::dot(lobe.peak, lobe.axis)),
                            std::fabs(lobe.peak.y * lobe.axis.x - lobe.peak.x * lobe.axis.y)};
  const double widths[] = {lobe.narrow, lobe.wide};
  double nearest = 0, fall = 0;
  for (int i = 0; i < 2; ++i) {
    const double beside = std::max(centres[i] - 1, 0.0) / widths[i];
    const double far = (centres[i] + 1) / widths[i];
    nearest += beside * beside;
    fall += (far - beside) * (far + beside);
  }
  return nearest > 0 && fall > 4;
}

}  // namespace

DiscPlaces::DiscPlaces(const materials::DiscLobes& lobes) {
  for (int i = 0; i < lobes.count; ++i) {
    const materials::DiscLobe& lobe = lobes.all[static_cast<std::size_t>(i)];
    if (is_flank(lobe)) lobes_.all[static_cast<std::size_t>(lobes_.count++)] = lobe;
  }
}

Vec2 DiscPlaces::sample(const Vec2& u) const {
  const int ways = lobes_.count + 1;
  const double scaled = u.x * ways;
  const int way = std::min(static_cast<int>(scaled), ways - 1);
  const Vec2 rest(std::clamp(scaled - way, 1e-12, 1 - 1e-12), u.y);
  if (way == 0) return on_disc(rest);
  const materials::DiscLobe& lobe = lobes_.all[static_cast<std::size_t>(way - 1)];
  const double across = across_of(lobe).sample(rest.x);
  const double along = along_of(lobe, across).sample(rest.y);
  return {across * lobe.axis.x - along * lobe.axis.y, across * lobe.axis.y + along * lobe.axis.x};
}

double DiscPlaces::pdf(const Vec2& place) const {
  if (!(glm::dot(place, place) < 1)) return 0;
  double sum = 1 / kPi;
  for (int i = 0; i < lobes_.count; ++i) {
    const materials::DiscLobe& lobe = lobes_.all[static_cast<std::size_t>(i)];
    const double across = std::clamp(glm::dot(place, lobe.axis), -kRim, kRim);
    const double along = place.y * lobe.axis.x - place.x * lobe.axis.y;
    sum += across_of(lobe).pdf(across) * along_of(lobe, across).pdf(along);
  }
  return sum / (lobes_.count + 1);
}

}  // namespace panwright::preview::reference
