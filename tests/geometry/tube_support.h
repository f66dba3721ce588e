// Shared parts of the tests of tubes: meshes, their checks, distances to paths, and paths.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/tessellate/internal/path.h"
#include "shapes.h"

namespace panwright::geometry::tubes {

inline Mesh made(const Tube& tube, double max_error, bool texcoords = false,
                 std::uint32_t edge = 0) {
  const auto problem = problem_of(tube);
  EXPECT_FALSE(problem) << problem->message;
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = max_error;
  options.texcoords = texcoords;
  options.edge_segments = edge;
  auto mesh = tessellated(tube, options, {}, log);
  EXPECT_TRUE(mesh.ok());
  return mesh.ok() ? *mesh : Mesh{};
}

inline void expect_closed_or_open(const Mesh& mesh, bool closed) {
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.closed, closed);
  EXPECT_EQ(mesh.closed, closed);
  EXPECT_EQ(report.degenerate_triangles, 0u);
  EXPECT_EQ(report.bad_indices + report.bad_lengths + report.bad_normals + report.non_finite, 0u);
  EXPECT_EQ(report.misoriented_edges + report.non_manifold_edges, 0u);
  if (closed) {
    EXPECT_GT(report.volume, 0);
  }
}

inline void expect_sound(const Mesh& mesh, bool closed) {
  expect_closed_or_open(mesh, closed);
  // nothing is folded: facets face along their vertex normals
  std::size_t turned = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 facet = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                  mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t v : t) turned += !(glm::dot(facet, mesh.normals[v]) > 0);
  }
  EXPECT_EQ(turned, 0u);
}

// The pyramid of Barry and Goldman: the same spline by another way.
inline Vec3 pyramid(const Vec3 p[4], double share) {
  double t[4] = {0};
  for (int i = 1; i < 4; ++i) t[i] = t[i - 1] + std::sqrt(glm::length(p[i] - p[i - 1]));
  const double x = t[1] + share * (t[2] - t[1]);
  Vec3 a[3], b[2];
  for (int i = 0; i < 3; ++i)
    a[i] = ((t[i + 1] - x) * p[i] + (x - t[i]) * p[i + 1]) / (t[i + 1] - t[i]);
  for (int i = 0; i < 2; ++i)
    b[i] = ((t[i + 2] - x) * a[i] + (x - t[i]) * a[i + 1]) / (t[i + 2] - t[i]);
  return ((t[2] - x) * b[0] + (x - t[1]) * b[1]) / (t[2] - t[1]);
}

// Many points of a tube's path; distances are refined between them.
class Centreline {
 public:
  explicit Centreline(const Tube& tube, int per_span = 400) {
    const auto n = static_cast<int>(tube.path.size());
    const int spans = tube.closed ? n : n - 1;
    for (int i = 0; i < spans; ++i) {
      const auto at = [&](int k) {
        if (tube.closed) return tube.path[(k + n) % n];
        if (k < 0) return 2.0 * tube.path[0] - tube.path[1];
        if (k >= n) return 2.0 * tube.path[n - 1] - tube.path[n - 2];
        return tube.path[k];
      };
      const Vec3 p[4] = {at(i - 1), at(i), at(i + 1), at(i + 2)};
      for (int k = 0; k < per_span; ++k) {
        const double share = static_cast<double>(k) / per_span;
        points_.push_back(tube.spline ? pyramid(p, share) : p[1] + share * (p[2] - p[1]));
      }
    }
    points_.push_back(tube.closed ? tube.path[0] : tube.path.back());
  }
  double length() const {
    double sum = 0;
    for (std::size_t i = 1; i < points_.size(); ++i)
      sum += glm::length(points_[i] - points_[i - 1]);
    return sum;
  }
  // from the chords, which the curve leaves by step²·curvature/8
  double distance(const Vec3& q) const {
    constexpr std::size_t kBlock = 40;
    double best = 1e300;
    // a block's chords are no nearer than its first point less their length
    for (std::size_t first = 0; first + 1 < points_.size(); first += kBlock) {
      const std::size_t last = std::min(points_.size() - 1, first + kBlock);
      if (glm::length(q - points_[first]) - reach(first) > std::sqrt(best)) continue;
      for (std::size_t i = first + 1; i <= last; ++i) {
        const Vec3 d = points_[i] - points_[i - 1];
        const double t = std::clamp(glm::dot(q - points_[i - 1], d) / glm::dot(d, d), 0.0, 1.0);
        const Vec3 miss = q - points_[i - 1] - t * d;
        best = std::min(best, glm::dot(miss, miss));
      }
    }
    return std::sqrt(best);
  }
  // from the surface of a pipe, or of the cylinders that mitres cut
  double miss(const Vec3& q, const Tube& tube, double radius) const {
    if (tube.spline) return std::fabs(distance(q) - radius);
    double least = 1e300;
    for (std::size_t i = 1; i < tube.path.size(); ++i) {
      const Vec3 along = glm::normalize(tube.path[i] - tube.path[i - 1]);
      const Vec3 from = q - tube.path[i];
      least =
          std::min(least, std::fabs(glm::length(from - glm::dot(from, along) * along) - radius));
    }
    return least;
  }

