// The operations of the paper against tables, numpy and figure 9.
#include "tests/mli/sheet_support.h"

namespace panwright::mli::level0_test {
namespace {

using testing::recipe;
using testing::sheet_of;

// tests/mli/level0.py printed these
TEST(Level0, IsWhatNumpyMakes) {
  const Sheet figure9 = sheet_of(
      recipe(120, 60, 240, {Random{1.0}, Smooth{4}, Constant{4.0}, Taper{5.0, 7.0, 2.5, 3.5}}));
  EXPECT_EQ(checksum(figure9.heights), 0x4ba663184bb12d36u);
  EXPECT_EQ(checksum(sheet_of(recipe(1.0, 0.7, 37, {Random{0.003}}, 4294967295u)).heights),
            0x5a2d723ed2f59270u);
  const Recipe several = recipe(0.31, 1.0, 61,
                                {Constant{0.1}, Random{0.02}, Smooth{1}, Random{0.01}, Smooth{19},
                                 Taper{0.0, 0.0, 0.1, 0.35}},
                                12345);
  EXPECT_EQ(checksum(sheet_of(several).heights), 0xb7c2317d05b1bf6cu);
  EXPECT_EQ(checksum(sheet_of(recipe(2.0, 0.01, 200, {Random{1.0}, Smooth{3}}, 7)).heights),
            0x1184fb29c11ca965u);
}

struct Gain {
  std::uint32_t passes;
  double height, slope;  // of variances; of slopes for cells of side 1
};

// exact: sums over the convolved kernels, in two dimensions
constexpr Gain kGains[] = {{0, 1, 0.5},
                           {1, .11111111, .03703704},
                           {2, .05502210, .01303155},
                           {4, .02846788, .00415317},
                           {8, .01457347, .00119674},
                           {16, .00737325, .00032284}};

TEST(Level0, VariancesAreThoseOfTheExactTable) {
  for (const Gain& gain : kGains) {
    double height = 0, x = 0, y = 0, count = 0;
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
      const double cell = 0.25, amplitude = 3;
      const Sheet sheet = sheet_of(
          recipe(512 * cell, 512 * cell, 512, {Random{amplitude}, Smooth{gain.passes}}, seed));
      const std::uint32_t edge = gain.passes + 1;
      for (std::uint32_t j = edge; j + edge < sheet.rows; ++j)
        for (std::uint32_t i = edge; i + edge < sheet.columns; ++i) {
          const double variance = amplitude * amplitude / 3;
          height += std::pow(sheet.at(i, j), 2) / variance;
          x += std::pow((sheet.at(i + 1, j) - sheet.at(i - 1, j)) / 2, 2) / variance;
          y += std::pow((sheet.at(i, j + 1) - sheet.at(i, j - 1)) / 2, 2) / variance;
          ++count;
        }
    }
    // worst: heights 0.24 %, slopes 0.64 %
    EXPECT_NEAR(height / count, gain.height, 0.03 * gain.height) << gain.passes;
    EXPECT_NEAR(x / count, gain.slope, 0.03 * gain.slope) << gain.passes;
    EXPECT_NEAR(y / count, gain.slope, 0.03 * gain.slope) << gain.passes;
  }
}

TEST(Level0, SmoothingPreservesTheMean) {
  for (const std::uint32_t seed : {0u, 1u, 99u}) {
    double means[2];
    for (int k = 0; k < 2; ++k) {
      const Sheet sheet =
          sheet_of(recipe(1, 0.6, 211, {Random{1}, Smooth{k == 0 ? 0u : 57u}}, seed));
      double sum = 0;
      for (const double h : sheet.heights) sum += h;
      means[k] = sum / static_cast<double>(sheet.heights.size());
    }
    EXPECT_NEAR(means[0], means[1], 1e-12);  // 1.4e-17 measured; 1e-7 asked for
  }
}

TEST(Level0, EqualHeightsStayEqualToTheBit) {
  for (const double height : {0.1, 1.0 / 3, -1e-7, 4.0}) {
    const Sheet sheet = sheet_of(recipe(1, 1, 33, {Constant{height}, Smooth{40}}));
    for (const double h : sheet.heights) ASSERT_EQ(h, height);
  }
}

// Moments, and products of neighbours.
TEST(Level0, RandomHeightsAreUniformAndIndependent) {
  constexpr std::uint32_t kSeeds = 16;
  double moments[4]{}, neighbour = 0, count = 0;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    const Sheet sheet = sheet_of(recipe(1, 1, 255, {Random{1}}, seed));
    for (std::uint32_t j = 0; j < sheet.rows; ++j)
      for (std::uint32_t i = 0; i < sheet.columns; ++i) {
        const double h = sheet.at(i, j);
        ASSERT_LE(std::fabs(h), 1);
        for (int k = 0; k < 4; ++k) moments[k] += std::pow(h, k + 1);
        if (i > 0) neighbour += h * sheet.at(i - 1, j);
        ++count;
      }
  }
  const double exact[4] = {0, 1.0 / 3, 0, 1.0 / 5};
  const double spread[4] = {1.0 / 3, 1.0 / 5 - 1.0 / 9, 1.0 / 7, 1.0 / 9 - 1.0 / 25};
  for (int k = 0; k < 4; ++k)  // five standard errors
    EXPECT_NEAR(moments[k] / count, exact[k], 5 * std::sqrt(spread[k] / count)) << k;
  EXPECT_NEAR(neighbour / count, 0, 5.0 / 3 / std::sqrt(count));
}

