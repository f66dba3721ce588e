// What exporters and people write that the standards do not know, and what must come out of it.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/vrml/vrml_reading.h"

namespace panwright::importers::vrml::vrml_exporters_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kFaces =
    "IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] }";
const std::string kShape = "Shape { geometry " + kFaces + " }\n";
const std::string kShape10 =
    "Separator { Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } IndexedFaceSet { coordIndex "
    "[ 0, 1, 2, -1 ] } }\n";

// "unsupported properties ignored: …" or "skipped: …" of the one note with the code; else empty.
std::string note(const Reading& reading, Code code) {
  std::string out;
  for (const Diagnostic& entry : reading.log.entries())
    if (entry.code == code) out += entry.message;
  return out;
}

std::unique_ptr<Reading> read_text(const std::string& text) {
  return read_files({{"model.wrl", text}});
}

TEST(VrmlExporters, ReadWithoutAWord) {
  const std::string hull = "IndexedFaceSet { coord Coordinate { point [ ";
  const std::string tail = " ] } coordIndex [ 0 1 2 ] }";
  for (const std::string& body : {
           "DEF 3rdPanel " + kShape,
           "DEF Part.1-A(2)/b:c " + kShape,
           "DEF Pannéau_日本 " + kShape,
           "DEF Panel'A' " + kShape,
           "WorldInfo { title \"a # b { }\" info [ \"x # y\", \"]\" ] } " + kShape,
           "Shape { appearance NULL geometry NULL } " + kShape,
           "Shape { geometry " + hull + "0. .0 -0, +1 0 0, 0 1.e0 1E-05" + tail + " }",
           "Shape { geometry " + hull + "0 0 0 1 0 0 0 1 0,," + tail + " }",
           "DEF T TimeSensor {}, DEF I PositionInterpolator { key [ 0, 1 ] }, ROUTE "
           "T.fraction_changed TO I.set_fraction, " +
               kShape,
           "DEF S Script { url \"javascript: function f() { x = \\\"}\\\"; } // [\" field SFNode "
           "me USE S } " +
               kShape,
           "PROTO Unused [ ] { Group { } } " + kShape,
           "Group { children [ DEF A Shape { } , " + kShape + ", ] }",
       }) {
    const auto reading = read97(body);
    ASSERT_TRUE(reading->out) << body;
    EXPECT_THAT(reading->places(), IsEmpty()) << body << to_text(reading->log);
    EXPECT_EQ(reading->scene().instances.size(), 1u) << body;
  }
  for (std::string text : {kHeader97 + "# a comment\n" + kShape, kHeader97 + kHeader97 + kShape}) {
    EXPECT_EQ(read_text(text)->scene().instances.size(), 1u);
    std::replace(text.begin(), text.end(), '\n', '\r');
    EXPECT_EQ(read_text(text)->scene().instances.size(), 1u);
  }
}

TEST(VrmlExporters, HeadersInOtherWords) {
  const struct {
    std::string text;
    Format format;
    const char* place;
  } cases[] = {
      {"#vrml v2.0 UTF8\n" + kShape, Format::vrml97, "1:1 W6102"},
      {"#VRML V2.0 UTF8\n" + kShape, Format::vrml97, "1:1 W6102"},
      {"\n\n" + kHeader97 + kShape, Format::vrml97, "3:1 W6102"},
      {"# exported by a program\n" + kHeader97 + kShape, Format::vrml97, "2:1 W6102"},
      {"\n#VRML V1.0 ascii\n" + kShape10, Format::vrml1, "2:1 W6102"},
      {"#VRML V1.0 ascii\n" + kShape, Format::vrml97, "1:1 W6102"},
      {"#VRML V1.0 ascii\n# x\nDEF A " + kShape, Format::vrml97, "1:1 W6102"},
      {kHeader97 + kShape10, Format::vrml1, "1:1 W6102"},
  };
  for (const auto& c : cases) {
    const auto reading = read_text(c.text);
    ASSERT_TRUE(reading->out) << c.text;
    EXPECT_EQ(reading->out->format, c.format) << c.text;
    EXPECT_THAT(reading->places(), ElementsAre(c.place)) << c.text;
    EXPECT_EQ(reading->scene().instances.size(), 1u) << c.text;
  }
  // text comes first: a header further down is no header
  EXPECT_TRUE(read_text("Group { }\n" + kHeader97)->log.contains(Code("E6101")));
  EXPECT_TRUE(read_text(std::string(5000, ' ') + "\n" + kHeader97)->log.contains(Code("E6101")));
}

