#include "geometry/tessellate/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/random.h"

namespace panwright::geometry::polygon_test {
namespace {

using Outline = std::vector<Vec3>;

// Numbers in (0, 1), one after another.
class Random {
 public:
  explicit Random(std::uint32_t seed) : seed_(seed) {}
  double uniform() { return in_unit(philox({count_++, 0, 0, 0}, {seed_, 0})[0]); }

 private:
  std::uint32_t seed_;
  std::uint32_t count_ = 0;
};

std::vector<Triangle> cut(const Outline& outline) {
  std::vector<Triangle> triangles;
  PolygonCutter().cut(outline, triangles);
  return triangles;
}

Vec3 area_of(const Vec3& a, const Vec3& b, const Vec3& c) { return glm::cross(b - a, c - a) / 2.0; }

// The area vector by the shoelace formula over each plane of two axes.
Vec3 area_of(const Outline& outline) {
  Vec3 sum(0);
  for (std::size_t i = 0; i < outline.size(); ++i)
    sum += glm::cross(outline[i], outline[(i + 1) % outline.size()]);
  return sum / 2.0;
}

struct Sums {
  Vec3 area{0};
  double size = 0;  // of all triangles
  double smallest = 1e300;
};

Sums sums_of(const Outline& outline, const std::vector<Triangle>& triangles) {
  Sums sums;
  for (const Triangle& t : triangles) {
    const Vec3 area = area_of(outline[t[0]], outline[t[1]], outline[t[2]]);
    sums.area += area;
    sums.size += glm::length(area);
    sums.smallest = std::min(sums.smallest, glm::length(area));
  }
  return sums;
}

// What holds for every polygon: n − 2 triangles over all corners; each edge of the outline is run
// once as it runs, each other edge once each way.
void expect_whole(const Outline& outline, const std::vector<Triangle>& triangles) {
  const std::size_t n = outline.size();
  ASSERT_EQ(triangles.size(), n - 2);
  std::vector<std::vector<int>> runs(n, std::vector<int>(n, 0));
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT(t[k], n);
      ++runs[t[k]][t[(k + 1) % 3]];
    }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const int outline_runs = int(j == (i + 1) % n) - int(i == (j + 1) % n);
      EXPECT_EQ(runs[i][j] - runs[j][i], outline_runs) << i << " " << j;
    }
}

// note: an outline that turns back nowhere is covered once exactly when no area is lost or doubled.
// Sums of n terms: 2e-15 was seen for 1000 corners.
void expect_covered_once(const Outline& outline) {
  const std::vector<Triangle> triangles = cut(outline);
  expect_whole(outline, triangles);
  const Sums sums = sums_of(outline, triangles);
  const double area = glm::length(sums.area);
  EXPECT_NEAR(sums.size, area, 1e-13 * area);
  EXPECT_GT(sums.smallest, 0);
}

Outline regular(int n, const Vec3& right, const Vec3& up, const Vec3& centre) {
  Outline outline;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    outline.push_back(centre + right * std::cos(a) + up * std::sin(a));
  }
  return outline;
}

// A star-shaped outline with random radii.
Outline random_star(int n, std::uint32_t seed, const Vec3& right, const Vec3& up) {
  Random random(seed);
  Outline outline;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    const double r = 0.05 + random.uniform();
    outline.push_back(r * (right * std::cos(a) + up * std::sin(a)));
  }
  return outline;
}

// Two interleaved spirals joined at both ends: deep, narrow, every diagonal is short.
Outline spiral(int n) {
  Outline outline;
  for (int i = 0; i < n; ++i) {
    const double a = 0.2 * i;
    outline.push_back(Vec3(std::cos(a), std::sin(a), 0) * (1 + 0.1 * a));
  }
  for (int i = n; i-- > 0;) {
    const double a = 0.2 * i;
    outline.push_back(Vec3(std::cos(a), std::sin(a), 0) * (1.3 + 0.1 * a));
  }
  std::reverse(outline.begin(), outline.end());
  return outline;
}

