#include "materials/hapke_h.h"

#include <gtest/gtest.h>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::hapke_h_test {
namespace {

constexpr std::array kAlbedos{0.0, 1e-9, 0.01, 0.1,    0.3,      0.5,
                              0.7, 0.9,  0.99, 0.9999, 1 - 1e-9, 1.0};

// Values computed elsewhere from Chandrasekhar's integral, to the digits given.
TEST(HapkeH, Table) {
  const struct {
    double w;
    std::array<double, 5> h;
  } rows[] = {{.30, {1.024805, 1.039875, 1.061147, 1.097559, 1.126844}},
              {.60, {1.055317, 1.091349, 1.145165, 1.245807, 1.335407}},
              {.90, {1.099678, 1.172143, 1.291434, 1.556034, 1.850099}},
              {.99, {1.126071, 1.224875, 1.399767, 1.848601, 2.472793}},
              {1.0, {1.136575, 1.247350, 1.450351, 2.012779, 2.907811}}};
  constexpr std::array kMu{.05, .10, .20, .50, 1.00};
  for (const auto& row : rows)
    for (std::size_t k = 0; k < kMu.size(); ++k)
      EXPECT_NEAR(hapke_h(kMu[k], row.w), row.h[k], 6e-7) << row.w << ' ' << kMu[k];
}

// H solves 1/H(x) = √(1 − w) + (w/2) ∫ t H(t)/(x + t) dt, and its mean is 2 (1 − √(1 − w))/w.
TEST(HapkeH, SolvesItsEquation) {
  const auto nodes = gauss(200);
  double equation = 0, mean = 0;
  for (const double w : kAlbedos) {
    if (w == 0) continue;
    const HapkeH h(w);
    double sum = 0;
    // t = s³: H has a branch point at 0
    for (const auto& [s, weight] : nodes) sum += weight * 3 * s * s * h(s * s * s);
    mean = std::max(mean, std::fabs(sum - 2 / (1 + std::sqrt(1 - w))));
    for (const double x : {1e-3, 0.1, 0.5, 1.0}) {
      double integral = 0;
      for (const auto& [s, weight] : nodes) {
        const double t = s * s * s;
        integral += weight * 3 * s * s * t * h(t) / (x + t);
      }
      equation = std::max(equation, std::fabs(h(x) * (std::sqrt(1 - w) + w / 2 * integral) - 1));
    }
  }
  EXPECT_LE(mean, 1e-14) << mean;          // measured 3.4e-15
  EXPECT_LE(equation, 1e-14) << equation;  // measured 2.3e-15
}

TEST(HapkeH, EndsOfItsRange) {
  for (const double w : kAlbedos) {
    EXPECT_EQ(hapke_h(0, w), 1);
    EXPECT_EQ(hapke_h(1e-300, w), 1);
    EXPECT_NEAR(hapke_h(1e-17, w), 1, 1e-15);
    double last = 1;
    for (const double x : {1e-18, 1e-9, 1e-3, 0.5, 1.0}) {
      EXPECT_GE(hapke_h(x, w), last);
      last = hapke_h(x, w);
    }
  }
  for (const double x : {0.0, 0.3, 1.0}) EXPECT_EQ(hapke_h(x, 0), 1);
  EXPECT_EQ(hapke_h(1, 2), hapke_h(1, 1));
}

// What shaders use, in double and in float, between and on the nodes, for every albedo.
TEST(HapkeH, FitsInDoubleAndFloat) {
  double worst = 0, worst32 = 0;
  for (int i = 0; i <= 200; ++i) {
    const double w = i <= 100 ? i * 0.01 : 1 - det::exp(-0.2 * (i - 100));
    const HFit fit = hapke_h_fit(w);
    const HapkeH exact(w);
    f64::SurfaceFields s{};
    s.hapke_h0 = fit.coefficients[0];
    s.hapke_h1 = fit.coefficients[1];
    s.hapke_h2 = fit.coefficients[2];
    s.hapke_h3 = fit.coefficients[3];
    s.hapke_h4 = fit.coefficients[4];
    s.hapke_h5 = fit.coefficients[5];
    s.hapke_h6 = fit.coefficients[6];
    s.hapke_h7 = fit.coefficients[7];
    f32::SurfaceFields s32{};
    s32.hapke_h0 = static_cast<float>(fit.coefficients[0]);
    s32.hapke_h1 = static_cast<float>(fit.coefficients[1]);
    s32.hapke_h2 = static_cast<float>(fit.coefficients[2]);
    s32.hapke_h3 = static_cast<float>(fit.coefficients[3]);
    s32.hapke_h4 = static_cast<float>(fit.coefficients[4]);
    s32.hapke_h5 = static_cast<float>(fit.coefficients[5]);
    s32.hapke_h6 = static_cast<float>(fit.coefficients[6]);
    s32.hapke_h7 = static_cast<float>(fit.coefficients[7]);
    double here = 0;
    for (int k = 0; k <= 300; ++k) {
      const float x = static_cast<float>(k * k / 90000.0);
      const double want = exact(static_cast<double>(x));
      here = std::max(here, std::fabs(f64::hapke_h_function(s, static_cast<double>(x)) / want - 1));
      worst32 = std::max(worst32,
                         std::fabs(static_cast<double>(f32::hapke_h_function(s32, x)) / want - 1));
    }
    EXPECT_LE(here, 1.01 * fit.error + 1e-14) << w;  // what it says of itself
    worst = std::max(worst, here);
  }
  EXPECT_LE(worst, 1.2e-6) << worst;    // measured 1.07e-6
  EXPECT_LE(worst32, 4e-6) << worst32;  // measured 2.7e-6
}

// What the reference renderer multiplies the fit by, between its nodes.
TEST(HapkeH, CorrectedFitsAreExact) {
  double worst = 0;
  for (const double w : {1e-6, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0}) {
    const HFit fit = hapke_h_fit(w);
    const HapkeH exact(w);
    const HapkeHCorrection correction(w, fit.coefficients);
    f64::SurfaceFields s{};
    Material m;
    m.diffuse_brdf = Hapke{.w = w};
    materials::fit(m);
    s = f64::surface_of(m);
    for (int k = 0; k <= 1000; ++k) {
      const double x = k * k * 1e-6;
      const double got = f64::hapke_h_function(s, x) * correction(x);
      worst = std::max(worst, std::fabs(got / exact(x) - 1));
    }
    // far in, and out of the range
    for (const double x : {0.0, 1e-12, 1e-7, 1.0, 1.5})
      EXPECT_NEAR(f64::hapke_h_function(s, std::min(x, 1.0)) * correction(x), exact(x), 1e-9 * 3);
  }
  std::printf("corrected H within %.1e\n", worst);
  EXPECT_LE(worst, 5e-10) << worst;  // measured 3e-10; the fit by itself 1.1e-6
}

}  // namespace
}  // namespace panwright::materials::hapke_h_test
