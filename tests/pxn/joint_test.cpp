// <joint>: around nodes, in parts that are used, and on nodes of CAD files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pxn/writer.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::joint_test {
namespace {

using geometry::JointKind;
using testing::ElementsAre;
using testing::HasSubstr;

Reading read_1(const std::string& inside, const std::string& root = "",
               const std::string& wrl = "") {
  return read_files(
      {{"m.pxn", "<pangu_model ver=\"1\" " + root + ">\n" + inside + "\n</pangu_model>\n"},
       {"a.wrl", wrl}});
}

const scene::Joint& joint(const Reading& r, const std::string& name) {
  static const scene::Joint kNone;
  for (const scene::Joint& each : r.scene->joints)
    if (each.name == name) return each;
  ADD_FAILURE() << "no joint " << name;
  return kNone;
}

std::size_t node(const Reading& r, const std::string& name) {
  for (std::size_t i = 0; i < r.scene->nodes.size(); ++i)
    if (r.scene->nodes[i].name == name) return i;
  ADD_FAILURE() << "no node " << name;
  return 0;
}

TEST(JointElement, IsANodeThatMoves) {
  const Reading r = read_1(
      "<joint name='hinge' type='revolute' axis='0 2 0' lower='-90' upper='45deg' value='0.5rad' "
      "translate='1 0 0'><box name='panel' size='1' translate='1 0 0'/><keypoint name='k' at='1 0 "
      "0'/>"
      "</joint>");
  EXPECT_EQ(r.summary(), "");
  const scene::Joint& hinge = joint(r, "hinge");
  EXPECT_EQ(hinge.kind, JointKind::revolute);
  EXPECT_EQ(hinge.axis, Vec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(hinge.lower.at(0), -kPi / 2);
  EXPECT_DOUBLE_EQ(hinge.upper.at(0), kPi / 4);
  EXPECT_EQ(hinge.value.at(0), 0.5);
  EXPECT_EQ(r.scene->nodes[static_cast<std::size_t>(hinge.node)].name, "hinge");
  EXPECT_EQ(hinge.source.line, 2u);
  // what is inside stands as the joint has it: 1 m out, turned about y
  const Vec3 at(scene::world_from_nodes(*r.scene)[node(r, "panel")][3]);
  EXPECT_NEAR(glm::length(at - Vec3(1 + std::cos(0.5), 0, -std::sin(0.5))), 0, 1e-15);
}

TEST(JointElement, BareNumbersAreOfTheRootsUnits) {
  const Reading r = read_1(
      "<joint name='boom' type='prismatic' axis='1 0 0' lower='0' upper='400' value='{10 + 5}'/>"
      "<joint name='turn' type='revolute' lower='-1' upper='1' value='{2*0.25}'/>"
      "<joint name='ball' type='ball' value='0.1 90deg 0' lower='-1 -2 -3' upper='1 2 3'/>"
      "<joint name='all' type='general' value='1 2 50% 0.1 0 0 7 1m 0'/>",
      "units='mm' angle='rad'");
  EXPECT_EQ(r.summary(), "");
  EXPECT_NEAR(joint(r, "boom").upper.at(0), 0.4, 1e-16);
  EXPECT_NEAR(joint(r, "boom").value.at(0), 0.015, 1e-17);
  EXPECT_EQ(joint(r, "turn").value.at(0), 0.5);
  EXPECT_THAT(joint(r, "ball").value, ElementsAre(0.1, kPi / 2, 0));
  EXPECT_THAT(joint(r, "ball").lower, ElementsAre(-1, -2, -3));
  EXPECT_THAT(joint(r, "all").value, ElementsAre(1, 2, 0.5, 0.1, 0, 0, 0.007, 1, 0));
}

TEST(JointElement, BeginsWithinItsLimits) {
  const Reading r = read_1("<joint name='a' type='revolute' lower='10deg' upper='20deg'/>");
  EXPECT_EQ(r.summary(), "");
  EXPECT_DOUBLE_EQ(joint(r, "a").value.at(0), 10 * kDegree);
}

TEST(JointElement, OfUsesHaveTheirNamesAndFollowTheirOwn) {
  const Reading r = read_1(
      "<part name='wing'><joint name='hinge' type='continuous'><joint name='outer' "
      "type='continuous' mimic='hinge' multiplier='-2' offset='10deg'/><joint name='flap' "
      "type='continuous' mimic='master'/></joint></part>"
      "<joint name='master' type='continuous'/>"
      "<use part='wing' name='left'/><use part='wing' name='right'/>");
  EXPECT_EQ(r.summary(), "");
  const auto leader = [&](const std::string& name) {
    return r.scene->joints[static_cast<std::size_t>(joint(r, name).mimic)].name;
  };
  EXPECT_EQ(leader("left/outer"), "left/hinge");
  EXPECT_EQ(leader("right/outer"), "right/hinge");
  EXPECT_EQ(leader("right/flap"), "master");
  EXPECT_EQ(joint(r, "left/outer").multiplier, -2);
  EXPECT_DOUBLE_EQ(joint(r, "left/outer").offset, 10 * kDegree);
}

TEST(JointElement, AimsAloneOrWithAGimbal) {
  const Reading r = read_1(
      "<joint name='drive' type='continuous' axis='0 1 0' pointing='0 0 3' point_at='sun'/>"
      "<joint name='az' type='continuous'><node><joint name='el' type='revolute' axis='0 1 0' "
      "lower='-90' upper='90' value='30' pointing='0 0 1' gimbal='az'/></node></joint>");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(joint(r, "drive").pointing, Vec3(0, 0, 1));
  EXPECT_EQ(joint(r, "drive").point_at, scene::PointAt::sun);
  EXPECT_EQ(r.scene->joints[static_cast<std::size_t>(joint(r, "el").gimbal)].name, "az");
}

// What cannot be is said with its place, and what is inside stays.
TEST(JointElement, WhatCannotBeIsSaidAndTheRestStays) {
  const auto summary = [](const std::string& attributes, const std::string& inside = "") {
    const Reading r =
        read_1("<joint name='j' " + attributes + ">" + inside + "<box size='1'/></joint>");
    EXPECT_TRUE(r.scene);
    if (r.scene) {
      EXPECT_GE(r.scene->instances.size(), 1u) << attributes;
    }
    return r.summary();
  };
  EXPECT_EQ(summary("type='revolute'"),
            "2:1 E1231 joint 'j' is revolute and needs lower= and upper=\n");
  EXPECT_EQ(summary("type='prismatic' lower='0'"),
            "2:1 E1231 joint 'j' has no upper limit; lower and upper belong together\n");
  EXPECT_EQ(summary("type='continuous' lower='0' upper='1'"),
            "2:1 E1231 joint 'j' is continuous, which has no limits; a revolute joint has\n");
  EXPECT_EQ(summary("type='revolute' lower='20' upper='10'"),
            "2:1 E1231 joint 'j' has a lower limit of 20deg above the upper one of 10deg\n");
  EXPECT_EQ(summary("type='prismatic' lower='0' upper='1' value='2'"),
            "2:1 E1231 joint 'j' has an initial value of 2m outside its limits, 0m to 1m\n");
  EXPECT_EQ(summary("type='continuous' axis='0 0 0'"),
            "2:1 E1231 joint 'j' has an axis of length 0\n");
  EXPECT_EQ(summary("type='general' value='1 1 0 0 0 0 0 0 0'"),
            "2:1 E1231 joint 'j' has an initial factor of 0, which makes things flat\n");
  EXPECT_THAT(summary("type='ball' value='1 2'"), HasSubstr("E1203 value of <joint>: expected 3"));
  EXPECT_THAT(summary("type='revolute' lower='0m' upper='1m'"), HasSubstr("E1212"));
  EXPECT_THAT(summary("type='hinge'"), HasSubstr("E1204"));
  EXPECT_EQ(
      summary("type='prismatic' lower='0' upper='1' pointing='0 0 1'"),
      "2:1 E1231 joint 'j' is prismatic and cannot aim: revolute and continuous joints can\n");
  EXPECT_EQ(
      summary("type='ball' mimic='j'"),
      "2:1 E1231 joint 'j' is ball and cannot follow another: only joints of one value can\n");
  EXPECT_EQ(summary("type='continuous' mimic='k'"),
            "2:1 E1232 joint 'j' follows 'k', which is not a joint\n");
  EXPECT_EQ(summary("type='continuous' mimic='j'"),
            "2:1 E1232 joint 'j' follows itself through others\n");
  EXPECT_EQ(summary("type='continuous' pointing='0 0 1' gimbal='k'",
                    "<joint name='k' type='continuous'/>"),
            "2:1 E1232 joint 'j' aims with 'k', which does not enclose it\n");
  EXPECT_THAT(summary("type='continuous'", "<joint name='j' type='continuous'/>"),
              HasSubstr("E1210 duplicate joint 'j'"));
  EXPECT_THAT(summary("type='continuous' multiplier='2'"), HasSubstr("E11"));
}

TEST(JointElement, LoopsOfFollowersAreCutOnce) {
  const Reading r = read_1(
      "<joint name='a' type='continuous' mimic='b'/><joint name='b' type='continuous' mimic='c'/>"
      "<joint name='c' type='revolute' lower='1' upper='2' mimic='a'/>");
  EXPECT_EQ(r.summary(), "2:1 E1232 joint 'a' follows itself through others\n");
}

// A plate at x 0 to 1 and a flap at x 1 to 2, turned and shifted by its parents.
constexpr const char* kFlap =
    "#VRML V2.0 utf8\n"
    "Transform { translation 0 0 5 children ["
    "DEF plate Shape { geometry Box { size 1 0.1 1 } }"
    "Transform { rotation 0 1 0 0.3 scale 2 2 2 children [ DEF flap Transform { translation 1 0 0 "
    "children Shape { geometry Box { size 1 0.1 1 } } } ] } ] }\n";

TEST(ImportJoint, TurnsANodeAboutALineOfTheImport) {
  const std::string import = "<import file='a.wrl' units='m' up='z' clean='no' translate='10 0 0'>";
  const Reading rest = read_1(import + "</import>", "", kFlap);
  ASSERT_TRUE(rest.scene);
  const std::string rule =
      "<joint nodes='flap' name='hinge' type='continuous' origin='0.5 0 5' axis='0 1 1' ";
  const Reading r = read_1(import + rule + "/></import>", "", kFlap);
  EXPECT_EQ(r.summary(), rest.summary());
  // at rest nothing has moved
  const Mat4 before = scene::world_from_nodes(*rest.scene)[node(rest, "flap")];
  const Mat4 same = scene::world_from_nodes(*r.scene)[node(r, "flap")];
  for (int c = 0; c < 4; ++c) EXPECT_LE(glm::length(before[c] - same[c]), 2e-15);
  // and at 0.75 rad it is turned about the line through (10.5, 0, 5) along (0, 1, 1)
  const Reading turned = read_1(import + rule + "value='0.75rad'/></import>", "", kFlap);
  const Mat4 after = scene::world_from_nodes(*turned.scene)[node(turned, "flap")];
  const Vec3 pivot(10.5, 0, 5);
  const Quat q = glm::angleAxis(0.75, glm::normalize(Vec3(0, 1, 1)));
  for (int c = 0; c < 4; ++c) {
    const Vec3 expected = c < 3 ? q * Vec3(before[c]) : pivot + q * (Vec3(before[3]) - pivot);
    EXPECT_LE(glm::length(Vec3(after[c]) - expected), 1e-14);  // measured 3e-15
  }
}

TEST(ImportJoint, SeveralNodesMoveTogether) {
  const Reading r = read_1(
      "<import file='a.wrl' units='m'><joint nodes='*' name='all' type='revolute' lower='0' "
      "upper='9'/></import>",
      "",
      "#VRML V2.0 utf8\nDEF a Transform { children Shape { geometry Box {} } }\n"
      "DEF b Transform { translation 3 0 0 children Shape { geometry Box {} } }\n");
  ASSERT_EQ(r.scene->joints.size(), 2u) << r.summary();
  EXPECT_EQ(r.scene->joints[0].name, "all");
  EXPECT_EQ(r.scene->joints[1].name, "all#2");
  EXPECT_EQ(r.scene->joints[1].mimic, 0);
}

TEST(ImportJoint, PatternsThatFitNothingAreSaid) {
  const Reading r = read_1(
      "<import file='a.wrl' units='m'><joint nodes='flop' name='j' type='continuous'/></import>",
      "", kFlap);
  EXPECT_THAT(r.summary(), HasSubstr("W1501 no node of the import fits 'flop'"));
  EXPECT_THAT(r.summary(), HasSubstr("flap"));
  const Reading twice = read_1(
      "<import file='a.wrl' units='m'><joint nodes='flap' name='j' type='continuous'/>"
      "<joint nodes='fla?' name='k' type='continuous'/></import>",
      "", kFlap);
  EXPECT_THAT(twice.summary(), HasSubstr("E1231 joint 'k' moves node 'flap'"));
}

TEST(ImportJoint, FramesOfTheFileStandOnTheirNodes) {
  const std::vector<MemoryFile> files{
      {"m.pxn",
       "<pangu_model ver='1'>\n<part name='p'><import file='a.xml' translate='1 0 0'/></part>"
       "<use part='p' name='left'/><use part='p' name='right'/>\n"
       "<import file='a.xml'/><import file='a.xml'/></pangu_model>"},
      {"a.xml",
       "<mujoco><worldbody><body name='arm' pos='0 2 0'><geom size='1'/>"
       "<site name='port' pos='0 0 3'/></body></worldbody></mujoco>"}};
  const Reading r = read_files(files);
  EXPECT_THAT(r.summary(), HasSubstr("3:23 E1210 duplicate frame 'port' of the import"));
  ASSERT_EQ(r.scene->frames.size(), 3u);
  EXPECT_EQ(r.scene->frames[0].name, "left/port");
  EXPECT_EQ(r.scene->frames[1].name, "right/port");
  EXPECT_EQ(r.scene->frames[2].name, "port");
  const auto world = scene::world_from_nodes(*r.scene);
  const scene::Frame& port = r.scene->frames[0];
  const Vec3 at(world[static_cast<std::size_t>(port.node)] * Vec4(port.origin, 1));
  EXPECT_LE(glm::length(at - Vec3(1, 2, 3)), 1e-15);
}

// Written out and read again, every joint is the same.
TEST(JointElement, ComesBackFromText) {
  const Reading r = read_1(
      "<part name='wing'><joint name='hinge' type='revolute' axis='1 2 2' lower='-1' upper='1' "
      "value='0.25' translate='1 2 3'><box size='1'/><joint name='outer' type='prismatic' "
      "lower='0' "
      "upper='5' mimic='hinge' multiplier='-2' offset='1'/></joint></part>"
      "<use part='wing' name='left'/>"
      "<joint name='az' type='continuous'><joint name='el' type='continuous' pointing='1 1 1' "
      "gimbal='az' point_at='sun' value='3'><sphere/></joint></joint>"
      "<joint name='g' type='general' value='1 2 3 4 5 6 7 8 9'><box size='2'/></joint>");
  EXPECT_EQ(r.summary(), "");
  const std::string text = to_text(*r.scene);
  const Reading again = read_files({{"m.pxn", text}});
  EXPECT_EQ(again.summary(), "");
  EXPECT_EQ(scene_difference(*r.scene, *again.scene, Likeness::same), "") << text;
  scene::Scene other = *again.scene;
  other.joints[0].upper[0] = 1.5;
  EXPECT_NE(scene_difference(*r.scene, other, Likeness::same), "");
}

}  // namespace
}  // namespace panwright::pxn::joint_test
