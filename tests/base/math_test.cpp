#include "base/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/hash.h"
#include "base/parallel.h"

namespace panwright::math_test {
namespace {

// distance in units in the last place of b
double ulps(double a, double b) {
  if (a == b) return 0;
  return std::abs(a - b) / (std::nextafter(std::abs(b), 1e308) - std::abs(b));
}

TEST(Det, AgreesWithTheLongDoubleLibrary) {
  double worst = 0;
  for (int i = -4000; i <= 4000; ++i) {
    const double x = i * 0.0137 + 1e-5;
    worst = std::max(worst, ulps(det::sin(x), static_cast<double>(sinl(x))));
    worst = std::max(worst, ulps(det::cos(x), static_cast<double>(cosl(x))));
    worst = std::max(worst, ulps(det::sincos(x).sin, static_cast<double>(sinl(x))));
    worst = std::max(worst, ulps(det::tan(x), static_cast<double>(tanl(x))));
    worst = std::max(worst, ulps(det::exp(x), static_cast<double>(expl(x))));
    worst = std::max(worst, ulps(det::log(std::abs(x)), static_cast<double>(logl(std::abs(x)))));
    worst = std::max(worst,
                     ulps(det::pow(std::abs(x), 2.4),
                          static_cast<double>(powl(std::abs(x), static_cast<long double>(2.4)))));
    worst = std::max(worst, ulps(det::atan2(x, 0.7), static_cast<double>(atan2l(x, 0.7))));
  }
  RecordProperty("worst_ulp", std::to_string(worst));
  EXPECT_LE(worst, 1.0);
}

// Bits fixed once: they may depend on nothing, neither compiler nor processor nor optimisation.
TEST(Det, GivesTheSameBitsEverywhere) {
  Hasher hasher;
  for (int i = 0; i < 5000; ++i) {
    const double x = -30 + i * 0.01237;
    for (const double y : {det::sin(x), det::cos(x), det::exp(x), det::pow(2.5, x)})
      hasher.update(std::as_bytes(std::span(&y, 1)));
  }
  EXPECT_EQ(hasher.digest128().hex(), "cc2141cbddfb08e9b8f53d761cfa255c");
}

TEST(AngleBetween, IsAccurateNearZeroAndPi) {
  EXPECT_NEAR(angle_between({1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-24);
  EXPECT_NEAR(kPi - angle_between({1, 0, 0}, {-1, 1e-9, 0}), 1e-9, 5e-16);
  EXPECT_NEAR(angle_between({0, 2, 0}, {0, 0, 3}), kPi / 2, 1e-16);
}

TEST(QuatFromFixedXyz, IsRzRyRx) {
  const Vec3 a(0.3, -0.8, 2.1);
  const auto rx = Mat3(1, 0, 0, 0, std::cos(a.x), std::sin(a.x), 0, -std::sin(a.x), std::cos(a.x));
  const auto ry = Mat3(std::cos(a.y), 0, -std::sin(a.y), 0, 1, 0, std::sin(a.y), 0, std::cos(a.y));
  const auto rz = Mat3(std::cos(a.z), std::sin(a.z), 0, -std::sin(a.z), std::cos(a.z), 0, 0, 0, 1);
  const Mat3 expected = rz * ry * rx;
  const Mat3 got = glm::mat3_cast(quat_from_fixed_xyz(a));
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(got[c][r], expected[c][r], 4e-16);
}

TEST(Cofactor, KeepsNormalsPerpendicularEvenWhenSingular) {
  const Mat3 flat(1, 0, 0, 0, 2, 0, 0, 0, 0);  // squashes z
  const Vec3 n = cofactor(flat) * Vec3(0, 0, 1);
  EXPECT_EQ(n, Vec3(0, 0, 2));
  const Mat3 m(1, 0.2, 0, -0.4, 3, 1, 0.1, 0, -2);
  const Vec3 t1(1, 2, 3), t2(-1, 0.5, 0.2);
  const Vec3 normal = cofactor(m) * glm::cross(t1, t2);
  EXPECT_NEAR(glm::dot(normal, m * t1), 0, 1e-14);
  EXPECT_NEAR(glm::dot(normal, m * t2), 0, 1e-14);
}

TEST(MatrixFromTrs, AppliesScaleFirst) {
  const Mat4 m = matrix_from_trs({1, 2, 3}, quat_from_fixed_xyz({0, 0, kPi / 2}), {2, 3, 4});
  const Vec4 p = m * Vec4(1, 1, 1, 1);
  EXPECT_NEAR(p.x, 1 - 3, 1e-15);
  EXPECT_NEAR(p.y, 2 + 2, 1e-15);
  EXPECT_NEAR(p.z, 3 + 4, 1e-15);
}

TEST(Hasher, PiecesGiveTheHashOfTheWhole) {
  std::string text(100000, 'a');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 7 + i / 251);
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  Hasher hasher;
  for (std::size_t i = 0, step = 1; i < bytes.size(); step = step * 3 % 1009 + 1) {
    const std::size_t n = std::min(step, bytes.size() - i);
    hasher.update(bytes.subspan(i, n));
    i += n;
  }
  EXPECT_EQ(hasher.digest64(), hash64(bytes));
  EXPECT_EQ(hasher.digest128(), hash128(bytes));
}

TEST(ParallelFor, VisitsEachIndexOnce) {
  for (const std::size_t threads : {1, 2, 7}) {
    std::vector<int> visits(10007);
    parallel_for(
        visits.size(), [&](std::size_t i) { ++visits[i]; }, Job({threads, {}}));
    EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](int v) { return v == 1; }));
  }
}

