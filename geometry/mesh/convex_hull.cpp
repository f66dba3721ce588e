#include "geometry/mesh/convex_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace panwright::geometry {

namespace {

constexpr double kSame = 1e-11;  // of the extent: on a plane
constexpr double kFlat = 1e-9;   // of the extent: the height of a body that is none

class HullBuilder {
 public:
  HullBuilder(std::span<const Vec3> points, const Job& job) : points_(points), job_(job) {}

  std::optional<std::vector<Triangle>> run() {
    if (!begin()) return std::nullopt;
    for (std::size_t f = 0; f < facets_.size(); ++f)
      while (facets_[f].alive && !facets_[f].outside.empty()) add_farthest(f);
    std::vector<Triangle> out;
    for (const Facet& facet : facets_)
      if (facet.alive) out.push_back(facet.corners);
    return out;
  }

 private:
  struct Facet {
    Triangle corners{};
    std::array<std::size_t, 3> beside{};  // across the edge from corner k to the next
    Vec3 normal{0};
    double offset = 0;
    std::vector<std::uint32_t> outside;  // points that are beyond its plane, each of one facet
    bool alive = true;
    std::uint32_t visit = 0;
  };

  double height(const Facet& facet, std::uint32_t p) const {
    return glm::dot(facet.normal, points_[p]) - facet.offset;
  }

  // A facet with the normal of its corners; false: they lie on one line.
  bool set_plane(Facet& facet) const {
    const auto& [a, b, c] = facet.corners;
    const Vec3 cross = glm::cross(points_[b] - points_[a], points_[c] - points_[a]);
    const double length = glm::length(cross);
    if (!(length > 0)) return false;
    facet.normal = cross / length;
    facet.offset = glm::dot(facet.normal, points_[a]);
    return true;
  }

  template <class Measure>
  std::uint32_t farthest(const Measure& measure) const {
    std::uint32_t best = 0;
    for (std::uint32_t p = 1; p < points_.size(); ++p)
      if (measure(p) > measure(best)) best = p;
    return best;
  }

  // The first four facets; false: all points lie in one plane.
  bool begin() {
    if (points_.size() < 4) return false;
    Vec3 low = points_[0], high = low;
    for (const Vec3& p : points_) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    const double extent = glm::length(high - low);
    same_ = kSame * extent;
    const std::uint32_t a = farthest([&](std::uint32_t p) { return -points_[p].x; });
    const auto from_a = [&](std::uint32_t p) { return glm::length(points_[p] - points_[a]); };
    const std::uint32_t b = farthest(from_a);
    if (!(from_a(b) > kFlat * extent)) return false;
    const Vec3 along = (points_[b] - points_[a]) / from_a(b);
    const auto from_line = [&](std::uint32_t p) {
      return glm::length(glm::cross(points_[p] - points_[a], along));
    };
    const std::uint32_t c = farthest(from_line);
    if (!(from_line(c) > kFlat * extent)) return false;
    Facet base;
    base.corners = {a, b, c};
    if (!set_plane(base)) return false;
    const std::uint32_t d = farthest([&](std::uint32_t p) { return std::fabs(height(base, p)); });
    const double top = height(base, d);
    if (!(std::fabs(top) > kFlat * extent)) return false;
    const bool above = top > 0;
    const Triangle t = above ? Triangle{a, c, b} : Triangle{a, b, c};
    for (const Triangle& corners :
         {t, Triangle{t[1], t[0], d}, Triangle{t[2], t[1], d}, Triangle{t[0], t[2], d}}) {
      facets_.emplace_back().corners = corners;
      if (!set_plane(facets_.back())) return false;
    }
    facets_[0].beside = {1, 2, 3};
    facets_[1].beside = {0, 3, 2};
    facets_[2].beside = {0, 1, 3};
    facets_[3].beside = {0, 2, 1};
    for (std::uint32_t p = 0; p < points_.size(); ++p) give(p, 0);
    return true;
  }