TEST(VrmlExporters, PaddingAtTheEnd) {
  for (const std::string& padding : {std::string(3, '\0'), std::string("\x1a"),
                                     std::string("\x1a\r\n"), std::string("\0 \n\0", 4)}) {
    const auto reading = read97(kShape + padding);
    EXPECT_THAT(reading->places(), ElementsAre("3:1 W6118"));
    EXPECT_EQ(reading->scene().instances.size(), 1u);
  }
  // in the middle they stand for something that was lost
  const auto middle = read97(kShape + std::string(1, '\0') + kShape);
  EXPECT_TRUE(middle->log.contains(Code("E6103")));
  EXPECT_EQ(middle->scene().instances.size(), 2u);
}

TEST(VrmlExporters, NamesWithQuotesAndBrackets) {
  for (const std::string name : {"\"Solar Panel\"", "Part[1]", "Part[1].b", "P[a-b]_2"}) {
    const auto reading =
        read97("DEF " + name + " " + kShape + "Group { children [ USE " + name + "] }");
    EXPECT_THAT(reading->places(), ElementsAre("2:5 W6118", testing::EndsWith(" W6118"))) << name;
    EXPECT_EQ(reading->scene().instances.size(), 2u) << name;
  }
  EXPECT_NE(read97("DEF \"Solar Panel\" " + kShape)->node("Solar Panel"), nullptr);
  EXPECT_NE(read97("DEF Part[1] " + kShape)->node("Part[1]"), nullptr);
  // the list's own brackets stay its own
  EXPECT_THAT(read97("DEF A " + kShape + "Group { children [USE A]}")->places(), IsEmpty());
}

TEST(VrmlExporters, FieldsOfX3D) {
  const auto reading = read97(
      "LOD { children [ " + kShape +
      " Shape { geometry Box { } } ] range [ 9 ] }\nLOD { levels [ "
      "Shape { geometry Sphere { } } ] }\nSwitch { whichChoice 0 children [ Shape { geometry Cone "
      "{ } } ] }");
  EXPECT_THAT(reading->places(), ElementsAre("2:7 W6118", "4:7 W6118", "5:24 W6118"))
      << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 3u);
}

TEST(VrmlExporters, GeometryWithoutTheNameOfItsField) {
  const auto reading = read97("Shape { appearance Appearance { } " + kFaces + " }");
  EXPECT_TRUE(reading->log.contains(Code("E6103")));
  EXPECT_EQ(reading->scene().instances.size(), 1u) << to_text(reading->log);
}

TEST(VrmlExporters, LevelOfDetailOfInventorShowsItsFirstLevel) {
  const auto reading = read_text("#VRML V1.0 ascii\nSeparator { LevelOfDetail { screenArea [ 9 ] " +
                                 kShape10 + " Cube { } } }");
  EXPECT_THAT(reading->places(), ElementsAre("2:13 W6105"));
  ASSERT_EQ(reading->scene().instances.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<geometry::MeshShape>(reading->scene().shapes[0]));
}

TEST(VrmlExporters, FilesOfOtherCaseAndOfOtherFolders) {
  const std::string part = kHeader97 + kShape;
  const struct {
    const char* url;
    std::size_t instances;
    std::vector<std::string> places;
  } cases[] = {
      {"Parts/Panel.wrl", 1, {}},
      {"Parts\\\\Panel.wrl", 1, {}},
      {"./Parts/Panel.wrl#View", 1, {}},
      {"parts/PANEL.WRL", 1, {"2:14 W6118"}},
      {"C:\\\\cad\\\\hull.wrl", 1, {"2:14 W6118"}},
      {"/home/me/HULL.wrl", 1, {"2:14 W6118"}},
      {"C:\\\\cad\\\\none.wrl", 0, {"2:14 E6010"}},
      {"../hull.wrl", 0, {"2:14 E6010"}},
      {"http://a.b/hull.wrl", 0, {"2:14 E6010"}},
      {"TWICE.wrl", 0, {"2:14 E6010"}},
  };
  for (const auto& c : cases) {
    const auto reading =
        read_files({{"model.wrl", fmt::format("{}Inline {{ url \"{}\" }}", kHeader97, c.url)},
                    {"Parts/Panel.wrl", part},
                    {"hull.wrl", part},
                    {"twice.wrl", part},
                    {"Twice.wrl", part}});
    EXPECT_EQ(reading->scene().instances.size(), c.instances) << c.url;
    EXPECT_THAT(reading->places(), testing::ElementsAreArray(c.places)) << to_text(reading->log);
  }
}

