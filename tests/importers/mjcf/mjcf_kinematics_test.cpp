// Models move as their descriptions say: held against products of elementary matrices in long
// double, made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "tests/importers/mjcf/mjcf_reading.h"
#include "tests/importers/robot_maps.h"

namespace panwright::importers::mjcf_kinematics_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Map shifted(const Vec3& t) {
  return shift(Vector{static_cast<long double>(t.x), static_cast<long double>(t.y),
                      static_cast<long double>(t.z)});
}

// Along a direction of any length.
Map slide(const Vec3& axis, long double by) {
  const long double x = axis.x, y = axis.y, z = axis.z;
  const long double length = std::sqrt(x * x + y * y + z * z);
  return shift(Vector{x / length * by, y / length * by, z / length * by});
}

Map from_columns(const Vec3& x, const Vec3& y) {
  const long double a[3] = {x.x, x.y, x.z}, b[3] = {y.x, y.y, y.z};
  long double e[3], f[3], length = 0, dot = 0, rest = 0;
  for (int i = 0; i < 3; ++i) length += a[i] * a[i];
  for (int i = 0; i < 3; ++i) e[i] = a[i] / std::sqrt(length);
  for (int i = 0; i < 3; ++i) dot += e[i] * b[i];
  for (int i = 0; i < 3; ++i) f[i] = b[i] - dot * e[i];
  for (int i = 0; i < 3; ++i) rest += f[i] * f[i];
  for (int i = 0; i < 3; ++i) f[i] /= std::sqrt(rest);
  Map out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    out.m[i][0] = e[i], out.m[i][1] = f[i], out.m[i][2] = e[j] * f[k] - e[k] * f[j];
  }
  return out;
}

Map from_quat(const std::array<double, 4>& q) {
  const long double w = q[0], x = q[1], y = q[2], z = q[3];
  const long double angle = 2 * std::atan2(std::sqrt(x * x + y * y + z * z), w);
  return turn_about({q[1], q[2], q[3]}, angle);
}

// The turn that takes z to a direction the short way.
Map z_to(const Vec3& v) {
  const long double x = v.x, y = v.y, z = v.z;
  return turn_about({-v.y, v.x, 0}, std::atan2(std::sqrt(x * x + y * y), z));
}

struct Orientation {
  std::string text;
  Map map;
};
Orientation some_orientation(std::size_t kind, Numbers& number, const std::string& sequence) {
  const Vec3 v = number.vector(1), w = number.vector(1);
  const double angle = number(170);
  switch (kind % 5) {
    case 0: {
      const std::array<double, 4> q{number(1), v.x, v.y, v.z};
      return {"quat='" + format_double(q[0]) + " " + numbers(v) + "'", from_quat(q)};
    }
    case 1:
      return {"axisangle='" + numbers(v) + " " + format_double(angle) + "'",
              turn_about(v, static_cast<long double>(angle) * 3.14159265358979323846L / 180)};
    case 2:
      return {"xyaxes='" + numbers(v) + " " + numbers(w) + "'", from_columns(v, w)};
    case 3:
      return {"zaxis='" + numbers(v) + "'", z_to(v)};
    default: {
      const Vec3 degrees = 170.0 * w;
      Map out;
      for (int k = 0; k < 3; ++k) {
        const char letter = sequence[static_cast<std::size_t>(k)];
        const bool along = letter >= 'a';
        const Map one = turn(static_cast<std::size_t>(letter - (along ? 'x' : 'X')),
                             static_cast<long double>(degrees[k]) * 3.14159265358979323846L / 180);
        out = along ? then(out, one) : then(one, out);
      }
      return {"euler='" + numbers(degrees) + "'", out};
    }
  }
}

