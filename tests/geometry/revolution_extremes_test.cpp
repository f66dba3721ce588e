// Surfaces of revolution far from round: slivers, needles, pancakes, horns, deep and flat dishes.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/support/shape_distance.h"

namespace panwright::geometry::revolution_extremes_test {
namespace {

using oracles::sampled_distance;

Mesh made(const Shape& shape, double max_error) {
  TessellationOptions options;
  options.max_error = max_error;
  DiagnosticLog log;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok()) << (log.entries().empty() ? "" : log.entries().front().message);
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

template <class S>
void expect_kept(const S& shape, double max_error, double least_share) {
  SCOPED_TRACE(std::string(kind_name(shape)) + " " + std::to_string(max_error));
  const Mesh mesh = made(shape, max_error);
  EXPECT_LE(mesh.error, max_error);
  if (mesh.triangles.size() > 100000) return;
  const int steps = mesh.triangles.size() < 1000 ? 12 : mesh.triangles.size() < 5000 ? 4 : 2;
  const double sampled = sampled_distance(mesh, oracles::distance_to(shape), steps).worst;
  EXPECT_LE(sampled, mesh.error * (1 + 1e-9));
  EXPECT_GE(sampled, least_share * max_error);
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.closed, is_closed(shape));
  EXPECT_EQ(report.bad_normals, 0u);
  EXPECT_EQ(report.non_finite, 0u);
  if (report.closed) {
    EXPECT_GT(report.volume, 0);
  }
}

TEST(RoundExtremes, Ellipsoids) {
  // 0.81 the least measured where the radii are within 1000, but sharp ends get a vertex and are
  // finer than they need be: 0.42 of needles across the axis, 0.33 of pancakes
  for (const double e : {1e-1, 1e-2, 1e-3}) {
    expect_kept(Ellipsoid{{1, 1, 1000}}, e, 0.7);
    expect_kept(Ellipsoid{{1000, 1, 1}}, e, 0.4);
    expect_kept(Ellipsoid{{1000, 700, 1}}, e * 10, 0.3);
    expect_kept(Ellipsoid{{1, 1000, 700}}, e * 10, 0.3);
  }
  // a million to one: single precision leaves no less than a tenth of the small radius
  expect_kept(Ellipsoid{{1, 1, 1e6}}, 0.1, 0.3);
  expect_kept(Ellipsoid{{1e6, 1e6, 1}}, 0.1, 0.25);
  expect_kept(Ellipsoid{{1e6, 1, 1}}, 0.1, 0.25);
}

TEST(RoundExtremes, EllipsoidsHaveTheCountOfTheirClosedForm) {
  // the closed form of ellipsoid.cpp: 2·∮sqrt(h)du·∫sqrt(h)dv/(8e), by sums of its own
  const auto integral = [](double a, double b) {
    const int n = 2000000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double t = 0.5 * M_PI * (i + 0.5) / n;
      sum += std::pow(std::pow(std::cos(t) / a, 2) + std::pow(std::sin(t) / b, 2), -0.25);
    }
    return sum * 2 * M_PI / n;
  };
  for (const Vec3& radii : {Vec3(1, 1, 1), Vec3(3, 2, 1), Vec3(1, 1, 1000), Vec3(1000, 700, 1)}) {
    for (const double e : {1e-2, 1e-3}) {
      const double closed = 2 * integral(radii.x, radii.y) * 0.5 *
                            integral(std::max(radii.x, radii.y), radii.z) / (8 * e);
      TessellationOptions options;
      options.max_error = e;
      if (closed > 2e6) continue;
      // 1.00 … 1.20 measured, the most for the smallest
      EXPECT_LE(planned_triangles(Ellipsoid{radii}, options), 1.3 * closed + 20)
          << radii.x << " " << radii.z;
    }
  }
}

