// VRML 97 → scene: transforms, shapes, looks, joints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/axis_box.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_scene_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Rodrigues' formula, in extended precision.
using Long3 = std::array<long double, 3>;
Long3 rotated(const Long3& p, const Long3& axis, long double angle) {
  const long double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const Long3 k{axis[0] / length, axis[1] / length, axis[2] / length};
  const long double c = std::cos(angle);
  const long double s = std::sin(angle);
  const long double dot = k[0] * p[0] + k[1] * p[1] + k[2] * p[2];
  const Long3 cross{k[1] * p[2] - k[2] * p[1], k[2] * p[0] - k[0] * p[2],
                    k[0] * p[1] - k[1] * p[0]};
  Long3 out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = p[i] * c + cross[i] * s + k[i] * dot * (1 - c);
  return out;
}

Vec3 in_world(const Reading& reading, std::string_view name, const Vec3& p) {
  return Vec3(scene::world_from_nodes(reading.scene())[reading.index(name)] * Vec4(p, 1));
}

// Lists of a megabyte and more go when they have served, and not before.
TEST(VrmlScene, LargeListsServeAsOftenAsTheyAreAsked) {
  constexpr int kTriangles = 100'000;
  std::string points;
  std::string index;
  for (int i = 0; i < kTriangles; ++i) {
    points += std::to_string(i) + " 0 0 ";
    index += std::to_string(i) + " " + std::to_string((i + 1) % kTriangles) + " " +
             std::to_string((i + 2) % kTriangles) + " -1 ";
  }
  const std::string coordinate = "Coordinate { point [ " + points + "] }";
  const std::string faces = "coordIndex [ " + index + "]";
  const std::string texture =
      "appearance Appearance { texture PixelTexture { image 1 1 3 0x102030 } } ";
  const std::string proto =
      "PROTO P [ field SFNode g NULL ] { Group { children [ Shape { geometry IS g } Shape { " +
      texture + "geometry IS g } ] } } ";
  const std::vector<std::pair<std::string, std::size_t>> models = {
      // text, shapes
      {"Shape { geometry IndexedFaceSet { coord " + coordinate + faces + " } }", 1},
      {"DEF S Shape { geometry IndexedFaceSet { coord " + coordinate + faces + " } } USE S", 2},
      {"Shape { geometry DEF G IndexedFaceSet { coord " + coordinate + faces + " } } Shape { " +
           texture + "geometry USE G }",
       2},
      {"Shape { geometry IndexedFaceSet { coord DEF C " + coordinate + faces +
           " } } Shape { geometry IndexedFaceSet { ccw FALSE coord USE C " + faces + " } }",
       2},
      {proto + "P { g IndexedFaceSet { coord " + coordinate + faces + " } }", 2},
  };
  for (const auto& [text, shapes] : models) {
    const auto reading = read97(text);
    ASSERT_TRUE(reading->out) << text.substr(0, 80);
    EXPECT_EQ(reading->log.errors() + reading->log.warnings(), 0u) << to_text(reading->log);
    ASSERT_EQ(reading->scene().instances.size(), shapes) << text.substr(0, 80);
    for (const scene::Instance& instance : reading->scene().instances) {
      const auto& mesh = *std::get<geometry::MeshShape>(
          reading->scene().shapes[static_cast<std::size_t>(instance.shape)]);
      ASSERT_EQ(mesh.triangles.size(), std::size_t{kTriangles});
      ASSERT_EQ(mesh.positions.size(), std::size_t{kTriangles});
      for (int i = 0; i < kTriangles; i += 997)
        ASSERT_EQ(mesh.positions[static_cast<std::size_t>(i)], Vec3(i, 0, 0));
    }
    // nothing points into the text
    EXPECT_EQ(reading->log.sources().file(0).bytes, nullptr);
  }
  const auto warned = read97(models[0].first + "\nTransform { scale 0 0 0 }");
  ASSERT_TRUE(warned->out);
  EXPECT_THAT(warned->places(), ElementsAre("3:1 W6009"));
  EXPECT_THAT(to_text(warned->log), HasSubstr("Transform { scale 0 0 0 }"));
}