  // Gives a point to the first facet from `first` on that it is beyond.
  void give(std::uint32_t p, std::size_t first) {
    for (std::size_t f = first; f < facets_.size(); ++f)
      if (facets_[f].alive && height(facets_[f], p) > same_) {
        facets_[f].outside.push_back(p);
        return;
      }
  }

  struct Edge {
    std::uint32_t from, to;
    std::size_t beyond;  // the facet that stays
  };

  // The facets that a point is beyond, and the edges around them. False: these are no one ring.
  bool find_horizon(std::size_t start, std::uint32_t p) {
    seen_.assign(1, start);
    horizon_.clear();
    facets_[start].visit = ++visit_;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      for (const std::size_t beside : facets_[seen_[i]].beside) {
        Facet& other = facets_[beside];
        if (other.visit == visit_ || height(other, p) <= same_) continue;
        other.visit = visit_;
        seen_.push_back(beside);
      }
    }
    starts_.clear();
    for (const std::size_t f : seen_)
      for (std::size_t k = 0; k < 3; ++k)
        if (facets_[facets_[f].beside[k]].visit != visit_) {
          const Edge edge{facets_[f].corners[k], facets_[f].corners[(k + 1) % 3],
                          facets_[f].beside[k]};
          if (!starts_.try_emplace(edge.from, horizon_.size()).second) return false;
          horizon_.push_back(edge);
        }
    std::size_t ring = 0;
    if (horizon_.size() < 3) return false;
    for (std::uint32_t v = horizon_[0].from; ring <= horizon_.size();) {
      const auto next = starts_.find(v);
      if (next == starts_.end()) return false;
      v = horizon_[next->second].to;
      ++ring;
      if (v == horizon_[0].from) break;
    }
    if (ring != horizon_.size()) return false;
    return std::ranges::all_of(horizon_, [&](const Edge& edge) {
      Facet facet;
      facet.corners = {edge.from, edge.to, p};
      return set_plane(facet);
    });
  }

  void add_farthest(std::size_t f) {
    job_.poll();
    std::vector<std::uint32_t>& outside = facets_[f].outside;
    const auto far = std::ranges::max_element(
        outside, {}, [&](std::uint32_t p) { return height(facets_[f], p); });
    const std::uint32_t p = *far;
    outside.erase(far);
    // note: rounding alone makes a horizon that is no ring; the point is then on the hull
    if (!find_horizon(f, p)) return;
    const std::size_t first = facets_.size();
    for (const Edge& edge : horizon_) {
      Facet& facet = facets_.emplace_back();
      facet.corners = {edge.from, edge.to, p};
      set_plane(facet);
      facet.beside[0] = edge.beyond;
      Facet& beyond = facets_[edge.beyond];
      for (std::size_t k = 0; k < 3; ++k)
        if (beyond.corners[k] == edge.to && beyond.corners[(k + 1) % 3] == edge.from)
          beyond.beside[k] = facets_.size() - 1;
    }
    for (std::size_t i = 0; i < horizon_.size(); ++i) {
      const std::size_t next = starts_.at(horizon_[i].to);
      facets_[first + i].beside[1] = first + next;
      facets_[first + next].beside[2] = first + i;
    }
    for (const std::size_t old : seen_) {
      facets_[old].alive = false;
      const std::vector<std::uint32_t> left = std::move(facets_[old].outside);
      facets_[old].outside.clear();
      for (const std::uint32_t q : left) give(q, first);
    }
  }

  std::span<const Vec3> points_;
  const Job& job_;
  double same_ = 0;
  std::vector<Facet> facets_;
  std::vector<std::size_t> seen_;
  std::vector<Edge> horizon_;
  std::unordered_map<std::uint32_t, std::size_t> starts_;  // edges of the horizon by their start
  std::uint32_t visit_ = 0;
};

}  // namespace

std::optional<std::vector<Triangle>> convex_hull(std::span<const Vec3> points, const Job& job) {
  return HullBuilder(points, job).run();
}

}  // namespace panwright::geometry
