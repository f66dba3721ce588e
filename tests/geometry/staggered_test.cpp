// Spheres, ellipsoids and frusta without explicit counts: how few triangles they need, and that
// these keep what is asked for. The oracles are closed forms and samples of their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::staggered_test {
namespace {

Mesh made(const Shape& shape, double error, bool texcoords = false) {
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = error;
  options.texcoords = texcoords;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok());
  if (!mesh.ok()) return {};
  EXPECT_LE(mesh->error, error);
  EXPECT_EQ(static_cast<double>(mesh->triangles.size()), planned_triangles(shape, options));
  const MeshReport report = check(*mesh);
  EXPECT_EQ(report.closed, mesh->closed);
  EXPECT_EQ(report.degenerate_triangles, 0u);
  EXPECT_EQ(report.bad_normals, 0u);
  EXPECT_EQ(report.bad_lengths, 0u);
  return *mesh;
}

// An error beyond a shape's size makes the coarsest mesh, not one that stands out by the error.
TEST(Staggered, ErrorsBeyondTheSize) {
  for (const double error : {1.0, 3.0, 1e3, 1e30})
    for (const bool texcoords : {false, true})
      for (const Vec3& radii : {Vec3(1), Vec3(3, 2, 1), Vec3(1, 1, 0.01), Vec3(1, 100, 1)}) {
        const Shape shape = radii == Vec3(1) ? Shape(Sphere{1}) : Shape(Ellipsoid{radii});
        const Mesh mesh = made(shape, error * radii.x, texcoords);
        EXPECT_GE(mesh.triangles.size(), 6u);
        // measured: 0.91 of the longest radius
        const double largest = std::max({radii.x, radii.y, radii.z});
        EXPECT_LE(mesh.error, largest);
        for (const Vec3& p : mesh.positions) EXPECT_LE(glm::length(p), 1.5 * largest);
      }
}

// Fejes Tóth: no polyhedron of so many triangles in a unit sphere comes closer to it than one of
// equilateral ones would. Its depth under the sphere.
double least_depth(double triangles) {
  const double angle = (M_PI + 4 * M_PI / triangles) / 3;
  return 1 - 1 / (std::tan(M_PI / 3) * std::tan(angle / 2));
}

double fewest_for_a_sphere(double error) {
  // vertices stand out by as much as facets dip inside
  const double depth = 2 * error / (1 + error);
  double low = 4, high = 1e12;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (least_depth(middle) > depth ? low : high) = middle;
  }
  return high;
}

// Many small triangles, each of which may lie inside by as much as its corners lie outside:
// ∫ h dω / (3√3·error) over the unit sphere, h the distance between centre and tangent plane.
double fewest_for_an_ellipsoid(const Vec3& r, double error) {
  double sum = 0;
  const int n = 300;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double t = (i + 0.5) * M_PI / n, l = (j + 0.5) * M_PI / 2 / n;
      const Vec3 u(std::sin(t) * std::cos(l), std::sin(t) * std::sin(l), std::cos(t));
      sum += std::sin(t) / glm::length(u / r);
    }
  return sum * 4 * (M_PI / n) * (M_PI / 2 / n) / (3 * std::sqrt(3.0) * error);
}

double distance_to_ellipsoid(const Vec3& r, const Vec3& p) {
  const auto above = [&](double t) {
    double sum = -1;
    for (int k = 0; k < 3; ++k) sum += std::pow(r[k] * p[k] / (t + r[k] * r[k]), 2);
    return sum;
  };
  const double least = std::min({r.x, r.y, r.z});
  double low = -least * least * (1 - 1e-12);
  double high = glm::length(p) * std::max({r.x, r.y, r.z}) + 1;
  if (above(low) < 0) return least;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (above(middle) > 0 ? low : high) = middle;
  }
  Vec3 nearest;
  for (int k = 0; k < 3; ++k) nearest[k] = r[k] * r[k] * p[k] / (low + r[k] * r[k]);
  return glm::length(nearest - p);
}

