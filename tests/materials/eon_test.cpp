#include <gtest/gtest.h>

#include "materials/material.h"
#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::eon_test {
namespace {

const Vec3 kNormal(0, 0, 1);
constexpr std::array kMu{.1, .25, .5, .75, 1.0};

// Directional albedo with the ring around the viewer's plane split where the BRDF has its kink.
template <class Law>
double albedo(double mu, Law brdf) {
  const Vec3 v = hard_cases::direction(mu, 0);
  const double theta_v = std::acos(mu);
  double sum = 0;
  const auto nodes = gauss(64);
  for (const auto& [x, wx] : nodes)
    for (const auto& [y, wy] : nodes)
      for (const int part : {0, 1})
        for (const int quarter : {0, 1, 2, 3}) {
          const double from = part == 0 ? 0 : theta_v, to = part == 0 ? theta_v : kPi / 2;
          const double theta = from + x * (to - from);
          sum += wx * wy * (to - from) * kPi / 2 * std::cos(theta) * std::sin(theta) *
                 brdf(from_angles(theta, kPi / 2 * (y + quarter)), v);
        }
  return sum;
}

double fon_albedo(double r, double mu) {
  return albedo(mu, [&](const Vec3& l, const Vec3& v) { return f64::fon(r, l, v, kNormal); });
}

double eon_albedo(double rho, double r, double mu) {
  return albedo(
      mu, [&](const Vec3& l, const Vec3& v) { return f64::eon(Vec3(rho), r, l, v, kNormal).x; });
}

// Albedos computed elsewhere by quadrature, to the digits given.
TEST(Eon, Table) {
  const struct {
    double r;
    std::array<double, 5> albedo;
  } rows[] = {{.25, {.992283304, .979993127, .959550150, .942291409, .932880766}},
              {.5, {.985537332, .962503022, .924188698, .891842281, .874204809}},
              {1, {.974306751, .933385792, .865319548, .807855425, .776522067}}};
  for (const auto& row : rows)
    for (std::size_t k = 0; k < kMu.size(); ++k) {
      const double mu = kMu[k];
      EXPECT_NEAR(fon_albedo(row.r, mu), row.albedo[k], 6e-10) << row.r << ' ' << mu;
      const double a = f64::fon_scale(row.r);
      const double albedo_deficit = row.r * a * f64::fon_albedo_deficit(mu, std::sqrt(1 - mu * mu));
      EXPECT_NEAR(1 - albedo_deficit, row.albedo[k], 6e-10) << row.r << ' ' << mu;
    }
  EXPECT_NEAR(eon_albedo(.8, .25, .5), .793257159, 6e-10);
  EXPECT_NEAR(eon_albedo(.8, .5, .5), .786882605, 6e-10);
  EXPECT_NEAR(eon_albedo(.8, 1, .5), .775123917, 6e-10);
  EXPECT_NEAR(eon_albedo(.8, .25, 1), .788811470, 6e-10);
  EXPECT_NEAR(eon_albedo(.8, .5, 1), .778234047, 6e-10);
  EXPECT_NEAR(eon_albedo(.8, 1, 1), .758722624, 6e-10);
}

// The paper's closed form of E, as printed, against ours.
TEST(Eon, LossIsThePapers) {
  double worst = 0;
  for (int i = 1; i <= 1000; ++i) {
    const double mu = i * 1e-3, s = std::sqrt((1 - mu) * (1 + mu));
    const double g = s * (std::acos(mu) - s * mu) + 2.0 / 3 * (s / mu * (1 - s * s * s) - s);
    const double want = 0.5 - 2 / (3 * kPi) - g / kPi;
    worst = std::max(worst, std::fabs(f64::fon_albedo_deficit(mu, s) - want));
  }
  EXPECT_LE(worst, 1e-13) << worst;  // measured 3.7e-14, theirs at mu = 0.001
  // towards grazing 2 mu/pi, to the last digits and in float too
  for (const double mu : {1e-8, 1e-6, 1e-4}) {
    const double s = std::sqrt((1 - mu) * (1 + mu));
    const double want = 2 * mu / kPi;
    EXPECT_NEAR(f64::fon_albedo_deficit(mu, s) / kPi * 2 / want,
                f64::fon_albedo_deficit(mu, s) / mu, 1e-12);
    const float mu32 = static_cast<float>(mu), s32 = static_cast<float>(s);
    EXPECT_NEAR(static_cast<double>(f32::fon_albedo_deficit(mu32, s32)) /
                    f64::fon_albedo_deficit(static_cast<double>(mu32), static_cast<double>(s32)),
                1, 3e-7);
  }
}

// Mean of the loss over the hemisphere: 6/(5π) − 1/6.
TEST(Eon, MeanAlbedoDeficit) {
  double sum = 0;
  for (const auto& [x, w] : gauss(64)) {
    const double theta = x * kPi / 2;
    sum += w * kPi / 2 * 2 * std::sin(theta) * std::cos(theta) *
           f64::fon_albedo_deficit(std::cos(theta), std::sin(theta));
  }
  EXPECT_NEAR(sum, 6 / (5 * kPi) - 1.0 / 6, 1e-14);
}

// A white surface reflects all that it gets, at every roughness and angle.
TEST(Eon, Furnace) {
  double worst = 0;
  for (const double r : {0.0, 1e-7, 1e-3, 0.25, 0.5, 1.0})
    for (const double mu : {1e-3, 0.02, 0.1, 0.5, 0.9, 1.0})
      worst = std::max(worst, std::fabs(eon_albedo(1, r, mu) - 1));
  EXPECT_LE(worst, 1e-13) << worst;  // measured 2.1e-14
}

TEST(Eon, GreySurfacesLoseWhatTheyAbsorb) {
  for (const double rho : {0.05, 0.5, 0.95})
    for (const double r : {0.3, 1.0})
      for (const double mu : {0.05, 0.5, 1.0}) {
        EXPECT_LE(eon_albedo(rho, r, mu), rho);
        EXPECT_GE(eon_albedo(rho, r, mu), rho * fon_albedo(r, mu));
      }
}

TEST(Eon, SmoothSurfaceIsLambertToTheLastBit) {
  for (const auto& c : hard_cases::grid()) {
    const glm::vec3 color(0.8f, 0.3f, 0.0f);
    ASSERT_EQ(f32::eon(color, 0.0f, c.l, c.v, c.n), f32::lambert(color, c.l, c.v, c.n));
  }
}

// The total intensity of a white FON sphere of r = 1 and where it stands, computed elsewhere.
TEST(Eon, Sphere) {
  const auto sphere = [](double phase, double* offset) {
    const Vec3 v(0, 0, 1), l(std::sin(phase), 0, std::cos(phase));
    double flux = 0, moment = 0;
    const auto nodes = gauss(160);
    // photometric latitude and longitude: the lit and seen lune is a rectangle in them
    for (const auto& [x, wx] : nodes)
      for (const auto& [y, wy] : nodes) {
        const double latitude = (x - 0.5) * kPi;
        const double longitude = phase - kPi / 2 + y * (kPi - phase);
        const Vec3 n(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                     std::cos(latitude) * std::cos(longitude));
        const double area = wx * wy * kPi * (kPi - phase) * std::cos(latitude);
        const double part = area * f64::fon(1.0, l, v, n) * glm::dot(n, l) * n.z;
        flux += part;
        moment += part * n.x;
      }
    *offset = moment / flux;
    return flux;
  };
  double offset = 0;
  EXPECT_NEAR(sphere(30 * kDegree, &offset), .65837107, 1e-5);
  EXPECT_NEAR(sphere(60 * kDegree, &offset), .34162103, 1e-5);
  EXPECT_NEAR(offset, .37956275, 1e-5);
  EXPECT_NEAR(sphere(90 * kDegree, &offset), .11301496, 1e-5);
  EXPECT_NEAR(offset, .57258057, 1e-5);
}

// A and B of Oren and Nayar's qualitative model have the ratio of FON's.
TEST(Eon, RoughnessOfASlope) {
  EXPECT_EQ(eon_roughness(0), 0);
  for (const double sigma : {0.05, 0.3, 1.0, kPi / 2}) {
    const double s2 = sigma * sigma;
    EXPECT_NEAR(eon_roughness(sigma) * (1 - 0.5 * s2 / (s2 + 0.33)), 0.45 * s2 / (s2 + 0.09),
                1e-15);
  }
  EXPECT_LT(eon_roughness(1e6), 0.9 + 1e-9);
}

}  // namespace
}  // namespace panwright::materials::eon_test
