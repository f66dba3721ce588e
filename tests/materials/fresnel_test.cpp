#include <gtest/gtest.h>

#include <complex>

#include <complex>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::fresnel_test {
namespace {

// Fresnel's equations as they stand in textbooks, with Snell's angle, in long double.
long double textbook(long double cos_i, long double index) {
  const std::complex<long double> cos_t =
      std::sqrt(std::complex<long double>(1 - (1 - cos_i * cos_i) / (index * index)));
  const auto rs = (cos_i - index * cos_t) / (cos_i + index * cos_t);
  const auto rp = (index * cos_i - cos_t) / (index * cos_i + cos_t);
  return (std::norm(rs) + std::norm(rp)) / 2;
}

// Average over the hemisphere, ∫ 2 F μ dμ. Walsh 1926, Duntley 1942.
double duntley(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
         2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

TEST(Fresnel, TextbookEverywhere) {
  double worst32 = 0, worst64 = 0, beside_total = 0;
  for (const double index : {0.3, 0.7, 0.999, 1.0, 1.001, 1.1, 1.33, 1.5, 1.7, 2.4, 4.2, 100.0})
    for (int i = 1; i <= 20000; ++i) {
      const double cos_i = i / 20000.0;
      const double f = f64::fresnel_dielectric(cos_i, index);
      // the edge of total reflection has an infinite slope
      double& worst = index < 1 ? beside_total : worst64;
      worst = std::max(worst, std::fabs(f - static_cast<double>(textbook(cos_i, index))));
      ASSERT_GE(f, 0);
      ASSERT_LE(f, 1);
      if (index < 1) continue;
      const float c = static_cast<float>(cos_i), n = static_cast<float>(index);
      const float g = f32::fresnel_dielectric(c, n);
      worst32 = std::max(worst32, std::fabs(static_cast<double>(g - textbook(c, n))));
      ASSERT_LE(g, 1.0f);
    }
  EXPECT_LE(worst64, 1e-13);
  EXPECT_LE(beside_total, 5e-13);  // measured 2.2e-13
  EXPECT_LE(worst32, 3.05e-7);     // measured 3.0e-7, at n = 4.2
}

TEST(Fresnel, ClosedFormValues) {
  const struct {
    double index, f0, f60, f80;
  } rows[] = {{1.5, 0.04, 0.08918671, 0.38770435},
              {1.33, 0.02005931, 0.05912560, 0.34691610},
              {1.7, 0.06721536, 0.12033507, 0.41171465},
              {2.4, 0.16955017, 0.20935126, 0.43323603}};
  for (const auto& row : rows) {
    const double f0 = std::pow((row.index - 1) / (row.index + 1), 2);
    EXPECT_NEAR(f64::fresnel_dielectric(1.0, row.index), f0, 1e-15);
    EXPECT_NEAR(f64::fresnel_dielectric(1.0, row.index), row.f0, 6e-9);  // digits of the table
    EXPECT_NEAR(f64::fresnel_dielectric(0.5, row.index), row.f60, 6e-9);
    EXPECT_NEAR(f64::fresnel_dielectric(std::cos(80 * kDegree), row.index), row.f80, 6e-9);
  }
  EXPECT_NEAR(f64::fresnel_dielectric(std::cos(85 * kDegree), 1.5), 0.61279965, 6e-9);
  EXPECT_NEAR(f64::fresnel_dielectric(std::cos(89 * kDegree), 1.5), 0.90418495, 6e-9);
}

TEST(Fresnel, HemisphericalAverage) {
  const auto nodes = gauss(64);
  for (const auto& [index, table] : {std::pair{1.33, 0.0659308493}, std::pair{1.5, 0.0917779593},
                                     std::pair{1.7, 0.1203200318}, std::pair{2.4, 0.2101813020}}) {
    // x = sqrt(μ) takes the edge at grazing out of the integrand
    double sum64 = 0, sum32 = 0;
    for (const auto& [x, w] : nodes) {
      const double mu = x * x;
      sum64 += w * 4 * x * mu * f64::fresnel_dielectric(mu, index);
      sum32 += w * 4 * x * mu *
               static_cast<double>(
                   f32::fresnel_dielectric(static_cast<float>(mu), static_cast<float>(index)));
    }
    EXPECT_NEAR(duntley(index), table, 1e-10);
    EXPECT_NEAR(sum64, duntley(index), 1e-13) << index;
    EXPECT_NEAR(sum32, duntley(index), 3e-7) << index;
  }
}

// p-polarised light passes a boundary whole at Brewster's angle: what is left is half of s.
TEST(Fresnel, Brewster) {
  for (const double index : {1.1, 1.5, 4.2}) {
    const double cos_b = 1 / std::sqrt(1 + index * index);
    const double rs = (1 - index * index) / (1 + index * index);
    EXPECT_NEAR(f64::fresnel_dielectric(cos_b, index), 0.5 * rs * rs, 1e-15);
  }
}

// ((n - 1)/(n + 1))² goes to 0 with n - 1 and keeps its digits.
TEST(Fresnel, VanishingBoundary) {
  for (const double excess : {0.0, 0x1p-52, 1e-12, 1e-6, 1e-3}) {
    const double index = 1 + excess;
    const double f0 = std::pow((index - 1) / (index + 1), 2);
    EXPECT_NEAR(f64::fresnel_dielectric(1.0, index), f0, 1e-14 * f0);
  }
  const float index = 1 + 0x1p-20f;
  const double f0 =
      std::pow((static_cast<double>(index) - 1) / (static_cast<double>(index) + 1), 2);
  EXPECT_NEAR(static_cast<double>(f32::fresnel_dielectric(1.0f, index)), f0, 6e-7 * f0);
  EXPECT_EQ(f32::fresnel_dielectric(0.0f, 1.0f), 0.0f);
}

TEST(Fresnel, LimitsAndMirrors) {
  EXPECT_EQ(f64::fresnel_dielectric(0.0, 1.5), 1.0);
  EXPECT_EQ(f64::fresnel_dielectric(0.3, 0.0), 1.0);  // no index: a mirror
  EXPECT_EQ(f64::fresnel_dielectric(0.1, 0.5), 1.0);  // total reflection
  EXPECT_EQ(f32::fresnel_dielectric(0.0f, 1.5f), 1.0f);
  f64::SurfaceFields s{};
  s.indices = {4.2, 2.77, 2.62};
  const auto rgb = f64::dielectric_fresnel(s, 1.0, 1.0);
  EXPECT_NEAR(rgb.x, 0.3787, 5e-5);
  EXPECT_NEAR(rgb.y, 0.2204, 5e-5);
  EXPECT_NEAR(rgb.z, 0.2003, 5e-5);
}

// Metals at 650, 550 and 450 nm: n and k, and what they reflect at 0 and 80 degrees and on average.
TEST(Fresnel, Conductors) {
  const struct {
    Vec3 n, k, f0, f80, mean;
  } rows[] = {{{1.5196, .96565, .53124},
               {7.6635, 6.4581, 5.0699},
               {.906598, .915240, .924240},
               {.832668, .861934, .896771},
               {.893559, .904850, .917204}},
              {{.16262, .14512, .13550},
               {4.0728, 3.19, 2.1997},
               {.963740, .949468, .911554},
               Vec3(0),
               {.961336, .948335, .915821}},
              {{.18299, .42108, 1.3734},
               {3.4242, 2.3459, 1.7704},
               {.944230, .776102, .373402},
               Vec3(0),
               {.942322, .785344, .411691}}};
  for (const auto& row : rows)
    for (int c = 0; c < 3; ++c) {
      const double n = row.n[c], k = row.k[c];
      EXPECT_NEAR(f64::fresnel_conductor(1.0, n, k), row.f0[c], 6e-7);
      if (row.f80[c] > 0) {
        EXPECT_NEAR(f64::fresnel_conductor(std::cos(80 * kDegree), n, k), row.f80[c], 6e-7);
      }
      double mean = 0;
      for (const auto& [x, w] : gauss(64))
        mean += w * 4 * x * x * x * f64::fresnel_conductor(x * x, n, k);
      EXPECT_NEAR(mean, row.mean[c], 6e-7);
    }
}

// Complex arithmetic as the textbooks have it; without k it is a dielectric.
TEST(Fresnel, ConductorAgainstComplexNumbers) {
  double worst64 = 0, worst32 = 0;
  for (const double n : {0.0625, 0.5, 1.0, 1.5, 4.25, 50.0})
    for (const double k : {0.0, 0x1p-20, 0.03125, 1.0, 7.0, 50.0})
      for (double mu = 1; mu > 1e-9; mu *= 0.93) {
        using Complex = std::complex<long double>;
        const long double c = mu;
        const Complex index2 = Complex(n, k) * Complex(n, k);
        const Complex q = std::sqrt(index2 - 1.0L + c * c);
        const auto want = static_cast<double>(
            0.5L * (std::norm((c - q) / (c + q)) + std::norm((index2 * c - q) / (index2 * c + q))));
        const double got = f64::fresnel_conductor(mu, n, k);
        const double single = static_cast<double>(f32::fresnel_conductor(
            static_cast<float>(mu), static_cast<float>(n), static_cast<float>(k)));
        worst64 = std::max(worst64, std::fabs(got - want));
        worst32 = std::max(worst32, std::fabs(single - want));
        if (k == 0 && n > 1) {
          EXPECT_NEAR(got, f64::fresnel_dielectric(mu, n), 2e-14) << n << mu;
        }
      }
  EXPECT_LE(worst64, 2e-15) << worst64;  // measured 8.9e-16
  EXPECT_LE(worst32, 6e-7) << worst32;   // measured 4.5e-7, towards grazing
}

}  // namespace
}  // namespace panwright::materials::fresnel_test
