#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/flat.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/tube_plan.h"

namespace panwright::geometry::internal {

namespace {

// a bend must be wider than the radius by this much, or the inner side is all slivers
constexpr double kWider = 1.001;
// tangents whose sum is shorter run back to back
constexpr double kBackToBack = 1e-6;

class TubeBuilder {
 public:
  TubeBuilder(const Tube& tube, const TubePlan& plan, bool texcoords)
      : tube_(tube),
        plan_(plan),
        texcoords_(texcoords),
        circle_(directions(Sector{}, plan.segments)),
        columns_(plan.segments + (texcoords ? 1 : 0)) {}

  Mesh build() {
    const std::size_t surfaces = tube_.inner_radius > 0 ? 2 : 1;
    const std::size_t vertices = surfaces * (plan_.rows.size() + 2) * columns_;
    mesh_.positions.reserve(vertices);
    mesh_.normals.reserve(vertices);
    if (texcoords_) mesh_.texcoords.reserve(vertices);
    mesh_.triangles.reserve(static_cast<std::size_t>(plan_.triangles));
    surface(tube_.radius, false);
    if (tube_.inner_radius > 0) surface(tube_.inner_radius, true);
    if (!tube_.closed) {
      if (tube_.caps == Caps::both || tube_.caps == Caps::bottom) cap(plan_.rows.front(), true);
      if (tube_.caps == Caps::both || tube_.caps == Caps::top) cap(plan_.rows.back(), false);
    }
    mesh_.closed = tube_.closed || tube_.caps == Caps::both;
    return std::move(mesh_);
  }

 private:
  std::uint32_t corner(std::uint32_t column, std::uint32_t shift) const {
    return static_cast<std::uint32_t>((std::uint64_t{column} + shift) % plan_.segments);
  }
  std::uint32_t add(const Vec3& p, const Vec3& normal, const Vec2& uv) {
    mesh_.positions.push_back(p);
    mesh_.normals.push_back(normal);
    if (texcoords_) mesh_.texcoords.push_back(uv);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }
  Vec3 point(const Row& row, std::uint32_t column, double radius) const {
    const Ring& ring = plan_.rings[row.ring];
    const det::SinCos angle = circle_[corner(column, row.shift)];
    return ring.centre + radius * plan_.factor * (angle.cos * ring.right + angle.sin * ring.up);
  }
  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool turned) {
    mesh_.triangles.push_back(turned ? Triangle{a, c, b} : Triangle{a, b, c});
  }

  void surface(double radius, bool inner) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const Row& row : plan_.rows) {
      for (std::uint32_t i = 0; i < columns_; ++i) {
        const det::SinCos angle = circle_[corner(i, 0)];
        const Vec3 normal = angle.cos * row.right + angle.sin * row.up;
        add(point(row, i, radius), inner ? -normal : normal,
            {static_cast<double>(i) / plan_.segments, row.v});
      }
    }
    for (const Band& band : plan_.bands) {
      const std::uint32_t from = first + band.from * columns_;
      const std::uint32_t to = first + band.to * columns_;
      for (std::uint32_t i = 0; i < plan_.segments; ++i) {
        const std::uint32_t next = texcoords_ ? i + 1 : corner(i, 1);
        const std::uint32_t to_i = texcoords_ ? i : corner(i, band.shift);
        const std::uint32_t to_next = texcoords_ ? i + 1 : corner(next, band.shift);
        if (plan_.turning) {
          emit(from + i, from + next, to + to_i, inner);
          emit(from + next, to + to_next, to + to_i, inner);
        } else {
          emit(from + i, from + next, to + to_next, inner);
          emit(from + i, to + to_next, to + to_i, inner);
        }
      }
    }
  }

  // u, v: the square around the section seen from outside
  void cap(const Row& row, bool begin) {
    const Vec3 along = glm::cross(row.right, row.up);
    const Vec3 normal = begin ? -along : along;
    const auto ring = [&](double radius) {
      const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
      const double share = 0.5 * radius / tube_.radius;
      for (std::uint32_t i = 0; i < plan_.segments; ++i) {
        const det::SinCos angle = circle_[i];
        add(point(row, i, radius), normal,
            {0.5 + (begin ? -share : share) * angle.cos, 0.5 + share * angle.sin});
      }
      return first;
    };
    const std::uint32_t outer = ring(tube_.radius);
    if (tube_.inner_radius > 0) {
      const std::uint32_t inner = ring(tube_.inner_radius);
      for (std::uint32_t i = 0; i < plan_.segments; ++i) {
        const std::uint32_t next = corner(i, 1);
        emit(outer + i, outer + next, inner + next, begin);
        emit(outer + i, inner + next, inner + i, begin);
      }
      return;
    }
    // corners cut off a polygon, then off what is left, and so on
    std::vector<std::uint32_t> left(plan_.segments);
    for (std::uint32_t i = 0; i < plan_.segments; ++i) left[i] = outer + i;
    while (left.size() > 3) {
      std::size_t kept = 0;
      const std::size_t size = left.size();
      for (std::size_t i = 0; i < size; i += 2) {
        if (i + 1 < size) emit(left[i], left[i + 1], left[i + 2 < size ? i + 2 : 0], begin);
        left[kept++] = left[i];
      }
      left.resize(kept);
    }
    if (left.size() == 3) emit(left[0], left[1], left[2], begin);
  }

  const Tube& tube_;
  const TubePlan& plan_;
  bool texcoords_;
  std::vector<det::SinCos> circle_;
  std::uint32_t columns_;
  Mesh mesh_;
};

