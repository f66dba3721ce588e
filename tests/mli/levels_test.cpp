// Levels of detail against what light does on their facets.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/mesh/strip.h"
#include "mli/levels.h"
#include "mli/preset.h"
#include "tests/mli/sheet_support.h"

namespace panwright::mli::levels_test {
namespace {

using testing::recipe;
using testing::sheet_of;

constexpr double kCrease = 30 * kDegree;

Sheet noise(double slope, std::uint32_t seed = 0, std::uint32_t cells = 256) {
  return sheet_of(recipe(1.28, 1.28, cells, {Random{1e-3}, Smooth{8}, SlopeRms{slope}}, seed));
}

// What a sheet sends from a far light to a far viewer, over what a plane does, with the normals
// that stand between its vertices: of Lambert's kind; and the share that the viewer sees of normals
// within 0.1 of the half vector.
struct FarLight {
  double lambert = 0, mirrored = 0;
};
FarLight far_light(const geometry::Mesh& mesh, const Vec3& l, const Vec3& v) {
  const Vec3 h = glm::normalize(l + v);
  FarLight sum;
  double plane = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 area = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a) / 2.0;
    plane += area.z;
    for (int k = 0; k < 3; ++k) {
      const Vec3 n = glm::normalize(mesh.normals[t[static_cast<std::size_t>(k)]] +
                                    mesh.normals[t[static_cast<std::size_t>((k + 1) % 3)]]);
      const double seen = std::max(glm::dot(area, v), 0.0) / 3;
      sum.lambert += std::max(glm::dot(n, l), 0.0) * seen;
      if (glm::length(n - h) < 0.1) sum.mirrored += seen;
    }
  }
  return {sum.lambert / (plane * l.z * v.z), sum.mirrored / (plane * v.z)};
}

Vec3 direction(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }

TEST(Levels, SlopesAreThoseOfTheFinest) {
  for (const auto& [slope, seed] : {std::pair{0.07, 1u}, {0.2, 2u}, {0.42, 3u}}) {
    const Sheet sheet = noise(slope, seed);
    DiagnosticLog log;
    auto flat = formed(sheet, Flat{}, log);
    ASSERT_TRUE(flat);
    geometry::compute_normals(*flat, kCrease);
    const Covariance fine = shaded_slopes(*flat);
    const auto levels = levels_of(sheet, Flat{}, kCrease, 1e9);
    // that of 32 cells is a small sample of slopes, and left out for one sheet
    ASSERT_GE(levels.size(), 2u);
    for (const Level& level : levels)
      // measured 0.0182 at most, at 0.2: normals are linear between vertices, here slopes are
      EXPECT_NEAR((level.slopes.xx + level.slopes.yy) / (fine.xx + fine.yy), 1, 0.025)
          << slope << " " << level.detail;
    EXPECT_DOUBLE_EQ(levels[0].detail, 0.01);
    EXPECT_DOUBLE_EQ(levels[1].detail, 0.02);
    EXPECT_EQ(levels[1].mesh.triangles.size(), 2u * 64 * 64);
  }
}

// Against the finest sheet's own, over seeds.
TEST(Levels, FarLightIsTheSameInTheMean) {
  constexpr std::uint32_t kSeeds = 24;
  const std::pair<Vec3, Vec3> ways[] = {{direction(0), direction(0)},
                                        {direction(0.78), direction(-0.78)},
                                        {direction(0.78), direction(0.78)},
                                        {direction(0.5), direction(-0.2)}};
  constexpr std::size_t kSides = 16;
  FarLight sums[3][4];  // finest, levels
  double sides[3][kSides] = {};
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    const Sheet sheet = noise(0.2, seed, 128);
    for (std::size_t k = 0; k < 3; ++k) {
      DiagnosticLog log;
      // also those that are too small a sample for one sheet
      const Similar coarse = k == 0 ? Similar{sheet, {}, 0} : similar(sheet, 128u >> k, kCrease);
      Sheet without = coarse.sheet;
      std::ranges::fill(without.heights, 0.0);
      auto mesh = formed(coarse.sheet, Flat{}, log), plane = formed(without, Flat{}, log);
      ASSERT_TRUE(mesh && plane);
      compute_normals(*mesh, *std::move(plane), kCrease, coarse.tilts);
      for (std::size_t way = 0; way < 4; ++way) {
        const FarLight light = far_light(*mesh, ways[way].first, ways[way].second);
        sums[k][way].lambert += light.lambert;
        sums[k][way].mirrored += light.mirrored;
      }
      for (std::size_t side = 0; side < kSides; ++side) {
        const double about = static_cast<double>(side) * 2 * kPi / kSides;
        const Vec3 l = glm::normalize(Vec3(std::cos(about), std::sin(about), 2));
        sides[k][side] += far_light(*mesh, l, Vec3(0, 0, 1)).mirrored;
      }
    }
  }
  for (std::size_t k = 1; k < 3; ++k)
    for (std::size_t way = 0; way < 4; ++way) {
      EXPECT_NEAR(sums[k][way].lambert / sums[0][way].lambert, 1, 0.01) << k << " " << way;
      // The third way mirrors nothing. Measured 0.005 and 0.035, of 24 seeds; without what is done
      // to normals, 0.075.
      if (way == 2) continue;
      EXPECT_NEAR(sums[k][way].mirrored / sums[0][way].mirrored, 1, k == 1 ? 0.02 : 0.05)
          << k << " " << way;
    }
  // Cells are cut along one diagonal, which nothing of the finest sheet follows: half vectors that
  // lean towards 16 sides. Measured 0.017 and 0.057.
  for (std::size_t k = 1; k < 3; ++k)
    for (std::size_t side = 0; side < kSides; ++side)
      EXPECT_NEAR(sides[k][side] / sides[0][side], 1, k == 1 ? 0.03 : 0.08) << k << " " << side;
}

