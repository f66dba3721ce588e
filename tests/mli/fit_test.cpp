// Recipes that are fitted to statistics, measured on sheets that the fit has not seen.

#include "mli/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mli/preset.h"
#include "tests/mli/sheet_support.h"

namespace panwright::mli::fit_test {
namespace {

using ::testing::HasSubstr;
using testing::recipe;
using testing::sheet_of;

Recipe preset(const char* name, std::uint32_t xgrid = 100) {
  return recipe(0.5, 0.5, xgrid, *preset_operations(name, 0.5), 1);
}

// Small creases and wrinkles: as high as long by many shares.
Recipe wrinkled() {
  Crease crease;
  crease.density = 8000;
  crease.depth = 0.001;
  crease.length = 0.02;
  Recipe out = preset("crinkled");
  out.operations = {crease, Wrinkle{0.1, 0.0012, 0.6, 2}, SlopeRms{0.2}};
  return out;
}

// Means over seeds from 5000 on, by a loop of its own.
struct Means {
  double slope = 0, correlation = 0, height = 0;
};
Means means_of(Recipe each, int sheets) {
  Means out;
  for (int i = 0; i < sheets; ++i) {
    each.seed = 5000 + static_cast<std::uint32_t>(i);
    const Statistics s = sheet_of(each).statistics;
    out.slope += s.slope_rms / sheets;
    out.correlation += (s.correlation_length.x + s.correlation_length.y) / 2 / sheets;
    out.height += s.height_rms / sheets;
  }
  return out;
}

TEST(Fit, ScaledSheetsAreSimilar) {
  for (const char* name : {"crinkled", "smooth", "quilted", "taped"}) {
    const Recipe one = preset(name);
    const Statistics a = sheet_of(one).statistics;
    const Statistics b = sheet_of(scaled(one, 0.25, false)).statistics;
    // powers of two: the same bits, but for what rounds densities; residual 2e-15
    EXPECT_NEAR(b.slope_rms, a.slope_rms, 1e-12) << name;
    EXPECT_NEAR(b.height_rms, a.height_rms / 4, 1e-12) << name;
    EXPECT_NEAR(b.correlation_length.x, a.correlation_length.x / 4, 1e-12) << name;
  }
}

TEST(Fit, OtherSeedsHaveWhatIsAsked) {
  DiagnosticLog log;
  const auto found =
      fit(preset("crinkled"), {.slope_rms = 0.12, .correlation = 0.02}, {.sheets = 48}, log);
  ASSERT_TRUE(found) << to_text(log);
  EXPECT_NEAR(found->fitted.correlation.mean, 0.02, 0.02 * 0.006);  // residual 0.1 %, 4 digits
  const Means others = means_of(found->recipe, 96);
  EXPECT_NEAR(others.slope, 0.12, 1e-9);
  // both means have errors of their own, 4.4 % and 3.1 %
  EXPECT_NEAR(others.correlation, 0.02, 3 * 1.23 * found->fitted.correlation.error(48));
  EXPECT_LT(found->fitted.correlation.error(48), 0.06 * 0.02);
  EXPECT_EQ(found->checked.first_seed, 49u);
}

TEST(Fit, WrinklesSetHeightBesideLength) {
  DiagnosticLog log;
  const Recipe start = wrinkled();
  const auto plain = fit(start, {.slope_rms = 0.15, .correlation = 0.03}, {.sheets = 32}, log);
  ASSERT_TRUE(plain) << to_text(log);
  // more of them: higher for the same length and slope
  const double wanted = plain->fitted.height_rms.mean * 1.3;
  const auto more = fit(start, {.slope_rms = 0.15, .correlation = 0.03, .height_rms = wanted},
                        {.sheets = 32}, log);
  ASSERT_TRUE(more) << to_text(log);
  EXPECT_NEAR(more->fitted.height_rms.mean, wanted, 0.012 * wanted);
  EXPECT_NEAR(more->fitted.correlation.mean, 0.03, 0.006 * 0.03);
  const Means others = means_of(more->recipe, 64);
  EXPECT_NEAR(others.height / wanted, 1,
              3 * 1.23 * more->fitted.height_rms.error(32) / more->fitted.height_rms.mean);
}

TEST(Fit, KeepsTheSheetWhereThatIsAsked) {
  DiagnosticLog log;
  const auto found =
      fit(wrinkled(), {.correlation = 0.025}, {.keep_size = true, .sheets = 16}, log);
  ASSERT_TRUE(found) << to_text(log);
  EXPECT_EQ(found->recipe.width, 0.5);
  EXPECT_GT(found->recipe.xgrid, 150u);
  EXPECT_NEAR(found->fitted.correlation.mean, 0.025, 0.006 * 0.025);
}

TEST(Fit, RefusesWhatNoSheetHas) {
  const struct {
    Recipe start;
    FitTarget target;
    bool keep;
    const char* message;
  } cases[] = {
      {preset("crinkled"), {}, false, "no statistic to fit"},
      {preset("crinkled"), {.slope_rms = 0}, false, "slope_rms is 0"},
      {preset("crinkled"), {.slope_rms = std::nan("")}, false, "slope_rms is nan"},
      {preset("quilted"),
       {.correlation = 0.02, .height_rms = 1e-3},
       false,
       "which the recipe lacks"},
      {preset("crinkled"),
       {.slope_rms = 0.1, .correlation = 0.02, .height_rms = 0.02},
       false,
       "for sheets of this kind and slope"},
      {preset("crinkled"), {.correlation = 2}, true, "the nearest found is"},
      {preset("crinkled"), {.correlation = 1e-5}, true, "cannot have a correlation length"},
  };
  for (const auto& each : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(fit(each.start, each.target, {.keep_size = each.keep, .sheets = 4}, log));
    EXPECT_THAT(to_text(log), HasSubstr("[E7001]")) << each.message;
    EXPECT_THAT(to_text(log), HasSubstr(each.message));
  }
}

}  // namespace
}  // namespace panwright::mli::fit_test
