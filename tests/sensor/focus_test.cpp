// Blur by distance against the discs of a thin lens.
#include "sensor/focus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace panwright::sensor::focus_test {
namespace {

constexpr std::uint32_t kSide = 101;
constexpr double kFocal = 4000;  // pixels

Optics optics() {
  Optics out;
  out.aperture_mm = 40;
  out.focus_m = 8;
  return out;
}

// Of one pixel of light, at a depth.
struct Spot {
  double sum = 0, right = 0, down = 0;  // of all; second moments
  double farthest = 0;                  // pixel with light
};

Spot spot_at(double depth, const Vec2& focal) {
  std::vector<float> radiance(3 * kSide * kSide), depths(kSide * kSide, INFINITY);
  const std::size_t middle = kSide / 2 * kSide + kSide / 2;
  radiance[3 * middle + 1] = 7;
  depths[middle] = static_cast<float>(depth);
  DepthImage image{kSide, kSide, radiance, depths};
  defocus(optics(), focal, image);
  Spot out;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double light = double{radiance[3 * i + 1]} / 7;
    const double x = static_cast<double>(i % kSide) - kSide / 2,
                 y = static_cast<double>(i / kSide) - kSide / 2;
    EXPECT_EQ(radiance[3 * i], 0);
    out.sum += light;
    out.right += light * x * x;
    out.down += light * y * y;
    if (light > 0) out.farthest = std::max(out.farthest, std::hypot(x, y));
  }
  return out;
}

TEST(Focus, IsThatOfAThinLens) {
  // D f |1/z − 1/f|: 160 pixels times it
  EXPECT_NEAR(blur_px(optics(), kFocal, 16), 10, 1e-12);
  EXPECT_NEAR(blur_px(optics(), kFocal, 4), 20, 1e-12);
  EXPECT_NEAR(blur_px(optics(), kFocal, INFINITY), 20, 1e-12);
  EXPECT_EQ(blur_px(optics(), kFocal, 8), 0);
}

// A disc of diameter c has a second moment of c²/16 on each axis.
TEST(Focus, DiscsHaveTheirLightAndWidth) {
  for (const double depth : {8.2, 8.5, 8.9, 9.1, 9.5, 11.0, 16.0, 40.0, 4.2, 7.6}) {
    const double c = blur_px(optics(), kFocal, depth);
    const Spot spot = spot_at(depth, Vec2(kFocal));
    EXPECT_NEAR(spot.sum, 1, 1e-6) << depth;
    // 8 % measured of a disc of 3 pixels, 2 % of one of 5: rows of pixels are coarse
    const double coarse = c < 5 ? 0.09 : 0.025;
    EXPECT_NEAR(spot.right / (c * c / 16), 1, coarse) << depth << " " << c;
    EXPECT_NEAR(spot.down / (c * c / 16), 1, coarse) << depth << " " << c;
    EXPECT_LE(spot.farthest, std::max(0.5 * c, 1.0) + 1.0) << depth;
  }
  // pixels that are not square
  const Spot spot = spot_at(16, Vec2(kFocal, 0.5 * kFocal));
  EXPECT_NEAR(spot.right, 100 / 16.0, 0.1);
  EXPECT_NEAR(spot.down, 25 / 16.0, 0.03);
}

TEST(Focus, WhatIsInFocusStays) {
  std::vector<float> radiance(3 * 64, 0.3f), depths(64, 8);
  radiance[50] = 2;
  const std::vector<float> before = radiance;
  DepthImage image{8, 8, radiance, depths};
  defocus(optics(), Vec2(kFocal), image);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(radiance[i], before[i], 1e-6) << i;
}

// A pixel beside a surface, whose centre misses it, is as near as this.
TEST(Focus, EdgesAreOfTheirSurface) {
  std::vector<float> radiance(3 * 9, 0.0f), depths(9, INFINITY);
  radiance[3 * 3] = 1, radiance[3 * 4] = 0.5f;
  depths[3] = 8;
  DepthImage image{3, 3, radiance, depths};
  defocus(optics(), Vec2(kFocal), image);
  EXPECT_NEAR(radiance[3 * 4], 0.5, 1e-6);
  EXPECT_NEAR(std::accumulate(radiance.begin(), radiance.end(), 0.0), 1.5, 1e-6);
}

// A plate in focus whose edge a Gaussian of 1.2 pixels has blurred, before light at infinity.
TEST(Focus, TailsOfSharpEdgesStay) {
  constexpr std::uint32_t kSize = 64;
  for (const float behind : {0.0f, 0.8f}) {
    std::vector<float> radiance(3 * kSize * kSize), depths(kSize * kSize, INFINITY);
    std::vector<double> before(kSize);
    for (std::uint32_t y = 0; y < kSize; ++y)
      for (std::uint32_t x = 0; x < kSize; ++x) {
        const std::size_t i = std::size_t{y} * kSize + x;
        if (x < 20) depths[i] = 8;
        before[x] = 0.5 * std::erfc((x + 0.5 - 20) / (1.2 * std::sqrt(2.0)));
        const float value = x < 50 ? static_cast<float>(before[x]) : behind;
        std::fill_n(&radiance[3 * i], 3, value);
      }
    DepthImage image{kSize, kSize, radiance, depths, 1.2};
    defocus(optics(), Vec2(kFocal), image);
    // discs of infinity are 20 pixels wide: what stands beyond 50 reaches to 40
    for (std::size_t x = 0; x < 36; ++x)
      EXPECT_NEAR(radiance[3 * (32 * kSize + x)], before[x], 1e-6) << x << " " << behind;
    if (behind > 0) EXPECT_NEAR(radiance[3 * (32 * kSize + 50)], 0.5 * behind, 0.05);
  }
}

}  // namespace
}  // namespace panwright::sensor::focus_test