TEST(Polygon, FewerThanThreeCornersGiveNothing) {
  EXPECT_TRUE(cut({}).empty());
  EXPECT_TRUE(cut({Vec3(0)}).empty());
  EXPECT_TRUE(cut({Vec3(0), Vec3(1)}).empty());
}

TEST(Polygon, AppendsBehindWhatIsThere) {
  std::vector<Triangle> triangles{{7, 8, 9}};
  PolygonCutter cutter;
  cutter.cut(regular(5, Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0)), triangles);
  cutter.cut(regular(3, Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0)), triangles);
  ASSERT_EQ(triangles.size(), 5u);
  EXPECT_EQ(triangles[0], (Triangle{7, 8, 9}));
  EXPECT_EQ(triangles[4], (Triangle{0, 1, 2}));
}

TEST(Polygon, ConcaveQuadrilateralsAreCutInsideWhereverTheNotchIs) {
  const Outline dart{{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}};
  for (int start = 0; start < 4; ++start) {
    Outline outline;
    for (int i = 0; i < 4; ++i) outline.push_back(dart[(start + i) % 4]);
    expect_covered_once(outline);
  }
}

TEST(Polygon, QuadrilateralsWithACornerOnASideHaveNoFlatTriangle) {
  const Outline outline{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
  for (int start = 0; start < 4; ++start) {
    Outline turned;
    for (int i = 0; i < 4; ++i) turned.push_back(outline[(start + i) % 4]);
    expect_covered_once(turned);
  }
}

TEST(Polygon, EvenQuadrilateralsAreCutFromTheFirstCorner) {
  EXPECT_FALSE(cuts_better_from_second({0, 0, 0}, {0.1, 0, 0}, {0.1, 0.3, 0}, {0, 0.3, 0}));
  EXPECT_FALSE(cuts_better_from_second({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}));
  // the short diagonal of a kite
  EXPECT_TRUE(cuts_better_from_second({-3, 0, 0}, {0, -1, 0}, {3, 0, 0}, {0, 1, 0}));
}

TEST(Polygon, ConvexOnesAreFansInAnyPlane) {
  for (const Vec3& up : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    const Outline outline = regular(9, Vec3(1, 0, 0), up, Vec3(1000, -2000, 5));
    const std::vector<Triangle> triangles = cut(outline);
    ASSERT_EQ(triangles.size(), 7u);
    for (std::uint32_t i = 0; i < 7; ++i) EXPECT_EQ(triangles[i], (Triangle{0, i + 1, i + 2}));
    // area of a regular nonagon; 3e-13 was seen, of coordinates of 2000
    EXPECT_NEAR(sums_of(outline, triangles).size, 4.5 * std::sin(2 * kPi / 9), 1e-12);
  }
}

TEST(Polygon, CornersOnTheSidesOfConvexOnes) {
  // a square with two more corners on each side, from every start: a fan would lie flat
  Outline square;
  const std::array<Vec3, 4> c{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(3, 3, 0), Vec3(0, 3, 0)};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      square.push_back((c[i] * (3.0 - k) + c[(i + 1) % 4] * double(k)) / 3.0);
  for (std::size_t start = 0; start < square.size(); ++start) {
    Outline outline;
    for (std::size_t i = 0; i < square.size(); ++i)
      outline.push_back(square[(start + i) % square.size()]);
    expect_covered_once(outline);
  }
  expect_covered_once({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 1, 0}});
}

TEST(Polygon, AStarThatTurnsTwiceIsNotTakenForConvex) {
  // a pentagram turns left at every corner; its area counts the middle twice
  Outline outline;
  for (int i = 0; i < 5; ++i)
    outline.push_back({std::cos(4 * kPi * i / 5), std::sin(4 * kPi * i / 5), 0});
  const std::vector<Triangle> triangles = cut(outline);
  expect_whole(outline, triangles);
  EXPECT_NEAR(sums_of(outline, triangles).area.z, 2.5 * std::sin(4 * kPi / 5), 1e-15);
}

