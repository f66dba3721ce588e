// The share of the Sun that bodies leave at a point.
#include <algorithm>
#include <cmath>
#include <functional>

#include "sky/sky.h"

namespace panwright::sky {
namespace {

constexpr int kChords = 256;

// The line x along a chord y of the Sun's disc, as rays of an ellipsoid's space: those that meet
// the unit sphere have |ω|² > |from × ω|², and −from·ω > 0 in front.
struct ChordLine {
  Vec3 from;                               // the point
  Vec3 middle, x, y;                       // directions at the disc's centre, by x and by y
  Vec3 middle_moment, x_moment, y_moment;  // from × these

  ChordLine(const Ellipsoid& shape, const Vec3& at, const Vec3& to_sun, const Vec3& along,
            const Vec3& across, double sine)
      : from(at),
        middle(shape.unit_from_world * (to_sun * std::sqrt(1 - 0.5 * sine * sine))),
        x(shape.unit_from_world * (along * sine)),
        y(shape.unit_from_world * (across * sine)),
        middle_moment(glm::cross(from, middle)),
        x_moment(glm::cross(from, x)),
        y_moment(glm::cross(from, y)) {}
};

struct Span {
  double low, high;
};

// Adds what is hidden of [−half, half] at a chord.
void add_hidden(const ChordLine& line, double y, double half, std::vector<Span>& hidden) {
  const Vec3 a = line.middle + y * line.y, w = line.middle_moment + y * line.y_moment;
  const double c0 = glm::dot(a, a) - glm::dot(w, w);
  const double c1 = glm::dot(a, line.x) - glm::dot(w, line.x_moment);
  const double c2 = glm::dot(line.x, line.x) - glm::dot(line.x_moment, line.x_moment);
  // in front: d0 + x·d1 > 0
  const double d0 = -glm::dot(line.from, a), d1 = -glm::dot(line.from, line.x);
  double low = -half, high = half;
  if (d1 > 0)
    low = std::max(low, -d0 / d1);
  else if (d1 < 0)
    high = std::min(high, -d0 / d1);
  else if (!(d0 > 0))
    return;
  const auto add = [&](double from, double to) {
    from = std::max(from, low);
    to = std::min(to, high);
    if (from < to) hidden.push_back({from, to});
  };
  const double discriminant = c1 * c1 - c0 * c2;
  if (c2 == 0 || !(discriminant > 0)) {
    if (c2 > 0 || (c2 == 0 && c0 > 0)) add(low, high);
    return;
  }
  // c0 + 2·c1·x + c2·x² > 0
  const double sum = -(c1 + std::copysign(std::sqrt(discriminant), c1));
  double first = sum / c2, second = sum != 0 ? c0 / sum : first;
  if (first > second) std::swap(first, second);
  if (c2 < 0) {
    add(first, second);
  } else {
    add(low, first);
    add(second, high);
  }
}

// Integral of 1 − u + u·sqrt(half² − x²) from 0 to x.
double light_to(double x, double half, double limb) {
  const double t = std::clamp(x / half, -1.0, 1.0);
  return (1 - limb) * x +
         0.5 * limb * half * half * (t * std::sqrt(std::max(0.0, 1 - t * t)) + det::asin(t));
}

double hidden_of_chord(std::vector<Span>& hidden, double half, double limb) {
  double sum = 0;
  std::ranges::sort(hidden, {}, &Span::low);
  double reached = -half;
  for (const Span& span : hidden) {
    const double low = std::max(span.low, reached);
    if (span.high <= low) continue;
    sum += light_to(span.high, half, limb) - light_to(low, half, limb);
    reached = span.high;
  }
  return sum;
}

// Of what is not hidden, the integral of brightness times a weight by x.
Vec3 seen_of_chord(std::vector<Span>& hidden, double half, double limb,
                   const std::function<Vec3(double x)>& weight) {
  constexpr int kPlaces = 24;
  Vec3 sum(0);
  const auto add = [&](double low, double high) {
    for (int k = 0; k < kPlaces && low < high; ++k) {
      // dense at both ends, where brightness is a root
      const det::SinCos turn = det::sincos(kPi * ((k + 0.5) / kPlaces - 0.5));
      const double x = 0.5 * (low + high) + 0.5 * (high - low) * turn.sin;
      const double mu = std::sqrt(std::max(0.0, half * half - x * x));
      sum += (1 - limb + limb * mu) * turn.cos * (0.5 * (high - low) * kPi / kPlaces) * weight(x);
    }
  };
  std::ranges::sort(hidden, {}, &Span::low);
  double reached = -half;
  for (const Span& span : hidden) {
    add(reached, span.low);
    reached = std::max(reached, span.high);
  }
  add(reached, half);
  return sum;
}

enum class Cover { none, partial, whole };

// Whether a body may hide the disc, by how far its impact parameter changes over it.
Cover cover_of(const ChordLine& line) {
  const double size = std::sqrt(glm::dot(line.middle, line.middle));
  const double step = std::sqrt(glm::dot(line.x, line.x) + glm::dot(line.y, line.y)) / size;
  const double distance = std::sqrt(glm::dot(line.from, line.from));
  const double impact = std::sqrt(glm::dot(line.middle_moment, line.middle_moment)) / size;
  const double change = 1.1 * step * distance;
  const double ahead = -glm::dot(line.from, line.middle) / size;
  if (ahead < -change || impact > 1 + change) return Cover::none;
  return impact < 1 - change && ahead > change ? Cover::whole : Cover::partial;
}

// How far the Sun's centre stands beyond the limb, in its radii; far where the body is behind.
double beyond(const ChordLine& line) {
  constexpr double kFar = 1e6;
  if (glm::dot(line.from, line.middle) >= 0) return kFar;
  const double square = glm::dot(line.middle, line.middle);
  const double impact = std::sqrt(glm::dot(line.middle_moment, line.middle_moment) / square);
  const auto slope = [&](const Vec3& step, const Vec3& moment) {
    return (glm::dot(line.middle_moment, moment) - impact * impact * glm::dot(line.middle, step)) /
           (std::max(impact, 1e-9) * square);
  };
  const double along = slope(line.x, line.x_moment), across = slope(line.y, line.y_moment);
  const double change = std::sqrt(along * along + across * across);
  return change > 0 ? std::clamp((impact - 1) / change, -kFar, kFar) : kFar;
}

// The bodies that hide a part of the Sun's disc; none: one hides all of it.
//
//   along  axis of the disc; null: towards the first body
std::optional<std::vector<ChordLine>> partial_bodies(const Sky& sky, const Vec3& point,
                                                     std::optional<std::size_t> except,
                                                     const Vec3* along) {
  std::vector<ChordLine> lines;
  Vec3 axis = along ? *along : Vec3(0);
  for (std::size_t i = 0; i < sky.size(); ++i) {
    if (i == except) continue;
    const Vec3 from = sky.shape(i).from(point);
    if (glm::dot(from, from) < 1) return std::nullopt;
    if (lines.empty() && !along) axis = sky.beside_sun(sky.shape(i).centre - point);
    const ChordLine line(sky.shape(i), from, sky.to_sun(), axis, glm::cross(sky.to_sun(), axis),
                         sky.sun_sine());
    const Cover cover = cover_of(line);
    if (cover == Cover::whole) return std::nullopt;
    if (cover == Cover::partial) lines.push_back(line);
  }
  return lines;
}

// The t of a share, by bisection.
double edge_of(double share, double limb) {
  double low = -1, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (share_beyond(middle, limb) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

// By chords: uniform discs, and discs whose brightness is μ.
double share_beyond(double t, double limb_darkening) {
  t = std::clamp(t, -1.0, 1.0);
  const double even = 0.5 + (det::asin(t) + t * std::sqrt(1 - t * t)) / kPi;
  const double round = 0.5 + t * (3 - t * t) / 4;
  const double u = limb_darkening;
  return ((1 - u) * even + u * (2.0 / 3) * round) / (1 - u / 3);
}

std::optional<EclipseEdge> Sky::eclipse_edge(const Vec3& point, double radius) const {
  const auto value = [&](const Ellipsoid& shape, const Vec3& at) {
    return beyond(ChordLine(shape, shape.from(at), to_sun_, across_[0], across_[1], sun_sine_));
  };
  std::optional<EclipseEdge> deepest;
  for (const Ellipsoid& shape : shapes_) {
    EclipseEdge edge{value(shape, point)};
    double change = 0;
    for (int k = 0; k < 3; ++k) {
      Vec3 step(0);
      step[k] = radius;
      const double difference = value(shape, point + step) - value(shape, point - step);
      edge.gradient[k] = 0.5 * difference / radius;
      change += std::fabs(0.5 * difference);
    }
    if (edge.value > 1 + 2 * change) continue;
    if (!deepest || edge.value < deepest->value) deepest = edge;
  }
  if (!deepest) return std::nullopt;
  const double share = sun_share(point);
  constexpr double kPartial = 1e-4;  // beyond, the slope of a share is too small to divide by
  if (share > kPartial && share < 1 - kPartial) deepest->value = edge_of(share, limb_);
  return deepest;
}

std::vector<NearEclipse> Sky::near_eclipses(const Vec3& point, double radius,
                                            std::optional<std::size_t> except) const {
  constexpr double kMostBend = 1.5e-3;  // of a limb within the radius, radii of the Sun's disc
  constexpr double kWide = 100;  // bodies so many times as wide as the Sun have straight limbs
  constexpr std::size_t kMost = 2;
  struct Found {
    double depth;  // beyond the limb, metres; below 0: towards the shadow's middle
    Vec3 along;
    NearEclipse eclipse;
  };
  std::vector<Found> found;
  bool bends = except.has_value();
  for (std::size_t i = 0; i < size(); ++i) {
    if (i == except) continue;
    const Ellipsoid& shape = shapes_[i];
    const Vec3& radii = bodies_[i].radii;
    const double most = std::max({radii.x, radii.y, radii.z});
    const Vec3 toward = shape.centre - point;
    const double ahead = glm::dot(toward, to_sun_);
    const Vec3 beside = toward - ahead * to_sun_;
    const double off = std::sqrt(glm::dot(beside, beside));
    const double reach = ahead + most + radius;
    if (reach < 0 || off > most + radius + 1.1 * sun_sine_ * reach) continue;
    const Vec3 along = off > 0 ? beside / off : across_[0];
    const Vec3 across = glm::cross(to_sun_, along);
    const ChordLine line(shape, shape.from(point), to_sun_, along, across, sun_sine_);
    const double distance = std::sqrt(glm::dot(toward, toward));
    found.push_back(
        {off - most, along, {i, line.from, shape.unit_from_world, line.middle, line.x, line.y}});
    const double wide = most / std::max(distance, most);
    const auto value = [&](const Vec3& at) {
      return beyond(ChordLine(shape, shape.from(at), to_sun_, along, across, sun_sine_));
    };
    double bend = 0;
    for (int k = 0; k < 3; ++k) {
      Vec3 step(0);
      step[k] = radius;
      bend += std::fabs(0.5 * (value(point + step) + value(point - step)) - value(point));
    }
    bends = bends || bend > kMostBend || wide < kWide * sun_sine_;
  }
  std::vector<NearEclipse> out;
  if (found.empty() || (!bends && found.size() < 2)) return out;
  std::ranges::stable_sort(found, {}, &Found::depth);
  // of all bodies, the axes of the disc are those towards the first, or along a limb
  const Vec3 axis =
      except ? glm::cross(to_sun_, beside_sun(shapes_[*except].centre - point)) : found[0].along;
  const Vec3 along = sun_sine_ * axis;
  for (std::size_t i = 0; i < std::min(found.size(), kMost); ++i) {
    out.push_back(found[i].eclipse);
    out.back().along = out.back().unit_from_world * along;
    out.back().across = out.back().unit_from_world * glm::cross(to_sun_, along);
  }
  return out;
}

Vec3 Sky::beside_sun(const Vec3& toward) const {
  const Vec3 beside = toward - to_sun_ * glm::dot(toward, to_sun_);
  const double length = std::sqrt(glm::dot(beside, beside));
  return length > 0 ? beside / length : across_[0];
}

double Sky::sun_share(const Vec3& point, std::optional<std::size_t> except) const {
  const auto lines = partial_bodies(*this, point, except, nullptr);
  if (!lines) return 0;
  if (lines->empty()) return 1;
  double sum = 0;
  std::vector<Span> hidden;
  for (int i = 0; i < kChords; ++i) {
    const det::SinCos turn = det::sincos(kPi * ((i + 0.5) / kChords - 0.5));
    hidden.clear();
    for (const ChordLine& line : *lines) add_hidden(line, turn.sin, turn.cos, hidden);
    sum += hidden_of_chord(hidden, turn.cos, limb_) * turn.cos;
  }
  return std::clamp(1 - sum / (kChords * (1 - limb_ / 3)), 0.0, 1.0);
}

Vec3 Sky::mean_beside(const Vec3& point, std::size_t except, const Vec3& along,
                      const std::function<Vec3(double x, double y)>& weight) const {
  const auto lines = partial_bodies(*this, point, except, &along);
  if (!lines) return Vec3(0);
  Vec3 sum(0);
  std::vector<Span> hidden;
  for (int i = 0; i < kChords; ++i) {
    const det::SinCos turn = det::sincos(kPi * ((i + 0.5) / kChords - 0.5));
    hidden.clear();
    for (const ChordLine& line : *lines) add_hidden(line, turn.sin, turn.cos, hidden);
    sum += turn.cos *
           seen_of_chord(hidden, turn.cos, limb_, [&](double x) { return weight(x, turn.sin); });
  }
  return sum / (kChords * (1 - limb_ / 3));
}

}  // namespace panwright::sky
