#include <algorithm>
#include <cassert>
#include <cmath>

#include "geometry/tessellate/internal/profile.h"

namespace panwright::geometry::internal {

namespace {

// a chord is never measured beyond its curve by more than this much of itself
constexpr double kReach = 0.5;
// steps towards the requested error; two or three are usual
constexpr int kIterations = 12;
constexpr double kMostChords = 4e9;

// A chord between two points of a curve.
struct Chord {
  double begin, end;  // parameters
  double sag;         // how far the curve stands from it, positive where the chord lies inside
};

Chord chord_of(const Curve& curve, double begin, double end) {
  const Vec2 from = curve.at(begin).p;
  const Vec2 along = curve.at(end).p - from;
  const double length = glm::length(along);
  if (!(length > 0)) return {begin, end, 0};
  const Vec2 middle = curve.at(0.5 * (begin + end)).p - from;
  const double sag = curve.largest_cross(begin, end, from, along) / length;
  return {begin, end, along.x * middle.y - along.y * middle.x > 0 ? -sag : sag};
}

// No point of a turned chord, moved to a and b, lies further than this from the turned curve.
//
// At the angle φ from the middle of a segment the mesh is the profile with radii scaled by
// s = cos(half)/cos φ. How far the curve stands from the scaled chord is, before division by the
// chord's length, linear in s, so that the ends s = 1 and s = cos(half) decide.
double chord_error(const Curve& curve, const Chord& chord, const Vec2& a, const Vec2& b,
                   double cos_half, bool edge_a, bool edge_b) {
  const Jet start = curve.at(chord.begin), stop = curve.at(chord.end);
  const Vec2 flat = b - a;
  const double reach = kReach * (chord.end - chord.begin);
  const double shortest = glm::length(Vec2(cos_half * flat.x, flat.y));
  double across = 0, ends = 0, moved = 0;
  bool covered = shortest > 0;
  for (const double s : {1.0, cos_half}) {
    const Vec2 from(s * a.x, a.y), to(s * b.x, b.y);
    const double moved_a = glm::length(from - start.p), moved_b = glm::length(to - stop.p);
    moved = std::max({moved, moved_a, moved_b});
    if (edge_a) ends = std::max(ends, moved_a);
    if (edge_b) ends = std::max(ends, moved_b);
    if (!covered) break;
    const Vec2 along = to - from;
    const double length = glm::length(along);
    // the part of the curve over this chord, a little more to be safe
    const auto shifted = [&](const Jet& jet, double distance) {
      const double forward = glm::dot(jet.d, along) / length;
      const double t = distance / std::max(forward, 0.1 * jet.speed());
      if (!(std::fabs(t) < reach)) covered = false;
      return t > 0 ? 1.05 * t : 0.95 * t;
    };
    const double before = edge_a ? 0 : shifted(start, glm::dot(start.p - from, along) / length);
    const double after = edge_b ? 0 : shifted(stop, glm::dot(to - stop.p, along) / length);
    if (!covered) continue;
    across =
        std::max(across, curve.largest_cross(chord.begin - before, chord.end + after, from, along));
    // note: the ends slide along the curve between the two scales
    const double slide = std::max(a.x * std::sqrt(std::fabs(start.curvature())),
                                  b.x * std::sqrt(std::fabs(stop.curvature()))) *
                         (1 - cos_half) * along.x / length;
    ends = std::max(ends, 0.125 * slide * slide);
  }
  // chords that moved by more than their length: the move and the sag together
  const double worst = covered ? std::max(ends, across / shortest) : moved + std::fabs(chord.sag);
  return worst * (1 + 1e-12);
}

class Layer {
 public:
  Layer(const Curve& curve, const CurveSamples& samples, const ChordSettings& settings)
      : curve_(curve), samples_(samples), set_(settings) {
    const double s = det::sin(0.5 * set_.half);
    cos_half_ = 1 - 2 * s * s;
    dip_ = segment_dip(set_.half, set_.balanced);
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
  std::vector<double> placed(double half_range, std::size_t least) const {
    const Density density = samples_.density(half_range, dip_, set_.balanced);
    const double lost_first = 1 - end_length(curve_.begin(), set_.first, half_range);
    const double lost_last = 1 - end_length(curve_.end(), set_.last, half_range);
    const double lost = lost_first + lost_last;
    const double wanted = std::ceil((density.total() + lost) * (1 - 1e-12));
    const auto needed = static_cast<std::size_t>(std::clamp(wanted, 1.0, kMostChords));
    const std::size_t count = std::max({needed, least, std::size_t{least_}});
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
    std::vector<Chord> chords(count);
    for (std::size_t i = 0; i < count; ++i) chords[i] = chord_of(curve_, t[i], t[i + 1]);
    result.points.resize(count + 1);
    const double whole = samples_.length();
    for (std::size_t i = 0; i <= count; ++i) {
      result.points[i] = point(chords, t[i], i);
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
          chord_error(curve_, chords[i], {p.radius, p.z}, {q.radius, q.z}, cos_half_,
                      i == 0 && set_.first == End::edge, i + 1 == count && set_.last == End::edge);
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
  // The length of the chord at an end, against the others: circular edges do not balance, so it is
  // shorter.
  double end_length(double t, End end, double half_range) const {
    if (end != End::edge || !set_.balanced) return 1;
    const Jet jet = curve_.at(t);
    const double lever = jet.p.x * jet.normal().x;
    const double dip = lever * dip_;
    const double sag = 2 * half_range - std::fabs(dip);
    if (!(sag > 0)) return 0.5;
    const double side = jet.curvature() < 0 ? -1 : 1;
    const double middle = 0.5 * (lever * (set_.edge_factor - 1) + 0.5 * (dip + side * sag));
    const double room = half_range - std::max(side * dip, 0.0) + side * middle;
    return std::sqrt(std::clamp(room / sag, 0.05, 1.0));
  }

  // Where a vertex goes. Balanced: outwards from the axis by half of what segments dip, and along
  // the normal by half of the sag of its chords.
  ProfilePoint point(const std::vector<Chord>& chords, double t, std::size_t i) const {
    const bool first = i == 0, last = i == chords.size();
    const Jet jet = curve_.at(t);
    const End end = first ? set_.first : last ? set_.last : End::loop;
    const Vec2 n = jet.normal();
    if (end == End::edge) return {jet.p.x * set_.edge_factor, jet.p.y, n, 0};
    const double before = first && end != End::loop ? chords.front().sag
                          : first                   ? chords.back().sag
                                                    : chords[i - 1].sag;
    const double after = last && end != End::loop ? chords.back().sag
                         : last                   ? chords.front().sag
                                                  : chords[i].sag;
    double out = set_.balanced ? 0.25 * (before + after) : 0;
    if (end == End::pole) {
      const double up = n.y < 0 ? -1 : 1;
      return {0, jet.p.y + up * out, {0, up}, 0};
    }
    // note: not across the axis
    if (out * n.x < 0) {
      const double most = jet.p.x / (2 * std::fabs(n.x));
      out = std::clamp(out, -most, most);
    }
    const double factor = set_.balanced ? 1 + 0.5 * dip_ : 1;
    return {factor * jet.p.x + out * n.x, jet.p.y + out * n.y, n, 0};
  }

  const Curve& curve_;
  const CurveSamples& samples_;
  const ChordSettings& set_;
  double dip_, cos_half_;
  std::uint32_t least_;
};

}  // namespace

double segment_dip(double half, bool balanced) {
  const double s = det::sin(0.5 * half);
  const double dip = 2 * s * s;
  return balanced ? 2 * dip / (2 - dip) : dip;
}

Chords laid_chords(const Curve& curve, const CurveSamples& samples, const ChordSettings& settings) {
  const Layer layer(curve, samples, settings);
  if (settings.count != 0) return layer.chords(layer.even(settings.count));
  double target = settings.half_range;
  Chords result = layer.chords(layer.placed(target, 1));
  if (!layer.attainable()) return result;
  for (int i = 0; i < kIterations && result.error > settings.half_range; ++i) {
    target *= std::clamp(0.998 * settings.half_range / result.error, 0.5, 0.995);
    result = layer.chords(layer.placed(target, result.points.size()));
  }
  return result;
}

}  // namespace panwright::geometry::internal
