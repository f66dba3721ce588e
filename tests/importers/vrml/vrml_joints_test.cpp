// Joints of VRML prototypes move as their fields say.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/importers/vrml/vrml_reading.h"
#include "tests/support/affine_maps.h"

namespace panwright::importers::vrml::vrml_joints_test {
namespace {

const std::string kJoint = R"(
PROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children []
  exposedField MFFloat llimit [] exposedField MFFloat ulimit [] exposedField SFString name ""
  exposedField SFRotation rotation 0 0 1 0 exposedField SFVec3f translation 0 0 0
  exposedField SFVec3f scale 1 1 1 exposedField SFRotation scaleOrientation 0 0 1 0
  exposedField SFString jointType "" exposedField SFInt32 jointId -1
  exposedField SFVec3f jointAxis 0 0 1 ]
{ Transform { center IS center children IS children rotation IS rotation scale IS scale
    scaleOrientation IS scaleOrientation translation IS translation } }
)";

using support::Map;
using support::Vector;

Map moved(long double x, long double y, long double z) {
  Map out;
  out.t = {x, y, z};
  return out;
}

Map scaled(long double x, long double y, long double z) {
  Map out;
  out.m[0][0] = x, out.m[1][1] = y, out.m[2][2] = z;
  return out;
}

// About a unit axis: cos·I + sin·K + (1 − cos)·a·aᵀ.
Map turned(const Vector& a, long double angle) {
  const long double c = std::cos(angle), s = std::sin(angle);
  const long double k[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
  Map out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out.m[i][j] = (i == j ? c : 0) + s * k[i][j] + (1 - c) * a[i] * a[j];
  return out;
}

double distance(const Mat4& world, const Vec3& p, const Vector& expected) {
  const Vec4 at = world * Vec4(p, 1);
  long double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const long double d = at[static_cast<int>(k)] - expected[k];
    sum += d * d;
  }
  return static_cast<double>(std::sqrt(sum));
}

// An arm that turns about a centre and slides, under rotations and scales of the joints' own:
// p' = T·C·R·M(q)·SR·S·SR⁻¹·C⁻¹·p, of ISO/IEC 14772-1 6.52 with the motion after the rotation.
TEST(VrmlJoints, MoveAsTheirClosedForm) {
  const auto reading = read_files({{"arm.wrl", kHeader97 + kJoint + R"(
DEF ARM Joint { jointType "rotate" jointAxis 0 0.6 0.8 translation 0.1 0.2 0.3 center 1 -2 0.5
  rotation 0 0 1 0.7 scale 2 2 2 children [
    DEF SLIDE Joint { jointType "slide" jointAxis 1 0 0 translation 0 0 1 rotation 0 1 0 -0.4
      scale 3 0.5 1.5 scaleOrientation 1 0 0 0.3 children [
        DEF HAND Joint { jointType "rotate" jointAxis 0 1 0 translation 0.25 0 0 children
          DEF TIP Transform { translation 0 0.5 0 children Shape { geometry Box {} } } } ] } ] }
)"}});
  ASSERT_TRUE(reading->out) << to_text(reading->log);
  scene::Scene scene = reading->scene();
  ASSERT_EQ(scene.joints.size(), 3u);
  std::mt19937_64 random(7);
  const auto number = [&] {  // −3 to 3
    return 6 * (static_cast<double>(random() >> 11) * 0x1p-53) - 3;
  };
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    std::array<double, 3> q{};
    for (std::size_t k = 0; k < 3; ++k) {
      q[k] = number();
      for (scene::Joint& joint : scene.joints)
        if (joint.name == std::array{"ARM", "SLIDE", "HAND"}[k]) joint.value = {q[k]};
    }
    Map tip = then(moved(0.1L, 0.2L, 0.3L), moved(1, -2, 0.5L));
    for (const Map& next :
         {turned({0, 0, 1}, 0.7L), turned({0, 0.6L, 0.8L}, q[0]), scaled(2, 2, 2),
          moved(-1, 2, -0.5L), moved(0, 0, 1), turned({0, 1, 0}, -0.4L), moved(q[1], 0, 0),
          turned({1, 0, 0}, 0.3L), scaled(3, 0.5L, 1.5L), turned({1, 0, 0}, -0.3L),
          moved(0.25L, 0, 0), turned({0, 1, 0}, q[2]), moved(0, 0.5L, 0)})
      tip = then(tip, next);
    const std::vector<Mat4> world = scene::world_from_nodes(scene);
    for (const Vec3& p : {Vec3(0), Vec3(1, 0, 0), Vec3(0, 0, 1)})
      worst =
          std::max(worst, distance(world[reading->index("TIP")], p, apply(tip, {p.x, p.y, p.z})));
  }
  // fields are read as doubles; measured 6e-15
  EXPECT_LT(worst, 1e-13);
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_joints_test
