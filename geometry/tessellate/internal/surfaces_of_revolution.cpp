// Profiles of cylinder, cone, disc, torus and dish.
#include <fmt/core.h>

#include "base/text.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

namespace {

bool has_bottom(Caps caps) { return caps == Caps::both || caps == Caps::bottom; }
bool has_top(Caps caps) { return caps == Caps::both || caps == Caps::top; }

// a cylinder is a cone of two equal radii
Revolution revolution(const Cone& s, std::string_view kind) {
  Revolution r{.kind = kind, .sector = s.sector, .counts = s.counts};
  const Vec2 bottom(s.bottom_radius, -0.5 * s.height), top(s.top_radius, 0.5 * s.height);
  const Vec2 low(0, bottom.y), high(0, top.y);
  if (bottom.x > 0 && has_bottom(s.caps)) r.parts.push_back(Part::face(low, bottom));
  r.parts.push_back(Part::straight(bottom, top));
  if (top.x > 0 && has_top(s.caps)) r.parts.push_back(Part::face(top, high));
  if (!s.sector.whole() && s.caps == Caps::both) {
    r.wall.push_back(low);
    if (bottom.x > 0) r.wall.push_back(bottom);
    if (top.x > 0) r.wall.push_back(top);
    r.wall.push_back(high);
  }
  r.closed = is_closed(s);
  return r;
}

Revolution revolution(const Cone& s) { return revolution(s, "cone"); }

Revolution revolution(const Cylinder& s) {
  return revolution(Cone{s.radius, s.radius, s.height, s.caps, s.sector, s.counts}, "cylinder");
}

Revolution revolution(const Disc& s) {
  Revolution r{.kind = "disc", .sector = s.sector, .counts = s.counts};
  r.parts.push_back(Part::face({s.radius, 0}, {s.inner_radius, 0}));
  return r;
}

Revolution revolution(const Torus& s) {
  Revolution r{.kind = "torus", .sector = s.sector, .counts = s.counts};
  r.parts.push_back(Part::curved(Curve::arc({s.radius, 0}, s.tube_radius, 0, 2 * kPi)));
  r.closed = s.sector.whole();
  return r;
}

double rim_height(const Dish& s) { return s.diameter * s.diameter / (16 * s.focal_length); }

Revolution revolution(const Dish& s) {
  Revolution r{.kind = "dish", .counts = s.counts};
  const double radius = 0.5 * s.diameter;
  const double depth = rim_height(s);
  r.closed = s.thickness > 0;
  if (r.closed) {
    const double back = -s.thickness;
    Part part =
        Part::curved(Curve::cubics({{Vec2(0, back), {radius, 0}, {0, depth}, {0, 0}}}, false));
    part.mapping = Mapping::below;
    part.plane_radius = radius;
    r.parts.push_back(std::move(part));
    Part edge = Part::straight({radius, depth + back}, {radius, depth});
    edge.mapping = Mapping::above;
    edge.plane_radius = radius;
    r.parts.push_back(std::move(edge));
  }
  Part front = Part::curved(
      Curve::cubics({{Vec2(radius, depth), {-radius, -2 * depth}, {0, depth}, {0, 0}}}, false));
  front.mapping = Mapping::above;
  front.plane_radius = radius;
  r.parts.push_back(std::move(front));
  return r;
}

template <class Shape>
Result<Mesh> made(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  if (const Problem problem = internal::problem(shape)) {
    log.report(problem->code, where, problem->message);
    return failed;
  }
  return revolved(revolution(shape), options, where, log);
}

}  // namespace

Problem problem(const Cylinder& s) {
  if (auto p = size_problem(s.radius, "radius", "a radius")) return p;
  if (auto p = size_problem(s.height, "height", "a height")) return p;
  if (auto p = sector_problem(s.sector)) return p;
  return counts_problem(s.counts, s.sector, 1);
}

Problem problem(const Cone& s) {
  if (auto p = zero_or_size_problem(s.bottom_radius, "bottom_radius", "a radius")) return p;
  if (auto p = zero_or_size_problem(s.top_radius, "top_radius", "a radius")) return p;
  if (s.bottom_radius == 0 && s.top_radius == 0)
    return ShapeProblem{Code("E2011"), "a cone of two zero radii, expected at most one",
                        "bottom_radius"};
  if (auto p = size_problem(s.height, "height", "a height")) return p;
  if (auto p = sector_problem(s.sector)) return p;
  return counts_problem(s.counts, s.sector, 1);
}