TEST(VrmlScene, TransformsStepByStep) {
  // p' = T·C·R·SR·S·−SR·−C·p
  const auto reading = read97(
      "Transform { translation 1 2 3 children DEF A Transform { translation 0.5 -1 2 center 1 0 -2 "
      "rotation 1 2 -1 0.7 scale 2 0.5 -3 scaleOrientation 0 1 3 -1.1 children DEF B Group {} } }");
  EXPECT_THAT(reading->places(), IsEmpty());
  double worst = 0;
  for (const Vec3& p : {Vec3(0), Vec3(1, 0, 0), Vec3(-3, 4, 5), Vec3(1, 0, -2)}) {
    Long3 q{p.x - 1, p.y, p.z + 2};
    q = rotated(q, {0, 1, 3}, 1.1L);
    q = {q[0] * 2, q[1] * 0.5L, q[2] * -3};
    q = rotated(q, {0, 1, 3}, -1.1L);
    q = rotated(q, {1, 2, -1}, 0.7L);
    const Vec3 expected(static_cast<double>(q[0] + 1 + 0.5L + 1), static_cast<double>(q[1] - 1 + 2),
                        static_cast<double>(q[2] - 2 + 2 + 3));
    worst = std::max(worst, glm::length(in_world(*reading, "B", p) - expected));
  }
  EXPECT_LT(worst, 1.5e-14);  // measured 7.4e-15: the shear is taken apart and put together
}

TEST(VrmlScene, TransformsWithoutShearAreOneNode) {
  const auto reading = read97(
      "DEF A Transform { translation 1 2 3 rotation 0 0 2 1.5707963267948966 scale 1 2 3 } DEF B "
      "Transform { rotation 0 0 0 1 }");
  ASSERT_EQ(reading->scene().nodes.size(), 3u);
  EXPECT_EQ(in_world(*reading, "A", {1, 0, 0}).y, 3);
  EXPECT_EQ(reading->node("B")->parent_from_node, scene::Transform{});  // an axis of no direction
}

TEST(VrmlScene, WhatIsFlattenedIsLeftOut) {
  const auto reading = read97(
      "Transform { scale 1 0 1 children Shape { geometry Box {} } }\nShape { geometry Box {} }");
  EXPECT_THAT(reading->places(), ElementsAre("2:1 W6009"));
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlScene, NamesAndHierarchy) {
  const auto reading = read97(
      "DEF Bus Transform { children [ DEF a/b Shape { geometry Box {} } Shape { geometry Box {} } "
      "] "
      "}\nGroup {}");
  std::vector<std::string> names;
  for (const auto& node : reading->scene().nodes) names.push_back(node.name);
  EXPECT_THAT(names, ElementsAre("root", "Bus", "a_b", "Shape1", "Group1"));
  EXPECT_EQ(reading->scene().nodes[2].parent, 1);
  EXPECT_EQ(reading->scene().nodes[1].source.line, 2u);
  EXPECT_EQ(reading->scene().nodes[1].source.column, 9u);
}

TEST(VrmlScene, GroupsOfEveryKind) {
  const std::string box = "Shape { geometry Box {} }";
  const auto count = [&](const std::string& body) {
    return read97(body)->scene().instances.size();
  };
  EXPECT_EQ(count("Anchor { children " + box + " }"), 1u);
  EXPECT_EQ(count("Billboard { children " + box + " }"), 1u);
  EXPECT_EQ(count("Collision { children " + box + " proxy " + box + " }"), 1u);
  EXPECT_EQ(count("Switch { choice [ " + box + box + " ] }"), 0u);
  EXPECT_EQ(count("Switch { whichChoice 1 choice [ " + box + " Group { children [ " + box + box +
                  " ] } ] }"),
            2u);
  EXPECT_EQ(count("Switch { whichChoice 2 choice [ " + box + box + " ] }"), 0u);
  EXPECT_EQ(count("LOD { level [ " + box + " Group { children [ " + box + box + " ] } ] }"), 1u);
}

