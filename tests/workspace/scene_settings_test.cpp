// Lamps and scenes of models in worlds and frames.
#include "workspace/scene_settings.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "tests/support/process.h"
#include "workspace/frame.h"
#include "workspace/lamp_text.h"
#include "workspace/targets.h"
#include "world/lamps.h"

namespace panwright::workspace::scene_settings_test {
namespace {

using support::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPort =
    "<pangu_model ver='1'><scene><sun direction='1 0 0' distance='2'/>"
    "<planet body='earth' at='0 0 -6778km'/><stars to='6'/></scene><box size='1'/>"
    "<lamp name='red' type='led' power='1'/><lamp name='nav green' type='led' power='2'/>"
    "<joint name='boom' type='revolute' axis='0 0 1' lower='-180' upper='180'>"
    "<lamp name='tip' type='spot' at='2 0 0' direction='1 0 0' intensity='3' half_angle='20' "
    "state='off'/></joint></pangu_model>";

world::World world_of(const std::vector<TargetFile>& targets) {
  DiagnosticLog log;
  auto world = open_world(targets, {}, log);
  EXPECT_TRUE(world) << to_text(log);
  return world ? *std::move(world) : world::World();
}

Settings settings_of(const std::vector<std::pair<SettingId, std::string>>& given) {
  Settings settings;
  DiagnosticLog log;
  for (const auto& [id, text] : given) EXPECT_TRUE(read_setting(id, text, settings, log)) << text;
  return settings;
}

// Names of the lamps that are on.
std::vector<std::string> lit(const std::vector<world::Lamp>& lamps) {
  std::vector<std::string> out;
  for (const world::Lamp& lamp : lamps)
    if (lamp.on) out.push_back(lamp.name);
  return out;
}

std::vector<world::Lamp> changed(const world::World& world, const std::string& text,
                                 DiagnosticLog& log) {
  std::vector<world::Lamp> lamps(world.lamps().begin(), world.lamps().end());
  const bool good = set_lamp(text, world, lamps, log);
  EXPECT_EQ(good, !log.has_errors()) << text;
  return lamps;
}

TEST(SceneSettings, LampsOfAModelAreOnTheWorld) {
  const TemporaryFolder folder;
  world::World world = world_of({{"port", folder.write("port.pxn", kPort)}});
  ASSERT_EQ(world.lamps().size(), 3u);
  EXPECT_EQ(world.lamps()[0].target, "port");
  EXPECT_THAT(lit({world.lamps().begin(), world.lamps().end()}), ElementsAre("red", "nav green"));
  // a joint of a quarter turn takes the lamp and its axis along
  world.set_lamp_on(2, true);
  world.set_joint(0, 0, geometry::JointValues{kPi / 2});
  const auto placed = world::placed_lamps(world, {});
  ASSERT_EQ(placed.size(), 3u);
  const auto& tip = std::get<light::Spot>(placed[2]);
  EXPECT_NEAR(glm::length(tip.position - Vec3(0, 2, 0)), 0, 1e-12);
  EXPECT_NEAR(glm::length(tip.axis - Vec3(0, 1, 0)), 0, 1e-12);
  world.remove(0);
  EXPECT_TRUE(world.lamps().empty());
}

TEST(SceneSettings, LampsByName) {
  const TemporaryFolder folder;
  const std::string file = folder.write("port.pxn", kPort);
  const world::World world = world_of({{"port", file}});
  DiagnosticLog log;
  EXPECT_THAT(lit(changed(world, "red off", log)), ElementsAre("nav green"));
  EXPECT_THAT(lit(changed(world, "port/red off", log)), ElementsAre("nav green"));
  EXPECT_THAT(lit(changed(world, "nav green off", log)), ElementsAre("red"));
  EXPECT_THAT(lit(changed(world, "* off", log)), ElementsAre());
  EXPECT_THAT(lit(changed(world, "port/* on", log)), ElementsAre("red", "nav green", "tip"));
  EXPECT_THAT(lit(changed(world, "tip", log)), ElementsAre("red", "nav green", "tip"));
  const auto tip = changed(world, "tip intensity 7 half-angle 10deg radius 5mm", log)[2];
  EXPECT_TRUE(tip.on);
  const auto& spot = std::get<light::Spot>(tip.source);
  EXPECT_EQ(spot.intensity, Vec3(7));
  EXPECT_NEAR(spot.half_angle, 10 * kDegree, 1e-15);
  EXPECT_EQ(spot.radius, 0.005);
  EXPECT_EQ(spot.position, Vec3(2, 0, 0));
  // a led is a cosine: power over pi
  EXPECT_NEAR(std::get<light::Spot>(changed(world, "red power 2", log)[0].source).intensity.x,
              2 / kPi, 1e-15);
  EXPECT_EQ(changed(world, "led on camera intensity 2", log).size(), 4u);
  EXPECT_TRUE(log.entries().empty()) << to_text(log);
}

TEST(SceneSettings, WrongLampNames) {
  const TemporaryFolder folder;
  const std::string file = folder.write("port.pxn", kPort);
  const world::World world = world_of({{"a", file}, {"b", file}});
  for (const auto& [text, says] : std::initializer_list<std::pair<const char*, const char*>>{
           {"rad off", "has 'rad', expected spot, point, disc, led or the name of a lamp"},
           {"red off", "names 2 lamps, expected TARGET/NAME or a pattern"},
           {"x* off", "has 'x*', expected"},
           {"a/red dim", "has 'dim', expected on, off, intensity"},
           {"a/red at 1 2 3", "has 'at', expected on, off, intensity"},
           {"a/red intensity -1", "expected one number or three after it"},
           {"a/red intensity 1 power 1", "expected intensity or power"}}) {
    DiagnosticLog log;
    changed(world, text, log);
    ASSERT_EQ(log.errors(), 1u) << text;
    EXPECT_THAT(log.entries()[0].message, HasSubstr(says));
  }
  DiagnosticLog log;
  EXPECT_EQ(lit(changed(world, "*red off", log)).size(), 2u);
}

TEST(SceneSettings, GiveWhatAViewLeavesOut) {
  const TemporaryFolder folder;
  const world::World world = world_of({{"port", folder.write("port.pxn", kPort)}});
  FrameMaker maker(world);
  DiagnosticLog log;
  const auto plain = maker.frame(View(), log);
  ASSERT_TRUE(plain) << to_text(log);
  EXPECT_EQ(plain->sun->direction, Vec3(1, 0, 0));
  EXPECT_EQ(plain->sun->distance, 2);
  ASSERT_EQ(plain->sky->bodies.size(), 1u);
  EXPECT_EQ(plain->sky->bodies[0].centre, Vec3(0, 0, -6778e3));
  EXPECT_EQ(plain->sky->stars.faintest, 6);
  EXPECT_THAT(plain->of_scene,
              ElementsAre("sun 1 0 0", "sun-distance 2", "stars 6", "planet earth=0 0 -6778000"));
  EXPECT_EQ(plain->scene_target, "port");
  // a view wins, setting by setting
  const auto own = maker.frame(View(settings_of({{SettingId::sun, "0 1 0"},
                                                 {SettingId::planet, "earth=off"},
                                                 {SettingId::planet, "moon=1e8 0 0"},
                                                 {SettingId::stars, "off"}})),
                               log);
  ASSERT_TRUE(own) << to_text(log);
  EXPECT_EQ(own->sun->direction, Vec3(0, 1, 0));
  EXPECT_EQ(own->sun->distance, 2);
  ASSERT_EQ(own->sky->bodies.size(), 1u);
  EXPECT_EQ(own->sky->bodies[0].name, "moon");
  EXPECT_EQ(own->sky->stars.catalogue, nullptr);
  EXPECT_THAT(own->of_scene, ElementsAre("sun-distance 2"));
  EXPECT_TRUE(log.entries().empty()) << to_text(log);
}

TEST(SceneSettings, TheFirstTargetThatHasOneGivesIt) {
  const TemporaryFolder folder;
  const std::string bare = folder.write("bare.pxn", "<pangu_model ver='1'><sphere/></pangu_model>");
  const std::string other = folder.write(
      "other.pxn",
      "<pangu_model ver='1'><scene><sun direction='0 0 1'/></scene><sphere/></pangu_model>");
  const world::World world =
      world_of({{"bare", bare}, {"other", other}, {"port", folder.write("port.pxn", kPort)}});
  FrameMaker maker(world);
  DiagnosticLog log;
  for (int k = 0; k < 2; ++k) {
    const auto frame = maker.frame(View(), log);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sun->direction, Vec3(0, 0, 1));
    EXPECT_EQ(frame->sky, nullptr);
  }
  ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
  EXPECT_EQ(log.entries()[0].code, Code("N1314"));
  EXPECT_THAT(log.entries()[0].message, HasSubstr("scene of 'port' is not used; that of 'other'"));
}

// What the language leaves to the readers of settings is found when the model is read.
TEST(SceneSettings, TextsAreCheckedAtTheirPlace) {
  const TemporaryFolder folder;
  for (const auto& [scene, says] : std::initializer_list<std::pair<const char*, const char*>>{
           {"<scene date='tomorrow'/>", "line 2: --date is 'tomorrow'"},
           {"<scene><planet body='rock' at='0 0 0'/></scene>",
            "radius=, since only earth and moon"},
           {"<scene><planet body='earth' at='0 0 0' law='phong'/></scene>", "law=lambert"},
           {"<scene><planet body='earth' at='0 0 0' quat='1 1 0 0'/></scene>",
            "unit quaternion"}}) {
    DiagnosticLog log;
    const std::string file = folder.write(
        "m.pxn", "<pangu_model ver='1'>\n" + std::string(scene) + "<sphere/></pangu_model>");
    (void)open(file, {}, log);
    ASSERT_EQ(log.errors(), 1u) << scene << to_text(log);
    EXPECT_EQ(log.entries()[0].code, Code("E0203"));
    EXPECT_THAT(log.entries()[0].message, HasSubstr(says));
  }
}

TEST(SceneSettings, FilesAreBesideTheModel) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "models");
  folder.write("models/own.csv", "ra[deg],dec[deg],v[mag]\n10,20,3\n");
  const world::World world =
      world_of({{"m", folder.write("models/m.pxn",
                                   "<pangu_model ver='1'><scene><stars to='6' "
                                   "catalogue='own.csv'/></scene><sphere/></pangu_model>")}});
  FrameMaker maker(world);
  DiagnosticLog log;
  const auto frame = maker.frame(View(), log);
  ASSERT_TRUE(frame) << to_text(log);
  EXPECT_EQ(frame->sky->stars.catalogue->stars.size(), 1u);
}

