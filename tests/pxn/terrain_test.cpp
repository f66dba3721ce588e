// Terrain of a text: which files, and what is taken of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/pxn/reading.h"

namespace panwright::pxn::terrain_test {
namespace {

using testing::HasSubstr;

struct Read {
  std::optional<TerrainText> terrain;
  Reading reading;
};

Read read_terrain(const std::string& nodes, const std::string& root = "") {
  Read out;
  Options options;
  options.terrain = &out.terrain;
  out.reading =
      read_files({{"m.pxn", "<pangu_model ver=\"1\"" + root + ">\n" + nodes + "\n</pangu_model>\n"},
                  {"a.lbl", "PDS"},
                  {"maps/b.img", "CUB"}},
                 options);
  return out;
}

TEST(TerrainText, EveryAttribute) {
  const Read r = read_terrain(
      R"(<param name="site" value="2"/><terrain error="5cm">
  <dem file="a.lbl" unit="km" values="radius" radius="1737.4km" spacing="5" void="-32768"
       pixels="8 16 {128*site} 64" reduce="{site}" raise="-12.5m" blend="2km"/>
  <dem file="maps/b.img" unit="m" values="height" bounds="-90 0 -80 360"/>
</terrain>)",
      R"( units="mm")");
  EXPECT_EQ(r.reading.summary(), "");
  ASSERT_TRUE(r.terrain);
  EXPECT_DOUBLE_EQ(r.terrain->error, 0.05);
  EXPECT_EQ(r.terrain->source.line, 2u);
  ASSERT_EQ(r.terrain->dems.size(), 2u);
  const DemText& a = r.terrain->dems[0];
  EXPECT_EQ(a.file, "a.lbl");
  EXPECT_EQ(a.source.line, 3u);
  EXPECT_EQ(a.unit, 1000);
  EXPECT_EQ(a.radii, true);
  EXPECT_EQ(a.radius, 1737400);
  EXPECT_EQ(a.spacing, 0.005);
  EXPECT_EQ(a.no_height, -32768);
  EXPECT_EQ(a.pixels, (std::array<std::uint32_t, 4>{8, 16, 256, 64}));
  EXPECT_FALSE(a.bounds);
  EXPECT_EQ(a.reduce, 2u);
  EXPECT_EQ(a.raise, -12.5);
  EXPECT_EQ(a.blend, 2000);
  const DemText& b = r.terrain->dems[1];
  EXPECT_EQ(b.file, "maps/b.img");
  EXPECT_EQ(b.unit, 1);
  EXPECT_EQ(b.radii, false);
  EXPECT_FALSE(b.radius || b.spacing || b.no_height || b.pixels);
  EXPECT_EQ(b.bounds, (std::array<double, 4>{-90, 0, -80, 360}));
  EXPECT_EQ(b.reduce, 1u);
  EXPECT_EQ(b.raise + b.blend, 0);
}

TEST(TerrainText, MaterialAndAlbedo) {
  const Read r = read_terrain(
      R"(<terrain material="m"><dem file="a.lbl"/>
  <albedo file="a.lbl" bands="3 2 1" scale="1e-4" reflectance="30 0 30" radius="1737.4km"
          spacing="5" void="-1"/>
  <albedo file="maps/b.img" bands="2"/>
</terrain><material name="m"><diffuse> 0.1 0.2 0.3 </diffuse></material>)");
  EXPECT_EQ(r.reading.summary(), "");
  ASSERT_TRUE(r.terrain && r.terrain->material);
  EXPECT_EQ(r.terrain->material->name, "m");
  EXPECT_EQ(r.terrain->material->diffuse, Vec3(0.1, 0.2, 0.3));
  ASSERT_EQ(r.terrain->albedo.size(), 2u);
  const AlbedoText& a = r.terrain->albedo[0];
  EXPECT_EQ(a.file, "a.lbl");
  EXPECT_EQ(a.source.line, 3u);
  EXPECT_EQ(a.bands, (std::array<std::uint32_t, 3>{3, 2, 1}));
  EXPECT_EQ(a.scale, 1e-4);
  ASSERT_TRUE(a.reflectance);
  EXPECT_DOUBLE_EQ((*a.reflectance)[0], 30 * kDegree);
  EXPECT_EQ((*a.reflectance)[1], 0);
  EXPECT_DOUBLE_EQ((*a.reflectance)[2], 30 * kDegree);
  EXPECT_EQ(a.radius, 1737400);
  EXPECT_EQ(a.spacing, 5);
  EXPECT_EQ(a.no_value, -1);
  const AlbedoText& b = r.terrain->albedo[1];
  EXPECT_EQ(b.bands, (std::array<std::uint32_t, 3>{2, 2, 2}));
  EXPECT_EQ(b.scale, 1);
  EXPECT_FALSE(b.reflectance || b.radius || b.spacing || b.no_value);
}

TEST(TerrainText, Defaults) {
  const Read r = read_terrain(R"(<terrain><dem file="a.lbl"/></terrain>)");
  ASSERT_TRUE(r.terrain);
  EXPECT_EQ(r.terrain->error, 0);
  ASSERT_EQ(r.terrain->dems.size(), 1u);
  EXPECT_EQ(r.terrain->dems[0].reduce, 1u);
  EXPECT_EQ(r.terrain->dems[0].raise, 0);
  EXPECT_EQ(r.terrain->dems[0].blend, 0);
}

TEST(TerrainText, ProblemsHaveTheirPlace) {
  const auto told = [](const std::string& attributes) {
    return read_terrain("<terrain><dem file=\"a.lbl\" " + attributes + "/></terrain>")
        .reading.summary();
  };
  EXPECT_THAT(told(R"(pixels="0 0 8.5 8")"), HasSubstr("2:36 E1202 pixels are whole numbers"));
  EXPECT_THAT(told(R"(bounds="10 0 5 20")"), HasSubstr("2:36 E1202 bounds are south, west"));
  EXPECT_THAT(told(R"(bounds="1 2 3 4" pixels="1 2 3 4")"), HasSubstr("bounds"));
  EXPECT_THAT(told(R"(reduce="0")"), HasSubstr("E1202"));
  EXPECT_THAT(told(R"(blend="-1")"), HasSubstr("E1202"));
  EXPECT_THAT(read_terrain("<terrain><dem file=\"c.lbl\"/></terrain>").reading.summary(),
              HasSubstr("2:21 E1301"));
  EXPECT_THAT(read_terrain("<terrain/>").reading.summary(), HasSubstr("dem"));
}

TEST(TerrainText, StandsAlone) {
  const Read beside =
      read_terrain("<terrain><dem file=\"a.lbl\"/></terrain>\n<sphere radius=\"1\"/>");
  EXPECT_FALSE(beside.reading.scene);
  EXPECT_THAT(beside.reading.summary(), HasSubstr("E9613 m.pxn:3:1: a file with a <terrain>"));
  // a reader that makes no terrain says so
  const Reading left = read_files(
      {{"m.pxn", "<pangu_model ver=\"1\"><terrain><dem file=\"a.lbl\"/></terrain></pangu_model>"},
       {"a.lbl", "PDS"}});
  EXPECT_TRUE(left.scene);
  EXPECT_THAT(left.summary(), HasSubstr("W9620"));
}

}  // namespace
}  // namespace panwright::pxn::terrain_test
