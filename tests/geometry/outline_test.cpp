#include "geometry/tessellate/internal/outline.h"

#include <gtest/gtest.h>

#include <chrono>

#include "base/clock.h"
#include "geometry/tessellate/internal/predicates.h"
#include "outlines.h"

namespace panwright::geometry::internal::outline_test {
namespace {

using shapes::Outline;
using Kind = RegionFault::Kind;

std::optional<RegionFault> fault(const Outline& outline) {
  Region region = outline.region();
  return fault_of(region);
}

void expect_fault(const Outline& outline, Kind kind, std::uint32_t edge, std::uint32_t other) {
  const auto found = fault(outline);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, kind);
  EXPECT_EQ(std::min(found->edge, found->other), std::min(edge, other));
  EXPECT_EQ(std::max(found->edge, found->other), std::max(edge, other));
}

// Every pair of edges, in plain words: neighbours may share their corner, others nothing.
bool simple_by_pairs(const std::vector<Vec2>& p) {
  const std::size_t n = p.size();
  const auto between = [](const Vec2& a, const Vec2& b, const Vec2& q) {
    return orientation(a, b, q) == 0 && glm::dot(q - a, q - b) <= 0;
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const Vec2 &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
      if (j == i + 1 || (i == 0 && j == n - 1)) {
        const Vec2& shared = j == i + 1 ? b : a;
        const Vec2& u = j == i + 1 ? a : b;
        const Vec2& v = j == i + 1 ? d : c;
        if (between(shared, u, v) || between(shared, v, u)) return false;
        continue;
      }
      const int s1 = orientation(a, b, c), s2 = orientation(a, b, d);
      const int s3 = orientation(c, d, a), s4 = orientation(c, d, b);
      if (s1 * s2 < 0 && s3 * s4 < 0) return false;
      if (between(a, b, c) || between(a, b, d) || between(c, d, a) || between(c, d, b))
        return false;
    }
  }
  return true;
}

TEST(Outline, SoundOnesHaveNoFault) {
  EXPECT_FALSE(fault(shapes::outline({{0, 0}, {1, 0}, {0, 1}})));
  EXPECT_FALSE(fault(shapes::outline({{0, 0}, {0, 1}, {1, 0}})));
  EXPECT_FALSE(fault(shapes::outline(shapes::circle(1000, 3))));
  EXPECT_FALSE(fault(shapes::outline(shapes::star(1001, 1))));
  EXPECT_FALSE(fault(shapes::outline(shapes::comb(500))));
  EXPECT_FALSE(fault(shapes::outline(shapes::spiral(700, 6))));
  EXPECT_FALSE(fault(shapes::sieve(30)));
  // runs along lines, upright ones too
  EXPECT_FALSE(fault(shapes::outline(
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {2, 2}, {1, 2}, {0, 2}, {0, 1}})));
}

