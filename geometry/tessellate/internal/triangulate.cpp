#include "geometry/tessellate/internal/triangulate.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <set>

#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/predicates.h"

namespace panwright::geometry::internal {

namespace {

constexpr std::uint64_t kFlipsPerTriangle = 64;

// Where the sweep line runs through the region it is cut into intervals, each between a lower and
// an upper edge. The triangles of an interval end at its front: a chain of points from the lower
// edge to the upper one that no further triangle can be cut from, so that it bulges to the right.
class Sweep {
 public:
  explicit Sweep(const Region& region)
      : region_(region), rank_(region.size()), status_(Order{this}), interval_of_(region.size()) {
    triangles_.reserve(region.size() + 2 * region.loops.size());
    links_.reserve(2 * region.size());
  }

  std::vector<Triangle> run() {
    const std::vector<std::uint32_t> order = sweep_order(region_.points);
    for (std::uint32_t i = 0; i < order.size(); ++i) rank_[order[i]] = i;
    for (const std::uint32_t v : order) visit(v);
    assert(status_.empty());
    return std::move(triangles_);
  }

 private:
  struct Link {
    std::uint32_t vertex;
    std::uint32_t down = kNone;  // towards the lower edge
    std::uint32_t up = kNone;
  };
  struct Interval {
    mutable std::uint32_t lower;  // note: changes only where the order does not
    mutable std::uint32_t upper;
    mutable std::uint32_t bottom;  // links: the ends of the front
    mutable std::uint32_t top;
    mutable std::uint32_t tip;  // the link of its rightmost point
  };
  struct Point {
    std::uint32_t vertex;
  };
  struct Order {
    using is_transparent = void;
    const Sweep* sweep;
    bool operator()(const Interval& a, const Interval& b) const {
      return sweep->below(a.lower, b.lower);
    }
    bool operator()(const Interval& a, const Point& p) const {
      return sweep->turn(a.lower, sweep->region_.next[a.lower], p.vertex) > 0;
    }
  };
  using Status = std::set<Interval, Order>;
  using Place = Status::iterator;

  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(region_.points[a], region_.points[b], region_.points[c]);
  }

  // note: lower edges run from left to right
  bool below(std::uint32_t e, std::uint32_t f) const {
    if (e == f) return false;
    const std::uint32_t e_end = region_.next[e];
    const std::uint32_t f_end = region_.next[f];
    if (rank_[e] > rank_[f]) {
      const int s = turn(f, f_end, e);
      return (s != 0 ? s : turn(f, f_end, e_end)) < 0;
    }
    const int s = turn(e, e_end, f);
    return (s != 0 ? s : turn(e, e_end, f_end)) > 0;
  }

  void visit(std::uint32_t v) {
    const std::uint32_t in = region_.prev[v];  // also the edge that leads here
    const std::uint32_t out = region_.next[v];
    const bool from_left = rank_[in] < rank_[v];
    const bool to_right = rank_[v] < rank_[out];
    if (from_left && to_right) {
      const Place at = interval_of_[in];
      add_below(*at, v);
      at->lower = v;
      interval_of_[v] = at;
    } else if (!from_left && !to_right) {
      const Place at = interval_of_[v];
      add_above(*at, v);
      at->upper = in;
      interval_of_[in] = at;
    } else if (to_right) {
      turn(in, v, out) > 0 ? begin(v) : split(v);
    } else {
      interval_of_[in] == interval_of_[v] ? end(v) : merge(v);
    }
  }

  std::uint32_t new_link(std::uint32_t v) {
    links_.push_back({v});
    return static_cast<std::uint32_t>(links_.size() - 1);
  }
  void join(std::uint32_t down, std::uint32_t up) {
    links_[down].up = up;
    links_[up].down = down;
  }
  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back({links_[a].vertex, links_[b].vertex, links_[c].vertex});
  }

