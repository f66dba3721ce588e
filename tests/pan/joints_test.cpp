// Joints in the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pan/diff.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::joints_test {
namespace {

using geometry::JointKind;
using support::problems;
using ::testing::HasSubstr;

// Three nodes in a line: the second turns, the third slides after it.
Contents jointed() {
  Contents contents = support::small_contents();
  JointContent turn;
  turn.name = "turn";
  turn.node = 1;
  turn.joint.kind = JointKind::continuous;
  turn.value[0] = 0.5;
  turn.pointing = Vec3(0, 1, 0);
  turn.points_at_sun = true;
  JointContent slide;
  slide.name = "slide";
  slide.node = 2;
  slide.joint.kind = JointKind::prismatic;
  slide.joint.axis = {1, 0, 0};
  slide.joint.limited = true;
  slide.joint.lower[0] = -2;
  slide.joint.upper[0] = 3;
  slide.joint.mimic = 0;
  slide.joint.multiplier = 4;
  slide.joint.offset = 0.25;
  contents.joints = {turn, slide};
  return contents;
}

TEST(Joints, ComeBack) {
  DiagnosticLog log;
  auto model = Model::from_bytes(write_to_memory(jointed()), "test.pan", log);
  ASSERT_TRUE(model && model->check(log)) << to_text(log);
  ASSERT_EQ(model->joints().size(), 2u);
  EXPECT_EQ(model->joint_name(0), "turn");
  EXPECT_EQ(model->find_joint("slide"), 1u);
  EXPECT_FALSE(model->find_joint("slid"));
  const geometry::Joint slide = kinematic(model->joints()[1]);
  EXPECT_EQ(slide.kind, JointKind::prismatic);
  EXPECT_EQ(slide.axis, Vec3(1, 0, 0));
  EXPECT_TRUE(slide.limited);
  EXPECT_EQ(slide.lower[0], -2);
  EXPECT_EQ(slide.upper[0], 3);
  EXPECT_EQ(slide.mimic, 0);
  EXPECT_EQ(slide.multiplier, 4);
  EXPECT_EQ(slide.offset, 0.25);
  EXPECT_EQ(model->joints()[0].pointing[1], 1);
  EXPECT_EQ(model->joints()[0].flags, layout::kJointPointsAtSun);
  // 4·0.5 + 0.25, within its limits
  EXPECT_EQ(model->initial_values()[1][0], 2.25);

  // a reader that knows no joints would draw another model
  EXPECT_EQ(model->header().required_features, layout::kFeatureJointValues);
  EXPECT_EQ(model->header().minor, 1);
  Contents rest = jointed();
  rest.joints.resize(1);
  rest.joints[0].value = {};
  auto at_rest = Model::from_bytes(write_to_memory(rest), "test.pan", log);
  ASSERT_TRUE(at_rest && at_rest->check(log)) << to_text(log);
  EXPECT_EQ(at_rest->header().required_features, 0u);
  EXPECT_EQ(at_rest->header().minor, 0);

  Contents bare = jointed();
  bare.joints.clear();
  auto none = Model::from_bytes(write_to_memory(bare), "test.pan", log);
  ASSERT_TRUE(none && none->check(log));
  EXPECT_EQ(none->entry(layout::SectionKind::joints), nullptr);
}

// World matrices are those of the initial values: T·R·S of the node, then the motion.
TEST(Joints, ModelsStandAtTheirInitialValues) {
  DiagnosticLog log;
  Contents contents = jointed();
  contents.joints[1].joint.mimic = -1;
  contents.joints[1].value[0] = 2;
  auto model = Model::from_bytes(write_to_memory(contents), "test.pan", log);
  ASSERT_TRUE(model && model->check(log)) << to_text(log);
  const auto world = model->world_from_nodes();
  const auto nodes = model->nodes();
  Mat4 turn(1);
  turn[0] = Vec4(std::cos(0.5), std::sin(0.5), 0, 0);
  turn[1] = Vec4(-std::sin(0.5), std::cos(0.5), 0, 0);
  Mat4 shift(1);
  shift[3] = Vec4(2, 0, 0, 1);
  const Mat4 second = parent_from_node(nodes[0]) * parent_from_node(nodes[1]) * turn;
  const Mat4 third = second * parent_from_node(nodes[2]) * shift;
  for (int c = 0; c < 4; ++c) {
    EXPECT_LE(glm::length(world[1][c] - second[c]), 1e-15);
    EXPECT_LE(glm::length(world[2][c] - third[c]), 2e-11);  // of 1e5 m: measured 1.5e-11
  }
  ASSERT_EQ(model->frames()[0].node, 1u);
  EXPECT_EQ(model->world_from_frame(0), world[1] * node_from_frame(model->frames()[0]));
}

TEST(Joints, AreCheckedAgainstTheRules) {
  EXPECT_EQ(problems(jointed()), "");
  const auto broken = [](auto change) {
    Contents contents = jointed();
    change(contents);
    return problems(contents);
  };
  EXPECT_THAT(broken([](Contents& c) {
                c.joints[0].joint.axis = {0, 0, 2};
              }),
              HasSubstr("joints[0] has an axis that is not of unit length"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].pointing = Vec3(0, 0, 2); }),
              HasSubstr("joints[0] has a pointing direction"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].joint.lower[0] = 4; }),
              HasSubstr("joints[1] has a lower limit above the upper one"));
  EXPECT_THAT(broken([](Contents& c) {
                c.joints[1].joint.mimic = -1;
                c.joints[1].value[0] = 7;
              }),
              HasSubstr("joints[1] has an initial value outside its limits"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].value[1] = 7; }),
              HasSubstr("joints[0] has a value 1 beyond those of its kind"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].joint.lower[5] = -1; }),
              HasSubstr("joints[1] has limits of value 5, which its kind does not have"));
  EXPECT_THAT(broken([](Contents& c) {
                c.joints[1].joint = {};
                c.joints[1].joint.kind = JointKind::scale;
              }),
              HasSubstr("joints[1] has an initial factor of 0"));
  EXPECT_THAT(broken([](Contents& c) { std::swap(c.joints[0], c.joints[1]); }),
              HasSubstr("is out of order, expected them ascending by node"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].name.clear(); }),
              HasSubstr("joints[1] has no name"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].name = "turn"; }),
              HasSubstr("two joints have the name 'turn'"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].joint.mimic = 1; }),
              HasSubstr("joints[1].mimic is a joint that it cannot follow"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].joint.mimic = 1; }),
              HasSubstr("mimic is a joint that it cannot follow"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].joint.mimic = 2; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].node = 3; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].value[0] = NAN; }), HasSubstr("E4012"));
  support::OpenPan file(write_to_memory(jointed()));
  file.at<layout::Joint>(layout::SectionKind::joints, 0).kind = 7;
  file.seal();
  DiagnosticLog log;
  auto model = Model::from_bytes(file.bytes(), "test.pan", log);
  EXPECT_FALSE(model && model->check(log));
  EXPECT_THAT(to_text(log), HasSubstr("joints[0].kind is 7"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].pointing = Vec3(0, 0, 1); }),
              HasSubstr("joints[1] points without turning"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[1].gimbal = 0; }),
              HasSubstr("joints[1] aims without a pointing direction"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].gimbal = 1; }),
              HasSubstr("joints[0] has a gimbal that does not turn"));
  EXPECT_THAT(broken([](Contents& c) { c.joints[0].gimbal = 0; }),
              HasSubstr("joints[0] has a gimbal that is not above it"));
}