// An orbit a quarter round, a quarter of a period after the scene's date.
TEST(SceneSettings, PlanetsOfADateStandAboutTheScenesOrbit) {
  const TemporaryFolder folder;
  const world::World world =
      world_of({{"m", folder.write("m.pxn",
                                   "<pangu_model ver='1'><scene date='2026-03-20T12:00:00' "
                                   "orbit='a=7000km'><planet body='earth' air='none' albedo='0.4'/>"
                                   "</scene><sphere/></pangu_model>")}});
  FrameMaker maker(world);
  DiagnosticLog log;
  const auto frame = maker.frame(View(), log);
  ASSERT_TRUE(frame) << to_text(log);
  ASSERT_EQ(frame->sky->bodies.size(), 1u);
  EXPECT_LT(glm::length(frame->sky->bodies[0].centre - Vec3(-7e6, 0, 0)), 1);
  EXPECT_FALSE(frame->sky->bodies[0].air);
  EXPECT_EQ(frame->sky->bodies[0].albedo, Vec3(0.4));
  const double quarter = 0.5 * kPi * std::sqrt(7e6 * 7e6 * 7e6 / 3.986004418e14);  // 1457.1 s
  const auto later = maker.frame(
      View(settings_of(
          {{SettingId::date, fmt::format("2026-03-20T12:24:{:.3f}", quarter - 24 * 60)}})),
      log);
  ASSERT_TRUE(later) << to_text(log);
  EXPECT_LT(glm::length(later->sky->bodies[0].centre - Vec3(0, -7e6, 0)), 100);
}

TEST(SceneSettings, TooManyLampsAreCounted) {
  const TemporaryFolder folder;
  const world::World world =
      world_of({{"m", folder.write("m.pxn",
                                   "<pangu_model ver='1'><sphere/><repeat count='70' var='i'>"
                                   "<lamp name='l{i}' type='led' power='1'/></repeat>"
                                   "</pangu_model>")}});
  FrameMaker maker(world);
  DiagnosticLog log;
  EXPECT_FALSE(maker.frame(View(), log));
  ASSERT_EQ(log.errors(), 1u);
  EXPECT_THAT(log.entries()[0].message, HasSubstr("70 lamps are on, expected 64 at most"));
  DiagnosticLog few;
  EXPECT_TRUE(maker.frame(View(settings_of({{SettingId::lamp, "l1* off"}})), few)) << to_text(few);
}

}  // namespace
}  // namespace panwright::workspace::scene_settings_test
