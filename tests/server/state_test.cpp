#include "server/state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace panwright::server {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Motion, FollowsTheEquationsOfMotion) {
  Motion motion;
  motion.velocity = Vec3(1, 0, 0);
  motion.acceleration = Vec3(0, 2, 0);
  motion.jerk = Vec3(0, 0, 6);
  motion.turn = Vec3(0, 0, kPi / 4);
  const world::Pose start{Vec3(10, 0, 0), Quat(1, 0, 0, 0)};
  const world::Pose after = motion.at(start, 2);
  EXPECT_EQ(after.translation, Vec3(12, 4, 8));
  // a quarter turn about its own z: its x is along the start's y; 2e-16 measured
  EXPECT_LT(glm::length(after.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)), 1e-15);
  EXPECT_EQ(motion.at(start, 0), start);
  EXPECT_TRUE(Motion().still());
}

TEST(Fog, HasTheTransmissionOfItsMode) {
  Fog fog{FogMode::linear, 0, 0.1, 10, 30};
  EXPECT_EQ(fog.transmission(5), 1);
  EXPECT_EQ(fog.transmission(20), 0.5);
  EXPECT_EQ(fog.transmission(kInfinity), 0);
  fog.mode = FogMode::exponential;
  // to the rounding of exp(): 1e-16 measured
  EXPECT_NEAR(fog.transmission(10), 1 / std::exp(1.0), 1e-15);
  EXPECT_EQ(fog.transmission(kInfinity), 0);
  fog.mode = FogMode::squared;
  EXPECT_NEAR(fog.transmission(20), std::exp(-4.0), 1e-15);
  fog.radius = 10;
  EXPECT_NEAR(fog.transmission(kInfinity), 1 / std::exp(1.0), 1e-15);
  fog.mode = FogMode::none;
  EXPECT_EQ(fog.transmission(kInfinity), 1);
}

// Two slabs let through what one of both lengths does.
TEST(Fog, SlabsMultiply) {
  const Fog fog{FogMode::exponential, 0, 0.037, 0, 1};
  EXPECT_NEAR(fog.transmission(3) * fog.transmission(8.5), fog.transmission(11.5), 1e-15);
}

TEST(SkyColor, IsThatOfItsType) {
  SkyColor sky;
  sky.rgb = Vec3(0.25, 0.5, 1);
  EXPECT_EQ(sky.color(), Vec3(0));
  sky.type = 5;
  EXPECT_EQ(sky.color(), Vec3(0, 0, 1));
  sky.type = 8;
  EXPECT_EQ(sky.color(), sky.rgb);
  // white of sRGB is D65, x 0.3127 y 0.3290: to the four digits of the standard
  sky.type = 9;
  sky.cie = Vec3(0.3127, 0.3290, 0.5);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sky.color()[k], 0.5, 5e-4);
}

}  // namespace
}  // namespace panwright::server
