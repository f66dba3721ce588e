#include "geometry/polygon.h"

#include <algorithm>
#include <cmath>

#include "geometry/internal/outline.h"
#include "geometry/internal/predicates.h"
#include "geometry/internal/triangulate.h"

namespace panwright::geometry {

namespace {

constexpr std::size_t kSweepFrom = 192;          // corners, above which a sweep is tried first
constexpr std::uint64_t kStepsPerCorner = 4096;  // of cutting ears
constexpr double kTurnsBack = 2;                 // before all ears: roundness stays below 1
constexpr double kFlatShare = 1e-12;             // a normal below this of the extent² says nothing

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

void fan(std::size_t n, std::vector<Triangle>& triangles) {
  for (std::size_t i = 1; i + 1 < n; ++i) triangles.push_back({0, u32(i), u32(i + 1)});
}

double squared(const Vec3& v) { return glm::dot(v, v); }

// 0 without area, the same for all sizes, greatest for an equilateral triangle.
double roundness(const Vec3& cross, double squares) {
  return squares > 0 ? squared(cross) / (squares * squares) : 0;
}

double roundness(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec3 ab(b - a, 0), bc(c - b, 0), ca(a - c, 0);
  return roundness(glm::cross(ab, bc), squared(ab) + squared(bc) + squared(ca));
}

// Cuts off corner after corner whose triangle holds nothing else of the outline. Meisters,
// "Polygons have ears", 1975.
class EarCutter {
 public:
  EarCutter(const std::vector<Vec2>& plane, std::vector<Triangle>& triangles)
      : plane_(plane),
        triangles_(triangles),
        left_(plane.size()),
        steps_(kStepsPerCorner * plane.size()),
        next_(plane.size()),
        prev_(plane.size()),
        turn_(plane.size()),
        quality_(plane.size(), 0) {
    for (std::uint32_t i = 0; i < left_; ++i) {
      next_[i] = i + 1 == left_ ? 0 : i + 1;
      prev_[i] = i == 0 ? u32(left_ - 1) : i - 1;
    }
  }