Problem problem(const Disc& s) {
  if (auto p = size_problem(s.radius, "radius", "a radius")) return p;
  if (auto p = zero_or_size_problem(s.inner_radius, "inner_radius", "an inner radius")) return p;
  if (s.inner_radius >= s.radius)
    return ShapeProblem{
        Code("E2011"),
        fmt::format("an inner radius of {} m in a disc of radius {} m, expected a smaller one",
                    format_double(s.inner_radius), format_double(s.radius)),
        "inner_radius"};
  if (auto p = sector_problem(s.sector)) return p;
  return counts_problem(s.counts, s.sector, 1);
}

Problem problem(const Torus& s) {
  if (auto p = size_problem(s.radius, "radius", "a radius")) return p;
  if (auto p = size_problem(s.tube_radius, "tube_radius", "a tube radius")) return p;
  if (s.tube_radius >= s.radius)
    return ShapeProblem{Code("E2011"),
                        fmt::format("a tube radius of {} m reaches the axis of a torus of radius "
                                    "{} m, expected a smaller one",
                                    format_double(s.tube_radius), format_double(s.radius)),
                        "tube_radius"};
  if (auto p = size_problem(s.radius + s.tube_radius, "radius", "an outer radius")) return p;
  if (auto p = sector_problem(s.sector)) return p;
  return counts_problem(s.counts, s.sector, 3);
}

Problem problem(const Dish& s) {
  if (auto p = size_problem(s.diameter, "diameter", "a diameter")) return p;
  if (auto p = size_problem(s.focal_length, "focal_length", "a focal length")) return p;
  if (auto p = zero_or_size_problem(s.thickness, "thickness", "a thickness")) return p;
  if (!(rim_height(s) + s.thickness <= kMaxCoordinate))
    return ShapeProblem{Code("E2010"),
                        fmt::format("a diameter of {} m with a focal length of {} m makes a dish "
                                    "{} m deep, expected at most {} m",
                                    format_double(s.diameter), format_double(s.focal_length),
                                    format_double(rim_height(s)), format_double(kMaxCoordinate)),
                        "focal_length"};
  return counts_problem(s.counts, {}, 1);
}

Result<Mesh> make(const Cylinder& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return made(s, options, where, log);
}
Result<Mesh> make(const Cone& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return made(s, options, where, log);
}
Result<Mesh> make(const Disc& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return made(s, options, where, log);
}
Result<Mesh> make(const Torus& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return made(s, options, where, log);
}
Result<Mesh> make(const Dish& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  return made(s, options, where, log);
}

double planned(const Cylinder& s, const TessellationOptions& options) {
  return planned_triangles(revolution(s), options);
}
double planned(const Cone& s, const TessellationOptions& options) {
  return planned_triangles(revolution(s), options);
}
double planned(const Disc& s, const TessellationOptions& options) {
  return planned_triangles(revolution(s), options);
}
double planned(const Torus& s, const TessellationOptions& options) {
  return planned_triangles(revolution(s), options);
}
double planned(const Dish& s, const TessellationOptions& options) {
  return planned_triangles(revolution(s), options);
}

std::vector<CircularEdge> circular_edges(const Cylinder& s) {
  if (!(s.counts == Counts{})) return {};
  return {circular_edge(s.radius, -0.5 * s.height, s.sector),
          circular_edge(s.radius, 0.5 * s.height, s.sector)};
}

std::vector<CircularEdge> circular_edges(const Cone& s) {
  if (!(s.counts == Counts{})) return {};
  std::vector<CircularEdge> result;
  if (s.bottom_radius > 0)
    result.push_back(circular_edge(s.bottom_radius, -0.5 * s.height, s.sector));
  if (s.top_radius > 0) result.push_back(circular_edge(s.top_radius, 0.5 * s.height, s.sector));
  return result;
}

std::vector<CircularEdge> circular_edges(const Disc& s) {
  if (!(s.counts == Counts{})) return {};
  std::vector<CircularEdge> result{circular_edge(s.radius, 0, s.sector)};
  if (s.inner_radius > 0) result.push_back(circular_edge(s.inner_radius, 0, s.sector));
  return result;
}

std::vector<CircularEdge> circular_edges(const Dish& s) {
  if (!(s.counts == Counts{})) return {};
  std::vector<CircularEdge> result{circular_edge(0.5 * s.diameter, rim_height(s), {})};
  if (s.thickness > 0)
    result.push_back(circular_edge(0.5 * s.diameter, rim_height(s) - s.thickness, {}));
  return result;
}

std::uint32_t segments(const Cylinder& s, const TessellationOptions& options) {
  return shared_segments(revolution(s), options);
}
std::uint32_t segments(const Cone& s, const TessellationOptions& options) {
  return shared_segments(revolution(s), options);
}
std::uint32_t segments(const Disc& s, const TessellationOptions& options) {
  return shared_segments(revolution(s), options);
}
std::uint32_t segments(const Dish& s, const TessellationOptions& options) {
  return shared_segments(revolution(s), options);
}

}  // namespace panwright::geometry::internal