TEST(VrmlScene, ANodeInsideItselfIsLeftOut) {
  const auto reading =
      read97("DEF A Group { children [ Group { children USE A } Shape { geometry Box {} } ] }");
  EXPECT_THAT(reading->places(), ElementsAre("2:7 E6109"));
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  // a Script may hold itself
  EXPECT_THAT(read97("DEF S Script { field SFNode me USE S }")->places(), IsEmpty());
}

TEST(VrmlScene, WhatMakesNoSurfaceIsOneNote) {
  const auto reading = read97(
      "PointLight {} PointLight {} Viewpoint {} Shape { geometry PointSet {} } Script {}\n"
      "Shape { geometry IndexedLineSet {} } Shape { geometry Text {} }");
  EXPECT_EQ(reading->log.entries().size(), 1u);
  EXPECT_EQ(reading->log.entries()[0].message,
            "skipped: IndexedLineSet, PointLight (2), PointSet, Script, Text, Viewpoint");
}

TEST(VrmlScene, MisplacedNodes) {
  EXPECT_THAT(read97("Box {}\nShape { geometry Group {} }")->places(),
              ElementsAre("2:1 W6115", "3:18 W6115"));
}

// ---- shapes

AxisBox bounds_of(const Reading& reading) {
  AxisBox out;
  const auto world = scene::world_from_nodes(reading.scene());
  for (const scene::Instance& instance : reading.scene().instances) {
    DiagnosticLog log;
    const auto& shape = reading.scene().shapes[static_cast<std::size_t>(instance.shape)];
    const auto mesh = geometry::tessellated(shape, {.max_error = 1e-4}, {}, log);
    for (const Vec3& p : mesh->positions)
      out.add(Vec3(world[static_cast<std::size_t>(instance.node)] * Vec4(p, 1)));
  }
  return out;
}

void expect_bounds(const std::string& body, const Vec3& low, const Vec3& high) {
  const auto reading = read97(body);
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  const AxisBox bounds = bounds_of(*reading);
  EXPECT_LT(glm::length(bounds.low - low), 2e-4)
      << body;  // chord error 1e-4 on each axis; measured 1.44e-4
  EXPECT_LT(glm::length(bounds.high - high), 2e-4) << body;
}

TEST(VrmlScene, PrimitivesStandOnY) {
  expect_bounds("Shape { geometry Box { size 1 2 3 } }", {-0.5, -1, -1.5}, {0.5, 1, 1.5});
  expect_bounds("Shape { geometry Sphere { radius 2 } }", Vec3(-2), Vec3(2));
  expect_bounds("Shape { geometry Cylinder { radius 1 height 6 } }", {-1, -3, -1}, {1, 3, 1});
  expect_bounds("Shape { geometry Cone { bottomRadius 1 height 6 } }", {-1, -3, -1}, {1, 3, 1});
  expect_bounds("Shape { geometry Cylinder { side FALSE bottom FALSE } }", {-1, 1, -1}, {1, 1, 1});
  expect_bounds("Shape { geometry Cone { side FALSE } }", {-1, -1, -1}, {1, -1, 1});
}

TEST(VrmlScene, PartsOfPrimitives) {
  const auto caps = [](const std::string& fields) {
    const auto reading = read97("Shape { geometry Cylinder { " + fields + " } }");
    return std::get<geometry::Cylinder>(reading->scene().shapes.at(0)).caps;
  };
  EXPECT_EQ(caps(""), geometry::Caps::both);
  EXPECT_EQ(caps("top FALSE"), geometry::Caps::bottom);
  EXPECT_EQ(caps("bottom FALSE"), geometry::Caps::top);
  EXPECT_EQ(caps("bottom FALSE top FALSE"), geometry::Caps::none);
  // discs alone look outwards
  const auto discs = read97("Shape { geometry Cylinder { side FALSE } }");
  ASSERT_EQ(discs->scene().instances.size(), 2u);
  const auto world = scene::world_from_nodes(discs->scene());
  for (int i = 0; i < 2; ++i) {
    const Vec3 normal(world[static_cast<std::size_t>(discs->scene().instances[i].node)] *
                      Vec4(0, 0, 1, 0));
    EXPECT_LT(glm::length(normal - Vec3(0, i == 0 ? 1 : -1, 0)), 1e-15);  // measured 0
  }
}