// Bodies with up to three joints each, with anchors and references of their own.
TEST(MjcfKinematics, ChainsOfAllJointsMoveAsTheirProducts) {
  constexpr const char* kSequences[] = {"xyz", "zyx", "XYZ", "ZXZ", "zXy", "yxy"};
  double worst = 0;
  std::set<std::size_t> orientations;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Numbers number(seed);
    const std::string sequence = kSequences[seed % std::size(kSequences)];
    constexpr std::size_t kBodies = 7;
    std::string text = "<compiler eulerseq='" + sequence + "'/><worldbody>", ends;
    struct Motion {
      std::size_t body, type;  // 0 hinge, 1 slide, 2 ball
      Vec3 anchor, axis;
      double reference;
      std::string name;
    };
    std::vector<Motion> motions;
    std::vector<Map> placed;
    for (std::size_t i = 0; i < kBodies; ++i) {
      const Vec3 position = number.vector(2);
      orientations.insert((i + seed) % 5);
      const Orientation o = some_orientation(i + seed, number, sequence);
      placed.push_back(then(shifted(position), o.map));
      text += fmt::format("<body name='b{}' pos='{}' {}>\n", i, numbers(position), o.text);
      Vec3 anchor(0);
      for (std::size_t k = 0; k < (i * 7 + seed) % 4; ++k) {
        Motion m{i, (i + k + seed) % 3, Vec3(0), number.vector(1), 0, fmt::format("j{}_{}", i, k)};
        if ((k + seed) % 3 != 0) anchor = number.vector(1);  // else that of the one before
        m.anchor = anchor;
        if ((i + seed) % 2 == 0 && m.type != 2) m.reference = m.type == 0 ? number(100) : number(1);
        constexpr const char* kTypes[] = {"hinge", "slide", "ball"};
        text += fmt::format("<joint name='{}' type='{}' pos='{}' axis='{}'{}/>\n", m.name,
                            kTypes[m.type], numbers(m.anchor), numbers(m.axis),
                            m.reference != 0 ? " ref='" + format_double(m.reference) + "'" : "");
        motions.push_back(m);
      }
      text += "<geom size='0.1'/>";
      ends += "</body>";
    }
    const auto reading = read_mujoco(text + ends + "</worldbody>");
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
    scene::Scene scene = reading->scene();
    ASSERT_EQ(scene.joints.size(), motions.size());
    EXPECT_EQ(scene::check(scene), "");
    // as the file stands: each at its reference, no joint has moved
    for (int pose = 0; pose < 2; ++pose) {
      Map expected;
      std::size_t next = 0;
      for (std::size_t i = 0; i < kBodies; ++i) {
        expected = then(expected, placed[i]);
        for (; next < motions.size() && motions[next].body == i; ++next) {
          const Motion& m = motions[next];
          scene::Joint& joint = *joint_named(scene, m.name);
          if (pose == 0) continue;
          Map motion;
          const long double degree = 3.14159265358979323846L / 180;
          if (m.type == 2) {
            const Vec3 angles = number.vector(3);
            joint.value = {angles.x, angles.y, angles.z};
            motion = roll_pitch_yaw(angles);
          } else {
            const double q = number(3);
            joint.value = {q};
            motion = m.type == 0 ? turn_about(m.axis, q - m.reference * degree)
                                 : slide(m.axis, static_cast<long double>(q) - m.reference);
          }
          expected = then(expected, then(shifted(m.anchor), then(motion, shifted(-m.anchor))));
        }
        const std::vector<Mat4> world = scene::world_from_nodes(scene);
        worst =
            std::max(worst, difference(world[node_index(scene, fmt::format("b{}", i))], expected));
      }
    }
  }
  EXPECT_EQ(orientations.size(), 5u);
  EXPECT_LT(worst, 1e-12);  // metres and entries of rotations, of coordinates up to 20
}

TEST(MjcfKinematics, JointsOfOneAnchorShareANode) {
  const auto reading = read_mujoco(
      "<worldbody><body name='gimbal'><joint name='x' axis='1 0 0'/><joint name='y' axis='0 1 0'/>"
      "<joint name='s' type='slide'/><geom size='1'/></body></worldbody>");
  ASSERT_TRUE(reading->out) << reading->text();
  const scene::Scene& scene = reading->scene();
  for (const scene::Joint& joint : scene.joints)
    EXPECT_EQ(scene.nodes[static_cast<std::size_t>(joint.node)].name, "gimbal");
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_EQ(scene.nodes.size(), 3u);
}

