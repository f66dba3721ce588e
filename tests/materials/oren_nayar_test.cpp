#include <gtest/gtest.h>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::oren_nayar_test {
namespace {

const Vec3 kNormal(0, 0, 1);

// Equations 27 and 28 of the paper from its angles, trigonometry as printed.
double by_angles(double rho, double sigma, double theta_i, double theta_r, double phi) {
  const double s2 = sigma * sigma;
  const double alpha = std::max(theta_i, theta_r), beta = std::min(theta_i, theta_r);
  const double c1 = 1 - 0.5 * s2 / (s2 + 0.33);
  const double c2 = 0.45 * s2 / (s2 + 0.09) *
                    (std::sin(alpha) - (std::cos(phi) >= 0 ? 0 : std::pow(2 * beta / kPi, 3)));
  const double c3 = 0.125 * s2 / (s2 + 0.09) * std::pow(4 * alpha * beta / (kPi * kPi), 2);
  const double l1 = c1 + std::cos(phi) * c2 * std::tan(beta) +
                    (1 - std::fabs(std::cos(phi))) * c3 * std::tan((alpha + beta) / 2);
  const double l2 = 0.17 * s2 / (s2 + 0.13) * (1 - std::cos(phi) * std::pow(2 * beta / kPi, 2));
  return rho / kPi * (std::max(l1, 0.0) + rho * l2);
}

double formula(double rho, double sigma, double theta_i, double theta_r, double phi) {
  return f64::oren_nayar(Vec3(rho), sigma, from_angles(theta_i, phi), from_angles(theta_r, 0),
                         kNormal)
      .x;
}

TEST(OrenNayar, EquationsOfThePaper) {
  double worst = 0;
  for (const double sigma : {0.05, 0.3, 0.7, 1.2})
    for (const double ti : {0.0, 1e-3, 0.1, 0.5, 1.0, 1.3, 1.5, 1.55})
      for (const double tr : {0.0, 1e-3, 0.1, 0.5, 1.0, 1.3, 1.5, 1.55})
        for (const double phi : {0.0, 1e-3, 0.4, 1.2, 1.7, 2.5, 3.1, kPi}) {
          const double want = by_angles(0.7, sigma, ti, tr, phi);
          worst = std::max(
              worst, std::fabs(formula(0.7, sigma, ti, tr, phi) - want) / std::max(want, 1e-3));
        }
  EXPECT_LE(worst, 2e-14) << worst;  // measured 4.2e-15
}

TEST(OrenNayar, SmoothSurfaceIsLambertToTheLastBit) {
  for (const auto& cases : {hard_cases::grid(), hard_cases::random_pairs(0, 1000)})
    for (const auto& c : cases) {
      const glm::vec3 color(0.8f, 0.3f, 0.0f);
      ASSERT_EQ(f32::oren_nayar(color, 0.0f, c.l, c.v, c.n), f32::lambert(color, c.l, c.v, c.n));
      ASSERT_EQ(f64::oren_nayar(Vec3(color), 0.0, Vec3(c.l), Vec3(c.v), Vec3(c.n)),
                f64::lambert(Vec3(color), Vec3(c.l), Vec3(c.v), Vec3(c.n)));
    }
}

double albedo(double rho, double sigma, double mu) {
  const Vec3 v = hard_cases::direction(mu, 0);
  return cosine_integral(
      [&](const Vec3& l) { return f64::oren_nayar(Vec3(rho), sigma, l, v, kNormal).x; }, 96);
}

// The fit of 1994 gains up to 4 % at grazing for white surfaces, so energy holds from 0.95 down.
TEST(OrenNayar, Energy) {
  double worst = 0;
  for (const double rho : {0.2, 0.5, 0.8, 0.95})
    for (const double sigma : {0.1, 0.2, 0.3, 0.5, 0.8, 1.2, kPi / 2})
      for (const double mu : {0.02, 0.05, 0.1, 0.3, 0.6, 1.0})
        worst = std::max(worst, albedo(rho, sigma, mu) - 1);
  EXPECT_LE(worst, 0);
  // its excess as measured elsewhere, to the digits given
  EXPECT_NEAR(albedo(1, 0.3, 0.02), 1.0435, 2e-4);
  EXPECT_NEAR(albedo(1, 0.1, 0.02), 1.0137, 2e-4);
}

TEST(OrenNayar, WhereTheFitIsNegativeItIsZero) {
  EXPECT_LT(by_angles(0, 1.4, 1.5, 1.5, kPi), 1e-300);
  EXPECT_GE(formula(0.5, 1.57, 1.56, 1.54, kPi), 0);
  EXPECT_EQ(f64::oren_nayar(Vec3(0.0), 1.4, from_angles(1.5, 0), from_angles(1.4, kPi), kNormal),
            Vec3(0));
}

}  // namespace
}  // namespace panwright::materials::oren_nayar_test
