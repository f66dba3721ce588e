// Parts of a model in other files, and parts that are written once and stand several times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/mjcf/mjcf_reading.h"

namespace panwright::importers::mjcf_include_test {
namespace {

using testing::HasSubstr;

Vec3 place_of(const scene::Scene& scene, std::string_view name) {
  const std::size_t index = node_index(scene, name);
  EXPECT_LT(index, scene.nodes.size()) << name;
  if (index >= scene.nodes.size()) return Vec3(HUGE_VAL);
  return Vec3(scene::world_from_nodes(scene)[index][3]);
}

void expect_near(const Vec3& got, const Vec3& want) {
  EXPECT_LE(glm::length(got - want), 1e-14) << got.x << " " << got.y << " " << got.z;
}

// At the top, in a body, and within what is included; classes and compiler of it hold for all.
TEST(MjcfInclude, StandsWhereItIsNamed) {
  const auto r = read_mujoco(
      "<include file='parts/common.xml'/>\n<worldbody><body name='bus'><geom class='thick'/>\n"
      "<include file='arm.xml'/><body name='last'><geom size='1'/></body></body></worldbody>",
      {{"parts/common.xml",
        "<!-- kept apart -->\n<mujoco><compiler angle='radian'/><default><default class='thick'>"
        "<geom type='box' size='1 2 3'/></default></default></mujoco>"},
       {"arm.xml",
        "<mujocoinclude><body name='arm' euler='0 0 1.5707963267948966' pos='1 0 0'>"
        "<geom size='1'/><include file='hand.xml'/></body></mujocoinclude>"},
       {"hand.xml",
        "<mujocoinclude><body name='hand' pos='2 0 0'><geom size='0.5'/></body>"
        "</mujocoinclude>"}});
  ASSERT_TRUE(r->out) << r->text();
  EXPECT_EQ(r->log.errors() + r->log.warnings(), 0u) << r->text();
  const scene::Scene& scene = r->out->scene;
  expect_near(place_of(scene, "arm"), {1, 0, 0});
  expect_near(place_of(scene, "hand"), {1, 2, 0});
  EXPECT_LT(node_index(scene, "arm"), node_index(scene, "last"));
  EXPECT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.inputs.size(), 4u) << "files that the model was made from";
}

TEST(MjcfInclude, ProblemsAreSaidInTheirFile) {
  const std::string body = "<worldbody><body name='b'><geom size='1'/></body></worldbody>";
  const auto with = [&](const std::string& other, const std::string& more = "") {
    return read_mujoco("<include file='other.xml'/>" + more + body, {{"other.xml", other}});
  };
  const auto wrong = with("<mujoco>\n<worldbody><geom size='x'/></worldbody></mujoco>");
  EXPECT_THAT(wrong->text(), HasSubstr("other.xml:2:24")) << wrong->text();
  const auto broken = with("<mujoco>\n<worldbody><geom size='1'/></wordbody></mujoco>");
  EXPECT_THAT(broken->text(), HasSubstr("other.xml:2:")) << broken->text();
  EXPECT_THAT(broken->text(), HasSubstr("not well-formed"));
  ASSERT_TRUE(broken->out);
  EXPECT_EQ(broken->scene().instances.size(), 2u) << "the text before is read";
  const auto foreign = with("\n<robot/>");
  EXPECT_THAT(foreign->text(), HasSubstr("other.xml:2:2"));
  EXPECT_THAT(foreign->text(),
              HasSubstr("unexpected element 'robot', expected mujoco or mujocoinclude"));
  EXPECT_THAT(with("")->text(), testing::AnyOf(HasSubstr("not well-formed"), HasSubstr("empty")));
  // files which include themselves or each other end
  const auto itself = with("<mujocoinclude><include file='other.xml'/></mujocoinclude>");
  EXPECT_THAT(itself->places(), testing::ElementsAre("1:31 E6220")) << itself->text();
  const auto ring = read_mujoco(
      "<include file='a.xml'/>" + body,
      {{"a.xml", "<mujoco><include file='b.xml'/></mujoco>"},
       {"b.xml", "<mujoco><include file='a.xml'/><include file='model.xml'/></mujoco>"}});
  EXPECT_THAT(ring->places(), testing::ElementsAre("1:24 E6220", "1:47 E6220")) << ring->text();
  EXPECT_THAT(with("<mujoco/>", "<include file='../out.xml'/>")->text(), HasSubstr("E6010"));
}

TEST(MjcfInclude, IsLookedForBesideTheModelThenBesideTheIncludingFile) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  const auto r = read_mujoco(
      "<include file='parts/arm.xml'/>",
      {{"parts/arm.xml",
        "<mujoco><include file='assets.xml'/><include file='geoms.xml'/></mujoco>"},
       {"parts/assets.xml",
        "<mujoco><compiler meshdir='meshes'/><asset><mesh name='beside model' "
        "file='a.obj'/><mesh name='beside text' file='b.obj'/><mesh name='no "
        "folder' file='c.obj'/></asset></mujoco>"},
       {"geoms.xml",
        "<mujoco><worldbody><geom name='right' type='mesh' mesh='beside model'/><geom type='mesh' "
        "mesh='beside text'/><geom type='mesh' mesh='no folder'/></worldbody></mujoco>"},
       {"parts/geoms.xml", "<mujoco><worldbody><geom name='wrong'/></worldbody></mujoco>"},
       {"meshes/a.obj", square},
       {"parts/meshes/a.obj", "v 0 0 0\n"},
       {"parts/meshes/b.obj", square},
       {"parts/c.obj", square}});
  ASSERT_TRUE(r->out) << r->text();
  EXPECT_EQ(r->log.errors() + r->log.warnings(), 0u) << r->text();
  EXPECT_EQ(r->scene().instances.size(), 3u);
  EXPECT_LT(node_index(r->scene(), "right"), r->scene().nodes.size());
}