TEST(VrmlExporters, TexturesOfOtherFoldersMayLieBesideTheModel) {
  const std::string texture = "P3 1 1 255 255 0 0";
  for (const std::string url : {"../maps/gold.ppm", "C:\\\\maps\\\\gold.ppm", "/maps/gold.ppm"}) {
    const auto reading = read_files(
        {{"model.wrl", kHeader97 + "Shape { appearance Appearance { texture ImageTexture { url \"" +
                           url + "\" } } geometry Box { } }"},
         {"gold.ppm", texture}});
    EXPECT_EQ(reading->scene().textures.size(), 1u) << to_text(reading->log);
    EXPECT_THAT(reading->places(), ElementsAre("2:60 W6118")) << url;
  }
}

TEST(VrmlExporters, AFileByTwoNamesIsReadOnce) {
  const auto reading = read_files(
      {{"model.wrl", kHeader97 + "Inline { url \"part.wrl\" } Inline { url \"PART.wrl\" }\n" +
                         "Inline { url \"C:\\\\part.wrl\" } Inline { url \"Model.wrl\" }"},
       {"part.wrl", kHeader97 + kShape}});
  EXPECT_EQ(reading->count(Code("W6118")), 3u) << to_text(reading->log);
  EXPECT_EQ(reading->count(Code("E6109")), 1u) << to_text(reading->log);
  EXPECT_EQ(reading->scene().instances.size(), 3u);
  EXPECT_EQ(reading->scene().inputs.size(), 3u);
}

// ---- what is lost has its line

std::string textured(const std::string& texture, const std::string& s) {
  return "Shape { appearance Appearance { texture " + texture +
         " } geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } "
         "coordIndex [ 0 1 2 ] texCoord TextureCoordinate { point [ 0 0, " +
         s + " 0, 0 1 ] } } }";
}

TEST(VrmlLost, TexturesThatDoNotRepeat) {
  const std::string once = "PixelTexture { image 1 1 3 0xff0000 repeatS FALSE }";
  EXPECT_EQ(note(*read97(textured(once, "2")), Code("W6008")),
            "unsupported properties ignored: textures that do not repeat");
  EXPECT_EQ(note(*read97(textured(once, "1")), Code("W6008")), "");
  const std::string other = "PixelTexture { image 1 1 3 0xff0000 repeatT FALSE }";
  EXPECT_EQ(note(*read97(textured(other, "2")), Code("W6008")), "");
  const auto in_10 = [](const std::string& wrap) {
    return read_text("#VRML V1.0 ascii\nTexture2 { image 1 1 3 0xff0000 wrapS " + wrap +
                     " } TextureCoordinate2 { point [ 0 0, 2 0, 0 1 ] } " + kShape10);
  };
  EXPECT_EQ(note(*in_10("CLAMP"), Code("W6008")),
            "unsupported properties ignored: textures that do not repeat");
  EXPECT_EQ(note(*in_10("REPEAT"), Code("W6008")), "");
}

TEST(VrmlLost, TransparencyOfTextures) {
  for (const std::string image : {"1 1 4 0xff000080", "1 1 2 0x8040"})
    EXPECT_EQ(note(*read97(textured("PixelTexture { image " + image + " }", "1")), Code("W6008")),
              "unsupported: opacity, drawn opaque: #1");
  for (const std::string image : {"1 1 4 0xff0000ff", "1 1 2 0x80ff", "1 1 1 0x80"})
    EXPECT_EQ(note(*read97(textured("PixelTexture { image " + image + " }", "1")), Code("W6008")),
              "");
}

TEST(VrmlLost, ColoursThatAreNone) {
  const auto material = read97(
      "Shape { appearance Appearance { material Material { diffuseColor 255 128 0 } } geometry Box "
      "{ } }");
  EXPECT_EQ(note(*material, Code("W6008")),
            "unsupported properties ignored: values outside of 0 to 1");
  EXPECT_EQ(material->scene().materials[0].diffuse, Vec3(1, 1, 0));
  const auto corners = read97(
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
      "coordIndex [ 0 1 2 ] color Color { color [ 0 0 1, 0 2 0, -1 0 0 ] } } }");
  EXPECT_THAT(corners->places(), ElementsAre("3:51 W6114")) << to_text(corners->log);
}

