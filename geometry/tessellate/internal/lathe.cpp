#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/revolution_problem.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

namespace {

bool ends_meet(const Lathe& s) { return s.profile.front() == s.profile.back(); }

// The cubic between b and c of a centripetal Catmull-Rom spline through a, b, c, d: knots are
// apart by the square roots of distances. Barry, Goldman, SIGGRAPH 1988; Yuksel, Schaefer, Keyser,
// "Parameterization and applications of Catmull-Rom curves", 2011.
Cubic centripetal(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double ab = std::sqrt(glm::length(b - a));
  const double bc = std::sqrt(glm::length(c - b));
  const double cd = std::sqrt(glm::length(d - c));
  const Vec2 at_b = bc * ((b - a) / ab - (c - a) / (ab + bc)) + (c - b);
  const Vec2 at_c = (c - b) + bc * ((d - c) / cd - (d - b) / (bc + cd));
  return {b, at_b, 3.0 * (c - b) - 2.0 * at_b - at_c, 2.0 * (b - c) + at_b + at_c};
}

// Beyond an end the spline is its own mirror image at the axis, elsewhere it goes on straight.
Vec2 beyond(const Vec2& end, const Vec2& inner) {
  if (end.x == 0) return {-inner.x, inner.y};
  return 2.0 * end - inner;
}

std::vector<Cubic> cubics(const std::vector<Vec2>& points, bool loop) {
  const std::size_t last = points.size() - 1;
  std::vector<Cubic> pieces;
  pieces.reserve(last);
  for (std::size_t i = 0; i < last; ++i) {
    const Vec2& b = points[i];
    const Vec2& c = points[i + 1];
    const Vec2 a = i > 0 ? points[i - 1] : loop ? points[last - 1] : beyond(b, c);
    const Vec2 d = i + 1 < last ? points[i + 2] : loop ? points[1] : beyond(c, b);
    pieces.push_back(centripetal(a, b, c, d));
  }
  return pieces;
}

// Stretches of a profile between points on the axis; those along it make no surface.
struct Run {
  std::size_t first;  // point
  std::vector<Vec2> points;
};

std::vector<Run> runs(const Lathe& s) {
  std::vector<Run> result;
  std::size_t first = 0;
  for (std::size_t i = 1; i < s.profile.size(); ++i) {
    if (s.profile[i].x != 0 && i + 1 < s.profile.size()) continue;
    if (i - first > 1 || s.profile[first].x != 0 || s.profile[i].x != 0)
      result.push_back({first,
                        {s.profile.begin() + static_cast<std::ptrdiff_t>(first),
                         s.profile.begin() + static_cast<std::ptrdiff_t>(i) + 1}});
    first = i;
  }
  return result;
}

bool is_loop(const Run& run) {
  return run.points.front() == run.points.back() && run.points.front().x > 0;
}

// whether the profile goes straight on at b
bool straight_on(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 in = b - a, out = c - b;
  const double sine = in.x * out.y - in.y * out.x;
  return std::fabs(sine) <= kStraight * glm::length(in) * glm::length(out) && glm::dot(in, out) > 0;
}

Revolution lathe_revolution(const Lathe& s) {
  Revolution r{.kind = "lathe", .sector = s.sector, .counts = s.counts};
  std::vector<double> lengths;
  for (Run& run : runs(s)) {
    if (s.spline) {
      Curve curve = Curve::cubics(cubics(run.points, is_loop(run)), is_loop(run));
      lengths.push_back(CurveSamples(curve).length());
      r.parts.push_back(Part::curved(std::move(curve)));
      continue;
    }
    std::size_t from = 0;
    for (std::size_t i = 1; i < run.points.size(); ++i) {
      if (i + 1 < run.points.size() &&
          straight_on(run.points[from], run.points[i], run.points[i + 1]))
        continue;
      lengths.push_back(glm::length(run.points[i] - run.points[from]));
      r.parts.push_back(Part::straight(run.points[from], run.points[i]));
      from = i;
    }
  }
  double whole = 0, before = 0;
  for (const double length : lengths) whole += length;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    r.parts[i].v_begin = before / whole;
    before += lengths[i];
    r.parts[i].v_end = i + 1 < lengths.size() ? before / whole : 1.0;
  }
  r.closed = is_closed(s);
  return r;
}

// whether a cubic's radius is positive between its ends
bool off_axis(const Cubic& c) {
  const auto radius = [&](double x) { return c[0].x + x * (c[1].x + x * (c[2].x + x * c[3].x)); };
  const double root = c[2].x * c[2].x - 3 * c[1].x * c[3].x;
  if (root < 0) return true;
  const double q = -(c[2].x + std::copysign(std::sqrt(root), c[2].x));
  for (const double x : {c[1].x / q, q / (3 * c[3].x)})
    if (x > 0 && x < 1 && !(radius(x) > 0)) return false;
  return true;
}