TEST(VrmlScene, PrimitivesOfNoSize) {
  const auto reading = read97("Shape { geometry Sphere { radius 0 } }\nShape { geometry Box {} }");
  EXPECT_THAT(reading->places(), ElementsAre("2:18 W6009"));
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlScene, SharedGeometryIsOneShape) {
  const auto reading = read97(
      "Shape { geometry DEF G IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } "
      "coordIndex [ 0 1 2 ] } }\nShape { geometry USE G } Transform { translation 1 0 0 children "
      "Shape { geometry USE G } }");
  EXPECT_EQ(reading->scene().shapes.size(), 1u);
  EXPECT_EQ(reading->scene().instances.size(), 3u);
}

TEST(VrmlScene, ProblemsOfFacesHaveTheirPlace) {
  const auto reading = read97(
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] }\n"
      "coordIndex [ 0 1 2 -1\n 0 1 7 -1 ] } }\nShape { geometry IndexedFaceSet {} }");
  EXPECT_THAT(reading->places(), ElementsAre("4:6 E6113", "5:18 W6009")) << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

// ---- looks

TEST(VrmlScene, Materials) {
  const auto reading = read97(
      "Shape { appearance Appearance { material DEF Gold Material { diffuseColor 0.5 0.25 0 "
      "specularColor 1 1 0.5 shininess 0.25 emissiveColor 0 0 0.1 transparency 0.25 } } geometry "
      "Box "
      "{} } Shape { geometry Box {} }");
  ASSERT_EQ(reading->scene().materials.size(), 2u);
  const auto& gold = reading->scene().materials[0];
  EXPECT_EQ(gold.name, "Gold");
  // the largest sum, of red, is 1.5
  EXPECT_LT(glm::length(gold.diffuse - Vec3(0.5, 0.25, 0) / 1.5), 1e-15);
  EXPECT_LT(glm::length(gold.specular - Vec3(1, 1, 0.5) / 1.5), 1e-15);
  EXPECT_EQ(gold.specular_model(), materials::SpecularModel::blinn_phong);
  EXPECT_EQ(std::get<materials::BlinnPhong>(gold.specular_brdf).shine, 32);
  EXPECT_EQ(gold.emissive, Vec3(0, 0, 0.1));
  EXPECT_EQ(gold.weights, Vec3(1, 1, 1));
  EXPECT_EQ(reading->out->materials[0].opacity, 0.75);
  EXPECT_TRUE(reading->log.contains(Code("W6008")));
  EXPECT_EQ(reading->scene().materials[1].diffuse, Vec3(0.8));
}

