#include "geometry/tessellate/internal/subdiv_deviation.h"

#include <algorithm>
#include <cmath>

namespace panwright::geometry::internal {

namespace {

// steps towards the nearest point of a surface
constexpr int kSteps = 12;
// of the largest distance: what a parabola may miss the centre by
constexpr double kParabolic = 0.03;
// where it misses more, a side is sampled in so many steps
constexpr int kDense = 6;

// The largest value inside a triangle, relative to the largest sample, of the parabola that is 0 at
// the corners and m at the middles of the sides (0 1, 1 2, 2 0): 1 where it is at one of them.
double peak_of(const double (&m)[3], double centre) {
  double most = std::fabs(centre);
  for (const double x : m) most = std::max(most, std::fabs(x));
  if (!(most > 0)) return 1;
  // stationary where the products of the matrix of m with the barycentric coordinates are equal
  const double b[3] = {m[1] * (m[0] + m[2] - m[1]), m[2] * (m[0] + m[1] - m[2]),
                       m[0] * (m[1] + m[2] - m[0])};
  const double sum = b[0] + b[1] + b[2];
  for (const double x : b)
    if (!(x * sum > 0)) return 1;
  const double peak =
      4 * (m[0] * b[0] * b[1] + m[1] * b[1] * b[2] + m[2] * b[2] * b[0]) / (sum * sum);
  return std::max(1.0, std::fabs(peak) / most);
}

}  // namespace

double CellDeviation::distance(const Vec3& p, const Vec2& at, double& along_normal) const {
  LimitPoint s;
  along_normal = 0;
  // note: next to an irregular vertex, where nothing finer is known
  if (!surface_.evaluate(cell_, at, s)) return 0;
  along_normal = glm::dot(p - s.position, normal_of(s));
  const double straight = glm::length(p - s.position);
  return straight <= worst_ ? straight : nearest(p, at, s);
}

// Levenberg and Marquardt: any point of the cell is an upper bound, and few steps find a near one,
// next to irregular vertices too, where parameters bend.
double CellDeviation::nearest(const Vec3& p, Vec2 at, LimitPoint s) const {
  double best = glm::length(p - s.position);
  double damping = 1e-4;
  for (int step = 0; step < kSteps && best > worst_; ++step) {
    const Vec3 d = p - s.position;
    const double size = glm::dot(s.du, s.du) + glm::dot(s.dv, s.dv);
    const double uu = glm::dot(s.du, s.du) + damping * size;
    const double vv = glm::dot(s.dv, s.dv) + damping * size;
    const double uv = glm::dot(s.du, s.dv);
    const double du = glm::dot(d, s.du), dv = glm::dot(d, s.dv);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) break;
    const Vec2 move((vv * du - uv * dv) / determinant, (uu * dv - uv * du) / determinant);
    const Vec2 next = glm::clamp(at + move, Vec2(0), Vec2(1));
    LimitPoint there;
    const bool known = surface_.evaluate(cell_, next, there);
    const double distance = known ? glm::length(p - there.position) : HUGE_VAL;
    if (!(distance < best)) {
      damping *= 16;
      continue;
    }
    const bool enough = best - distance < 1e-3 * best;
    best = distance;
    at = next;
    s = there;
    damping *= 0.25;
    if (enough) break;
  }
  return best;
}

void CellDeviation::show(const Vec2 (&at)[3], const Vec3 (&p)[3]) {
  double middles[3], centre = 0, found = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    found = std::max(found, distance(0.5 * (p[i] + p[k]), 0.5 * (at[i] + at[k]), middles[i]));
  }
  found =
      std::max(found, distance((p[0] + p[1] + p[2]) / 3.0, (at[0] + at[1] + at[2]) / 3.0, centre));
  const double expected = 4 * (middles[0] + middles[1] + middles[2]) / 9;
  if (std::fabs(centre - expected) > kParabolic * found) {
    found = std::max(found, densely(at, p));
    worst_ = std::max(worst_, found);
  } else {
    worst_ = std::max(worst_, found * peak_of(middles, centre));
  }
}

// What is no parabola is looked at closely.
double CellDeviation::densely(const Vec2 (&at)[3], const Vec3 (&p)[3]) const {
  double found = 0, along_normal = 0;
  for (int i = 0; i <= kDense; ++i)
    for (int j = 0; i + j <= kDense; ++j) {
      const int k = kDense - i - j;
      if (i == kDense || j == kDense || k == kDense) continue;
      const double a = static_cast<double>(i) / kDense, b = static_cast<double>(j) / kDense,
                   c = static_cast<double>(k) / kDense;
      found = std::max(found, distance(a * p[0] + b * p[1] + c * p[2],
                                       a * at[0] + b * at[1] + c * at[2], along_normal));
    }
  return found;
}

void CellDeviation::show_curve(const Vec2& from, const Vec2& to, const Vec3& a, const Vec3& b) {
  for (const double t : {0.25, 0.5, 0.75}) {
    LimitPoint s;
    if (!surface_.evaluate(cell_, from + t * (to - from), s)) continue;
    const Vec3 d = a + t * (b - a) - s.position;
    const Vec3 tangent = (to.x - from.x) * s.du + (to.y - from.y) * s.dv;
    const double squared = glm::dot(tangent, tangent);
    const Vec3 across = squared > 0 ? d - glm::dot(d, tangent) / squared * tangent : d;
    worst_ = std::max(worst_, glm::length(across));
  }
}

}  // namespace panwright::geometry::internal
