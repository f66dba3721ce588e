// VRML 1.0: what a state of nodes makes of the shapes that follow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/check.h"
#include "vrml_reading.h"

namespace panwright::importers::vrml {
namespace {

std::unique_ptr<Reading> read10(const std::string& body, const Options& options = {}) {
  auto reading = read_files({{"model.wrl", "#VRML V1.0 ascii\n" + body}}, options);
  if (reading->out) {
    EXPECT_EQ(reading->out->format, Format::vrml1);
    EXPECT_EQ(scene::check(reading->out->scene), "");
  }
  return reading;
}

const scene::Instance& instance(const Reading& reading, std::size_t i = 0) {
  return reading.scene().instances.at(i);
}
const geometry::Shape& shape(const Reading& reading, std::size_t i = 0) {
  return reading.scene().shapes.at(static_cast<std::size_t>(instance(reading, i).shape));
}
const geometry::Mesh& mesh(const Reading& reading, std::size_t i = 0) {
  return *std::get<geometry::MeshShape>(shape(reading, i));
}
const materials::Material& material(const Reading& reading, std::size_t i = 0) {
  return reading.scene().materials.at(static_cast<std::size_t>(instance(reading, i).material));
}
Mat4 world(const Reading& reading, std::size_t i = 0) {
  return scene::world_from_nodes(reading.scene())
      .at(static_cast<std::size_t>(instance(reading, i).node));
}
Vec3 moved(const Reading& reading, const Vec3& p, std::size_t i = 0) {
  return Vec3(world(reading, i) * Vec4(p, 1));
}
std::string node_name(const Reading& reading, std::size_t i = 0) {
  return reading.scene().nodes.at(static_cast<std::size_t>(instance(reading, i).node)).name;
}

// One triangle with its first corner at the origin.
const std::string kTriangle =
    "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] }\n";
// Two triangles and a quadrilateral over a strip, corners 0 to 5.
const std::string kStrip = "Coordinate3 { point [ 0 0 0, 1 0 0, 2 0 0, 0 1 0, 1 1 0, 2 1 0 ] }\n";
const std::string kStripIndex = "coordIndex [ 0, 1, 4, 3, -1, 1, 2, 4, -1, 2, 5, 4, -1 ]";
const std::string kRainbow =
    "Material { diffuseColor [ 0 0 0, .1 0 0, .2 0 0, .3 0 0, .4 0 0, .5 0 0, .6 0 0, .7 0 0, "
    ".8 0 0, .9 0 0 ] }\n";

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
  EXPECT_EQ(cycle->count(Code::E6109), 1u);
  EXPECT_EQ(cycle->scene().instances.size(), 1u);
  const auto missing = read10("Separator { WWWInline { name \"no.wrl\" } Cube {} }");
  EXPECT_EQ(missing->count(Code::W6004), 1u);
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
  EXPECT_EQ(reading->count(Code::N6007), 1u);
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
  EXPECT_EQ(perspective->count(Code::W6118), 1u);
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
  EXPECT_GE(reading->count(Code::W6009), 1u);
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
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(reading->count(Code::W6009), 3u);
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
      return cube.normals[v] == face.first && cube.colours[v] == face.second;
    });
    EXPECT_TRUE(found);
  }
}

