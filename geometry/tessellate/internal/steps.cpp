#include "geometry/tessellate/internal/steps.h"

#include <algorithm>
#include <cmath>

#include "geometry/tessellate/internal/circle.h"

namespace panwright::geometry::internal {

namespace {

// intervals of a quarter turn before halving, and how often they are halved
constexpr int kStepNodes = 16;
constexpr int kStepDepth = 40;

}  // namespace

Steps::Steps(double a, double b, Kind kind)
    : a_(a),
      b_(b),
      kind_(kind),
      even_(a == b),
      sharp_(std::max(a, b) > 3 * std::min(a, b)),
      density_(made()) {}

double Steps::stretch(std::uint64_t k, std::uint64_t n) const {
  if (even_) return 1;
  const det::SinCos at = this->at(k, n);
  return integral() / (2 * kPi * value(det::atan2(std::fabs(at.sin), std::fabs(at.cos))));
}

det::SinCos Steps::at(std::uint64_t k, std::uint64_t n) const {
  if (even_) return turn(k, n);
  std::uint64_t num = 4 * k;
  const bool lower = num > 2 * n;
  if (lower) num = 4 * n - num;
  const bool left = num > n;
  if (left) num = 2 * n - num;
  det::SinCos r{0, 1};
  if (num == n)
    r = {1, 0};
  else if (num > 0)
    r = det::sincos(density_.place(static_cast<double>(num) / static_cast<double>(n)));
  if (left) r.cos = -r.cos;
  if (lower) r.sin = -r.sin;
  return r;
}

// Steps per parameter, of any unit. Around a facet of side s and height h the radius is
// R = h/2 + s²/(8h), whose square goes with the inverse of the distance between centre and tangent.
// At the end of the longer axis, where that is the largest, facets are equilateral: h = 3R/2. For
// q times that R the same height allows s² = 12 (q − 3/4) R².
double Steps::value(double t) const {
  const double unit = std::max(a_, b_);
  const double ra = unit / a_, rb = unit / b_;
  const det::SinCos s = det::sincos(t);
  const double inverse = std::hypot(s.cos * ra, s.sin * rb);
  if (kind_ == Kind::chords) return std::sqrt(unit / inverse);
  return 0.5 / std::sqrt(std::max(std::sqrt(inverse), 1.0) - 0.75);
}

Density Steps::made() const {
  std::vector<double> t{0}, v{value(0)};
  struct Span {
    double end, value;
    int depth;
  };
  std::vector<Span> todo;
  for (int i = 1; i <= kStepNodes; ++i) {
    const double end = 0.5 * kPi * (static_cast<double>(i) / kStepNodes);
    todo.push_back({end, value(end), 0});
    while (!todo.empty()) {
      const Span span = todo.back();
      const double middle = 0.5 * (t.back() + span.end);
      const double mid = value(middle);
      if (span.depth < kStepDepth && std::fabs(mid - 0.5 * (v.back() + span.value)) > 0.01 * mid) {
        todo.back().depth = span.depth + 1;
        todo.push_back({middle, mid, span.depth + 1});
        continue;
      }
      todo.pop_back();
      t.push_back(span.end);
      v.push_back(span.value);
    }
  }
  return {std::move(t), std::move(v)};
}

}  // namespace panwright::geometry::internal
