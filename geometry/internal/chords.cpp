#include <algorithm>
#include <cassert>
#include <cmath>

#include "geometry/internal/profile.h"

namespace panwright::geometry::internal {

namespace {

// a chord is never measured beyond its curve by more than this much of itself
constexpr double kReach = 0.5;
// steps towards the error asked for; two or three are usual
constexpr int kIterations = 24;
constexpr double kMostChords = 4e9;

// No point of a turned chord from a to b lies further than this from the turned curve.
//
// At the angle φ from the middle of a segment the mesh is the profile with radii scaled by
// s = cos(half)/cos φ. How far the curve stands from the scaled chord is, before division by the
// chord's length, linear in s, so that the ends s = 1 and s = cos(half) decide.
double chord_error(const Curve& curve, double ta, double tb, const Vec2& a, const Vec2& b,
                   double cos_half, bool rim_a, bool rim_b) {
  const Jet start = curve.at(ta), stop = curve.at(tb);
  const Vec2 flat = b - a;
  const double shortest = glm::length(Vec2(cos_half * flat.x, flat.y));
  double worst = 0, ends = 0;
  for (const double s : {1.0, cos_half}) {
    const Vec2 from(s * a.x, a.y), to(s * b.x, b.y);
    if (rim_a) ends = std::max(ends, glm::length(from - start.p));
    if (rim_b) ends = std::max(ends, glm::length(to - stop.p));
    const Vec2 along = to - from;
    const double length = glm::length(along);
    if (!(length > 0)) {
      ends = std::max({ends, glm::length(from - start.p), glm::length(to - stop.p)});
      continue;
    }
    // the part of the curve over this chord, a little more to be safe
    const auto shifted = [&](const Jet& jet, double distance) {
      const double forward = glm::dot(jet.d, along) / length;
      const double t = distance / std::max(forward, 0.3 * jet.speed());
      return std::clamp(t > 0 ? 1.05 * t : 0.95 * t, -kReach * (tb - ta), kReach * (tb - ta));
    };
    const double before = rim_a ? 0 : shifted(start, glm::dot(start.p - from, along) / length);
    const double after = rim_b ? 0 : shifted(stop, glm::dot(to - stop.p, along) / length);
    const double first = ta - before;
    const double last = std::max(first, tb + after);
    worst = std::max(worst, curve.largest_cross(first, last, from, along));
    // note: where the ends slide along the curve between the two scales
    const double slide_a = a.x * (1 - cos_half) * along.x / length;
    const double slide_b = b.x * (1 - cos_half) * along.x / length;
    worst = std::max(worst, shortest * 0.125 *
                                std::max(slide_a * slide_a * std::fabs(start.curvature()),
                                         slide_b * slide_b * std::fabs(stop.curvature())));
  }
  return std::max(ends, shortest > 0 ? worst / shortest : 0.0) * (1 + 1e-12);
}

class Layer {
 public:
  Layer(const Curve& curve, const CurveSamples& samples, const ChordSettings& settings)
      : curve_(curve), samples_(samples), set_(settings) {
    const double s = det::sin(0.5 * set_.half);
    dip_ = 2 * s * s;
    cos_half_ = 1 - dip_;
    least_ = set_.first == End::loop                             ? 3
             : set_.first == End::pole && set_.last == End::pole ? 2
                                                                 : 1;
  }

  // equal steps of the parameter
  std::vector<double> even(std::uint32_t count) const {
    std::vector<double> t(std::size_t{count} + 1);
    for (std::size_t i = 0; i <= count; ++i)
      t[i] = curve_.begin() + (curve_.end() - curve_.begin()) * (static_cast<double>(i) / count);
    t.back() = curve_.end();
    return t;
  }

  // as many as the error needs
  std::vector<double> placed(double half_range) const {
    const Density density = samples_.density(half_range, dip_, set_.balanced);
    const double lost_first = 1 - end_length(curve_.begin(), set_.first, half_range);
    const double lost_last = 1 - end_length(curve_.end(), set_.last, half_range);
    const double lost = lost_first + lost_last;
    const double wanted = std::ceil((density.total() + lost) * (1 - 1e-12));
    const auto count =
        static_cast<std::size_t>(std::clamp(wanted, static_cast<double>(least_), kMostChords));
    std::vector<double> t(count + 1);
    for (std::size_t i = 1; i < count; ++i)
      t[i] = density.place((static_cast<double>(i) - lost_first) /
                           (static_cast<double>(count) - lost));
    t.front() = curve_.begin();
    t.back() = curve_.end();
    return t;
  }