TEST(Joints, DifferencesAreNamed) {
  const auto model = [](const Contents& contents) {
    DiagnosticLog log;
    auto out = Model::from_bytes(write_to_memory(contents), "test.pan", log);
    EXPECT_TRUE(out && out->check(log)) << to_text(log);
    return std::move(*out);
  };
  const Model a = model(jointed());
  const auto difference = [&](auto change) {
    Contents contents = jointed();
    change(contents);
    std::string out;
    for (const Difference& each : diff(a, model(contents), 20).model)
      out += each.where + ": " + each.what + "\n";
    return out;
  };
  EXPECT_EQ(difference([](Contents&) {}), "");
  EXPECT_THAT(difference([](Contents& c) { c.joints[1].joint.upper[0] = 2.5; }),
              HasSubstr("joint 'slide': upper"));
  EXPECT_THAT(difference([](Contents& c) {
                c.joints[1].joint.mimic = -1;
                c.joints[1].value[0] = 1;
              }),
              HasSubstr("joint 'slide': follows joint 'turn' in a, none in b"));
  EXPECT_THAT(difference([](Contents& c) { c.joints[1].node = 1; }),
              HasSubstr("joint 'slide': at node"));
  EXPECT_THAT(difference([](Contents& c) { c.joints.pop_back(); }), HasSubstr("joint 'slide'"));
}

}  // namespace
}  // namespace panwright::pan::joints_test