TEST(RoundExtremes, Tori) {
  for (const double e : {1e-2, 1e-3}) {
    expect_kept(Torus{1, 0.999999}, e, 0.5);
    expect_kept(Torus{1, 1 - 1e-12}, e, 0.5);
    expect_kept(Torus{1, 0.999}, e, 0.5);
  }
  // tubes thinner than the error, and finer; 0.6 measured at the radius itself
  for (const double e : {0.3, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) expect_kept(Torus{1, 1e-3}, e, 0.45);
}

TEST(RoundExtremes, Dishes) {
  for (const double e : {1e-1, 1e-2, 1e-3}) {
    // f/D from 1/1000 to 1000; the deepest is 62 m deep
    expect_kept(Dish{1, 1e-3}, e, 0.5);
    expect_kept(Dish{1, 0.01}, e, 0.5);
    expect_kept(Dish{1, 100}, e, 0.5);
    expect_kept(Dish{1, 1000, 1e-3}, e, 0.5);
    expect_kept(Dish{1, 0.25, 1e-6}, e, 0.5);
    expect_kept(Dish{1, 0.25, 10}, e, 0.5);
  }
}

TEST(RoundExtremes, Slivers) {
  // triangles are as thin as the shape: only what does not depend on it is asked
  for (const Shape& shape :
       {Shape(Cylinder{1e6, 1e-9}), Shape(Cylinder{1e-9, 1e6}), Shape(Cone{1e6, 0, 1e-9}),
        Shape(Cone{1e-9, 1e6, 1}), Shape(Cone{0, 1e-9, 1e6})}) {
    for (const double e : {1e7, 1e5, 1e3, 10.0}) {
      const Mesh mesh = made(shape, e);
      EXPECT_LE(mesh.error, e);
      const MeshReport report = check(mesh);
      EXPECT_EQ(report.non_finite, 0u);
      EXPECT_EQ(report.bad_normals, 0u);
      EXPECT_EQ(report.boundary_edges, 0u);
      EXPECT_TRUE(mesh.closed);
    }
  }
}

TEST(RoundExtremes, AnySizeGivesTheSameMesh) {
  // powers of two change no digit: relative to the size every number is the same
  for (const int power : {-90, -30, 30, 90}) {
    const double k = std::ldexp(1.0, power);
    for (const double e : {0.1, 1e-3, 1e-5}) {
      const auto same = [&](const Shape& one, const Shape& scaled) {
        const Mesh a = made(one, e), b = made(scaled, e * k);
        ASSERT_EQ(a.triangles, b.triangles) << kind_name(one) << " " << power;
        for (std::size_t i = 0; i < a.positions.size(); ++i)
          ASSERT_EQ(k * a.positions[i], b.positions[i]) << kind_name(one) << " " << power;
        EXPECT_EQ(k * a.error, b.error);
      };
      same(Cylinder{1, 2}, Cylinder{k, 2 * k});
      same(Torus{1, 0.3}, Torus{k, 0.3 * k});
      same(Dish{1, 0.3, 0.1}, Dish{k, 0.3 * k, 0.1 * k});
      same(Ellipsoid{{1, 0.3, 0.7}}, Ellipsoid{Vec3(1, 0.3, 0.7) * k});
      same(Sphere{1, {}, -1, 1, {}}, Sphere{k, {}, -1, 1, {}});
      Lathe lathe;
      lathe.profile = {{0, -1}, {1, -0.7}, {0.6, 0}, {0, 1.5}};
      lathe.spline = true;
      Lathe scaled = lathe;
      for (Vec2& p : scaled.profile) p *= k;
      // note: centripetal knots are square roots, exact for even powers
      same(lathe, scaled);
    }
  }
}

TEST(RoundExtremes, ToleranceBeyondTheShapeGivesTheFewest) {
  for (const double e : {3.0, 1e3, 1e12}) {
    EXPECT_EQ(made(Cylinder{1, 1}, e).triangles.size(), 8u);
    EXPECT_EQ(made(Cone{1, 0, 1}, e).triangles.size(), 4u);
    EXPECT_EQ(made(Disc{1}, e).triangles.size(), 1u);
    EXPECT_EQ(made(Torus{1, 0.3}, e).triangles.size(), 18u);
    EXPECT_EQ(made(Dish{1, 1}, e).triangles.size(), 3u);
    EXPECT_EQ(made(Ellipsoid{{1, 2, 3}}, e).triangles.size(), 6u);
  }
}

TEST(RoundExtremes, LongProfiles) {
  // a hundred thousand points; 2.9 s measured for both, most of it the spline
  Lathe lathe;
  for (int i = 0; i <= 100000; ++i)
    lathe.profile.push_back({1 + 0.2 * std::sin(i * 1e-3), i * 1e-4});
  lathe.counts.around = 12;
  EXPECT_EQ(made(lathe, 1e-2).triangles.size(), 2u * 12 * 100000);
  lathe.counts = {};
  lathe.spline = true;
  const Mesh mesh = made(lathe, 1e-2);
  EXPECT_LE(mesh.error, 1e-2);
  EXPECT_LT(mesh.triangles.size(), 20000u);
}

}  // namespace
}  // namespace panwright::geometry::revolution_extremes_test
