// Points of the Sun's disc against the disc.
#include "preview/frame/sun_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "preview/frame/light_space.h"
#include "preview/frame/projection.h"

namespace panwright::preview::sun_points_test {
namespace {

constexpr double kPi = std::numbers::pi;

// The share of a disc's light on one side of a straight line, physics 2.4.
double beyond_edge(double t, double u) {
  const double even = t * std::sqrt(1 - t * t) + std::asin(t) + kPi / 2;
  const double dark = kPi / 2 * (t - t * t * t / 3 + 2.0 / 3);
  return ((1 - u) * even + u * dark) / ((1 - u) * kPi + 2 * kPi * u / 3);
}

TEST(SunPoints, LightWithinIsThatOfTheDisc) {
  for (const double u : {0.0, 0.3, 0.6, 1.0}) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double r = (i + 0.5) / kSteps;
      sum += (1 - u + u * std::sqrt(1 - r * r)) * 2 * r / kSteps / (1 - u / 3);
      if (i % 1000 == 999) EXPECT_NEAR(light_within((i + 1.0) / kSteps, u), sum, 1e-6) << u;
    }
    EXPECT_EQ(light_within(0, u), 0);
    EXPECT_NEAR(light_within(1, u), 1, 1e-15);
    EXPECT_NEAR(light_within(1e-6, u) / 1e-12, 1 / (1 - u / 3), 1e-6);
  }
}

std::vector<Vec2> sun_points(const SunDisc& disc, unsigned points) {
  std::vector<Vec2> places;
  find_sun_points(disc, points, places);
  return places;
}

// Each of N×N samples takes every fourth point: none of the four parts may move a shadow.
TEST(SunPoints, EveryFourthPointIsAboutTheCentre) {
  for (const unsigned count : {8u, 16u, 32u, 64u, 256u}) {
    const SunDisc disc{1.0, 0.6, 256, 256, true};
    const std::vector<Vec2> points = sun_points(disc, count);
    for (unsigned part = 0; part < 4; ++part) {
      Vec2 sum(0);
      for (unsigned k = part; k < count; k += 4) sum += points[k];
      // found at most: 0.24, 0.12, 0.064, 0.037 and 0.0078 of the radius
      EXPECT_LT(glm::length(sum) / (count / 4), 4.0 / count) << count << " " << part;
    }
  }
}

// Edges in all directions, as far as the share that they leave goes.
TEST(SunPoints, EdgesLeaveWhatTheyLeaveOfTheDisc) {
  for (const double u : {0.0, 0.6})
    for (const unsigned count : {4u, 8u, 16u, 32u, 64u, 128u, 256u}) {
      const SunDisc disc{0.5, u, 256, true};
      const std::vector<Vec2> points = sun_points(disc, count);
      ASSERT_EQ(points.size(), count);
      double squares = 0;
      double worst = 0;
      int places = 0;
      for (int turn = 0; turn < 360; ++turn) {
        const Vec2 across(std::cos(turn * kPi / 180), std::sin(turn * kPi / 180));
        std::vector<double> along;
        for (const Vec2& point : points) along.push_back(glm::dot(point, across) / disc.tangent);
        std::sort(along.begin(), along.end());
        EXPECT_LT(std::max(-along.front(), along.back()), 1.0);
        for (int i = -200; i <= 200; ++i, ++places) {
          const double t = i / 200.0;
          const auto below = std::upper_bound(along.begin(), along.end(), t) - along.begin();
          const double off = static_cast<double>(below) / count - beyond_edge(t, u);
          squares += off * off;
          worst = std::max(worst, std::fabs(off));
        }
      }
      const double rms = std::sqrt(squares / places);
      printf("u %.1f, %3u points: rms %.4f, said %.4f, at most %.3f\n", u, count, rms,
             error_of_sun_points(count), worst);
      // what is said is no less, and not much more
      EXPECT_LE(rms, error_of_sun_points(count));
      EXPECT_GE(rms, 0.7 * error_of_sun_points(count));
    }
}

TEST(SunPoints, AsManyAsAnErrorAsksFor) {
  for (const double error : {0.06, 0.05, 0.02, 0.01, 0.006}) {
    const unsigned count = sun_points_for(error);
    EXPECT_EQ(count % 8, 0u);
    EXPECT_LE(error_of_sun_points(count), error);
    if (count > 8) {
      EXPECT_GT(error_of_sun_points(count - 8), error);
    }
  }
  EXPECT_EQ(sun_points_for(0.05), 16u);
  EXPECT_EQ(sun_points_for(1), 8u);
  EXPECT_EQ(sun_points_for(1e-9), kMostSunPoints);
}

TEST(SunPoints, OneIsTheCentre) {
  const std::vector<Vec2> points = sun_points({0.005, 0.6, 64, true}, 1);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0], Vec2(0));
}

// A ray to a point of the disc runs along z of the space that is sheared by it, and the wider box
// holds what rays from the box reach within it.
TEST(SunPoints, RaysRunAlongTheShearedSpace) {
  DrawItem item;
  item.visible = true;
  item.low = Vec3(-1, -2, 0.5);
  item.high = Vec3(3, 1, 6);
  const Vec3 to_sun = glm::normalize(Vec3(0.3, -0.5, 0.8));
  const LightSpace bare = fitted_light_space(std::span(&item, 1), to_sun, 512);
  const double tangent = 0.01;
  const LightSpace frame = widened(bare, tangent);
  EXPECT_EQ(frame.extent.z, bare.extent.z);
  double farthest = 0;
  for (const Vec2& point : {Vec2(tangent, 0), Vec2(-0.6, 0.8) * tangent, Vec2(0, -tangent)}) {
    const Mat4 sheared_from_model = sheared(sun_shear(frame.extent, point)) * frame.sun_from_model;
    const Vec3 ray = glm::transpose(frame.axes_from_model) * Vec3(point, 1);
    for (const Vec3& corner : corners(item.low, item.high)) {
      const Vec3 start(sheared_from_model * Vec4(corner, 1));
      const Vec3 end(sheared_from_model * Vec4(corner + 700.0 * ray, 1));
      EXPECT_NEAR(start.x, end.x, 1e-11);
      EXPECT_NEAR(start.y, end.y, 1e-11);
      EXPECT_GT(end.z, start.z);
      farthest = std::max({farthest, std::fabs(start.x), std::fabs(start.y)});
    }
  }
  EXPECT_LT(farthest, 1.0);
  EXPECT_GT(farthest, 0.97);
}

}  // namespace
}  // namespace panwright::preview::sun_points_test
