// What is wrong with a model is said at its place, and the rest is read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/importers/mjcf/mjcf_reading.h"

namespace panwright::importers::mjcf_bad_test {
namespace {

using testing::HasSubstr;

std::string body(const std::string& inside) {
  return "<worldbody><body>\n" + inside + "<geom size='1'/></body></worldbody>";
}

// Lines begin with 3: what read_mujoco() puts before them.
TEST(MjcfBad, IsSaidAtItsPlace) {
  const struct {
    std::string text;
    std::vector<std::string> places;
    std::string message;
  } cases[] = {
      {"<worldbody><joint/><geom size='1'/></worldbody>", {"3:13 E6220"}, "the world, which does"},
      {body("<joint axis='0 0 0'/>"), {"4:14 E6220"}, "no length"},
      {body("<joint axis='0 0'/>"), {"4:14 E6220"}, "axis of <joint> is '0 0', expected 3 numbers"},
      {body("<joint pos='0 0 nan'/>"), {"4:13 E6220"}, "'0 0 nan'"},
      {body("<joint pos='0 1e300 0'/>"), {"4:13 E6220"}, "of at most 1e+12"},
      {body("<joint type='revolute'/>"), {"4:14 E6220"}, "expected hinge or slide or ball or free"},
      {body("<joint range='5 -5'/>"), {"4:15 E6220"}, "not below the upper one"},
      {body("<joint limited='true'/>"), {"4:2 E6220"}, "has no range"},
      {body("<joint type='ball' range='0 90'/>"), {"4:27 W6221"}, "moves freely"},
      {"<compiler autolimits='false'/>" + body("<joint range='-5 5'/>"),
       {"4:15 W6221"},
       "autolimits"},
      {body("<joint range='10 20'/>"), {"4:2 W6221"}, "it begins at 0.17"},
      {body("<joint/><freejoint/>"), {"4:10 E6220"}, "only joint of a body"},
      {body("<freejoint/><joint/>"), {"4:14 E6220"}, "beside a free one"},
      {body("<body><freejoint/><geom size='1'/></body>"), {"4:8 E6220"}, "a body of the world"},
      {body("<joint name='a'/><joint name='a'/>"), {"4:19 E6220"}, "two joints are called 'a'"},
      {body("<joint class='arn'/>") + "<default><default class='arm'/></default>",
       {"4:15 E6220"},
       "did you mean 'arm'?"},
      {"<default><default/></default>" + body(""), {"3:11 E6220"}, "has no class"},
      {"<default><default class='a'/><default class='b'><default class='a'/></default></default>" +
           body(""),
       {"3:50 E6220"},
       "duplicate class"},
      {body("<body quat='1 0 0 0' euler='0 0 1'><geom size='1'/></body>"),
       {"4:2 E6220"},
       "has 2 orientations"},
      {body("<geom size='1' quat='0 0 0 0'/>"), {"4:22 E6220"}, "is 0, expected w x y z"},
      {body("<geom size='1' xyaxes='1 0 0 2 0 0'/>"), {"4:24 E6220"}, "parallel"},
      {"<compiler eulerseq='xyq'/>" + body(""), {"3:21 E6220"}, "three letters"},
      {"<compiler angle='grad'/>" + body(""), {"3:18 E6220"}, "degree or radian"},
      {"<compiler coordinate='global'/>" + body(""), {"3:23 E6220"}, "expected local"},
      {body("<geom/>"), {"4:2 E6220"}, "has no size"},
      {body("<geom type='box' size='1 0 1'/>"), {"4:24 E6220"}, "3 numbers above 0"},
      {body("<geom type='capsule' size='1' fromto='1 1 1 1 1 1'/>"), {"4:39 E6220"}, "the same"},
      {body("<geom type='mesh' mesh='cub'/>") + "<asset><mesh file='cube.stl'/></asset>",
       {"4:25 E6220"},
       "did you mean 'cube'?"},
      {body("<geom type='mesh'/>"), {"4:2 E6220"}, "has no mesh"},
      {body("<geom size='1' material='m'/>"), {"4:26 E6220"}, "no material 'm'"},
      {"<asset><material name='m' texture='t'/></asset>" + body(""),
       {"3:36 E6220"},
       "no texture 't'"},
      {"<asset><mesh name='a' file='no.stl'/></asset>" + body("<geom mesh='a'/>"),
       {"3:29 E6010"},
       "part not found"},
      {"<asset><mesh name='a' file='../no.stl'/></asset>" + body("<geom mesh='a'/>"),
       {"3:29 E6010"},
       "--root FOLDER"},
      {"<asset><mesh name='a' file='model.xml'/></asset>" + body("<geom mesh='a'/>"),
       {"3:29 E6001"},
       "not part of another one"},
      {"<asset><mesh name='a' file='c.stl'/><mesh name='a' file='d.stl'/></asset>" + body(""),
       {"3:38 E6220"},
       "duplicate mesh"},
      {"<include file='other.xml'/>" + body(""), {"3:16 E6010"}, "does not exist"},
      {"<include/>" + body(""), {"3:2 E6220"}, "<include> has no file"},
      {"<include file='model.xml'/>" + body(""), {"3:16 E6220"}, "includes itself"},
      {body("<replicate count='0'/>"), {"4:19 E6220"}, "count of 1 or more"},
      {body("<replicate><geom size='1'/></replicate>"), {"4:2 E6220"}, "count of 1 or more"},
      {body("<attach/><attach/>"), {"4:2 E6220"}, "1 more like this one"},
      {"<equality><joint joint1='a' joint2='b'/></equality>" + body("<joint name='a'/>"),
       {"3:12 E6220"},
       "no hinge or slide 'b'"},
      {"<equality><joint joint1='a' joint2='a'/></equality>" + body("<joint name='a'/>"),
       {"3:12 E6220"},
       "follows itself"},
      {"<equality><joint joint1='a' joint2='b'/>\n<joint joint1='b' joint2='a'/></equality>" +
           body("<joint name='a'/><joint name='b'/>"),
       {"4:2 E6220"},
       "follows itself"},
      {"<equality><joint joint1='a' joint2='b'/>\n<joint joint1='a'/></equality>" +
           body("<joint name='a'/><joint name='b'/>"),
       {"4:2 W6221"},
       "already"},
      {"<equality><joint joint1='a' joint2='b' polycoef='0 1 2'/></equality>" +
           body("<joint name='a'/><joint name='b'/>"),
       {"3:12 W6221"},
       "follows a curve"},
      {body("<site name='s'/><camera name='s'/>"), {"4:18 W6221"}, "duplicate frame"},
      {body("") + "<worldbody><body name='b'", {"5:1 E6220"}, "not well-formed"},
  };
  for (const auto& each : cases) {
    const auto reading = read_mujoco(each.text);
    ASSERT_TRUE(reading->out) << each.text << reading->text();
    EXPECT_EQ(reading->places(), each.places) << each.text << "\n" << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr(each.message)) << each.text;
    EXPECT_EQ(scene::check(reading->scene()), "") << each.text;
  }
}

TEST(MjcfBad, ModelsWithoutAnythingAreRefused) {
  for (const char* text : {"<mujoco/>", "<mujoco model='x'>", "<mujoco><worldbody/></mujoco>"}) {
    const auto reading = read_meshes({{"r.xml", text}});
    EXPECT_FALSE(reading->out) << text;
    EXPECT_TRUE(reading->log.contains(Code("E6220"))) << text;
  }
  const auto other = read_meshes({{"r.mjcf", "<sdf/>"}});
  EXPECT_FALSE(other->out);
  EXPECT_THAT(other->text(), HasSubstr("unexpected element 'sdf', expected <mujoco>"));
}

std::string chain(int bodies) {
  std::string text = "<worldbody>";
  for (int i = 0; i < bodies; ++i) text += "<body><joint/>";
  for (int i = 0; i < bodies; ++i) text += "</body>";
  return text + "</worldbody>";
}

TEST(MjcfBad, LimitsHold) {
  EXPECT_EQ(read_mujoco(chain(250))->places().size(), 0u);
  EXPECT_TRUE(read_mujoco(chain(300))->log.contains(Code("E6002")));
  EXPECT_TRUE(read_mujoco(chain(100'000))->log.contains(Code("E6002")));
  Options options;
  options.limits.nodes = 10;
  EXPECT_TRUE(read_mujoco(chain(20), {}, options)->log.contains(Code("E6002")));
  options = {};
  options.limits.memory = 1000;
  EXPECT_TRUE(read_mujoco(chain(20), {}, options)->log.contains(Code("E6002")));
  std::string classes, ends;
  for (int i = 0; i < 300; ++i) {
    classes += fmt::format("<default class='c{}'>", i);
    ends += "</default>";
  }
  EXPECT_TRUE(read_mujoco("<default>" + classes + ends + "</default>" + chain(1))
                  ->log.contains(Code("E6002")));
}

// Cut short anywhere, or with bytes changed: a sound scene or none, and always a word about it
// where something is missing.
TEST(MjcfBad, DamagedTextsGiveSoundScenes) {
  const std::string whole =
      "<mujoco><compiler angle='radian' meshdir='.'/><default><geom rgba='1 0 0 1'/><default "
      "class='k'><joint range='-1 1'/></default></default><asset><mesh name='c' file='c.stl' "
      "scale='1 2 3' refpos='1 0 0'/><material name='m' rgba='1 1 0 1'/></asset><worldbody><body "
      "name='a' pos='1 2 3' quat='1 0 1 0'><joint name='x' class='k' pos='0 0 1' ref='0.1'/>"
      "<geom mesh='c' material='m'/><site name='s' zaxis='1 1 0'/><body name='b' "
      "xyaxes='1 0 0 0 1 1'><joint name='y' type='slide' axis='1 1 0'/><joint name='z' "
      "type='ball' pos='1 0 0'/><geom type='capsule' size='0.1' fromto='0 0 0 1 1 1'/>"
      "</body></body></worldbody><equality><joint joint1='y' joint2='x' polycoef='0 2 0 0 0'/>"
      "</equality></mujoco>";
  const std::string cube_text = stl_text_of(cube());
  const auto look = [&](std::string text) {
    const auto reading = read_meshes({{"r.xml", std::move(text)}, {"c.stl", cube_text}});
    if (reading->out)
      ASSERT_EQ(scene::check(reading->scene()), "") << reading->files[0].bytes;
    else
      ASSERT_TRUE(reading->log.has_errors()) << reading->files[0].bytes;
  };
  const auto sound = read_meshes({{"r.xml", whole}, {"c.stl", cube_text}});
  ASSERT_FALSE(sound->log.has_errors()) << sound->text();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto reading = read_meshes({{"r.xml", whole.substr(0, length)}, {"c.stl", cube_text}});
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
}  // namespace panwright::importers::mjcf_bad_test
