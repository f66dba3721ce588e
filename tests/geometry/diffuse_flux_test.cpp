// Diffuse light of meshes that stand for others.
#include "geometry/mesh/diffuse_flux.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::diffuse_flux_test {
namespace {

Mesh ball(double radius, double error) {
  Sphere sphere;
  sphere.radius = radius;
  DiagnosticLog log;
  return *tessellated(sphere, {.max_error = error}, {}, log);
}

TEST(DiffuseFlux, GoesWithTheArea) {
  const Mesh one = ball(1, 1e-3);
  EXPECT_EQ(diffuse_flux_error(one, one), 0);
  for (const double size : {0.9, 1.01, 1.5}) {
    Mesh other = one;
    for (Vec3& p : other.positions) p *= size;
    EXPECT_NEAR(diffuse_flux_error(one, other), std::fabs(size * size - 1), 1e-9);
  }
}

// A facet turned about x: what it sends is Σ max(0, n·l)·max(0, n·v) of known normals.
TEST(DiffuseFlux, SeesTurnedNormals) {
  const Mesh one = ball(1, 1e-3);
  Mesh other = one;
  const double turn = 0.2;
  for (Vec3& n : other.normals)
    n = Vec3(n.x, std::cos(turn) * n.y - std::sin(turn) * n.z,
             std::sin(turn) * n.y + std::cos(turn) * n.z);
  // as if the Sun had moved by 0.2 rad: at 60° of phase the flux of a sphere has the slope
  // −(π − a)·sin a / (sin a + (π − a)·cos a) = −0.95 a radian, at 120° −4.9
  const double error = diffuse_flux_error(one, other);
  EXPECT_GT(error, 0.2 * 0.95);
  EXPECT_LT(error, 0.2 * 4.9 * 1.5);
}

TEST(DiffuseFlux, OpenSheetsAreSeenFromBothSides) {
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh turned = sheet;
  turned.triangles = {{0, 2, 1}, {0, 3, 2}};
  EXPECT_NEAR(diffuse_flux_error(sheet, turned), 0, 1e-12);
  turned.triangles.pop_back();
  EXPECT_NEAR(diffuse_flux_error(sheet, turned), 0.5, 1e-12);
  EXPECT_EQ(diffuse_flux_error({}, sheet), 0);
  EXPECT_NEAR(diffuse_flux_error(sheet, {}), 1, 1e-12);
}

}  // namespace
}  // namespace panwright::geometry::diffuse_flux_test