TEST(MjcfInclude, StandsInEveryPlaceThatUsesIt) {
  const auto r = read_mujoco(
      "<worldbody><body name='l' pos='0 2 0'><include file='./wheel.xml'/></body>"
      "<body name='r' pos='0 -2 0'><include file='wheel.xml'/></body></worldbody>",
      {{"wheel.xml", "<mujoco><geom type='box' size='1 1 1'/><geom size='x'/></mujoco>"}});
  ASSERT_TRUE(r->out) << r->text();
  EXPECT_EQ(r->scene().instances.size(), 2u);
  EXPECT_EQ(r->path(0), "/l/l_geom");
  EXPECT_EQ(r->path(1), "/r/r_geom");
  EXPECT_EQ(r->scene().inputs.size(), 2u) << "a file is an input once";
  EXPECT_THAT(r->text(), HasSubstr("wheel.xml:1:52"));
}

// Forty files that use the next one twice stand for 2^40.
TEST(MjcfInclude, IsBounded) {
  std::vector<MemoryFile> files;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<include file='" + std::to_string(i + 1) + ".xml'/>";
    files.push_back({std::to_string(i) + ".xml", "<mujoco>" + next + next + "</mujoco>"});
  }
  files.push_back({"40.xml", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"});
  const auto r = read_mujoco("<include file='0.xml'/>", files);
  EXPECT_THAT(r->text(), HasSubstr("E6002"));
}

// Copy n is placed by the n-th power of the step: four quarter turns about a square.
TEST(MjcfReplicate, CopiesAreStepsApart) {
  const auto r = read_mujoco(
      "<worldbody><replicate count='4' offset='1 0 0' euler='0 0 90' sep='_'>"
      "<body name='leg' pos='0 0 5'><joint name='hip'/><geom size='0.1'/>"
      "<site name='foot' pos='0 -1 0'/></body></replicate></worldbody>");
  ASSERT_TRUE(r->out) << r->text();
  EXPECT_EQ(r->log.errors() + r->log.warnings(), 0u) << r->text();
  scene::Scene& scene = r->out->scene;
  const Vec3 corners[] = {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}};
  const Vec3 down[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  ASSERT_EQ(scene.frames.size(), 4u);
  const auto world = scene::world_from_nodes(scene);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string number = "_" + std::to_string(i);
    EXPECT_NE(joint_named(scene, "hip" + number), nullptr);
    expect_near(place_of(scene, "leg" + number), corners[i]);
    const scene::Frame& foot = scene.frames[i];
    EXPECT_EQ(foot.name, "foot" + number);
    expect_near(Vec3(world[static_cast<std::size_t>(foot.node)] * Vec4(foot.origin, 1)),
                corners[i] + down[i]);
  }
}

TEST(MjcfReplicate, NamesAreOfOneLengthAndNest) {
  const auto r = read_mujoco(
      "<worldbody><replicate count='11' offset='1 0 0'><replicate count='2' offset='0 1 0' "
      "sep='-'><body name='n'><geom size='0.1'/></body></replicate></replicate></worldbody>");
  ASSERT_TRUE(r->out) << r->text();
  const scene::Scene& scene = r->out->scene;
  expect_near(place_of(scene, "n-000"), {0, 0, 0});
  expect_near(place_of(scene, "n-103"), {3, 1, 0});
  expect_near(place_of(scene, "n-110"), {10, 1, 0});
  EXPECT_EQ(scene.instances.size(), 22u);
}

// Copies of nothing, a thousand times a thousand times a thousand.
TEST(MjcfReplicate, IsBounded) {
  std::string inside = "<geom size='1' group='5'/>";
  for (int i = 0; i < 6; ++i) inside = "<replicate count='1000'>" + inside + "</replicate>";
  const auto r = read_mujoco("<worldbody>" + inside + "<geom size='1'/></worldbody>");
  EXPECT_THAT(r->text(), HasSubstr("E6002"));
}

}  // namespace
}  // namespace panwright::importers::mjcf_include_test