TEST(Math, StretchIsThatOfTheScales) {
  // by construction: rotations change no singular value
  std::mt19937 random(2);
  const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const Quat a = quat_from_fixed_xyz({3 * uniform(), 3 * uniform(), 3 * uniform()});
    const Quat b = quat_from_fixed_xyz({3 * uniform(), 3 * uniform(), 3 * uniform()});
    const Vec3 scale(det::exp(9 * uniform()), -det::exp(9 * uniform()), det::exp(9 * uniform()));
    const Mat4 m = matrix_from_trs({1e9, -3, 5}, a, scale) * glm::mat4_cast(b);
    const Stretch found = stretch_of(m);
    const Vec3 sizes = glm::abs(scale);
    const double high = std::max({sizes.x, sizes.y, sizes.z});
    const double low = std::min({sizes.x, sizes.y, sizes.z});
    worst = std::max(worst, std::fabs(found.largest / high - 1));
    // the smallest is known to what rounding the matrix leaves of it
    worst = std::max(worst, std::fabs(found.smallest - low) / high);
  }
  EXPECT_LT(worst, 3e-15);  // measured 1.1e-15
}

TEST(Math, StretchOfHardMatrices) {
  const auto scaled = [](double x, double y, double z) {
    return stretch_of(matrix_from_trs(Vec3(0), {1, 0, 0, 0}, {x, y, z}));
  };
  EXPECT_EQ(scaled(1, 1, 1).smallest, 1);
  EXPECT_EQ(scaled(1, 1, 1).largest, 1);
  EXPECT_EQ(scaled(1e200, 1e-200, -3).largest, 1e200);  // squares would overflow
  EXPECT_EQ(scaled(1e200, 1e200, 1e150).smallest, 1e150);
  EXPECT_EQ(scaled(1e-300, 1e-300, 1e-300).largest, 1e-300);
  EXPECT_EQ(scaled(0, 0, 0).largest, 0);
  EXPECT_EQ(scaled(2, 0, 3).smallest, 0);
  // a shear: the singular values of [1 1; 0 1] are the golden ratio and its inverse
  Mat4 shear(1);
  shear[1][0] = 1;
  EXPECT_NEAR(stretch_of(shear).largest, (1 + std::sqrt(5.0)) / 2, 4e-16);  // measured 0
  EXPECT_NEAR(stretch_of(shear).smallest, (std::sqrt(5.0) - 1) / 2, 4e-16);
}

}  // namespace
}  // namespace panwright::math_test
