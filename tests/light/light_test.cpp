// The light of sources at points against closed forms and quadratures.
#include "light/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace panwright::light::light_test {
namespace {

constexpr double kTiny = 1e-12;

void expect_near(const Vec3& got, const Vec3& want, double relative) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], relative * std::fabs(want[k]) + 1e-300);
}

// 1 AU: 16 arc minutes; the disc shrinks with the distance, the irradiance is that at the target.
TEST(Light, SunAtDistances) {
  for (const double distance : {0.05, 1.0, 1.52, 30.0}) {
    const Sun sun{.direction = {0, 3, 4}, .distance = distance, .limb_darkening = 0.6};
    const Incidence here = incidence(sun, Vec3(0));
    EXPECT_EQ(here, incidence(sun, Vec3(1e6, -2, 3)));
    expect_near(here.to_light, {0, 0.6, 0.8}, 1e-15);
    EXPECT_EQ(here.irradiance, Vec3(1));
    EXPECT_EQ(here.limb, 0.6);
    const double sine = kSunSineAtOneAu / distance;
    // kSunAlpha2 is rounded to five digits: 1.2e-5
    EXPECT_NEAR(8 * here.alpha2 / (sine * sine), 1, 3e-5);
  }
  EXPECT_NEAR(std::sqrt(8 * incidence(Sun{}, Vec3(0)).alpha2) * 180 / kPi * 60, 15.99, 0.01);
  const Sun measured{.irradiance = Vec3(180, 190, 170)};
  EXPECT_EQ(incidence(measured, Vec3(0)).irradiance, Vec3(180, 190, 170));
}

TEST(Light, PointByInverseSquare) {
  const Point lamp{.position = {1, 2, 3}, .intensity = {4, 8, 16}, .radius = 0.01};
  const Vec3 toward = glm::normalize(Vec3(2, -1, 2));
  for (const double distance : {0.02, 0.1, 1.0, 7.0, 1e6}) {
    const Incidence light = incidence(lamp, lamp.position - distance * toward);
    const double tolerance = 1e-14 * (1 + 4 / distance);
    expect_near(light.irradiance, lamp.intensity / (distance * distance), tolerance);
    expect_near(light.to_light, toward, tolerance);
    EXPECT_NEAR(8 * light.alpha2, 1e-4 / (distance * distance),
                1e-4 * tolerance / (distance * distance));
  }
  // within it: as on its surface
  const double at_surface = 4 / (0.01 * 0.01);
  for (const double inside : {0.005, 0.0}) {
    const Incidence light = incidence(lamp, lamp.position - inside * toward);
    EXPECT_NEAR(light.irradiance.x / at_surface, 1, kTiny);
    EXPECT_NEAR(light.alpha2, 0.125, kTiny);
  }
  EXPECT_EQ(incidence(Point{}, Vec3(0)).irradiance, Vec3(0));
  EXPECT_EQ(incidence(Point{}, Vec3(2, 0, 0)).alpha2, 0);
}

// The cone ends at the half-angle; the power is the integral of the intensity over it,
// 2π·I·(1 − cos^(m+1))/(m + 1).
TEST(Light, SpotConeAndPower) {
  for (const double half_angle : {0.01, 0.5, 1.2, kPi / 2, 2.0, kPi})
    for (const double exponent : {0.0, 1.0, 7.5}) {
      const Spot spot{.axis = {0, 0, -2},
                      .intensity = {3, 2, 1},
                      .half_angle = half_angle,
                      .exponent = exponent};
      const auto at = [&](double angle) {
        const Vec3 away(std::sin(angle) * 0.6, std::sin(angle) * 0.8, -std::cos(angle));
        return incidence(spot, 2.0 * away).irradiance;
      };
      expect_near(at(0), spot.intensity / 4.0, kTiny);
      const double lit = exponent > 0 ? std::min(half_angle, kPi / 2) : half_angle;
      if (lit < kPi) {
        EXPECT_EQ(at(lit + 1e-9), Vec3(0)) << half_angle;
        if (exponent == 0) expect_near(at(lit - 1e-9), spot.intensity / 4.0, kTiny);
      } else {
        expect_near(at(kPi), spot.intensity / 4.0, kTiny);
      }
      constexpr int n = 20000;
      double power = 0;
      for (int i = 0; i < n; ++i) {
        const double angle = (i + 0.5) * lit / n;
        power += 4 * at(angle).x * 2 * kPi * std::sin(angle) * lit / n;
      }
      const double m = exponent + 1;
      const double want =
          2 * kPi * 3 * (1 - std::copysign(std::pow(std::fabs(std::cos(lit)), m), std::cos(lit))) /
          m;
      EXPECT_NEAR(power / want, 1, 1e-6) << half_angle << ' ' << exponent;
    }
}

TEST(Light, SoundSources) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_sound(Sun{}) && is_sound(Spot{}) && is_sound(Point{}));
  EXPECT_FALSE(is_sound(Sun{.direction = Vec3(0)}));
  EXPECT_FALSE(is_sound(Sun{.distance = 0}));
  EXPECT_FALSE(is_sound(Sun{.irradiance = Vec3(1, -1, 1)}));
  EXPECT_FALSE(is_sound(Sun{.limb_darkening = 1.5}));
  EXPECT_FALSE(is_sound(Spot{.axis = Vec3(0)}));
  EXPECT_FALSE(is_sound(Spot{.half_angle = 0}));
  EXPECT_FALSE(is_sound(Spot{.exponent = -1}));
  EXPECT_FALSE(is_sound(Spot{.radius = kInf}));
  EXPECT_FALSE(is_sound(Point{.position = Vec3(kInf)}));
  EXPECT_FALSE(is_sound(Point{.intensity = Vec3(-1)}));
}

TEST(Light, StampsChangeWithTheSource) {
  Light light;
  EXPECT_EQ(light.stamp(), Light().stamp());
  EXPECT_FALSE(light.set(Sun{}));
  EXPECT_EQ(light.stamp(), Light().stamp());
  const Light copy = light;
  EXPECT_TRUE(light.set(Sun{.distance = 2}));
  EXPECT_NE(light.stamp(), copy.stamp());
  const Stamp first = light.stamp();
  EXPECT_TRUE(light.set(Point{}));
  EXPECT_NE(light.stamp(), first);
  EXPECT_NE(Light(Point{}).stamp(), Light(Point{}).stamp());
}

}  // namespace
}  // namespace panwright::light::light_test
