#include "geometry/tessellate/internal/triangulate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <map>

#include "base/clock.h"
#include "geometry/tessellate/internal/predicates.h"
#include "outlines.h"

namespace panwright::geometry::internal::triangulate_test {
namespace {

using shapes::Outline;

std::vector<Triangle> triangles_of(const Outline& outline) {
  Region region = outline.region();
  const auto fault = fault_of(region);
  EXPECT_FALSE(fault) << fault->edge << " " << fault->other;
  if (fault) return {};
  return triangulated(region);
}

// Counts, directions, areas, sides: what makes a list of triangles a triangulation.
void expect_triangulation(const Outline& outline, double area_slack = 1e-12) {
  const std::vector<Triangle> triangles = triangles_of(outline);
  const std::size_t holes = outline.loops.size() - 2;
  ASSERT_EQ(triangles.size(), outline.points.size() + 2 * holes - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  long double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec2 &a = outline.points[t[0]], &b = outline.points[t[1]], &c = outline.points[t[2]];
    ASSERT_GT(orientation(a, b, c), 0);
    sum += static_cast<long double>(b.x - a.x) * (c.y - a.y) -
           static_cast<long double>(b.y - a.y) * (c.x - a.x);
    for (int k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  const double area = shapes::area(outline);
  EXPECT_NEAR(static_cast<double>(sum) / 2, area, area_slack * area);
  // each side once, its other direction once or an edge of the outline
  std::size_t borders = 0;
  for (const auto& [side, uses] : sides) {
    ASSERT_EQ(uses, 1);
    borders += !sides.contains({side.second, side.first});
  }
  EXPECT_EQ(borders, outline.points.size());
  for (std::size_t l = 0; l + 1 < outline.loops.size(); ++l) {
    for (std::uint32_t i = outline.loops[l]; i < outline.loops[l + 1]; ++i) {
      const std::uint32_t j = i + 1 < outline.loops[l + 1] ? i + 1 : outline.loops[l];
      EXPECT_NE(sides.contains({i, j}), sides.contains({j, i}));
    }
  }
}

TEST(Triangulate, Simple) {
  expect_triangulation(shapes::outline({{0, 0}, {1, 0}, {0, 1}}));
  expect_triangulation(shapes::outline({{0, 0}, {0, 1}, {1, 1}, {1, 0}}));
  expect_triangulation(shapes::outline({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}));
}

TEST(Triangulate, Circles) {
  for (const int count : {3, 4, 5, 6, 7, 8, 100, 1000, 4096})
    expect_triangulation(shapes::outline(shapes::circle(count, 2, {1, 5})));
}

TEST(Triangulate, RandomStars) {
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    expect_triangulation(shapes::outline(shapes::star(5 + static_cast<int>(seed), seed)));
}

TEST(Triangulate, CombsAndSpirals) {
  for (const int teeth : {1, 2, 7, 300}) {
    Outline comb = shapes::outline(shapes::comb(teeth));
    for (int turn = 0; turn < 4; ++turn) {
      expect_triangulation(comb);
      for (Vec2& p : comb.points) p = {-p.y, p.x};
    }
  }
  expect_triangulation(shapes::outline(shapes::spiral(500, 9)));
}

TEST(Triangulate, ManyHoles) { expect_triangulation(shapes::sieve(32)); }

TEST(Triangulate, RunsAlongLines) {
  // a cross on a grid, each unit of each edge a point
  std::vector<Vec2> loop;
  const Vec2 corners[] = {{3, 0}, {6, 0}, {6, 3}, {9, 3}, {9, 6}, {6, 6},
                          {6, 9}, {3, 9}, {3, 6}, {0, 6}, {0, 3}, {3, 3}};
  for (int k = 0; k < 12; ++k) {
    const Vec2 a = corners[k], b = corners[(k + 1) % 12];
    for (int i = 0; i < 3; ++i) loop.push_back(a + (b - a) * (i / 3.0));
  }
  Outline outline = shapes::outline(loop);
  outline.add({{4, 4}, {4.5, 4}, {5, 4}, {5, 5}, {4, 5}, {4, 4.5}});
  outline.add({{1, 4}, {2, 4}, {2, 5}, {1, 5}});
  expect_triangulation(outline);
  for (Vec2& p : outline.points) p = {p.y, p.x};
  expect_triangulation(outline);
}

TEST(Triangulate, NearlyDegenerate) {
  // a long run that leaves its line by one unit in the last place
  std::vector<Vec2> loop;
  shapes::Random random(8);
  for (int i = 0; i <= 200; ++i)
    loop.push_back({static_cast<double>(i), 1 + (random() < 0.5 ? 0 : 0x1p-52)});
  for (int i = 200; i >= 0; --i) loop.push_back({i - 0.5, 1 - (random() < 0.5 ? 1e-15 : 2e-15)});
  expect_triangulation(shapes::outline(loop), 1e-9);
  // far from the origin, steps near the spacing of its numbers
  Outline far = shapes::outline(shapes::star(300, 4));
  for (Vec2& p : far.points) p = Vec2(1e6, -1e6) + 1e-6 * p;
  expect_triangulation(far, 1e-6);
}

TEST(Triangulate, RandomLoopsOnAGrid) {
  // whatever is sound among loops of few places
  shapes::Random random(23);
  int sound = 0;
  for (int trial = 0; trial < 40000; ++trial) {
    std::vector<Vec2> loop;
    const int count = 4 + static_cast<int>(random() * 7);
    for (int i = 0; i < count; ++i)
      loop.push_back({std::floor(random() * 5), std::floor(random() * 5)});
    const Outline outline = shapes::outline(loop);
    Region region = outline.region();
    if (fault_of(region)) continue;
    ++sound;
    expect_triangulation(outline);
  }
  EXPECT_GT(sound, 2000);
}

// Points spread over the square belong to one triangle when they are inside, to none otherwise.
TEST(Triangulate, CoversTheAreaOnce) {
  Outline outline = shapes::outline(shapes::star(60, 12));
  outline.add(shapes::circle(9, 0.04));
  const std::vector<Triangle> triangles = triangles_of(outline);
  shapes::Random random(2);
  for (int trial = 0; trial < 5000; ++trial) {
    const Vec2 p(random.between(-1, 1), random.between(-1, 1));
    int covers = 0;
    for (const Triangle& t : triangles)
      covers += orientation(outline.points[t[0]], outline.points[t[1]], p) > 0 &&
                orientation(outline.points[t[1]], outline.points[t[2]], p) > 0 &&
                orientation(outline.points[t[2]], outline.points[t[0]], p) > 0;
    EXPECT_EQ(covers, shapes::inside(outline, p) ? 1 : 0);
  }
}

// No side inside has the far corner of its neighbour within its triangle's circle.
TEST(Triangulate, IsDelaunayWithinTheOutline) {
  const Outline outline = shapes::outline(shapes::star(500, 31, 0.4));
  const std::vector<Triangle> triangles = triangles_of(outline);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> across;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) across[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
  for (const auto& each : across) {
    const std::pair<std::uint32_t, std::uint32_t>& side = each.first;
    const auto other = across.find({side.second, side.first});
    if (other == across.end()) continue;
    // angles opposite a side of a Delaunay triangulation sum to at most π
    const auto angle = [&](std::uint32_t apex) {
      const Vec2 a = outline.points[side.first] - outline.points[apex];
      const Vec2 b = outline.points[side.second] - outline.points[apex];
      return std::atan2(std::fabs(a.x * b.y - a.y * b.x), glm::dot(a, b));
    };
    EXPECT_LE(angle(each.second) + angle(other->second), M_PI + 1e-9);  // 1e-10 measured
  }
}

TEST(Triangulate, AHundredThousandPointsInTime) {
  const auto seconds = [](const Outline& outline) {
    Region region = outline.region();
    EXPECT_FALSE(fault_of(region));
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(triangulated(region).size(),
              outline.points.size() + 2 * (outline.loops.size() - 2) - 2);
    const double took = seconds_since(start);
    return took;
  };
  // 0.05 to 0.16 s measured; flips without order take minutes
  EXPECT_LT(seconds(shapes::outline(shapes::star(100000, 2))), 30);
  EXPECT_LT(seconds(shapes::outline(shapes::comb(50000))), 30);
  EXPECT_LT(seconds(shapes::outline(shapes::circle(100000, 1))), 30);
  EXPECT_LT(seconds(shapes::outline(shapes::spiral(50000, 40))), 30);
  EXPECT_LT(seconds(shapes::sieve(120)), 30);
}

}  // namespace
}  // namespace panwright::geometry::internal::triangulate_test
