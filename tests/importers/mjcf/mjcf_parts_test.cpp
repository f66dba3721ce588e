// Shapes, meshes, materials and classes of MuJoCo models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/mjcf/mjcf_reading.h"

namespace panwright::importers::mjcf_parts_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string world(const std::string& inside) { return "<worldbody>" + inside + "</worldbody>"; }

TEST(MjcfParts, ShapesAreExact) {
  const auto reading = read_mujoco(world(R"(<geom size="0.5"/><body name="a">
<geom name="box" type="box" size="1 2 3" pos="1 2 3" euler="0 0 90"/>
<geom type="cylinder" size="0.1 2"/><geom type="ellipsoid" size="1 2 3"/>
<geom type="plane" size="4 5 0.1"/><geom type="plane" size="0 0 1"/><geom type="capsule" size="0.2 1"/>
<geom size="9" group="3"/><geom type="hfield" hfield="h"/></body>)"));
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  EXPECT_TRUE(
      reading->log.contains(Code("N6007")));  // the endless plane, the hidden geom, the field
  const scene::Scene& scene = reading->scene();
  ASSERT_EQ(scene.instances.size(), 8u);
  EXPECT_EQ(reading->path(0), "/world_geom");
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[0]).radius, 0.5);
  EXPECT_EQ(reading->path(1), "/a/box");
  EXPECT_EQ(std::get<geometry::Box>(scene.shapes[1]), geometry::Box{.size = Vec3(2, 4, 6)});
  const auto matrices = scene::world_from_nodes(scene);
  const Vec3 at(matrices[static_cast<std::size_t>(scene.instances[1].node)] * Vec4(1, 0, 0, 1));
  EXPECT_LT(glm::length(at - Vec3(1, 3, 3)), 1e-15);
  EXPECT_EQ(std::get<geometry::Cylinder>(scene.shapes[2]),
            (geometry::Cylinder{.radius = 0.1, .height = 4}));
  EXPECT_EQ(std::get<geometry::Ellipsoid>(scene.shapes[3]).radii, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<geometry::Plane>(scene.shapes[4]),
            (geometry::Plane{.width = 8, .height = 10}));
  // a capsule: a tube, and half spheres 1 m up and down
  EXPECT_EQ(std::get<geometry::Cylinder>(scene.shapes[5]).caps, geometry::Caps::none);
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[6]).latitude_min, 0);
  EXPECT_EQ(matrices[static_cast<std::size_t>(scene.instances[6].node)][3].z, 1);
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[7]).latitude_max, 0);
  EXPECT_EQ(matrices[static_cast<std::size_t>(scene.instances[7].node)][3].z, -1);
  EXPECT_EQ(reading->out->format, Format::mjcf);
  EXPECT_TRUE(reading->out->in_metres);
  EXPECT_EQ(usual_up(Format::mjcf), UpAxis::z);
}

