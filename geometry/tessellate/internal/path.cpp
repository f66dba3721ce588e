#include "geometry/tessellate/internal/path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace panwright::geometry::internal {

namespace {

// radians by which a piece bends at most, and how much faster the parameter runs at one end
constexpr double kPieceBend = 0.15;
constexpr double kPieceSpeed = 1.5;
// halvings of a cubic: what bends within 2^-32 of it is a cusp
constexpr int kMostHalvings = 32;

// nodes and weights of Gauss and Legendre on [0, 1]
constexpr double kNodes[5] = {0.5, 0.23076534494715845, 0.76923465505284155, 0.046910077030668004,
                              0.953089922969332};
constexpr double kWeights[5] = {0.28444444444444444, 0.23931433524968324, 0.23931433524968324,
                                0.11846344252809454, 0.11846344252809454};

}  // namespace

Vec3 first_right(const Vec3& tangent) {
  int axis = 0;
  for (const int other : {1, 2})
    if (std::fabs(tangent[other]) < std::fabs(tangent[axis])) axis = other;
  Vec3 right(0);
  right[axis] = 1;
  return glm::normalize(right - glm::dot(right, tangent) * tangent);
}

Vec3 carried(const Frame& from, const Vec3& centre, const Vec3& tangent) {
  const Vec3 way = centre - from.centre;
  const double squared = glm::dot(way, way);
  Vec3 right = from.right;
  Vec3 old_tangent = from.tangent;
  if (squared > 0) {
    right -= (2 * glm::dot(way, right) / squared) * way;
    old_tangent -= (2 * glm::dot(way, old_tangent) / squared) * way;
  } else {
    old_tangent = -old_tangent;  // as a way along it does
  }
  const Vec3 change = tangent - old_tangent;
  const double changed = glm::dot(change, change);
  if (changed > 0) right -= (2 * glm::dot(change, right) / changed) * change;
  // what rounding leaves along the tangent
  return glm::normalize(right - glm::dot(right, tangent) * tangent);
}

Frame turned(const Frame& frame, double angle) {
  if (angle == 0) return frame;
  const det::SinCos turn = det::sincos(angle);
  Frame result = frame;
  result.right = turn.cos * frame.right + turn.sin * frame.up();
  return result;
}

Vec3 SplinePath::Point::bend() const {
  const double speed = glm::length(first);
  if (speed == 0) return Vec3(std::numeric_limits<double>::infinity(), 0, 0);
  const Vec3 unit = first / speed;
  return (second - glm::dot(second, unit) * unit) / (speed * speed);
}

SplinePath::SplinePath(std::span<const Vec3> points, bool closed) : closed_(closed) {
  const std::size_t count = points.size();
  const std::size_t spans = closed ? count : count - 1;
  cubics_.reserve(spans);
  for (std::size_t i = 0; i < spans; ++i) {
    const Vec3& b = points[i];
    const Vec3& c = points[(i + 1) % count];
    const Vec3 a = i > 0 ? points[i - 1] : closed ? points[count - 1] : 2.0 * b - c;
    const Vec3 d = closed || i + 2 < count ? points[(i + 2) % count] : 2.0 * c - b;
    // knots are apart by the square roots of distances
    const double ab = std::sqrt(glm::length(b - a));
    const double bc = std::sqrt(glm::length(c - b));
    const double cd = std::sqrt(glm::length(d - c));
    const Vec3 at_b = bc * ((b - a) / ab - (c - a) / (ab + bc)) + (c - b);
    const Vec3 at_c = (c - b) + bc * ((d - c) / cd - (d - b) / (bc + cd));
    cubics_.push_back({{b, at_b, 3.0 * (c - b) - 2.0 * at_b - at_c, 2.0 * (b - c) + at_b + at_c}});
  }
  pieces_.reserve(4 * spans);
  for (std::size_t i = 0; i < spans; ++i) cut(i);
  const Piece& piece = pieces_.back();
  const Point end = at(piece, 1);
  last_ = {end.position, end.tangent(), {}};
  last_.right = carried(piece.frame, last_.centre, last_.tangent);
}