// The largest distance of samples of the triangles, on float32 vertices.
template <class Distance>
double sampled_error(const Mesh& mesh, int steps, const Distance& distance) {
  double worst = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        corner[k][axis] = static_cast<float>(mesh.positions[t[k]][axis]);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
        worst = std::max(worst, distance((1 - u - v) * corner[0] + u * corner[1] + v * corner[2]));
      }
  }
  return worst;
}

// How far along the line from the centre the mesh is, in each direction exactly once.
double along(const Mesh& mesh, const Vec3& direction) {
  double found = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double u = glm::dot(direction, glm::cross(b, c)),
                 v = glm::dot(direction, glm::cross(c, a)),
                 w = glm::dot(direction, glm::cross(a, b));
    if (u < 0 || v < 0 || w < 0) continue;
    EXPECT_EQ(found, 0);
    found = glm::dot(a, glm::cross(b, c)) / (u + v + w);
  }
  return found;
}

TEST(Staggered, SpheresNeedLittleMoreThanTheFewestTrianglesPossible) {
  struct Case {
    double error;
    std::size_t triangles;
    double most, most_textured;  // of the bound
  };
  // measured 1.04, 1.36, 1.26, 1.23, 1.17, 1.14, 1.07, 1.04; 2.0 on a grid
  for (const Case& c : {Case{0.1, 24, 1.05, 1.14},
                        {0.05, 64, 1.36, 1.45},
                        {0.03, 100, 1.27, 1.32},
                        {0.01, 296, 1.24, 1.22},
                        {3e-3, 940, 1.18, 1.25},
                        {1e-3, 2744, 1.15, 1.23},
                        {1e-4, 25906, 1.08, 1.18},
                        {1e-5, 251738, 1.05, 1.17}}) {
    const double fewest = fewest_for_a_sphere(c.error);
    const Mesh mesh = made(Sphere{1, {}}, c.error);
    EXPECT_EQ(mesh.triangles.size(), c.triangles);
    EXPECT_LE(mesh.triangles.size(), c.most * fewest) << c.error;
    EXPECT_GE(mesh.triangles.size(), fewest);
    const Mesh textured = made(Sphere{1, {}}, c.error, true);
    EXPECT_LE(textured.triangles.size(), c.most_textured * fewest) << c.error;
    if (c.error < 1e-3) continue;
    const auto miss = [](const Vec3& p) { return std::fabs(glm::length(p) - 1); };
    for (const Mesh* m : {&mesh, &textured}) {
      EXPECT_LE(sampled_error(*m, 24, miss), c.error);
      EXPECT_GE(sampled_error(*m, 24, miss), 0.99 * c.error);  // 0.9997 measured
    }
  }
}

TEST(Staggered, TheMeshIsAllRoundTheSphere) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double error : {0.2, 0.03, 0.004}) {
    const Mesh mesh = made(Sphere{1, {}}, error);
    for (int i = 0; i < 400; ++i) {
      const Vec3 d = glm::normalize(Vec3(normal(random), normal(random), normal(random)));
      EXPECT_NEAR(along(mesh, d), 1, error);
    }
  }
}

TEST(Staggered, EllipsoidsNeedLittleMoreThanTheFewestTrianglesPossible) {
  struct Case {
    Vec3 radii;
    double error, most, most_textured;
  };
  // measured without and with texture coordinates 1.39 1.42, 1.31 1.41, 1.21 1.34, 1.42 1.47,
  // 1.36 1.43, 1.55 1.67, 1.38 1.66, 1.35 1.60, 1.30 1.54, 1.29 1.98, 1.16 1.26; 2.0 to 3.1 on a
  // grid. With texture coordinates the poles are on z, and counts about it fall less
  for (const Case& c : {Case{{3, 2, 1}, 0.03, 1.5, 1.6},
                        {{3, 2, 1}, 3e-3, 1.33, 1.42},
                        {{3, 2, 1}, 3e-4, 1.23, 1.35},
                        {{1, 1, 100}, 0.01, 1.46, 1.5},
                        {{1, 1, 100}, 1e-3, 1.4, 1.46},
                        {{1, 1, 0.1}, 1e-3, 1.56, 1.7},
                        {{1, 1, 0.1}, 1e-4, 1.4, 1.67},
                        {{1, 0.3, 0.2}, 0.01, 1.37, 1.62},
                        {{1, 0.3, 0.2}, 1e-3, 1.3, 1.55},
                        {{10, 1, 1}, 0.01, 1.35, 2.0},
                        {{1, 1.2, 0.9}, 1.2e-3, 1.2, 1.3}}) {
    const double fewest = fewest_for_an_ellipsoid(c.radii, c.error);
    for (const bool texcoords : {false, true}) {
      const Mesh mesh = made(Ellipsoid{c.radii}, c.error, texcoords);
      EXPECT_LE(mesh.triangles.size(), (texcoords ? c.most_textured : c.most) * fewest)
          << c.radii.x << " " << c.radii.y << " " << c.radii.z << " " << c.error;
      if (mesh.triangles.size() > 6000) continue;
      const double sampled =
          sampled_error(mesh, 10, [&](const Vec3& p) { return distance_to_ellipsoid(c.radii, p); });
      EXPECT_LE(sampled, c.error);
      EXPECT_GE(sampled, 0.9 * c.error);
    }
  }
}

