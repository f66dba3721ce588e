#include "mli/preset.h"

#include <gtest/gtest.h>

#include <set>

#include "mli/sheet.h"

namespace panwright::mli::preset_test {
namespace {

Recipe recipe_of(const Preset& preset, double width, double height) {
  Recipe recipe;
  recipe.width = width;
  recipe.height = height;
  recipe.xgrid = static_cast<std::uint32_t>(std::ceil(width / preset.cell));
  recipe.operations = *preset_operations(preset.name, height);
  return recipe;
}

constexpr double kSpread = 0.1;

TEST(Presets, CanBeMadeAtAnySizeOfASpacecraft) {
  for (const Preset& preset : presets())
    for (const double width : {0.05, 0.5, 3.0, 12.0})
      for (const double height : {0.05, 0.7, 11.0}) {
        DiagnosticLog log;
        EXPECT_TRUE(check(recipe_of(preset, width, height), log))
            << preset.name << " " << width << " x " << height << ": " << to_text(log);
      }
  EXPECT_FALSE(preset_operations("crinkle", 1));
}

// Another size is the same foil, and another seed another sheet of the same kind: slopes stay
// within what a square metre leaves to chance.
TEST(Presets, SlopesAreTheirOwnWhateverTheSize) {
  for (const Preset& preset : presets()) {
    std::vector<double> slopes;
    std::set<std::uint64_t> sums;
    for (const double side : {0.6, 1.4})
      for (const std::uint32_t seed : {1u, 2u}) {
        Recipe recipe = recipe_of(preset, side, side);
        recipe.seed = seed;
        DiagnosticLog log;
        const auto sheet = made(recipe, {}, log);
        ASSERT_TRUE(sheet) << to_text(log);
        slopes.push_back(sheet->statistics.slope_rms);
        sums.insert(checksum(sheet->heights));
      }
    EXPECT_EQ(sums.size(), 4u) << preset.name;
    for (const double slope : slopes) {
      EXPECT_NEAR(slope / slopes[0], 1, kSpread) << preset.name;
      EXPECT_GT(slope, 0.04) << preset.name;
      EXPECT_LT(slope, 0.35) << preset.name;
    }
  }
}

}  // namespace
}  // namespace panwright::mli::preset_test
