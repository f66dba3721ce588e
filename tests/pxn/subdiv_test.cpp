// Subdivision surfaces: what a text says of a cage, and where it is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pxn/writer.h"
#include "tests/pxn/reading.h"
#include "tests/support/paths.h"

namespace panwright::pxn::subdiv_test {
namespace {

using geometry::Subdiv;

Reading cage(const std::string& inside, const std::string& attributes = "") {
  return read_files({{"m.pxn", "<pangu_model ver='1'>\n<subdiv " + attributes +
                                   ">\n<vertices>0 0 0 1 0 0 1 1 0 0 1 0 2 0 0 2 1 "
                                   "0</vertices>\n<face><outline>0 1 2 3</outline></face>\n" +
                                   inside + "\n</subdiv></pangu_model>"}});
}

TEST(Subdiv, IsReadAsItIsWritten) {
  const Reading r = read_files({{"m.pxn", R"(<pangu_model ver="1" units="mm">
<subdiv border="smooth" levels="3" tolerance="2mm">
  <vertices> 0 0 0  1 0 0  1 1 0  0 1 0  2 0 0  {1+1} 1 0 </vertices>
  <texcoords> 0 0  1 0  1 1  0 1 </texcoords>
  <face> <outline> 0 1 2 3 </outline> <uv> 0 1 2 3 </uv> </face>
  <face> <outline> 1 4 5 2 </outline> <uv> 0 1 2 3 </uv> </face>
  <crease> 1 2 </crease>
  <crease sharpness="1.5"> 0 1 4 </crease>
  <corner sharpness="0.25"> 2 3 </corner>
</subdiv></pangu_model>)"}});
  ASSERT_TRUE(r.scene) << r.summary();
  EXPECT_EQ(r.summary(), "");
  Subdiv expected;
  expected.positions = {{0, 0, 0},    {1e-3, 0, 0}, {1e-3, 1e-3, 0},
                        {0, 1e-3, 0}, {2e-3, 0, 0}, {2e-3, 1e-3, 0}};
  expected.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  expected.faces = {{{0, 1, 2, 3}, {0, 1, 2, 3}}, {{1, 4, 5, 2}, {0, 1, 2, 3}}};
  expected.creases = {{{1, 2}, geometry::kInfinitelySharp}, {{0, 1, 4}, 1.5}};
  expected.corners = {{{2, 3}, 0.25}};
  expected.smooth_border = true;
  expected.levels = 3;
  ASSERT_EQ(r.scene->shapes.size(), 1u);
  EXPECT_EQ(std::get<Subdiv>(r.scene->shapes[0]), expected);
  const Reading again = read_files({{"m.pxn", to_text(*r.scene)}});
  ASSERT_TRUE(again.scene) << again.summary();
  EXPECT_EQ(std::get<Subdiv>(again.scene->shapes[0]), expected);
}

TEST(Subdiv, ProblemsStandAtTheirPlaces) {
  EXPECT_EQ(cage("").summary(), "");
  EXPECT_EQ(cage("<crease>0 1 9</crease>").summary(),
            "5:13 E2001 index 9 of 6 vertices, expected at most 5\n");
  EXPECT_EQ(cage("<crease>0 1 3</crease>").summary(),
            "5:13 E2027 crease 1: no face has an edge from vertex 1 to 3\n");
  EXPECT_EQ(cage("<corner>7</corner>").summary(),
            "5:9 E2001 index 7 of 6 vertices, expected at most 5\n");
  EXPECT_EQ(cage("<face><outline>1 2 5 4</outline></face>").summary(),
            "5:1 E2026 face 2: it runs along its edge from vertex 1 to 2 the same way as face 1, "
            "expected outlines counter-clockwise from outside\n");
  EXPECT_EQ(cage("<face><outline>1 4 1 2</outline></face>").summary(),
            "5:1 E2015 face 2: its outline has vertex 1 twice, expected each vertex once\n");
  EXPECT_EQ(cage("<face><outline>1 4 5 2</outline><uv>0 1 2 3</uv></face>").summary(),
            "5:37 E2001 index 0 of no texture coordinates\n");
  EXPECT_THAT(cage("<crease sharpness='-1'>0 1</crease>").codes(), testing::ElementsAre("E1202"));
  EXPECT_THAT(cage("", "levels='11'").codes(), testing::ElementsAre("E1202"));
  EXPECT_THAT(cage("<texcoords>0 0 1</texcoords>").codes(), testing::ElementsAre("E1203"));
}

TEST(Subdiv, TheExampleIsSound) {
  const std::string path = PANWRIGHT_SOURCE_DIR "/examples/shapes/housing.pxn";
  const Reading r = read_path(path);
  ASSERT_TRUE(r.scene) << r.summary();
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->shapes.size(), 2u);
}

}  // namespace
}  // namespace panwright::pxn::subdiv_test
