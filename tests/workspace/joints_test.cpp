// Joint values as text, in options, views and records.
#include "workspace/joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "compiler/compile.h"
#include "workspace/record.h"
#include "world/evaluation.h"

namespace panwright::workspace::joints_test {
namespace {

using ::testing::HasSubstr;

world::ModelPtr craft() {
  static const world::ModelPtr model = [] {
    scene::Scene scene;
    scene.nodes.push_back({"root", scene::kNone, {}, {}});
    for (const char* name : {"wing", "flap", "boom", "mount"})
      scene.nodes.push_back({name, 0, {}, {}});
    scene.nodes[2].parent = 1;
    scene.shapes = {geometry::Box{{1, 1, 1}}};
    scene.materials.emplace_back();
    for (int i = 1; i < 5; ++i) {
      scene::Instance instance;
      instance.node = i;
      scene.instances.push_back(instance);
    }
    scene::Joint wing;
    wing.name = "wing";
    wing.node = 1;
    wing.lower = {-kPi / 2};
    wing.upper = {kPi / 2};
    wing.axis = {0, 1, 0};
    wing.pointing = Vec3(0, 0, 1);
    scene::Joint flap = wing;
    flap.name = "left/flap";
    flap.node = 2;
    flap.pointing.reset();
    flap.mimic = 0;
    scene::Joint boom;
    boom.name = "boom";
    boom.node = 3;
    boom.kind = geometry::JointKind::prismatic;
    boom.lower = {0};
    boom.upper = {0.5};
    scene::Joint mount;
    mount.name = "mount";
    mount.node = 4;
    mount.kind = geometry::JointKind::general;
    scene.joints = {wing, flap, boom, mount};
    scene.frames.push_back({"eye", 3, {0, 0, 1}, {1, 0, 0, 0}, {}});
    DiagnosticLog log;
    const auto bytes = compiler::compiled(scene, {}, log);
    auto opened = pan::Model::from_bytes(*bytes, "m.pan", log);
    EXPECT_TRUE(opened->check(log)) << to_text(log);
    return std::make_shared<const pan::Model>(std::move(*opened));
  }();
  return model;
}

world::World world_of(const std::vector<std::string>& names) {
  world::World world;
  DiagnosticLog log;
  for (const std::string& name : names) EXPECT_TRUE(world.add(name, craft(), log));
  return world;
}

std::string problem(world::World world, const std::string& text) {
  DiagnosticLog log;
  JointSetter setter(world);
  if (setter.set(joint_text(text), log)) setter.set_aims(Vec3(0, 0, 9), log);
  std::string out;
  for (const Diagnostic& each : log.entries())
    out += std::string(code_info(each.code).name) + " " + each.message + "|" + each.hint;
  return out;
}

double value(world::World world, const std::string& text, std::size_t joint) {
  DiagnosticLog log;
  JointSetter setter(world);
  EXPECT_TRUE(setter.set(joint_text(text), log)) << to_text(log);
  EXPECT_TRUE(setter.set_aims(Vec3(0, 0, 9), log)) << to_text(log);
  return world[0].joint_values()[joint][0];
}

TEST(JointTexts, HaveUnits) {
  const world::World world = world_of({"a"});
  EXPECT_EQ(value(world, "wing=30", 0), 30 * kDegree);
  EXPECT_EQ(value(world, "wing=0.5rad", 0), 0.5);
  EXPECT_EQ(value(world, "wing=90deg", 0), kPi / 2);
  EXPECT_EQ(value(world, "a/wing=-20mrad", 1), -0.02);  // its follower
  EXPECT_EQ(value(world, "boom=0.25", 2), 0.25);
  EXPECT_EQ(value(world, "boom=40cm", 2), 0.4);
  EXPECT_EQ(value(world, "mount=2 1 50%, 0 0 90deg 1m 2 3", 3), 2);
  EXPECT_EQ(value(world, "wing=@0.5 0 0.5", 0), kPi / 4);
  EXPECT_NEAR(value(world, "wing=@camera", 0), 0, 1e-15);
}

TEST(JointTexts, WhatIsWrongSaysWhatWouldBeRight) {
  const world::World one = world_of({"a"}), two = world_of({"a", "b"});
  EXPECT_EQ(problem(one, "wing=100deg"),
            "E5014 joint 'wing' goes from -90 deg to 90 deg, found 100 deg|");
  EXPECT_THAT(problem(one, "wing=2m"),
              HasSubstr("E5014 joint 'wing' is revolute: '2m' is not an angle"));
  EXPECT_THAT(problem(one, "boom=2deg"), HasSubstr("is not a length, as 0.2m"));
  EXPECT_EQ(problem(one, "wing=1 2"), "E5014 joint 'wing' is revolute and takes 1 value, found 2|");
  EXPECT_EQ(problem(one, "left/flap=1"),
            "E5014 joint 'left/flap' follows 'wing': give that one a value|");
  EXPECT_THAT(problem(one, "wnig=1"), HasSubstr("E5013 unknown joint 'wnig'|did you mean 'wing'?"));
  EXPECT_THAT(problem(two, "wing=1"),
              HasSubstr("2 targets have a joint 'wing'|name one of 'a/wing', 'b/wing'"));
  EXPECT_EQ(problem(two, "b/left/flap=1"),
            "E5014 joint 'b/left/flap' follows 'b/wing': give that one a value|");
  EXPECT_THAT(problem(one, "mount=0 1 1 0 0 0 0 0 0"), HasSubstr("a factor, which cannot be 0"));
  EXPECT_THAT(problem(one, "wing"), HasSubstr("E0201 --joint 'wing': NAME=VALUE is needed"));
  EXPECT_THAT(problem(one, "wing=@moon"),
              HasSubstr("cannot aim at 'moon', expected @sun, @camera"));
  EXPECT_THAT(problem(one, "boom=@sun"), HasSubstr("has no pointing direction"));
  EXPECT_THAT(problem(one, "wing=nan"), HasSubstr("E5014"));
  EXPECT_THAT(problem(one, "wing=@1 2 -3"), HasSubstr("W5015 joint 'wing' points"));
  EXPECT_THAT(problem(one, "mount=1e300 1 1 0 0 0 0 0 0"), HasSubstr("E5014"));
}

// A camera on a boom that is out, looking at a wing that points at it: all from one text.
TEST(JointTexts, ViewsMoveFramesAndAims) {
  DiagnosticLog log;
  Settings settings;
  settings.camera_frame = "eye";
  settings.size = ImageSize{16, 16};
  settings.fov = 20 * kDegree;
  settings.joint = {{"boom", "0.5m"}, {"wing", "@camera"}};
  const world::World world = world_of({"a"});
  const auto view = FrameMaker(world).frame(settings, log);
  ASSERT_TRUE(view) << to_text(log);
  EXPECT_NEAR(glm::length(view->camera().position - Vec3(0, 0, 1.5)), 0, 1e-12);
  ASSERT_EQ(view->joints.size(), 2u);
  EXPECT_EQ(view->joints[0].target, "a");
  EXPECT_NEAR(view->joints[0].values[0], 0, 1e-12);
  EXPECT_EQ(view->joints[1].values[0], 0.5);
}

// What a record says of joints is read back to the same bits.
TEST(JointTexts, RecordsKeepEveryBit) {
  world::World world = world_of({"a", "b/c"});
  geometry::JointValues wing{}, mount{};
  wing[0] = 0.1 + 0.2;
  for (std::size_t i = 0; i < 9; ++i) mount[i] = std::sqrt(2.0 + static_cast<double>(i)) / 3;
  world.set_joint(0, 0, wing);
  world.set_joint(1, 3, mount);
  const std::string record = record_text(world, {}, {});
  EXPECT_THAT(record, HasSubstr("a/wing"));
  View view;
  DiagnosticLog log;
  const std::size_t at = record.find("\"joint\":");
  const std::string joints = record.substr(at, record.find('}', at) + 1 - at);
  ASSERT_TRUE(parse_view("{" + joints + "}", 0, {}, view, log)) << joints << to_text(log);
  world::World again = world_of({"a", "b/c"});
  JointSetter setter(again);
  for (const JointText& joint : *view.settings.joint)
    EXPECT_TRUE(setter.set(joint, log)) << to_text(log);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(again[i].joint_values(), world[i].joint_values());
}

}  // namespace
}  // namespace panwright::workspace::joints_test
