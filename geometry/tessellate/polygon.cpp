#include "geometry/tessellate/polygon.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "geometry/tessellate/internal/outline.h"
#include "geometry/tessellate/internal/predicates.h"
#include "geometry/tessellate/internal/triangulate.h"

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

// The corners that can lie in an ear, those that do not turn left, by squares of the plane.
class Blockers {
 public:
  Blockers(const std::vector<Vec2>& plane, const std::vector<int>& turn)
      : plane_(plane), is_one_(plane.size(), false), listed_(plane.size(), false) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t v = 0; v < plane.size(); ++v)
      if (turn[v] <= 0) all.push_back(v);
    for (const std::uint32_t v : all) is_one_[v] = listed_[v] = true;
    low_ = plane[0];
    Vec2 high = low_;
    for (const Vec2& p : plane) {
      low_ = glm::min(low_, p);
      high = glm::max(high, p);
    }
    constexpr std::size_t kMostSquares = 1024;  // on a side
    side_ = 1 + std::min(kMostSquares - 1,
                         static_cast<std::size_t>(std::sqrt(static_cast<double>(all.size()) / 4)));
    per_length_ = Vec2(static_cast<double>(side_)) / glm::max(high - low_, Vec2(1e-300));
    start_.assign(side_ * side_ + 2, 0);
    for (const std::uint32_t v : all) ++start_[square(plane[v]) + 2];
    for (std::size_t i = 2; i < start_.size(); ++i) start_[i] += start_[i - 1];
    list_.resize(all.size());
    for (const std::uint32_t v : all) list_[start_[square(plane[v]) + 1]++] = v;
  }

  void set(std::uint32_t v, bool is_one) {
    is_one_[v] = is_one;
    if (!is_one || listed_[v]) return;
    listed_[v] = true;
    late_.push_back(v);
  }

  // Calls blocks(v) for those in a rectangle until one says yes. *steps grows by the work done.
  template <class Blocks>
  bool any(const Vec2& low, const Vec2& high, const Blocks& blocks, std::uint64_t* steps) const {
    const auto found = [&](std::uint32_t v) {
      const Vec2& p = plane_[v];
      return is_one_[v] && p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y &&
             blocks(v);
    };
    const std::size_t first = column(low.x, 0), last = column(high.x, 0);
    for (std::size_t row = column(low.y, 1); row <= column(high.y, 1); ++row) {
      const std::uint32_t begin = start_[row * side_ + first];
      const std::uint32_t end = start_[row * side_ + last + 1];
      *steps += 1 + end - begin;
      for (std::uint32_t i = begin; i < end; ++i)
        if (found(list_[i])) return true;
    }
    *steps += late_.size();
    return std::ranges::any_of(late_, found);
  }

 private:
  std::size_t column(double at, int axis) const {
    const double i = (at - low_[axis]) * per_length_[axis];
    return i > 0 ? std::min(side_ - 1, static_cast<std::size_t>(i)) : 0;
  }
  std::size_t square(const Vec2& p) const { return column(p.y, 1) * side_ + column(p.x, 0); }

  const std::vector<Vec2>& plane_;
  std::vector<bool> is_one_;
  std::vector<bool> listed_;
  std::size_t side_ = 1;
  Vec2 low_{0};
  Vec2 per_length_{0};
  std::vector<std::uint32_t> start_;  // of the squares in list_, row by row
  std::vector<std::uint32_t> list_;
  std::vector<std::uint32_t> late_;  // that were none at first
};

// Cuts off corner after corner whose triangle holds nothing else of the outline. Meisters,
// "Polygons have ears", 1975.
class EarCutter {
 public:
  EarCutter(const std::vector<Vec2>& plane, std::vector<Triangle>& triangles)
      : plane_(plane),
        triangles_(triangles),
        left_(plane.size()),
        most_steps_(kStepsPerCorner * plane.size()),
        next_(linked(plane.size(), 1)),
        prev_(linked(plane.size(), plane.size() - 1)),
        turn_(turns()),
        quality_(plane.size(), 0),
        blockers_(plane, turn_) {}

  void run() {
    evaluate_all(false);
    bool fresh = true;
    while (left_ > 3 && steps_ < most_steps_) {
      std::uint32_t ear = best();
      if (ear == kNone && !fresh) {
        evaluate_all(false);
        fresh = true;
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

  struct Ear {
    double quality;
    std::uint32_t corner;
    // the best on top, of equals the first corner
    bool operator<(const Ear& other) const {
      return quality != other.quality ? quality < other.quality : corner > other.corner;
    }
  };

  static std::vector<std::uint32_t> linked(std::size_t n, std::size_t step) {
    std::vector<std::uint32_t> out(n);
    for (std::size_t i = 0; i < n; ++i) out[i] = u32((i + step) % n);
    return out;
  }
  std::vector<int> turns() const {
    std::vector<int> out(plane_.size());
    for (std::uint32_t v = 0; v < out.size(); ++v) out[v] = turn_at(v);
    return out;
  }

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.push_back({a, b, c}); }

  int turn_at(std::uint32_t v) const {
    return internal::orientation(plane_[prev_[v]], plane_[v], plane_[next_[v]]);
  }

  void evaluate_all(bool lenient) {
    ears_ = {};
    std::uint32_t v = first_;
    for (std::size_t i = 0; i < left_; ++i, v = next_[v]) evaluate(v, lenient);
  }

  void evaluate(std::uint32_t b, bool lenient) {
    ++steps_;
    quality_[b] = quality(b, lenient);
    if (quality_[b] > 0) ears_.push({quality_[b], b});
  }

  // 0: not an ear.
  double quality(std::uint32_t b, bool lenient) {
    const std::uint32_t a = prev_[b];
    const std::uint32_t c = next_[b];
    if (turn_[b] == 0 && turns_back(a, b, c)) return kTurnsBack;
    if (turn_[b] <= 0) return 0;
    const Vec2 low = glm::min(glm::min(plane_[a], plane_[b]), plane_[c]);
    const Vec2 high = glm::max(glm::max(plane_[a], plane_[b]), plane_[c]);
    const auto blocks_ear = [&](std::uint32_t p) {
      return p != a && p != b && p != c && blocks(p, a, b, c, lenient);
    };
    if (blockers_.any(low, high, blocks_ear, &steps_)) return 0;
    // note: never 0 for an ear
    return roundness(plane_[a], plane_[b], plane_[c]) + 1e-300;
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
    while (!ears_.empty()) {
      const Ear ear = ears_.top();
      if (quality_[ear.corner] == ear.quality) return ear.corner;
      ears_.pop();
    }
    return kNone;
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
    next_[a] = c;
    prev_[c] = a;
    if (first_ == b) first_ = c;
    --left_;
    quality_[b] = 0;
    blockers_.set(b, false);
    for (const std::uint32_t v : {a, c}) {
      turn_[v] = turn_at(v);
      blockers_.set(v, turn_[v] <= 0);
    }
    evaluate(a, false);
    evaluate(c, false);
  }

  const std::vector<Vec2>& plane_;
  std::vector<Triangle>& triangles_;
  std::size_t left_;
  std::uint64_t steps_ = 0;
  std::uint64_t most_steps_;
  std::uint32_t first_ = 0;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> prev_;
  std::vector<int> turn_;
  std::vector<double> quality_;    // of ears; 0: not an ear
  std::priority_queue<Ear> ears_;  // with some that are none any more
  Blockers blockers_;
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
