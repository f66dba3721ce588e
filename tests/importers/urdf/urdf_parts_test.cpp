// Shapes, meshes, materials and textures of robots.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/urdf/urdf_reading.h"

namespace panwright::importers::urdf_parts_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(UrdfParts, ShapesAreExact) {
  const auto reading = read_robot(R"(<link name="a">
<visual><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><geometry><box size="1 2 3"/></geometry></visual>
<visual name="mast"><geometry><cylinder radius="0.1" length="2"/></geometry></visual>
<visual><geometry><sphere radius="0.5"/></geometry></visual>
<collision><geometry><box size="9 9 9"/></geometry></collision>
</link>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty());
  EXPECT_TRUE(reading->log.contains(Code("N6007")));  // the collision
  const scene::Scene& scene = reading->scene();
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(std::get<geometry::Box>(scene.shapes[0]), geometry::Box{.size = Vec3(1, 2, 3)});
  EXPECT_EQ(std::get<geometry::Cylinder>(scene.shapes[1]),
            (geometry::Cylinder{.radius = 0.1, .height = 2}));
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[2]).radius, 0.5);
  EXPECT_EQ(reading->path(0), "/a/a_visual");
  EXPECT_EQ(reading->path(1), "/a/mast");
  EXPECT_EQ(reading->path(2), "/a/a_visual3");
  const auto world = scene::world_from_nodes(scene);
  const Vec3 at(world[static_cast<std::size_t>(scene.instances[0].node)] * Vec4(1, 0, 0, 1));
  EXPECT_LT(glm::length(at - Vec3(1, 3, 3)), 1e-15);
  EXPECT_EQ(reading->out->format, Format::urdf);
  EXPECT_TRUE(reading->out->in_metres);
  EXPECT_EQ(usual_up(Format::urdf), UpAxis::z);
}

TEST(UrdfParts, MaterialsAreSharedByName) {
  const auto reading = read_robot(R"(<material name="gold"><color rgba="0.8 0.6 0.1 1"/></material>
<link name="a">
<visual><geometry><sphere radius="1"/></geometry><material name="gold"/></visual>
<visual><geometry><sphere radius="2"/></geometry><material name="red"/></visual>
<visual><geometry><sphere radius="3"/></geometry><material name="red"><color rgba="1 0 0 0.5"/></material></visual>
<visual><geometry><sphere radius="4"/></geometry></visual>
</link>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), ElementsAre("7:51 W6008"));  // its transparency
  EXPECT_EQ(reading->material(0).diffuse, Vec3(0.8, 0.6, 0.1));
  EXPECT_EQ(reading->material(1).diffuse, Vec3(1, 0, 0));  // named before it stands
  EXPECT_EQ(reading->scene().instances[1].material, reading->scene().instances[2].material);
  EXPECT_EQ(reading->out->materials.size(), 3u);
  EXPECT_EQ(reading->out->materials[0].name, "gold");
}

