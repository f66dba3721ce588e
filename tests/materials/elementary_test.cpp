// The elementary functions of formulas/common.glsl against the standard library in long double.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/hard_cases.h"

namespace panwright::materials::elementary_test {
namespace {

// the largest relative error over a sweep of decades, in units of epsilon
template <class Real>
double worst_epsilons(Real (*function)(Real), long double (*reference)(long double), double least,
                      double most) {
  long double worst = 0;
  for (double x = least; x < most; x *= 1.00071) {
    const Real argument = static_cast<Real>(x);
    const long double want = reference(argument);
    worst = std::max(worst, std::fabs(function(argument) - want) / std::fabs(want));
  }
  return static_cast<double>(worst / std::numeric_limits<Real>::epsilon());
}

TEST(Elementary, WithinAFewUlp) {
  const auto exp_of = [](long double x) { return std::exp(-x); };
  const auto rise = [](long double x) { return -std::expm1(-x); };
  const auto log_of = [](long double x) { return std::log1p(x); };
  const auto tan_of = [](long double x) { return std::tan(x); };
  EXPECT_LE(worst_epsilons<float>(f32::exp_negative, exp_of, 1e-8, 80), 1.5);
  EXPECT_LE(worst_epsilons<double>(f64::exp_negative, exp_of, 1e-17, 80), 1.5);
  EXPECT_LE(worst_epsilons<float>(f32::one_minus_exp, rise, 1e-8, 200), 1.5);
  EXPECT_LE(worst_epsilons<double>(f64::one_minus_exp, rise, 1e-17, 200), 1.5);
  EXPECT_LE(worst_epsilons<float>(f32::log_one_plus, log_of, 1e-8, 1e38), 2.5);
  EXPECT_LE(worst_epsilons<double>(f64::log_one_plus, log_of, 1e-17, 1e38), 2.5);
  EXPECT_LE(worst_epsilons<float>(f32::tangent, tan_of, 1e-8, 1.5), 20);    // measured 16, at 1.5
  EXPECT_LE(worst_epsilons<double>(f64::tangent, tan_of, 1e-17, 1.5), 20);  // 12
}

TEST(Elementary, ExponentialEndsAtEighty) {
  EXPECT_EQ(f32::exp_negative(0.0f), 1.0f);
  EXPECT_EQ(f64::exp_negative(0.0), 1.0);
  EXPECT_GT(f32::exp_negative(79.99f), 0.0f);
  EXPECT_EQ(f32::exp_negative(80.0f), 0.0f);
  EXPECT_EQ(f32::exp_negative(std::numeric_limits<float>::infinity()), 0.0f);
  EXPECT_EQ(f64::one_minus_exp(std::numeric_limits<double>::infinity()), 1.0);
}

// angle_of against atan2, all ratios
TEST(Elementary, AngleOfSineAndCosine) {
  double worst32 = 0, worst64 = 0;
  for (double x = 1e-12; x < 1e12; x *= 1.0007) {
    for (const auto& [s, c] : {std::pair{x, 1.0}, std::pair{1.0, x}, std::pair{0.37 * x, 0.91}}) {
      const long double want = std::atan2(static_cast<long double>(s), static_cast<long double>(c));
      worst64 =
          std::max(worst64, static_cast<double>(std::fabs(f64::angle_of(s, c) - want) / want));
      const float sf = static_cast<float>(s), cf = static_cast<float>(c);
      const long double want32 =
          std::atan2(static_cast<long double>(sf), static_cast<long double>(cf));
      worst32 = std::max(worst32,
                         static_cast<double>(std::fabs(f32::angle_of(sf, cf) - want32) / want32));
    }
  }
  EXPECT_LE(worst32, 4e-7);   // measured 3.3e-7
  EXPECT_LE(worst64, 8e-16);  // 6.8e-16
  EXPECT_EQ(f32::angle_of(0.0f, 1.0f), 0.0f);
  EXPECT_EQ(f32::angle_of(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(f32::angle_of(1.0f, 0.0f), static_cast<float>(kPi / 2));
}

}  // namespace
}  // namespace panwright::materials::elementary_test
