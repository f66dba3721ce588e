// The light of bodies on plates against closed forms and a quadrature over the surface.
#include "sky/planetshine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <span>
#include <vector>

namespace panwright::sky::planetshine_test {
namespace {

constexpr double kRadius = 6371e3;

// A Lambert sphere below the origin, the Sun at a zenith angle.
world::World world_at(double height, double zenith_deg) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.air = false;  // closed forms are of rough ground alone
  body.albedo = Vec3(0.3);
  body.radii = Vec3(kRadius);
  body.centre = Vec3(0, 0, -kRadius - height);
  world.set_sky({body}, false);
  const double z = zenith_deg * kDegree;
  world.set_sun({.direction = {std::sin(z), 0, std::cos(z)}});
  return world;
}

// Oracle: over longitude and latitude of the surface about the nadir.
double plate(double height, double zenith_deg, const Vec3& normal) {
  const double z = zenith_deg * kDegree;
  const Vec3 sun(std::sin(z), 0, std::cos(z)), eye(0, 0, kRadius + height);
  const double widest = std::acos(kRadius / (kRadius + height));
  constexpr int kRings = 300, kSectors = 300;
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    // finer near the nadir
    const double s = (i + 0.5) / kRings, angle = widest * s * s, width = widest * 2 * s / kRings;
    for (int j = 0; j < kSectors; ++j) {
      const double turn = 2 * kPi * (j + 0.5) / kSectors;
      const Vec3 up(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                    std::cos(angle));
      const Vec3 toward = up * kRadius - eye;
      const double square = glm::dot(toward, toward);
      const Vec3 direction = toward / std::sqrt(square);
      sum += 0.3 / kPi * std::max(0.0, glm::dot(up, sun)) *
             std::max(0.0, -glm::dot(up, direction)) * std::max(0.0, glm::dot(normal, direction)) /
             square * kRadius * kRadius * std::sin(angle) * width * 2 * kPi / kSectors;
    }
  }
  return sum;
}

// The Moon behind the Earth, half of it, and before it, from 6,878 km.
TEST(Planetshine, BodiesHideOneAnother) {
  const auto of = [](std::initializer_list<light::Body> bodies) {
    world::World world;
    world.set_sky(bodies, false);
    world.set_sun({.direction = {1, 0, 0}});
    return irradiance(Sky(world), Vec3(0), glm::normalize(Vec3(0, 0.3, -1)));
  };
  light::Body earth = *light::body_preset("earth");
  earth.air = false;
  earth.radii = Vec3(kRadius);
  earth.centre = Vec3(0, 0, -6878e3);
  light::Body moon = *light::body_preset("moon");
  moon.centre = Vec3(-2e7, 0, -4e8);
  EXPECT_EQ(of({earth, moon}), of({earth}));
  EXPECT_GT(of({moon}).x, 1e-7);
  // its middle at the Earth's limb
  const double limb = std::asin(earth.radii.x / 6878e3);
  moon.centre = 4e8 * Vec3(0, std::sin(limb), -std::cos(limb));
  const double share = (of({earth, moon}).x - of({earth}).x) / of({moon}).x;
  EXPECT_NEAR(share, 0.5, 0.02) << share;
  moon.centre = Vec3(0, 0, -2e5 - moon.radii.z);
  EXPECT_LT(of({earth, moon}).x, of({earth}).x + of({moon}).x - 1e-3);
}

