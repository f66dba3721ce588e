// PLY: properties of all types, and what is said of damaged files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::ply_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string header(const std::string& vertices, const std::string& faces,
                   const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices + "\nelement face " + faces +
         "\nend_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z";
const std::string kList = "property list uchar uint vertex_index";

TEST(Ply, VerticesHaveNormalsColorsAndTexcoords) {
  const auto out = read_meshes(
      {{"m.ply", header("3\n" + kXyz +
                            "\nproperty float nx\nproperty float ny\nproperty float nz\n"
                            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                            "property uchar alpha\nproperty float s\nproperty float t",
                        "1\n" + kList) +
                     "0 0 0 0 0 2 255 0 128 255 0 0\n1 0 0 0 0 1 0 0 0 255 1 0\n"
                     "0 1 0 0 0 0 255 255 255 255 0.5 1\n3 0 1 2\n"}});
  ASSERT_TRUE(out->out) << out->text();
  const geometry::Mesh& mesh = out->mesh();
  EXPECT_THAT(mesh.normals, testing::Each(Vec3(0, 0, 1)));  // the last has that of its face
  EXPECT_EQ(mesh.texcoords[2], Vec2(0.5, 1));
  // IEC 61966-2-1 at 128/255
  EXPECT_EQ(mesh.colors[0].x, 1);
  EXPECT_NEAR(mesh.colors[0].z, std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-16);
  EXPECT_EQ(out->material(0).diffuse, Vec3(1));
  EXPECT_THAT(out->text(), HasSubstr("unsupported properties ignored: vertex property 'alpha'"));
}

