#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "base/hash.h"
#include "base/parallel.h"
#include "geometry/internal/triangle.h"
#include "shapes.h"

namespace panwright::geometry::sphere_test {
namespace {

using shapes::sphere;

// Relative to R: volume of the inscribed latitude-longitude polyhedron, summed band by band as
// frusta of q-gons (an independent closed form: prismatoid of similar polygons).
double polyhedron_volume(int rings, int quads) {
  const double polygon = 0.5 * quads * std::sin(2 * M_PI / quads);  // area / circumradius²
  double volume = 0;
  for (int j = 0; j < rings; ++j) {
    const double t0 = M_PI * j / rings;
    const double t1 = M_PI * (j + 1) / rings;
    const double r0 = std::sin(t0);
    const double r1 = std::sin(t1);
    volume += polygon * (std::cos(t0) - std::cos(t1)) / 3 * (r0 * r0 + r0 * r1 + r1 * r1);
  }
  return volume;
}

// The same for its area: trapezoids between chords of neighbouring parallels.
double polyhedron_area(int rings, int quads) {
  double area = 0;
  for (int j = 0; j < rings; ++j) {
    const double t0 = M_PI * j / rings;
    const double t1 = M_PI * (j + 1) / rings;
    const double chord0 = 2 * std::sin(t0) * std::sin(M_PI / quads);
    const double chord1 = 2 * std::sin(t1) * std::sin(M_PI / quads);
    const double apothem = (std::sin(t0) - std::sin(t1)) * std::cos(M_PI / quads);
    const double slant = std::hypot(apothem, std::cos(t0) - std::cos(t1));
    area += quads * 0.5 * (chord0 + chord1) * slant;
  }
  return area;
}

// The largest | |p| − R | over a dense sampling of every triangle, on float32 vertices.
double sampled_error(const Mesh& mesh, double radius, int steps) {
  double worst = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        corner[k][axis] = static_cast<float>(mesh.positions[t[k]][axis]);
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps;
        const double v = static_cast<double>(j) / steps;
        const Vec3 p = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        worst = std::max(worst, std::fabs(glm::length(p) - radius));
      }
    }
  }
  return worst;
}

TEST(Sphere, FigureEightHasItsPublishedCountAndError) {
  const Mesh mesh = sphere(100, 60);
  EXPECT_EQ(mesh.triangles.size(), 11880u);
  EXPECT_EQ(mesh.positions.size(), 99u * 60 + 2);
  // physics 5.1: bound 1.4937e-3, dense sampling 1.4933e-3
  EXPECT_LT(mesh.error, 1.494e-3);
  EXPECT_GT(mesh.error, 1.4930e-3);
}

TEST(Sphere, OtherPublishedErrors) {
  EXPECT_NEAR(sphere(60, 100).error, 8.36e-4, 2e-6);
  EXPECT_NEAR(sphere(32, 64).error, 2.41e-3, 1e-5);
  EXPECT_NEAR(sphere(16, 16).error, 2.39e-2, 3e-4);
}

TEST(Sphere, CountsAreObeyedAndTheMeshIsClosedAndOutward) {
  for (const auto& [rings, quads] :
       {std::pair{2, 3}, {2, 4}, {3, 3}, {3, 7}, {16, 16}, {101, 60}}) {
    for (const bool texcoords : {false, true}) {
      const Mesh mesh = sphere(rings, quads, 1, texcoords);
      const MeshReport report = check(mesh);
      EXPECT_EQ(mesh.triangles.size(), 2u * quads * (rings - 1));
      EXPECT_TRUE(report.closed) << rings << " " << quads << " " << texcoords;
      EXPECT_EQ(report.degenerate_triangles, 0u);
      EXPECT_EQ(report.bad_normals, 0u);
      EXPECT_EQ(report.bad_lengths, 0u);
      // 8.9e-16 and 1.8e-15 measured
      EXPECT_NEAR(report.volume, polyhedron_volume(rings, quads), 1e-14);
      EXPECT_NEAR(report.area, polyhedron_area(rings, quads), 2e-14);
    }
  }
}

TEST(Sphere, EulerCharacteristicIsTwo) {
  const Mesh mesh = sphere(17, 23);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  EXPECT_EQ(mesh.positions.size() + mesh.triangles.size() - edges.size(), 2u);
}

TEST(Sphere, DeficitsOfFigureEight) {
  const MeshReport report = check(sphere(100, 60));
  // physics 5.1: volume 2.07e-3, area 1.04e-3 below the sphere
  EXPECT_NEAR(1 - report.volume / (4 * M_PI / 3), 2.07e-3, 5e-6);
  EXPECT_NEAR(1 - report.area / (4 * M_PI), 1.04e-3, 5e-6);
}

TEST(Sphere, NormalsAreTheDirectionsOfVertices) {
  const Mesh mesh = sphere(31, 45, 7.5);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    // 1.6e-16 measured
    EXPECT_LT(glm::length(mesh.normals[i] - mesh.positions[i] / 7.5), 1e-15);
}