  Chords chords(std::vector<double> t) const {
    Chords result;
    const std::size_t count = t.size() - 1;
    result.points.resize(count + 1);
    const double whole = samples_.length();
    for (std::size_t i = 0; i <= count; ++i) {
      result.points[i] = point(t, i);
      result.points[i].v = samples_.length_to(t[i]) / whole;
    }
    if (set_.first == End::loop) {
      const double v = result.points.back().v;
      result.points.back() = result.points.front();
      result.points.back().v = v;
    }
    result.error = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const ProfilePoint& p = result.points[i];
      const ProfilePoint& q = result.points[i + 1];
      const double error =
          chord_error(curve_, t[i], t[i + 1], {p.radius, p.z}, {q.radius, q.z}, cos_half_,
                      i == 0 && set_.first == End::rim, i + 1 == count && set_.last == End::rim);
      result.error = std::max(result.error, error);
    }
    result.t = std::move(t);
    return result;
  }

  // whether finer chords can reach the error that segments leave
  bool attainable() const {
    const double room = (set_.balanced ? 2 : 1) * set_.half_range;
    return samples_.largest_lever() * dip_ < 0.95 * room;
  }

 private:
  // The length of the chord at an end, against the others: rims do not balance, so it is shorter.
  double end_length(double t, End end, double half_range) const {
    if (end != End::rim || !set_.balanced) return 1;
    const Jet jet = curve_.at(t);
    const double lever = jet.p.x * jet.normal().x;
    const double dip = lever * dip_;
    const double sag = 2 * half_range - std::fabs(dip);
    if (!(sag > 0)) return 0.5;
    const double side = jet.curvature() < 0 ? -1 : 1;
    const double middle = 0.5 * (lever * (set_.rim_factor - 1) + 0.5 * (dip + side * sag));
    const double room = half_range - std::max(side * dip, 0.0) + side * middle;
    return std::sqrt(std::clamp(room / sag, 0.05, 1.0));
  }

  // How far the chords at a vertex stand from the curve: of a circle with the curve's bend there.
  double sag(const std::vector<double>& t, std::size_t i, const Jet& jet) const {
    const std::size_t count = t.size() - 1;
    const bool loop = set_.first == End::loop;
    double before = 0, after = 0;
    if (i > 0 || loop) before = glm::length(jet.p - curve_.at(i > 0 ? t[i - 1] : t[count - 1]).p);
    if (i < count || loop) after = glm::length(curve_.at(i < count ? t[i + 1] : t[1]).p - jet.p);
    if (before == 0) before = after;
    if (after == 0) after = before;
    const double chord = 0.5 * (before + after);
    const double bend = jet.curvature();
    const double root = std::sqrt(std::max(0.0, 1 - 0.25 * bend * bend * chord * chord));
    return 0.25 * bend * chord * chord / (1 + root);
  }

  ProfilePoint point(const std::vector<double>& t, std::size_t i) const {
    const std::size_t count = t.size() - 1;
    const bool first = i == 0, last = i == count;
    const Jet jet = curve_.at(t[i]);
    const End end = first ? set_.first : last ? set_.last : End::loop;
    const bool on_end = first || last;
    const Vec2 n = jet.normal();
    if (on_end && end == End::rim) return {jet.p.x * set_.rim_factor, jet.p.y, n, 0};
    double out = 0;
    if (set_.balanced) {
      out = 0.5 * (jet.p.x * n.x * dip_ + sag(t, i, jet));
      // note: not across the axis
      if (out * n.x < 0) {
        const double most = jet.p.x / (2 * std::fabs(n.x));
        out = std::clamp(out, -most, most);
      }
    }
    if (on_end && end == End::pole) {
      const double up = n.y < 0 ? -1 : 1;
      return {0, jet.p.y + up * out, {0, up}, 0};
    }
    const Vec2 p = jet.p + out * n;
    return {p.x, p.y, n, 0};
  }

  const Curve& curve_;
  const CurveSamples& samples_;
  const ChordSettings& set_;
  double dip_, cos_half_;
  std::uint32_t least_;
};

}  // namespace

Chords laid_chords(const Curve& curve, const CurveSamples& samples, const ChordSettings& settings) {
  const Layer layer(curve, samples, settings);
  if (settings.count != 0) return layer.chords(layer.even(settings.count));
  double target = settings.half_range;
  Chords result = layer.chords(layer.placed(target));
  if (!layer.attainable()) return result;
  for (int i = 0; i < kIterations && result.error > settings.half_range; ++i) {
    target *= std::clamp(0.998 * settings.half_range / result.error, 0.5, 0.995);
    result = layer.chords(layer.placed(target));
  }
  return result;
}

}  // namespace panwright::geometry::internal
