#include "world/world.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/support/pan_sample.h"
#include "world/evaluation.h"

namespace panwright::world::world_test {
namespace {

ModelPtr small_model() {
  static const ModelPtr model = [] {
    DiagnosticLog log;
    auto opened = pan::Model::from_bytes(support::small_pan(), "small.pan", log);
    EXPECT_TRUE(opened && opened->check(log)) << to_text(log);
    return std::make_shared<const pan::Model>(std::move(*opened));
  }();
  return model;
}

std::size_t added(World& world, const std::string& name) {
  DiagnosticLog log;
  const auto index = world.add(name, small_model(), log);
  EXPECT_TRUE(index) << to_text(log);
  return index ? *index : 0;
}

TEST(World, TargetsAreFoundByName) {
  World world;
  EXPECT_EQ(added(world, "chaser"), 0u);
  EXPECT_EQ(added(world, "client"), 1u);
  EXPECT_EQ(world.find("client"), 1u);
  EXPECT_EQ(world.find("clients"), std::nullopt);
}

TEST(World, TwoTargetsOfOneNameAreRefused) {
  World world;
  added(world, "client");
  DiagnosticLog log;
  const Stamp stamp = world.stamp();
  EXPECT_FALSE(world.add("client", small_model(), log));
  EXPECT_TRUE(log.contains(Code("E5009")));
  EXPECT_EQ(world.size(), 1u);
  EXPECT_EQ(world.stamp(), stamp);
}

TEST(World, ANameThatIsNotThereGetsItsNeighbour) {
  World world;
  added(world, "chaser");
  added(world, "client");
  DiagnosticLog log;
  EXPECT_FALSE(world.require("cleint", log));
  ASSERT_TRUE(log.contains(Code("E5011")));
  EXPECT_EQ(log.entries()[0].hint, "did you mean 'client'?");
  EXPECT_FALSE(world.require("zzz", log));
  EXPECT_NE(log.entries()[1].message.find("'chaser', 'client'"), std::string::npos)
      << log.entries()[1].message;
  EXPECT_FALSE(World().require("zzz", log));
  EXPECT_NE(log.entries()[2].message.find("there are none"), std::string::npos);
}

TEST(World, MoreTargetsThanFitAreRefused) {
  World world;
  for (std::size_t i = 0; i < World::kMaxInstances; ++i) added(world, "t" + std::to_string(i));
  DiagnosticLog log;
  EXPECT_FALSE(world.add("one more", small_model(), log));
  EXPECT_TRUE(log.contains(Code("E5010")));
  EXPECT_EQ(world.size(), World::kMaxInstances);
}

TEST(World, ASetterChangesTheStampsOfWhatDependsOnIt) {
  World world;
  added(world, "a");
  added(world, "b");
  struct Stamps {
    Stamp all, sun, a_shape, a_pose, b_shape, b_pose;
  };
  const auto stamps = [&] {
    return Stamps{world.stamp(),         world.sun_stamp(),      world[0].shape_stamp(),
                  world[0].pose_stamp(), world[1].shape_stamp(), world[1].pose_stamp()};
  };
  Stamps old = stamps();
  const auto expect = [&](bool sun, bool a_shape, bool a_pose) {
    const Stamps now = stamps();
    EXPECT_NE(now.all, old.all);
    EXPECT_EQ(now.sun != old.sun, sun);
    EXPECT_EQ(now.a_shape != old.a_shape, a_shape);
    EXPECT_EQ(now.a_pose != old.a_pose, a_pose);
    EXPECT_EQ(now.b_shape, old.b_shape);
    EXPECT_EQ(now.b_pose, old.b_pose);
    old = now;
  };
  world.set_pose(0, {Vec3(1, 2, 3), Quat(1, 0, 0, 0)});
  expect(false, false, true);
  NodeTransform lifted;
  lifted.translation = Vec3(0, 0, 1);
  world.set_node_transform(0, 1, lifted);
  expect(false, true, false);
  world.set_node_visible(0, 2, false);
  expect(false, true, false);
  world.set_visible(0, false);
  expect(false, true, false);
  Sun sun;
  sun.direction = Vec3(1, 0, 0);
  world.set_sun(sun);
  expect(true, false, false);
  world.set_white(Vec3(2));
  expect(false, false, false);
}

// White has the unit of the Sun's irradiance, and not its value.
TEST(World, WhiteIsNotTheSuns) {
  World world;
  EXPECT_EQ(world.white(), Vec3(1));
  Sun sun;
  for (const double irradiance : {0.0, 5.0, 1361.0}) {
    sun.irradiance = Vec3(irradiance);
    world.set_sun(sun);
    EXPECT_EQ(world.white(), light::kSolarIrradiance);
  }
  world.set_white(Vec3(3, 2, 1));
  EXPECT_EQ(world.white(), Vec3(3, 2, 1));
  world.set_sun(Sun{});
  EXPECT_EQ(world.white(), Vec3(3, 2, 1));
}

TEST(World, WhatIsThereAlreadyChangesNoStamp) {
  World world;
  added(world, "a");
  NodeTransform lifted;
  lifted.translation = Vec3(0, 0, 1);
  world.set_node_transform(0, 1, lifted);
  world.set_node_visible(0, 2, false);
  const Stamp stamp = world.stamp();
  world.set_pose(0, Pose{});
  world.set_visible(0, true);
  world.set_node_transform(0, 1, lifted);
  world.set_node_transform(0, 2, std::nullopt);
  world.set_node_visible(0, 2, false);
  world.set_node_visible(0, 1, true);
  world.set_sun(Sun{});
  world.set_white(std::nullopt);
  EXPECT_EQ(world.stamp(), stamp);
}

TEST(World, CopiesAreIndependentAndKeepTheirStamps) {
  World world;
  added(world, "a");
  World copy = world;
  EXPECT_EQ(copy.stamp(), world.stamp());
  EXPECT_EQ(copy[0].model().get(), world[0].model().get());
  copy.set_pose(0, {Vec3(1, 0, 0), Quat(1, 0, 0, 0)});
  world.set_pose(0, {Vec3(2, 0, 0), Quat(1, 0, 0, 0)});
  EXPECT_EQ(copy[0].pose().translation.x, 1);
  EXPECT_NE(copy.stamp(), world.stamp());
  EXPECT_NE(copy[0].pose_stamp(), world[0].pose_stamp());
}

TEST(World, AStateThatIsTheModelsAgainIsNotKept) {
  World world;
  added(world, "a");
  world.set_node_transform(0, 2, NodeTransform{});
  world.set_node_visible(0, 2, false);
  world.set_node_transform(0, 1, NodeTransform{});
  ASSERT_EQ(world[0].node_states().size(), 2u);
  EXPECT_EQ(world[0].node_states()[0].node, 1u);
  world.set_node_transform(0, 2, std::nullopt);
  ASSERT_NE(world[0].node_state(2), nullptr);
  world.set_node_visible(0, 2, true);
  EXPECT_EQ(world[0].node_state(2), nullptr);
  EXPECT_EQ(world[0].node_states().size(), 1u);
}

TEST(World, AModelLivesAsLongAsItIsHeld) {
  World world;
  std::weak_ptr<const pan::Model> watched;
  {
    DiagnosticLog log;
    auto opened = pan::Model::from_bytes(support::small_pan(), "small.pan", log);
    ASSERT_TRUE(opened && opened->check(log));
    const auto model = std::make_shared<const pan::Model>(std::move(*opened));
    watched = model;
    ASSERT_TRUE(world.add("a", model, log));
  }
  EXPECT_EQ(world[0].model()->nodes().size(), 3u);
  world.remove(0);
  EXPECT_TRUE(watched.expired());
}

}  // namespace
}  // namespace panwright::world::world_test