TEST(Vrml1, AMaterialForEachPartOfACylinder) {
  const auto reading = read10(
      "Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1 ] specularColor [ 0 0 0, .5 .5 .5 ] }\n"
      "MaterialBinding { value PER_PART } Cylinder {} Cone {}");
  ASSERT_EQ(reading->scene().instances.size(), 5u);
  EXPECT_EQ(std::get<geometry::Cylinder>(shape(*reading, 0)).caps, geometry::Caps::none);
  EXPECT_EQ(material(*reading, 0).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(material(*reading, 0).specular, Vec3(0));
  EXPECT_EQ(moved(*reading, Vec3(0), 1), Vec3(0, 1, 0));
  EXPECT_EQ(material(*reading, 1).diffuse, Vec3(0, 1, 0));
  EXPECT_EQ(material(*reading, 1).specular, Vec3(0.5));
  EXPECT_EQ(moved(*reading, Vec3(0), 2), Vec3(0, -1, 0));
  EXPECT_EQ(material(*reading, 2).diffuse, Vec3(0, 0, 1));
  // the cone's bottom is its second part
  EXPECT_EQ(material(*reading, 3).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(material(*reading, 4).diffuse, Vec3(0, 1, 0));
}

// ---- face sets

// The red of each corner of a strip under a binding: by the place in the strip.
std::vector<double> reds(const std::string& binding, const std::string& index = {}) {
  const auto reading = read10(kRainbow + kStrip + "MaterialBinding { value " + binding +
                              " }\nIndexedFaceSet { " + kStripIndex + " " + index + " }");
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  const geometry::Mesh& strip = mesh(*reading);
  if (strip.colours.empty()) return {material(*reading).diffuse.x};
  std::vector<double> out;
  for (const geometry::Triangle& t : strip.triangles)
    for (const std::uint32_t v : t) out.push_back(10 * strip.colours[v].x);
  for (double& red : out) red = std::round(red);
  return out;
}

TEST(Vrml1, TheEightMaterialBindings) {
  // the quadrilateral 0 1 4 3 is cut into 0 1 4 and 0 4 3
  EXPECT_EQ(reds("DEFAULT"), (std::vector<double>{0}));
  EXPECT_EQ(reds("OVERALL"), (std::vector<double>{0}));
  const std::vector<double> by_face{0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2};
  EXPECT_EQ(reds("PER_PART"), by_face);
  EXPECT_EQ(reds("PER_FACE"), by_face);
  const std::vector<double> by_face_index{7, 7, 7, 7, 7, 7, 5, 5, 5, 9, 9, 9};
  EXPECT_EQ(reds("PER_PART_INDEXED", "materialIndex [ 7, 5, 9 ]"), by_face_index);
  EXPECT_EQ(reds("PER_FACE_INDEXED", "materialIndex [ 7, 5, 9 ]"), by_face_index);
  EXPECT_EQ(reds("PER_FACE_INDEXED"), by_face);
  EXPECT_EQ(reds("PER_VERTEX"), (std::vector<double>{0, 1, 2, 0, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(reds("PER_VERTEX_INDEXED"), (std::vector<double>{0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 5, 4}));
  EXPECT_EQ(
      reds("PER_VERTEX_INDEXED", "materialIndex [ 9, 8, 7, 6, -1, 5, 4, 3, -1, 2, 1, 0, -1 ]"),
      (std::vector<double>{9, 8, 7, 9, 7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(Vrml1, MaterialsCountRound) {
  // ten colours: item 13 is item 3
  EXPECT_EQ(reds("PER_FACE_INDEXED", "materialIndex [ 13, 20, 9 ]"),
            (std::vector<double>{3, 3, 3, 3, 3, 3, 0, 0, 0, 9, 9, 9}));
}

TEST(Vrml1, AnUnknownBindingIsSaid) {
  const auto reading = read10(kRainbow + "MaterialBinding { value PER_MOON } " + kTriangle);
  EXPECT_EQ(reading->count(Code::E6107), 1u);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(Vrml1, SeveralMaterialsBecomeColoursOrElseSeveralParts) {
  const std::string bound =
      kStrip + "MaterialBinding { value PER_FACE }\nIndexedFaceSet { " + kStripIndex + " }";
  const auto colours = read10(
      "Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1 ] shininess 0.5 "
      "specularColor .2 .2 .2 } " +
      bound);
  ASSERT_EQ(colours->scene().instances.size(), 1u);
  EXPECT_EQ(material(*colours).diffuse, Vec3(1));
  EXPECT_EQ(material(*colours).specular, Vec3(0.2));
  EXPECT_EQ(material(*colours).shine, 64);

  const auto parts =
      read10("Material { diffuseColor [ 1 0 0, 0 1 0 ] transparency [ 0, 0, .5 ] } " + bound);
  ASSERT_EQ(parts->scene().instances.size(), 3u);
  EXPECT_EQ(mesh(*parts, 0).triangles.size(), 2u);
  EXPECT_EQ(mesh(*parts, 1).triangles.size(), 1u);
  EXPECT_EQ(mesh(*parts, 2).triangles.size(), 1u);
  EXPECT_EQ(material(*parts, 0).diffuse, Vec3(1, 0, 0));
  EXPECT_EQ(material(*parts, 1).diffuse, Vec3(0, 1, 0));
  EXPECT_EQ(material(*parts, 2).diffuse, Vec3(0, 1, 0));  // the last holds for what follows
  const auto cad = static_cast<std::size_t>(instance(*parts, 2).material);
  EXPECT_EQ(parts->out->materials.at(cad).opacity, 0.5);
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) area += check(mesh(*parts, i)).area;
  EXPECT_DOUBLE_EQ(area, 2);

  // corners cannot have materials of their own: their colours stay
  const auto corners =
      read10("Material { diffuseColor [ 1 0 0, 0 1 0 ] shininess [ .1, .2 ] } " + kStrip +
             "MaterialBinding { value PER_VERTEX_INDEXED }\n"
             "IndexedFaceSet { " +
             kStripIndex + " }");
  ASSERT_EQ(corners->scene().instances.size(), 1u);
  EXPECT_EQ(mesh(*corners).colours.size(), mesh(*corners).positions.size());
  EXPECT_EQ(corners->count(Code::N6008), 1u);
}

TEST(Vrml1, PartsKeepTheirNormalsAndTexcoords) {
  const auto reading = read10(
      "Material { specularColor [ .1 .1 .1, .2 .2 .2, .3 .3 .3 ] }\n"
      "MaterialBinding { value PER_FACE_INDEXED } NormalBinding { value PER_FACE }\n"
      "Normal { vector [ 0 0 1, 0 1 0, 1 0 0 ] }\n"
      "TextureCoordinate2 { point [ 0 0, .1 0, .2 0, .3 0, .4 0, .5 0 ] }\n" +
      kStrip + "IndexedFaceSet { " + kStripIndex +
      " materialIndex [ 2, 0, 2 ] "
      "textureCoordIndex [ 5, 4, 3, 2, -1, 1, 1, 1, -1, 0, 0, 0, -1 ] }");
  ASSERT_EQ(reading->scene().instances.size(), 2u);
  const geometry::Mesh& two = mesh(*reading, 0);
  ASSERT_EQ(two.triangles.size(), 3u);
  EXPECT_EQ(material(*reading, 0).specular, Vec3(0.3));
  EXPECT_EQ(two.normals[two.triangles[0][0]], Vec3(0, 0, 1));
  EXPECT_EQ(two.normals[two.triangles[2][0]], Vec3(1, 0, 0));
  EXPECT_EQ(two.texcoords[two.triangles[0][0]], Vec2(0.5, 0));
  EXPECT_EQ(two.texcoords[two.triangles[2][0]], Vec2(0, 0));
  const geometry::Mesh& one = mesh(*reading, 1);
  EXPECT_EQ(one.normals[0], Vec3(0, 1, 0));
  EXPECT_EQ(one.texcoords[0], Vec2(0.1, 0));
}

TEST(Vrml1, PrelitColoursAreKept) {
  const auto reading = read10(
      "Material { ambientColor [] diffuseColor [] specularColor [] emissiveColor [ .2 .4 .6 ] } "
      "Cube {}");
  EXPECT_EQ(material(*reading).diffuse, Vec3(0.2, 0.4, 0.6));
  EXPECT_EQ(material(*reading).emissive, Vec3(0));
}

// The normal at each corner of a strip under a binding, as the number of the item it came from.
std::vector<int> normal_items(const std::string& binding, const std::string& index = {}) {
  std::string vectors;
  for (int i = 0; i < 10; ++i) vectors += std::to_string(i) + " 0 10, ";
  const auto reading =
      read10("Normal { vector [ " + vectors + " ] } " + kStrip + "NormalBinding { value " +
             binding + " }\nIndexedFaceSet { " + kStripIndex + " " + index + " }");
  EXPECT_EQ(reading->log.errors() + reading->log.warnings(), 0u);
  std::vector<int> out;
  const geometry::Mesh& strip = mesh(*reading);
  for (const geometry::Triangle& t : strip.triangles)
    for (const std::uint32_t v : t)
      out.push_back(static_cast<int>(std::lround(10 * strip.normals[v].x / strip.normals[v].z)));
  return out;
}

TEST(Vrml1, TheEightNormalBindings) {
  EXPECT_EQ(normal_items("OVERALL"), std::vector<int>(12, 0));
  const std::vector<int> by_face{0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2};
  EXPECT_EQ(normal_items("PER_PART"), by_face);
  EXPECT_EQ(normal_items("PER_FACE"), by_face);
  const std::vector<int> by_face_index{7, 7, 7, 7, 7, 7, 5, 5, 5, 9, 9, 9};
  EXPECT_EQ(normal_items("PER_PART_INDEXED", "normalIndex [ 7, 5, 9 ]"), by_face_index);
  EXPECT_EQ(normal_items("PER_FACE_INDEXED", "normalIndex [ 7, 5, 9 ]"), by_face_index);
  EXPECT_EQ(normal_items("PER_VERTEX"), (std::vector<int>{0, 1, 2, 0, 2, 3, 4, 5, 6, 7, 8, 9}));
  const std::vector<int> by_point{0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 5, 4};
  EXPECT_EQ(normal_items("PER_VERTEX_INDEXED"), by_point);
  EXPECT_EQ(normal_items("DEFAULT"), by_point);
}

TEST(Vrml1, NormalsThatDoNotSuffice) {
  const std::string few = "Normal { vector [ 1 0 0, 1 0 0 ] } " + kStrip;
  const std::string faces = "IndexedFaceSet { " + kStripIndex + " }";
  // left by what stood before: not meant for this
  const auto quiet = read10(few + faces);
  EXPECT_EQ(quiet->log.warnings(), 0u);
  for (const Vec3& n : mesh(*quiet).normals) EXPECT_EQ(n, Vec3(0, 0, 1));
  for (const char* binding : {"PER_VERTEX", "PER_FACE", "PER_VERTEX_INDEXED"}) {
    const auto said = read10(few + "NormalBinding { value " + binding + " } " + faces);
    EXPECT_EQ(said->count(Code::W6114), 1u) << binding;
    for (const Vec3& n : mesh(*said).normals) EXPECT_EQ(n, Vec3(0, 0, 1));
  }
}

TEST(Vrml1, ShapeHints) {
  const auto clockwise = read10("ShapeHints { vertexOrdering CLOCKWISE } " + kTriangle);
  EXPECT_EQ(mesh(*clockwise).normals[0], Vec3(0, 0, -1));
  const auto unknown = read10("ShapeHints { vertexOrdering UNKNOWN_ORDERING } " + kTriangle);
  EXPECT_EQ(mesh(*unknown).normals[0], Vec3(0, 0, 1));
  // a roof of 90 degrees
  const std::string roof =
      "Coordinate3 { point [ 0 0 0, 1 1 0, 1 1 1, 0 0 1, 2 0 0, 2 0 1 ] }\n"
      "IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1, 1, 4, 5, 2, -1 ] }";
  EXPECT_EQ(mesh(*read10(roof)).positions.size(), 8u);
  EXPECT_EQ(mesh(*read10("ShapeHints { creaseAngle 1.6 } " + roof)).positions.size(), 6u);
  EXPECT_EQ(mesh(*read10("ShapeHints { creaseAngle 1.5 } " + roof)).positions.size(), 8u);
}

TEST(Vrml1, PicturesAndTheirTransforms) {
  const std::string picture = "Texture2 { image 1 2 3 0xff0000 0x0000ff } ";
  const std::string square =
      "Coordinate3 { point [ 0 0 0, 2 0 0, 2 2 0, 0 2 0 ] }\n"
      "TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] }\n"
      "IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] }";
  const auto plain = read10(picture + square);
  ASSERT_EQ(plain->scene().textures.size(), 1u);
  EXPECT_EQ(instance(*plain).texture, 0);
  // the file's first row is the lowest
  EXPECT_EQ(plain->scene().textures[0].rgba,
            (std::vector<std::uint8_t>{0, 0, 255, 255, 255, 0, 0, 255}));
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3& p = mesh(*plain).positions[v];
    EXPECT_EQ(mesh(*plain).texcoords[v], Vec2(p.x, p.y) / 2.0);
  }
  // about its centre twice as large, turned by a right angle, then moved
  const auto changed = read10(picture +
                              "Texture2Transform { center .5 .5 scaleFactor 2 2 rotation "
                              "1.5707963267948966 translation 10 0 } " +
                              square);
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3& p = mesh(*changed).positions[v];
    const Vec2 off = (Vec2(p.x, p.y) / 2.0 - Vec2(0.5)) * 2.0;
    const Vec2 expected = Vec2(-off.y, off.x) + Vec2(10.5, 0.5);
    EXPECT_LT(glm::length(mesh(*changed).texcoords[v] - expected), 1e-14);
  }
  // without coordinates of its own: by the bounds
  const auto by_bounds = read10(picture + kTriangle);
  EXPECT_EQ(mesh(*by_bounds).texcoords.size(), 3u);
}

TEST(Vrml1, FaceSetsThatHaveNothingToStandOn) {
  const auto none = read10("IndexedFaceSet { coordIndex [ 0, 1, 2 ] } Cube {}");
  EXPECT_EQ(none->scene().instances.size(), 1u);
  EXPECT_EQ(none->count(Code::W6009), 1u);
  const auto past_end = read10(
      "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
      "IndexedFaceSet { coordIndex [ 0, 1, 2, -1,\n 0, 1,\n   3, -1 ] }");
  EXPECT_EQ(mesh(*past_end).triangles.size(), 1u);
  EXPECT_EQ(past_end->places(), (std::vector<std::string>{"5:4 E6113"}));
}

// ---- hostile

TEST(Vrml1, UsesThatDoubleAreBounded) {
  std::string text = "DEF N0 Separator { " + kTriangle + " }\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "USE N" + std::to_string(i - 1);
    text += "DEF N" + std::to_string(i) + " Separator { " + before + " " + before + " }\n";
  }
  Options options;
  options.limits.nodes = 20'000;
  const auto reading = read10(text, options);
  EXPECT_EQ(reading->count(Code::E6002), 1u);
}

TEST(Vrml1, DeepNestingIsBounded) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "Separator { ";
  const auto reading = read10(text);
  EXPECT_TRUE(reading->log.has_errors());
}

TEST(Vrml1, ManyMaterialsOfOneShapeAreBounded) {
  // each face with a material of its own that differs in more than its colour
  std::string shininess, points, index;
  for (int i = 0; i < 3000; ++i) {
    shininess += std::to_string(i / 3000.0) + " ";
    const std::string at = std::to_string(i);
    points += at + " 0 0, " + at + " 1 0, " + at + " 0 1, ";
    for (int k = 0; k < 3; ++k) index += std::to_string(3 * i + k) + ", ";
    index += "-1, ";
  }
  const auto reading = read10("Material { shininess [ " + shininess + "] }\n" +
                              "MaterialBinding { value PER_FACE }\nCoordinate3 { point [ " +
                              points + "] }\nIndexedFaceSet { coordIndex [ " + index + "] }");
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_EQ(mesh(*reading).triangles.size(), 3000u);
  EXPECT_EQ(reading->count(Code::N6008), 1u);
}

TEST(Vrml1, EveryPrefixOfAFileIsRead) {
  const std::string whole =
      "#VRML V1.0 ascii\nDEF A Separator { Material { diffuseColor [ 1 0 0, 0 1 0 ] }\n"
      "MaterialBinding { value PER_FACE } " +
      kStrip +
      "Normal { vector [ 0 0 1 ] }\n"
      "NormalBinding { value OVERALL } IndexedFaceSet { " +
      kStripIndex +
      " }\n"
      "Switch { whichChild -3 Cylinder { parts (SIDES | TOP) } MatrixTransform { matrix 1 0 0 0 0 "
      "1 0 "
      "0 0 0 1 0 2 0 0 1 } } Texture2 { image 1 1 3 0xff } } USE A Cone {}";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const auto reading = read_files({{"model.wrl", whole.substr(0, length)}});
    if (reading->out) {
      EXPECT_EQ(scene::check(reading->scene()), "") << length;
    }
    const std::string part = whole.substr(0, length);
    if (std::ranges::count(part, '{') != std::ranges::count(part, '}')) {
      EXPECT_TRUE(reading->log.has_errors()) << length;
    }
  }
}

}  // namespace
}  // namespace panwright::importers::vrml
