// The Sun, the Moon and rotations by date against values of others.

#include "ephemeris/analytic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace panwright::ephemeris::analytic_test {
namespace {

constexpr double kArcsecond = kDegree / 3600;

// Rows as one writes them.
Mat3 rows(const Vec3& a, const Vec3& b, const Vec3& c) { return transpose(Mat3(a, b, c)); }

// DE430 at 2015-03-02T00:00:00 TDB, from the Earth.
TEST(Analytic, SunAndMoon) {
  const Vec3 sun(140048325.763, -44572455.166, -19323688.163);
  const Vec3 moon(-200509.254, 332408.773, 106587.558);
  const double et = 478526400;
  // 11.9" and 9.4e-6; 1.1" and 1.3e-5 measured
  EXPECT_LE(angle_between(sun_from_earth(et), sun), 30 * kArcsecond);
  EXPECT_NEAR(length(sun_from_earth(et)) / length(sun), 1, 5e-5);
  EXPECT_LE(angle_between(moon_from_earth(et), moon), 20 * kArcsecond);
  EXPECT_NEAR(length(moon_from_earth(et)) / length(moon), 1, 1e-4);
}

// Meeus, Astronomical Algorithms, example 47.a: 1992-04-12T00:00:00 TD.
TEST(Analytic, DistanceOfTheMoon) {
  EXPECT_NEAR(length(moon_from_earth(-2820.5 * 86400)), 368409.7, 0.1);
}

// Measured rotation (binary PCK of the Earth, ITRF93) in axes of the ecliptic of J2000, 2003-10-12.
TEST(Analytic, Earth) {
  const Mat3 of_ecliptic = rows({0.98126526863002472, 0.1766290839487237, -0.076945690482834311},
                                {-0.1926612333485535, 0.90030724783726546, -0.39029283999306613},
                                {0.00033769603181756596, 0.39780526164836405, 0.91746981408996053});
  const double e = 84381.448 * kArcsecond;
  const Mat3 ecliptic =
      rows({1, 0, 0}, {0, std::cos(e), std::sin(e)}, {0, -std::sin(e), std::cos(e)});
  const double et = 119272873.43093674;
  const Attitude earth = earth_attitude(et, et - 64.184);
  const Mat3 turn = earth.from_j2000 * transpose(of_ecliptic * ecliptic);
  EXPECT_LE(std::abs(turn[1][0]), 14 * kArcsecond);
  EXPECT_LE(std::hypot(turn[2][0], turn[2][1]), 1 * kArcsecond);
  // 15" of a second
  const Mat3 later = earth_attitude(et + 1, et - 63.184).from_j2000 * transpose(earth.from_j2000);
  EXPECT_NEAR(later[1][0], 7.292115e-5, 1e-9);
  EXPECT_NEAR(length(*earth.rate), 7.292115e-5, 1e-12);
}

// The same polynomials and sums, of pck00010 by an independent reader, 2026-06-04.
TEST(Analytic, Moon) {
  const Mat3 expected = rows({-0.72610048562422291, 0.63420632606850103, 0.26563211543592025},
                             {-0.68749150270853754, -0.67612591944811606, -0.26497013936290414},
                             {0.011555019680853531, -0.37501476907601117, 0.92694681859049555});
  const Mat3 found = moon_attitude(833932869.17999995).from_j2000;
  for (int i = 0; i < 3; ++i) EXPECT_LE(length(found[i] - expected[i]), 1e-9) << i;
}

}  // namespace
}  // namespace panwright::ephemeris::analytic_test