  // Puts a point below the front's end, and cuts off the triangles that this opens.
  std::uint32_t attach_below(std::uint32_t bottom, std::uint32_t v) {
    const std::uint32_t link = new_link(v);
    while (links_[bottom].up != kNone) {
      const std::uint32_t above = links_[bottom].up;
      if (turn(links_[bottom].vertex, v, links_[above].vertex) <= 0) break;
      emit(bottom, link, above);
      bottom = above;
    }
    join(link, bottom);
    return link;
  }
  std::uint32_t attach_above(std::uint32_t top, std::uint32_t v) {
    const std::uint32_t link = new_link(v);
    while (links_[top].down != kNone) {
      const std::uint32_t under = links_[top].down;
      if (turn(links_[under].vertex, v, links_[top].vertex) <= 0) break;
      emit(under, link, top);
      top = under;
    }
    join(top, link);
    return link;
  }
  void add_below(const Interval& at, std::uint32_t v) {
    at.tip = at.bottom = attach_below(at.bottom, v);
  }
  void add_above(const Interval& at, std::uint32_t v) { at.tip = at.top = attach_above(at.top, v); }

  void begin(std::uint32_t v) {
    const std::uint32_t link = new_link(v);
    const std::uint32_t in = region_.prev[v];
    const Place at =
        status_.emplace_hint(status_.lower_bound(Point{v}), Interval{v, in, link, link, link});
    interval_of_[v] = interval_of_[in] = at;
  }

  // Both parts keep the tip, from where the point is seen.
  void split(std::uint32_t v) {
    const Place above = status_.lower_bound(Point{v});
    assert(above != status_.begin());
    const Place at = std::prev(above);
    const std::uint32_t in = region_.prev[v];
    const std::uint32_t tip = at->tip;
    const std::uint32_t twin = new_link(links_[tip].vertex);
    Interval high{v, at->upper, kNone, at->top == tip ? twin : at->top, kNone};
    if (links_[tip].up != kNone) join(twin, links_[tip].up);
    links_[tip].up = kNone;
    high.tip = high.bottom = attach_below(twin, v);
    at->upper = in;
    at->tip = at->top = attach_above(tip, v);
    interval_of_[in] = at;
    const Place high_at = status_.emplace_hint(above, high);
    interval_of_[v] = interval_of_[high.upper] = high_at;
  }

  // The edge that leads here is the lower one of the interval above.
  void merge(std::uint32_t v) {
    const Place low = interval_of_[v];
    const Place high = interval_of_[region_.prev[v]];
    const std::uint32_t tip = attach_above(low->top, v);
    const std::uint32_t other = attach_below(high->bottom, v);
    join(tip, links_[other].up);
    low->tip = tip;
    low->top = high->top;
    low->upper = high->upper;
    interval_of_[low->upper] = low;
    status_.erase(high);
  }

  void end(std::uint32_t v) {
    const Place at = interval_of_[v];
    for (std::uint32_t link = at->bottom; links_[link].up != kNone; link = links_[link].up)
      triangles_.push_back({links_[link].vertex, v, links_[links_[link].up].vertex});
    status_.erase(at);
  }

  const Region& region_;
  std::vector<std::uint32_t> rank_;  // N
  Status status_;
  std::vector<Place> interval_of_;  // N, of edges
  std::vector<Link> links_;
  std::vector<Triangle> triangles_;
};

// A side is 3·triangle + place, from that corner to the next.
class Flipper {
 public:
  Flipper(const Region& region, std::span<const Vec3> space, std::vector<Triangle>& triangles)
      : region_(region), space_(space), triangles_(triangles) {}

  void run() {
    match();
    std::vector<std::uint32_t> queue;
    std::vector<bool> waiting(twin_.size(), false);
    const auto push = [&](std::uint32_t side) {
      if (twin_[side] == kNone) return;
      side = std::min(side, twin_[side]);
      if (waiting[side]) return;
      waiting[side] = true;
      queue.push_back(side);
    };
    for (auto side = static_cast<std::uint32_t>(twin_.size()); side-- > 0;) push(side);
    std::uint64_t left = kFlipsPerTriangle * triangles_.size();
    while (!queue.empty() && left > 0) {
      const std::uint32_t side = queue.back();
      queue.pop_back();
      waiting[side] = false;
      if (twin_[side] == kNone || !should_flip(side)) continue;
      --left;
      const std::uint32_t other = twin_[side];
      flip(side);
      for (const std::uint32_t s : {side, other}) {
        const std::uint32_t first = s - s % 3;
        for (std::uint32_t k = 0; k < 3; ++k) push(first + k);
      }
    }
  }