TEST(Staggered, NormalsAreThoseOfTheNearestPoint) {
  for (const Vec3& r : {Vec3(3, 2, 1), Vec3(1, 1, 20), Vec3(5, 0.7, 1)})
    for (const bool texcoords : {false, true}) {
      const Mesh mesh = made(Ellipsoid{r}, 0.02, texcoords);
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3& n = mesh.normals[i];
        // from the vertex back along the normal, to the point that has this normal
        const Vec3 foot = r * r * n / glm::length(r * n);
        const Vec3 way = mesh.positions[i] - foot;
        EXPECT_LE(glm::length(glm::cross(way, n)), 1e-12);
      }
    }
}

// How far a point of the texture lies from where its coordinates say, on the unit sphere.
TEST(Staggered, TexturesStayInPlace) {
  for (const double error : {0.05, 0.01, 1e-3, 1e-4}) {
    const Mesh mesh = made(Sphere{1, {}}, error, true);
    double worst = 0;
    const int steps = 6;
    for (const Triangle& t : mesh.triangles)
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
          const double b[3] = {static_cast<double>(i) / steps, static_cast<double>(j) / steps,
                               1 - static_cast<double>(i + j) / steps};
          Vec3 p(0);
          Vec2 uv(0);
          for (int k = 0; k < 3; ++k) {
            p += b[k] * mesh.positions[t[k]];
            uv += b[k] * mesh.texcoords[t[k]];
          }
          const double u = 2 * M_PI * uv.x, v = M_PI * (uv.y - 0.5);
          const Vec3 said(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
          worst = std::max(worst, glm::length(glm::normalize(p) - said));
        }
    // 3.3, 3.3, 3.2 and 2.7 errors measured; 12 to 49 where counts fall to 5 about the poles
    EXPECT_LE(worst, 4 * error) << error;
  }
}

TEST(Staggered, TheSeamIsTheFirstMeridian) {
  for (const Shape& shape : {Shape(Sphere{1, {}}), Shape(Ellipsoid{{3, 2, 1}})}) {
    const Mesh mesh = made(shape, 0.01, true);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const double u = mesh.texcoords[i].x;
      EXPECT_GE(u, 0);
      EXPECT_LE(u, 1);
      if (u != 0 && u != 1) continue;
      EXPECT_EQ(mesh.positions[i].y, 0);
      EXPECT_GE(mesh.positions[i].x, 0);
    }
    for (const Triangle& t : mesh.triangles) {
      double low = 1, high = 0;
      for (const std::uint32_t v : t) {
        low = std::min(low, mesh.texcoords[v].x);
        high = std::max(high, mesh.texcoords[v].x);
      }
      EXPECT_LE(high - low, 0.34);
    }
  }
}

TEST(Staggered, AnotherFirstMeridianTurnsTheSphere) {
  Sphere turned{1, {}};
  turned.sector = {0.7, 0.7 + 2 * kPi};
  for (const bool texcoords : {false, true}) {
    const Mesh a = made(Sphere{1, {}}, 0.01, texcoords), b = made(turned, 0.01, texcoords);
    ASSERT_EQ(a.triangles, b.triangles);
    for (std::size_t i = 0; i < a.positions.size(); ++i) {
      const Vec3& p = a.positions[i];
      const Vec3 q(std::cos(0.7) * p.x - std::sin(0.7) * p.y,
                   std::sin(0.7) * p.x + std::cos(0.7) * p.y, p.z);
      EXPECT_LE(glm::length(b.positions[i] - q), 1e-15);
    }
  }
}

