// The share of the Sun beside bodies against sums over its disc and the lens formula.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sky/sky.h"

namespace panwright::sky::eclipse_test {
namespace {

constexpr double kRadius = 6371e3;

// Oracle: rays over the Sun's disc against ellipsoids, as a quadratic in long double.
double share_by_rays(const world::World& world, const Vec3& point, int side) {
  const world::Sun& sun = world.sun();
  const Vec3 s = glm::normalize(sun.direction);
  const Vec3 x =
      glm::normalize(glm::cross(s, std::fabs(s.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  const Vec3 y = glm::cross(s, x);
  const double rho = world::kSunSineAtOneAu / sun.distance;
  double lit = 0, all = 0;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double a = 2 * (i + 0.5) / side - 1, b = 2 * (j + 0.5) / side - 1;
      const double square = a * a + b * b;
      if (square >= 1) continue;
      const double weight = 1 - sun.limb_darkening * (1 - std::sqrt(1 - square));
      all += weight;
      const Vec3 ray = std::sqrt(1 - rho * rho * square) * s + rho * (a * x + b * y);
      bool hidden = false;
      for (const light::Body& body : world.bodies()) {
        const Quat turn = glm::conjugate(body.world_from_body);
        const Vec3 o = turn * (point - body.centre) / body.radii, d = turn * ray / body.radii;
        using Real = long double;
        Real oo = -1, od = 0, dd = 0;
        for (int k = 0; k < 3; ++k) {
          oo += Real(o[k]) * o[k];
          od += Real(o[k]) * d[k];
          dd += Real(d[k]) * d[k];
        }
        hidden = hidden || (od < 0 && od * od > oo * dd);
      }
      if (!hidden) lit += weight;
    }
  return lit / all;
}

world::World sphere_world(double radius, const Vec3& centre, double limb) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.air = false;  // closed forms are of rough ground alone
  body.albedo = Vec3(0.3);
  body.radii = Vec3(radius);
  body.centre = centre;
  world.set_sky({body}, false);
  world.set_sun({.direction = {1, 0, 0}, .limb_darkening = limb});
  return world;
}

// Area of the common part of two circles, angles as lengths.
double lens(double d, double r, double big) {
  if (d >= r + big) return 0;
  if (d <= std::fabs(big - r)) return kPi * std::pow(std::min(r, big), 2);
  const double a = (d * d + r * r - big * big) / (2 * d * r);
  const double b = (d * d + big * big - r * r) / (2 * d * big);
  return r * r * std::acos(a) + big * big * std::acos(b) -
         0.5 * std::sqrt((-d + r + big) * (d + r - big) * (d - r + big) * (d + r + big));
}

TEST(Eclipse, LensFormula) {
  const double rs = std::asin(world::kSunSineAtOneAu);
  for (const double distance : {kRadius + 400e3, 42164e3, 3.844e8, 2e9}) {
    const double rp = std::asin(kRadius / distance);
    for (double t = -1.5; t <= 1.5; t += 0.25) {
      const double d = std::fabs(rp + t * rs);
      const world::World world =
          sphere_world(kRadius, distance * Vec3(std::cos(d), std::sin(d), 0), 0);
      const double want = 1 - lens(d, rs, rp) / (kPi * rs * rs);
      // 2.3e-4 is the formula's own error
      EXPECT_NEAR(Sky(world).sun_share(Vec3(0)), want, 1e-3) << distance << ' ' << t;
    }
  }
}

// Partial, annular and total ones, of oblate bodies and of two at once, with a dark limb.
TEST(Eclipse, SumsOverTheDisc) {
  std::mt19937 random(7);
  const auto unit = [&] { return random() / 4294967296.0; };
  int partial = 0;
  for (int i = 0; i < 60; ++i) {
    world::World world;
    const double rs = world::kSunSineAtOneAu;
    const Vec3 sun = glm::normalize(Vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5));
    world.set_sun({.direction = sun, .limb_darkening = unit()});
    std::vector<light::Body> bodies;
    for (int k = 0; k <= i % 2; ++k) {
      light::Body body = *light::body_preset("earth");
      body.air = false;  // closed forms are of rough ground alone
      body.albedo = Vec3(0.3);
      body.radii = Vec3(1, 0.8 + 0.4 * unit(), 0.7 + 0.5 * unit());
      body.world_from_body = glm::normalize(Quat(unit(), unit() - 0.5, unit() - 0.5, unit() - 0.5));
      // from a third of the Sun's size to a low orbit
      const double distance = i % 3 == 0 ? 1.5 + unit() : std::exp(std::log(2.0) + 6 * unit());
      const Vec3 beside = glm::normalize(glm::cross(sun, Vec3(unit(), unit(), unit() + 0.1)));
      const double limb = std::asin(1 / distance) + (2 * unit() - 1) * 1.5 * rs;
      body.centre = distance * (std::cos(limb) * sun + std::sin(limb) * beside);
      bodies.push_back(body);
    }
    world.set_sky(bodies, false);
    const double want = share_by_rays(world, Vec3(0), 700);
    // the sum's own error is 3e-4
    EXPECT_NEAR(Sky(world).sun_share(Vec3(0)), want, 1e-3) << i;
    if (want > 0.01 && want < 0.99) ++partial;
  }
  EXPECT_GT(partial, 10);
}

TEST(Eclipse, AnnularByAreas) {
  const double distance = 1e9;  // the Earth is 1.37 Sun radii wide from here
  const world::World world =
      sphere_world(0.5 * world::kSunSineAtOneAu * distance, Vec3(distance, 0, 0), 0);
  EXPECT_NEAR(Sky(world).sun_share(Vec3(0)), 0.75, 1e-4);
  EXPECT_EQ(Sky(world).sun_share(Vec3(2 * distance, 0, 0)), 1);  // behind the observer
  EXPECT_EQ(Sky(world).sun_share(Vec3(distance, 0, 0)), 0);      // within it
}

// The edge crosses a truss: of 40 m by a moon of 6 km, whose penumbra is as wide, and the Earth.
TEST(Eclipse, EdgeNearAPoint) {
  struct Case {
    double radius, distance, truss;
  };
  for (const auto& [radius, distance, truss] :
       {Case{3000, 5000, 20}, Case{kRadius, kRadius + 400e3, 50}, Case{kRadius, 42164e3, 5000}}) {
    for (const double t : {-0.8, 0.0, 0.5}) {
      const double limb = std::asin(radius / distance) + t * world::kSunSineAtOneAu;
      const world::World world =
          sphere_world(radius, distance * Vec3(std::cos(limb), 0, std::sin(limb)), 0.6);
      const Sky sky(world);
      const auto edge = sky.eclipse_edge(Vec3(0), truss);
      ASSERT_TRUE(edge);
      for (const Vec3& place : {Vec3(0), Vec3(truss, 0, 0), Vec3(0, truss, 0), Vec3(0, 0, truss),
                                Vec3(0, 0, -0.4 * truss)}) {
        const double got = share_beyond(edge->value + glm::dot(edge->gradient, place), 0.6);
        // the limb of the small moon bends by 0.07 m in 20 m, 4e-3 of its penumbra
        EXPECT_NEAR(got, sky.sun_share(place), 4e-3) << distance << ' ' << t << ' ' << place.z;
      }
    }
  }
  EXPECT_FALSE(Sky(sphere_world(kRadius, Vec3(-1e8, 0, 0), 0)).eclipse_edge(Vec3(0), 10));
  EXPECT_FALSE(Sky(sphere_world(kRadius, Vec3(0, 1e8, 0), 0)).eclipse_edge(Vec3(0), 10));
}

// Seconds from the first to the last light on a circular orbit.
double crossing(double height) {
  const double orbit = kRadius + height;
  const double rate = std::sqrt(3.986004418e14 / (orbit * orbit * orbit));
  const world::World world = sphere_world(kRadius, Vec3(0), 0);
  const Sky sky(world);
  const auto angle_at = [&](double share) {
    double low = 0.5 * kPi, high = kPi;  // from the Sun: lit, dark
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      const double there = sky.sun_share(orbit * Vec3(std::cos(middle), std::sin(middle), 0));
      (there > share ? low : high) = middle;
    }
    return low;
  };
  return (angle_at(1e-12) - angle_at(1 - 1e-12)) / rate;
}

TEST(Eclipse, PenumbraCrossingTimes) {
  EXPECT_NEAR(crossing(400e3) / 8.2, 1, 0.01);
  EXPECT_NEAR(crossing(35793e3) / 128, 1, 0.01);
}

}  // namespace
}  // namespace panwright::sky::eclipse_test