// Their points and faces are no nodes of the file.
TEST(VrmlScene, GridsAndExtrusionsBeyondAllCoordinatesAreReportedAtTheirNumbers) {
  const auto reading = read97(
      "Shape { geometry ElevationGrid { xDimension 2 zDimension 2\nheight [ 0 0\n1e300 0 ] } }\n"
      "Shape { geometry\nExtrusion { spine [ 0 0 0, 0 1e300 0 ] } }\n"
      "Shape { geometry Box { } }");
  ASSERT_TRUE(reading->out) << to_text(reading->log);
  EXPECT_THAT(reading->places(), ElementsAre("4:1 E6107", "2:18 W6009", "6:1 E6107", "6:1 W6009"))
      << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(VrmlScene, PixelTextures) {
  const auto reading = read97(
      "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } texture "
      "PixelTexture { image 1 2 3 0x102030 0x405060 } } geometry Box {} }\n"
      "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } texture "
      "PixelTexture { image 1 1 2 0x8040 } } geometry Box {} }");
  EXPECT_THAT(reading->places(), ElementsAre("3:42 W6008")) << to_text(reading->log);
  ASSERT_EQ(reading->scene().textures.size(), 2u);
  // rows from the bottom in the file, from the top here
  EXPECT_THAT(reading->scene().textures[0].rgba,
              ElementsAre(0x40, 0x50, 0x60, 255, 0x10, 0x20, 0x30, 255));
  EXPECT_THAT(reading->scene().textures[1].rgba, ElementsAre(0x80, 0x80, 0x80, 0x40));
  // colour replaces the diffuse colour, grey multiplies it
  EXPECT_EQ(reading->scene().materials[0].diffuse, Vec3(1));
  EXPECT_EQ(reading->scene().materials[1].diffuse, Vec3(1, 0, 0));
}

TEST(VrmlScene, TextureTransforms) {
  // T, C, R, S, −C: (1, 0) → (1 + 0.5, 0) → about (0.5, 0.5) by 90°, twice as large
  const auto reading = read97(
      "Shape { appearance Appearance { texture PixelTexture { image 1 1 1 9 } textureTransform "
      "TextureTransform { translation 0.5 0 center 0.5 0.5 rotation 1.5707963267948966 scale 2 2 } "
      "} "
      "geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 "
      "2 "
      "] texCoord TextureCoordinate { point [ 1 0 0 0 0 1 ] } } }");
  const auto& mesh = *std::get<geometry::MeshShape>(reading->scene().shapes.at(0));
  // (1, 0) + T + C = (2, 0.5); turned (−0.5, 2); scaled (−1, 4); − C
  ASSERT_EQ(mesh.texcoords.size(), 3u);
  EXPECT_LT(glm::length(mesh.texcoords[0] - Vec2(-1.5, 3.5)), 1e-15);  // measured 2.2e-16
}

TEST(VrmlScene, MissingTexturesAreAWarning) {
  const auto reading = read97(
      "Shape { appearance DEF L Appearance { texture ImageTexture { url \"no.png\" } } geometry "
      "Box "
      "{} }\nShape { appearance USE L geometry Box {} }");
  EXPECT_THAT(reading->places(), ElementsAre("2:66 W6004"));
  EXPECT_EQ(reading->scene().instances.size(), 2u);
}

TEST(VrmlScene, ColoursOfTheMeshReplaceTheMaterials) {
  const auto reading = read97(
      "Shape { appearance Appearance { material Material { diffuseColor 0 0 1 } } geometry "
      "IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 2 ] "
      "color "
      "Color { color [ 1 0 0 0 1 0 1 1 1 ] } } }");
  EXPECT_EQ(reading->scene().materials.at(0).diffuse, Vec3(1));
  EXPECT_EQ(std::get<geometry::MeshShape>(reading->scene().shapes.at(0))->colors.size(), 3u);
}

// ---- joints

const std::string kJoint = R"(
PROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children []
  exposedField MFFloat llimit [] exposedField MFFloat ulimit [] exposedField SFString name ""
  exposedField SFRotation rotation 0 0 1 0 exposedField SFVec3f translation 0 0 0
  exposedField SFString jointType "" exposedField SFInt32 jointId -1
  exposedField SFVec3f jointAxis 0 0 1 ]
{ Transform { center IS center children IS children rotation IS rotation translation IS translation } }
PROTO Segment [ exposedField SFVec3f centerOfMass 0 0 0 exposedField MFNode children []
  exposedField SFFloat mass 0 exposedField MFFloat momentsOfInertia [ 0 0 0 0 0 0 0 0 0 ]
  exposedField SFString name "" ] { Group { children IS children } }
)";