TEST(MjcfKinematics, KindsLimitsAndUnits) {
  const auto reading = read_mujoco(R"(<worldbody><body><joint name="h" range="-90 45"/>
<joint name="c"/><joint name="off" range="-90 45" limited="false"/><joint name="s" type="slide" range="0 0.5"/>
<joint name="long" type="slide"/><geom size="1"/></body>
<body name="f"><freejoint name="fly"/><geom size="1"/></body><body name="g" pos="0 1 0"><joint type="ball"/><geom size="1"/></body></worldbody>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty());
  scene::Scene scene = reading->scene();
  using geometry::JointKind;
  EXPECT_EQ(joint_named(scene, "h")->kind, JointKind::revolute);
  EXPECT_EQ(joint_named(scene, "h")->axis, Vec3(0, 0, 1));
  EXPECT_DOUBLE_EQ(joint_named(scene, "h")->lower.at(0), -kPi / 2);
  EXPECT_DOUBLE_EQ(joint_named(scene, "h")->upper.at(0), kPi / 4);
  EXPECT_EQ(joint_named(scene, "c")->kind, JointKind::continuous);
  EXPECT_EQ(joint_named(scene, "off")->kind, JointKind::continuous);
  EXPECT_EQ(joint_named(scene, "s")->kind, JointKind::prismatic);
  EXPECT_THAT(joint_named(scene, "s")->upper, ElementsAre(0.5));
  EXPECT_THAT(joint_named(scene, "long")->upper, IsEmpty());
  EXPECT_EQ(joint_named(scene, "fly")->kind, JointKind::general);
  EXPECT_EQ(joint_named(scene, "g_joint")->kind, JointKind::ball);
  const auto radians = read_mujoco(
      "<compiler angle='radian'/><worldbody><body euler='0 0 1'><joint range='-1 2' ref='0.5'/>"
      "<geom size='1'/></body></worldbody>");
  EXPECT_THAT(radians->scene().joints.at(0).lower, ElementsAre(-1));
  EXPECT_THAT(radians->scene().joints.at(0).value, ElementsAre(0.5));
}

TEST(MjcfKinematics, CouplingsAreFollowersAboutTheirReferences) {
  const auto reading = read_mujoco(R"(<worldbody><body><joint name="x" ref="30"/><geom size="1"/>
<body name="b"><joint name="y" type="slide" ref="0.25" axis="1 0 0"/><geom size="1"/>
<body><joint name="z" range="-20 20"/><geom size="1"/></body></body></body></worldbody>
<equality><joint joint1="y" joint2="x" polycoef="0.125 -2 0 0 0"/><joint joint1="z" polycoef="0.1"/></equality>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  scene::Scene scene = reading->scene();
  const scene::Joint& y = *joint_named(scene, "y");
  EXPECT_EQ(scene.joints[static_cast<std::size_t>(y.mimic)].name, "x");
  EXPECT_EQ(y.multiplier, -2);
  // y − 0.25 = 0.125 − 2 (x − 30°)
  joint_named(scene, "x")->value = {0.8};
  const double expected = 0.25 + 0.125 - 2 * (0.8 - kPi / 6);
  // the body stands as in the file where y is 0.25
  const auto world = scene::world_from_nodes(scene);
  const Map at = then(turn(2, 0.8L - 3.14159265358979323846L / 6),
                      shift(Vector{static_cast<long double>(expected) - 0.25L, 0, 0}));
  EXPECT_LT(difference(world[node_index(scene, "b")], at), 1e-15);
  const scene::Joint& z = *joint_named(scene, "z");
  EXPECT_THAT(z.lower, ElementsAre(0.1));
  EXPECT_THAT(z.upper, ElementsAre(0.1));
}

TEST(MjcfKinematics, FramesAreOfTheirBody) {
  const auto reading = read_mujoco(R"(<worldbody><frame pos="1 0 0" euler="0 0 90">
<body name="a" pos="2 0 0"><frame pos="0 0 3" zaxis="1 0 0"><joint name="j" pos="0 0 0.5" axis="0 0 1"/>
<geom name="g" size="0.1" pos="0 0 1"/></frame><site name="port" pos="0 1 0" zaxis="0 1 0"/>
<camera name="eye" pos="0 0 1"/></body></frame></worldbody>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  scene::Scene scene = reading->scene();
  const auto world = scene::world_from_nodes(scene);
  EXPECT_LT(glm::length(Vec3(world[node_index(scene, "a")][3]) - Vec3(1, 2, 0)), 1e-15);
  EXPECT_LT(glm::length(Vec3(world[node_index(scene, "g")][3]) - Vec3(1, 3, 3)), 1e-15);
  EXPECT_LT(glm::length(scene.joints[0].axis - Vec3(1, 0, 0)), 1e-15);
  ASSERT_EQ(scene.frames.size(), 2u);
  const scene::Frame& port = scene.frames[0];
  EXPECT_EQ(port.name, "port");
  EXPECT_EQ(port.origin, Vec3(0, 1, 0));
  EXPECT_LT(glm::length(port.rotation * Vec3(0, 0, 1) - Vec3(0, 1, 0)), 1e-15);
  // a camera of MuJoCo looks along −z with y up; a frame along +z with y down
  const scene::Frame& eye = scene.frames[1];
  EXPECT_LT(glm::length(eye.rotation * Vec3(0, 0, 1) - Vec3(0, 0, -1)), 1e-15);
  EXPECT_LT(glm::length(eye.rotation * Vec3(0, 1, 0) - Vec3(0, -1, 0)), 1e-15);
}

}  // namespace
}  // namespace panwright::importers::mjcf_kinematics_test
