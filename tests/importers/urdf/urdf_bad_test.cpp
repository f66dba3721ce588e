// What is wrong with a robot is said at its place, and the rest is read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/importers/urdf/urdf_reading.h"

namespace panwright::importers::urdf_bad_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kLinks = "<link name='a'/><link name='b'/><link name='c'/>\n";

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& more = "", const std::string& type = "continuous") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/>" + more + "</joint>\n";
}

// Lines begin with 3: what read_robot() puts before them.
TEST(UrdfBad, IsSaidAtItsPlace) {
  const struct {
    std::string body;
    std::vector<std::string> places;
    std::string message;
  } cases[] = {
      {kLinks + joint("x", "a", "b") + joint("y", "c", "b"),
       {"5:2 E6220", "3:34 E6220"},
       "is the child of joint 'x' already"},
      {kLinks + joint("x", "a", "b") + joint("y", "b", "c") + joint("z", "c", "a"),
       {"6:2 E6220"},
       "its own ancestor"},
      {kLinks + joint("x", "a", "a") + joint("y", "a", "b") + joint("z", "a", "c"),
       {"4:2 E6220"},
       "its own ancestor"},
      {kLinks + joint("x", "a", "b"), {"3:34 E6220"}, "has no parent joint, like 'a'"},
      {"<link name='arm'/>" + joint("x", "arm", "arn"), {"3:86 E6220"}, "did you mean 'arm'?"},
      {"<link name='a'/><link name='a'/>", {"3:18 E6220"}, "duplicate link"},
      {"<link/>", {"3:2 E6220"}, "<link> has no name"},
      {kLinks + joint("x", "a", "b") + joint("x", "b", "c"), {"5:2 E6220"}, "two joints"},
      {kLinks + joint("x", "a", "b", "", "hinge") + joint("y", "a", "c"),
       {"4:23 E6220"},
       "the type of the joint 'x' is 'hinge', expected revolute"},
      {kLinks + joint("x", "a", "b", "\n<axis xyz='0 0 0'/>") + joint("y", "a", "c"),
       {"5:12 E6220"},
       "no length"},
      {kLinks + joint("x", "a", "b", "\n<origin xyz='0 0 nan'/>") + joint("y", "a", "c"),
       {"5:14 E6220"},
       "xyz of <origin> is '0 0 nan', expected 3 numbers"},
      {kLinks + joint("x", "a", "b", "\n<origin rpy='0 1e300 0'/>") + joint("y", "a", "c"),
       {"5:14 E6220"},
       "of at most 1e+12"},
      {kLinks + joint("x", "a", "b", "\n<limit lower='1' upper='-1'/>", "prismatic") +
           joint("y", "a", "c"),
       {"5:2 E6220"},
       "the lower limit 1 is above the upper one -1"},
      {kLinks + joint("x", "a", "b", "", "revolute") + joint("y", "a", "c"),
       {"4:2 W6221"},
       "has no <limit>"},
      {kLinks + joint("x", "a", "b", "\n<mimic joint='x'/>") + joint("y", "a", "c"),
       {"5:2 E6220"},
       "follows itself"},
      {kLinks + joint("x", "a", "b", "\n<mimic joint='y'/>") +
           joint("y", "a", "c", "\n<mimic joint='x'/>"),
       {"5:2 E6220"},
       "follows itself"},
      {kLinks + joint("x", "a", "b", "\n<mimic joint='q'/>") + joint("y", "a", "c"),
       {"5:2 E6220"},
       "there is no joint 'q'"},
      {kLinks + joint("x", "a", "b", "\n<mimic joint='y'/>") + joint("y", "a", "c", "", "fixed"),
       {"5:2 E6220"},
       "cannot follow"},
      {"<link name='a'><visual>\n<geometry><box size='1 0 1'/></geometry></visual></link>",
       {"4:22 E6220"},
       "numbers above 0"},
      {"<link name='a'><visual>\n<geometry><cylinder radius='1'/></geometry></visual></link>",
       {"4:12 E6220"},
       "<cylinder> has no length"},
      {"<link name='a'><visual>\n<geometry><blob/></geometry></visual></link>",
       {"4:12 E6220"},
       "is not a geometry"},
      {"<link name='a'><visual/></link>", {"3:17 E6220"}, "no geometry"},
      {"<link name='a'><visual><geometry><sphere radius='1'/></geometry>\n<material "
       "name='m'/></visual></link>",
       {"4:2 E6220"},
       "no material 'm'"},
      {"<link name='a'><visual><geometry>\n<mesh filename='no.stl'/></geometry></visual></link>",
       {"4:17 E6010"},
       "part not found"},
      {"<link name='a'><visual><geometry>\n<mesh filename='../no.stl'/></geometry></visual></link>",
       {"4:17 E6010"},
       "--root FOLDER"},
      {"<link name='a'><visual><geometry>\n<mesh "
       "filename='robot.urdf'/></geometry></visual></link>",
       {"4:17 E6001"},
       "not part of another one"},
      {"<link name='a'/><xacro:macro/>\n<xacro:arm/>", {"3:18 E6220"}, "expand them first"},
      {"<link name='a'/>\n<link name='b'", {"5:1 E6220", "4:2 E6220"}, "not well-formed"},
  };
  for (const auto& each : cases) {
    const auto reading = read_robot(each.body);
    ASSERT_TRUE(reading->out || each.body == "<link/>") << each.body << reading->text();
    EXPECT_EQ(reading->places(), each.places) << each.body << "\n" << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr(each.message)) << each.body;
    if (reading->out) EXPECT_EQ(scene::check(reading->scene()), "") << each.body;
  }
}