TEST(Outline, CrossingsAreNamed) {
  // a bow tie
  expect_fault(shapes::outline({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), Kind::crossing, 0, 2);
  // a five-pointed star in one stroke
  std::vector<Vec2> star;
  for (const int i : {0, 2, 4, 1, 3}) star.push_back(shapes::circle(5, 1)[i]);
  ASSERT_TRUE(fault(shapes::outline(star)));
  EXPECT_EQ(fault(shapes::outline(star))->kind, Kind::crossing);
  // a figure eight of many points
  std::vector<Vec2> eight;
  for (int i = 0; i < 100; ++i) {
    const double t = 2 * M_PI * (i + 0.5) / 100;
    eight.push_back({std::sin(2 * t), std::sin(t)});
  }
  // it crosses itself at the origin only, between t = 0 and t = π
  expect_fault(shapes::outline(eight), Kind::crossing, 49, 99);
}

TEST(Outline, TouchesAreCrossings) {
  // a corner on an edge
  const auto corner = fault(shapes::outline({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->kind, Kind::crossing);
  EXPECT_EQ(corner->edge, 0u);
  // two corners at one place
  ASSERT_TRUE(fault(shapes::outline({{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}})));
  // a spike without width, inwards and outwards, in every direction
  for (const Vec2& tip : {Vec2(1, 0.5), Vec2(1, -3)}) {
    Outline spike = shapes::outline({{0, 0}, {1, 0}, tip, {1, 0}, {2, 0}, {2, 1}, {0, 1}});
    for (int turn = 0; turn < 4; ++turn) {
      EXPECT_TRUE(fault(spike)) << turn;
      for (Vec2& p : spike.points) p = {-p.y, p.x};
    }
  }
  // there and back
  ASSERT_TRUE(fault(shapes::outline({{0, 0}, {1, 0}, {2, 0}})));
  ASSERT_TRUE(fault(shapes::outline({{0, 0}, {3, 0}, {1, 0}, {2, 1}})));
  // two edges on one line that overlap
  ASSERT_TRUE(fault(shapes::outline({{0, 0}, {4, 0}, {4, 1}, {3, 0}, {1, 0}, {1, 1}, {0, 1}})));
}

TEST(Outline, NearMissesAreNoFaults) {
  // a corner an ulp above the edge, then on it
  const double tiny = 0x1p-52;
  EXPECT_FALSE(fault(shapes::outline({{0, 1}, {4, 1}, {4, 4}, {2, 1 + tiny}, {0, 4}})));
  EXPECT_TRUE(fault(shapes::outline({{0, 1}, {4, 1}, {4, 4}, {2, 1}, {0, 4}})));
  EXPECT_TRUE(fault(shapes::outline({{0, 1}, {4, 1}, {4, 4}, {2, 1 - tiny / 2}, {0, 4}})));
}

TEST(Outline, NeighboursThatCoincide) {
  expect_fault(shapes::outline({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), Kind::coincident, 1, 2);
  expect_fault(shapes::outline({{0, 0}, {1, 0}, {1, 1e-10}, {0, 1}}), Kind::coincident, 1, 2);
  EXPECT_FALSE(fault(shapes::outline({{0, 0}, {1, 0}, {1, 1e-8}, {0, 1}})));
  expect_fault(shapes::outline({{2, 2}, {2, 2}, {2, 2}}), Kind::coincident, 0, 1);
}

TEST(Outline, HolesLieInsideAndApart) {
  const std::vector<Vec2> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const auto with = [&](std::initializer_list<std::vector<Vec2>> holes) {
    Outline outline = shapes::outline(square);
    for (const auto& hole : holes) outline.add(hole);
    return outline;
  };
  const auto at = [](double x, double y, double r) { return shapes::circle(8, r, {x, y}); };
  EXPECT_FALSE(fault(with({at(3, 3, 1), at(7, 7, 1), at(3, 7, 1)})));
  for (const Vec2& outside : {Vec2(-5, 5), Vec2(15, 5), Vec2(5, -5), Vec2(5, 15)})
    EXPECT_EQ(fault(with({at(3, 3, 1), at(outside.x, outside.y, 1)}))->kind, Kind::outside);
  EXPECT_EQ(fault(with({at(5, 5, 20)}))->kind, Kind::outside);
  EXPECT_EQ(fault(with({at(5, 5, 3), at(5, 5, 1)}))->kind, Kind::nested);
  EXPECT_EQ(fault(with({at(5, 5, 1), at(5, 5, 3)}))->kind, Kind::nested);
  EXPECT_EQ(fault(with({at(9.5, 5, 1)}))->kind, Kind::crossing);
  // it begins inside the other, which is seen first
  EXPECT_EQ(fault(with({at(4, 5, 1), at(5, 5, 1)}))->kind, Kind::nested);
  // a corner of a hole on the outline, and on another hole
  EXPECT_EQ(fault(with({at(9, 5, 1)}))->kind, Kind::crossing);
  EXPECT_EQ(fault(with({at(4, 5, 1), at(6, 5, 1)}))->kind, Kind::crossing);
  EXPECT_EQ(fault(with({square}))->kind, Kind::crossing);
}

TEST(Outline, EveryWindingIsTurnedTheSameWay) {
  for (const bool outer : {false, true}) {
    for (const bool inner : {false, true}) {
      std::vector<Vec2> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
      std::vector<Vec2> hole = shapes::circle(7, 2, {5, 5});
      if (outer) std::reverse(square.begin(), square.end());
      if (inner) std::reverse(hole.begin(), hole.end());
      Outline outline = shapes::outline(square);
      outline.add(hole);
      Region region = outline.region();
      ASSERT_FALSE(fault_of(region));
      EXPECT_EQ(region.next[0], outer ? 3u : 1u);
      EXPECT_EQ(region.next[5], inner ? 6u : 4u);
    }
  }
}

TEST(Outline, RandomLoopsAgreeWithAllPairs) {
  shapes::Random random(17);
  int sound = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    // few places on a small grid: every kind of touch happens
    const int count = 3 + static_cast<int>(random() * 6);
    const double side = trial % 3 == 0 ? 3 : 6;
    std::vector<Vec2> loop;
    for (int i = 0; i < count; ++i)
      loop.push_back({std::floor(random() * side), std::floor(random() * side)});
    bool doubled = false;
    for (int i = 0; i < count; ++i) doubled |= loop[i] == loop[(i + 1) % count];
    if (doubled) continue;
    const bool expected = simple_by_pairs(loop);
    ASSERT_EQ(!fault(shapes::outline(loop)), expected) << trial;
    sound += expected;
  }
  EXPECT_GT(sound, 1000);
}

TEST(Outline, AHundredThousandPointsAreCheckedInTime) {
  const auto seconds = [](const Outline& outline) {
    Region region = outline.region();
    const auto start = std::chrono::steady_clock::now();
    EXPECT_FALSE(fault_of(region));
    return seconds_since(start);
  };
  // 0.06 s measured; a check of all pairs takes minutes
  EXPECT_LT(seconds(shapes::outline(shapes::star(100000, 2))), 30);
  EXPECT_LT(seconds(shapes::outline(shapes::comb(50000))), 30);
  EXPECT_LT(seconds(shapes::outline(shapes::circle(100000, 1))), 30);
}

TEST(Outline, HugeAndTinyCoordinates) {
  for (const double scale : {1e-30, 1e-9, 1e9, 1e30}) {
    std::vector<Vec2> loop = shapes::star(200, 9);
    for (Vec2& p : loop) p *= scale;
    EXPECT_FALSE(fault(shapes::outline(loop)));
    std::swap(loop[50], loop[90]);
    EXPECT_TRUE(fault(shapes::outline(loop)));
  }
}

}  // namespace
}  // namespace panwright::geometry::internal::outline_test