TEST(UrdfParts, MeshesAreReadOnceScaledAndPlaced) {
  const Polyhedron box = cube();
  const auto reading = read_robot(
      R"(<material name="blue"><color rgba="0 0 1 1"/></material>
<link name="a"><visual><origin xyz="0 0 5"/><geometry><mesh filename="meshes/cube.stl" scale="1 -2 3"/></geometry>
  <material name="blue"/></visual></link>
<link name="b"><visual><geometry><mesh filename="package://robot_pkg/meshes/cube.stl"/></geometry></visual></link>
<link name="c"><visual><geometry><mesh filename="meshes/own.obj"/></geometry><material name="blue"/></visual></link>
<joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
<joint name="bc" type="fixed"><parent link="b"/><child link="c"/></joint>)",
      {{"meshes/cube.stl", stl_text_of(box)},
       {"meshes/own.obj", "mtllib own.mtl\nusemtl green\n" + obj_of(box)},
       {"meshes/own.mtl", "newmtl green\nKd 0 1 0\n"}});
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(),
              ElementsAre("8:3 W6502", "7:50 W6221"));  // loops of four; blue is not used
  const scene::Scene& scene = reading->scene();
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].shape, scene.instances[1].shape);
  EXPECT_EQ(reading->material(0).diffuse, Vec3(0, 0, 1));
  EXPECT_NE(reading->material(1).diffuse, Vec3(0, 0, 1));
  EXPECT_EQ(reading->material(2).diffuse, Vec3(0, 1, 0));
  EXPECT_EQ(reading->path(0), "/a/a_visual/part");
  const auto world = scene::world_from_nodes(scene);
  const Vec3 corner(world[static_cast<std::size_t>(scene.instances[0].node)] * Vec4(1, 1, 1, 1));
  EXPECT_EQ(corner, Vec3(1, -2, 8));
  std::vector<std::string> inputs;
  for (const scene::Input& input : scene.inputs) inputs.push_back(input.path);
  EXPECT_THAT(inputs,
              ElementsAre("robot.urdf", "meshes/cube.stl", "meshes/own.obj", "meshes/own.mtl"));
}

// robot.urdf in a folder of its own, as packages have it.
TEST(UrdfParts, PackagesAreFoundInFoldersAbove) {
  const std::string text = R"(<robot name="r"><link name="a"><visual><geometry>
    <mesh filename="package://arm/meshes/cube.stl"/></geometry></visual></link></robot>)";
  for (const char* place : {"meshes/cube.stl", "arm/meshes/cube.stl", "urdf/meshes/cube.stl"}) {
    const auto reading = read_meshes({{"urdf/r.urdf", text}, {place, stl_text_of(cube())}});
    ASSERT_TRUE(reading->out) << place << reading->text();
    EXPECT_EQ(reading->scene().instances.size(), 1u) << place;
  }
}

// A 2 x 1 image in PPM.
TEST(UrdfParts, TexturesCoverShapesWithCoordinates) {
  const auto reading = read_robot(
      R"(<material name="t"><texture filename="package://r/t.ppm"/></material>
<link name="a"><visual><geometry><box size="1 1 1"/></geometry><material name="t"/></visual>
<visual><geometry><mesh filename="c.stl"/></geometry><material name="t"/></visual></link>)",
      {{"t.ppm", "P6 2 1 255\n\xff\x01\x01\x01\xff\x01"}, {"c.stl", stl_text_of(cube())}});
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(),
              ElementsAre("8:3 W6502", "5:35 W6221"));  // loops of four; an STL has no coordinates
  ASSERT_EQ(reading->scene().textures.size(), 1u);
  EXPECT_EQ(reading->scene().textures[0].width, 2u);
  EXPECT_EQ(reading->scene().instances[0].texture, 0);
  EXPECT_EQ(reading->scene().instances[1].texture, scene::kNone);
  EXPECT_EQ(reading->material(0).diffuse, Vec3(1));
  EXPECT_TRUE(reading->out->materials[0].textured);
}

// What a file is, it says itself: any name, comments first, with a mark of UTF-8.
TEST(UrdfParts, AreKnownByTheirFirstElement) {
  const std::string body = "<robot name='x'><link name='a'/></robot>";
  for (const std::string& text : {body, "<?xml version='1.0'?>\n<!-- <COLLADA> -->\n" + body,
                                  "\xef\xbb\xbf<?xml version='1.0'?><!DOCTYPE robot>" + body}) {
    const auto reading = read_meshes({{"model.xml", text}});
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(reading->out->format, Format::urdf);
  }
  const auto other = read_meshes({{"model.xml", "<?xml version='1.0'?><robots/>"}});
  EXPECT_FALSE(other->out);
  EXPECT_TRUE(other->log.contains(Code("E6001")));
}

}  // namespace
}  // namespace panwright::importers::urdf_parts_test
