#include <gtest/gtest.h>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials {
namespace {

const Vec3 kNormal(0, 0, 1);

double bidirectional(double i_deg, double e_deg, double psi_deg, double rough_deg) {
  const Vec3 l = from_angles(i_deg * kDegree, psi_deg * kDegree);
  const Vec3 v = from_angles(e_deg * kDegree, 0);
  return f64::hapke(0.21, 0.07, 1.0, rough_deg * kDegree, 0.25, 0.3, l, v, kNormal) * l.z;
}

// An independent computation of r, smooth and with 20° of roughness.
TEST(Hapke, Fixture) {
  const struct {
    double i, e, psi, smooth, rough;
  } rows[] = {{0, 0, 0, .028389201, .028307759},     {30, 0, 0, .014411100, .014334146},
              {30, 30, 180, .011100650, .011015635}, {60, 60, 0, .028056029, .028049027},
              {60, 60, 90, .009478504, .007681216},  {60, 30, 45, .009711536, .009262282},
              {80, 70, 120, .005458602, .002228484}, {85, 85, 180, .009465028, .000449654}};
  for (const auto& row : rows) {
    SCOPED_TRACE(testing::Message() << row.i << ' ' << row.e << ' ' << row.psi);
    EXPECT_NEAR(bidirectional(row.i, row.e, row.psi, 0), row.smooth, 6e-10);  // digits of the table
    EXPECT_NEAR(bidirectional(row.i, row.e, row.psi, 20), row.rough, 6e-10);
  }
}

// Isotropic particles without opposition: the plane albedo is 1 - sqrt(1 - w) H(μ), exactly, with
// Chandrasekhar's H; the approximate one of 2002 is within 1 % of it.
TEST(Hapke, PlaneAlbedo) {
  const struct {
    double w, mu, albedo;
  } rows[] = {{.9, .1, .62933582}, {.9, .5, .50793891}, {.9, 1, .41494748},
              {.6, .1, .30977055}, {.6, .5, .21208237}, {.6, 1, .15541466}};
  for (const auto& row : rows) {
    const Vec3 v = hard_cases::direction(row.mu, 0);
    const double got = cosine_integral(
        [&](const Vec3& l) { return f64::hapke(row.w, 0.0, 0.0, 0.0, 0.0, 0.0, l, v, kNormal); },
        64);
    // measured 7.4e-3
    EXPECT_NEAR(got, row.albedo, 0.012) << row.w << ' ' << row.mu;
  }
  // a white one keeps nearly all
  for (const auto& [mu, albedo] :
       {std::pair{0.1, .991}, std::pair{0.5, .987}, std::pair{1.0, .986}}) {
    const Vec3 v = hard_cases::direction(mu, 0);
    EXPECT_NEAR(
        cosine_integral(
            [&](const Vec3& l) { return f64::hapke(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, l, v, kNormal); },
            64),
        albedo, 6e-4);
  }
}

TEST(Hapke, HFunctionIsNearChandrasekhar) {
  const struct {
    double w;
    std::array<double, 5> h;
    double bound;  // of the approximation
  } rows[] = {{.30, {1.024805, 1.039875, 1.061147, 1.097559, 1.126844}, .0050},
              {.60, {1.055317, 1.091349, 1.145165, 1.245807, 1.335407}, .0050},
              {.90, {1.099678, 1.172143, 1.291434, 1.556034, 1.850099}, .0076},
              {.99, {1.126071, 1.224875, 1.399767, 1.848601, 2.472793}, .0097},
              {1.0, {1.136575, 1.247350, 1.450351, 2.012779, 2.907811}, .0078}};
  constexpr std::array kMu{.05, .10, .20, .50, 1.00};
  for (const auto& row : rows)
    for (std::size_t k = 0; k < kMu.size(); ++k)
      EXPECT_NEAR(f64::hapke_h_function(kMu[k], row.w) / row.h[k], 1, row.bound)
          << row.w << ' ' << kMu[k];
}

// The phase function has mean 1 over all directions whatever its asymmetry.
TEST(Hapke, PhaseFunctionIsNormalised) {
  for (const double b : {0.0, 0.25, 0.6, 0.9})
    for (const double c : {-1.0, 0.3, 1.0}) {
      double sum = 0;
      for (const auto& [x, w] : gauss(200)) {
        const double minus2 = 4 * x;  // 2 (1 - cos g), uniform over the sphere
        sum += w * f64::hapke_phase(b, c, minus2, 4 - minus2);
      }
      EXPECT_NEAR(sum, 1, 1e-12) << b << ' ' << c;
    }
  EXPECT_GT(f64::hapke_phase(0.5, 1.0, 0.0, 4.0), f64::hapke_phase(0.5, 1.0, 4.0, 0.0));
}

// B0/(1 + tan(g/2)/h): half its height where tan(g/2) = h, gone in forward scattering.
TEST(Hapke, OppositionSurge) {
  const double h = 0.07;
  const auto f = [&](double b0, double phase) {
    return f64::hapke(0.3, h, b0, 0.0, 0.0, 0.0, from_angles(phase, 0), kNormal, kNormal);
  };
  const double lommel = 0.3 / (4 * kPi) / 2;
  EXPECT_NEAR(f(1, 0) - f(0, 0), lommel, 1e-15);
  const double g = 2 * std::atan(h);
  EXPECT_NEAR((f(1, g) - f(0, g)) / (0.3 / (4 * kPi) / (1 + std::cos(g))), 0.5, 1e-13);
}

// Rough surfaces are continuous where angles vanish: the limits that public code gets wrong.
TEST(Hapke, RoughnessIsContinuousAtTheNormalAndInPlane) {
  const auto f = [](double i, double e, double psi) {
    return f64::hapke(0.3, 0.1, 1.0, 0.4, 0.0, 0.0, from_angles(i, psi), from_angles(e, 0),
                      kNormal);
  };
  // measured 2.0e-12, 7.8e-16, 5.1e-13, 2.4e-15
  EXPECT_NEAR(f(1e-9, 0.7, 1.0), f(0, 0.7, 0), 1e-11);
  EXPECT_NEAR(f(0.5, 0.7, kPi - 1e-9), f(0.5, 0.7, kPi), 1e-14);
  EXPECT_NEAR(f(0.5, 0.5 + 1e-10, 2.0), f(0.5, 0.5 - 1e-10, 2.0), 5e-12);
  // as roughness goes to 0 the smooth surface comes back
  EXPECT_NEAR(
      f64::hapke(0.3, 0.1, 1.0, 1e-6, 0.0, 0.0, from_angles(0.5, 1), from_angles(0.9, 0), kNormal),
      f64::hapke(0.3, 0.1, 1.0, 0.0, 0.0, 0.0, from_angles(0.5, 1), from_angles(0.9, 0), kNormal),
      1e-14);
}

}  // namespace
}  // namespace panwright::materials
