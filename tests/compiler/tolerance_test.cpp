// Tolerances: what each term gives, and whether a mesh made to it keeps what it was made for.
#include "compiler/tolerance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "geometry/tessellate/tessellate.h"
#include "tests/compiler/facet_sums.h"

namespace panwright::compiler::tolerance_test {
namespace {

using pan::layout::ToleranceReason;
using support::Seen;
using support::seen_by;

geometry::Sphere ball(double radius) {
  geometry::Sphere sphere;
  sphere.radius = radius;
  return sphere;
}

// ---- which term decides

Tolerance of(const scene::Budget& budget, const geometry::Shape& shape = ball(2),
             const Stretch& stretch = {1, 1}, const ToleranceOverrides& asked = {}) {
  return tolerance_for(budget, shape, stretch, asked);
}

scene::Budget camera() {
  scene::Budget budget;
  budget.nearest = 50;
  budget.ifov = 2e-4;  // a pixel is 1 cm
  return budget;
}

TEST(Budget, WithoutTermsTheDefault) {
  EXPECT_EQ(of({}).metres, 1e-3);
  EXPECT_EQ(of({}).reason, ToleranceReason::tolerance);
  EXPECT_EQ(of(camera()).metres, 1e-3) << "a camera alone asks for nothing";
}

TEST(Budget, EachTerm) {
  scene::Budget budget;
  budget.tolerance = 0.02;
  EXPECT_EQ(of(budget).metres, 0.02);
  budget = camera();
  budget.pixels = 0.5;
  EXPECT_DOUBLE_EQ(of(budget).metres, 0.005);
  EXPECT_EQ(of(budget).reason, ToleranceReason::pixels);
  budget = camera();
  budget.centroid = 0.5;
  EXPECT_DOUBLE_EQ(of(budget).metres, 0.005 / kCentroidFactor);
  EXPECT_EQ(of(budget).reason, ToleranceReason::centroid);
  budget = {};
  budget.flux = 1e-2;
  EXPECT_DOUBLE_EQ(of(budget).metres, 2e-2 / kFluxFactor);
  EXPECT_EQ(of(budget).reason, ToleranceReason::flux);
  EXPECT_EQ(of(budget, geometry::Plane{}).metres, 1e-3) << "a flat face has no flux to lose";
}

TEST(Budget, TheSmallestTermWins) {
  scene::Budget budget = camera();
  budget.tolerance = 4e-3;
  budget.pixels = 1;     // 1 cm
  budget.centroid = 1;   // 5.88 mm
  budget.flux = 1.2e-2;  // 4.4 mm of a sphere of 2 m
  EXPECT_EQ(of(budget).reason, ToleranceReason::tolerance);
  budget.tolerance = 5e-3;
  EXPECT_EQ(of(budget).reason, ToleranceReason::flux);
  budget.flux = 1;
  EXPECT_EQ(of(budget).reason, ToleranceReason::tolerance);
  budget.tolerance.reset();
  EXPECT_EQ(of(budget).reason, ToleranceReason::centroid);
  budget.centroid = 2;
  EXPECT_EQ(of(budget).reason, ToleranceReason::pixels);
}

TEST(Budget, TermsWithoutTheirPartnersGiveNone) {
  scene::Budget budget;
  budget.pixels = 1e-9;
  budget.centroid = 1e-9;
  budget.nearest = 3;
  EXPECT_EQ(of(budget).metres, 1e-3);
  budget.ifov = 1;
  EXPECT_LT(of(budget).metres, 1e-8);
}

TEST(Budget, InstanceAndCommandLineOverride) {
  scene::Budget budget;
  budget.tolerance = 1e-6;
  EXPECT_EQ(of(budget, geometry::Sphere{}, {}, {0.25, {}}).metres, 0.25);
  EXPECT_EQ(of(budget, geometry::Sphere{}, {}, {0.25, {}}).reason, ToleranceReason::shape);
  EXPECT_EQ(of(budget, geometry::Sphere{}, {}, {0.25, 0.5}).metres, 0.5);
  EXPECT_EQ(of(budget, geometry::Sphere{}, {}, {{}, 0.5}).reason, ToleranceReason::command_line);
}

TEST(Budget, CountsAreTheirOwnReason) {
  EXPECT_EQ(of({}, geometry::Sphere{1, {{20, 30}}}).reason, ToleranceReason::explicit_counts);
  geometry::Cylinder cylinder;
  EXPECT_EQ(of({}, cylinder).reason, ToleranceReason::tolerance);
  cylinder.counts.around = 12;
  EXPECT_EQ(of({}, cylinder).reason, ToleranceReason::explicit_counts);
  EXPECT_EQ(of({}, geometry::MeshShape(std::make_shared<geometry::Mesh>())).reason,
            ToleranceReason::explicit_counts);
  EXPECT_EQ(of({}, geometry::Box{}).reason, ToleranceReason::tolerance);
}

TEST(Budget, AStretchedSphereIsAnEllipsoid) {
  scene::Budget budget;
  budget.flux = 1e-2;
  // radii 8, 2 and 2 m: the tips have the radius of curvature 2²/8
  EXPECT_DOUBLE_EQ(of(budget, ball(2), {1, 4}).metres, 1e-2 * 0.5 / kFluxFactor);
  EXPECT_DOUBLE_EQ(of(budget, geometry::Ellipsoid{{2, 8, 2}}).metres, 1e-2 * 0.5 / kFluxFactor);
}

TEST(Budget, SmallRoundShapesAreFinerByDefault) {
  const double share = kDefaultFlux / kFluxFactor;
  EXPECT_DOUBLE_EQ(of({}, geometry::Cylinder{.radius = 2e-3, .height = 9}).metres, share * 2e-3);
  EXPECT_EQ(of({}, geometry::Cylinder{.radius = 2e-3}).reason, ToleranceReason::flux);
  EXPECT_DOUBLE_EQ(of({}, ball(5e-3)).metres, share * 5e-3);
  EXPECT_EQ(of({}, ball(0.2)).metres, 1e-3);
  EXPECT_EQ(of({}, geometry::Box{.size = Vec3(1e-3)}).metres, 1e-3) << "flat faces";
  EXPECT_DOUBLE_EQ(of({}, ball(1), {0.01, 0.01}).metres, share * 0.01);
  // lenses: a 30th of the largest radius
  EXPECT_DOUBLE_EQ(of({}, geometry::Ellipsoid{{1, 1, 0.05}}).metres, share * 0.05);
  EXPECT_DOUBLE_EQ(of({}, geometry::Ellipsoid{{1, 1, 1e-6}}).metres, share / 30);
  EXPECT_DOUBLE_EQ(of({}, ball(1), {1e-6, 1}).metres, share / 30);
  // an explicit tolerance is obeyed
  scene::Budget budget;
  budget.tolerance = 1e-3;
  EXPECT_EQ(of(budget, ball(5e-3)).metres, 1e-3);
}

TEST(Budget, CurvatureOfEachShape) {
  using namespace geometry;
  EXPECT_EQ(radius_of_curvature(Cylinder{.radius = 3, .height = 9}), 3);
  EXPECT_EQ(radius_of_curvature(Cone{.bottom_radius = 2, .top_radius = 1}), 0.75);
  EXPECT_EQ(radius_of_curvature(Torus{.radius = 2, .tube_radius = 0.25}), 0.25);
  EXPECT_EQ(radius_of_curvature(Dish{.diameter = 2, .focal_length = 0.4}), 0.8);
  EXPECT_EQ(radius_of_curvature(Dish{.diameter = 2, .focal_length = 40}), 1);
  EXPECT_EQ(radius_of_curvature(Disc{.radius = 2, .inner_radius = 1.5}), 0.5);
  EXPECT_EQ(radius_of_curvature(Tube{.path = {{0, 0, 0}, {1, 0, 0}}, .radius = 0.02}), 0.02);
  EXPECT_EQ(radius_of_curvature(Box{}), std::nullopt);
  EXPECT_EQ(radius_of_curvature(Box{.size = {1, 2, 3}, .bevel = 0.1, .round = true}), 0.5);
  EXPECT_EQ(radius_of_curvature(Polygons{}), std::nullopt);
  EXPECT_EQ(radius_of_curvature(Extrude{}), std::nullopt);
  // the wall of a cone, once as a profile
  EXPECT_EQ(radius_of_curvature(Lathe{.profile = {{2, 0}, {1, 1}}}), 0.75);
  // half a circle in 64 chords: it turns by π − π/64 over a length of 64·2·sin(π/128)
  Lathe half_circle{.profile = {}, .spline = true};
  for (int i = 0; i <= 64; ++i)
    half_circle.profile.emplace_back(det::sin(kPi * i / 64), -det::cos(kPi * i / 64));
  const double around = 64 * 2 * det::sin(kPi / 128) / (kPi - kPi / 64);
  EXPECT_GT(around, 1);  // so that half of the mean radius, 1/π, is the smaller
  EXPECT_NEAR(*radius_of_curvature(half_circle), 1 / kPi, 1e-4);
  EXPECT_EQ(radius_of_curvature(Lathe{.profile = {{0, 0}, {0, 1}}}), std::nullopt);
}

// ---- the constants: facet sums against closed forms

struct Worst {
  double flux = 0;      // |error of the flux|·R/error of the mesh
  double centroid = 0;  // error of the photocentre/error of the mesh
};

class Directions {
 public:
  Vec3 next() {
    for (;;) {
      const Vec3 d(uniform(), uniform(), uniform());
      const double squared = glm::dot(d, d);
      if (squared > 0.01 && squared < 1) return d / std::sqrt(squared);
    }
  }
  Vec3 across(const Vec3& v) { return glm::normalize(glm::cross(v, next())); }
  double uniform() { return static_cast<double>(random_()) / 2147483648.0 - 1; }