TEST(MjcfParts, ShapesBetweenTwoPoints) {
  const auto reading =
      read_mujoco(world(R"(<body><geom type="cylinder" fromto="1 0 0 1 4 0" size="0.1"/>
<geom type="box" fromto="0 0 0 0 0 -2" size="0.25"/></body>)"));
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  const scene::Scene& scene = reading->scene();
  const auto matrices = scene::world_from_nodes(scene);
  const Mat4& one = matrices[static_cast<std::size_t>(scene.instances[0].node)];
  EXPECT_EQ(Vec3(one[3]), Vec3(1, 2, 0));
  EXPECT_LT(glm::length(Vec3(one[2]) - Vec3(0, -1, 0)), 1e-15);  // z from the second to the first
  EXPECT_EQ(std::get<geometry::Cylinder>(scene.shapes[0]).height, 4);
  EXPECT_EQ(std::get<geometry::Box>(scene.shapes[1]).size, Vec3(0.5, 0.5, 2));
  EXPECT_EQ(Vec3(matrices[static_cast<std::size_t>(scene.instances[1].node)][3]), Vec3(0, 0, -1));
}

TEST(MjcfParts, ClassesGiveWhatIsNotWritten) {
  const auto reading =
      read_mujoco(R"(<default><geom rgba="1 0 0 1" size="0.1"/><joint axis="0 1 0"/>
<default class="arm"><geom type="box" size="1 1 1" zaxis="1 0 0"/><joint range="-10 10"/>
<default class="hand"><geom rgba="0 0 1 1"/><joint axis="1 0 0" type="slide"/></default></default></default>
<worldbody><body name="a"><joint name="plain"/><geom name="red"/>
<body name="b" childclass="arm"><joint name="arm"/><geom name="box"/>
<body name="c"><joint name="still arm"/><joint name="hand" class="hand"/><geom name="blue" class="hand"/>
<geom name="own" class="hand" type="sphere" size="3" rgba="0 1 0 1" euler="0 0 90"/></body></body></body></worldbody>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  scene::Scene scene = reading->scene();
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[0]).radius, 0.1);
  EXPECT_EQ(reading->material(0).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(std::get<geometry::Box>(scene.shapes[1]).size, Vec3(2));
  EXPECT_EQ(reading->material(1).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(reading->material(2).diffuse, Vec3(0, 0, 1));
  EXPECT_EQ(std::get<geometry::Sphere>(scene.shapes[3]).radius, 3);
  EXPECT_EQ(joint_named(scene, "plain")->axis, Vec3(0, 1, 0));
  EXPECT_EQ(joint_named(scene, "plain")->kind, geometry::JointKind::continuous);
  EXPECT_EQ(joint_named(scene, "arm")->kind, geometry::JointKind::revolute);
  EXPECT_EQ(joint_named(scene, "still arm")->axis, Vec3(0, 1, 0));
  EXPECT_EQ(joint_named(scene, "hand")->axis, Vec3(1, 0, 0));
  EXPECT_THAT(joint_named(scene, "hand")->lower, ElementsAre(-10));  // metres: it slides
  // an orientation of its own stands for that of its class
  const auto matrices = scene::world_from_nodes(scene);
  EXPECT_LT(glm::length(Vec3(matrices[node_index(scene, "own")][0]) - Vec3(0, 1, 0)), 1e-15);
  EXPECT_LT(glm::length(Vec3(matrices[node_index(scene, "box")][2]) - Vec3(1, 0, 0)), 1e-15);
}

TEST(MjcfParts, MeshesMaterialsAndTextures) {
  const std::string image = "P6 1 1 255\nabc";
  const auto reading = read_mujoco(
      R"(<compiler meshdir="parts" texturedir="images"/><asset><mesh file="sub/cube.stl" scale="1 -2 3"/>
<mesh name="moved" file="sub/cube.stl" refpos="1 0 0" refquat="0.70710678118654752 0 0 0.70710678118654752" scale="2 1 1"/>
<texture name="t" type="2d" file="a.ppm"/><texture name="sky" type="skybox" builtin="gradient"/>
<material name="gold" rgba="0.8 0.6 0.1 1"/><material name="painted" texture="t"/></asset>
<worldbody><body><geom type="mesh" mesh="cube" material="gold" pos="0 0 5"/><geom mesh="moved"/>
<geom name="own" size="1" material="gold" rgba="0 1 0 1"/><geom size="1" material="painted"/></body></worldbody>)",
      {{"parts/sub/cube.stl", stl_text_of(cube())}, {"images/a.ppm", image}});
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), ElementsAre("8:3 W6502", "5:44 W6008"))
      << reading->text();  // squares in STL; the gradient
  const scene::Scene& scene = reading->scene();
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[0].shape, scene.instances[1].shape);
  EXPECT_EQ(reading->material(0).name, "gold");
  EXPECT_EQ(reading->material(2).diffuse, Vec3(0, 1, 0));
  EXPECT_NE(scene.instances[3].texture, scene::kNone);
  const auto matrices = scene::world_from_nodes(scene);
  const auto corner = [&](std::size_t i, const Vec3& p) {
    return Vec3(matrices[static_cast<std::size_t>(scene.instances[i].node)] * Vec4(p, 1));
  };
  EXPECT_LT(glm::length(corner(0, {1, 1, 1}) - Vec3(1, -2, 8)), 1e-14);
  // moved by −1 along x, turned by −90 degrees about z, then twice as wide in x
  EXPECT_LT(glm::length(corner(1, {1, 1, 1}) - Vec3(2, 0, 1)), 1e-14);
  EXPECT_LT(glm::length(corner(1, {3, 1, 0}) - Vec3(2, -2, 0)), 1e-14);
}

