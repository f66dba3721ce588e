// Lamps on nodes, and the scene of a model.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "pxn/writer.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::lights_test {
namespace {

using testing::HasSubstr;
using Kind = scene::Lamp::Kind;

Reading read_level_1(const std::string& nodes, const std::string& root = "") {
  return read_files({{"m.pxn", "<pangu_model ver=\"1\"" + root + ">\n" + nodes +
                                   "\n<sphere radius=\"1\"/></pangu_model>\n"}});
}

std::map<std::string, scene::Lamp> by_name(const Reading& r) {
  std::map<std::string, scene::Lamp> out;
  if (r.scene)
    for (const scene::Lamp& lamp : r.scene->lamps) out[lamp.name] = lamp;
  return out;
}

TEST(Lights, Kinds) {
  const Reading r = read_level_1(
      R"(<lamp name="a" type="spot" at="300 0 0" direction="0 3 0" intensity="4" half_angle="20"/>
         <lamp name="b" type="point" power="1 2 3" radius="5"/>
         <lamp name="c" type="disc" radius="1m" power="2" state="off"/>
         <lamp name="d" type="led" power="{1 + 2}"/>
         <lamp name="e" type="spot" power="1"/>)",
      R"( units="mm")");
  EXPECT_EQ(r.summary(), "");
  const auto lamps = by_name(r);
  ASSERT_EQ(lamps.size(), 5u);
  const scene::Lamp& a = lamps.at("a");
  EXPECT_EQ(a.kind, Kind::spot);
  EXPECT_EQ(a.position, Vec3(0.3, 0, 0));
  EXPECT_EQ(a.axis, Vec3(0, 1, 0));
  EXPECT_EQ(a.intensity, Vec3(4));
  EXPECT_NEAR(a.half_angle, 20 * kDegree, 1e-15);
  EXPECT_TRUE(a.on);
  // power: over 4 pi, over pi for a disc, and over pi for a led, whose intensity falls as the
  // cosine
  EXPECT_NEAR(lamps.at("b").intensity.y, 2 / (4 * kPi), 1e-15);
  EXPECT_EQ(lamps.at("b").radius, 0.005);
  EXPECT_NEAR(lamps.at("c").intensity.x, 2 / kPi, 1e-15);
  EXPECT_FALSE(lamps.at("c").on);
  EXPECT_EQ(lamps.at("d").kind, Kind::spot);
  EXPECT_EQ(lamps.at("d").exponent, 1);
  EXPECT_NEAR(lamps.at("d").intensity.x, 3 / kPi, 1e-15);
  EXPECT_NEAR(lamps.at("e").intensity.x, 1 / (2 * kPi * (1 - std::cos(kPi / 6))), 1e-15);
}

TEST(Lights, MoveWithTheirNodes) {
  const Reading r = read_level_1(
      R"(<part name="head"><lamp name="light" type="point" intensity="1"/></part>
         <use part="head" name="left"/><use part="head" name="right"/>
         <joint name="boom" type="continuous"><lamp name="tip" type="point" intensity="1"/></joint>
         <repeat count="3" var="i"><lamp name="nav{i}" type="point" intensity="1"/></repeat>)");
  EXPECT_EQ(r.summary(), "");
  const auto lamps = by_name(r);
  const auto node = [&](const char* name) {
    return r.scene->nodes[static_cast<std::size_t>(lamps.at(name).node)].name;
  };
  ASSERT_EQ(lamps.size(), 6u);
  EXPECT_EQ(node("left/light"), "left");
  EXPECT_EQ(node("right/light"), "right");
  EXPECT_EQ(node("tip"), "boom");
  EXPECT_EQ(node("nav2"), "root");
}

TEST(Lights, WhatIsWrongHasItsPlace) {
  for (const auto& [lamp, says] : std::initializer_list<std::pair<const char*, const char*>>{
           {R"(name="a" type="bulb" intensity="1")", "2:22 E1204"},
           {R"(name="a" type="spot")", "2:2 E1108"},
           {R"(name="a" type="spot" intensity="1" power="1")", "2:2 E1108"},
           {R"(name="a" type="spot" intensity="-1")", "2:39 E1202"},
           {R"(name="a" type="spot" intensity="1 2")", "2:2 E1203"},
           {R"(name="a" type="spot" intensity="1" half_angle="181")", "E1202"},
           {R"(name="a" type="spot" intensity="1" half_angle="0")", "E1202"},
           {R"(name="a" type="spot" intensity="1" exponent="x")", "E1201"},
           {R"(name="a" type="spot" intensity="1" direction="0 0 0")",
            "2:1 E1108 lamp 'a' has a direction of length 0"},
           {R"(name="a" type="point" intensity="1" half_angle="10")", "which only a spot has"},
           {R"(name="a" type="point" intensity="1" pulse="1 1")", "does not end after its begin"},
           {R"(name="a" type="point" intensity="1" pulse="1")", "expected 2"},
           {R"(name="a" type="point" intensity="1" direction="0 0 1")", "lights all of them"},
           {R"(name="a" type="disc" intensity="1")", "is a disc without a radius"},
           {R"(type="spot" intensity="1")", "2:2 E1103"},
           {R"(name="a" type="spot" intensity="1" radius="2deg")", "E1212"}}) {
    const Reading r = read_level_1(std::string("<lamp ") + lamp + "/>");
    EXPECT_THAT(r.summary(), HasSubstr(says)) << lamp;
    EXPECT_TRUE(r.log.has_errors());
    // the rest is read
    ASSERT_TRUE(r.scene);
    EXPECT_EQ(r.scene->instances.size(), 1u);
    EXPECT_TRUE(r.scene->lamps.empty());
  }
  const Reading twice =
      read_level_1(R"(<lamp name="a" type="led" power="1"/><lamp name="a" type="led" power="1"/>)");
  EXPECT_THAT(twice.summary(), HasSubstr("2:38 E1210 duplicate lamp 'a'; this one is left out"));
  EXPECT_THAT(read_nodes("<lamp name='a' type='led' power='1'/>").summary(), HasSubstr("E1106"));
}

