// Matrices taken apart are put together again.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/scene.h"

namespace panwright::scene::decompose_test {
namespace {

double off(const Mat4& matrix, const Decomposed& parts) {
  const Mat4 again = parts.outer.matrix() * parts.inner.matrix();
  double worst = 0, size = 0;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) {
      worst = std::fmax(worst, std::fabs(again[k][i] - matrix[k][i]));
      size = std::fmax(size, std::fabs(matrix[k][i]));
    }
  EXPECT_EQ(Vec3(again[3]), Vec3(matrix[3]));
  return worst / size;
}

TEST(Decomposed, any_regular_matrix) {
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    Mat4 matrix(1);
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) matrix[k][i] = number() * std::exp2(n % 41 - 20);
    // columns of very different length, and nearly parallel ones
    if (n % 3 == 1) matrix[1] *= 1e-6;
    if (n % 3 == 2) matrix[1] = matrix[0] + matrix[1] * 1e-4;
    matrix[1].w = 0;
    const auto parts = decomposed(matrix);
    ASSERT_TRUE(parts) << n;
    EXPECT_NEAR(glm::length(parts->outer.rotation), 1, 1e-15);
    EXPECT_NEAR(glm::length(parts->inner.rotation), 1, 1e-15);
    worst = std::fmax(worst, off(matrix, *parts));
  }
  EXPECT_LE(worst, 1e-14);  // measured 5.1e-15
}

TEST(Decomposed, transforms_and_mirrors_need_one_node) {
  for (const Vec3& scale : {Vec3(1), Vec3(2, 3, 4), Vec3(-1, 1, 1), Vec3(-1, -2, -3)}) {
    const Mat4 matrix = matrix_from_trs({1, 2, 3}, quat_from_fixed_xyz({0.3, -1.2, 2.9}), scale);
    const auto parts = decomposed(matrix);
    ASSERT_TRUE(parts);
    EXPECT_FALSE(parts->sheared);
    EXPECT_LE(off(matrix, *parts), 1e-15);
  }
}

TEST(Decomposed, flat_and_foreign_matrices_are_refused) {
  Mat4 flat(1);
  flat[2] = flat[0] + flat[1];
  EXPECT_FALSE(decomposed(flat));
  EXPECT_FALSE(decomposed(Mat4(0)));
  Mat4 projective(1);
  projective[0].w = 0.1;
  EXPECT_FALSE(decomposed(projective));
  Mat4 infinite(1);
  infinite[3].x = INFINITY;
  EXPECT_FALSE(decomposed(infinite));
}

}  // namespace
}  // namespace panwright::scene::decompose_test
