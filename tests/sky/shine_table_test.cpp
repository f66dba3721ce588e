// The table of a planet's light against the quadrature over its disc, and against rays to it.
#include "sky/shine_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sky/planetshine.h"

namespace panwright::sky::shine_table_test {
namespace {

constexpr double kRadius = 6371e3;

world::World world_at(double height, double zenith_deg) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.air = false;
  body.albedo = Vec3(0.3);
  body.radii = Vec3(kRadius);
  body.centre = Vec3(0, 0, -kRadius - height);
  world.set_sky({body}, false);
  const double z = zenith_deg * kDegree;
  world.set_sun({.direction = {std::sin(z), 0, std::cos(z)}});
  return world;
}

// As a shader reads it, linear between texels.
double read(const ShineTable& table, int layer, const Vec3& direction) {
  const Vec3 d =
      direction / (std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z));
  const double turned_x = std::copysign(1 - std::fabs(d.y), d.x);
  const double turned_y = std::copysign(1 - std::fabs(d.x), d.y);
  const double x = (0.5 * (d.z >= 0 ? d.x : turned_x) + 0.5) * ShineTable::kSide + 0.5;
  const double y = (0.5 * (d.z >= 0 ? d.y : turned_y) + 0.5) * ShineTable::kSide + 0.5;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  double value = 0;
  for (int k = 0; k < 4; ++k) {
    const int to_right = k % 2, down = k / 2;
    const double share = (to_right ? x - column : column + 1 - x) * (down ? y - row : row + 1 - y);
    const auto texel = static_cast<std::size_t>(
        (layer * ShineTable::kRow + row + down) * ShineTable::kRow + column + to_right);
    value += share * static_cast<double>(table.rgba[4 * texel]);
  }
  return value;
}

// Directions of a spiral, even over the sphere.
std::vector<Vec3> directions(int count) {
  std::vector<Vec3> all;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - 2 * (k + 0.5) / count, turn = k * kPi * (3 - std::sqrt(5.0));
    all.emplace_back(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn),
                     z);
  }
  return all;
}

struct Case {
  const char* name;
  double height, zenith;
};
constexpr Case kCases[] = {{"400 km day", 400e3, 20},
                           {"400 km terminator", 400e3, 90},
                           {"800 km", 800e3, 60},
                           {"GEO", 35793e3, 90}};

// Of all directions together, blurred or not.
TEST(ShineTable, LayersKeepTheFlux) {
  for (const Case& each : kCases) {
    const Sky sky(world_at(each.height, each.zenith));
    const ShineTable table = shine_table(sky, Vec3(0));
    double want = 0;  // a plate's mean over all normals is a quarter of it
    for (const Vec3& normal : directions(500)) want += 4 * irradiance(sky, Vec3(0), normal).x / 500;
    for (int layer = 0; layer < ShineTable::kLayers; ++layer) {
      double sum = 0;
      for (const Vec3& direction : directions(40000))
        sum += read(table, layer, direction) * 4 * kPi / 40000;
      std::printf("%-18s layer %d: %.2f %%\n", each.name, layer, 100 * (sum / want - 1));
      // measured: 1.9 % at the terminator
      EXPECT_NEAR(sum / want, 1, 0.025) << each.name << layer;
    }
  }
}

// Inside the disc: the radiance where the ray meets the sphere.
TEST(ShineTable, SharpLayerByRays) {
  const Sky sky(world_at(400e3, 40));
  const ShineTable table = shine_table(sky, Vec3(0));
  const Vec3 sun = sky.to_sun();
  for (const Vec3& direction : directions(2000)) {
    const Vec3 eye(0, 0, kRadius + 400e3);
    const double b = glm::dot(eye, direction);
    const double square = b * b - glm::dot(eye, eye) + kRadius * kRadius;
    const double sine = std::sqrt(1 - direction.z * direction.z) * (kRadius + 400e3) / kRadius;
    if (direction.z > 0 || sine > 1.08) {
      EXPECT_EQ(read(table, 0, direction), 0);
    } else if (sine < 0.9) {
      const Vec3 up = (eye + (-b - std::sqrt(square)) * direction) / kRadius;
      const double want = 0.3 / kPi * std::max(glm::dot(up, sun), 0.0);
      // measured: 2e-4
      EXPECT_NEAR(read(table, 0, direction), want, 5e-4);
    }
  }
}

// The blurred radiance is the mean of the sharp one by the Gaussian, and a small Moon is there.
TEST(ShineTable, BlursAndSmallBodies) {
  world::World world = world_at(400e3, 30);
  std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
  light::Body moon = *light::body_preset("moon");
  moon.centre = 3.8e8 * glm::normalize(Vec3(0.2, 0.3, 1));
  bodies[0] = moon;
  world.set_sky(bodies, false);
  world.set_sun({.direction = {0, 0, -1}});
  const ShineTable table = shine_table(Sky(world), Vec3(0));
  const double flux = irradiance(Sky(world), Vec3(0), glm::normalize(moon.centre)).x;
  for (int layer = 1; layer < ShineTable::kLayers; ++layer) {
    const double square = kShineWidths[layer] * kShineWidths[layer];
    const double peak = flux / (2 * kPi * square * (1 - std::exp(-2 / square)));
    const double got = read(table, layer, glm::normalize(moon.centre));
    std::printf("%g: %.3f\n", kShineWidths[layer], got / peak);
    // measured: 0.90, 0.95, 0.96: a texel is as wide as it is
    EXPECT_NEAR(got / peak, 1, 0.13) << layer;
  }
}

}  // namespace
}  // namespace panwright::sky::shine_table_test