std::string settings_of(const scene::Scene& scene) {
  std::string out;
  for (const scene::Setting& setting : scene.settings)
    out += setting.name + " " + setting.value + "\n";
  return out;
}

TEST(Lights, SceneIsSettingsOfViews) {
  const Reading r = read_level_1(
      R"(<scene date="2026-01-01T12:00:00" orbit="a=7000km i=50">
         <sun direction="1 0 2" distance="{1 + 0.5}" irradiance="7" limb_darkening="0.5" visible="on"/>
         <planet body="earth" at="0 0 -6778km"/>
         <planet body="rock" at="1 2 3" quat="0 0 0 1" radius="2km" albedo="0.1 0.2 0.3" law="rolo"/>
         <planet body="moon" albedo="0.5" air="none"/>
         <stars to="6.5"/></scene>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(settings_of(*r.scene),
            "date 2026-01-01T12:00:00\norbit a=7000km i=50\nsun 1 0 2\nsun-distance "
            "1.5\nsun-irradiance 7 7 7\n"
            "limb-darkening 0.5\nsky sun\nplanet earth=0 0 -6778000\n"
            "planet rock=1 2 3 0 0 0 1 radius=2000 2000 2000 albedo=0.1 0.2 0.3 law=rolo\n"
            "planet moon= albedo=0.5 0.5 0.5 air=none\nstars 6.5\n");
}

TEST(Lights, SceneProblems) {
  for (const auto& [scene, says] : std::initializer_list<std::pair<const char*, const char*>>{
           {R"(<planet at="0 0 0"/>)", "E1103"},
           {R"(<planet body="earth" air="mars"/>)", "2:34 E1204"},
           {R"(<planet body="earth" air="sunrise"/>)", "2:34 E1204"},
           {R"(<planet body="earth" air=""/>)", "2:34 E1103"},
           {R"(<planet body="earth" clouds="none.png"/>)", "E1301"},
           {R"(<planet body="rock" at="0 0 0" radius="0"/>)", "2:47 E1202"},
           {R"(<planet body="earth" at="0 0 0" map="none.png"/>)", "E1301"},
           {R"(<stars to="99"/>)", "2:19 E1202"},
           {R"(<sun distance="0"/>)", "E1202"},
           {R"(<sun/><sun/>)", "E1104"},
           {R"(<lamp name="a" type="led" power="1"/>)", "E1101"}}) {
    const Reading r = read_level_1(std::string("<scene>") + scene + "</scene>");
    EXPECT_THAT(r.summary(), HasSubstr(says)) << scene;
    EXPECT_TRUE(r.scene);
  }
  const Reading inside = read_files(
      {{"m.pxn", "<pangu_model ver='1'><include file='o.pxn'/></pangu_model>"},
       {"o.pxn", "<pangu_model ver='1'><scene><stars to='3'/></scene><sphere/></pangu_model>"}});
  EXPECT_THAT(inside.summary(), HasSubstr("N1314 the scene of an included file is not used"));
  EXPECT_TRUE(inside.scene->settings.empty());
}

TEST(Lights, ComeBackFromText) {
  const Reading r = read_level_1(
      R"(<scene date="2026-01-01" orbit="earth"><sun direction="1 0 2" visible="on"/>
         <planet body="moon" air="none"/>
         <planet body="rock" at="1 2 3" quat="0 0 0 1" radius="2km 1km 1km" law="hapke 0.3 -0.2 1 0.1" air="none"/>
         <planet body="earth" at="0 0 -6778km" albedo="0.3" air="sunset"/><stars to="6.5"/></scene>
         <lamp name="a" type="spot" at="0.3 0 0" direction="1 2 3" intensity="4" half_angle="20"
               exponent="2" radius="0.01" pulse="-0.5 0.25" state="off"/>
         <node name="n"><lamp name="b" type="point" power="1 2 3"/>
         <box size="1"><lamp name="x" type="led" power="1"/></box></node>
         <box name="lone" size="1"/><lamp name="c" type="disc" radius="1" power="2"/>)");
  ASSERT_TRUE(r.scene);
  const std::string text = to_text(*r.scene);
  const Reading again = read_files({{"again.pxn", text}});
  EXPECT_EQ(again.summary(), "") << text;
  ASSERT_TRUE(again.scene) << text;
  EXPECT_EQ(scene_difference(*r.scene, *again.scene, Likeness::same), "") << text;
  EXPECT_EQ(again.scene->lamps.size(), r.scene->lamps.size());
  EXPECT_EQ(settings_of(*again.scene), settings_of(*r.scene));
}

}  // namespace
}  // namespace panwright::pxn::lights_test
