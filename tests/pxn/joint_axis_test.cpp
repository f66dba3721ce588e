// <joint axis="auto">: axes of imports' joints from the faces of their nodes.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/pxn/reading.h"

namespace panwright::pxn::joint_axis_test {
namespace {

using testing::HasSubstr;
using testing::Not;

// The faces of a cylinder about z in VRML, of 2 m height, without ends.
std::string tube(double radius, int segments, double arc = 2 * kPi) {
  std::string points, faces;
  for (int k = 0; k <= segments; ++k) {
    const double angle = arc * k / segments;
    for (const double z : {-1.0, 1.0})
      points += fmt::format("{} {} {}, ", radius * std::cos(angle), radius * std::sin(angle), z);
    if (k < segments)
      faces += fmt::format("{} {} {} {} -1 ", 2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1);
  }
  return "Shape { geometry IndexedFaceSet { solid FALSE coord Coordinate { point [" + points +
         "] } coordIndex [" + faces + "] } }";
}

std::string placed(const std::string& name, const std::string& fields, const std::string& shapes) {
  return "DEF " + name + " Transform { " + fields + " children [ " + shapes + " ] }\n";
}

const std::string kBox = "Shape { geometry Box { size 3 0.1 2 } }";

Reading import(const std::string& wrl, const std::string& rules,
               const std::string& attributes = "units='m' up='z' hidden='keep'") {
  return read_files({{"m.pxn", "<pangu_model ver=\"1\">\n<import file='a.wrl' " + attributes +
                                   ">\n" + rules + "\n</import></pangu_model>\n"},
                     {"a.wrl", "#VRML V2.0 utf8\n" + wrl}});
}

std::string rule(const std::string& attributes) {
  return "<joint name='j' type='continuous' " + attributes + "/>";
}

// The joint's axis and a point of it, in the world.
struct Line {
  Vec3 axis, point;
};
Line line_of(const Reading& r) {
  EXPECT_TRUE(r.scene && r.scene->joints.size() == 1) << r.summary();
  if (!r.scene || r.scene->joints.empty()) return {};
  const scene::Joint& joint = r.scene->joints[0];
  const Mat4 world = scene::world_from_nodes(*r.scene)[static_cast<std::size_t>(joint.node)];
  return {glm::normalize(Mat3(world) * joint.axis), Vec3(world[3])};
}

void expect_line(const Reading& r, const Vec3& axis, const Vec3& point) {
  const Line line = line_of(r);
  EXPECT_LT(glm::length(glm::cross(line.axis, glm::normalize(axis))), 1e-9) << r.summary();
  EXPECT_LT(glm::length(glm::cross(line.axis, point - line.point)), 1e-9) << r.summary();
}

const std::string kTurned = "translation 1 2 3 rotation 0.6 0 0.8 1.1";
Vec3 turned(const Vec3& v) { return glm::angleAxis(1.1, Vec3(0.6, 0, 0.8)) * v; }

TEST(JointAxis, OfThePartThatMovesOrOfAnotherOne) {
  const std::string wrl =
      placed("flap", "translation 0 5 0", kBox) + placed("pin", kTurned, tube(0.05, 16));
  const Reading r = import(wrl, rule("nodes='flap' axis='auto' axis_from='pin'"));
  EXPECT_EQ(r.codes().count("N1234"), 1u) << r.summary();
  EXPECT_THAT(r.summary(),
              HasSubstr("joint 'j' has the axis of a cylinder of radius 0.05 m in node "
                        "'pin/Shape2': 100 % of the area there"));
  expect_line(r, turned({0, 0, 1}), {1, 2, 3});
  // the same, said shorter, and from faces of the part itself
  expect_line(import(wrl, rule("nodes='flap' axis_from='pin'")), turned({0, 0, 1}), {1, 2, 3});
  expect_line(import(placed("flap", kTurned, kBox + tube(0.2, 12, kPi / 2)),
                     rule("nodes='flap' axis='auto'")),
              turned({0, 0, 1}), {1, 2, 3});
  // faces of its own are looked at with what is below, exact ones too
  expect_line(import(placed("arm", kTurned,
                            placed("inner", "translation 0 0 1",
                                   "Shape { geometry Cylinder { radius 0.1 } }")),
                     rule("nodes='arm' axis='auto'")),
              turned({0, 1, 0}), Vec3(1, 2, 3) + turned({0, 0, 1}));
}

TEST(JointAxis, TurnsAboutItAndPointsAlongItsLargestComponent) {
  const std::string wrl = placed("flap", kTurned, kBox + tube(0.2, 24));
  const auto flap = [&](const std::string& value) {
    const Reading r = import(wrl, rule("nodes='flap' axis='auto' value='" + value + "'"));
    EXPECT_TRUE(r.scene && r.scene->joints.size() == 1) << r.summary();
    const auto world = scene::world_from_nodes(*r.scene);
    return world[static_cast<std::size_t>(r.scene->joints[0].node) + 1];
  };
  Vec3 axis = turned({0, 0, 1});
  int largest = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(axis[k]) > std::fabs(axis[largest])) largest = k;
  if (axis[largest] < 0) axis = -axis;
  const Mat4 before = flap("0"), after = flap("0.7rad");
  const Quat q = glm::angleAxis(0.7, axis);
  const Vec3 pivot(1, 2, 3);
  for (int c = 0; c < 4; ++c) {
    const Vec3 expected = c < 3 ? q * Vec3(before[c]) : pivot + q * (Vec3(before[3]) - pivot);
    EXPECT_LE(glm::length(Vec3(after[c]) - expected), 1e-14);
  }
}

TEST(JointAxis, MirroredAndUnevenlyScaledNodes) {
  for (const char* scale : {"-1 1 1", "2 2 0.1", "-3 3 50", "1e-4 1e-4 1e-4", "1e4 1e4 1e4"})
    expect_line(import(placed("flap", kTurned + std::string(" scale ") + scale, tube(0.2, 8)),
                       rule("nodes='flap' axis='auto'")),
                turned({0, 0, 1}), {1, 2, 3});
  // one that became an ellipse is none
  const Reading r = import(placed("flap", kTurned + " scale 1 1.5 1", tube(0.2, 16)),
                           rule("nodes='flap' axis='auto'"));
  EXPECT_THAT(r.summary(), HasSubstr("E1233"));
  EXPECT_TRUE(r.scene->joints.empty());
}

TEST(JointAxis, WhatIsWrittenStaysAndChooses) {
  const std::string wrl =
      placed("flap", "", kBox) +
      placed("lugs", "",
             placed("a", "translation 1 0 0", tube(0.1, 16)) +
                 placed("b", "translation -1 0 0", tube(0.1, 16)) +
                 placed("c", "rotation 1 0 0 1.5707963267948966", tube(0.1, 16)));
  // several of like size
  const Reading several = import(wrl, rule("nodes='flap' axis_from='lugs'"));
  EXPECT_THAT(several.summary(), HasSubstr("3:59 E1233 joint 'j' has several axes of like size"));
  EXPECT_THAT(several.summary(), HasSubstr("origin=\"1m 0m 0m\" axis=\"0 0 1\""));
  EXPECT_THAT(several.summary(), HasSubstr("name its node by axis_from"));
  EXPECT_TRUE(several.scene->joints.empty());
  // a point or a direction chooses
  const Reading near = import(wrl, rule("nodes='flap' axis_from='lugs' origin='-0.95 0 0.3'"));
  EXPECT_THAT(near.summary(), HasSubstr("0.05 m from the origin that is written"));
  expect_line(near, {0, 0, 1}, {-0.95, 0, 0});
  const Reading along = import(wrl, rule("nodes='flap' axis_from='lugs' axis='0 2 0.01'"));
  EXPECT_EQ(along.codes().count("N1234"), 1u) << along.summary();
  expect_line(along, {0, 2, 0.01}, {0, 0, 0});
  const Reading pin = import(wrl, rule("nodes='flap' origin='auto' axis_from='b' axis='0 0 -1'"));
  expect_line(pin, {0, 0, 1}, {-1, 0, 0});
  EXPECT_EQ(pin.scene->joints[0].axis, Vec3(0, 0, -1));
  // parallel ones have one direction
  const Reading both = import(wrl, rule("nodes='flap' axis='auto' axis_from='?' origin='5 0 0'"));
  EXPECT_THAT(both.summary(), HasSubstr("E1233"));
  const Reading nothing = import(wrl, rule("nodes='flap' axis_from='lugs' axis='1 0 0'"));
  EXPECT_THAT(nothing.summary(), HasSubstr("none is along the axis that is written"));
}

TEST(JointAxis, WhatCannotBeIsSaidAtItsPlace) {
  const std::string wrl =
      placed("flap", "", kBox) + placed("ball", "", "Shape { geometry Sphere { radius 1 } }");
  const auto summary = [&](const std::string& attributes) {
    return import(wrl, rule(attributes)).summary();
  };
  EXPECT_THAT(summary("nodes='flap' axis='auto'"),
              HasSubstr("3:54 E1233 joint 'j' has no axis: there is no cylinder, cone, torus or "
                        "circular hole in the nodes that 'flap' matches"));
  EXPECT_THAT(summary("nodes='flap' origin='auto'"), HasSubstr("3:56 E1233"));
  EXPECT_THAT(summary("nodes='flap' axis_from='ball'"), HasSubstr("E1233"));
  EXPECT_THAT(summary("nodes='flap' axis_from='bal'"),
              HasSubstr("W1501 no node of the import fits 'bal'; joint 'j' has no axis"));
  EXPECT_THAT(summary("nodes='flap' axis='1 0 0' origin='0 0 0' axis_from='ball'"),
              HasSubstr("N1405 'axis_from' has no effect"));
  EXPECT_THAT(summary("nodes='flap' axis='aut'"), HasSubstr("or auto for x of axis of <joint>"));
  EXPECT_THAT(summary("nodes='flap' axis='1 0'"),
              HasSubstr("expected 3 numbers (x y z) or auto, found 2"));
  EXPECT_THAT(summary("nodes='flap' axis='auto 0 0'"), HasSubstr("E1201"));
  const Reading around =
      read_files({{"m.pxn",
                   "<pangu_model ver='1'><joint name='j' type='continuous' axis='auto'><box "
                   "size='1'/></joint></pangu_model>"}});
  EXPECT_THAT(around.summary(), HasSubstr("E1201"));
  EXPECT_THAT(around.summary(), Not(HasSubstr("or auto")));
}

TEST(JointAxis, RemovedPartsDoNotCount) {
  const std::string wrl = placed("flap", "", kBox) + placed("pin", kTurned, tube(0.05, 16));
  const Reading r = import(wrl, "<remove nodes='pin'/>" + rule("nodes='flap' axis_from='pin'"));
  EXPECT_THAT(r.summary(), HasSubstr("E1233"));
}

}  // namespace
}  // namespace panwright::pxn::joint_axis_test
