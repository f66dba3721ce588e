// Meshes from text: strips, normals, and what is said about them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text.h"
#include "geometry/mesh/check.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"

namespace panwright::pxn::mesh_test {
namespace {

using testing::HasSubstr;

std::string list(const char* name, const char* item, const std::vector<Vec3>& values) {
  std::string out = std::string("<") + name + ">";
  for (const Vec3& v : values)
    out += std::string("<") + item + "> " + format_double(v.x) + "\t" + format_double(v.y) + " " +
           format_double(v.z) + "</" + item + ">";
  return out + "</" + name + ">";
}
std::string strips(const std::vector<std::string>& all) {
  std::string out = "<tristrips>";
  for (const std::string& s : all) out += "<tristrip>" + s + "</tristrip>";
  return out + "</tristrips>";
}
const std::vector<Vec3> kQuad = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};

Reading read_mesh(const std::string& inside, const Options& options = {}) {
  return read_nodes("<mesh>" + inside + "</mesh>", options);
}
const geometry::Mesh& mesh_of(const Reading& r) {
  return *std::get<geometry::MeshShape>(r.scene->shapes.at(0));
}

TEST(Mesh, CubeIsClosedAndHasSharpEdges) {
  const Reading r = read_path(PANWRIGHT_SOURCE_DIR "/tests/pxn/data/good/cube.pxn");
  EXPECT_EQ(r.summary(), "");
  const geometry::Mesh& mesh = mesh_of(r);
  EXPECT_TRUE(mesh.closed);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  const geometry::MeshReport report = geometry::check(mesh);
  EXPECT_DOUBLE_EQ(report.volume, 8);
  EXPECT_DOUBLE_EQ(report.area, 24);
  EXPECT_EQ(mesh.positions.size(), 24u) << "three normals at each corner";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // along one axis, outwards; exact
    EXPECT_EQ(glm::dot(mesh.normals[i], mesh.normals[i]), 1);
    EXPECT_EQ(glm::dot(mesh.normals[i], mesh.positions[i]), 1);
  }
}

TEST(Mesh, TheCreaseAngleIsAnOption) {
  Options smooth;
  smooth.crease_angle = kPi;
  const Reading r = read_path(PANWRIGHT_SOURCE_DIR "/tests/pxn/data/good/cube.pxn", smooth);
  EXPECT_EQ(mesh_of(r).positions.size(), 8u);
}

TEST(Mesh, GivenNormalsAreMadeUnitWhateverTheirLength) {
  const Reading r = read_mesh(
      list("positions", "vec3", kQuad) +
      list("normals", "vec3", {{0, 0, 2}, {0, 3e-200, 4e-200}, {3e29, 0, 4e29}, {0, 0, 1}}) +
      strips({"0 1 2 3"}));
  EXPECT_EQ(r.summary(), "");
  // measured 1.1e-16
  EXPECT_LT(glm::length(mesh_of(r).normals[1] - Vec3(0, 0.6, 0.8)), 1e-15);
  EXPECT_LT(glm::length(mesh_of(r).normals[2] - Vec3(0.6, 0, 0.8)), 1e-15);
}

TEST(Mesh, ZeroNormalsAreComputed) {
  const Reading r = read_mesh(
      list("positions", "vec3", kQuad) +
      list("normals", "vec3", {{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}}) + strips({"0 1 2 3"}));
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"W2008"});
  EXPECT_EQ(mesh_of(r).normals[0], Vec3(1, 0, 0));
  EXPECT_EQ(mesh_of(r).normals[1], Vec3(0, 0, 1));
  EXPECT_EQ(mesh_of(r).normals[3], Vec3(0, 0, 1));
}

TEST(Mesh, ListsOfAnotherLengthAreLeftOut) {
  const Reading r =
      read_mesh(list("positions", "vec3", kQuad) + list("normals", "vec3", {{1, 0, 0}}) +
                list("colours", "rgb", {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}) +
                list("texcoords", "vec3", kQuad) + strips({"0 1 2 3"}));
  EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E2002", "E2002"}));
  EXPECT_EQ(mesh_of(r).normals[0], Vec3(0, 0, 1)) << "computed instead";
  EXPECT_TRUE(mesh_of(r).colors.empty());
  EXPECT_EQ(mesh_of(r).texcoords.size(), 4u);
}

