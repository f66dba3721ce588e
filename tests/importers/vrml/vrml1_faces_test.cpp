// VRML 1.0: face sets under bindings, and texts that mean harm.
#include <algorithm>
#include <cmath>

#include "geometry/mesh/check.h"
#include "vrml1_reading.h"

namespace panwright::importers::vrml::vrml1_faces_test {
namespace {

// Two triangles and a quadrilateral over a strip, corners 0 to 5.
const std::string kStrip = "Coordinate3 { point [ 0 0 0, 1 0 0, 2 0 0, 0 1 0, 1 1 0, 2 1 0 ] }\n";
const std::string kStripIndex = "coordIndex [ 0, 1, 4, 3, -1, 1, 2, 4, -1, 2, 5, 4, -1 ]";
const std::string kRainbow =
    "Material { diffuseColor [ 0 0 0, .1 0 0, .2 0 0, .3 0 0, .4 0 0, .5 0 0, .6 0 0, .7 0 0, "
    ".8 0 0, .9 0 0 ] }\n";

// ---- face sets

// The red of each corner of a strip under a binding: by the place in the strip.
std::vector<double> reds(const std::string& binding, const std::string& index = {}) {
  const auto reading = read10(kRainbow + kStrip + "MaterialBinding { value " + binding +
                              " }\nIndexedFaceSet { " + kStripIndex + " " + index + " }");
  EXPECT_EQ(reading->scene().instances.size(), 1u);
  const geometry::Mesh& strip = mesh(*reading);
  if (strip.colors.empty()) return {material(*reading).diffuse.x};
  std::vector<double> out;
  for (const geometry::Triangle& t : strip.triangles)
    for (const std::uint32_t v : t) out.push_back(10 * strip.colors[v].x);
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
  EXPECT_EQ(reading->count(Code("E6107")), 1u);
  EXPECT_EQ(reading->scene().instances.size(), 1u);
}

TEST(Vrml1, SeveralMaterialsBecomeColorsOrElseSeveralParts) {
  const std::string bound =
      kStrip + "MaterialBinding { value PER_FACE }\nIndexedFaceSet { " + kStripIndex + " }";
  const auto colors = read10(
      "Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1 ] shininess 0.5 "
      "specularColor .2 .2 .2 } " +
      bound);
  ASSERT_EQ(colors->scene().instances.size(), 1u);
  // white and the lobe are scaled to 1
  EXPECT_LT(glm::length(material(*colors).diffuse - Vec3(1 / 1.2)), 1e-15);
  EXPECT_LT(glm::length(material(*colors).specular - Vec3(0.2 / 1.2)), 1e-15);
  EXPECT_EQ(std::get<materials::BlinnPhong>(material(*colors).specular_brdf).shine, 64);

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
  EXPECT_EQ(mesh(*corners).colors.size(), mesh(*corners).positions.size());
  EXPECT_EQ(corners->count(Code("W6008")), 1u);
}

TEST(Vrml1, PartsKeepTheirNormalsAndTexcoords) {
  const auto reading = read10(
      "Material { diffuseColor .5 .5 .5 specularColor [ .1 .1 .1, .2 .2 .2, .3 .3 .3 ] }\n"
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

TEST(Vrml1, PrelitColorsAreKept) {
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
    EXPECT_EQ(said->count(Code("W6114")), 1u) << binding;
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

TEST(Vrml1, TexturesAndTheirTransforms) {
  const std::string texture = "Texture2 { image 1 2 3 0xff0000 0x0000ff } ";
  const std::string square =
      "Coordinate3 { point [ 0 0 0, 2 0 0, 2 2 0, 0 2 0 ] }\n"
      "TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] }\n"
      "IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] }";
  const auto plain = read10(texture + square);
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
  const auto changed = read10(texture +
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
  const auto by_bounds = read10(texture + kTriangle);
  EXPECT_EQ(mesh(*by_bounds).texcoords.size(), 3u);
}

TEST(Vrml1, FaceSetsThatHaveNothingToStandOn) {
  const auto none = read10("IndexedFaceSet { coordIndex [ 0, 1, 2 ] } Cube {}");
  EXPECT_EQ(none->scene().instances.size(), 1u);
  EXPECT_EQ(none->count(Code("W6009")), 1u);
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
  EXPECT_EQ(reading->count(Code("E6002")), 1u);
}

TEST(Vrml1, AShapeInManyStatesIsBounded) {
  std::string index;
  for (int i = 0; i < 10'000; ++i) index += "0 1 2 -1 ";
  std::string text =
      "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] }\nDEF F IndexedFaceSet { "
      "coordIndex [ " +
      index + "] }\n";
  std::string materials = text, normals = text;
  for (int i = 0; i < 1000; ++i) {
    materials += "Material { diffuseColor " + std::to_string(i / 1000.0) + " 0 0 } USE F\n";
    normals += "Normal { vector [ 0 0 1 ] } USE F\n";
  }
  Options options;
  options.limits.triangles = 100'000;
  const auto one_shape = read10(materials, options);
  ASSERT_EQ(one_shape->scene().instances.size(), 1001u);
  EXPECT_EQ(one_shape->scene().shapes.size(), 1u);
  EXPECT_EQ(material(*one_shape, 501).diffuse, Vec3(0.5, 0, 0));
  const auto over = read10(normals, options);
  EXPECT_EQ(over->count(Code("E6002")), 1u);
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
  EXPECT_EQ(reading->count(Code("W6008")), 1u);
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
}  // namespace panwright::importers::vrml::vrml1_faces_test