// The segments of a circle of an area's polygon: vertices outside by a third of the sag.
double circle_segments(double radius, double error) { return M_PI / std::sqrt(3 * error / radius); }

TEST(Frustum, TheSmallerEndHasFewerSegments) {
  struct Case {
    double top;
    double most;  // of the segments of both ends and of their caps
  };
  // 1.01 to 1.83 with equal segments
  for (const Case& c : {Case{0.95, 1.04}, {0.7, 1.05}, {0.4, 1.16}, {0.25, 1.06}, {0.04, 1.33}}) {
    for (const double error : {1e-3, 1e-4}) {
      const Mesh mesh = made(Cone{1, c.top, 1.5}, error);
      const double fewest = 2 * (circle_segments(1, error) + circle_segments(c.top, error)) - 4;
      EXPECT_LE(mesh.triangles.size(), c.most * fewest) << c.top << " " << error;
      const auto distance = [&](const Vec3& p) {
        // to the wall, the top or the bottom, in the plane of the axis
        const Vec2 q(std::hypot(p.x, p.y), p.z);
        const auto segment = [&](const Vec2& a, const Vec2& b) {
          const double t = std::clamp(glm::dot(q - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
          return glm::length(q - a - t * (b - a));
        };
        const Vec2 bottom(1, -0.75), top(c.top, 0.75);
        return std::min(
            {segment(bottom, top), segment({0, -0.75}, bottom), segment({0, 0.75}, top)});
      };
      EXPECT_LE(sampled_error(mesh, 12, distance), error);
      EXPECT_GE(sampled_error(mesh, 12, distance), 0.9 * error);
    }
  }
}

// Of the first order in the error, as of other shapes: 0.41 and 0.42 of a shell of its thickness.
TEST(Frustum, EndsKeepTheirAreaAndTheVolumeIsNear) {
  for (const double error : {1e-2, 1e-4}) {
    const Mesh mesh = made(Cone{1, 0.4, 3}, error);
    double bottom = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 n = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                mesh.positions[t[2]] - mesh.positions[t[0]]);
      if (n.x == 0 && n.y == 0 && n.z < 0) bottom -= 0.5 * n.z;
    }
    EXPECT_NEAR(bottom / M_PI, 1, 1e-14);
    const double volume = M_PI * 1.56;
    EXPECT_NEAR(check(mesh).volume / volume, 1, 0.45 * error);
  }
}

TEST(Frustum, NoEdgeSpansMoreThanASegmentOfTheLargerEnd) {
  for (const double top : {0.8, 0.5, 0.2, 0.01})
    for (const bool texcoords : {false, true}) {
      Cone cone{1, top, 1};
      cone.caps = Caps::none;
      const Mesh mesh = made(cone, 1e-3, texcoords);
      std::set<double> bottom;
      for (const Vec3& p : mesh.positions)
        if (p.z < 0) bottom.insert(std::round(1e9 * std::atan2(p.y, p.x)));
      const double segment = 2 * M_PI / static_cast<double>(bottom.size());
      for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
          const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
          if (a.z == b.z) continue;
          const double angle = std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
          EXPECT_LE(std::fabs(angle), segment * (1 + 1e-9));
        }
    }
}

TEST(Frustum, SectorsWithWallsStayClosed) {
  Cone cone{1, 0.3, 1};
  cone.sector = {0.4, 3};
  for (const bool texcoords : {false, true}) {
    const Mesh mesh = made(cone, 1e-3, texcoords);
    EXPECT_TRUE(mesh.closed);
  }
  Disc disc{1, 0.2};
  disc.sector = {0, 2};
  const Mesh ring = made(disc, 1e-3, true);
  EXPECT_NEAR(check(ring).area, 0.5 * 2 * (1 - 0.04), 1e-12);
}

}  // namespace
}  // namespace panwright::geometry::staggered_test