TEST(UrdfBad, RobotsWithoutLinksAreRefused) {
  for (const char* text : {"<robot/>", "<robot name='x'>", "<robot><joint/></robot>"}) {
    const auto reading = read_meshes({{"r.urdf", text}});
    EXPECT_FALSE(reading->out) << text;
    EXPECT_TRUE(reading->log.contains(Code("E6220"))) << text;
  }
  const auto other = read_meshes({{"r.urdf", "<sdf/>"}});
  EXPECT_FALSE(other->out);
  EXPECT_THAT(other->text(), HasSubstr("unexpected element 'sdf', expected <robot>"));
}

TEST(UrdfBad, FormatsThatAreNotReadAreNamed) {
  const auto reading = read_robot(
      "<link name='a'><visual><geometry>\n<mesh filename='a.dae'/></geometry></visual></link>",
      {{"a.dae", "<?xml version='1.0'?><COLLADA/>"}});
  ASSERT_TRUE(reading->out);
  EXPECT_THAT(reading->places(), ElementsAre("4:17 E6001"));
  EXPECT_THAT(reading->text(), HasSubstr("COLLADA is not supported"));
}

std::string chain(int links) {
  std::string text = "<link name='l0'/>";
  for (int i = 1; i < links; ++i)
    text += fmt::format("<link name='l{}'/>", i) +
            joint(fmt::format("j{}", i), fmt::format("l{}", i - 1), fmt::format("l{}", i));
  return text;
}

TEST(UrdfBad, LimitsHold) {
  EXPECT_EQ(read_robot(chain(256))->places().size(), 0u);
  EXPECT_TRUE(read_robot(chain(300))->log.contains(Code("E6002")));
  Options options;
  options.limits.nodes = 10;
  EXPECT_TRUE(read_robot(chain(20), {}, options)->log.contains(Code("E6002")));
  options = {};
  options.limits.memory = 1000;
  EXPECT_TRUE(read_robot(chain(20), {}, options)->log.contains(Code("E6002")));
  options = {};
  options.limits.triangles = 20;  // two cubes of 12
  EXPECT_TRUE(read_robot("<link name='a'><visual><geometry><mesh filename='a.stl'/></geometry>"
                         "</visual><visual><geometry><mesh filename='b.stl'/></geometry></visual>"
                         "</link>",
                         {{"a.stl", stl_text_of(cube())}, {"b.stl", stl_text_of(cube())}}, options)
                  ->log.contains(Code("E6002")));
}

// Cut short anywhere, or with bytes changed: a sound scene or none, and always a word about it
// where something is missing.
TEST(UrdfBad, DamagedTextsGiveSoundScenes) {
  const std::string whole =
      "<robot name='r'><material name='m'><color rgba='1 0 0 1'/></material>" + kLinks +
      "<link name='d'><inertial><origin rpy='1 2 3'/><mass value='2'/><inertia ixx='1' iyy='1' "
      "izz='1'/></inertial><visual><origin xyz='1 2 3'/><geometry><mesh filename='c.stl' "
      "scale='1 2 3'/></geometry><material name='m'/></visual></link>" +
      joint("x", "a", "b", "<limit lower='-1' upper='1'/>", "revolute") +
      joint("y", "b", "c", "<mimic joint='x' multiplier='2' offset='0.5'/>") +
      joint("z", "c", "d", "<axis xyz='1 1 0'/>", "planar") + "</robot>";
  const std::string cube_text = stl_text_of(cube());
  const auto look = [&](std::string text) {
    const auto reading = read_meshes({{"r.urdf", std::move(text)}, {"c.stl", cube_text}});
    if (reading->out)
      ASSERT_EQ(scene::check(reading->scene()), "") << reading->files[0].bytes;
    else
      ASSERT_TRUE(reading->log.has_errors()) << reading->files[0].bytes;
  };
  ASSERT_FALSE(read_meshes({{"r.urdf", whole}, {"c.stl", cube_text}})->log.has_errors());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto reading = read_meshes({{"r.urdf", whole.substr(0, length)}, {"c.stl", cube_text}});
    ASSERT_TRUE(reading->log.has_errors()) << length;
    look(whole.substr(0, length));
  }
  std::mt19937_64 random(11);
  for (int i = 0; i < 4000; ++i) {
    std::string text = whole;
    for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 60));
          break;
        default:
          text[at] = "0123456789.-e'<>/ "[random() % 18];
      }
      if (text.empty()) text = "<";
    }
    look(std::move(text));
  }
}

}  // namespace
}  // namespace panwright::importers::urdf_bad_test
