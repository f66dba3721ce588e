#include "geometry/tessellate/internal/tube_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/tessellate/internal/circle.h"

namespace panwright::geometry::internal {

namespace {

// A sum of four harmonics from its values at eighths of a turn: their bounds over the whole turn.
void bounds_of(const std::array<double, 8>& value, double& low, double& high) {
  constexpr double kRoot = 0.70710678118654752;
  constexpr int kAngles = 24;
  static const std::array<std::array<double, 7>, kAngles> kTable = [] {
    std::array<std::array<double, 7>, kAngles> table{};
    for (int i = 0; i < kAngles; ++i) {
      for (int m = 1; m <= 3; ++m) {
        const det::SinCos angle = turn(static_cast<std::uint64_t>(m * i % kAngles), kAngles);
        table[i][2 * m - 2] = angle.cos;
        table[i][2 * m - 1] = angle.sin;
      }
      table[i][6] = turn(static_cast<std::uint64_t>(4 * i % kAngles), kAngles).cos;
    }
    return table;
  }();
  const auto& x = value;
  const double even = 0.25 * kRoot, quarter = 0.25;
  const double d0 = x[0] - x[4], d1 = x[1] - x[5], d2 = x[2] - x[6], d3 = x[3] - x[7];
  const double s0 = x[0] + x[4], s1 = x[1] + x[5], s2 = x[2] + x[6], s3 = x[3] + x[7];
  const double mean = 0.125 * (s0 + s1 + s2 + s3);
  const double c[7] = {quarter * d0 + even * (d1 - d3),
                       quarter * d2 + even * (d1 + d3),
                       quarter * (s0 - s2),
                       quarter * (s1 - s3),
                       quarter * d0 - even * (d1 - d3),
                       even * (d1 + d3) - quarter * d2,
                       0.125 * (s0 + s2 - s1 - s3)};
  low = high = 0;
  for (const auto& row : kTable) {
    double sum = 0;
    for (int k = 0; k < 7; ++k) sum += c[k] * row[k];
    low = std::min(low, sum);
    high = std::max(high, sum);
  }
  // between the angles: half of the square of half their distance, times the second derivative
  constexpr double kHalf = kPi / kAngles;
  const double rest = 0.5 * kHalf * kHalf *
                      (std::fabs(c[0]) + std::fabs(c[1]) + 4 * (std::fabs(c[2]) + std::fabs(c[3])) +
                       9 * (std::fabs(c[4]) + std::fabs(c[5])) + 16 * std::fabs(c[6]));
  low += mean - rest;
  high += mean + rest;
}

}  // namespace

SectionPlacer::SectionPlacer(const SplinePath& path, Settings settings)
    : path_(path), settings_(std::move(settings)) {}

std::vector<Section> SectionPlacer::placed(double most) const {
  double step = std::min(path_.end(), 4.0);  // pieces
  std::vector<Section> result{section(0, step)};
  // how far the first is moved depends on the step that follows
  step = furthest(result, step);
  result.front() = section(0, step);
  while (result.back().t < path_.end()) {
    if (static_cast<double>(result.size()) > most) return result;
    step = furthest(result, step);
    result.push_back(further(result, step));
  }
  while (settings_.closed && result.size() < 4) result = halved(result);
  even_out(result);
  return result;
}

// The section that follows after a step; a closed path ends at its first.
Section SectionPlacer::further(const std::vector<Section>& sections, double step) const {
  const double t = sections.back().t + step;
  if (t < path_.end() * (1 - 1e-12)) return section(t, step);
  Section last = section(path_.end(), step);
  if (settings_.closed) last.frame.centre = sections.front().frame.centre;
  return last;
}

Section SectionPlacer::section(double t, double step) const {
  Section result{t, path_.frame_at(t)};
  if (settings_.twist != 0)
    result.frame = turned(result.frame, -settings_.twist * path_.length_to(t) / path_.length());
  if (settings_.shift == 0) return result;
  const double reach =
      settings_.closed ? std::min(step, 0.25 * path_.end()) : std::min({step, t, path_.end() - t});
  if (reach <= 0) return result;
  const auto around = [&](double u) {
    if (u < 0) u += path_.end();
    return path_.at(u > path_.end() ? u - path_.end() : u).position;
  };
  // chords of that length dip by a quarter of this
  Vec3 out = result.frame.centre - 0.5 * (around(t - reach) + around(t + reach));
  out -= glm::dot(out, result.frame.tangent) * result.frame.tangent;
  const double moved = glm::length(out) / 8;
  if (moved > 0) result.frame.centre += (std::min(moved, settings_.shift) / (8 * moved)) * out;
  return result;
}

// The worst of all surfaces: 1 is all that is allowed.
double SectionPlacer::use(const Section& a, const Section& b) const {
  double worst = 0;
  for (const Allowance& allowance : settings_.allowances) {
    const Range range = measure(a, b, allowance.radius);
    if (range.folded) return 1e9;
    worst = std::max({worst, range.high / allowance.high, range.low / allowance.low});
  }
  return worst;
}

Range SectionPlacer::measure(const Section& a, const Section& b, double radius) const {
  const double pieces = b.t - a.t;
  const auto samples = static_cast<int>(std::min(1e6, std::max(7.0, std::ceil(2 * pieces) + 1)));
  Range range{1e300, -1e300};
  Range before[2] = {};
  double bend_low = 0, bend_high = 0;  // second differences
  for (int i = 0; i <= samples + 1; ++i) {
    const double share = static_cast<double>(i) / (samples + 1);
    const Range here = across(a, b, a.t + share * pieces, radius);
    if (here.folded) return here;
    range.low = std::min(range.low, here.low);
    range.high = std::max(range.high, here.high);
    if (i > 1) {
      bend_low = std::max(bend_low, here.low - 2 * before[1].low + before[0].low);
      bend_high = std::max(bend_high, 2 * before[1].high - here.high - before[0].high);
    }
    before[0] = before[1];
    before[1] = here;
  }
  // Triangles leave the ruled strip: by its twist, which lies along the path, so that only the
  // path's own turning brings any of it out of the surface, and by the square of it.
  const double bend = angle_between(a.frame.tangent, b.frame.tangent);
  constexpr double kTurning = 0.0963;  // max of 2·w(1 − w)|w − ½| over [0, 1]
  const double twist =
      radius * settings_.sin_half * bend * bend * (kTurning + 0.125 * settings_.sin_half);
  range.low -= bend_low / 8 + twist;
  range.high += bend_high / 8 + twist;
  return range;
}

// Where the strip's rulings cross the plane across the path at t.
Range SectionPlacer::across(const Section& a, const Section& b, double t, double radius) const {
  const SplinePath::Point point = path_.at(t);
  const Vec3 tangent = point.tangent();
  const Vec3 from = a.frame.centre - point.position;
  const Vec3 way = b.frame.centre - a.frame.centre;
  const Vec3 a_up = a.frame.up(), b_up = b.frame.up();
  const double from_along = glm::dot(from, tangent), way_along = glm::dot(way, tangent);
  const double right_along = glm::dot(a.frame.right, tangent), up_along = glm::dot(a_up, tangent);
  const double right_way = glm::dot(b.frame.right, tangent) - right_along;
  const double up_way = glm::dot(b_up, tangent) - up_along;
  std::array<double, 8> value{};
  for (int k = 0; k < 8; ++k) {
    constexpr double kRoot = 0.70710678118654752;
    constexpr double kCos[8] = {1, kRoot, 0, -kRoot, -1, -kRoot, 0, kRoot};
    const double c = radius * kCos[k];
    const double s = radius * kCos[(k + 6) % 8];
    const double along = way_along + c * right_way + s * up_way;
    if (!(along > 0)) return {0, 0, true};
    const double share =
        std::clamp(-(from_along + c * right_along + s * up_along) / along, 0.0, 1.0);
    const Vec3 p = from + share * way +
                   c * (a.frame.right + share * (b.frame.right - a.frame.right)) +
                   s * (a_up + share * (b_up - a_up));
    value[k] = glm::length(p) - radius;
  }
  Range range;
  bounds_of(value, range.low, range.high);
  return range;
}

double SectionPlacer::furthest(const std::vector<Section>& sections, double guess) const {
  const double room = path_.end() - sections.back().t;
  double good = 0;
  double bad = std::numeric_limits<double>::infinity();
  double step = std::min(guess, room);
  constexpr int kTries = 40;
  for (int i = 0; i < kTries; ++i) {
    const double used = use(sections.back(), further(sections, step));
    if (used <= 1) {
      good = step;
      if (step == room || used > 0.9) break;
    } else {
      bad = step;
    }
    if (good > 0 && bad - good < 0.02 * good) break;
    // chords dip by the square of their length
    double next = std::min(room, step * std::clamp(0.98 / std::sqrt(used), 0.25, 4.0));
    if (!(next > good && next < bad)) next = 0.5 * (good + bad);
    step = next;
  }
  // note: shorter than this a step is a point to the precision of its parameter
  return std::max(good, 1e-9);
}

std::vector<Section> SectionPlacer::halved(const std::vector<Section>& sections) const {
  std::vector<Section> result{sections.front()};
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const double half = 0.5 * (sections[i].t - sections[i - 1].t);
    result.push_back(section(sections[i - 1].t + half, half));
    result.push_back(sections[i]);
  }
  return result;
}

// The last step is what the others left: it shares with the one before.
void SectionPlacer::even_out(std::vector<Section>& sections) const {
  if (sections.size() < 3) return;
  const std::size_t n = sections.size();
  const Section& a = sections[n - 3];
  const Section& c = sections[n - 1];
  const double half = 0.5 * (c.t - a.t);
  const Section middle = section(a.t + half, half);
  if (use(a, middle) <= 1 && use(middle, c) <= 1) sections[n - 2] = middle;
}

}  // namespace panwright::geometry::internal
