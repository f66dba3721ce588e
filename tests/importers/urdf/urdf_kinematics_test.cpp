// Robots move as their descriptions say: held against products of elementary matrices in long
// double, made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/importers/robot_maps.h"
#include "tests/importers/urdf/urdf_reading.h"

namespace panwright::importers::urdf_kinematics_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(UrdfKinematics, ChainsOfAllJointsMoveAsTheirProducts) {
  constexpr const char* kTypes[] = {"revolute", "continuous", "prismatic", "fixed", "floating"};
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Numbers number(seed);
    constexpr std::size_t kLinks = 8;
    std::string text = "<link name='l0'/>";
    std::array<Vec3, kLinks> xyz{}, rpy{}, axis{};
    std::array<std::size_t, kLinks> type{};
    for (std::size_t i = 1; i < kLinks; ++i) {
      xyz[i] = number.vector(2), rpy[i] = number.vector(3.1), axis[i] = number.vector(1);
      type[i] = (i + seed) % std::size(kTypes);
      text += fmt::format(
          "<link name='l{0}'/><joint name='j{0}' type='{1}'><parent link='l{2}'/><child "
          "link='l{0}'/><origin xyz='{3}' rpy='{4}'/><axis xyz='{5}'/>{6}</joint>\n",
          i, kTypes[type[i]], i - 1, numbers(xyz[i]), numbers(rpy[i]), numbers(axis[i]),
          type[i] == 0 || type[i] == 2 ? "<limit lower='-4' upper='4' effort='1' velocity='1'/>"
                                       : "");
    }
    const auto reading = read_robot(text);
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
    scene::Scene scene = reading->scene();
    ASSERT_EQ(scene.joints.size(), kLinks - 1);
    Map expected;
    for (std::size_t i = 1; i < kLinks; ++i) {
      expected =
          then(expected, then(shift({xyz[i].x, xyz[i].y, xyz[i].z}), roll_pitch_yaw(rpy[i])));
      scene::Joint& joint = *joint_named(scene, fmt::format("j{}", i));
      const double q = number(3.9);
      const double length = glm::length(axis[i]);
      if (type[i] <= 1) {
        joint.value = {q};
        expected = then(expected, turn_about(axis[i], q));
      } else if (type[i] == 2) {
        joint.value = {q};
        const Vec3 unit = axis[i] / length;
        expected = then(expected, shift({static_cast<long double>(unit.x) * q,
                                         static_cast<long double>(unit.y) * q,
                                         static_cast<long double>(unit.z) * q}));
      } else if (type[i] == 4) {
        const Vec3 turned = number.vector(3), moved = number.vector(2);
        joint.value = {1, 1, 1, turned.x, turned.y, turned.z, moved.x, moved.y, moved.z};
        expected = then(expected, then(shift({moved.x, moved.y, moved.z}), roll_pitch_yaw(turned)));
      }
      const std::vector<Mat4> world = scene::world_from_nodes(scene);
      worst =
          std::max(worst, difference(world[node_index(scene, fmt::format("l{}", i))], expected));
    }
    EXPECT_EQ(scene::check(scene), "");
  }
  EXPECT_LT(worst, 1e-12);  // metres and entries of rotations, of coordinates up to 20
}

TEST(UrdfKinematics, AnArmOfTwoLinks) {
  const auto reading = read_robot(R"(
<link name="base"/><link name="upper"/><link name="lower"/><link name="tip"/>
<joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="2 0 0"/><axis xyz="0 0 3"/></joint>
<joint name="c" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="1.5 0 0"/></joint>)");
  ASSERT_TRUE(reading->out) << reading->text();
  scene::Scene scene = reading->scene();
  Numbers number(3);
  for (int i = 0; i < 100; ++i) {
    const double a = number(9), b = number(9);
    joint_named(scene, "a")->value = {a};
    joint_named(scene, "b")->value = {b};
    const Vec3 tip(scene::world_from_nodes(scene)[node_index(scene, "tip")][3]);
    const Vec3 expected(2 * std::cos(a) + 1.5 * std::cos(a + b),
                        2 * std::sin(a) + 1.5 * std::sin(a + b), 0);
    EXPECT_LT(glm::length(tip - expected), 1e-14);
  }
}

