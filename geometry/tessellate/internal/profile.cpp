#include "geometry/tessellate/internal/profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace panwright::geometry::internal {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// nodes of an arc for a whole turn, of a cubic, and the depth to which they are halved
constexpr int kArcNodes = 48;
constexpr int kCubicNodes = 8;
constexpr int kDepth = 30;
// an interval is halved while its middle is this far from linear, and holds this share of the whole
constexpr double kNonlinearity = 0.03;
constexpr double kShare = 1e-4;

}  // namespace

double Jet::speed() const { return glm::length(d); }

Vec2 Jet::normal() const {
  const double length = speed();
  return {d.y / length, -d.x / length};
}

double Jet::curvature() const {
  const double length = speed();
  return cross(d, dd) / (length * length * length);
}

Curve Curve::arc(const Vec2& centre, double radius, double begin, double end) {
  Curve curve;
  curve.begin_ = begin;
  curve.end_ = end;
  curve.loop_ = end - begin == 2 * kPi;
  curve.centre_ = centre;
  curve.radius_ = radius;
  const int nodes = 4 + static_cast<int>(kArcNodes * (end - begin) / (2 * kPi));
  for (int i = 0; i <= nodes; ++i)
    curve.knots_.push_back(begin + (end - begin) * (static_cast<double>(i) / nodes));
  return curve;
}

Curve Curve::cubics(std::vector<Cubic> pieces, bool loop) {
  Curve curve;
  curve.begin_ = 0;
  curve.end_ = static_cast<double>(pieces.size());
  curve.loop_ = loop;
  curve.pieces_ = std::move(pieces);
  const std::size_t nodes = kCubicNodes * curve.pieces_.size();
  curve.knots_.reserve(nodes + 1);
  for (std::size_t i = 0; i <= nodes; ++i)
    curve.knots_.push_back(static_cast<double>(i) / kCubicNodes);
  return curve;
}

Jet Curve::at(double t) const {
  if (pieces_.empty()) {
    const det::SinCos angle = det::sincos(t);
    const Vec2 out(angle.cos, angle.sin);
    const Vec2 forward(-angle.sin, angle.cos);
    return {centre_ + radius_ * out, radius_ * forward, -radius_ * out};
  }
  const double count = end_;
  if (loop_ && !(t >= 0 && t < count)) t -= count * std::floor(t / count);
  const auto piece = static_cast<std::size_t>(std::clamp(std::floor(t), 0.0, count - 1));
  const double x = t - static_cast<double>(piece);
  const Cubic& c = pieces_[piece];
  return {c[0] + x * (c[1] + x * (c[2] + x * c[3])), c[1] + x * (2.0 * c[2] + 3 * x * c[3]),
          2.0 * c[2] + 6 * x * c[3]};
}

double Curve::largest_cross(double first, double last, const Vec2& from, const Vec2& along) const {
  double worst = 0;
  const auto look = [&](double t) {
    worst = std::max(worst, std::fabs(cross(at(t).p - from, along)));
  };
  look(first);
  look(last);
  // inside, the extremes are where the curve runs parallel
  if (pieces_.empty()) {
    const double angle = det::atan2(-along.x, along.y);
    for (double t = angle + kPi * std::ceil((first - angle) / kPi); t < last; t += kPi) look(t);
    return worst;
  }
  const double count = end_;
  double begin = std::floor(first);
  if (!loop_) begin = std::clamp(begin, 0.0, count - 1);
  for (double base = begin; base < last && (loop_ || base < count); ++base) {
    const auto piece = static_cast<std::size_t>(base - count * std::floor(base / count));
    const Cubic& c = pieces_[piece];
    const double c0 = cross(c[1], along), c1 = 2 * cross(c[2], along), c2 = 3 * cross(c[3], along);
    const double root = c1 * c1 - 4 * c0 * c2;
    if (root < 0) continue;
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(root), c1));
    for (const double t : {base + c0 / q, base + q / c2})
      if (t > first && t < last) look(t);
  }
  return worst;
}

Density::Density(std::vector<double> t, std::vector<double> value)
    : t_(std::move(t)), value_(std::move(value)), sum_(t_.size(), 0.0) {
  for (std::size_t i = 1; i < t_.size(); ++i)
    sum_[i] = sum_[i - 1] + 0.5 * (value_[i - 1] + value_[i]) * (t_[i] - t_[i - 1]);
}

