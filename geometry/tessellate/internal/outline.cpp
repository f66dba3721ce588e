#include "geometry/tessellate/internal/outline.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/axis_box.h"
#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/predicates.h"

namespace panwright::geometry::internal {

namespace {

bool left_of(const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }

// Sweeps a line from left to right over the edges. Those it meets are kept in order; whatever
// crosses first were neighbours before.
class CrossingFinder {
 public:
  explicit CrossingFinder(const Region& region)
      : region_(region),
        order_(sweep_order(region.points)),
        rank_(region.size()),
        status_(Order{this}),
        places_(region.size()),
        ccw_(region.loops.size() - 1, kUnknown) {
    for (std::uint32_t i = 0; i < order_.size(); ++i) rank_[order_[i]] = i;
  }

  std::optional<RegionFault> run() {
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      const std::uint32_t v = order_[i];
      if (i > 0 && region_.points[order_[i - 1]] == region_.points[v])
        return RegionFault{RegionFault::Kind::crossing, order_[i - 1], v};
      const std::uint32_t in = region_.prev[v];
      const bool in_starts = rank_[in] > rank_[v];
      const bool out_starts = rank_[region_.next[v]] > rank_[v];
      if (in_starts && out_starts) {
        start(v);
      } else if (in_starts) {
        replace(v, in);
      } else if (out_starts) {
        replace(in, v);
      } else {
        end(in, v);
      }
      if (fault_) return fault_;
    }
    return std::nullopt;
  }

  bool counter_clockwise(std::uint32_t loop) const { return ccw_[loop] == kYes; }

 private:
  enum : std::uint8_t { kUnknown, kNo, kYes };
  struct Slot {
    mutable std::uint32_t edge;  // note: changes only where the order does not
  };
  struct Point {
    std::uint32_t vertex;
  };
  struct Order {
    using is_transparent = void;
    const CrossingFinder* sweep;
    bool operator()(const Slot& a, const Slot& b) const { return sweep->below(a.edge, b.edge); }
    bool operator()(const Slot& a, const Point& p) const {
      return sweep->side(a.edge, p.vertex) > 0;
    }
  };
  using Status = std::set<Slot, Order>;
  using Place = Status::iterator;

  std::uint32_t left(std::uint32_t e) const {
    return rank_[e] < rank_[region_.next[e]] ? e : region_.next[e];
  }
  std::uint32_t right(std::uint32_t e) const {
    return rank_[e] < rank_[region_.next[e]] ? region_.next[e] : e;
  }
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(region_.points[a], region_.points[b], region_.points[c]);
  }
  // 1: the vertex lies above the edge
  int side(std::uint32_t edge, std::uint32_t vertex) const {
    return turn(left(edge), right(edge), vertex);
  }

  bool below(std::uint32_t e, std::uint32_t f) const {
    if (e == f) return false;
    if (left(e) == left(f)) return turn(left(e), right(e), right(f)) > 0;
    if (rank_[left(e)] > rank_[left(f)]) {
      const int s = side(f, left(e));
      return (s != 0 ? s : side(f, right(e))) < 0;
    }
    const int s = side(e, left(f));
    return (s != 0 ? s : side(e, right(f))) > 0;
  }

  bool on(std::uint32_t vertex, std::uint32_t edge) const {
    const Vec2& p = region_.points[vertex];
    return !left_of(p, region_.points[left(edge)]) && !left_of(region_.points[right(edge)], p);
  }

  bool cross(std::uint32_t e, std::uint32_t f) const {
    if (region_.next[e] == f || region_.next[f] == e) return false;
    const int a = side(e, left(f));
    const int b = side(e, right(f));
    const int c = side(f, left(e));
    const int d = side(f, right(e));
    return (a * b < 0 && c * d < 0) || (a == 0 && on(left(f), e)) || (b == 0 && on(right(f), e)) ||
           (c == 0 && on(left(e), f)) || (d == 0 && on(right(e), f));
  }

  void report(RegionFault::Kind kind, std::uint32_t e, std::uint32_t f) {
    if (!fault_) fault_ = RegionFault{kind, e, f};
  }
  void report_crossing(std::uint32_t e, std::uint32_t f) {
    const bool swapped = region_.loop[e] == region_.loop[f] && e > f;
    report(RegionFault::Kind::crossing, swapped ? f : e, swapped ? e : f);
  }
  void compare(Place low, Place high) {
    if (cross(low->edge, high->edge)) report_crossing(low->edge, high->edge);
  }
  void compare_below(Place place) {
    if (place != status_.begin()) compare(std::prev(place), place);
  }
  void compare_above(Place place) {
    const Place above = std::next(place);
    if (above != status_.end()) compare(place, above);
  }