// E/(albedo·S) of nadir plates: series in Legendre polynomials of the zenith angle, whose first
// term is closed.
TEST(Planetshine, NadirPlatesByTheSeries) {
  struct Row {
    double height;
    double at[7];  // 0 60 80 90 100 110 120 degrees
  };
  const double angles[7] = {0, 60, 80, 90, 100, 110, 120};
  for (const Row& row :
       {Row{400e3, {0.8817541, 0.440882, 0.153523, 0.020341, 0.00041, 0, 0}},
        Row{800e3, {0.7802991, 0.390150, 0.138189, 0.031462, 0.00269, 0.0001, 0}},
        Row{35793e3,
            {0.0168820, 0.0095856, 0.0059656, 0.0043818, 0.0030341, 0.0019535, 0.0011446}}}) {
    for (int k = 0; k < 7; ++k) {
      if (row.height > 1e6 && k == 0) continue;
      const world::World world = world_at(row.height, angles[k]);
      const double got = irradiance(Sky(world), Vec3(0), {0, 0, -1}).x / 0.3;
      // 4e-4 measured at 400 km and 80 degrees
      EXPECT_NEAR(got, row.at[k], 5e-4 * row.at[0]) << row.height << ' ' << angles[k];
    }
  }
  const double h = (kRadius + 35793e3) / kRadius;
  const double c1 = 1 / (2 * h * h * h) + (1 + h * h) / (4 * h * h) -
                    std::pow(h * h - 1, 2) / (8 * h * h * h) * std::log((h + 1) / (h - 1));
  EXPECT_NEAR(irradiance(Sky(world_at(35793e3, 0)), Vec3(0), {0, 0, -1}).x / 0.3 / c1, 1, 5e-4);
}

struct Case {
  const char* name;
  double height, zenith;
};
constexpr Case kCases[] = {{"400 km day", 400e3, 20},
                           {"400 km terminator", 400e3, 90},
                           {"800 km", 800e3, 60},
                           {"GEO", 35793e3, 90}};

TEST(Planetshine, TiltedPlatesByQuadrature) {
  for (const Case& each : kCases) {
    const Sky sky(world_at(each.height, each.zenith));
    const double most = plate(each.height, each.zenith, {0, 0, -1});
    for (int tilt = 0; tilt <= 180; tilt += 20)
      for (int turn = 0; turn < 360; turn += 90) {
        const Vec3 normal(std::sin(tilt * kDegree) * std::cos(turn * kDegree),
                          std::sin(tilt * kDegree) * std::sin(turn * kDegree),
                          -std::cos(tilt * kDegree));
        // 6e-4 measured
        EXPECT_NEAR(irradiance(sky, Vec3(0), normal).x, plate(each.height, each.zenith, normal),
                    1e-3 * most)
            << each.name << ' ' << tilt << ' ' << turn;
      }
  }
}

// What a plate gets of a disc that its horizon cuts: of a uniform one.
double cut(double cosine, double radius) {
  if (radius <= 0 || std::fabs(cosine) >= radius) return std::max(cosine, 0.0);
  const double t = cosine / radius;
  return 0.5 * cosine +
         radius * ((2 + t * t) * std::sqrt(1 - t * t) + 3 * t * std::asin(t)) / (3 * kPi);
}

constexpr int kPlates = 300;