TEST(VrmlJoints, OfOpenHrp) {
  const auto reading = read97(kJoint + R"(
DEF BASE Joint { jointType "fixed" children [
  DEF ARM Joint { jointType "rotate" jointAxis 0 2 0 translation 0 0 0.2 ulimit 1.5 llimit -0.5
    children [
      DEF LINK Segment { mass 4 centerOfMass 0 0 0.1 momentsOfInertia [ 1 2 3 2 5 6 3 6 9 ]
        children Shape { geometry Box {} } }
      DEF SLIDE Joint { jointType "slide" jointAxis 1 0 0 }
      DEF WHEEL Joint { jointType "rotate" jointAxis 1 0 0 } ] } ] })");
  EXPECT_THAT(reading->places(), IsEmpty()) << to_text(reading->log);
  EXPECT_EQ(scene::check(reading->scene()), "");
  ASSERT_EQ(reading->scene().joints.size(), 4u);
  const auto joint = [&](std::string_view name) {
    for (const scene::Joint& j : reading->scene().joints)
      if (j.name == name) return j;
    ADD_FAILURE() << name;
    return scene::Joint{};
  };
  EXPECT_EQ(joint("BASE").kind, scene::JointKind::fixed);
  const scene::Joint arm = joint("ARM");
  EXPECT_EQ(arm.kind, scene::JointKind::revolute);
  EXPECT_EQ(arm.axis, Vec3(0, 1, 0));
  EXPECT_THAT(arm.lower, ElementsAre(-0.5));
  EXPECT_THAT(arm.upper, ElementsAre(1.5));
  EXPECT_EQ(arm.mass, 4.0);
  EXPECT_EQ(arm.centre_of_mass, Vec3(0, 0, 0.1));
  ASSERT_TRUE(arm.inertia);
  EXPECT_EQ((*arm.inertia)[1][0], 2);
  EXPECT_EQ((*arm.inertia)[2][2], 9);
  EXPECT_EQ(reading->scene().nodes[static_cast<std::size_t>(arm.node)].name, "ARM");
  EXPECT_EQ(joint("SLIDE").kind, scene::JointKind::prismatic);
  EXPECT_EQ(joint("WHEEL").kind, scene::JointKind::continuous);
}

TEST(VrmlJoints, OfHAnimTurnAboutTheirCentre) {
  const auto reading = read97(
      "PROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children [] "
      "exposedField "
      "MFFloat llimit [] exposedField MFFloat ulimit [] exposedField SFString name \"\" "
      "exposedField "
      "SFRotation rotation 0 0 1 0 ] { Transform { center IS center children IS children rotation "
      "IS "
      "rotation } }\nDEF hanim_knee Joint { name \"knee\" center 0 1 0 rotation 0 0 1 1 llimit [ "
      "-1 0 "
      "0 ] ulimit [ 2 0 0 ] children DEF leg Shape { geometry Box {} } }");
  ASSERT_EQ(reading->scene().joints.size(), 1u);
  const scene::Joint& knee = reading->scene().joints[0];
  EXPECT_EQ(knee.name, "knee");
  EXPECT_EQ(knee.kind, scene::JointKind::ball);
  EXPECT_THAT(knee.lower, ElementsAre(-1, 0, 0));
  // its node's origin is the centre; what hangs on it stands as the Transform says
  EXPECT_EQ(in_world(*reading, "hanim_knee", Vec3(0)), Vec3(0, 1, 0));
  const Vec3 expected(std::sin(1.0), 1 - std::cos(1.0), 0);
  EXPECT_LT(glm::length(in_world(*reading, "leg", Vec3(0)) - expected), 1e-15);  // measured 0
}

// 1 × 1 pixel of 255 128 0
TEST(VrmlScene, TexturesMayBeGif) {
  std::string gif;
  for (const int byte :
       {0x47, 0x49, 0x46, 0x38, 0x39, 0x61, 1, 0, 1, 0, 0x80, 0, 0, 255,  128, 0, 0,   0,
        0,    0x2c, 0,    0,    0,    0,    1, 0, 1, 0, 0,    2, 2, 0x44, 1,   0, 0x3b})
    gif += static_cast<char>(byte);
  const auto reading = read_files(
      {{"model.wrl", kHeader97 +
                         "Shape { appearance Appearance { texture ImageTexture { url \"a.gif\" } } "
                         "geometry Box { } }"},
       {"a.gif", gif}});
  ASSERT_EQ(reading->scene().textures.size(), 1u) << to_text(reading->log);
  EXPECT_EQ(reading->scene().textures[0].rgba, (std::vector<std::uint8_t>{255, 128, 0, 255}));
  EXPECT_EQ(reading->scene().instances[0].texture, 0);
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_scene_test
