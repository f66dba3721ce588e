// FLIP against values worked out by hand.

#include "bench/flip.h"

#include <gtest/gtest.h>

#include <cmath>

namespace panwright::bench::flip_test {
namespace {

std::vector<float> plain(float r, float g, float b, std::size_t pixels) {
  std::vector<float> rgb;
  for (std::size_t i = 0; i < pixels; ++i) rgb.insert(rgb.end(), {r, g, b});
  return rgb;
}

// Plain images have no features: the colours' distance alone counts. White and black are 100
// apart in lightness; 100^0.7 = 25.12, the most is 203.28^0.7 = 41.28, and beyond 0.4 of that the
// scale runs from 0.95 to 1.
TEST(Flip, WhiteAndBlack) {
  const double flip = mean_flip(plain(1, 1, 1, 900), plain(0, 0, 0, 900), 30, 30);
  EXPECT_NEAR(flip, 0.9674, 1e-4);
}

// Greys of lightness 50 and 60: 10^0.7 = 5.0119 on a scale of 0.95/16.51.
TEST(Flip, TwoGreys) {
  const auto grey = [](double lightness) {
    const double t = (lightness + 16) / 116;
    return static_cast<float>(t * t * t);
  };
  const auto a = plain(grey(50), grey(50), grey(50), 900);
  const auto b = plain(grey(60), grey(60), grey(60), 900);
  EXPECT_NEAR(mean_flip(a, b, 30, 30), 0.95 / (0.4 * std::pow(203.28, 0.7)) * std::pow(10, 0.7),
              2e-4);
}

TEST(Flip, SameAndSymmetric) {
  std::vector<float> a, b;
  for (int i = 0; i < 40 * 40 * 3; ++i) {
    a.push_back(static_cast<float>(0.5 + 0.5 * std::sin(i * 0.37)));
    b.push_back(static_cast<float>(0.5 + 0.5 * std::sin(i * 0.37 + 0.2)));
  }
  EXPECT_EQ(mean_flip(a, a, 40, 40), 0);
  const double forth = mean_flip(a, b, 40, 40);
  EXPECT_GT(forth, 0);
  EXPECT_LT(forth, 1);
  EXPECT_DOUBLE_EQ(forth, mean_flip(b, a, 40, 40));
}

// An edge that moves counts for more than its colours alone.
TEST(Flip, FeaturesRaiseIt) {
  const auto edge = [](int at) {
    std::vector<float> rgb;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) rgb.insert(rgb.end(), 3, x < at ? 0.2f : 0.6f);
    return rgb;
  };
  const double near = mean_flip(edge(30), edge(31), 60, 60);
  const double far = mean_flip(edge(30), edge(36), 60, 60);
  EXPECT_GT(near, 0);
  EXPECT_GT(far, near);
}

}  // namespace
}  // namespace panwright::bench::flip_test