// Halves a cubic until the tangents of each part lie in a narrow cone: that of the controls of its
// derivative holds them all.
void SplinePath::cut(std::size_t cubic) {
  const Vec3* c = cubics_[cubic].c;
  const auto derivative = [&](double u) { return c[1] + u * (2.0 * c[2] + 3.0 * u * c[3]); };
  const auto second = [&](double u) { return 2.0 * c[2] + 6.0 * u * c[3]; };
  struct Section {
    double begin, end;
    int halvings;
  };
  std::vector<Section> waiting{{0, 1, 0}};
  while (!waiting.empty()) {
    const Section section = waiting.back();
    waiting.pop_back();
    const Vec3 first = derivative(section.begin);
    const Vec3 last = derivative(section.end);
    const Vec3 middle = first + 0.5 * (section.end - section.begin) * second(section.begin);
    const double low = std::min({glm::length(first), glm::length(middle), glm::length(last)});
    const double high = std::max({glm::length(first), glm::length(middle), glm::length(last)});
    const bool calm = high <= kPieceSpeed * low &&
                      angle_between(first, middle) + angle_between(middle, last) <= kPieceBend;
    if (calm || section.halvings == kMostHalvings) {
      add_piece(cubic, section.begin, section.end, !calm);
      continue;
    }
    const double half = 0.5 * (section.begin + section.end);
    waiting.push_back({half, section.end, section.halvings + 1});
    waiting.push_back({section.begin, half, section.halvings + 1});
  }
}

void SplinePath::add_piece(std::size_t cubic, double begin, double end, bool cusp) {
  Piece piece{cubic, begin, end, length_, 0, {}, cusp};
  const Point start = at(piece, 0);
  piece.frame = {start.position, start.tangent(), {}};
  piece.frame.right = pieces_.empty()
                          ? first_right(piece.frame.tangent)
                          : carried(pieces_.back().frame, piece.frame.centre, piece.frame.tangent);
  for (int k = 0; k < 5; ++k)
    piece.length += kWeights[k] * (end - begin) * glm::length(at(piece, kNodes[k]).first);
  length_ += piece.length;
  pieces_.push_back(piece);
}

SplinePath::Point SplinePath::at(const Piece& piece, double share) const {
  const Vec3* c = cubics_[piece.cubic].c;
  const double u = piece.begin + share * (piece.end - piece.begin);
  return {c[0] + u * (c[1] + u * (c[2] + u * c[3])), c[1] + u * (2.0 * c[2] + 3.0 * u * c[3]),
          2.0 * c[2] + 6.0 * u * c[3]};
}

const SplinePath::Piece& SplinePath::piece_at(double t, double& share) const {
  const auto last = static_cast<double>(pieces_.size() - 1);
  const double index = std::clamp(std::floor(t), 0.0, last);
  share = t - index;
  return pieces_[static_cast<std::size_t>(index)];
}

SplinePath::Point SplinePath::at(double t) const {
  double share = 0;
  const Piece& piece = piece_at(t, share);
  return at(piece, share);
}

Frame SplinePath::frame_at(double t) const {
  if (t >= end()) return last_;
  double share = 0;
  const Piece& piece = piece_at(t, share);
  if (share == 0) return piece.frame;
  const Point point = at(piece, share);
  Frame frame{point.position, point.tangent(), {}};
  frame.right = carried(piece.frame, frame.centre, frame.tangent);
  return frame;
}

double SplinePath::length_to(double t) const {
  if (t >= end()) return length_;
  double share = 0;
  const Piece& piece = piece_at(t, share);
  double length = 0;
  for (int k = 0; k < 5; ++k)
    length += kWeights[k] * glm::length(at(piece, share * kNodes[k]).first);
  return piece.before + share * (piece.end - piece.begin) * length;
}

double SplinePath::at_length(double length) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), length,
                       [](double value, const Piece& piece) { return value < piece.before; });
  const auto index = static_cast<std::size_t>(after - pieces_.begin()) - 1;
  const Piece& piece = pieces_[index];
  double share = std::clamp((length - piece.before) / piece.length, 0.0, 1.0);
  // two steps of Newton's: lengths of one part in 1e12
  for (int step = 0; step < 2; ++step) {
    const double t = static_cast<double>(index) + share;
    const double speed = glm::length(at(piece, share).first) * (piece.end - piece.begin);
    share = std::clamp(share - (length_to(t) - length) / speed, 0.0, 1.0);
  }
  return static_cast<double>(index) + share;
}

double SplinePath::twist() const {
  const Frame& first = pieces_.front().frame;
  return det::atan2(glm::dot(last_.right, first.up()), glm::dot(last_.right, first.right));
}

SplinePath::Bend SplinePath::sharpest() const {
  constexpr int kSamples = 8;  // of a piece: the curvature between them is 0.1 % more, measured
  Bend result{0, 0};
  for (const Piece& piece : pieces_) {
    for (int k = 0; k <= kSamples; ++k) {
      const double share = static_cast<double>(k) / kSamples;
      const double curvature = piece.cusp ? std::numeric_limits<double>::infinity()
                                          : glm::length(at(piece, share).bend());
      if (!(curvature > result.curvature)) continue;
      const double u = piece.begin + share * (piece.end - piece.begin);
      const std::size_t points = closed_ ? cubics_.size() : cubics_.size() + 1;
      result = {curvature, (piece.cubic + (u > 0.5 ? 1 : 0)) % points};
    }
  }
  return result;
}

}  // namespace panwright::geometry::internal
