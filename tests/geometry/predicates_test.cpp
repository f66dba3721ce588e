#include "geometry/tessellate/internal/predicates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::internal::predicates_test {
namespace {

__extension__ using Wide = __int128;

// The sign in whole numbers, for points of whole coordinates.
int whole_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const auto whole = [](double x) { return static_cast<Wide>(static_cast<long long>(x)); };
  const Wide det = (whole(a.x) - whole(c.x)) * (whole(b.y) - whole(c.y)) -
                   (whole(a.y) - whole(c.y)) * (whole(b.x) - whole(c.x));
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

TEST(Orientation, MatchesWholeNumbersNearTheLine) {
  shapes::Random random(3);
  int rounded_wrong = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    const auto coordinate = [&] { return std::floor(random.between(-0x1p52, 0x1p52)); };
    const Vec2 a(coordinate(), coordinate());
    const Vec2 b(coordinate(), coordinate());
    const double t = random.between(-2, 2);
    const Vec2 c(std::floor(a.x + t * (b.x - a.x)), std::floor(a.y + t * (b.y - a.y)));
    const int expected = whole_orientation(a, b, c);
    ASSERT_EQ(orientation(a, b, c), expected);
    ASSERT_EQ(orientation(b, a, c), -expected);
    ASSERT_EQ(orientation(c, a, b), expected);
    const double det = (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
    rounded_wrong += (det > 0) - (det < 0) != expected;
  }
  // the cases are hard: plain arithmetic gets some wrong
  EXPECT_GT(rounded_wrong, 10);
}

TEST(Orientation, GridOfShewchuk) {
  // points an ulp apart next to a line through (12, 12) and (24, 24)
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vec2 p(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53);
      // the line is x = y: the sign is that of y − x
      EXPECT_EQ(orientation({12, 12}, {24, 24}, p), (p.y > p.x) - (p.y < p.x));
    }
  }
}

TEST(Orientation, ScalesFarApart) {
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {1e-60, 1e-60}), 0);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {1e-60, std::nextafter(1e-60, 1)}), 1);
  EXPECT_EQ(orientation({0, 0}, {1, 1e-60}, {2, 2e-60}), 0);
  EXPECT_EQ(orientation({0, 0}, {1, 1e-60}, {2, std::nextafter(2e-60, 0)}), -1);
  EXPECT_EQ(orientation({1e30, 1e30}, {-1e30, -1e30}, {1, 1}), 0);
  EXPECT_EQ(orientation({1e30, 1e30}, {-1e30, -1e30}, {1, std::nextafter(1, 2)}), -1);
}

TEST(InCircle, IsSureOnlyWhereItIsRight) {
  shapes::Random random(5);
  int sure = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    // whole coordinates: the determinant fits 128 bits
    const auto coordinate = [&] { return std::floor(random.between(-1e6, 1e6)); };
    Vec2 p[4];
    for (Vec2& q : p) q = {coordinate(), coordinate()};
    if (trial % 2) {  // nearly on one circle
      const double angle = random.between(0, 6.28);
      for (Vec2& q : p) {
        const double turned = angle + random.between(0, 6.28);
        q = {std::round(9e5 * std::cos(turned)), std::round(9e5 * std::sin(turned))};
      }
    }
    if (orientation(p[0], p[1], p[2]) < 0) std::swap(p[0], p[1]);
    Wide x[3], y[3], lift[3];
    Vec3 lengths;
    for (int k = 0; k < 3; ++k) {
      x[k] = static_cast<long long>(p[k].x - p[3].x);
      y[k] = static_cast<long long>(p[k].y - p[3].y);
      lift[k] = x[k] * x[k] + y[k] * y[k];
      lengths[k] = glm::dot(p[k] - p[3], p[k] - p[3]);
    }
    const Wide det = lift[0] * (x[1] * y[2] - x[2] * y[1]) + lift[1] * (x[2] * y[0] - x[0] * y[2]) +
                     lift[2] * (x[0] * y[1] - x[1] * y[0]);
    const bool inside = clearly_in_circle(p[0], p[1], p[2], p[3], lengths);
    EXPECT_FALSE(inside && det <= 0);
    if (trial % 2 == 0) {
      EXPECT_EQ(inside, det > 0);
    }
    sure += inside;
  }
  EXPECT_GT(sure, 10000);
}

}  // namespace
}  // namespace panwright::geometry::internal::predicates_test