TEST(Sphere, FirstMeridianIsAtPlusXAndEastwardsIsAnticlockwise) {
  const Mesh mesh = sphere(4, 8);
  EXPECT_EQ(mesh.positions[0], Vec3(0, 0, -1));
  // the equator is the second ring
  EXPECT_EQ(mesh.positions[1 + 8], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.positions[1 + 8 + 2], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.positions[1 + 8 + 4], Vec3(-1, 0, 0));
  EXPECT_EQ(mesh.positions.back(), Vec3(0, 0, 1));
}

TEST(Sphere, IsSymmetricToTheLastBit) {
  const Mesh mesh = sphere(20, 24);
  const auto has = [&](const Vec3& p) {
    for (const Vec3& q : mesh.positions)
      if (p == q) return true;
    return false;
  };
  for (const Vec3& p : mesh.positions) {
    EXPECT_TRUE(has({-p.x, p.y, p.z}));
    EXPECT_TRUE(has({p.x, -p.y, p.z}));
    EXPECT_TRUE(has({p.y, p.x, p.z}));
    EXPECT_TRUE(has({p.x, p.y, -p.z}));
  }
}

TEST(Sphere, TexcoordsFollowLongitudeAndLatitude) {
  const int rings = 12;
  const int quads = 20;
  const Mesh mesh = sphere(rings, quads, 1, true);
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    double low = 2;
    double high = -1;
    for (const std::uint32_t v : t) {
      const Vec3& p = mesh.positions[v];
      const Vec2& uv = mesh.texcoords[v];
      low = std::min(low, uv.x);
      high = std::max(high, uv.x);
      EXPECT_NEAR(uv.y, std::asin(p.z) / M_PI + 0.5, 1e-15);  // 1.1e-16 measured
      if (std::hypot(p.x, p.y) < 1e-9) continue;
      const double expected = std::atan2(p.y, p.x) / (2 * M_PI);
      EXPECT_NEAR(std::remainder(uv.x - expected, 1.0), 0, 1e-15);
    }
    // no triangle runs back across the texture
    EXPECT_LE(high - low, 1.0 / quads + 1e-12);
    EXPECT_GE(low, 0);
    EXPECT_LE(high, 1);
  }
}

TEST(Sphere, MeasuredErrorAgreesWithDenseSampling) {
  for (const auto& [rings, quads] : {std::pair{2, 3}, {3, 5}, {7, 12}, {8, 12}, {40, 30}}) {
    const Mesh mesh = sphere(rings, quads, 3);
    const double sampled = sampled_error(mesh, 3, 60);
    EXPECT_LE(sampled - mesh.error, 1e-14);  // ulps of 3
    // samples miss the nearest point by at most edge²/(8·60²) of the depth
    EXPECT_GE(sampled, mesh.error * 0.999);
  }
}

TEST(Sphere, ErrorRequestedIsKeptAndNotWasted) {
  for (double radius : {1e-9, 0.37, 1.0, 12.5, 1e12}) {
    for (double relative : {0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 1e-4, 1.7e-5, 3e-6}) {
      DiagnosticLog log;
      TessellationOptions options;
      options.max_error = relative * radius;
      const auto mesh = tessellated(Sphere{radius, {}}, options, {}, log);
      ASSERT_TRUE(mesh.ok());
      EXPECT_LE(mesh->error, options.max_error);
      if (mesh->triangles.size() > 6) {
        EXPECT_GE(mesh->error, 0.5 * options.max_error);
      }
      if (mesh->triangles.size() > 20000) {
        EXPECT_GE(mesh->error, 0.97 * options.max_error);
      }
    }
  }
}

TEST(Sphere, SampledErrorOfARequestedOne) {
  for (double requested : {0.2, 0.05, 7e-3, 1e-3}) {
    DiagnosticLog log;
    TessellationOptions options;
    options.max_error = requested;
    const auto mesh = tessellated(Sphere{1, {}}, options, {}, log);
    ASSERT_TRUE(mesh.ok());
    EXPECT_LE(sampled_error(*mesh, 1, 40), requested);
    EXPECT_TRUE(check(*mesh).closed);
  }
}

TEST(Sphere, LimitsHoldBeforeAnythingIsAllocated) {
  for (const SphereCounts counts : {SphereCounts{1000000000u, 60}, SphereCounts{100, 4294967295u},
                                    SphereCounts{4294967295u, 4294967295u}}) {
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(Sphere{1, counts}, {}, {}, log).ok());
    EXPECT_TRUE(log.contains(Code("E2003")));
  }
  DiagnosticLog log;
  TessellationOptions options;
  options.max_triangles = 11879;
  EXPECT_FALSE(tessellated(Sphere{1, SphereCounts{100, 60}}, options, {}, log).ok());
  options.max_triangles = 11880;
  EXPECT_TRUE(tessellated(Sphere{1, SphereCounts{100, 60}}, options, {}, log).ok());
  for (const double impossible : {1e-8, 1e-15, 1e-300}) {
    DiagnosticLog other;
    options.max_error = impossible;
    EXPECT_FALSE(tessellated(Sphere{1, {}}, options, {}, other).ok());
    EXPECT_TRUE(other.contains(Code("E2003")));
  }
}