TEST(MjcfParts, IsToldByItsFirstElement) {
  const std::string body = "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>";
  for (const char* name : {"a.xml", "a.mjcf", "a.txt"})
    EXPECT_TRUE(read_meshes({{name, "<!-- a model -->\n" + body}})->out) << name;
  EXPECT_THAT(read_meshes({{"a.xml", "<?xml version='1.0'?><other/>"}})->text(),
              HasSubstr("an XML file is not supported"));
}

// Signed by winding: outward faces give the volume.
double volume_of(const geometry::Mesh& mesh) {
  double sum = 0;
  for (const geometry::Triangle& t : mesh.triangles)
    sum +=
        glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  return sum;
}

TEST(MjcfMesh, GivesItsOwnVertices) {
  const auto reading = read_mujoco(R"(<default><mesh scale="2 1 1"/></default><asset>
<mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3"/>
<mesh name="hull" vertex="0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1 .5 .5 .5 .5 .5 0"/>
<mesh name="flat" vertex="0 0 0 1 0 0 1 1 0" face="0 1 2" texcoord="0 0 1 0 1 1" normal="0 0 2 0 0 2 0 1 0"/>
</asset><worldbody><geom type="mesh" mesh="t"/><geom type="mesh" mesh="t" pos="5 0 0"/>
<geom type="mesh" mesh="hull"/><geom type="mesh" mesh="flat"/></worldbody>)");
  ASSERT_TRUE(reading->out) << reading->text();
  EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
  const scene::Scene& scene = reading->scene();
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[0].shape, scene.instances[1].shape);
  const auto mesh_of = [&](std::size_t i) {
    return *std::get<geometry::MeshShape>(
        scene.shapes[static_cast<std::size_t>(scene.instances[i].shape)]);
  };
  EXPECT_NEAR(volume_of(mesh_of(0)), 1.0 / 6, 1e-15);
  EXPECT_NEAR(volume_of(mesh_of(2)), 1, 1e-15);
  EXPECT_EQ(mesh_of(2).triangles.size(), 12u);
  EXPECT_EQ(mesh_of(3).normals[2], Vec3(0, 1, 0));
  EXPECT_EQ(mesh_of(3).texcoords[2], Vec2(1, 0));  // v counts from the top
  const auto matrices = scene::world_from_nodes(scene);
  EXPECT_EQ(matrices[static_cast<std::size_t>(scene.instances[0].node)][0].x, 2);
}

TEST(MjcfMesh, WrongVerticesAreLeftOut) {
  const auto place_of = [](const std::string& attributes) {
    return read_mujoco("<asset><mesh name='a' " + attributes + "/></asset>" +
                       world("<geom size='1'/>"))
        ->text();
  };
  EXPECT_THAT(place_of("vertex='0 0 0 1'"), HasSubstr("multiple of 3"));
  EXPECT_THAT(place_of("vertex='0 0 0 1 x 1'"), HasSubstr("E6220"));
  EXPECT_THAT(place_of("vertex='0 0 0 1 0 0 0 1 0 1 1 0'"), HasSubstr("lie in one plane"));
  EXPECT_THAT(place_of("vertex='0 0 0 1 0 0 0 1 0' face='0 1 3'"),
              HasSubstr("face 0 has vertex 3 of 3"));
  EXPECT_THAT(place_of("vertex='0 0 0 1 0 0 0 1 0' face='0 1 2' normal='0 0 1'"),
              HasSubstr("normal of <mesh> has 1 item for 3"));
  EXPECT_THAT(place_of("builtin='sphere'"), HasSubstr("neither a file nor a vertex"));
}

TEST(MjcfMesh, FoldersAreTakenOff) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  for (const std::string name :
       {"C:\\work\\sat\\panel.obj", "/home/someone/panel.obj", "panel.obj", "a\\b/panel.obj"}) {
    const auto reading =
        read_mujoco("<compiler meshdir='stl' strippath='true'/><asset><mesh file='" + name +
                        "'/></asset>" + world("<geom type='mesh' mesh='panel'/>"),
                    {{"stl/panel.obj", square}});
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_THAT(reading->places(), IsEmpty()) << reading->text();
    EXPECT_EQ(reading->scene().instances.size(), 1u) << name;
  }
}

}  // namespace
}  // namespace panwright::importers::mjcf_parts_test