TEST(Mesh, ABadNumberInThePositionsLeavesTheMeshOut) {
  const Reading r =
      read_mesh("<positions><vec3>0 0 0</vec3><vec3>1 0 oops</vec3><vec3>0 1</vec3></positions>" +
                strips({"0 1 2"}));
  EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E1201", "E1203"}));
  EXPECT_TRUE(r.scene->shapes.empty());
}

TEST(Mesh, TheThirdTextureCoordinateIsZeroAndColorsReachOne) {
  EXPECT_THAT(read_mesh(list("positions", "vec3", kQuad) +
                        list("texcoords", "vec3", {{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0}, {1, 1, 0}}) +
                        strips({"0 1 2 3"}))
                  .summary(),
              HasSubstr("E1202 0 of <vec3> is 0.5, expected 0"));
  EXPECT_THAT(read_mesh(list("positions", "vec3", kQuad) +
                        list("colours", "rgb", {{0, 0, 0}, {1, 0, 1.5}, {0, 1, 0}, {1, 1, 0}}) +
                        strips({"0 1 2 3"}))
                  .summary(),
              HasSubstr("E1202 b of <rgb> is 1.5, expected 0 to 1"));
}

TEST(Mesh, BadIndicesLeaveTheirStripOut) {
  const Reading r =
      read_mesh(list("positions", "vec3", kQuad) +
                strips({"0 1 2", "0 7 2 9", "1 -1 2", "1 3 2", "4294967296 0 1", "0 1.5 2"}));
  EXPECT_EQ(r.codes(), (std::multiset<std::string>{"E1201", "E1202", "E1202", "E2001"}))
      << r.summary();
  EXPECT_THAT(r.summary(), HasSubstr("the index 7 is past the last position; there are 4 "
                                     "positions, expected 0 to 3; 1 more"));
  EXPECT_EQ(mesh_of(r).triangles.size(), 2u);
}

TEST(Mesh, ThinTrianglesAreLeftOutWhateverTheirSize) {
  for (const double size : {1e-25, 1e-6, 1.0, 1e6, 1e29}) {
    std::vector<Vec3> points = kQuad;
    // thinner and thicker than 1e-7 of their length
    points.push_back({0.5, 0.9e-7, 0});
    points.push_back({0.5, -1.2e-7, 0});
    for (Vec3& p : points) p *= size;
    const Reading r =
        read_mesh(list("positions", "vec3", points) + strips({"0 1 2 3", "0 1 4", "0 5 1"}));
    EXPECT_EQ(r.codes(), std::multiset<std::string>{"W2006"}) << size << r.summary();
    EXPECT_EQ(mesh_of(r).triangles.size(), 3u) << size;
  }
}

TEST(Mesh, NothingToSee) {
  for (const std::string& inside : {list("positions", "vec3", kQuad) + strips({}),
                                    list("positions", "vec3", kQuad) + strips({"", "0 1"}),
                                    list("positions", "vec3", kQuad) + strips({"0 0 1 1 1"}),
                                    std::string("<positions/>") + strips({""})}) {
    const Reading r = read_mesh(inside);
    EXPECT_TRUE(r.log.contains(Code("E2004"))) << r.summary();
    EXPECT_TRUE(r.scene->shapes.empty());
    EXPECT_EQ(r.log.errors(), 1u) << r.summary();
  }
}

TEST(Mesh, CountsAreChecked) {
  std::vector<Vec3> points = kQuad;
  for (const Vec3& p : kQuad) points.push_back(p + Vec3(5, 0, 0));
  const std::string inside = list("positions", "vec3", points) +
                             "<tristrips><tristrip count=\"4\">0 1 2 3</tristrip>"
                             "<tristrip count=\"5\">4 5 6</tristrip></tristrips>";
  const std::size_t column = 1 + std::string("<mesh>").size() + inside.find("5\">4");
  EXPECT_EQ(read_mesh(inside).summary(),
            "2:" + std::to_string(column) + " W1205 count is 5, and there are 3 indices\n");
}

}  // namespace
}  // namespace panwright::pxn::mesh_test
