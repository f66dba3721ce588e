#include "light/ground_shine.h"

#include <gtest/gtest.h>

namespace panwright::light::ground_shine_test {
namespace {

TEST(GroundShine, OctahedronThereAndBack) {
  constexpr int kSteps = 40;
  double worst = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      const Vec2 place((2 * i + 1.0) / kSteps - 1, (2 * j + 1.0) / kSteps - 1);
      const Vec3 direction = octahedron_direction(place);
      worst = std::max(worst, glm::length(octahedron_place(3.0 * direction) - place));
    }
  EXPECT_LT(worst, 1e-15);  // measured: 1.6e-16
  EXPECT_EQ(octahedron_direction({0, 0}), Vec3(0, 0, 1));
  EXPECT_EQ(octahedron_direction({1, 0}), Vec3(1, 0, 0));
  EXPECT_EQ(octahedron_direction({-1, 1}), Vec3(0, 0, -1));
}

TEST(GroundShine, HidesByTexelsOrCaps) {
  GroundShine shine;
  EXPECT_FALSE(shine.hides({0, 0, -1}));
  shine.caps.push_back({Vec3(0, 0, -1), std::cos(0.2)});
  EXPECT_TRUE(shine.hides({std::sin(0.19), 0, -std::cos(0.19)}));
  EXPECT_FALSE(shine.hides({std::sin(0.21), 0, -std::cos(0.21)}));
  // texels count before caps
  shine.is_ground.assign(GroundShine::kSide * GroundShine::kSide, 0);
  EXPECT_FALSE(shine.hides({0, 0, -1}));
  constexpr int kColumn = 50, kRow = 20;
  shine.is_ground[kRow * GroundShine::kSide + kColumn] = 1;
  const auto direction = [](int column, int row) {
    return glm::normalize(octahedron_direction(
        {(2 * column + 1.0) / GroundShine::kSide - 1, (2 * row + 1.0) / GroundShine::kSide - 1}));
  };
  EXPECT_TRUE(shine.hides(direction(kColumn, kRow)));
  EXPECT_FALSE(shine.hides(direction(kColumn + 1, kRow)));
  EXPECT_FALSE(shine.hides(direction(kColumn, kRow - 1)));
}

}  // namespace
}  // namespace panwright::light::ground_shine_test
