// VRML 1.0: what a state of nodes makes of the shapes that follow.
#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/mesh/check.h"
#include "vrml1_reading.h"

namespace panwright::importers::vrml::vrml1_test {
namespace {

// ---- state

TEST(Vrml1, SeparatorsKeepTheirStateToThemselves) {
  const auto reading = read10(
      "Separator {\n"
      "  Material { diffuseColor 1 0 0 } Translation { translation 1 0 0 }\n"
      "  Separator { Material { diffuseColor 0 1 0 } Translation { translation 0 1 0 } Sphere {} "
      "}\n"
      "  Sphere {}\n"
      "}");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(material(*reading, 0).diffuse, Vec3(0, 1, 0));
  EXPECT_EQ(moved(*reading, Vec3(0), 0), Vec3(1, 1, 0));
  EXPECT_EQ(material(*reading, 1).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(1, 0, 0));
}

TEST(Vrml1, GroupsPassTheirStateOn) {
  for (const std::string group : {"Group", "DEF Named Group"}) {
    const auto reading =
        read10("Separator { " + group +
               " { Material { diffuseColor 0 0 1 } Translation { translation 3 0 0 "
               "} Cube {} }\nTranslation { translation 0 2 0 } Cube {} }");
    ASSERT_EQ(reading->scene().instances.size(), 2u);
    EXPECT_EQ(moved(*reading, Vec3(0), 0), Vec3(3, 0, 0));
    EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(3, 2, 0));
    EXPECT_EQ(material(*reading, 1).diffuse, Vec3(0, 0, 1));
  }
}

TEST(Vrml1, TransformSeparatorsKeepTransformsAlone) {
  const auto reading = read10(
      "Separator { TransformSeparator { Material { diffuseColor 0 0 1 }\n"
      "Translation { translation 3 0 0 } } Cube {} }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(moved(*reading, Vec3(0)), Vec3(0));
  EXPECT_EQ(material(*reading).diffuse, Vec3(0, 0, 1));
}

TEST(Vrml1, StateOfTheTopHoldsForWhatFollows) {
  const auto reading =
      read10("Material { diffuseColor 0 1 1 }\nScale { scaleFactor 2 3 4 }\nCube {}");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(material(*reading).diffuse, Vec3(0, 1, 1));
  EXPECT_NEAR(std::fabs(glm::determinant(world(*reading))), 24, 1e-13);
}

TEST(Vrml1, WithoutMaterialTheStandardsHolds) {
  const auto reading = read10("Cube {}");
  EXPECT_EQ(material(*reading).diffuse, Vec3(0.8));
  EXPECT_EQ(material(*reading).specular, Vec3(0));
}

TEST(Vrml1, UsedPropertiesAreAppliedAgain) {
  const auto reading = read10(
      "Separator { DEF Red Material { diffuseColor 1 0 0 } DEF Step Translation { translation 1 2 "
      "3 "
      "}\n Material {} Cube {} USE Step USE Red Cube {} }");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(moved(*reading, Vec3(0), 0), Vec3(1, 2, 3));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(2, 4, 6));
  EXPECT_EQ(material(*reading, 0).diffuse, Vec3(0.8));
  EXPECT_EQ(material(*reading, 1).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(material(*reading, 1).name, "Red");
}

TEST(Vrml1, UsedShapesAreOneShapeInSeveralPlaces) {
  const auto reading =
      read10("DEF A Separator { " + kTriangle + " } Translation { translation 5 0 0 } USE A USE A");
  ASSERT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(reading->scene().shapes.size(), 1u);
  EXPECT_EQ(moved(*reading, Vec3(0), 2), Vec3(5, 0, 0));
}

TEST(Vrml1, AUsedShapeTakesTheStateWhereItStands) {
  const auto reading = read10(
      "Separator { Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
      "DEF F IndexedFaceSet { coordIndex [ 0, 1, 2 ] }\n"
      "Coordinate3 { point [ 0 0 0, 0 0 2, 0 2 0 ] } USE F }");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_DOUBLE_EQ(check(mesh(*reading, 0)).area, 0.5);
  EXPECT_DOUBLE_EQ(check(mesh(*reading, 1)).area, 2);
}

// ---- groups

TEST(Vrml1, SwitchesChoose) {
  const auto chosen = [](const std::string& which) {
    const auto reading =
        read10("Switch { " + which + " Cube { width 1 } Cube { width 2 } Cube { width 3 } }");
    std::set<double> widths;
    for (std::size_t i = 0; i < reading->scene().instances.size(); ++i)
      widths.insert(std::get<geometry::Box>(shape(*reading, i)).size.x);
    return widths;
  };
  EXPECT_EQ(chosen(""), (std::set<double>{}));
  EXPECT_EQ(chosen("whichChild -1"), (std::set<double>{}));
  EXPECT_EQ(chosen("whichChild 1"), (std::set<double>{2}));
  EXPECT_EQ(chosen("whichChild 7"), (std::set<double>{}));
  EXPECT_EQ(chosen("whichChild -3"), (std::set<double>{1, 2, 3}));
  EXPECT_EQ(chosen("whichChild -2147483648"), (std::set<double>{}));
}

TEST(Vrml1, SwitchesHandTheirChoiceDown) {
  const auto reading = read10(
      "Switch { whichChild 1 Cube { width 1 }\n"
      "  Switch { whichChild -2 Cube { width 2 } Cube { width 3 } } }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(std::get<geometry::Box>(shape(*reading)).size.x, 3);
}

TEST(Vrml1, TheFirstLevelOfDetailIsTaken) {
  const auto reading = read10("LOD { range [ 10 ] Cube { width 5 } Sphere {} }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(std::get<geometry::Box>(shape(*reading)).size.x, 5);
}

TEST(Vrml1, AnchorsAreSeparators) {
  const auto reading =
      read10("WWWAnchor { name \"http://x\" Translation { translation 1 0 0 } Cube {} } Cube {}");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(moved(*reading, Vec3(0), 0), Vec3(1, 0, 0));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(0));
}

TEST(Vrml1, InlinedFilesAndTheirOwnStates) {
  const auto reading = read_files(
      {{"a/model.wrl",
        "#VRML V1.0 ascii\nSeparator { Material { diffuseColor 1 0 0 } Translation { translation 1 "
        "0 "
        "0 } DEF In WWWInline { name \"b/part.wrl\" } Cube {} }"},
       {"a/b/part.wrl", "#VRML V1.0 ascii\nTranslation { translation 0 7 0 } Sphere {}"}});
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(moved(*reading, Vec3(0), 0), Vec3(1, 7, 0));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(1, 0, 0));
  EXPECT_NE(reading->node("In"), nullptr);

  const auto cycle = read10("Separator { WWWInline { name \"model.wrl\" } Cube {} }");
  EXPECT_EQ(cycle->count(Code("E6109")), 1u);
  EXPECT_EQ(cycle->scene().instances.size(), 1u);
  const auto missing = read10("Separator { WWWInline { name \"no.wrl\" } Cube {} }");
  EXPECT_EQ(missing->count(Code("E6010")), 1u);
  EXPECT_EQ(missing->scene().instances.size(), 1u);
}

TEST(Vrml1, AnInlinedFileOfTheOtherVersion) {
  const auto reading = read_files(
      {{"m.wrl",
        "#VRML V1.0 ascii\nTranslation { translation 1 2 3 }\nWWWInline { name \"n.wrl\" }"},
       {"n.wrl", "#VRML V2.0 utf8\nShape { geometry Box {} }"}});
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(moved(*reading, Vec3(0)), Vec3(1, 2, 3));
}

TEST(Vrml1, WhatMakesNoSurfaceIsCountedInOneNote) {
  const auto reading = read10(
      "Separator { PointLight {} AsciiText { string \"x\" } PointSet {} IndexedLineSet {} "
      "FontStyle "
      "{} Info { string \"hi\" } PerspectiveCamera {} AsciiText { string \"y\" } }");
  EXPECT_EQ(reading->count(Code("N6007")), 1u);
  for (const Diagnostic& entry : reading->log.entries()) {
    EXPECT_EQ(entry.message,
              "skipped: AsciiText (2), IndexedLineSet, PerspectiveCamera, PointLight, PointSet");
  }
}

TEST(Vrml1, NodesThatDescribeThemselves) {
  const auto reading = read10(
      "MyGroup { fields [ SFFloat mass ] mass 3 Cube {} }\n"
      "Better { fields [ SFFloat width ] isA [ \"Cube\" ] width 6 }");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(std::get<geometry::Box>(shape(*reading, 1)).size.x, 6);
}

TEST(Vrml1, NamesOfNodes) {
  const auto reading = read10(
      "DEF Craft Separator { Translation { translation 0 0 1 }\n"
      "  DEF Wing Separator { Translation { translation 2 0 0 } DEF Panel Cube {} Sphere {} }\n"
      "  DEF Empty Separator {} }");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(node_name(*reading, 0), "Panel");
  for (const char* name : {"Craft", "Wing", "Empty"}) EXPECT_NE(reading->node(name), nullptr);
  const auto worlds = scene::world_from_nodes(reading->scene());
  // a separator takes the transforms that stand first in it
  EXPECT_EQ(Vec3(worlds[reading->index("Wing")][3]), Vec3(2, 0, 1));
  EXPECT_EQ(Vec3(worlds[reading->index("Craft")][3]), Vec3(0, 0, 1));
}

// ---- transforms

TEST(Vrml1, TransformsAddUpFromTopToBottom) {
  // turned by a right angle about z, then moved along the turned x
  const auto reading = read10(
      "Rotation { rotation 0 0 1 1.5707963267948966 } Translation { translation 2 0 0 }\n"
      "Scale { scaleFactor 3 1 1 } " +
      kTriangle);
  const Vec3 at = moved(*reading, Vec3(1, 0, 0));
  EXPECT_LT(glm::length(at - Vec3(0, 5, 0)), 2e-15);
}

TEST(Vrml1, MatricesMultiplyRows) {
  // x' = (1 2 3 1)·M
  const auto reading =
      read10("MatrixTransform { matrix 1 0 0 0  0 0 1 0  0 -1 0 0  10 20 30 1 } " + kTriangle);
  EXPECT_EQ(moved(*reading, Vec3(1, 2, 3)), Vec3(1 + 10, -3 + 20, 2 + 30));
  const auto perspective =
      read10("MatrixTransform { matrix 1 0 0 0.5  0 1 0 0  0 0 1 0  0 0 0 1 } " + kTriangle);
  EXPECT_EQ(perspective->count(Code("W6118")), 1u);
  EXPECT_EQ(moved(*perspective, Vec3(1, 2, 3)), Vec3(1, 2, 3));
}

Vec3 turned(const Vec3& p, const Vec3& axis, double angle) {
  const Vec3 u = glm::normalize(axis);
  return p * std::cos(angle) + glm::cross(u, p) * std::sin(angle) +
         u * glm::dot(u, p) * (1 - std::cos(angle));
}

TEST(Vrml1, ATransformOfAllFields) {
  const auto reading = read10(
      "Transform { translation 1 2 3 rotation 1 2 -1 0.7 scaleFactor 2 -0.5 3\n"
      "scaleOrientation 0 1 1 0.4 center 4 -1 2 } " +
      kTriangle);
  for (const Vec3& p : {Vec3(0), Vec3(1, 0, 0), Vec3(-3, 2, 7)}) {
    Vec3 q = p - Vec3(4, -1, 2);
    q = turned(q, {0, 1, 1}, -0.4) * Vec3(2, -0.5, 3);
    q = turned(turned(q, {0, 1, 1}, 0.4), {1, 2, -1}, 0.7);
    q += Vec3(4, -1, 2) + Vec3(1, 2, 3);
    EXPECT_LT(glm::length(moved(*reading, p) - q), 3e-14);  // 1e-14 was seen
  }
}

TEST(Vrml1, WhatIsFlattenedIsLeftOutAndSaid) {
  const auto reading = read10(
      "Separator { Separator { Scale { scaleFactor 1 0 1 } Cube {} Separator { Cube {} } }\n"
      "Cube { width 3 } }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(std::get<geometry::Box>(shape(*reading)).size.x, 3);
  EXPECT_GE(reading->count(Code("W6009")), 1u);
}

// ---- primitives

TEST(Vrml1, PrimitivesStayExactAndStandOnY) {
  const auto reading = read10(
      "Cube { width 1 height 2 depth 3 } Sphere { radius 4 } Cylinder { radius 5 height 6 }\n"
      "Cone { bottomRadius 7 height 8 }");
  ASSERT_EQ(reading->scene().instances.size(), 4u);
  const Vec3 half = std::get<geometry::Box>(shape(*reading, 0)).size / 2.0;
  const Vec3 corner = moved(*reading, half, 0);
  EXPECT_EQ(Vec3(std::fabs(corner.x), std::fabs(corner.y), std::fabs(corner.z)), Vec3(0.5, 1, 1.5));
  EXPECT_EQ(std::get<geometry::Sphere>(shape(*reading, 1)).radius, 4);
  const auto& cylinder = std::get<geometry::Cylinder>(shape(*reading, 2));
  EXPECT_EQ(cylinder.radius, 5);
  EXPECT_EQ(cylinder.height, 6);
  EXPECT_EQ(cylinder.caps, geometry::Caps::both);
  EXPECT_EQ(moved(*reading, Vec3(0, 0, 1), 2), Vec3(0, 1, 0));
  const auto& cone = std::get<geometry::Cone>(shape(*reading, 3));
  EXPECT_EQ(cone.bottom_radius, 7);
  EXPECT_EQ(cone.top_radius, 0);
  EXPECT_EQ(moved(*reading, Vec3(0, 0, 4), 3), Vec3(0, 4, 0));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(glm::determinant(world(*reading, i)), 1);
}

TEST(Vrml1, PartsOfCylindersAndCones) {
  using geometry::Caps;
  const auto caps = [](const std::string& parts) {
    const auto reading = read10("Cylinder { parts " + parts + " }");
    return std::get<geometry::Cylinder>(shape(*reading)).caps;
  };
  EXPECT_EQ(caps("ALL"), Caps::both);
  EXPECT_EQ(caps("SIDES"), Caps::none);
  EXPECT_EQ(caps("(SIDES | TOP)"), Caps::top);
  EXPECT_EQ(caps("(BOTTOM|SIDES)"), Caps::bottom);

  const auto discs = read10("Cylinder { height 6 parts (TOP | BOTTOM) }");
  ASSERT_EQ(discs->scene().instances.size(), 2u);
  EXPECT_EQ(moved(*discs, Vec3(0), 0), Vec3(0, 3, 0));
  EXPECT_EQ(moved(*discs, Vec3(0, 0, 1), 0), Vec3(0, 4, 0));
  EXPECT_EQ(moved(*discs, Vec3(0), 1), Vec3(0, -3, 0));
  EXPECT_EQ(moved(*discs, Vec3(0, 0, 1), 1), Vec3(0, -4, 0));
  EXPECT_EQ(glm::determinant(world(*discs, 1)), 1);

  const auto base = read10("Cone { parts BOTTOM bottomRadius 2 }");
  ASSERT_EQ(base->scene().instances.size(), 1u);
  EXPECT_EQ(std::get<geometry::Disc>(shape(*base)).radius, 2);
  EXPECT_EQ(moved(*base, Vec3(0, 0, 1)), Vec3(0, -2, 0));
  EXPECT_EQ(std::get<geometry::Cone>(shape(*read10("Cone { parts SIDES }"))).caps, Caps::none);
}

TEST(Vrml1, PrimitivesWithoutSizeAreLeftOut) {
  const auto reading =
      read10("Sphere { radius 0 } Cylinder { height -1 } Cube { width 0 } Cone {}");
  // the cube without width is a sheet
  EXPECT_EQ(reading->scene().instances.size(), 2u);
  EXPECT_EQ(reading->count(Code("W6009")), 3u);
}

TEST(Vrml1, SegmentsAreObeyed) {
  Options options;
  options.primitives = 16;
  const auto reading = read10("Sphere {} Cylinder {}", options);
  EXPECT_EQ(std::get<geometry::Sphere>(shape(*reading, 0)).counts->quads, 16u);
  EXPECT_EQ(std::get<geometry::Cylinder>(shape(*reading, 1)).counts.around, 16u);
}

TEST(Vrml1, AMaterialForEachFaceOfACube) {
  const auto reading = read10(
      "Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1, 1 1 0, 0 1 1, 1 0 1 ] }\n"
      "MaterialBinding { value PER_FACE } Cube { width 2 height 4 depth 6 }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(material(*reading).diffuse, Vec3(1));
  const geometry::Mesh& cube = mesh(*reading);
  EXPECT_DOUBLE_EQ(check(cube).volume, 48);
  ASSERT_EQ(cube.triangles.size(), 12u);
  // front, back, left, right, top, bottom
  const std::vector<std::pair<Vec3, Vec3>> faces = {
      {{0, 0, 1}, {1, 0, 0}}, {{0, 0, -1}, {0, 1, 0}}, {{-1, 0, 0}, {0, 0, 1}},
      {{1, 0, 0}, {1, 1, 0}}, {{0, 1, 0}, {0, 1, 1}},  {{0, -1, 0}, {1, 0, 1}}};
  for (std::size_t v = 0; v < cube.positions.size(); ++v) {
    const bool found = std::ranges::any_of(faces, [&](const auto& face) {
      return cube.normals[v] == face.first && cube.colors[v] == face.second;
    });
    EXPECT_TRUE(found);
  }
}

TEST(Vrml1, AMaterialForEachPartOfACylinder) {
  const auto reading = read10(
      "Material { diffuseColor [ .5 0 0, 0 .5 0, 0 0 .5 ] specularColor [ 0 0 0, .5 .5 .5 ] }\n"
      "MaterialBinding { value PER_PART } Cylinder {} Cone {}");
  ASSERT_EQ(reading->scene().instances.size(), 5u);
  EXPECT_EQ(std::get<geometry::Cylinder>(shape(*reading, 0)).caps, geometry::Caps::none);
  EXPECT_EQ(material(*reading, 0).diffuse, Vec3(0.5, 0, 0));
  EXPECT_EQ(material(*reading, 0).specular, Vec3(0));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(0, 1, 0));
  EXPECT_EQ(material(*reading, 1).diffuse, Vec3(0, 0.5, 0));
  EXPECT_EQ(material(*reading, 1).specular, Vec3(0.5));
  EXPECT_EQ(moved(*reading, Vec3(0), 2), Vec3(0, -1, 0));
  EXPECT_EQ(material(*reading, 2).diffuse, Vec3(0, 0, 0.5));
  // the cone's bottom is its second part
  EXPECT_EQ(material(*reading, 3).diffuse, Vec3(0.5, 0, 0));
  EXPECT_EQ(material(*reading, 4).diffuse, Vec3(0, 0.5, 0));
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml1_test