 private:
  double reach(std::size_t first) const {
    const std::size_t block = first / 40;
    while (reach_.size() <= block) {
      const std::size_t begin = 40 * reach_.size();
      double furthest = 0;
      for (std::size_t i = begin; i <= std::min(points_.size() - 1, begin + 40); ++i)
        furthest = std::max(furthest, glm::length(points_[i] - points_[begin]));
      reach_.push_back(furthest);
    }
    return reach_[block];
  }
  std::vector<Vec3> points_;
  mutable std::vector<double> reach_;
};

// The largest | distance − radius | over points of the wall's triangles, on float32 vertices.
inline double sampled_error(const Mesh& mesh, const Tube& tube, int steps) {
  const Centreline path(tube);
  Vec3 least = mesh.positions[0], most = least;
  for (const Vec3& p : mesh.positions) least = glm::min(least, p), most = glm::max(most, p);
  const Vec3 origin = 0.5 * (least + most);
  const auto stored = [&](const Vec3& p) {
    const Vec3 d = p - origin;
    return origin + Vec3(static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z));
  };
  double worst = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = stored(mesh.positions[t[0]]), b = stored(mesh.positions[t[1]]),
               c = stored(mesh.positions[t[2]]);
    const Vec3 facet = glm::normalize(glm::cross(b - a, c - a));
    // caps are flat: their inside is at any distance
    if (glm::dot(facet, mesh.normals[t[0]]) > 0.999999 && !tube.closed &&
        mesh.normals[t[0]] == mesh.normals[t[1]] && mesh.normals[t[1]] == mesh.normals[t[2]])
      continue;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
        worst = std::max(worst, path.miss((1 - u - v) * a + u * b + v * c, tube, tube.radius));
      }
    }
  }
  return worst;
}

inline Tube ring(int points, double path_radius, double radius) {
  Tube tube;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * M_PI * i / points;
    tube.path.push_back({path_radius * std::cos(angle), path_radius * std::sin(angle), 0});
  }
  tube.radius = radius;
  tube.spline = tube.closed = true;
  return tube;
}

inline Tube helix(double radius, bool spline = true) {
  Tube tube;
  for (int i = 0; i <= 24; ++i) {
    const double angle = 2 * M_PI * i / 8;
    tube.path.push_back({std::cos(angle), std::sin(angle), 0.1 * i});
  }
  tube.radius = radius;
  tube.spline = spline;
  return tube;
}

// A closed curve in space without any plane: its frames come back turned.
inline Tube knot(double radius) {
  Tube tube;
  for (int i = 0; i < 40; ++i) {
    const double t = 2 * M_PI * i / 40;
    tube.path.push_back({std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t),
                         -1.5 * std::sin(3 * t)});
  }
  tube.radius = radius;
  tube.spline = tube.closed = true;
  return tube;
}

}  // namespace panwright::geometry::tubes