TEST(Level0, OtherOperationsOfTheSameKindHaveOtherNumbers) {
  const Sheet once = sheet_of(recipe(1, 1, 64, {Random{1}}));
  const Sheet twice = sheet_of(recipe(1, 1, 64, {Random{1}, Random{1}}));
  const Sheet second = sheet_of(recipe(1, 1, 64, {Constant{0}, Random{1}}));
  double product = 0;
  for (std::size_t k = 0; k < once.heights.size(); ++k) {
    EXPECT_EQ(twice.heights[k], once.heights[k] + second.heights[k]);
    product += once.heights[k] * second.heights[k];
  }
  const auto count = static_cast<double>(once.heights.size());
  EXPECT_NEAR(product / count, 0, 5.0 / 3 / std::sqrt(count));
}

TEST(Level0, FigureNineComesDownToFlatEdges) {
  const Recipe lifted =
      recipe(120, 60, 240, {Random{1.0}, Smooth{4}, Constant{4.0}, Taper{5, 7, 2.5, 3.5}});
  Recipe before = lifted;
  before.operations.pop_back();
  const Sheet sheet = sheet_of(lifted), full = sheet_of(before);
  ASSERT_EQ(sheet.columns, 241u);
  ASSERT_EQ(sheet.rows, 121u);
  std::size_t between = 0;
  for (std::uint32_t j = 0; j < sheet.rows; ++j)
    for (std::uint32_t i = 0; i < sheet.columns; ++i) {
      const double x = std::min(0.5 * i, 120 - 0.5 * i), y = std::min(0.5 * j, 60 - 0.5 * j);
      const double h = sheet.at(i, j);
      if (x <= 5 || y <= 2.5) {
        ASSERT_EQ(h, 0) << x << " " << y;
      } else if (x >= 7 && y >= 3.5) {
        ASSERT_EQ(h, full.at(i, j)) << x << " " << y;
        ASSERT_GT(h, 3);
      } else {
        ++between;
        ASSERT_TRUE(h > 0 && h < full.at(i, j)) << x << " " << y;
      }
    }
  EXPECT_GT(between, 1000u);
  // 3t² - 2t³ a quarter and half of the way
  EXPECT_DOUBLE_EQ(sheet.at(11, 60), full.at(11, 60) * 0.15625);
  EXPECT_DOUBLE_EQ(sheet.at(12, 60), full.at(12, 60) * 0.5);
  EXPECT_DOUBLE_EQ(sheet.at(120, 6), full.at(120, 6) * 0.5);
}

TEST(Level0, TapersOfZeroWidthAreNone) {
  const Sheet flat = sheet_of(recipe(1, 1, 10, {Constant{1}, Taper{0, 0, 0, 0}}));
  for (const double h : flat.heights) EXPECT_EQ(h, 1);
  const Sheet step = sheet_of(recipe(1, 1, 8, {Constant{1}, Taper{0.25, 0.25, 0, 0}}));
  for (std::uint32_t i = 0; i <= 8; ++i) EXPECT_EQ(step.at(i, 3), i >= 2 && i <= 6 ? 1 : 0) << i;
}

}  // namespace
}  // namespace panwright::mli::level0_test
