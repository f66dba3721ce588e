// Initial values of joints lie within their limits in all formats; what is changed is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/importers/gltf/sample.h"
#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::joint_values_test {
namespace {

using testing::HasSubstr;

const std::string kJoint =
    "#VRML V2.0 utf8\nPROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children "
    "[] exposedField MFFloat llimit [] exposedField MFFloat ulimit [] exposedField SFString "
    "jointType \"\" exposedField SFVec3f jointAxis 0 0 1 ] { Transform { center IS center children "
    "IS children } }\n";

std::string glb(nlohmann::json stage, nlohmann::json more = nlohmann::json::object()) {
  Sample sample = triangle();
  sample.json["extensionsUsed"] = nlohmann::json::array({"AGI_articulations"});
  sample.json["nodes"][0]["extensions"]["AGI_articulations"]["articulationName"] = "KNEE";
  stage["name"] = "s";
  if (!stage.contains("type")) stage["type"] = "yTranslate";
  nlohmann::json articulation = {{"name", "KNEE"}, {"stages", nlohmann::json::array({stage})}};
  articulation.update(more);
  sample.json["extensions"]["AGI_articulations"]["articulations"] =
      nlohmann::json::array({articulation});
  return sample.glb();
}

std::string urdf(const std::string& joint) {
  return "<robot name=\"r\"><link name=\"a\"><visual><geometry><box size=\"1 1 "
         "1\"/></geometry></visual></link><link name=\"b\"/><joint name=\"KNEE\" "
         "type=\"prismatic\"><parent link=\"a\"/><child link=\"b\"/>" +
         joint + "</joint></robot>";
}

TEST(JointValues, BeginAtTheNearestLimit) {
  const std::vector<MemoryFile> cases[] = {
      {{"m.wrl", kJoint + "DEF KNEE Joint { jointType \"slide\" llimit [ 0.25 ] ulimit [ 2 ] "
                          "children Shape { geometry Box {} } }"}},
      {{"m.urdf", urdf("<limit lower=\"0.25\" upper=\"2\" effort=\"1\" velocity=\"1\"/>")}},
      {{"m.xml",
        "<mujoco><worldbody><body><joint name=\"KNEE\" type=\"slide\" range=\".25 2\"/><geom "
        "size=\"1\"/></body></worldbody></mujoco>"}},
      {{"m.glb", glb({{"minimumValue", 0.25}, {"maximumValue", 2}, {"initialValue", 0}})}},
  };
  for (const std::vector<MemoryFile>& files : cases) {
    const auto reading = read_meshes(files);
    ASSERT_TRUE(reading->out) << reading->text();
    ASSERT_EQ(reading->scene().joints.size(), 1u);
    const scene::Joint& joint = reading->scene().joints[0];
    EXPECT_EQ(joint.lower, std::vector<double>{0.25}) << files[0].path;
    EXPECT_EQ(joint.value, std::vector<double>{0.25}) << files[0].path;
    EXPECT_EQ(reading->log.warnings(), 1u) << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr("limit"));
    EXPECT_THAT(reading->text(), HasSubstr("0.25"));
  }
}

TEST(JointValues, LimitsAgainstEachOtherAreLeftOutAndReported) {
  const std::vector<MemoryFile> cases[] = {
      {{"m.wrl", kJoint + "DEF KNEE Joint { jointType \"slide\" llimit [ 2 ] ulimit [ 1 ] "
                          "children Shape { geometry Box {} } }"}},
      {{"m.urdf", urdf("<limit lower=\"2\" upper=\"1\" effort=\"1\" velocity=\"1\"/>")}},
      {{"m.xml",
        "<mujoco><worldbody><body><joint name=\"KNEE\" type=\"slide\" range=\"2 1\"/><geom "
        "size=\"1\"/></body></worldbody></mujoco>"}},
      {{"m.glb", glb({{"minimumValue", 2}, {"maximumValue", 1}})}},
      {{"m.glb", glb(nlohmann::json::object({{"minimumValue", 2}}))}},
  };
  for (const std::vector<MemoryFile>& files : cases) {
    const auto reading = read_meshes(files);
    ASSERT_TRUE(reading->out) << reading->text();
    ASSERT_EQ(reading->scene().joints.size(), 1u);
    EXPECT_TRUE(reading->scene().joints[0].lower.empty());
    EXPECT_EQ(reading->log.warnings() + reading->log.errors(), 1u) << reading->text();
  }
}

TEST(JointValues, WhatChangesAnArticulationIsReported) {
  const nlohmann::json turn = {{"type", "xRotate"}};
  const std::string cases[] = {
      glb({{"type", "xScale"}, {"initialValue", 0}}),
      glb(turn, {{"pointingVector", {0, 0, 0}}}),
      glb({{"type", "xTranslate"}}, {{"pointingVector", {0, 0, 1}}}),
      glb({{"type", "xRotate"},
           {"minimumValue", -90},
           {"maximumValue", 90},
           {"initialValue", 1e300}}),
  };
  for (const std::string& bytes : cases) {
    const auto reading = read_meshes({{"m.glb", bytes}});
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(reading->log.warnings(), 1u) << reading->text();
  }
  const auto sound = read_meshes({{"m.glb", glb(turn, {{"pointingVector", {0, 0, 1}}})}});
  EXPECT_EQ(sound->log.warnings(), 0u) << sound->text();
}

TEST(JointValues, SizesOutOfRangeAreErrorsAtTheirElement) {
  const auto reading = read_meshes(
      {{"m.xml",
        "<mujoco><worldbody><body><geom type=\"capsule\" fromto=\"0 0 0 0 0 1\" size=\"1e-300\"/>"
        "<geom size=\"1\"/></body></worldbody></mujoco>"}});
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_THAT(reading->places(), testing::ElementsAre("1:27 E2010"));
}

}  // namespace
}  // namespace panwright::importers::joint_values_test
