// Surfaces of revolution against distances, volumes and areas that have nothing to do with how they
// are made.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/hash.h"
#include "base/parallel.h"
#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/support/shape_distance.h"

namespace panwright::geometry::surfaces_of_revolution_test {
namespace {

using oracles::Distance;
using oracles::sampled_distance;

struct Case {
  const char* name;
  Shape shape;
  Distance distance;
  double size;    // tolerances are shares of it
  double volume;  // 0: open
  double area;
  int euler = 2;
};

double ellipse_perimeter_integral(double a, double b, double c) {
  // the area of an ellipsoid by the midpoint rule, which converges geometrically in both angles
  const int n = 400;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 2 * M_PI * (i + 0.5) / n, v = M_PI * (j + 0.5) / n - M_PI / 2;
      const double x = std::cos(v) * std::cos(u) * b * c, y = std::cos(v) * std::sin(u) * a * c;
      sum += std::cos(v) * std::hypot(x, y, std::sin(v) * a * b);
    }
  }
  return sum * (2 * M_PI / n) * (M_PI / n);
}

double paraboloid_area(double radius, double focal) {
  const double k = 4 * focal * focal;
  return M_PI / (3 * focal) * (std::pow(k + radius * radius, 1.5) - std::pow(k, 1.5));
}

// Pappus: what a fine polyline (r, z) encloses and sweeps
double swept_volume(const std::vector<Vec2>& line) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 &p = line[i], &q = line[i + 1];
    sum += M_PI / 3 * (p.x * p.x + p.x * q.x + q.x * q.x) * (q.y - p.y);
  }
  return sum;
}
double swept_area(const std::vector<Vec2>& line) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    sum += M_PI * (line[i].x + line[i + 1].x) * glm::length(line[i + 1] - line[i]);
  return sum;
}

template <class S>
Case make_case(const char* name, const S& shape, double size, double volume, double area,
               int euler = 2) {
  return {name, shape, oracles::distance_to(shape), size, volume, area, euler};
}

Lathe vase() {
  Lathe s;
  s.profile = {{0, -1}, {1, -0.7}, {0.6, 0}, {0.8, 0.9}, {0, 1.5}};
  s.spline = true;
  return s;
}

Lathe ring() {
  Lathe s;
  s.profile = {{1, -1}, {1.5, 0}, {1, 1}, {0.5, 0}, {1, -1}};
  s.spline = true;
  return s;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back(make_case("cylinder", Cylinder{1, 2}, 1, 2 * M_PI, 6 * M_PI));
  all.push_back(make_case("cone", Cone{1, 0, 2}, 1, 2 * M_PI / 3, M_PI * (1 + std::sqrt(5.0))));
  all.push_back(make_case("frustum", Cone{1, 0.5, 2}, 1, M_PI * 2 / 3 * 1.75,
                          M_PI * (1.25 + 1.5 * std::hypot(0.5, 2))));
  all.push_back(
      make_case("pipe", Cone{1, 0.5, 2, Caps::none}, 1, 0, M_PI * 1.5 * std::hypot(0.5, 2), 0));
  all.push_back(make_case("disc", Disc{1}, 1, 0, M_PI, 1));
  all.push_back(make_case("ring", Disc{1, 0.3}, 1, 0, M_PI * 0.91, 0));
  all.push_back(make_case("torus", Torus{1, 0.25}, 1, 2 * M_PI * M_PI / 16, M_PI * M_PI, 0));
  all.push_back(make_case("fat torus", Torus{1, 0.95}, 1, 2 * M_PI * M_PI * 0.9025,
                          4 * M_PI * M_PI * 0.95, 0));
  all.push_back(make_case("dish", Dish{2, 0.5}, 1, 0, paraboloid_area(1, 0.5), 1));
  all.push_back(make_case("shell", Dish{2, 0.4, 0.1}, 1, M_PI * 0.1,
                          2 * paraboloid_area(1, 0.4) + 2 * M_PI * 0.1));
  all.push_back(make_case("ellipsoid", Ellipsoid{{3, 2, 1}}, 3, 8 * M_PI,
                          ellipse_perimeter_integral(3, 2, 1)));
  all.push_back(make_case("ball", Ellipsoid{{1, 1, 1}}, 1, 4 * M_PI / 3, 4 * M_PI));
  all.push_back(make_case("zone", Sphere{1, {}, -0.5, 1.0, {}}, 1, 0,
                          2 * M_PI * (std::sin(1.0) + std::sin(0.5)), 0));
  all.push_back(
      make_case("cap", Sphere{1, {}, 0.2, kPi / 2, {}}, 1, 0, 2 * M_PI * (1 - std::sin(0.2)), 1));
  for (const auto& [name, s, euler] : {std::tuple{"vase", vase(), 2}, {"bent ring", ring(), 0}}) {
    const std::vector<Vec2> line = oracles::profile_of(s, 20000);
    all.push_back(make_case(name, s, 1, swept_volume(line), swept_area(line), euler));
  }
  Lathe edges = vase();
  edges.spline = false;
  all.push_back(
      make_case("beads", edges, 1, swept_volume(edges.profile), swept_area(edges.profile)));
  return all;
}