  void run() {
    for (std::uint32_t v = first_, i = 0; i < left_; v = next_[v], ++i) turn_[v] = turn_at(v);
    list_blockers();
    bool fresh = evaluate_all(false);
    while (left_ > 3 && steps_ > 0) {
      std::uint32_t ear = best();
      if (ear == kNone && !fresh) {
        fresh = evaluate_all(false);
        continue;
      }
      if (ear == kNone) ear = forced();
      cut(ear);
      fresh = false;
    }
    for (; left_ > 2; --left_) {
      const std::uint32_t b = next_[first_];
      emit(first_, b, next_[b]);
      next_[first_] = next_[b];
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.push_back({a, b, c}); }

  int turn_at(std::uint32_t v) const {
    return internal::orientation(plane_[prev_[v]], plane_[v], plane_[next_[v]]);
  }

  void unlink(std::uint32_t v) {
    next_[prev_[v]] = next_[v];
    prev_[next_[v]] = prev_[v];
    if (first_ == v) first_ = next_[v];
    --left_;
  }

  // Only corners that do not turn left can lie in an ear.
  void list_blockers() {
    blockers_.clear();
    std::uint32_t v = first_;
    for (std::size_t i = 0; i < left_; ++i, v = next_[v])
      if (turn_[v] <= 0) blockers_.push_back(v);
  }

  bool evaluate_all(bool lenient) {
    std::uint32_t v = first_;
    for (std::size_t i = 0; i < left_; ++i, v = next_[v]) evaluate(v, lenient);
    return true;
  }

  void evaluate(std::uint32_t b, bool lenient) {
    const std::uint32_t a = prev_[b];
    const std::uint32_t c = next_[b];
    quality_[b] = 0;
    if (turn_[b] == 0 && turns_back(a, b, c)) quality_[b] = kTurnsBack;
    if (turn_[b] <= 0) return;
    const double x_min = std::min({plane_[a].x, plane_[b].x, plane_[c].x});
    const double x_max = std::max({plane_[a].x, plane_[b].x, plane_[c].x});
    const double y_min = std::min({plane_[a].y, plane_[b].y, plane_[c].y});
    const double y_max = std::max({plane_[a].y, plane_[b].y, plane_[c].y});
    steps_ -= std::min<std::uint64_t>(steps_, 1 + blockers_.size());
    for (const std::uint32_t p : blockers_) {
      const Vec2& at = plane_[p];
      if (at.x < x_min || at.x > x_max || at.y < y_min || at.y > y_max) continue;
      if (p != a && p != b && p != c && blocks(p, a, b, c, lenient)) return;
    }
    // note: never 0 for an ear
    quality_[b] = roundness(plane_[a], plane_[b], plane_[c]) + 1e-300;
  }

  // Of three in a line: what is cut off has no area, and must go before it is taken for a wall.
  bool turns_back(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (plane_[a] == plane_[b] || plane_[b] == plane_[c]) return true;
    return glm::dot(plane_[a] - plane_[b], plane_[c] - plane_[b]) > 0;
  }

  bool blocks(std::uint32_t p, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              bool lenient) const {
    const int ab = internal::orientation(plane_[a], plane_[b], plane_[p]);
    const int bc = internal::orientation(plane_[b], plane_[c], plane_[p]);
    const int ca = internal::orientation(plane_[c], plane_[a], plane_[p]);
    if (ab < 0 || bc < 0 || ca < 0) return false;
    if (plane_[p] == plane_[a]) return enters(p, a, b, c);
    if (plane_[p] == plane_[b]) return enters(p, b, c, a);
    if (plane_[p] == plane_[c]) return enters(p, c, a, b);
    return !lenient || (ab > 0 && bc > 0 && ca > 0);
  }

  // Whether the outline runs from p, which lies at the tip, to between the rays to right and left.
  bool enters(std::uint32_t p, std::uint32_t tip, std::uint32_t right, std::uint32_t left) const {
    for (const std::uint32_t q : {prev_[p], next_[p]})
      if (internal::orientation(plane_[tip], plane_[right], plane_[q]) > 0 &&
          internal::orientation(plane_[tip], plane_[left], plane_[q]) < 0)
        return true;
    return false;
  }

  std::uint32_t best() {
    steps_ -= std::min<std::uint64_t>(steps_, left_);
    std::uint32_t found = kNone;
    std::uint32_t v = first_;
    for (std::size_t i = 0; i < left_; ++i, v = next_[v])
      if (quality_[v] > 0 && (found == kNone || quality_[v] > quality_[found])) found = v;
    return found;
  }

  // A corner to cut off where there is no ear: touched by the outline, without area, else any.
  std::uint32_t forced() {
    evaluate_all(true);
    if (const std::uint32_t ear = best(); ear != kNone) return ear;
    std::uint32_t found = kNone;
    std::uint32_t v = first_;
    for (std::size_t i = 0; i < left_; ++i, v = next_[v]) {
      if (turn_[v] == 0) return v;
      if (found == kNone && turn_[v] > 0) found = v;
    }
    return found != kNone ? found : first_;
  }

  void cut(std::uint32_t b) {
    const std::uint32_t a = prev_[b];
    const std::uint32_t c = next_[b];
    emit(a, b, c);
    unlink(b);
    bool changed = turn_[b] <= 0;
    for (const std::uint32_t v : {a, c}) {
      const int turn = turn_at(v);
      changed = changed || (turn <= 0) != (turn_[v] <= 0);
      turn_[v] = turn;
    }
    if (changed) list_blockers();
    steps_ -= std::min<std::uint64_t>(steps_, left_);
    evaluate(a, false);
    evaluate(c, false);
  }

  const std::vector<Vec2>& plane_;
  std::vector<Triangle>& triangles_;
  std::size_t left_;
  std::uint64_t steps_;
  std::uint32_t first_ = 0;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> prev_;
  std::vector<int> turn_;
  std::vector<double> quality_;  // of ears; 0: not an ear
  std::vector<std::uint32_t> blockers_;
};

}  // namespace

bool cuts_better_from_second(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, bc = c - b, cd = d - c, da = a - d, ac = c - a, bd = d - b;
  const double ab2 = squared(ab), bc2 = squared(bc), cd2 = squared(cd), da2 = squared(da);
  const double ac2 = squared(ac), bd2 = squared(bd);
  const Vec3 abc = glm::cross(ab, bc), acd = glm::cross(ac, cd);
  const Vec3 abd = glm::cross(ab, bd), bcd = glm::cross(bc, cd);
  const bool first_inside = glm::dot(abc, acd) > 0;
  const bool second_inside = glm::dot(abd, bcd) > 0;
  if (first_inside != second_inside) return second_inside;
  const double first = std::min(roundness(abc, ab2 + bc2 + ac2), roundness(acd, ac2 + cd2 + da2));
  const double second = std::min(roundness(abd, ab2 + bd2 + da2), roundness(bcd, bc2 + cd2 + bd2));
  // note: equal up to rounding is a tie, so that grids look even
  return second > first * (1 + 1e-9);
}

void PolygonCutter::cut(std::span<const Vec3> corners, std::vector<Triangle>& triangles) {
  const std::size_t n = corners.size();
  if (n < 3) return;
  if (n == 3) {
    triangles.push_back({0, 1, 2});
  } else if (n == 4) {
    if (cuts_better_from_second(corners[0], corners[1], corners[2], corners[3])) {
      triangles.push_back({0, 1, 3});
      triangles.push_back({1, 2, 3});
    } else {
      fan(n, triangles);
    }
  } else if (!project(corners) || is_strictly_convex()) {
    fan(n, triangles);
  } else if (n < kSweepFrom || !cut_by_sweep(corners, triangles)) {
    EarCutter(plane_, triangles).run();
  }
}

// Into the plane of the two axes across the normal; no rounding but a power of two. False when all
// corners lie on one line.
bool PolygonCutter::project(std::span<const Vec3> corners) {
  double largest = 0;
  for (const Vec3& p : corners)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  if (!(largest > 0)) return false;
  int exponent = 0;
  std::frexp(largest, &exponent);
  const double half = std::ldexp(1.0, -(exponent / 2));
  const double rest = std::ldexp(1.0, -(exponent - exponent / 2));
  const auto scaled = [&](const Vec3& p) { return p * half * rest; };

  const Vec3 origin = scaled(corners[0]);
  Vec3 normal(0);
  Vec3 widest(0);
  double extent = 0;
  Vec3 before(0);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vec3 at = scaled(corners[i]) - origin;
    const Vec3 cross = glm::cross(before, at);
    normal += cross;
    if (squared(cross) > squared(widest)) widest = cross;
    extent = std::max(extent, squared(at));
    before = at;
  }
  // an outline that crosses itself can have as much area on the one side as on the other
  if (!(squared(normal) > (kFlatShare * extent) * (kFlatShare * extent))) normal = widest;
  if (normal == Vec3(0)) return false;
  const Vec3 size(std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z));
  const int axis = size.z >= size.x && size.z >= size.y ? 2 : size.x >= size.y ? 0 : 1;
  int right = (axis + 1) % 3;
  int up = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(right, up);
  plane_.clear();
  for (const Vec3& p : corners) {
    const Vec3 at = scaled(p);
    plane_.push_back({at[right], at[up]});
  }
  return true;
}

// Every corner turns left, and the edges go round once.
bool PolygonCutter::is_strictly_convex() const {
  const std::size_t n = plane_.size();
  const auto to_right = [](const Vec2& a, const Vec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  };
  int changes = 0;
  bool before = to_right(plane_[n - 1], plane_[0]);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& b = plane_[i];
    const Vec2& c = plane_[i + 1 == n ? 0 : i + 1];
    if (internal::orientation(plane_[i == 0 ? n - 1 : i - 1], b, c) <= 0) return false;
    const bool now = to_right(b, c);
    changes += now != before;
    before = now;
  }
  return changes == 2;
}

bool PolygonCutter::cut_by_sweep(std::span<const Vec3> corners,
                                 std::vector<Triangle>& triangles) const {
  internal::Region region = internal::region_of(plane_, {0, u32(plane_.size())});
  if (internal::fault_of(region)) return false;
  const std::vector<Triangle> cut = internal::triangulated(region, corners);
  triangles.insert(triangles.end(), cut.begin(), cut.end());
  return true;
}

}  // namespace panwright::geometry
