#include "geometry/mesh/convex_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace panwright::geometry::convex_hull_test {
namespace {

struct Measured {
  double volume = 0;
  bool closed = true;      // each edge is met once in each direction
  double beyond = -1e300;  // of the farthest point beyond a plane
};

Measured measured(const std::vector<Vec3>& points, const std::vector<Triangle>& hull) {
  Measured out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : hull) {
    const Vec3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    out.volume += glm::dot(a, glm::cross(b, c)) / 6;
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    for (const Vec3& p : points) out.beyond = std::max(out.beyond, glm::dot(normal, p - a));
  }
  for (const auto& [edge, count] : edges)
    out.closed = out.closed && count == 1 && edges.contains({edge.second, edge.first});
  return out;
}

TEST(ConvexHull, OfACubeWithPointsInItAndOnIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 5 * 5 * 5; ++i)
    points.emplace_back(i % 5 / 2.0, i / 5 % 5 / 2.0, i / 25 / 2.0);
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  const Measured got = measured(points, *hull);
  EXPECT_TRUE(got.closed);
  EXPECT_NEAR(got.volume, 8, 1e-12);
  EXPECT_LE(got.beyond, 1e-12);
}

// On a sphere every point is a corner, and by Euler there are 2 V - 4 triangles.
TEST(ConvexHull, OfPointsOnASphere) {
  std::mt19937 random(7);
  std::vector<Vec3> points;
  while (points.size() < 3000) {
    const auto number = [&] { return static_cast<double>(random()) / 0x80000000u - 1; };
    const Vec3 p(number(), number(), number());
    if (glm::length(p) < 1 && glm::length(p) > 0.1)
      points.push_back(glm::normalize(p) * 1e3 + Vec3(1e5, 0, 0));
  }
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->size(), 2 * points.size() - 4);
  const Measured got = measured(points, *hull);
  EXPECT_TRUE(got.closed);
  EXPECT_LE(got.beyond, 1e-6);                               // of 1e3: measured 6e-9
  EXPECT_NEAR(got.volume / (4.0 / 3 * kPi * 1e9), 1, 5e-3);  // inscribed: measured 0.9967
}

TEST(ConvexHull, OfWhatHasNoBody) {
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{}));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>(9, Vec3(1, 2, 3))));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}));
  std::vector<Vec3> flat;
  for (int i = 0; i < 100; ++i) flat.emplace_back(i % 10, i / 10, i % 10 + i / 10);
  EXPECT_FALSE(convex_hull(flat));
}

// Many equal and coplanar points, of any size, make a closed body that holds them all.
TEST(ConvexHull, OfGridsAndRepeatedPoints) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const double scale = std::pow(10, trial % 13 - 6);
    std::vector<Vec3> points;
    for (int i = 0; i < 4 + trial; ++i)
      points.push_back(scale * Vec3(random() % 4, random() % 4, random() % 4) / 3.0);
    const auto hull = convex_hull(points);
    if (!hull) continue;
    const Measured got = measured(points, *hull);
    EXPECT_TRUE(got.closed) << trial;
    EXPECT_GT(got.volume, 0) << trial;
    EXPECT_LE(got.beyond, 1e-9 * scale) << trial;
  }
}

}  // namespace
}  // namespace panwright::geometry::convex_hull_test