 private:
  std::mt19937 random_{5};
};

geometry::Mesh made(const geometry::Shape& shape, double error, std::uint32_t edge_segments = 0) {
  geometry::TessellationOptions options;
  options.max_error = error;
  options.edge_segments = edge_segments;
  DiagnosticLog log;
  auto mesh = geometry::tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh) << to_text(log);
  return *std::move(mesh);
}

// Lambert sphere of radius 1: F = 2/3·(sin a + (π − a)·cos a), and the photocentre lies
// π/8·sin a·(1 + cos a)/F from the centre, towards the Sun in the image.
Worst sphere_worst(double error, int directions, int side) {
  Directions random;
  const geometry::Mesh mesh = made(ball(1), error);
  Worst worst;
  for (const double phase : {0.0, 30.0, 60.0, 90.0, 105.0, 120.0}) {
    const double a = phase * kDegree;
    const double flux = 2.0 / 3 * (std::sin(a) + (kPi - a) * std::cos(a));
    const double offset = kPi / 8 * std::sin(a) * (1 + std::cos(a)) / flux;
    for (int i = 0; i < directions; ++i) {
      const Vec3 v = random.next(), p = random.across(v);
      const Seen seen = seen_by(mesh, std::cos(a) * v + std::sin(a) * p, v, side);
      worst.flux = std::max(worst.flux, std::fabs(seen.flux / flux - 1) / mesh.error);
      const Vec3 miss = seen.photocentre() - offset * p;
      worst.centroid =
          std::max(worst.centroid, glm::length(miss - v * glm::dot(miss, v)) / mesh.error);
    }
  }
  return worst;
}

// The wall of a cylinder of radius 1 and height h seen across: F = h/2·(sin a + (π − a)·cos a), the
// photocentre h/6·(2·sin a + sin 2a)/F from the axis.
Worst cylinder_worst(double error, std::uint32_t edge_segments, int directions, int side) {
  Directions random;
  geometry::Cylinder shape;
  shape.caps = geometry::Caps::none;
  shape.height = 2;
  const geometry::Mesh mesh = made(shape, error, edge_segments);
  Worst worst;
  for (const double phase : {0.0, 30.0, 60.0, 90.0, 105.0, 120.0}) {
    const double a = phase * kDegree;
    const double flux = std::sin(a) + (kPi - a) * std::cos(a);
    const double offset = (2 * std::sin(a) + std::sin(2 * a)) / 3 / flux;
    for (int i = 0; i < directions; ++i) {
      const double turn = kPi * random.uniform();
      const Vec3 v(std::cos(turn), std::sin(turn), 0), p(-v.y, v.x, 0);
      const Seen seen = seen_by(mesh, std::cos(a) * v + std::sin(a) * p, v, side);
      worst.flux = std::max(worst.flux, std::fabs(seen.flux / flux - 1) / mesh.error);
      worst.centroid = std::max(worst.centroid,
                                std::fabs(glm::dot(seen.photocentre(), p) - offset) / mesh.error);
    }
  }
  return worst;
}

// A rod of 2 mm was 18 % off, one of 5 mm 10 %.
TEST(NeedConstants, DefaultFluxOfSmallRoundShapes) {
  const double error = of({}, ball(2e-3)).metres / 2e-3;
  const double sphere = error * sphere_worst(error, 30, 8).flux;
  const double rod = error * cylinder_worst(error, 0, 200, 8).flux;
  EXPECT_LE(std::max(sphere, rod), kDefaultFlux) << sphere << ' ' << rod;
  EXPECT_GE(std::max(sphere, rod), 0.5 * kDefaultFlux) << "finer than needed";
}

TEST(NeedConstants, AreTheWorstMeasured) {
  Worst all;
  for (const double error : {3e-2, 1e-2, 1e-3}) {
    const bool fine = error < 5e-3;
    const auto on_shape = static_cast<std::uint32_t>(std::ceil(kPi / std::acos(1 - error)));
    for (const Worst& worst :
         {sphere_worst(error, fine ? 10 : 100, fine ? 4 : 12), cylinder_worst(error, 0, 200, 8),
          cylinder_worst(error, on_shape, 200, 8)}) {
      EXPECT_LT(worst.flux, kFluxFactor);
      EXPECT_LT(worst.centroid, kCentroidFactor);
      all.flux = std::max(all.flux, worst.flux);
      all.centroid = std::max(all.centroid, worst.centroid);
    }
  }
  // measured: 5.28 (a cylinder of error 0.03 R), 1.60 (a sphere of error 0.03 R)
  EXPECT_GT(all.flux, 0.9 * kFluxFactor);
  EXPECT_GT(all.centroid, 0.8 * kCentroidFactor);
}

// An ellipsoid by quadrature over the sphere it is an image of: n·dA = (s/radii)·abc·dω.
double ellipsoid_flux(const Vec3& radii, const Vec3& l, const Vec3& v) {
  constexpr int kRows = 400, kColumns = 800;
  double sum = 0;
  for (int i = 0; i < kRows; ++i) {
    const double z = -1 + (2 * i + 1.0) / kRows, r = std::sqrt(1 - z * z);
    for (int j = 0; j < kColumns; ++j) {
      const double u = 2 * kPi * (j + 0.5) / kColumns;
      const Vec3 area = Vec3(r * std::cos(u), r * std::sin(u), z) / radii;
      sum += std::fmax(0.0, glm::dot(glm::normalize(area), l)) * std::fmax(0.0, glm::dot(area, v));
    }
  }
  return sum * radii.x * radii.y * radii.z * 4 * kPi / (kRows * kColumns);
}

TEST(NeedConstants, HoldForEllipsoids) {
  for (const Vec3& radii : {Vec3(1, 0.5, 0.5), Vec3(1, 1, 0.4), Vec3(0.3, 0.6, 1)}) {
    Directions random;
    const geometry::Shape shape = geometry::Ellipsoid{radii, {}};
    const double curvature = *radius_of_curvature(shape);
    const geometry::Mesh mesh = made(shape, 1e-2 * curvature);
    double worst = 0;
    for (const double phase : {0.0, 60.0, 90.0, 120.0}) {
      for (int i = 0; i < 10; ++i) {
        const Vec3 v = random.next(), p = random.across(v);
        const Vec3 l = std::cos(phase * kDegree) * v + std::sin(phase * kDegree) * p;
        const double flux = ellipsoid_flux(radii, l, v);
        worst = std::max(worst, std::fabs(seen_by(mesh, l, v, 4).flux / flux - 1));
      }
    }
    EXPECT_LT(worst * curvature / mesh.error, kFluxFactor);  // measured 1.7 to 3.7
  }
}

TEST(NeedConstants, HoldForCones) {
  for (const double top : {0.0, 0.25, 0.9}) {
    Directions random;
    geometry::Cone cone;
    cone.bottom_radius = 1;
    cone.top_radius = top;
    cone.height = 1.5;
    const double curvature = *radius_of_curvature(cone);
    const geometry::Mesh mesh = made(cone, 1e-2), fine = made(cone, 1e-5);
    double worst = 0;
    for (const double phase : {0.0, 60.0, 90.0, 120.0}) {
      for (int i = 0; i < 60; ++i) {
        const Vec3 v = random.next(), p = random.across(v);
        const Vec3 l = std::cos(phase * kDegree) * v + std::sin(phase * kDegree) * p;
        // a sphere keeps 0.109 of its flux at 120 degrees; here a sliver of the wall may be left
        const double flux = seen_by(fine, l, v, 4).flux;
        if (flux < 0.109 * seen_by(fine, v, v, 2).flux) continue;
        worst = std::max(worst, std::fabs(seen_by(mesh, l, v, 8).flux / flux - 1));
      }
    }
    // measured 0.9, 4.0 and 1.5
    EXPECT_LT(worst * curvature / mesh.error, kFluxFactor) << top;
  }
}

}  // namespace
}  // namespace panwright::compiler::tolerance_test