// Normals of a spiral, even over the sphere.
Vec3 normal_of(int plate) {
  const double z = 1 - 2 * (plate + 0.5) / kPlates, turn = plate * kPi * (3 - std::sqrt(5.0));
  return Vec3(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
}

// Worst and rms error over all tilts, in parts of the largest irradiance.
Vec2 errors(const std::vector<double>& want, std::span<const materials::Incidence> lights) {
  double worst = 0, squares = 0;
  for (int i = 0; i < kPlates; ++i) {
    double error = -want[static_cast<std::size_t>(i)];
    for (const materials::Incidence& light : lights)
      error += light.irradiance.x *
               cut(glm::dot(normal_of(i), light.to_light), std::sqrt(8 * light.alpha2));
    worst = std::max(worst, std::fabs(error));
    squares += error * error;
  }
  return Vec2(worst, std::sqrt(squares / kPlates)) / *std::ranges::max_element(want);
}

TEST(Planetshine, FewLightsForThePlanet) {
  for (const Case& each : kCases) {
    const Sky sky(world_at(each.height, each.zenith));
    std::vector<double> want;
    for (int i = 0; i < kPlates; ++i) want.push_back(irradiance(sky, Vec3(0), normal_of(i)).x);
    for (const std::size_t count : {8u, 16u, 32u, 64u}) {
      const auto lights = planet_lights(sky, Vec3(0), count);
      EXPECT_LE(lights.size(), count);
      const Vec2 error = errors(want, lights);
      std::printf("%-18s %2zu lights: %.2f %% worst, %.2f %% rms\n", each.name, count,
                  100 * error.x, 100 * error.y);
      // measured, worst: 1.07, 0.42, 0.20, 0.10 %; rms: 0.60, 0.20, 0.07, 0.03 %
      EXPECT_LT(error.x, count == 8 ? 0.013 : count == 16 ? 0.005 : count == 32 ? 0.0025 : 0.0013);
      EXPECT_LT(error.y, count == 8 ? 0.007 : count == 16 ? 0.0025 : 0.001);
    }
  }
}

TEST(Planetshine, LightsOfSeveralBodiesAreDeterministic) {
  world::World world = world_at(400e3, 30);
  std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
  light::Body moon = *light::body_preset("moon");
  moon.centre = Vec3(0, 3.8e8, 0);
  bodies.push_back(moon);
  world.set_sky(bodies, false);
  const Sky sky(world);
  const auto lights = planet_lights(sky, Vec3(0), 16);
  EXPECT_EQ(lights, planet_lights(Sky(world), Vec3(0), 16));
  ASSERT_EQ(lights.size(), 16u);
  // the Moon is one light
  int moons = 0;
  for (const auto& light : lights) moons += light.to_light.y > 0.999 ? 1 : 0;
  EXPECT_EQ(moons, 1);
  for (std::size_t i = 1; i < lights.size(); ++i)
    EXPECT_GE(lights[i - 1].irradiance.x * 1.2, lights[i].irradiance.x);
  EXPECT_TRUE(planet_lights(Sky(world::World()), Vec3(0), 8).empty());
  // at night, and within the planet
  EXPECT_TRUE(planet_lights(Sky(world_at(400e3, 180)), Vec3(0), 8).empty());
  EXPECT_TRUE(planet_lights(Sky(world_at(-100, 0)), Vec3(0), 8).empty());
}

// The Moon's irradiance from afar is ROLO's.
TEST(Planetshine, MoonByRolo) {
  for (const auto& [degrees, reflectance] :
       {std::pair(7.0, 0.0987), {30.0, 0.0545}, {60.0, 0.0266}, {90.0, 0.0109}}) {
    world::World world;
    light::Body moon = *light::body_preset("moon");
    moon.centre = Vec3(0, 0, 3.844e8);
    world.set_sky({moon}, false);
    const double phase = degrees * kDegree;
    world.set_sun({.direction = {std::sin(phase), 0, -std::cos(phase)}});
    const double got = irradiance(Sky(world), Vec3(0), {0, 0, 1}).y;
    const double solid = std::pow(1737400 / 3.844e8, 2) * kPi;
    // the figures have three digits
    EXPECT_NEAR(got / (reflectance * solid / kPi), 1, 0.006) << degrees;
  }
}

// Every law's mean over a disc is what disc_reflectance() says.
TEST(Planetshine, DiscsOfTheLaws) {
  for (const light::Law law : {light::Law::lambert, light::Law::lommel_seeliger,
                               light::Law::lunar_lambert, light::Law::hapke})
    for (const double degrees : {0.0, 30.0, 90.0, 140.0}) {
      world::World world;
      light::Body body = *light::body_preset("moon");
      body.photometry = {};
      body.photometry.law = law;
      body.centre = Vec3(0, 0, 1e12);
      world.set_sky({body}, false);
      const double phase = degrees * kDegree;
      world.set_sun({.direction = {std::sin(phase), 0, -std::cos(phase)}});
      const double got = irradiance(Sky(world), Vec3(0), {0, 0, 1}, {400, 400}).x * kPi /
                         (kPi * std::pow(1737400 / 1e12, 2));
      const double want = light::disc_reflectance(body.photometry, phase);
      EXPECT_NEAR(got, want, 2e-3 * want + 1e-6) << static_cast<int>(law) << ' ' << degrees;
    }
}

}  // namespace
}  // namespace panwright::sky::planetshine_test
