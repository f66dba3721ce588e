#include "geometry/tessellate/tessellate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/triangle.h"
#include "geometry/tessellate/internal/maximum.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry {

namespace {

using internal::maximum;

Vec3 stored(const Vec3& p, const Vec3& origin) {
  const Vec3 d = p - origin;
  return {static_cast<double>(static_cast<float>(d.x)),
          static_cast<double>(static_cast<float>(d.y)),
          static_cast<double>(static_cast<float>(d.z))};
}

}  // namespace

bool within_limits(const Mesh& mesh, const TessellationOptions& options, SourceSpan where,
                   DiagnosticLog& log) {
  const std::uint64_t limit = std::min(options.max_triangles, kMaxVertices);
  if (mesh.triangles.size() > limit) {
    log.report(
        Code("E2003"), where,
        fmt::format("a mesh of {} triangles, expected at most {}", mesh.triangles.size(), limit));
    return false;
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (std::fabs(p[axis]) <= kMaxCoordinate) continue;
      log.report(
          Code("E2010"), where,
          fmt::format("position {} has a coordinate of {} m, expected a magnitude of at most {} m",
                      i, format_double(p[axis]), format_double(kMaxCoordinate)));
      return false;
    }
  }
  return true;
}

Result<Mesh> tessellated(const Shape& shape, const TessellationOptions& options, SourceSpan where,
                         DiagnosticLog& log) {
  return std::visit(
      [&](const auto& s) -> Result<Mesh> {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>) {
          assert(s != nullptr);
          if (!within_limits(*s, options, where, log)) return failed;
          Mesh copy = *s;
          copy.error = rounding_error(s->positions, Vec3(0));
          return copy;
        } else {
          return internal::make(s, options, where, log);
        }
      },
      shape);
}

double planned_triangles(const Shape& shape, const TessellationOptions& options) {
  return std::visit(
      [&](const auto& s) -> double {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>)
          return static_cast<double>(s->triangles.size());
        else
          return internal::planned(s, options);
      },
      shape);
}

std::vector<CircularEdge> circular_edges_of(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> std::vector<CircularEdge> {
        if constexpr (requires { internal::circular_edges(s); })
          return internal::circular_edges(s);
        else
          return {};
      },
      shape);
}

std::uint32_t segments_of(const Shape& shape, const TessellationOptions& options) {
  return std::visit(
      [&](const auto& s) -> std::uint32_t {
        if constexpr (requires { internal::segments(s, options); })
          return internal::segments(s, options);
        else
          return 0;
      },
      shape);
}

double sphere_error(const Mesh& mesh, double radius, const Vec3& origin) {
  // the furthest point of a triangle from the centre is a corner, the nearest may lie inside
  const double outside = maximum(mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    double worst = 0;
    for (std::size_t i = begin; i < end; ++i)
      worst = std::max(worst,
                       std::fabs(glm::length(stored(mesh.positions[i], origin) + origin) - radius));
    return worst;
  });
  const double inside = maximum(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
    double nearest = radius;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      const Vec3 a = stored(mesh.positions[t[0]], origin) + origin;
      const Vec3 b = stored(mesh.positions[t[1]], origin) + origin;
      const Vec3 c = stored(mesh.positions[t[2]], origin) + origin;
      // a triangle is no nearer than its plane, and most planes are no nearer than the record
      const Vec3 n = glm::cross(b - a, c - a);
      const double height = glm::dot(n, a);
      const double bound = nearest * nearest * glm::dot(n, n);
      if (height * height > bound * (1 + 1e-12)) continue;
      nearest = std::min(nearest, glm::length(nearest_to_origin(a, b, c)));
    }
    return radius - nearest;
  });
  return std::max(outside, inside);
}

double rounding_error(std::span<const Vec3> positions, const Vec3& origin) {
  const double squared = maximum(positions.size(), [&](std::size_t begin, std::size_t end) {
    double worst = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 miss = (positions[i] - origin) - stored(positions[i], origin);
      worst = std::max(worst, glm::dot(miss, miss));
    }
    return worst;
  });
  return std::sqrt(squared);
}

}  // namespace panwright::geometry