TEST(Sphere, SizesThatSinglePrecisionCannotHoldAreRefused) {
  for (const double radius : {0.0, -1.0, 1e-31, 1e31, 1e300, HUGE_VAL, std::nan("")}) {
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(Sphere{radius, SphereCounts{4, 4}}, {}, {}, log).ok());
    EXPECT_TRUE(log.contains(Code("E2010"))) << radius;
  }
  for (const double radius : {1e-30, 1e-9, 1e12, 1e30}) {
    const Mesh mesh = sphere(100, 60, radius);
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_EQ(report.degenerate_triangles, 0u);
    EXPECT_NEAR(mesh.error / radius, 1.4933e-3, 1e-7);  // 6e-8 measured: float32 vertices
    // 8.9e-16 measured
    EXPECT_NEAR(report.volume / (radius * radius * radius), polyhedron_volume(100, 60), 1e-14);
  }
}

TEST(Sphere, ThinTrianglesAtThePolesAreNotDegenerate) {
  for (const auto& [rings, quads] : {std::pair{1000, 2000}, {2, 5000}, {3000, 3}}) {
    const MeshReport report = check(sphere(rings, quads));
    EXPECT_EQ(report.degenerate_triangles, 0u);
    EXPECT_TRUE(report.closed);
  }
}

TEST(Sphere, BytesDoNotDependOnTheNumberOfThreads) {
  const auto hashes = [](std::size_t threads) {
    DiagnosticLog log;
    TessellationOptions options;
    options.max_error = 3e-6;
    Result<Mesh> mesh = failed;
    run_on_threads(Job({threads, {}}), [&] {
      mesh = tessellated(Sphere{1, {}}, options, {}, log);
    });
    return std::tuple{hash64(std::as_bytes(std::span(mesh->positions))),
                      hash64(std::as_bytes(std::span(mesh->normals))),
                      hash64(std::as_bytes(std::span(mesh->triangles))), mesh->error};
  };
  const auto one = hashes(1);
  EXPECT_EQ(one, hashes(2));
  EXPECT_EQ(one, hashes(5));
}

TEST(MeshShape, ComesBackWithItsRoundingError) {
  Mesh mesh = shapes::cube();
  for (Vec3& p : mesh.positions) p *= 0.1;  // 0.1 is off by 1.49e-9 in float32
  DiagnosticLog log;
  const auto copy = tessellated(std::make_shared<const Mesh>(mesh), {}, {}, log);
  ASSERT_TRUE(copy.ok());
  EXPECT_EQ(copy->positions, mesh.positions);
  EXPECT_EQ(copy->triangles, mesh.triangles);
  const double miss = std::fabs(0.1 - static_cast<double>(0.1f));
  EXPECT_NEAR(copy->error, std::sqrt(3.0) * miss, 1e-22);
  // relative to a corner everything that is left are edges of 0.2
  EXPECT_NEAR(rounding_error(mesh.positions, mesh.positions[0]),
              std::sqrt(3.0) * std::fabs(0.2 - static_cast<double>(0.2f)), 1e-22);
}

TEST(MeshShape, CoordinatesBeyondSinglePrecisionAreRefused) {
  for (const double x : {1e31, -1e300, HUGE_VAL, std::nan("")}) {
    Mesh mesh = shapes::cube();
    mesh.positions[3].y = x;
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(std::make_shared<const Mesh>(mesh), {}, {}, log).ok());
    EXPECT_TRUE(log.contains(Code("E2010")));
  }
}

TEST(MeshShape, ObeysTheLimit) {
  DiagnosticLog log;
  TessellationOptions options;
  options.max_triangles = 11;
  EXPECT_FALSE(tessellated(std::make_shared<const Mesh>(shapes::cube()), options, {}, log).ok());
  EXPECT_TRUE(log.contains(Code("E2003")));
}

// Against the projection onto the plane where that lies inside, and onto sides otherwise.
TEST(Triangle, NearestPointMatchesASearch) {
  shapes::Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 shift = random.direction() * random.between(0, 2);
    const Vec3 a = random.direction() + shift;
    const Vec3 b = random.direction() + shift;
    const Vec3 c = random.direction() + shift;
    const double distance = glm::length(nearest_to_origin(a, b, c));
    double sampled = 1e9;
    const int steps = 200;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j)
        sampled = std::min(sampled, glm::length(a + (b - a) * (double(i) / steps) +
                                                (c - a) * (double(j) / steps)));
    EXPECT_LE(distance, sampled + 1e-14);
    EXPECT_GE(distance, sampled - 0.02);  // covering radius of the samples: edge ≤ 2, 2/200·√2
  }
}

}  // namespace
}  // namespace panwright::geometry::sphere_test
