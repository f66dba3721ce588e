#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/flat.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/triangulate.h"

namespace panwright::geometry::internal {

namespace {

std::vector<Vec2> points_of(const Extrude& shape, std::vector<std::uint32_t>& loops) {
  std::vector<Vec2> points = shape.outline;
  loops = {0, static_cast<std::uint32_t>(points.size())};
  for (const std::vector<Vec2>& hole : shape.holes) {
    points.insert(points.end(), hole.begin(), hole.end());
    loops.push_back(static_cast<std::uint32_t>(points.size()));
  }
  return points;
}

double point_count(const Extrude& shape) {
  double count = static_cast<double>(shape.outline.size());
  for (const auto& hole : shape.holes) count += static_cast<double>(hole.size());
  return count;
}

double cap_count(const Extrude& shape) {
  return shape.caps == Caps::both ? 2 : shape.caps == Caps::none ? 0 : 1;
}

Problem too_few(std::size_t count, std::string_view part, std::size_t item) {
  return ShapeProblem{Code("E2015"), fmt::format("a loop of {} points, expected at least 3", count),
                      part, item};
}

class Extruder {
 public:
  Extruder(const Extrude& shape, const TessellationOptions& options)
      : shape_(shape), texcoords_(options.texcoords) {
    std::vector<std::uint32_t> loops;
    points_ = points_of(shape, loops);
    region_ = region_of(points_, std::move(loops));
  }

  // nothing when the outline is not what problem_of() lets pass
  std::optional<Mesh> build() {
    if (fault_of(region_)) return std::nullopt;
    // the mesh is as tall as authored, and z = 0 stays exact
    low_ = high_ = points_.front();
    for (std::uint32_t i = 0; i < region_.loops[1]; ++i) {
      low_ = glm::min(low_, points_[i]);
      high_ = glm::max(high_, points_[i]);
    }
    const std::size_t n = points_.size();
    const std::size_t walls = 2 * n;
    mesh_.positions.reserve(4 * n + walls);
    mesh_.normals.reserve(4 * n + walls);
    mesh_.triangles.reserve(walls + 2 * (n + 2 * shape_.holes.size()));
    caps();
    for (std::uint32_t loop = 0; loop + 1 < region_.loops.size(); ++loop) wall(loop);
    mesh_.closed = shape_.caps == Caps::both;
    set_error(mesh_, 0);
    return std::move(mesh_);
  }

