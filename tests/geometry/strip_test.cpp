#include "geometry/mesh/strip.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace panwright::geometry::strip_test {
namespace {

TEST(Strip, WindingAlternates) {
  const std::uint32_t strip[] = {7, 8, 9, 10, 11};
  std::vector<Triangle> triangles;
  EXPECT_EQ(append_strip(strip, triangles), 0u);
  const std::vector<Triangle> expected{{7, 8, 9}, {9, 8, 10}, {9, 10, 11}};
  EXPECT_EQ(triangles, expected);
}

// The rule of the paper: the first triangle is counter-clockwise from outside, so that all of a
// flat strip are.
TEST(Strip, AllTrianglesOfAFlatStripFaceTheSameWay) {
  Mesh mesh;
  std::vector<std::uint32_t> strip;
  for (std::uint32_t i = 0; i < 20; ++i) {
    mesh.positions.push_back({0.5 * i, i % 2 == 0 ? 1.0 : 0.0, 0});
    strip.push_back(i);
  }
  append_strip(strip, mesh.triangles);
  ASSERT_EQ(mesh.triangles.size(), 18u);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 n = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                              mesh.positions[t[2]] - mesh.positions[t[0]]);
    EXPECT_GT(n.z, 0);
  }
  EXPECT_EQ(check(mesh).misoriented_edges, 0u);
}

TEST(Strip, RepeatedIndicesKeepTheAlternation) {
  // two quads joined by repeated indices: 0123 3 4 4567
  const std::uint32_t strip[] = {0, 1, 2, 3, 3, 4, 4, 5, 6, 7};
  std::vector<Triangle> triangles;
  EXPECT_EQ(append_strip(strip, triangles), 4u);
  const std::vector<Triangle> expected{{0, 1, 2}, {2, 1, 3}, {4, 5, 6}, {6, 5, 7}};
  EXPECT_EQ(triangles, expected);
}

TEST(Strip, ShortStripsHaveNoTriangles) {
  std::vector<Triangle> triangles;
  EXPECT_EQ(append_strip({}, triangles), 0u);
  const std::uint32_t two[] = {0, 1};
  EXPECT_EQ(append_strip(two, triangles), 0u);
  EXPECT_TRUE(triangles.empty());
}

// A tetrahedron is one strip of four triangles.
TEST(Strip, ATetrahedronFromOneStripIsClosedAndOutward) {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {1, -1, -1}, {-1, 1, -1}};
  const std::uint32_t strip[] = {0, 1, 2, 3, 0, 1};
  append_strip(strip, mesh.triangles);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume, 8.0 / 3, 1e-14);  // a third of the cube of side 2
}

}  // namespace
}  // namespace panwright::geometry::strip_test