  void start(std::uint32_t v) {
    const std::uint32_t in = region_.prev[v];
    const int bend = turn(in, v, region_.next[v]);
    if (bend == 0) return report_crossing(in, v);
    const Place above = status_.lower_bound(Point{v});
    if (above != status_.end() && side(above->edge, v) == 0) return report_crossing(v, above->edge);
    std::uint8_t& ccw = ccw_[region_.loop[v]];
    if (ccw == kUnknown) {
      ccw = bend > 0 ? kYes : kNo;
      nest(v, above);
      if (fault_) return;
    }
    // the edge that leads here lies above the one that leads on when they turn left
    const Place high = status_.emplace_hint(above, Slot{bend > 0 ? in : v});
    const Place low = status_.emplace_hint(high, Slot{bend > 0 ? v : in});
    places_[high->edge] = high;
    places_[low->edge] = low;
    compare_below(low);
    compare_above(high);
  }

  // The first point of a hole: what lies below it says where it is.
  void nest(std::uint32_t v, Place above) {
    if (region_.loop[v] == 0) return;
    if (above == status_.begin()) return report(RegionFault::Kind::outside, v, 0);
    const std::uint32_t e = std::prev(above)->edge;
    const std::uint32_t loop = region_.loop[e];
    const bool inside = (left(e) == e) == (ccw_[loop] == kYes);
    if (loop == 0 && !inside) report(RegionFault::Kind::outside, v, e);
    if (loop != 0 && inside) report(RegionFault::Kind::nested, v, e);
  }

  void replace(std::uint32_t old_edge, std::uint32_t new_edge) {
    const Place place = places_[old_edge];
    place->edge = new_edge;
    places_[new_edge] = place;
    compare_below(place);
    compare_above(place);
  }

  void end(std::uint32_t a, std::uint32_t b) {
    status_.erase(places_[a]);
    const Place above = status_.erase(places_[b]);
    if (above != status_.end()) compare_below(above);
  }

  const Region& region_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> rank_;  // N
  Status status_;
  std::vector<Place> places_;      // N, of edges
  std::vector<std::uint8_t> ccw_;  // L
  std::optional<RegionFault> fault_;
};

std::optional<RegionFault> coincident(const Region& region) {
  AxisRectangle bounds{region.points.front(), region.points.front()};
  for (std::uint32_t i = 0; i < region.loops[1]; ++i) bounds.add(region.points[i]);
  const double least = kCoincident * bounds.diagonal();
  for (std::uint32_t i = 0; i < region.size(); ++i)
    if (!(glm::length(region.points[region.next[i]] - region.points[i]) > least))
      return RegionFault{RegionFault::Kind::coincident, i, region.next[i]};
  return std::nullopt;
}

}  // namespace

std::vector<std::uint32_t> sweep_order(const std::vector<Vec2>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec2& p = points[a];
    const Vec2& q = points[b];
    if (p.x != q.x) return p.x < q.x;
    return p.y != q.y ? p.y < q.y : a < b;
  });
  return order;
}

Region region_of(std::span<const Vec2> points, std::vector<std::uint32_t> loops) {
  assert(loops.size() >= 2 && loops.back() == points.size());
  Region region;
  region.points.assign(points.begin(), points.end());
  double largest = 0;
  for (const Vec2& p : points) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y)});
  int exponent = 0;
  std::frexp(largest, &exponent);
  // 2^-200 leaves room for the last bits of products of four differences
  const auto scaled = [&](double x) {
    const double y = std::ldexp(x, -exponent);
    return std::fabs(y) < 0x1p-200 ? 0.0 : y;
  };
  for (Vec2& p : region.points) p = {scaled(p.x), scaled(p.y)};
  region.loops = std::move(loops);
  region.loop.resize(points.size());
  region.next.resize(points.size());
  region.prev.resize(points.size());
  for (std::uint32_t l = 0; l + 1 < region.loops.size(); ++l) {
    const std::uint32_t begin = region.loops[l];
    const std::uint32_t end = region.loops[l + 1];
    assert(end - begin >= 3);
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t next = i + 1 < end ? i + 1 : begin;
      region.loop[i] = l;
      region.next[i] = next;
      region.prev[next] = i;
    }
  }
  return region;
}

std::optional<RegionFault> fault_of(Region& region) {
  if (const auto fault = coincident(region)) return fault;
  CrossingFinder finder(region);
  if (const auto fault = finder.run()) return fault;
  for (std::uint32_t i = 0; i < region.size(); ++i)
    if (finder.counter_clockwise(region.loop[i]) != (region.loop[i] == 0))
      std::swap(region.next[i], region.prev[i]);
  return std::nullopt;
}

}  // namespace panwright::geometry::internal
