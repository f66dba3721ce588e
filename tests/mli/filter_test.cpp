// One foil at every detail.
#include "tests/mli/sheet_support.h"

namespace panwright::mli::filter_test {
namespace {

using testing::everything;
using testing::recipe;
using testing::sheet_of;

// Heights linear along x, then y, between vertices; mirrored beyond the edges.
double between(const Sheet& sheet, double x, double y) {
  const double w = sheet.columns - 1, h = sheet.rows - 1;
  x = std::fabs(x / sheet.spacing.x);
  y = std::fabs(y / sheet.spacing.y);
  if (x > w) x = 2 * w - x;
  if (y > h) y = 2 * h - y;
  const auto i = std::min(static_cast<std::uint32_t>(x), sheet.columns - 2);
  const auto j = std::min(static_cast<std::uint32_t>(y), sheet.rows - 2);
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * sheet.at(i, j) + s * sheet.at(i + 1, j)) +
         t * ((1 - s) * sheet.at(i, j + 1) + s * sheet.at(i + 1, j + 1));
}

// By area, linear between vertices.
double mean_of(const Sheet& sheet) {
  double sum = 0, weights = 0;
  for (std::uint32_t j = 0; j < sheet.rows; ++j)
    for (std::uint32_t i = 0; i < sheet.columns; ++i) {
      const double w =
          (i == 0 || i + 1 == sheet.columns ? 0.5 : 1) * (j == 0 || j + 1 == sheet.rows ? 0.5 : 1);
      sum += w * sheet.at(i, j);
      weights += w;
    }
  return sum / weights;
}

TEST(Filter, CoarserSheetsAreBoxMeansOfTheRecipesOwn) {
  const Sheet fine = sheet_of(recipe(2, 1.3, 60, {Random{1}, Smooth{1}}, 5));
  for (const std::uint32_t cells : {1u, 7u, 23u, 30u, 59u}) {
    const Sheet coarse = filtered(fine, cells);
    ASSERT_EQ(coarse.columns, cells + 1);
    EXPECT_DOUBLE_EQ(coarse.spacing.x * cells, 2);
    EXPECT_DOUBLE_EQ(coarse.spacing.y * (coarse.rows - 1), fine.spacing.y * (fine.rows - 1));
    double worst = 0;
    constexpr int n = 60;  // midpoints a side
    for (std::uint32_t j = 0; j < coarse.rows; j += 1 + coarse.rows / 6)
      for (std::uint32_t i = 0; i < coarse.columns; i += 1 + coarse.columns / 6) {
        double sum = 0;
        for (int b = 0; b < n; ++b)
          for (int a = 0; a < n; ++a)
            sum += between(fine, (i - 0.5 + (a + 0.5) / n) * coarse.spacing.x,
                           (j - 0.5 + (b + 0.5) / n) * coarse.spacing.y);
        worst = std::max(worst, std::fabs(sum / (n * n) - coarse.at(i, j)));
      }
    // the midpoint rule's own error, which falls with n²
    EXPECT_LT(worst, cells == 1 ? 4e-3 : 1e-3) << cells;
  }
}

TEST(Filter, MadeAtADetailIsTheFilteredSheet) {
  const Recipe recipe = everything();
  const Sheet whole = sheet_of(recipe);
  for (const std::uint32_t cells : {3u, 100u, 300u}) {
    const Sheet coarse = sheet_of(recipe, cells);
    EXPECT_EQ(coarse.heights, filtered(whole, cells).heights) << cells;
    EXPECT_NEAR(mean_of(coarse), mean_of(whole), 1e-15);  // 3e-18 m measured
  }
  for (const std::uint32_t cells : {0u, 301u, 5000u})
    EXPECT_EQ(sheet_of(recipe, cells).heights, whole.heights) << cells;
}

TEST(Filter, SlopesThatAreLostAreKept) {
  const Sheet whole = sheet_of(everything());
  double before = 0;
  for (const std::uint32_t cells : {150u, 75u, 37u, 10u}) {
    const Sheet coarse = filtered(whole, cells);
    const Covariance& lost = coarse.removed_slope_covariance;
    const Covariance& left = coarse.statistics.facet_slope_covariance;
    const Covariance& all = whole.statistics.facet_slope_covariance;
    EXPECT_DOUBLE_EQ(lost.xx + left.xx, all.xx);
    EXPECT_DOUBLE_EQ(lost.yy + left.yy, all.yy);
    EXPECT_NEAR(lost.xy + left.xy, all.xy, 1e-15);
    EXPECT_GT(lost.xx + lost.yy, before);
    before = lost.xx + lost.yy;
    // in two steps as in one, but for two boxes in place of one
    const Sheet again = filtered(coarse, 5);
    EXPECT_NEAR(again.removed_slope_covariance.xx + again.statistics.facet_slope_covariance.xx,
                all.xx, 1e-15);
  }
}

// What does not count in cells is the same foil on any grid: vertices that two grids share.
TEST(Filter, AFinerGridOfTheRecipeShowsTheSameFoil) {
  Recipe coarse = everything();
  coarse.operations.erase(coarse.operations.begin(), coarse.operations.begin() + 2);  // in cells
  coarse.operations.erase(coarse.operations.begin() + 7);  // measures the grid
  coarse.operations.erase(coarse.operations.begin() + 3);  // has more octaves
  coarse.xgrid = 150;
  Recipe fine = coarse;
  fine.xgrid = 450;
  const Sheet a = sheet_of(coarse), b = sheet_of(fine);
  double worst = 0;
  for (std::uint32_t j = 0; j < a.rows; ++j)
    for (std::uint32_t i = 0; i < a.columns; ++i)
      worst = std::max(worst, std::fabs(a.at(i, j) - b.at(3 * i, 3 * j)));
  EXPECT_LT(worst, 1e-14);  // metres; 9e-17 measured
}

}  // namespace
}  // namespace panwright::mli::filter_test
