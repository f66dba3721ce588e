// Every formula over the grid of hard cases: finite, not negative, reciprocal, and f32 near f64.
#include "tests/support/hard_cases.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "materials/brdf.h"

namespace panwright::hard_cases::hard_cases_test {
namespace {

std::string described(const Formula& formula, const Worst& worst) {
  const Inputs& c = formula.cases[worst.at];
  char text[400];
  std::snprintf(text, sizeof text,
                "%s: %.3g (%zu cases, %zu bad), worst at l=(%.9g %.9g %.9g) v=(%.9g %.9g %.9g) "
                "p=%g %g %g %g",
                formula.name.c_str(), worst.error, formula.cases.size(), worst.bad,
                static_cast<double>(c.l.x), static_cast<double>(c.l.y), static_cast<double>(c.l.z),
                static_cast<double>(c.v.x), static_cast<double>(c.v.y), static_cast<double>(c.v.z),
                static_cast<double>(c.p[0]), static_cast<double>(c.p[1]),
                static_cast<double>(c.p[2]), static_cast<double>(c.p[3]));
  return text;
}

// bounds a little above what was measured (the number behind each)
const struct {
  const char* name;
  double bound;
} kBounds[] = {{"exp_negative", 2e-7},        // 1.6e-7
               {"log_one_plus", 2e-7},        // 1.7e-7
               {"angle_of", 3e-7},            // 2.9e-7
               {"tangent", 6e-7},             // 5.5e-7
               {"fresnel", 2e-6},             // 1.8e-6, beside total reflection; 6e-7 for n >= 1
               {"lambert", 6e-8},             // 8.4e-9
               {"oren_nayar", 4e-7},          // 3.1e-7
               {"blinn_phong", 6.5e-6},       // 6.0e-6, exponent 31 of e at shine 1000
               {"cook_torrance", 6e-6},       // 5.4e-6, exponent 60 of e
               {"eon", 3e-7},                 // 2.3e-7
               {"fon", 3e-7},                 // 1.9e-7
               {"fon_albedo_deficit", 4e-7},  // 3.0e-7
               {"cell_shares", 2e-3},     // 1.4e-3, an edge in the smallest footprint: 6e-8 of 1e-5
               {"conductor", 5e-6},       // 4.3e-6, n = 0.05
               {"beckmann_smith", 1e-5},  // 8.9e-6, exponent 70 of e
               {"ggx_smith", 6e-7},       // 5.4e-7
               {"lommel_seeliger", 2e-7},  // 1.3e-7
               {"hapke", 3e-6}};           // 2.4e-6

TEST(HardCases, FloatIsNearDouble) {
  for (const Formula& formula : formulas()) {
    const Worst worst = worst_error(formula);
    std::printf("%s\n", described(formula, worst).c_str());
    EXPECT_EQ(worst.bad, 0u) << described(formula, worst);
    double bound = 0;
    for (const auto& entry : kBounds)
      if (formula.name == entry.name) bound = entry.bound;
    EXPECT_LE(worst.error, bound) << described(formula, worst);
  }
}

// Normals without zero components, and Sun and viewer anywhere: nothing but finite numbers >= 0.
TEST(HardCases, FiniteAboutTiltedNormals) {
  const std::vector<Inputs> tilted = tilted_grid();
  for (Formula& formula : formulas()) {
    for (std::size_t i = 0; i < formula.cases.size(); ++i) {
      const auto p = formula.cases[i].p;
      formula.cases[i] = tilted[i % tilted.size()];
      formula.cases[i].p = p;
    }
    EXPECT_EQ(worst_error(formula).bad, 0u) << formula.name;
  }
}

// The bound of the project on the error of D where the highlight is.
TEST(HardCases, DistributionNearTheHighlight) {
  for (const double slope : {1e-4, 1e-3, 1e-2, 0.15}) {
    const Formula formula = beckmann_near_specular(slope, 200000);
    const Worst worst = worst_error(formula);
    std::printf("slope %g: %s\n", slope, described(formula, worst).c_str());
    EXPECT_EQ(worst.bad, 0u);
    EXPECT_LE(worst.error, slope <= 0.01 ? 1.5e-3 * (1e-3 / slope) : 2e-5);
  }
}

TEST(HardCases, Reciprocity) {
  double worst32 = 0, worst64 = 0;
  for (const Formula& formula : formulas())
    for (const Inputs& c : formula.cases) {
      Inputs swapped = c;
      std::swap(swapped.l, swapped.v);
      const glm::vec3 a = formula.f32(c), b = formula.f32(swapped);
      const glm::dvec3 x = formula.f64(c), y = formula.f64(swapped);
      for (int k = 0; k < 3; ++k) {
        worst32 = std::max(worst32, static_cast<double>(std::fabs(a[k] - b[k])) /
                                        std::max(static_cast<double>(a[k]), 1e-30));
        worst64 = std::max(worst64, std::fabs(x[k] - y[k]) / std::max(x[k], 1e-30));
      }
    }
  // measured: 0 and 0; every BRDF is written in symmetric terms
  EXPECT_EQ(worst32, 0);
  EXPECT_EQ(worst64, 0);
}

// A cosine of 0 or less on either side is 0 in every BRDF.
TEST(HardCases, NothingBelowTheHorizon) {
  for (const Formula& formula : formulas()) {
    if (!formula.of_directions) continue;
    for (Inputs c : formula.cases) {
      if (c.l.z <= 0 || c.v.z <= 0) {
        ASSERT_EQ(formula.f32(c), glm::vec3(0)) << formula.name;
        ASSERT_EQ(formula.f64(c), glm::dvec3(0)) << formula.name;
      }
      c.l.z = -0.3f;
      ASSERT_EQ(formula.f32(c), glm::vec3(0)) << formula.name;
    }
  }
}

// What exactly opposite directions and exact highlights give.
TEST(HardCases, OppositeDirections) {
  const glm::dvec3 v = direction(1e-7, 0);
  const glm::dvec3 l(-v.x, 0, v.z);
  EXPECT_EQ(materials::f64::cook_torrance(0.15, l, v, {0, 0, 1}), 0);
  EXPECT_EQ(materials::f64::blinn_phong(20.0, l, v, {0, 0, 1}), 0);
}

}  // namespace
}  // namespace panwright::hard_cases::hard_cases_test