 private:
  std::uint32_t add(const Vec3& p, const Vec3& normal, const Vec2& uv) {
    mesh_.positions.push_back(p);
    mesh_.normals.push_back(normal);
    if (texcoords_) mesh_.texcoords.push_back(uv);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  void caps() {
    if (shape_.caps == Caps::none) return;
    const std::vector<Triangle> triangles = triangulated(region_);
    for (const bool top : {false, true}) {
      if (shape_.caps == (top ? Caps::bottom : Caps::top)) continue;
      const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
      for (const Vec2& p : points_) {
        const Vec2 uv = (p - low_) / (high_ - low_);
        add({p.x, p.y, top ? shape_.height : 0.0}, {0, 0, top ? 1 : -1},
            {top ? uv.x : 1 - uv.x, uv.y});
      }
      for (const Triangle& t : triangles)
        mesh_.triangles.push_back(top ? Triangle{first + t[0], first + t[1], first + t[2]}
                                      : Triangle{first + t[0], first + t[2], first + t[1]});
    }
  }

  Vec3 normal_after(std::uint32_t i) const {
    const Vec2 d = points_[region_.next[i]] - points_[i];
    return glm::normalize(Vec3(d.y, -d.x, 0));
  }

  // The walls of a loop from its first point on, the area on their left.
  void wall(std::uint32_t loop) {
    const std::uint32_t begin = region_.loops[loop];
    const std::uint32_t count = region_.loops[loop + 1] - begin;
    double whole = 0;
    for (std::uint32_t i = begin; i < begin + count; ++i)
      whole += glm::length(points_[region_.next[i]] - points_[i]);
    double along = 0;
    std::uint32_t i = begin;
    Vec3 before = normal_after(region_.prev[i]);
    std::uint32_t first = 0;  // bottom vertex of the loop's first wall
    std::uint32_t from = 0;   // bottom vertex where this wall begins; its top one follows
    for (std::uint32_t k = 0; k < count; ++k, i = region_.next[i]) {
      const Vec3 normal = normal_after(i);
      const bool smooth_here = smooth(before, normal);
      if (k == 0) {
        first = from = pair(i, smooth_here ? middle(before, normal) : normal, 0);
        shared_ = smooth_here && !texcoords_;
      } else if (!smooth_here) {
        from = pair(i, normal, along / whole);
      }
      const std::uint32_t j = region_.next[i];
      along += glm::length(points_[j] - points_[i]);
      const Vec3 after = normal_after(j);
      const bool last = k + 1 == count;
      std::uint32_t to = first;
      if (!last || !shared_)
        to = pair(j, smooth(normal, after) ? middle(normal, after) : normal,
                  last ? 1 : along / whole);
      mesh_.triangles.push_back({from, to, to + 1});
      mesh_.triangles.push_back({from, to + 1, from + 1});
      before = normal;
      from = to;
    }
  }

  std::uint32_t pair(std::uint32_t i, const Vec3& normal, double u) {
    const Vec2& p = points_[i];
    const std::uint32_t bottom = add({p.x, p.y, 0}, normal, {u, 0});
    add({p.x, p.y, shape_.height}, normal, {u, 1});
    return bottom;
  }

  bool smooth(const Vec3& a, const Vec3& b) const {
    return angle_between(a, b) <= shape_.smooth + kAngleSlack;
  }
  // note: back to back, two normals have no middle
  static Vec3 middle(const Vec3& a, const Vec3& b) {
    const Vec3 sum = a + b;
    const double length = glm::length(sum);
    return length > 1e-9 ? sum / length : a;
  }

  const Extrude& shape_;
  bool texcoords_;
  std::vector<Vec2> points_;
  Region region_;
  Vec2 low_{0}, high_{0};
  bool shared_ = false;  // the loop's last wall ends at its first vertices
  Mesh mesh_;
};

Problem problem_of_loops(const Extrude& shape) {
  std::vector<std::uint32_t> loops;
  const std::vector<Vec2> points = points_of(shape, loops);
  const auto [left, right] =
      std::minmax_element(shape.outline.begin(), shape.outline.end(),
                          [](const Vec2& a, const Vec2& b) { return a.x < b.x; });
  const auto [low, high] =
      std::minmax_element(shape.outline.begin(), shape.outline.end(),
                          [](const Vec2& a, const Vec2& b) { return a.y < b.y; });
  const double extent = std::max(right->x - left->x, high->y - low->y);
  if (auto bad = size_problem(extent, "outline", "an outline")) return bad;
  Region region = region_of(points, std::move(loops));
  const auto fault = fault_of(region);
  if (!fault) return std::nullopt;
  const std::uint32_t loop = std::max(region.loop[fault->edge], [&] {
    // of an outline and a hole the hole is to blame
    return fault->kind == RegionFault::Kind::crossing ? region.loop[fault->other] : 0u;
  }());
  const bool own = region.loop[fault->edge] == loop;
  const std::size_t point = (own ? fault->edge : fault->other) - region.loops[loop];
  ShapeProblem problem{code_of(*fault, region), sentence_of(*fault, region), "outline", point};
  if (loop > 0) {
    problem.part = "holes";
    problem.item = loop - 1;
    problem.sub_item = point;
  }
  return problem;
}

}  // namespace

Problem problem(const Extrude& shape) {
  if (auto bad = size_problem(shape.height, "height", "a height")) return bad;
  if (!(shape.smooth >= 0 && shape.smooth <= 2 * kPi))
    return ShapeProblem{Code("E2011"),
                        fmt::format("a smoothing angle of {:.12g} deg, expected 0 to 360 deg",
                                    shape.smooth / kDegree),
                        "smooth"};
  if (shape.outline.size() < 3) return too_few(shape.outline.size(), "outline", 0);
  if (auto bad = coordinate_problem(shape.outline, "outline")) return bad;
  for (std::size_t i = 0; i < shape.holes.size(); ++i) {
    if (shape.holes[i].size() < 3) return too_few(shape.holes[i].size(), "holes", i);
    if (auto bad = coordinate_problem(shape.holes[i], "holes")) {
      bad->sub_item = bad->item;
      bad->item = i;
      return bad;
    }
  }
  return problem_of_loops(shape);
}

Result<Mesh> make(const Extrude& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  // at worst each wall has its own vertices
  const double vertices = (4 + cap_count(shape)) * point_count(shape);
  if (!within_counts(planned(shape, options), vertices, "an extrusion", options, where, log))
    return failed;
  auto mesh = Extruder(shape, options).build();
  if (!mesh) return failed;
  return std::move(*mesh);
}

double planned(const Extrude& shape, const TessellationOptions&) {
  const double points = point_count(shape);
  const double cap = points + 2 * static_cast<double>(shape.holes.size()) - 2;
  return 2 * points + cap_count(shape) * cap;
}

}  // namespace panwright::geometry::internal
