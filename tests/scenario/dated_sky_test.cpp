// The Earth, the Moon and the Sun by date and orbit, against ERFA (astropy 5.2, printed below),
// textbooks and the dates of eclipses.
#include "scenario/dated_sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace panwright::scenario::dated_sky_test {
namespace {

constexpr double kArcsecond = kDegree / 3600;

Epoch utc(const std::string& text) {
  std::string problem;
  const auto epoch = parse_epoch(text, TimeSystem::utc, problem);
  EXPECT_TRUE(epoch) << problem;
  return epoch.value_or(Epoch{});
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

DatedSky sky_at(const Orbit& orbit, const std::string& date) {
  const auto sky = dated_sky(orbit, utc(date));
  EXPECT_TRUE(sky);
  return sky.value_or(DatedSky{});
}

Orbit earth_centre() {
  Orbit orbit;
  orbit.at_centre = true;
  return orbit;
}

struct Row {
  const char* date;
  Vec3 sun, moon, velocity;    // apparent, AU; apparent, km; of the Earth's barycentric motion, m/s
  double longitude, latitude;  // beneath (0.6, 0, 0.8) of the GCRS, degrees
};

// get_sun(), get_body("moon"), get_body_barycentric_posvel("earth"), GCRS to ITRS.
const Row kRows[] = {
    {"2003-08-28T03:00:00",
     {-0.91087271, 0.40094454, 0.17382925},
     {-349461.0176, 107122.0781, 80798.5296},
     {12410.9675713, 24560.65685027, 10648.13780642},
     -20.884211084,
     53.148921421},
    {"2010-06-21T12:00:00",
     {0.00230431, 0.93237976, 0.40420705},
     {-327372.2262, -158297.8958, -104700.4189},
     {29295.91257942, -161.92409988, -70.57952723},
     -89.442218675,
     53.190079155},
    {"2017-08-21T18:25:00",
     {-0.86372009, 0.4830572, 0.2094115},
     {-317563.2168, 176832.1702, 79670.4669},
     {15016.23985267, 23256.1614602, 10080.47304378},
     113.712987853,
     53.227401015},
    {"2020-03-20T00:00:00",
     {0.9958437, -0.00695477, -0.00301956},
     {263323.2373, -266297.0692, -138445.5861},
     {-732.73222658, -27445.19861096, -11896.08368701},
     -177.727547967,
     53.240785606},
};

TEST(DatedSky, AgreesWithErfaAtTheEarthsCentre) {
  for (const Row& row : kRows) {
    const DatedSky sky = sky_at(earth_centre(), row.date);
    // at most 11"
    EXPECT_LT(angle_between(sky.sun_direction, row.sun), 30 * kArcsecond) << row.date;
    EXPECT_NEAR(sky.sun_distance / glm::length(row.sun), 1, 1e-4) << row.date;
    EXPECT_LT(angle_between(sky.moon.centre, row.moon), 22 * kArcsecond) << row.date;
    EXPECT_NEAR(glm::length(sky.moon.centre), 1000 * glm::length(row.moon), 40e3) << row.date;
    EXPECT_EQ(sky.earth.centre, Vec3(0));
    EXPECT_LT(glm::length(sky.velocity - row.velocity), 20) << row.date;
    EXPECT_LT(glm::length(earth_velocity(utc(row.date)) - row.velocity), 20) << row.date;
    // the Earth's map: the place beneath a point
    const Vec3 place = glm::conjugate(sky.earth.world_from_body) * Vec3(0.6, 0, 0.8);
    EXPECT_NEAR(std::atan2(place.y, place.x) / kDegree, row.longitude, 0.005) << row.date;
    EXPECT_NEAR(std::asin(place.z) / kDegree, row.latitude, 0.001) << row.date;
  }
}

// The Sun stands above the equator at 2026-03-20T14:46 (the almanacs' equinox), over the longitude
// where it is noon: 12 h - 14:46 + 7.5 minutes of the equation of time.
TEST(DatedSky, SunStandsWhereItIsNoon) {
  const DatedSky sky = sky_at(earth_centre(), "2026-03-20T14:46:00");
  const Vec3 place = glm::conjugate(sky.earth.world_from_body) * sky.sun_direction;
  EXPECT_NEAR(std::asin(place.z) / kDegree, 0, 0.012);
  EXPECT_NEAR(std::atan2(place.y, place.x) / kDegree, 15 * (12 - 14 - 46 / 60.0 + 7.45 / 60), 0.1);
}

// The Moon turns one side to the Earth, within its librations of 8°, and is full and new when the
// almanacs say so.
TEST(DatedSky, MoonTurnsItsFaceAndHasItsPhases) {
  double most = 0;
  for (int day = 1; day <= 28; ++day) {
    const DatedSky sky = sky_at(earth_centre(), "2026-02-" + std::string(day < 10 ? "0" : "") +
                                                    std::to_string(day) + "T00:00:00");
    const Vec3 to_earth =
        glm::conjugate(sky.moon.world_from_body) * glm::normalize(-sky.moon.centre);
    most = std::max(most, angle_between(to_earth, {1, 0, 0}) / kDegree);
  }
  EXPECT_LT(most, 10.5);
  EXPECT_GT(most, 4);
  const auto phase = [](const char* date) {
    const DatedSky sky = sky_at(earth_centre(), date);
    return angle_between(sky.sun_direction, sky.moon.centre) / kDegree;
  };
  // total eclipse of the Moon, gamma -0.3765: 0.37 radii of the Earth beside the shadow's axis
  EXPECT_NEAR(phase("2026-03-03T11:33:37"), 180 - 0.36, 0.02);
  // total eclipse of the Sun, gamma 0.8977
  EXPECT_NEAR(phase("2026-08-12T17:45:53"), 0.8977 * 6378 / 363e3 / kDegree, 0.02);
  // first quarter of 2026-02-24, 12:28
  EXPECT_NEAR(phase("2026-02-24T12:28:00"), 90, 0.3);
}

// Vallado, Fundamentals of Astrodynamics and Applications, example 2-6.
TEST(OrbitElements, AreThoseOfATextbook) {
  constexpr double kE = 0.83285;
  const auto state = state_of({11067790 / (1 - kE * kE), kE, 87.87 * kDegree, 227.89 * kDegree,
                               53.38 * kDegree, 92.335 * kDegree},
                              kEarthGravity);
  ASSERT_TRUE(state);
  EXPECT_LT(glm::length(state->position - Vec3(6525344, 6861535, 6449125)), 600);  // 5 digits
  EXPECT_LT(glm::length(state->velocity - Vec3(4902.276, 5533.124, -1975.709)), 0.5);
  EXPECT_FALSE(state_of({7e6, 1.2, 0, 0, 0, 0}, kEarthGravity));
  EXPECT_FALSE(state_of({-7e6, 0.2, 0, 0, 0, 0}, kEarthGravity));
  EXPECT_FALSE(state_of({-7e6, 2, 0, 0, 0, kPi}, kEarthGravity));
  EXPECT_TRUE(state_of({-7e6, 2, 0, 0, 0, 1}, kEarthGravity));
}

TEST(DatedSky, OriginMovesOnItsOrbit) {
  constexpr double kRadius = 6778e3;
  Orbit orbit;
  orbit.start = *state_of({kRadius, 0, 51.6 * kDegree, 0.5, 0, 0.3}, kEarthGravity);
  orbit.epoch = utc("2026-03-20T12:00:00");
  const double period = 2 * kPi * std::sqrt(kRadius * kRadius * kRadius / kEarthGravity);
  const DatedSky begin = sky_at(orbit, "2026-03-20T12:00:00");
  EXPECT_LT(glm::length(begin.earth.centre + orbit.start.position), 1e-6);
  const auto after = dated_sky(orbit, later(*orbit.epoch, period));
  ASSERT_TRUE(after);
  EXPECT_LT(glm::length(after->earth.centre - begin.earth.centre), 1e-2);
  const auto half = dated_sky(orbit, later(*orbit.epoch, period / 2));
  ASSERT_TRUE(half);
  EXPECT_LT(glm::length(half->earth.centre + begin.earth.centre), 1e-2);
  // the Moon and the Sun keep their distance from the Earth
  const DatedSky centre = sky_at(earth_centre(), "2026-03-20T12:00:00");
  EXPECT_LT(glm::length(begin.moon.centre - begin.earth.centre - centre.moon.centre), 1e-3);
  EXPECT_LT(glm::length(begin.velocity - centre.velocity - orbit.start.velocity), 1e-6);
  // without an epoch the elements are those of the date
  orbit.epoch.reset();
  EXPECT_LT(glm::length(sky_at(orbit, "2031-01-01T00:00:00").earth.centre + orbit.start.position),
            1e-6);
}

TEST(DatedSky, AxesOfTheOrbitAreThoseOfClohessyAndWiltshire) {
  Orbit orbit;
  orbit.start = *state_of({7e6, 0.1, 1, 2, 3, 0.7}, kEarthGravity);
  const DatedSky inertial = sky_at(orbit, "2026-03-20T12:00:00");
  orbit.axes = WorldAxes::rtn;
  const DatedSky turned = sky_at(orbit, "2026-03-20T12:00:00");
  const double distance = glm::length(orbit.start.position);
  EXPECT_LT(glm::length(turned.earth.centre - Vec3(-distance, 0, 0)), 1e-6);
  const Vec3 along = turned.world_from_icrf * orbit.start.velocity;
  EXPECT_GT(along.y, 0);
  EXPECT_NEAR(along.z, 0, 1e-9);
  EXPECT_LT(glm::length(turned.world_from_icrf * inertial.sun_direction - turned.sun_direction),
            1e-12);
  EXPECT_LT(glm::length(turned.world_from_icrf * inertial.moon.centre - turned.moon.centre), 1e-6);
  EXPECT_EQ(turned.velocity, inertial.velocity) << "stars have axes of the ICRF";
}

TEST(DatedSky, OrbitsOfTheMoon) {
  Orbit orbit;
  orbit.about = Centre::moon;
  orbit.start = *state_of({1837.4e3, 0, 1.5, 0, 0, 0}, gravity_of(Centre::moon));
  const DatedSky sky = sky_at(orbit, "2026-03-20T12:00:00");
  EXPECT_LT(glm::length(sky.moon.centre + orbit.start.position), 1e-6);
  const DatedSky centre = sky_at(earth_centre(), "2026-03-20T12:00:00");
  EXPECT_LT(glm::length(sky.earth.centre + centre.moon.centre + orbit.start.position), 1e-3);
  // the Moon goes around the Earth at 1 km/s
  const Vec3 beside = sky.velocity - centre.velocity - orbit.start.velocity;
  EXPECT_NEAR(glm::length(beside), 1022, 60);
  EXPECT_NEAR(glm::dot(beside, glm::normalize(centre.moon.centre)), 0, 70);
}

TEST(DatedSky, HasDatesAndUtc) {
  EXPECT_FALSE(dated_sky(earth_centre(), utc("2051-01-01T00:00:00")));
  EXPECT_TRUE(dated_sky(earth_centre(), utc("1972-01-01T00:00:00")));
  EXPECT_EQ(utc_seconds(utc("2000-01-01T12:00:00")), 0);
  EXPECT_EQ(utc_seconds(utc("1999-12-31T12:00:00")), -86400);
  EXPECT_EQ(utc_seconds(utc("2017-01-01T12:00:00")), 6210 * 86400.0) << "five leap seconds after";
  EXPECT_EQ(utc_seconds(utc("1985-01-01T12:00:00.5")), -5478 * 86400.0 + 0.5);
}

}  // namespace
}  // namespace panwright::scenario::dated_sky_test
