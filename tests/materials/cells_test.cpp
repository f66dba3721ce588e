#include "materials/cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::cells_test {
namespace {

// What is at one point, by comparisons alone.
Vec3 part_at(const Cells& cells, const Vec2& texcoord) {
  const Vec2 at = texcoord * cells.count;
  const Vec2 in(at.x - std::floor(at.x), at.y - std::floor(at.y));
  for (int axis = 0; axis < 2; ++axis)
    if (in[axis] < cells.gap[axis] / 2 || in[axis] >= 1 - cells.gap[axis] / 2) return {0, 0, 1};
  if (cells.fingers == 0) return {1, 0, 0};
  const double place = (in.x - cells.gap.x / 2) / (1 - cells.gap.x) * cells.fingers;
  const double from_middle = std::fabs(place - std::floor(place) - 0.5);
  return from_middle < cells.finger_width / 2 ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
}

// The mean of a box, by points.
Vec3 by_points(const Cells& cells, const Vec2& middle, const Vec2& size, int side) {
  Vec3 sum(0);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      sum += part_at(cells, middle + size * (Vec2(x + 0.5, y + 0.5) / double(side) - 0.5));
  return sum / double(side * side);
}

Vec3 by_formula(const Cells& cells, const Vec2& middle, const Vec2& size) {
  const CellShares shares = cells_at(cells, middle, size);
  return {shares.cell, shares.finger, shares.gap};
}

const Cells kPanels[] = {
    {.count = {1, 1}, .gap = {0.1, 0.2}},
    {.count = {3, 7}, .gap = {0.03, 0.05}, .fingers = 8, .finger_width = 0.1},
    {.count = {2.5, 4}, .gap = {0, 0.5}, .fingers = 3, .finger_width = 0.9},
    {.count = {12, 26}, .gap = {0.04, 0.04}, .fingers = 40, .finger_width = 0.03},
    {.count = {1, 1}, .gap = {0.9, 0}, .fingers = 1, .finger_width = 0.5},
};

TEST(Cells, PointsAreWhatTheyAre) {
  hard_cases::Uniform uniform(3);
  for (const Cells& cells : kPanels)
    for (int i = 0; i < 2000; ++i) {
      const Vec2 at = Vec2(uniform(), uniform()) * 4.0 - 2.0;
      // away from edges by more than the least footprint
      const Vec3 want = part_at(cells, at);
      bool same = true;
      for (const double d : {-1e-4, 1e-4})
        same = same && part_at(cells, at + Vec2(d, 0) / cells.count) == want &&
               part_at(cells, at + Vec2(0, d) / cells.count) == want;
      if (!same) continue;
      const Vec3 got = by_formula(cells, at, Vec2(0));
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(got[k], want[k], 1e-10);
    }
}

TEST(Cells, BoxesAreMeansOfPoints) {
  hard_cases::Uniform uniform(4);
  double worst = 0;
  for (const Cells& cells : kPanels)
    for (int i = 0; i < 60; ++i) {
      const Vec2 at = Vec2(uniform(), uniform()) * 3.0 - 1.0;
      const Vec2 size =
          Vec2(std::pow(10, -2.5 * uniform()), std::pow(10, -2.5 * uniform())) * 2.0 / cells.count;
      const Vec3 difference =
          glm::abs(by_formula(cells, at, size) - by_points(cells, at, size, 700));
      worst = std::max({worst, difference.x, difference.y, difference.z});
    }
  EXPECT_LE(worst, 0.01)
      << worst;  // measured 0.0082, the points' own error: edges over 1/700 of a box
}

// Boxes side by side over a panel have the panel's mean, (1 − gap)² less the grid lines, at any
// size.
TEST(Cells, MeanOverAPanel) {
  double worst = 0;
  for (const Cells& cells : kPanels)
    for (const int boxes : {1, 3, 10, 37, 256}) {
      // whole cells: twice the panel where a half is over
      const Vec2 extent = Vec2(2);
      Vec3 sum(0);
      for (int y = 0; y < boxes; ++y)
        for (int x = 0; x < boxes; ++x)
          sum += by_formula(cells, extent * Vec2(x + 0.5, y + 0.5) / double(boxes),
                            extent / double(boxes));
      sum /= double(boxes * boxes);
      const double covered = (1 - cells.gap.x) * (1 - cells.gap.y);
      const double lines = cells.fingers > 0 ? covered * cells.finger_width : 0;
      worst = std::max({worst, std::fabs(sum.x - (covered - lines)), std::fabs(sum.y - lines),
                        std::fabs(sum.z - (1 - covered))});
    }
  EXPECT_LE(worst, 1e-12) << worst;  // measured 3.1e-13
}

TEST(Cells, SharesAddUpAndStayInRange) {
  hard_cases::Uniform uniform(5);
  for (const Cells& cells : kPanels)
    for (int i = 0; i < 5000; ++i) {
      const Vec2 at = (Vec2(uniform(), uniform()) - 0.5) * std::pow(10, 6 * uniform());
      const Vec2 size = Vec2(uniform(), uniform()) * std::pow(10, 9 * uniform() - 6);
      const Vec3 got = by_formula(cells, at, size);
      ASSERT_NEAR(got.x + got.y + got.z, 1, 1e-15);
      for (int k = 0; k < 3; ++k) {
        ASSERT_GE(got[k], 0);
        ASSERT_LE(got[k], 1);
      }
    }
  // a far panel is its mean: what is left of the pattern falls with the footprint
  const Vec3 far = by_formula(kPanels[3], {0.3, 0.7}, Vec2(1000));
  EXPECT_NEAR(far.z, 1 - 0.96 * 0.96, 1e-5);
}

TEST(Cells, PartsAreMaterials) {
  Material panel;
  panel.specular_brdf = CookTorrance{};
  panel.specular = Vec3(0.5);
  panel.weights = {0, 1, 0};
  panel.coat = Coat{};
  panel.cells = kPanels[1];
  fit(panel);
  const auto [cell, finger, gap] = cell_parts(panel);
  EXPECT_EQ(brdf_model_of(cell), brdf_model_of(panel));
  EXPECT_EQ(brdf_model_of(finger), (BrdfModel{.coated = true}));
  EXPECT_EQ(brdf_model_of(gap), BrdfModel{});
  EXPECT_EQ(gap.diffuse, panel.cells->gap_color);
  EXPECT_EQ(finger.diffuse, panel.cells->finger_color);
  EXPECT_EQ(gap.weights, Vec3(1, 0, 0));
}

}  // namespace
}  // namespace panwright::materials::cells_test
