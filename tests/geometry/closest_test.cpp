#include "geometry/mesh/closest.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::closest_test {
namespace {

TEST(Closest, FacesEdgesAndCornersOfACube) {
  const Mesh cube = shapes::cube();
  const auto at = [&](const Vec3& p) { return *closest_point(cube, p); };
  EXPECT_EQ(at({0.25, 0.5, 3}).position, Vec3(0.25, 0.5, 1));
  EXPECT_EQ(at({0.25, 0.5, 3}).normal, Vec3(0, 0, 1));
  EXPECT_EQ(at({0.25, 0.5, 3}).distance, 2);
  EXPECT_EQ(at({4, 0.5, 5}).position, Vec3(1, 0.5, 1));
  EXPECT_EQ(at({4, 0.5, 5}).distance, 5);
  EXPECT_EQ(at({3, 2, 3}).position, Vec3(1, 1, 1));
  EXPECT_EQ(at({3, 2, 3}).distance, 3);
  // from inside
  EXPECT_EQ(at({0.5, 0, 0.25}).position, Vec3(1, 0, 0.25));
  // on the surface
  EXPECT_EQ(at({1, 0.5, 0.25}).distance, 0);
  // of equals the first triangle, here that of z = −1
  EXPECT_EQ(at({0, 0, 0}).position, Vec3(0, 0, -1));
}

TEST(Closest, BoxesByTheirFormula) {
  const Mesh cube = shapes::cube();
  shapes::Random random(6);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p(random.between(-3, 3), random.between(-3, 3), random.between(-3, 3));
    const Vec3 q = glm::abs(p) - 1.0;
    const double expected =
        std::fabs(glm::length(glm::max(q, Vec3(0))) + std::min(0.0, std::max({q.x, q.y, q.z})));
    const auto found = closest_point(cube, p);
    EXPECT_NEAR(found->distance, expected, 1e-15);  // 4e-16 measured
    EXPECT_NEAR(glm::length(found->position - p), expected, 2e-15);
  }
}

TEST(Closest, NormalsAreInterpolated) {
  const Mesh ball = shapes::sphere(60, 90);
  shapes::Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 direction = random.direction();
    const auto found = closest_point(ball, 3.0 * direction);
    EXPECT_NEAR(found->distance, 2, 3e-3);
    EXPECT_NEAR(glm::length(found->normal), 1, 1e-15);
    // the facet's would be off by up to 0.03
    EXPECT_LT(glm::length(found->normal - glm::normalize(found->position)), 1.5e-3);
  }
}

TEST(Closest, NothingOnAnEmptyMesh) {
  EXPECT_FALSE(closest_point(Mesh{}, Vec3(0)));
  Mesh mesh = shapes::cube();
  EXPECT_FALSE(closest_point(mesh, Vec3(NAN, 0, 0)));
  // a triangle that is not finite does not count
  mesh.positions[0].x = NAN;
  const auto found = closest_point(mesh, {2, 0.9, 0.9});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->position, Vec3(1, 0.9, 0.9));
  // nor do normals that cancel
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.normals = {{1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_EQ(closest_point(flat, {0.5, 0, 1})->normal, Vec3(0, 0, 1));
}

TEST(Closest, TrianglesWithoutAreaHavePlaces) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 1, 1}};
  const auto found = closest_point(mesh, {1.5, 1, 0});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, 1, 1e-15);
  EXPECT_TRUE(is_finite(found->normal));
}

}  // namespace
}  // namespace panwright::geometry::closest_test