double Density::place(double share) const {
  const double wanted = share * total();
  if (!(wanted > 0)) return t_.front() + share * (t_.back() - t_.front());
  if (wanted >= total()) return t_.back();
  const auto above = std::upper_bound(sum_.begin(), sum_.end(), wanted);
  const auto i = static_cast<std::size_t>(above - sum_.begin()) - 1;
  const double area = wanted - sum_[i];
  const double slope = (value_[i + 1] - value_[i]) / (t_[i + 1] - t_[i]);
  const double root = std::sqrt(std::max(0.0, value_[i] * value_[i] + 2 * area * slope));
  const double step = value_[i] + root > 0 ? 2 * area / (value_[i] + root) : 0.0;
  return std::min(t_[i] + step, t_[i + 1]);
}

CurveSamples::CurveSamples(const Curve& curve) {
  const auto bend = [](const Jet& jet) {
    return std::sqrt(std::fabs(jet.curvature()) / 8) * jet.speed();
  };
  const auto add = [&](double t, const Jet& jet) {
    const Vec2 n = jet.normal();
    t_.push_back(t);
    bend_.push_back(bend(jet));
    lever_.push_back(std::fabs(jet.p.x * n.x));
    inward_.push_back(n.x < -1e-9 ? jet.p.x / (-2 * n.x) : std::numeric_limits<double>::infinity());
    largest_lever_ = std::max(largest_lever_, lever_.back());
    low_ = t_.size() == 1 ? jet.p : glm::min(low_, jet.p);
    high_ = t_.size() == 1 ? jet.p : glm::max(high_, jet.p);
  };
  const std::vector<double>& knots = curve.knots();
  double rough = 0;
  for (std::size_t i = 1; i < knots.size(); ++i)
    rough += bend(curve.at(0.5 * (knots[i - 1] + knots[i]))) * (knots[i] - knots[i - 1]);
  struct Span {
    double end;
    Jet jet;
    int depth;
  };
  std::vector<Span> todo;
  Jet jet = curve.at(knots.front());
  for (std::size_t i = 1; i < knots.size(); ++i) {
    // note: where cubics meet both the speed and the bend may jump
    jet = curve.at(knots[i - 1]);
    add(knots[i - 1], jet);
    todo.push_back({knots[i], curve.at(std::nextafter(knots[i], knots[i - 1])), 0});
    while (!todo.empty()) {
      const Span span = todo.back();
      const double begin = t_.back();
      const double middle = 0.5 * (begin + span.end);
      const Jet between = curve.at(middle);
      const double low = bend(jet), high = bend(span.jet), mid = bend(between);
      const double most = std::max({low, high, mid});
      if (span.depth < kDepth && std::fabs(mid - 0.5 * (low + high)) > kNonlinearity * most &&
          most * (span.end - begin) > kShare * rough) {
        todo.back().depth = span.depth + 1;
        todo.push_back({middle, between, span.depth + 1});
        continue;
      }
      todo.pop_back();
      add(span.end, span.jet);
      jet = span.jet;
    }
  }
  length_at_.assign(t_.size(), 0);
  for (std::size_t i = 1; i < t_.size(); ++i) {
    length_at_[i] = length_at_[i - 1];
    const double step = t_[i] - t_[i - 1];
    if (step == 0) continue;
    // Gauss's rule of two points
    const double offset = 0.5 * step / std::sqrt(3.0);
    const double middle = t_[i - 1] + 0.5 * step;
    length_at_[i] +=
        0.5 * step * (curve.at(middle - offset).speed() + curve.at(middle + offset).speed());
  }
  length_ = length_at_.back();
}

double CurveSamples::allowed(std::size_t i, double half_range, double dip, bool balanced) const {
  // what vertices may stand out, and what is left for chords after segments
  const double outside = balanced ? std::min(half_range, inward_[i]) : 0.0;
  return std::max(half_range + outside - lever_[i] * dip, 0.25 * half_range);
}

Density CurveSamples::density(double half_range, double dip, bool balanced) const {
  std::vector<double> value(t_.size());
  for (std::size_t i = 0; i < t_.size(); ++i)
    value[i] = bend_[i] / std::sqrt(allowed(i, half_range, dip, balanced));
  return {t_, std::move(value)};
}

double CurveSamples::chords(double half_range, double dip, bool balanced) const {
  double sum = 0, before = 0;
  for (std::size_t i = 0; i < t_.size(); ++i) {
    const double value = bend_[i] / std::sqrt(allowed(i, half_range, dip, balanced));
    if (i > 0) sum += 0.5 * (before + value) * (t_[i] - t_[i - 1]);
    before = value;
  }
  return sum;
}

double CurveSamples::length_to(double t) const {
  if (t <= t_.front()) return 0;
  if (t >= t_.back()) return length_;
  const auto above = std::upper_bound(t_.begin(), t_.end(), t);
  const auto i = static_cast<std::size_t>(above - t_.begin()) - 1;
  const double share = (t - t_[i]) / (t_[i + 1] - t_[i]);
  return length_at_[i] + share * (length_at_[i + 1] - length_at_[i]);
}

}  // namespace panwright::geometry::internal