 private:
  std::uint32_t corner(std::uint32_t side, std::uint32_t step = 0) const {
    return triangles_[side / 3][(side + step) % 3];
  }
  static std::uint32_t after(std::uint32_t side, std::uint32_t step) {
    return side - side % 3 + (side + step) % 3;
  }

  // Finds the triangle beyond each side.
  void match() {
    twin_.assign(3 * triangles_.size(), kNone);
    std::vector<std::uint32_t> start(region_.size() + 2, 0);
    for (std::uint32_t s = 0; s < twin_.size(); ++s) ++start[std::min(corner(s), corner(s, 1)) + 2];
    for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<std::uint32_t> sides(start.back());
    const auto high = [&](std::uint32_t s) { return std::max(corner(s), corner(s, 1)); };
    for (std::uint32_t s = 0; s < twin_.size(); ++s)
      sides[start[std::min(corner(s), corner(s, 1)) + 1]++] = s;
    for (std::uint32_t v = 0; v < region_.size(); ++v) {
      const auto begin = sides.begin() + start[v];
      const auto end = sides.begin() + start[v + 1];
      std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
        return high(a) != high(b) ? high(a) < high(b) : a < b;
      });
      for (auto i = begin; i != end && i + 1 != end; ++i) {
        if (high(*i) != high(i[1])) continue;
        twin_[*i] = i[1];
        twin_[i[1]] = *i;
      }
    }
  }

  double squared_distance(std::uint32_t a, std::uint32_t b) const {
    if (space_.empty()) {
      const Vec2 d = region_.points[a] - region_.points[b];
      return d.x * d.x + d.y * d.y;
    }
    const Vec3 d = space_[a] - space_[b];
    return d.x * d.x + d.y * d.y + d.z * d.z;
  }

  bool should_flip(std::uint32_t side) const {
    const std::uint32_t a = corner(side), b = corner(side, 1), c = corner(side, 2);
    const std::uint32_t d = corner(twin_[side], 2);
    const auto& p = region_.points;
    const Vec3 lift(squared_distance(a, d), squared_distance(b, d), squared_distance(c, d));
    return clearly_in_circle(p[a], p[b], p[c], p[d], lift) && orientation(p[a], p[d], p[c]) > 0 &&
           orientation(p[d], p[b], p[c]) > 0;
  }

  // abc and bad become adc and dbc: `side` is then ad, its twin db.
  void flip(std::uint32_t side) {
    const std::uint32_t other = twin_[side];
    const std::uint32_t c = corner(side, 2);
    const std::uint32_t d = corner(other, 2);
    const std::uint32_t bc = twin_[after(side, 1)];
    const std::uint32_t ad = twin_[after(other, 1)];
    triangles_[side / 3][(side + 1) % 3] = d;
    triangles_[other / 3][(other + 1) % 3] = c;
    // the triangles are now a d c from `side`, and b c d from `other`
    link(side, ad);
    link(other, bc);
    link(after(side, 1), after(other, 1));
  }
  void link(std::uint32_t s, std::uint32_t t) {
    twin_[s] = t;
    if (t != kNone) twin_[t] = s;
  }

  const Region& region_;
  std::span<const Vec3> space_;
  std::vector<Triangle>& triangles_;
  std::vector<std::uint32_t> twin_;  // 3*T
};

}  // namespace

std::vector<Triangle> triangulated(const Region& region, std::span<const Vec3> space) {
  assert(space.empty() || space.size() == region.points.size());
  std::vector<Triangle> triangles = Sweep(region).run();
  Flipper(region, space, triangles).run();
  return triangles;
}

}  // namespace panwright::geometry::internal
