#include "geometry/tessellate/internal/flat.h"

#include <fmt/core.h>

#include <cmath>

#include "base/text.h"
#include "geometry/internal/limits.h"

namespace panwright::geometry::internal {

namespace {

template <class V>
Problem first_problem(std::span<const V> points, std::string_view part) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (typename V::length_type axis = 0; axis < V::length(); ++axis) {
      const double x = points[i][axis];
      if (std::fabs(x) <= kMaxCoordinate) continue;
      return ShapeProblem{
          Code("E2010"),
          fmt::format("point {} has a coordinate of {} m, expected a magnitude of at most {} m",
                      i + 1, format_double(x), format_double(kMaxCoordinate)),
          part, i};
    }
  }
  return std::nullopt;
}

// "edge 3 of the outline"
std::string edge_name(const Region& region, std::uint32_t edge) {
  const std::uint32_t loop = region.loop[edge];
  const std::uint32_t number = edge - region.loops[loop] + 1;
  if (loop == 0) return fmt::format("edge {} of the outline", number);
  return fmt::format("edge {} of hole {}", number, loop);
}

}  // namespace

bool within_counts(double triangles, double vertices, std::string_view what,
                   const TessellationOptions& options, SourceSpan where, DiagnosticLog& log) {
  const double limit = std::fmin(static_cast<double>(options.max_triangles), kMostVertices);
  if (triangles <= limit && vertices <= kMostVertices) return true;
  log.report(Code("E2003"), where,
             fmt::format("{} of {} triangles and {} vertices, expected at most {} triangles", what,
                         format_double(triangles), format_double(vertices), format_double(limit)));
  return false;
}

Problem coordinate_problem(std::span<const Vec2> points, std::string_view part) {
  return first_problem(points, part);
}

Problem coordinate_problem(std::span<const Vec3> points, std::string_view part) {
  return first_problem(points, part);
}

Code code_of(const RegionFault& fault, const Region& region) {
  switch (fault.kind) {
    case RegionFault::Kind::coincident:
      return Code("E2015");
    case RegionFault::Kind::crossing:
      return region.loop[fault.edge] == region.loop[fault.other] ? Code("E2012") : Code("E2013");
    default:
      return Code("E2013");
  }
}

std::string sentence_of(const RegionFault& fault, const Region& region) {
  const std::string edge = edge_name(region, fault.edge);
  const std::uint32_t loop = region.loop[fault.edge];
  switch (fault.kind) {
    case RegionFault::Kind::coincident:
      return fmt::format("{} has no length, expected ends more than 1e-9 of the whole apart", edge);
    case RegionFault::Kind::crossing:
      return fmt::format("{} crosses or touches {}", edge, edge_name(region, fault.other));
    case RegionFault::Kind::outside:
      return fmt::format("hole {} lies outside the outline", loop);
    default:
      return fmt::format("hole {} lies inside hole {}", loop, region.loop[fault.other]);
  }
}

Upright upright(const Vec3& normal) {
  // below this the direction of +z in the face is made of rounding
  constexpr double kFlat = 1e-9;
  const bool flat = normal.x * normal.x + normal.y * normal.y < kFlat * kFlat;
  const Vec3 towards = flat ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const Vec3 right = glm::normalize(glm::cross(towards, normal));
  return {right, glm::normalize(glm::cross(normal, right))};
}

}  // namespace panwright::geometry::internal
