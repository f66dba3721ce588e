// STL: texts and binary files, whole and damaged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::stl_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Polyhedron triangles() {
  Polyhedron out = cube();
  std::vector<std::vector<std::uint32_t>> cut;
  for (const auto& f : out.faces) {
    cut.push_back({f[0], f[1], f[2]});
    cut.push_back({f[0], f[2], f[3]});
  }
  out.faces = cut;
  return out;
}

TEST(Stl, SolidsAreNodes) {
  const auto out = read_meshes(
      {{"m.stl", stl_text_of(triangles(), "bus") + stl_text_of(triangles(), "left/wing") +
                     stl_text_of(triangles(), "")}});
  ASSERT_TRUE(out->out) << out->text();
  ASSERT_EQ(out->scene().instances.size(), 3u);
  EXPECT_EQ(out->path(0), "/bus");
  EXPECT_EQ(out->path(1), "/left_wing");
  EXPECT_EQ(out->path(2), "/solid1");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(geometry::check(out->mesh(i)).volume, 8);
  EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
}

TEST(Stl, WordsMayStandOnAnyLines) {
  const auto out = read_meshes(
      {{"m.stl",
        "SOLID x\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX 0 1 0 ENDLOOP "
        "ENDFACET\nENDSOLID x\n"}});
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(geometry::check(out->mesh()).area, 0.5);
  EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
}

TEST(Stl, FileNormalsAreNotUsed) {
  const auto out = read_meshes({{"m.stl",
                                 "solid\nfacet normal 1 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 "
                                 "0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"}});
  ASSERT_TRUE(out->out) << out->text();
  for (const Vec3& n : out->mesh().normals) EXPECT_EQ(n, Vec3(0, 0, 1));
}

TEST(Stl, WrongNumbersOfTrianglesAreTold) {
  const std::string whole = stl_binary_of(triangles());
  const auto said = [&](std::uint32_t count, std::size_t bytes) {
    std::string out = whole.substr(0, bytes);
    out.resize(bytes, '\0');
    std::string word;
    append_bytes(word, count);
    return read_meshes({{"m.stl", out.replace(80, 4, word)}});
  };
  const auto more = said(1000, whole.size());
  EXPECT_THAT(more->places(), ElementsAre("1:1 E6501"));
  EXPECT_EQ(more->mesh().triangles.size(), 12u);
  const auto cut = said(12, whole.size() - 60);
  EXPECT_THAT(cut->text(), HasSubstr("12 triangles are announced, and the file ends after 10"));
  EXPECT_EQ(cut->mesh().triangles.size(), 10u);
  const auto extra = said(12, whole.size() + 7);
  EXPECT_THAT(extra->places(), ElementsAre("1:1 W6502"));
  EXPECT_EQ(extra->mesh().triangles.size(), 12u);
  // streams whose length was not known
  for (const std::uint32_t count : {0u, 0xffffffffu}) {
    const auto unknown = said(count, whole.size());
    EXPECT_THAT(unknown->places(), ElementsAre("1:1 W6502")) << count;
    EXPECT_EQ(unknown->mesh().triangles.size(), 12u) << count;
  }
  const auto header = read_meshes({{"m.stl", whole.substr(0, 50)}});
  EXPECT_FALSE(header->out);
  EXPECT_TRUE(header->log.contains(Code("E6501")));
}

TEST(Stl, CornersThatAreNoPlaceAreLeftOut) {
  Polyhedron in = triangles();
  in.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  in.points.push_back({0, std::numeric_limits<double>::infinity(), 0});
  in.faces[3] = {0, 1, 8};
  in.faces[5] = {0, 9, 1};
  const auto out = read_meshes({{"m.stl", stl_binary_of(in)}});
  ASSERT_TRUE(out->out);
  EXPECT_EQ(out->mesh().triangles.size(), 10u);
  EXPECT_THAT(out->text(), HasSubstr("byte 234: triangle 3"));
  EXPECT_THAT(out->text(), HasSubstr("1 more like this one"));
}

TEST(Stl, WrongWordsCostTheirFacetAlone) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\n";
  const std::string no_number =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 zero 0\nvertex 0 1 0\nendloop\n"
      "endfacet\n";
  const std::string two =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"
      "endfacet\n";
  const auto out =
      read_meshes({{"m.stl", "solid a\n" + facet + no_number + "vortex 1 2 3\n" + two + facet}});
  ASSERT_TRUE(out->out);
  EXPECT_THAT(out->places(), ElementsAre("12:10 E6501", "16:1 E6501", "21:1 E6501", "29:1 E6501"));
  EXPECT_EQ(out->mesh().triangles.size(), 2u);
}

}  // namespace
}  // namespace panwright::importers::stl_test