TEST(UrdfKinematics, TheUsualAxisIsX) {
  const auto reading = read_robot(R"(<link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>)");
  ASSERT_TRUE(reading->out);
  EXPECT_EQ(reading->scene().joints.at(0).axis, Vec3(1, 0, 0));
  EXPECT_EQ(reading->scene().joints.at(0).kind, scene::JointKind::continuous);
}

TEST(UrdfKinematics, FollowersAreLedAcrossEachOther) {
  const auto reading = read_robot(R"(
<link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="late" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1"/><mimic joint="middle" multiplier="-2" offset="0.25"/></joint>
<joint name="middle" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1"/><mimic joint="lead" multiplier="0.5"/></joint>
<joint name="lead" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2"/></joint>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty());
  scene::Scene scene = reading->scene();
  joint_named(scene, "lead")->value = {0.6};
  // middle = 0.3, late = −2·0.3 + 0.25
  Map expected = then(turn(2, -0.35L), then(shift({0, 0, 0.3L}), turn(2, 0.6L)));
  EXPECT_LT(difference(scene::world_from_nodes(scene)[node_index(scene, "d")], expected), 1e-15);
  joint_named(scene, "lead")->value = {-2};  // late is held by its limit: 2.25 → 1
  expected = then(turn(2, 1), then(shift({0, 0, -1}), turn(2, -2)));
  EXPECT_LT(difference(scene::world_from_nodes(scene)[node_index(scene, "d")], expected), 1e-15);
}

TEST(UrdfKinematics, PlanarJointsSlideInTheirPlane) {
  const auto reading = read_robot(R"(<link name="a"/><link name="b"/>
<joint name="p" type="planar"><parent link="a"/><child link="b"/><origin xyz="1 2 3"/><axis xyz="1 2 2"/></joint>)");
  ASSERT_TRUE(reading->out) << reading->text();
  scene::Scene scene = reading->scene();
  ASSERT_EQ(scene.joints.size(), 2u);
  const scene::Joint &x = *joint_named(scene, "p x"), &y = *joint_named(scene, "p y");
  const Vec3 normal = Vec3(1, 2, 2) / 3.0;
  EXPECT_EQ(x.kind, scene::JointKind::prismatic);
  EXPECT_NEAR(glm::dot(x.axis, normal), 0, 1e-15);
  EXPECT_NEAR(glm::dot(y.axis, normal), 0, 1e-15);
  EXPECT_LT(glm::length(glm::cross(x.axis, y.axis) - normal), 1e-15);
  scene.joints[0].value = {0.5};
  scene.joints[1].value = {-2};
  const Vec3 at(scene::world_from_nodes(scene)[node_index(scene, "b")][3]);
  EXPECT_LT(glm::length(at - (Vec3(1, 2, 3) + 0.5 * x.axis - 2.0 * y.axis)), 1e-15);
}

TEST(UrdfKinematics, LimitsMassesAndInertia) {
  const auto reading = read_robot(R"(<link name="a"/>
<link name="b"><inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="4"/>
  <inertia ixx="1" ixy="0.1" ixz="0" iyy="2" iyz="0.2" izz="3"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="0.5" upper="2"/></joint>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), ElementsAre("6:2 W6221"));  // it cannot begin at 0
  const scene::Joint& joint = reading->scene().joints.at(0);
  EXPECT_THAT(joint.lower, ElementsAre(0.5));
  EXPECT_THAT(joint.upper, ElementsAre(2));
  EXPECT_THAT(joint.value, ElementsAre(0.5));
  EXPECT_EQ(joint.mass, 4.0);
  EXPECT_EQ(joint.centre_of_mass, Vec3(0.1, 0.2, 0.3));
  ASSERT_TRUE(joint.inertia);
  // a quarter turn about z: x → y, y → −x
  const Mat3 expected(2, -0.1, -0.2, -0.1, 1, 0, -0.2, 0, 3);
  for (int i = 0; i < 3; ++i) EXPECT_LT(glm::length((*joint.inertia)[i] - expected[i]), 1e-15);
}

}  // namespace
}  // namespace panwright::importers::urdf_kinematics_test
