// Recipes that cannot be, and what is said of them.
#include <gmock/gmock.h>

#include <limits>

#include "tests/mli/sheet_support.h"

namespace panwright::mli::recipe_test {
namespace {

using testing::everything;
using ::testing::HasSubstr;
using testing::recipe;
using testing::sheet_of;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::string said_of(const Recipe& recipe) {
  DiagnosticLog log;
  EXPECT_FALSE(made(recipe, {}, log).ok());
  std::string all;
  for (const Diagnostic& entry : log.entries()) {
    EXPECT_EQ(entry.code, Code("E7001"));
    all += entry.message + "\n";
  }
  return all;
}

TEST(Recipe, SizesThatCannotBe) {
  for (const double wrong : {0.0, -1.0, kNan, kInfinite, 1e10, 1e-10}) {
    EXPECT_THAT(said_of(recipe(wrong, 1, 10, {})), HasSubstr("width is ")) << wrong;
    EXPECT_THAT(said_of(recipe(1, wrong, 10, {})), HasSubstr("height is ")) << wrong;
  }
  EXPECT_EQ(said_of(recipe(1, 1, 0, {})), "xgrid is 0, expected 1 to 100000 cells across\n");
  EXPECT_EQ(said_of(recipe(1, 1, 10'000'000, {})),
            "xgrid is 10000000, expected 1 to 100000 cells across\n");
  EXPECT_EQ(said_of(recipe(1, 1, 50'000, {})),
            "xgrid 50000 makes 2500100001 vertices, expected at most 70000000: an xgrid of 8365\n");
  EXPECT_THAT(said_of(recipe(1, 0.001, 100, {})), HasSubstr("is 0 cells high"));
  EXPECT_THAT(said_of(recipe(0.001, 1e9, 100, {})), HasSubstr("cells high, expected 1 to"));
  EXPECT_EQ(said_of(recipe(1, 1, 8000, {Smooth{2000}})),
            "operation 1, smooth: number of passes is 2000, expected a number from 0 to 1562\n");
  // what is proposed is accepted
  DiagnosticLog log;
  EXPECT_TRUE(check(recipe(1, 1, 8365, {}), log));
  EXPECT_TRUE(check(recipe(1, 0.0006, 8365, {}), log));
}

TEST(Recipe, OperationsThatCannotBe) {
  struct Case {
    Operation operation;
    const char* said;
  };
  Crease dense;
  dense.density = 1e9;
  dense.length = 0.001;
  Crease overlapping;
  overlapping.density = 3e4;
  overlapping.length = 0.1;
  Crease long_tailed;
  long_tailed.tail = 1;
  long_tailed.length = 0.1;
  Crease short_ridges;
  short_ridges.length = 0.01;
  const Case cases[] = {
      {Random{-1}, "operation 2, random: amplitude is -1, expected a number from 0 to"},
      {Random{kNan}, "amplitude is nan"},
      {Smooth{10'001}, "number of passes is 10001, expected a number from 0 to 10000"},
      {Constant{kInfinite}, "height is inf"},
      {Taper{0.3, 0.2, 0, 0}, "x0 is 0.3 m and x1 0.2 m, expected x1 at least as large as x0"},
      {Taper{0, 0.6, 0, 0}, "x1 is 0.6 m, more than half the sheet's width, 0.5 m"},
      {Taper{0, 0, 0.1, 0.26}, "y1 is 0.26 m, more than half the sheet's height, 0.25 m"},
      {Taper{0, kNan, 0, 0}, "x1 is nan"},
      {Taper{-1, 0, 0, 0}, "x0 is -1"},
      {Wrinkle{0, 1, 0, 3}, "wavelength is 0"},
      {Wrinkle{0.01, 1, 0, 3},
       "wavelength 0.01 m is less than two cells of the grid, 0.02 m; expected a larger one, or "
       "cells (width / xgrid) of at most 0.005 m"},
      {Fractal{0.7, 1, 0.01}, "longest 0.01 m is less than two cells"},
      {Emboss{Pattern::quilt, 0.01, 1}, "pitch 0.01 m is less than two cells"},
      {Seam{true, 0.2, 0.01, 1, 0, 0}, "width 0.01 m is less than two cells"},
      {Seam{true, 0.2, 0.1, 1, 0.01, 0}, "stitch 0.01 m is less than two cells"},
      {Crush{0.01, 1}, "size 0.01 m is less than two cells"},
      {short_ridges, "length 0.01 m is less than two cells"},
      {Wrinkle{0.1, kNan, 0, 3}, "amplitude is nan"},
      {Wrinkle{0.1, 1, kInfinite, 3}, "direction is inf"},
      {Wrinkle{0.1, 1, 0, 0.5}, "anisotropy is 0.5, expected a number from 1 to 100"},
      {dense, ": a density of"},
      {overlapping,
       "ridges overlap at each point of the sheet, expected at most 100: a density of"},
      {long_tailed, "tail is 1, expected a number from 1.01 to 10"},
      {Fractal{0, 1, 0}, "H is 0, expected above 0 and at most 1"},
      {Fractal{kNan, 1, 0}, "H is nan, expected above 0 and at most 1"},
      {Fractal{1.5, 1, 0}, "H is 1.5, expected a number from 0 to 1"},
      {Fractal{0.5, -1, 0}, "rms is -1"},
      {Fractal{0.5, 1, -1}, "longest is -1"},
      {Emboss{Pattern::quilt, 0, 1}, "pitch is 0"},
      {Emboss{Pattern::diamond, 1, kNan}, "depth is nan"},
      {Seam{true, 0.6, 0.1, 0, 0, 0},
       "position is 0.6, expected a number from 0 to 0.5 m, on the sheet"},
      {Seam{false, 0.6, 0, 0, 0, 0}, "width is 0"},
      {Seam{false, 0.6, 0.1, 0, -1, 0}, "stitch is -1"},
      {Button{0, 0, 0, 0}, "pitch is 0"},
      {Button{0.2, 0.05, 0.15, 0},
       "reach is 0.15 m, expected more than the radius, 0.05 m, and at most half the pitch, 0.1 m"},
      {Button{0.2, 0.05, 0.05, 0}, "reach is 0.05 m"},
      {Button{0.2, 0.05, kNan, 0}, "reach is nan m"},
      {Crush{0, 1}, "size is 0"},
      {Crush{1, kInfinite}, "depth is inf"},
      {SlopeRms{-0.1}, "slope is -0.1, expected a number from 0 to 100"},
      {SlopeRms{0.1}, "the sheet is flat here"},
  };
  for (const Case& each : cases)
    EXPECT_THAT(said_of(recipe(1, 0.5, 100, {Constant{1}, each.operation})), HasSubstr(each.said));
}

TEST(Recipe, SaysAllThatIsWrongWithItsPlace) {
  DiagnosticLog log;
  RecipePlaces places;
  places.recipe = {0, 1, 2};
  places.xgrid = {0, 10, 12};
  places.operations = {{0, 20, 22}, {0, 30, 32}};
  Recipe wrong = recipe(1, -1, 0, {});
  EXPECT_FALSE(check(wrong, log, places));
  ASSERT_EQ(log.entries().size(), 2u);
  EXPECT_EQ(log.entries()[0].where.begin, 1u);  // the height has no place of its own
  EXPECT_EQ(log.entries()[1].where.begin, 10u);

  DiagnosticLog second;
  wrong = recipe(1, 1, 10, {Random{-1}, Wrinkle{-1, kNan, 0, 0}, SlopeRms{-1}});
  EXPECT_FALSE(check(wrong, second, places));
  ASSERT_EQ(second.entries().size(), 5u);
  const std::uint32_t begins[] = {20, 30, 30, 30, 1};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(second.entries()[k].where.begin, begins[k]);
}

// Numbers at the ends of what is accepted make heights that are numbers.
TEST(Recipe, ExtremesStayFinite) {
  const double far = kMaxLength;
  Crease crease;
  crease.depth = far;
  crease.length = far;
  crease.density = 1e-19;
  crease.spread = 3;
  for (const double width : {1e-9, 1.0, 1e9})
    for (const std::uint32_t xgrid : {2u, 33u}) {
      Recipe one = recipe(width, width, xgrid, {});
      const double fine = std::max(2 * one.cell(), kMinLength);
      one.operations = {Random{far},
                        Constant{-far},
                        Wrinkle{fine, far, 1e6, 100},
                        Wrinkle{far, far, -1e6, 1},
                        crease,
                        Fractal{1e-6, far, far},
                        Fractal{1, far, fine},
                        Emboss{Pattern::quilt, fine, far},
                        Emboss{Pattern::diamond, fine, far},
                        Seam{true, 0, fine, far, fine, far},
                        Button{far, 0, kMinLength, far},
                        Crush{far, far},
                        Crush{fine, far},
                        Smooth{20}};
      const Sheet sheet = sheet_of(one);
      for (const double h : sheet.heights) ASSERT_TRUE(std::isfinite(h)) << width << " " << xgrid;
      ASSERT_TRUE(std::isfinite(sheet.statistics.slope_rms));
      ASSERT_TRUE(is_finite(sheet.statistics.mean_normal));
    }
}

TEST(Recipe, NumbersInsideTheirLimitsAreMade) {
  // one cell, one row of cells, one column
  EXPECT_EQ(sheet_of(recipe(1, 1, 1, {Random{1}, Smooth{3}})).heights.size(), 4u);
  EXPECT_EQ(sheet_of(recipe(1, 0.01, 100, {Random{1}, Smooth{3}})).rows, 2u);
  EXPECT_EQ(sheet_of(recipe(0.01, 1, 1, {Random{1}, Smooth{3}})).rows, 101u);
}

TEST(Recipe, ACancelledSheetIsNone) {
  DiagnosticLog log;
  const Job job({.threads = 1, .progress = {}});
  job.cancel();
  EXPECT_FALSE(made(everything(), {}, log, {}, job).ok());
  EXPECT_TRUE(log.contains(Code("E0001")));
}

TEST(Recipe, OperationsHaveNames) {
  EXPECT_EQ(name_of(Random{}), "random");
  EXPECT_EQ(name_of(SlopeRms{}), "slope_rms");
  EXPECT_EQ(name_of(Crease{}), "crease");
  EXPECT_EQ(name_of(Button{}), "button");
}

}  // namespace
}  // namespace panwright::mli::recipe_test