Mesh made(const Shape& shape, double max_error, bool texcoords = false,
          std::uint32_t edge_segments = 0) {
  TessellationOptions options;
  options.max_error = max_error;
  options.texcoords = texcoords;
  options.edge_segments = edge_segments;
  DiagnosticLog log;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok()) << (log.entries().empty() ? "" : log.entries().front().message);
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

// of the surface whose vertices at one place are one
int euler_number(const Mesh& mesh) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::map<Vec3, int, decltype(less)> places(less);
  std::vector<int> place(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    place[i] =
        places.try_emplace(mesh.positions[i] + 0.0, static_cast<int>(places.size())).first->second;
  std::set<std::pair<int, int>> edges;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.insert(std::minmax(place[t[k]], place[t[(k + 1) % 3]]));
  return static_cast<int>(places.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(mesh.triangles.size());
}

TEST(RoundShapes, ErrorIsKeptProvenAndNotWasted) {
  for (const Case& one : cases()) {
    for (const double share : {0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 1e-4}) {
      const double max_error = share * one.size;
      const Mesh mesh = made(one.shape, max_error);
      SCOPED_TRACE(std::string(one.name) + " " + std::to_string(share));
      EXPECT_LE(mesh.error, max_error);
      // the oracle of a spline is a polyline, off by 1e-6
      const bool spline = std::holds_alternative<Lathe>(one.shape);
      if (mesh.triangles.size() > 45000 || (spline && share < 1e-3)) continue;
      const int steps = mesh.triangles.size() < 1000 ? 12 : mesh.triangles.size() < 5000 ? 4 : 2;
      const double sampled = sampled_distance(mesh, one.distance, steps).worst;
      EXPECT_LE(sampled, mesh.error * (1 + 1e-9) + (spline ? 1e-6 : 0));
      // whole numbers of segments decide where there are few; the least of all measured is 0.507
      if (share <= 0.1) {
        EXPECT_GE(sampled, 0.5 * max_error);
      }
    }
  }
}

TEST(RoundShapes, AreClosedOutwardAndWhole) {
  for (const Case& one : cases()) {
    for (const double share : {10.0, 0.3, 0.1, 1e-2}) {
      for (const bool texcoords : {false, true}) {
        const Mesh mesh = made(one.shape, share * one.size, texcoords);
        const MeshReport report = check(mesh);
        SCOPED_TRACE(std::string(one.name) + " " + std::to_string(share));
        EXPECT_EQ(report.closed, one.volume > 0);
        EXPECT_EQ(mesh.closed, report.closed);
        EXPECT_EQ(is_closed(one.shape), report.closed);
        EXPECT_EQ(report.degenerate_triangles, 0u);
        EXPECT_EQ(report.bad_normals, 0u);
        EXPECT_EQ(report.bad_lengths, 0u);
        EXPECT_EQ(report.non_finite, 0u);
        EXPECT_EQ(report.non_manifold_edges, 0u);
        EXPECT_EQ(report.misoriented_edges, 0u);
        EXPECT_EQ(euler_number(mesh), one.euler);
        if (one.volume > 0) {
          EXPECT_GT(report.volume, 0);
        }
        for (const Vec2& uv : mesh.texcoords) {
          EXPECT_GE(std::min(uv.x, uv.y), 0);
          EXPECT_LE(std::max(uv.x, uv.y), 1);
        }
      }
    }
  }
}

TEST(RoundShapes, VolumesAndAreasConverge) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    for (const double share : {1e-2, 1e-3, 1e-4}) {
      const MeshReport report = check(made(one.shape, share * one.size));
      // a shell of this thickness; 0.45 of it measured for the worst, the ball: equilateral facets
      // lie inside by half of it on average, those of a grid by a third
      const double shell = one.area * share * one.size;
      if (one.volume > 0) {
        EXPECT_LE(std::fabs(report.volume - one.volume), 0.5 * shell);
      }
      // areas are of the first order in the error: 0.74 of it for the worst, the torus
      const double area_error = std::fabs(report.area - one.area) / one.area;
      EXPECT_LE(area_error, 0.8 * share);
    }
  }
}

// The gradient of the distance at a point off the surface.
Vec3 gradient(const Distance& distance, const Vec3& p, double step) {
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 d(0);
    d[axis] = step;
    g[axis] = (distance(p + d) - distance(p - d)) / (2 * step);
  }
  return glm::normalize(g);
}

TEST(RoundShapes, NormalsAreGradients) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const Mesh mesh = made(one.shape, 2e-3 * one.size);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      // a place that is smooth: a little off the vertex, inside one of its triangles
      const auto at =
          std::find_if(mesh.triangles.begin(), mesh.triangles.end(),
                       [&](const Triangle& t) { return t[0] == i || t[1] == i || t[2] == i; });
      ASSERT_NE(at, mesh.triangles.end());
      const Vec3 middle =
          (mesh.positions[(*at)[0]] + mesh.positions[(*at)[1]] + mesh.positions[(*at)[2]]) / 3.0;
      const Vec3& n = mesh.normals[i];
      const Vec3 inside = mesh.positions[i] + 0.2 * (middle - mesh.positions[i]);
      // a hundredth off, so that the side of the surface is plain
      const Vec3 g = gradient(one.distance, inside + 0.01 * one.size * n, 1e-5 * one.size);
      // 0.071 measured: vertices stand off the shape, and the place off the vertex
      EXPECT_LT(glm::length(g - n), 0.08) << i;
    }
  }
}