TEST(Ply, FloatColorsAreLinear) {
  const auto out = read_meshes(
      {{"m.ply",
        header("3\n" + kXyz + "\nproperty float red\nproperty double green\nproperty float blue",
               "1\n" + kList) +
            "0 0 0 0.5 0.25 2\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(out->mesh().colors[0], Vec3(0.5, 0.25, 1));
}

// A value as a type of PLY holds it.
template <class T>
void append_triangle(std::string& out, bool big) {
  for (const int n : {0, 0, 0, 100, 0, 0, 0, 100, 0}) append_bytes(out, static_cast<T>(n), big);
}

TEST(Ply, AllTypesInBothByteOrders) {
  for (const bool big : {false, true}) {
    const auto read_type = [&](const std::string& type, const std::string& coordinates,
                               const std::string& count, std::uint32_t count_bytes) {
      std::string body = coordinates;
      for (std::uint32_t k = 0; k < count_bytes; ++k)
        body += static_cast<char>((big ? k == count_bytes - 1 : k == 0) ? 3 : 0);
      for (const std::uint16_t v : {0, 1, 2}) append_bytes(body, v, big);
      return read_meshes({{"m.ply", header("3\nproperty " + type + " x\nproperty " + type +
                                               " y\nproperty " + type + " z",
                                           "1\nproperty list " + count + " ushort vertex_indices",
                                           big ? "binary_big_endian" : "binary_little_endian") +
                                        body}});
    };
    const auto expect = [&](const std::string& type, const std::string& coordinates,
                            const std::string& count, std::uint32_t count_bytes) {
      const auto out = read_type(type, coordinates, count, count_bytes);
      ASSERT_TRUE(out->out) << type << out->text();
      EXPECT_EQ(geometry::check(out->mesh()).area, 5000) << type << big;
      EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
    };
    std::string c, s, i, f, d;
    append_triangle<std::int8_t>(c, big);
    append_triangle<std::int16_t>(s, big);
    append_triangle<std::int32_t>(i, big);
    append_triangle<float>(f, big);
    append_triangle<double>(d, big);
    expect("char", c, "uchar", 1);
    expect("uint8", c, "int8", 1);
    expect("short", s, "ushort", 2);
    expect("uint16", s, "int16", 2);
    expect("int", i, "uint", 4);
    expect("uint32", i, "int32", 4);
    expect("float32", f, "uint8", 1);
    expect("float64", d, "uchar", 1);
  }
}

TEST(Ply, StripsEndAtMinusOne) {
  const auto out = read_meshes(
      {{"m.ply", "ply\nformat ascii 1.0\nelement vertex 5\n" + kXyz +
                     "\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n8 0 1 2 3 -1 2 3 4\n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(out->mesh().triangles.size(), 3u);
  EXPECT_EQ(geometry::check(out->mesh()).area, 1.5);
  for (const Vec3& n : out->mesh().normals) EXPECT_EQ(n, Vec3(0, 0, 1));
}

TEST(Ply, CornersOfFacesHaveTheirOwnTexcoords) {
  const std::string texture("P6\n1 1\n255\n\x10\x20\x30", 14);
  const auto out = read_meshes(
      {{"m.ply", "ply\nformat ascii 1.0\ncomment TextureFile a.ppm\nelement vertex 4\n" + kXyz +
                     "\nelement face 2\n" + kList +
                     "\nproperty list uchar float texcoord\nend_header\n"
                     "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                     "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0.5 0.5 1 1 0 1\n"},
       {"a.ppm", texture}});
  ASSERT_TRUE(out->out) << out->text();
  const geometry::Mesh& mesh = out->mesh();
  EXPECT_EQ(mesh.positions.size(), 5u);  // the first point twice, the third once
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.texcoords[mesh.triangles[1][0]], Vec2(0.5, 0.5));
  EXPECT_EQ(mesh.texcoords[mesh.triangles[0][0]], Vec2(0, 0));
  EXPECT_EQ(out->material(0).maps.albedo, 0);
  EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
}

TEST(Ply, OtherElementsAreCounted) {
  const auto out =
      read_meshes({{"m.ply",
                    "ply\nformat ascii 1.0\nelement camera 1\nproperty float view\n"
                    "property list int int more\nelement vertex 3\n" +
                        kXyz + "\nelement face 1\n" + kList +
                        "\nelement edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
                        "1.5 2 7 7\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0 1\n1 2\n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(geometry::check(out->mesh()).area, 0.5);
  EXPECT_THAT(out->text(), HasSubstr("skipped: camera, edge (2)"));
}

TEST(Ply, PointsMakeNoSurface) {
  const auto out = read_meshes({{"m.ply", "ply\nformat ascii 1.0\nelement vertex 2\n" + kXyz +
                                              "\nend_header\n0 0 0\n1 1 1\n"}});
  EXPECT_FALSE(out->out);
  EXPECT_THAT(out->text(), HasSubstr("2 points and no face: they make no surface"));
}

TEST(Ply, WrongValuesCostTheirFaceAlone) {
  const auto out = read_meshes({{"m.ply", header("4\n" + kXyz, "6\n" + kList) +
                                              "0 0 0\n1 0 0\n0 1 0\nnone 1 0\n"  // 10 to 13
                                              "3 0 1 2\n3 0 1 9\n3 0 1 3\n2 0 1\n"
                                              "many 0 1 2\n3 0 2 1\n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_THAT(out->places(), ElementsAre("13:1 E6501", "15:7 E6501", "17:5 W6502"));
  EXPECT_EQ(out->mesh().triangles.size(), 2u);
}

TEST(Ply, CutFilesGiveWhatTheyHold) {
  for (const Order order : {Order::text, Order::little, Order::big}) {
    const std::string whole = ply_of(ball(6, 8), order);
    std::size_t read = 0;
    for (std::size_t size = 10; size < whole.size(); ++size) {
      const auto out = read_meshes({{"m.ply", whole.substr(0, size)}});
      // a text may lose its last line end
      if (order == Order::text && size == whole.size() - 1) continue;
      EXPECT_TRUE(out->log.has_errors() || order == Order::text) << size;
      if (out->out) ++read;
    }
    EXPECT_GT(read, 100u);
  }
}

TEST(Ply, HeadersThatLieCostNoMemory) {
  Options small;
  small.limits.memory = 1 << 20;
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const auto out =
        read_meshes({{"m.ply", header("4000000000\n" + kXyz, "4000000000\n" + kList, format) +
                                   std::string(100, '1')}},
                    small);
    EXPECT_FALSE(out->out);
    EXPECT_TRUE(out->log.contains(Code("E6501"))) << out->text();
    EXPECT_FALSE(out->log.contains(Code("E6002"))) << out->text();
  }
}

// The exporter of Blender 2.41 forgets the word "comment".
TEST(Ply, TheCreditOfOldBlendersIsAComment) {
  const auto out = read_meshes(
      {{"m.ply",
        "ply\nformat ascii 1.0\nCreated by Blender3D 241 - www.blender.org, source file: "
        "a.blend\nelement vertex 3\nproperty float32 x\nproperty float32 y\nproperty "
        "float32 z\nelement face 1\nproperty list uint8 int32 vertex_indices\n"
        "end_header\n0 0 0 \n1 0 0 \n0 1 0 \n3 0 1 2 \n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(out->mesh().triangles.size(), 1u);
  EXPECT_THAT(out->places(), ElementsAre("3:1 W6502"));
}

TEST(Ply, WrongHeadersAreRefusedAtTheirPlace) {
  const auto place_of = [](const std::string& text) {
    const auto out = read_meshes({{"m.ply", text}});
    EXPECT_FALSE(out->out);
    return out->places();
  };
  EXPECT_THAT(place_of("ply\nformat askii 1.0\nend_header\n"), ElementsAre("2:8 E6501"));
  EXPECT_THAT(place_of("ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
              ElementsAre("3:16 E6501"));
  EXPECT_THAT(place_of("ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\nend_header\n"),
              ElementsAre("4:10 E6501"));
  EXPECT_THAT(place_of("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
              ElementsAre("3:1 E6501"));
  EXPECT_THAT(place_of("ply\nformat ascii 1.0\nfine words\nend_header\n"),
              ElementsAre("3:1 E6501"));
  EXPECT_EQ(place_of("ply\nformat ascii 1.0\n").size(), 1u);
  EXPECT_EQ(place_of("ply\nend_header\n").size(), 1u);
}

// As MeshLab writes it: several lines TextureFile, and for each face which of them.
TEST(Ply, FacesHaveTexturesOfTheirOwn) {
  const std::string red("P6\n1 1\n255\n\xff\x00\x00", 14), blue("P6\n1 1\n255\n\x00\x00\xff", 14);
  const auto text = [](const std::string& numbers) {
    std::string out =
        "ply\nformat ascii 1.0\ncomment TextureFile red one.ppm\ncomment TextureFile blue.ppm\n"
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\n" +
        std::string(numbers.empty() ? "" : "property int texnumber\n") +
        "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    for (std::size_t i = 0; i < 4; ++i) {
      out += i % 2 == 0 ? "3 0 1 2 6 0 0 1 0 1 1 " : "3 0 2 3 6 0 0 1 1 0 1 ";
      if (!numbers.empty()) out += numbers.substr(2 * i, 2);
      out += "\n";
    }
    return out;
  };
  const auto read = [&](const std::string& numbers) {
    return read_meshes({{"m.ply", text(numbers)}, {"red one.ppm", red}, {"blue.ppm", blue}});
  };
  const auto out = read(" 1 0-1 1");
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_THAT(out->places(), testing::IsEmpty()) << out->text();
  ASSERT_EQ(out->scene().instances.size(), 3u);  // none, red, blue
  EXPECT_EQ(out->material(0).maps.albedo, -1);
  EXPECT_EQ(out->mesh(0).triangles.size(), 1u);
  const auto texel = [&](std::size_t i) {
    return out->scene().textures[static_cast<std::size_t>(out->material(i).maps.albedo)].rgba[0];
  };
  EXPECT_EQ(texel(1), 255);
  EXPECT_EQ(out->mesh(1).triangles.size(), 1u);
  EXPECT_EQ(texel(2), 0);
  EXPECT_EQ(out->mesh(2).triangles.size(), 2u);
  EXPECT_EQ(out->mesh(2).texcoords.size(), out->mesh(2).positions.size());
  const auto wrong = read(" 1 0 7 1");
  EXPECT_THAT(wrong->text(), HasSubstr("texture 7 of 2"));
  const auto silent = read("");
  EXPECT_THAT(silent->text(), HasSubstr("no 'texnumber'"));
  EXPECT_EQ(silent->scene().instances.size(), 1u);
}

}  // namespace
}  // namespace panwright::importers::ply_test