TEST(Polygon, RandomStars) {
  const Vec3 right = glm::normalize(Vec3(1, 2, -0.5));
  const Vec3 up = glm::normalize(glm::cross(right, Vec3(0.3, -0.2, 1)));
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    expect_covered_once(random_star(5 + int(seed % 40), seed, {1, 0, 0}, {0, 1, 0}));
    // away from the axes the corners leave the plane by rounding alone
    expect_covered_once(random_star(5 + int(seed % 40), seed, right, up));
  }
  expect_covered_once(random_star(191, 1, {1, 0, 0}, {0, 1, 0}));
  expect_covered_once(random_star(192, 1, {1, 0, 0}, {0, 1, 0}));
  expect_covered_once(random_star(1000, 1, {1, 0, 0}, {0, 1, 0}));
}

TEST(Polygon, Spirals) {
  expect_covered_once(spiral(10));
  expect_covered_once(spiral(60));
  expect_covered_once(spiral(90));
  expect_covered_once(spiral(300));
}

TEST(Polygon, TinyAndHugeOnes) {
  for (const double scale : {1e-200, 1e-30, 1e-5, 1e5, 1e30, 1e150}) {
    Outline outline = random_star(31, 5, {1, 0, 0}, {0, 1, 0});
    const std::vector<Triangle> expected = cut(outline);
    for (Vec3& p : outline) p *= scale;
    const std::vector<Triangle> triangles = cut(outline);
    expect_whole(outline, triangles);
    // the same corners, up to what a product with a power of ten rounds
    for (Vec3& p : outline) p /= scale;
    const Sums sums = sums_of(outline, triangles);
    EXPECT_NEAR(sums.size, glm::length(sums.area), 1e-13) << scale;
    EXPECT_EQ(expected.size(), triangles.size());
  }
}

// A square with square holes, each joined to its left neighbour by a double edge.
TEST(Polygon, HolesJoinedByDoubleEdges) {
  for (int holes = 1; holes <= 6; ++holes) {
    const double width = 2.0 * holes + 1;
    Outline outline{{0, 0, 0}, {width, 0, 0}, {width, 3, 0}, {0, 3, 0}, {0, 1, 0}};
    for (int h = 0; h < holes; ++h) {
      const double x = 1 + 2.0 * h;
      outline.insert(outline.end(), {{x, 1, 0}, {x, 2, 0}, {x + 1, 2, 0}, {x + 1, 1, 0}});
    }
    for (int h = holes; h-- > 0;) outline.push_back({1 + 2.0 * h, 1, 0});
    outline.push_back({0, 1, 0});
    for (std::size_t start = 0; start < outline.size(); start += 3) {
      Outline turned;
      for (std::size_t i = 0; i < outline.size(); ++i)
        turned.push_back(outline[(start + i) % outline.size()]);
      const std::vector<Triangle> triangles = cut(turned);
      expect_whole(turned, triangles);
      const Sums sums = sums_of(turned, triangles);
      EXPECT_DOUBLE_EQ(sums.area.z, 3 * width - holes);
      EXPECT_DOUBLE_EQ(sums.size, sums.area.z) << holes << " from " << start;
    }
  }
}