TEST(RoundShapes, CountsAreThoseOfTheClosedForms) {
  for (const double e : {1e-2, 1e-3, 1e-4, 1e-5}) {
    SCOPED_TRACE(e);
    const auto count = [&](const Shape& s) {
      TessellationOptions options;
      options.max_error = e;
      return planned_triangles(s, options);
    };
    // an outline of the same area stands out by h²/3 of its radius, h = π/n
    // of what is left of it after rounding, 6e-8·|p| each; 1.2 % of the smallest
    const double n = M_PI / std::sqrt(3 * (e - 1.5e-7));
    EXPECT_LE(count(Cylinder{1, 2}), 4 * (n + 1) - 4);
    EXPECT_LE(count(Disc{1, 0.5}), 2 * (n + 1));
    EXPECT_LE(count(Cone{1, 0, 1}), 2 * (n + 1) - 2);
    // equal shares for both directions, half of an inscribed error: physics 5.1. Steps that go with
    // the local lever need fewer: 0.88 measured at 1e-5; whole numbers more at 1e-2: 1.06
    EXPECT_LE(count(Torus{1, 0.25}), 1.1 * M_PI * M_PI * std::sqrt(1.25 * 0.25) / e);
    // a sphere: 1.10 at 1e-2, 1.00 at 1e-5
    EXPECT_LE(count(Ellipsoid{{1, 1, 1}}), 1.3 * M_PI * M_PI / (2 * e));
    // a paraboloid of f = R/2: lever R²/sqrt(R² + 4f²), chords ∫ sqrt(bend/(8e)) ds
    double chords = 0;
    for (int i = 0; i < 1000; ++i)
      chords += 1e-3 * std::sqrt(1 / (8 * e)) * std::pow(1 + std::pow((i + 0.5) * 1e-3, 2), -0.25);
    const double segments = std::max(n, M_PI / std::sqrt(2 * e / std::sqrt(2.0)));
    EXPECT_LE(count(Dish{2, 0.5}), 1.3 * (2 * chords - 1) * segments);
  }
}

TEST(RoundShapes, PlansAreExact) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    for (const double share : {1.0, 0.1, 1e-2, 1e-3, 1e-4}) {
      TessellationOptions options;
      options.max_error = share * one.size;
      const double made_of =
          static_cast<double>(made(one.shape, options.max_error).triangles.size());
      const double planned = planned_triangles(one.shape, options);
      if (std::holds_alternative<Ellipsoid>(one.shape))
        EXPECT_NEAR(made_of, planned, 0.02 * made_of);
      else
        EXPECT_EQ(made_of, planned);
    }
  }
}

TEST(RoundShapes, OutlinesKeepTheirArea) {
  for (const double e : {0.2, 1e-2, 1e-3, 1e-5}) {
    EXPECT_NEAR(check(made(Disc{1}, e)).area / M_PI, 1, 1e-14);  // 2e-15 measured
    EXPECT_NEAR(check(made(Disc{2, 0.7}, e)).area / (M_PI * 3.51), 1, 1e-14);
    const Sector third{0.3, 1.9};
    EXPECT_NEAR(check(made(Disc{1, 0, third}, e)).area / 0.8, 1, 1e-14);
    const Mesh cylinder = made(Cylinder{1, 2, Caps::both, third}, e);
    EXPECT_NEAR(check(cylinder).volume / 1.6, 1, 1e-14);
    EXPECT_NEAR(check(made(Cone{1, 0, 3}, e)).volume / M_PI, 1, 1e-14);
  }
}

TEST(RoundShapes, BytesDoNotDependOnThreads) {
  const auto hash = [](std::size_t threads, const Shape& shape) {
    Mesh mesh;
    run_on_threads(Job({threads, {}}), [&] { mesh = made(shape, 1e-5, true); });
    return std::tuple{hash64(std::as_bytes(std::span(mesh.positions))),
                      hash64(std::as_bytes(std::span(mesh.normals))),
                      hash64(std::as_bytes(std::span(mesh.texcoords))),
                      hash64(std::as_bytes(std::span(mesh.triangles))), mesh.error};
  };
  for (const Shape& shape : {Shape(Torus{1, 0.3}), Shape(Ellipsoid{{1, 0.7, 0.4}}),
                             Shape(Dish{1, 0.3, 0.01}), Shape(Cylinder{1, 1})}) {
    const auto one = hash(1, shape);
    EXPECT_EQ(one, hash(2, shape));
    EXPECT_EQ(one, hash(5, shape));
  }
}

}  // namespace
}  // namespace panwright::geometry::surfaces_of_revolution_test