// Where the finest is level, and in the mean: heights of a plane stay, whatever is enlarged.
TEST(Levels, EdgesStayWhereTheyAre) {
  const Sheet sheet = sheet_of(recipe(
      1.28, 0.64, 256, {Random{1e-3}, Smooth{4}, SlopeRms{0.2}, Taper{0.1, 0.2, 0.05, 0.1}}));
  const Sheet coarse = similar(sheet, 64, kCrease).sheet;
  for (std::uint32_t i = 0; i < coarse.columns; ++i) {
    EXPECT_EQ(coarse.at(i, 0), 0) << i;
    EXPECT_EQ(coarse.at(i, coarse.rows - 1), 0) << i;
  }
  for (std::uint32_t j = 0; j < coarse.rows; ++j) EXPECT_EQ(coarse.at(0, j), 0) << j;
  // and relief stands within
  EXPECT_GT(coarse.statistics.height_rms, sheet.statistics.height_rms);
}

TEST(Levels, ALevelSheetStaysLevel) {
  const auto levels =
      levels_of(sheet_of(recipe(1, 1, 128, {Constant{0.01}})), Flat{}, kCrease, 1e9);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[1].error, 0);
  for (const Vec3& p : levels[1].mesh.positions) EXPECT_EQ(p.z, 0.01);
}

TEST(Levels, HeightErrorIsTheLargestDifference) {
  Sheet fine = sheet_of(recipe(1, 1, 4, {Constant{0}}));
  Sheet coarse = sheet_of(recipe(1, 1, 2, {Constant{0}}));
  coarse.heights[4] = 1;  // the middle of 3 x 3
  // where the coarse triangles are 1 or 1/2, and the fine sheet is 0.25 elsewhere
  EXPECT_DOUBLE_EQ(height_error(fine, coarse), 1);
  fine.heights[2 * 5 + 2] = 1;
  EXPECT_DOUBLE_EQ(height_error(fine, coarse), 0.5);
  fine.heights[1 * 5 + 1] = -0.25;
  EXPECT_DOUBLE_EQ(height_error(fine, coarse), 0.75);
}

// Every form, as many levels as its outline allows, closed where it is.
TEST(Levels, OfForms) {
  const Sheet sheet = noise(0.1, 5);
  const Form forms[] = {Tube{0.15, 0.8, 0.05}, Cone{0.15, 0.05, 0.4, 0.02}, Disc{0.4, 0.03},
                        Box{{0.25, 0.2, 0.3}, 0.03}};
  for (const Form& form : forms) {
    const auto levels = levels_of(sheet, form, kCrease, 1e9);
    EXPECT_EQ(levels.size(), 2u) << form.index();
    DiagnosticLog log;
    const auto fine = formed(sheet, form, log);
    ASSERT_TRUE(fine);
    for (const Level& level : levels) {
      EXPECT_EQ(level.mesh.closed, fine->closed);
      EXPECT_EQ(level.mesh.normals.size(), level.mesh.positions.size());
      EXPECT_EQ(level.mesh.texcoords.size(), level.mesh.positions.size());
      EXPECT_GT(level.error, 0);
      EXPECT_LT(level.error, 0.03);
    }
  }
  // within a bound on vertices the finest is left out
  EXPECT_EQ(levels_of(sheet, Flat{}, kCrease, 12000).size(), 2u);
}

}  // namespace
}  // namespace panwright::mli::levels_test