TEST(Polygon, TouchesItselfAtACorner) {
  // two squares that meet in (1, 1), run as one outline: four triangles, and two without area
  const Outline outline{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0},
                        {2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}};
  for (std::size_t start = 0; start < outline.size(); ++start) {
    Outline turned;
    for (std::size_t i = 0; i < outline.size(); ++i)
      turned.push_back(outline[(start + i) % outline.size()]);
    expect_whole(turned, cut(turned));
    EXPECT_DOUBLE_EQ(sums_of(turned, cut(turned)).area.z, 2);
    EXPECT_DOUBLE_EQ(sums_of(turned, cut(turned)).size, 2);
  }
  // a ring that closes in a corner: the outside from within
  const Outline ring{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                     {0, 0, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  const std::vector<Triangle> triangles = cut(ring);
  expect_whole(ring, triangles);
  // 16 less the quadrilateral (0,0) (1,3) (3,3) (3,1), which has 6
  EXPECT_DOUBLE_EQ(sums_of(ring, triangles).area.z, 10);
  EXPECT_DOUBLE_EQ(sums_of(ring, triangles).size, 10);
}

TEST(Polygon, RepeatedCornersGiveOneFlatTriangleEach) {
  const Outline plain = random_star(11, 3, {1, 0, 0}, {0, 1, 0});
  Outline outline;
  for (std::size_t i = 0; i < plain.size(); ++i)
    for (std::size_t k = 0; k <= i % 3; ++k) outline.push_back(plain[i]);
  const std::vector<Triangle> triangles = cut(outline);
  expect_whole(outline, triangles);
  std::size_t flat = 0;
  for (const Triangle& t : triangles)
    flat += area_of(outline[t[0]], outline[t[1]], outline[t[2]]) == Vec3(0);
  EXPECT_EQ(flat, outline.size() - plain.size());
  const Sums sums = sums_of(outline, triangles);
  EXPECT_NEAR(sums.size, glm::length(sums.area), 1e-14);
}

TEST(Polygon, LinesAndPointsAreFlatFans) {
  for (const int n : {3, 4, 5, 12, 300}) {
    Outline line, point;
    for (int i = 0; i < n; ++i) {
      line.push_back({i * 0.25, i * 0.5, -i * 1.0});
      point.push_back({1, 2, 3});
    }
    expect_whole(line, cut(line));
    expect_whole(point, cut(point));
  }
}

TEST(Polygon, OutlinesThatCrossKeepTheirAreaVector) {
  Random random(11);
  for (int round = 0; round < 200; ++round) {
    Outline outline;
    const int n = 4 + round % 60;
    for (int i = 0; i < n; ++i)
      outline.push_back({random.uniform(), random.uniform(), round % 2 ? random.uniform() : 0.0});
    const std::vector<Triangle> triangles = cut(outline);
    expect_whole(outline, triangles);
    // 4e-15 was seen
    EXPECT_LT(glm::length(sums_of(outline, triangles).area - area_of(outline)), 2e-14);
  }
  // as much area on the one side as on the other
  const Outline eight{{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.5, 0}, {0, 1, 0}};
  expect_whole(eight, cut(eight));
}

// What an outline of a map would be: many corners, and islands joined to the border by double
// edges.
TEST(Polygon, ManyCornersWithManyHoles) {
  const int rows = 60, columns = 60;
  const double width = 3.0 * columns + 1, height = 3.0 * rows + 1;
  Outline outline{{0, 0, 0}, {width, 0, 0}, {width, height, 0}, {0, height, 0}};
  for (int r = rows; r-- > 0;) {
    const double y = 1 + 3.0 * r;
    outline.push_back({0, y, 0});
    for (int c = 0; c < columns; ++c) {
      const double x = 1 + 3.0 * c;
      outline.insert(outline.end(), {{x, y, 0}, {x, y + 2, 0}, {x + 2, y + 2, 0}, {x + 2, y, 0}});
    }
    for (int c = columns; c-- > 0;) outline.push_back({1 + 3.0 * c, y, 0});
    outline.push_back({0, y, 0});
  }
  const std::vector<Triangle> triangles = cut(outline);
  ASSERT_EQ(triangles.size(), outline.size() - 2);
  const Sums sums = sums_of(outline, triangles);
  EXPECT_EQ(sums.area.z, width * height - 4.0 * rows * columns);
  EXPECT_EQ(sums.size, sums.area.z);
}

TEST(Polygon, CoordinatesWithoutEndDoNoHarm) {
  const double huge = 1.7e308;
  for (const int n : {4, 5, 9, 300}) {
    Outline outline;
    for (int i = 0; i < n; ++i)
      outline.push_back({i % 2 ? huge : -huge, i % 3 ? huge : -huge, i % 5 ? huge : -huge});
    EXPECT_EQ(cut(outline).size(), outline.size() - 2);
  }
}

}  // namespace
}  // namespace panwright::geometry::polygon_test