TEST(VrmlLost, BillboardsAndTransformsOfTexturesOnPrimitives) {
  EXPECT_EQ(note(*read97("Billboard { children " + kShape + " }"), Code("W6008")),
            "unsupported properties ignored: rotation of billboards");
  const std::string texture = "Texture2 { image 1 1 3 0xff0000 } Texture2Transform { rotation 1 } ";
  for (const std::string shape : {"Cube { }", "Sphere { }", "Cylinder { }", "Cone { }"})
    EXPECT_EQ(note(*read_text("#VRML V1.0 ascii\n" + texture + shape), Code("W6008")),
              "unsupported properties ignored: texture transforms on primitives");
}

TEST(VrmlLost, NotesNameTheFile) {
  const auto reading = read97("Viewpoint { } Billboard { }");
  std::vector<std::string> names;
  for (const Diagnostic& entry : reading->log.entries()) {
    ASSERT_NE(entry.where.file, kNoFile);
    names.push_back(reading->log.sources().file(entry.where.file).name);
  }
  EXPECT_THAT(names, ElementsAre("model.wrl", "model.wrl"));
}

// ---- lists that are given back once they are arrays

// Squares in a row, each 1 wide, and large enough for their lists to go: over 1 MB.
std::string large_faces(int first, int count) {
  std::string out = "IndexedFaceSet { coordIndex [";
  for (int i = first; i < first + count; ++i)
    out += fmt::format(" {} {} {} {} -1", 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  return out + " ] }\n";
}

std::string large_points(int squares) {
  std::string out = "Coordinate3 { point [";
  for (int i = 0; i <= squares; ++i) out += fmt::format(" {} 0 0 {} 1 0", i, i);
  return out + " ] }\n";
}

TEST(VrmlRelease, CoordinatesStayForTheFacesThatAskForThemLater) {
  constexpr int kSquares = 60'000;
  const std::string points = large_points(kSquares);
  const std::string all = large_faces(0, kSquares);
  for (const std::string& body : {
           points + all + all,
           "Separator { " + points + "Separator { " + all + " } Separator { " + all + " } }",
           "Separator { " + points + "Group { " + all + " } " + all + " }",
           "DEF A Separator { " + points + all + " }\nTranslation { translation 9 0 0 }\nUSE A",
           points + "DEF F " + all + " Translation { translation 9 0 0 } USE F",
           "Separator { Group { " + points + " } TransformSeparator { " + all + " } " + all + " }",
           "Separator { " + points + all + " }\nSeparator { " + points + all + " }",
           points + "Switch { whichChild -3 " + all + all + " }",
       }) {
    const auto reading = read_text("#VRML V1.0 ascii\n" + body);
    ASSERT_TRUE(reading->out);
    EXPECT_THAT(reading->places(), IsEmpty()) << body.substr(0, 40) << to_text(reading->log);
    ASSERT_EQ(reading->scene().instances.size(), 2u) << body.substr(0, 40);
    // equal shapes are stored once
    ASSERT_EQ(reading->scene().shapes.size(), 1u);
    const auto& mesh = *std::get<geometry::MeshShape>(reading->scene().shapes[0]);
    EXPECT_EQ(mesh.triangles.size(), 2u * kSquares);
    EXPECT_EQ(mesh.positions.size(), 2u * (kSquares + 1));
    EXPECT_EQ(mesh.positions.back().x, kSquares);
  }
}

// Exporters write panels so. The corners of the sheet are those of the box.
TEST(VrmlExporters, BoxesWithoutThicknessAreSheets) {
  const struct {
    Vec3 size;
    Vec3 normal;
  } cases[] = {{{0, 2, 6}, {1, 0, 0}}, {{2, 0, 6}, {0, 1, 0}}, {{2, 6, 0}, {0, 0, 1}}};
  for (const auto& each : cases) {
    const std::string size = fmt::format("{} {} {}", each.size.x, each.size.y, each.size.z);
    const std::string in_10 = fmt::format(
        "#VRML V1.0 ascii\nSeparator {{ Cube {{ width {} height {} "
        "depth {} }} }}\n",
        each.size.x, each.size.y, each.size.z);
    for (const auto& text : {kHeader97 + "Shape { geometry Box { size " + size + " } }\n", in_10}) {
      SCOPED_TRACE(text);
      const auto reading = read_text(text);
      ASSERT_TRUE(reading->out) << to_text(reading->log);
      EXPECT_EQ(reading->count(Code("W6009")), 1u);
      EXPECT_THAT(note(*reading, Code("W6009")), HasSubstr("sheet"));
      const scene::Scene& scene = reading->scene();
      ASSERT_EQ(scene.instances.size(), 1u);
      const auto& plane = std::get<geometry::Plane>(scene.shapes[0]);
      const Mat4 world =
          scene::world_from_nodes(scene)[static_cast<std::size_t>(scene.instances[0].node)];
      // quarter turns as quaternions: measured 1.4e-15
      constexpr double kTurned = 1e-14;
      EXPECT_LT(glm::length(Vec3(world * Vec4(0, 0, 1, 0)) - each.normal), kTurned);
      const Vec3 corner = world * Vec4(plane.width, plane.height, 0, 1);
      EXPECT_LT(glm::length(glm::abs(corner) - each.size), kTurned);
    }
  }
  // lines and points are none
  EXPECT_EQ(read97("Shape { geometry Box { size 0 0 1 } }")->scene().instances.size(), 0u);
  EXPECT_EQ(read97("Shape { geometry Box { size 0 -1 1 } }")->scene().instances.size(), 0u);
}

// They hold for what follows in the group, and not for what is around it.
TEST(VrmlExporters, TransformsOfTheOtherVersionMoveWhatFollows) {
  const std::string box = "Shape { geometry Box { } } ";
  const struct {
    std::string body;
    std::vector<Vec3> at;  // of the boxes' corner (1, 1, 1)
  } cases[] = {
      {"Group { children [ " + box + "Translation { translation 5 0 0 } " + box +
           "Scale { scaleFactor 2 2 2 } " + box + "] } " + box,
       {{1, 1, 1}, {6, 1, 1}, {7, 2, 2}, {1, 1, 1}}},
      {"MatrixTransform { matrix 1 0 0 0 0 1 0 0 0 0 1 0 0 0 7 1 } " + box, {{1, 1, 8}}},
      {"DEF T Translation { translation 5 0 0 } Transform { translation 0 1 0 children [ USE T " +
           box + "] }",
       {{11, 2, 1}}},
  };
  for (const auto& each : cases) {
    SCOPED_TRACE(each.body);
    const auto reading = read97(each.body);
    ASSERT_TRUE(reading->out);
    EXPECT_GE(reading->count(Code("W6118")), 1u);
    EXPECT_EQ(reading->log.errors(), 0u) << to_text(reading->log);
    const scene::Scene& scene = reading->scene();
    const auto worlds = scene::world_from_nodes(scene);
    std::vector<Vec3> found;
    for (const scene::Instance& instance : scene.instances)
      found.emplace_back(worlds[static_cast<std::size_t>(instance.node)] * Vec4(1, 1, 1, 1));
    EXPECT_EQ(found, each.at);
  }
  // where nothing can follow it
  for (const std::string& body :
       {"Switch { whichChoice 0 choice Scale { scaleFactor 2 2 2 } } " + box,
        "PROTO P [ ] { Scale { scaleFactor 2 2 2 } } P { } " + box})
    EXPECT_EQ(read97(body)->count(Code("W6115")), 1u) << body;
  const auto turned = read97("Rotation { rotation 0 0 1 1.5707963267948966 } " + box);
  const Vec3 corner = scene::world_from_nodes(turned->scene()).back() * Vec4(1, 0, 0, 1);
  EXPECT_NEAR(glm::length(corner - Vec3(0, 1, 0)), 0, 1e-15);
}

TEST(VrmlLimits, ExtrusionsAreRefusedBeforeTheyAreMade) {
  std::string section, spine;
  for (int i = 0; i < 7000; ++i) {
    section += fmt::format(" {} {}", i, i % 2);
    spine += fmt::format(" 0 {} 0", i);
  }
  const std::string body =
      "Shape { geometry Extrusion { crossSection [" + section + " ] spine [" + spine + " ] } }";
  // 98 million triangles are below the limit of triangles, and not below that of memory
  const auto reading = read97(body);
  EXPECT_FALSE(reading->out);
  EXPECT_EQ(reading->count(Code("E6002")), 1u);
  EXPECT_THAT(to_text(reading->log), HasSubstr("97972002 triangles"));
}

}  // namespace
}  // namespace panwright::importers::vrml::vrml_exporters_test
