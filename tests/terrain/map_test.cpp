// Projections against closed forms and published values.
#include <gtest/gtest.h>

#include <cmath>

#include "terrain/map.h"

namespace panwright::terrain::map_test {
namespace {

Map polar(bool north, double radius, double polar_radius, double standard) {
  Map map;
  map.kind = Map::Kind::polar;
  map.north = north;
  map.radius = radius;
  map.polar_radius = polar_radius;
  map.standard_latitude = standard;
  map.left = -1e5;
  map.top = 1e5;
  map.dx = map.dy = 100;
  return map;
}

TEST(Map, PolarOfASphere) {
  const Map map = polar(false, 1737400, 1737400, -90);
  // on the sphere rho = 2R·tan(45° − |latitude|/2), and south up is longitude 0
  const Vec2 p = map.pixel({-88, 0}, 2000);
  const double rho = 2 * 1737400 * std::tan(1 * kDegree);
  EXPECT_NEAR(map.left + p.x * map.dx, 0, 1e-6);
  EXPECT_NEAR(map.top - p.y * map.dy, rho, 1e-6);
  const Vec2 east = map.pixel({-88, 90}, 2000);
  EXPECT_NEAR(map.left + east.x * map.dx, rho, 1e-6);
  // scale 2 / (1 + sin)
  EXPECT_NEAR(map.dx / map.spacing(p.x, p.y).x, 2 / (1 + std::sin(88 * kDegree)), 1e-12);
}

TEST(Map, PolarRoundTrips) {
  for (const bool north : {true, false})
    for (const double standard : {90.0, 70.0})
      for (const double flat : {1.0, 3376200.0 / 3396190.0}) {
        const Map map = polar(north, 3396190, flat * 3396190, north ? standard : -standard);
        for (double column = 17; column < 2000; column += 480)
          for (double row = 5; row < 2000; row += 470) {
            const LatLon at = map.at(column, row);
            const Vec2 back = map.pixel(at, 2000);
            EXPECT_NEAR(back.x, column, 2e-8);
            EXPECT_NEAR(back.y, row, 2e-8);
          }
      }
}

// Snyder 1987, page 315: International ellipsoid, standard parallel 71° S, 75° S 150° E is at
// (-1540033.6, -560526.4) with the central meridian 100° W, for planetographic latitudes.
TEST(Map, PolarOfAnEllipsoid) {
  const double a = 6378388, flattening = 1 / 297.0, ratio = (1 - flattening) * (1 - flattening);
  const auto centric = [&](double degrees) {
    return std::atan(ratio * std::tan(degrees * kDegree)) / kDegree;
  };
  Map map = polar(false, a, a * (1 - flattening), centric(-71));
  map.center_longitude = -100;
  const Vec2 p = map.pixel({centric(-75), 150}, 2000);
  EXPECT_NEAR(map.left + p.x * map.dx, -1540033.6, 0.05);
  EXPECT_NEAR(map.top - p.y * map.dy, -560526.4, 0.05);
}

TEST(Map, Cylindrical) {
  Map map;
  map.kind = Map::Kind::cylindrical;
  map.radius = 1737400;
  map.center_longitude = 180;
  map.domain = 360;
  map.dx = map.dy = 1737400 * kDegree;  // one pixel a degree
  map.left = -180 * map.dx;
  map.top = 90 * map.dy;
  EXPECT_NEAR(map.at(0.5, 0.5).longitude, 0.5, 1e-12);
  EXPECT_NEAR(map.at(359.5, 0.5).longitude, 359.5, 1e-12);
  EXPECT_NEAR(map.at(0.5, 0.5).latitude, 89.5, 1e-12);
  EXPECT_NEAR(map.pixel({0, -10}, 360).x, 350, 1e-9);
  EXPECT_NEAR(map.pixel({0, 370}, 360).x, 10, 1e-9);
  // east of a parallel shrinks with its cosine
  EXPECT_NEAR(map.spacing(0, 30).x, map.dx * 0.5, 1e-6);
  EXPECT_EQ(map.spacing(0, 30).y, map.dy);
}

}  // namespace
}  // namespace panwright::terrain::map_test