Problem path_problem(const Tube& tube) {
  const std::size_t least = tube.closed ? 3 : 2;
  if (tube.path.size() < least)
    return ShapeProblem{
        Code("E2015"),
        fmt::format("{} of {}, expected at least {}", tube.closed ? "a closed path" : "a path",
                    counted(tube.path.size(), "point"), least),
        "path"};
  if (auto bad = coordinate_problem(tube.path, "path")) return bad;
  AxisBox box;
  for (const Vec3& p : tube.path) box.add(p);
  const double whole = box.diagonal();
  if (auto bad = size_problem(whole, "path", "a path")) return bad;
  const std::size_t segments = tube.closed ? tube.path.size() : tube.path.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t j = (i + 1) % tube.path.size();
    if (glm::length(tube.path[j] - tube.path[i]) > kCoincident * whole) continue;
    return ShapeProblem{
        Code("E2015"),
        fmt::format(
            "points {} and {} coincide, expected neighbours more than 1e-9 of the whole apart",
            i + 1, j + 1),
        "path", j};
  }
  return std::nullopt;
}

Problem mitre_problem(const Tube& tube) {
  const Straights straights = straights_of(tube);
  const std::size_t count = straights.frame.size();
  const auto back_to_back = [&](std::size_t a, std::size_t b) {
    return glm::length(straights.frame[a].tangent + straights.frame[b].tangent) < kBackToBack;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const bool has_begin = i > 0 || tube.closed;
    const bool has_end = i + 1 < count || tube.closed;
    const std::size_t before = i > 0 ? i - 1 : count - 1;
    const std::size_t after = i + 1 < count ? i + 1 : 0;
    const Vec3& tangent = straights.frame[i].tangent;
    if (has_end && back_to_back(i, after))
      return ShapeProblem{
          Code("E2014"),
          fmt::format("the path doubles back at point {}", straights.corner[after] + 1), "path",
          straights.corner[after]};
    const Vec3 zero(0);
    const bool begin_known = has_begin && !back_to_back(before, i);
    const Vec3 begin = begin_known ? lean_of(tangent, straights.frame[before].tangent) : zero;
    const Vec3 end = has_end ? lean_of(tangent, straights.frame[after].tangent) : zero;
    const double taken = tube.radius * glm::length(end - begin);
    if (straights.length[i] >= kWider * taken) continue;
    // of two alike the first
    const bool at_begin = glm::dot(begin, begin) >= 0.999 * glm::dot(end, end);
    const std::size_t point = straights.corner[at_begin ? i : after];
    return ShapeProblem{
        Code("E2014"),
        fmt::format("the mitre at point {} needs {} m of a straight part that is {} m long",
                    point + 1, format_double(kWider * taken), format_double(straights.length[i])),
        "path", point};
  }
  return std::nullopt;
}

Problem bend_problem(const Tube& tube) {
  const SplinePath::Bend bend = SplinePath(tube.path, tube.closed).sharpest();
  if (kWider * bend.curvature * tube.radius <= 1) return std::nullopt;
  return ShapeProblem{
      Code("E2014"),
      fmt::format(
          "near point {} the path bends with a radius of {} m, expected more than the tube's, {} m",
          bend.point + 1, format_double(1 / bend.curvature), format_double(tube.radius)),
      "path", bend.point};
}

}  // namespace

Problem problem(const Tube& shape) {
  if (auto bad = size_problem(shape.radius, "radius", "a radius")) return bad;
  if (auto bad = zero_or_size_problem(shape.inner_radius, "inner_radius", "an inner radius"))
    return bad;
  if (shape.inner_radius >= shape.radius)
    return ShapeProblem{Code("E2011"),
                        fmt::format("an inner radius of {} m, expected below the outer one, {} m",
                                    format_double(shape.inner_radius), format_double(shape.radius)),
                        "inner_radius"};
  const std::uint32_t least_along = shape.closed && shape.spline ? 3 : 1;
  if (auto bad = counts_problem(shape.counts, Sector{}, least_along)) return bad;
  if (auto bad = path_problem(shape)) return bad;
  return shape.spline ? bend_problem(shape) : mitre_problem(shape);
}

Result<Mesh> make(const Tube& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  const TubePlan plan = plan_of(shape, options);
  if (plan.state == TubePlan::State::too_fine) {
    log.report(
        Code("E2003"), where,
        fmt::format("an error of {} m cannot be achieved with single-precision vertices on a tube "
                    "of radius {} m",
                    format_double(options.max_error), format_double(shape.radius)));
    return failed;
  }
  const double vertices = 2.0 * (static_cast<double>(plan.rows.size()) + 2) * (plan.segments + 1.0);
  if (plan.state == TubePlan::State::too_many) {
    log.report(Code("E2003"), where,
               fmt::format("a tube with an error of {} m needs more than {} triangles",
                           format_double(options.max_error), options.max_triangles));
    return failed;
  }
  if (!within_counts(plan.triangles, vertices, "a tube", options, where, log)) return failed;
  Mesh mesh = TubeBuilder(shape, plan, options.texcoords).build();
  set_error(mesh, plan.error);
  return mesh;
}

double planned(const Tube& shape, const TessellationOptions& options) {
  return plan_of(shape, options).triangles;
}

std::vector<CircularEdge> circular_edges(const Tube& shape) {
  std::vector<CircularEdge> result;
  if (shape.counts.around != 0) return result;
  for (const Frame& frame : end_frames(shape)) {
    result.push_back({frame.centre, frame.tangent, shape.radius * frame.right});
    if (shape.inner_radius > 0)
      result.push_back({frame.centre, frame.tangent, shape.inner_radius * frame.right});
  }
  return result;
}

std::uint32_t segments(const Tube& shape, const TessellationOptions& options) {
  if (shape.closed || shape.counts.around != 0) return 0;
  TessellationOptions own = options;
  own.edge_segments = 0;
  return plan_of(shape, own).segments;
}

}  // namespace panwright::geometry::internal