ShapeProblem at_point(Code code, std::string message, std::size_t i) {
  return {code, std::move(message), "profile", i};
}

Problem points_problem(const std::vector<Vec2>& profile) {
  if (profile.size() < 2)
    return ShapeProblem{
        Code("E2015"),
        fmt::format("a profile of {}, expected at least 2", counted(profile.size(), "point")),
        "profile"};
  double size = 0, radius = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vec2& p = profile[i];
    if (!(std::fabs(p.x) <= kMaxCoordinate && std::fabs(p.y) <= kMaxCoordinate))
      return at_point(
          Code("E2010"),
          fmt::format("point {} of the profile is ({}, {}), expected magnitudes of at most {} m",
                      i + 1, format_double(p.x), format_double(p.y), format_double(kMaxCoordinate)),
          i);
    if (p.x < 0)
      return at_point(
          Code("E2011"),
          fmt::format("point {} of the profile has a radius of {} m, expected at least 0", i + 1,
                      format_double(p.x)),
          i);
    radius = std::max(radius, p.x);
    size = std::max({size, glm::length(p - profile[0]), p.x});
  }
  if (radius == 0)
    return ShapeProblem{
        Code("E2011"),
        "a profile that lies on the axis has no surface, expected a point off the axis", "profile"};
  if (radius < kMinRadius)
    return ShapeProblem{Code("E2010"),
                        fmt::format("a profile of radius {} m, expected at least {} m",
                                    format_double(radius), format_double(kMinRadius)),
                        "profile"};
  for (std::size_t i = 1; i < profile.size(); ++i)
    if (!(glm::length(profile[i] - profile[i - 1]) > kCoincident * size))
      return at_point(Code("E2015"),
                      fmt::format("points {} and {} of the profile coincide", i, i + 1), i);
  return std::nullopt;
}

}  // namespace

std::vector<Vec2> sampled_profile(const Lathe& s, int chords) {
  if (!s.spline) return s.profile;
  std::vector<Vec2> points{s.profile.front()};
  std::size_t at = 0;
  for (const Run& run : runs(s)) {
    // stretches along the axis
    for (; at < run.first; ++at)
      for (int k = 1; k <= chords; ++k)
        points.push_back(
            glm::mix(s.profile[at], s.profile[at + 1], static_cast<double>(k) / chords));
    for (const Cubic& c : cubics(run.points, is_loop(run))) {
      for (int k = 1; k < chords; ++k) {
        const double t = static_cast<double>(k) / chords;
        points.push_back(c[0] + t * (c[1] + t * (c[2] + t * c[3])));
      }
      points.push_back(s.profile[++at]);
    }
  }
  for (; at + 1 < s.profile.size(); ++at)
    for (int k = 1; k <= chords; ++k)
      points.push_back(glm::mix(s.profile[at], s.profile[at + 1], static_cast<double>(k) / chords));
  return points;
}

Problem problem(const Lathe& s) {
  if (auto p = points_problem(s.profile)) return p;
  if (auto p = sector_problem(s.sector)) return p;
  std::uint32_t least = 1;
  if (s.spline) {
    for (const Run& run : runs(s)) {
      const bool loop = is_loop(run);
      if (loop && run.points.size() < 4)
        return ShapeProblem{Code("E2015"), "a closed spline needs at least 3 different points",
                            "profile"};
      const bool poles = run.points.front().x == 0 && run.points.back().x == 0;
      least = std::max<std::uint32_t>(least, loop ? 3 : poles ? 2 : 1);
      const std::vector<Cubic> pieces = cubics(run.points, loop);
      for (std::size_t i = 0; i < pieces.size(); ++i)
        if (!off_axis(pieces[i]))
          return at_point(Code("E2011"),
                          fmt::format("the spline crosses the axis between points {} and {} of the "
                                      "profile; add points there",
                                      run.first + i + 1, run.first + i + 2),
                          run.first + i);
    }
  }
  return counts_problem(s.counts, s.sector, least);
}

Result<Mesh> make(const Lathe& s, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  if (const Problem p = problem(s)) {
    log.report(p->code, where, p->message);
    return failed;
  }
  return revolved(lathe_revolution(s), options, where, log);
}

double planned(const Lathe& s, const TessellationOptions& options) {
  return planned_triangles(lathe_revolution(s), options);
}

std::vector<CircularEdge> circular_edges(const Lathe& s) {
  if (!(s.counts == Counts{}) || ends_meet(s)) return {};
  std::vector<CircularEdge> result;
  for (const Vec2& p : {s.profile.front(), s.profile.back()})
    if (p.x > 0) result.push_back(circular_edge(p.x, p.y, s.sector));
  return result;
}

std::uint32_t segments(const Lathe& s, const TessellationOptions& options) {
  return shared_segments(lathe_revolution(s), options);
}

}  // namespace panwright::geometry::internal
