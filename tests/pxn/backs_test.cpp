// What backs are made of: by a material, a preset, or a shape itself.

#include <gtest/gtest.h>

#include "tests/pxn/reading.h"

namespace panwright::pxn::backs_test {
namespace {

// Fronts and backs of the instances, by name, "-" where both sides are alike.
std::string sides(const Reading& r) {
  std::string out;
  if (!r.scene) return "no scene";
  for (const scene::Instance& one : r.scene->instances) {
    if (!out.empty()) out += ", ";
    out += r.scene->materials[static_cast<std::size_t>(one.material)].name + "/" +
           (one.back == scene::kNone ? "-"
                                     : r.scene->materials[static_cast<std::size_t>(one.back)].name);
  }
  return out;
}

Reading read_model(const std::string& text) {
  return read_files({{"m.pxn", "<pangu_model ver=\"1\">\n" + text + "\n</pangu_model>\n"}});
}

TEST(Backs, OfMaterialsBasesAndPresets) {
  const Reading r = read_model(R"(
<material name="outer" back="inner"><diffuse>0.5 0.5 0.5</diffuse></material>
<material name="worn" base="outer"><diffuse>0.4 0.4 0.4</diffuse></material>
<material name="bare" base="outer" back="none"/>
<material name="inner"><diffuse>0.1 0.2 0.3</diffuse></material>
<material name="foil" preset="mli_gold_kapton"/>
<material name="own" preset="mli_gold_kapton" back="inner"/>
<material name="dull" preset="mli_gold_kapton" back="none"/>
<material name="painted" back="mli_black"><diffuse>0.9 0.9 0.9</diffuse></material>
<plane size="1" material="outer"/>
<plane size="1" material="worn"/>
<plane size="1" material="bare"/>
<plane size="1" material="inner"/>
<plane size="1" material="foil"/>
<plane size="1" material="own"/>
<plane size="1" material="dull"/>
<plane size="1" material="painted"/>
<plane size="1"/>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r),
            "outer/inner, worn/inner, bare/-, inner/-, foil/mli_aluminised, own/inner, "
            "dull/-, painted/mli_black, default/-");
}

TEST(Backs, OfShapesAndWhatIsAround) {
  const Reading r = read_model(R"(
<material name="outer" back="inner"/>
<material name="inner"><diffuse>0.1 0.2 0.3</diffuse></material>
<node material="outer">
  <plane size="1"/>
  <plane size="1" back="mli_silver"/>
  <plane size="1" back="none"/>
  <plane size="1" material="inner"/>
  <plane size="1" material="inner" back="outer"/>
</node>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r), "outer/inner, outer/mli_silver, outer/-, inner/-, inner/outer");
}

// Two sides of one film are each other's backs, in whatever order they are read.
TEST(Backs, OfEachOther) {
  for (const bool based : {false, true}) {
    const Reading r =
        read_model(std::string("<material name=\"a\" back=\"b\"") + (based ? " base=\"b\"" : "") +
                   "/>\n<material name=\"b\" back=\"a\"><diffuse>0.1 0.2 0.3</diffuse></material>\n"
                   "<plane size=\"1\" material=\"a\"/><plane size=\"1\" material=\"b\"/>");
    EXPECT_EQ(r.summary(), "") << based;
    EXPECT_EQ(sides(r), "a/b, b/a");
  }
  const Reading self =
      read_model("<material name=\"a\" back=\"a\"/><plane size=\"1\" material=\"a\"/>");
  EXPECT_EQ(self.summary(), "");
  EXPECT_EQ(sides(self), "a/-") << "both sides are alike";
}

TEST(Backs, FromIncludedFiles) {
  const Reading r =
      read_files({{"m.pxn",
                   "<pangu_model ver=\"1\"><include file=\"library.pxn\"/><material name=\"mine\" "
                   "base=\"outer\"/><plane size=\"1\" material=\"mine\"/><plane size=\"1\" "
                   "back=\"inner\"/></pangu_model>"},
                  {"library.pxn",
                   "<pangu_model ver=\"1\"><material name=\"outer\" back=\"inner\"/><material "
                   "name=\"inner\"><diffuse>0.1 0.2 0.3</diffuse></material></pangu_model>"}});
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r), "mine/inner, default/inner");
}

TEST(Backs, UnknownNamesAreReported) {
  const Reading r = read_model(
      "<material name=\"outer\" back=\"iner\"/><material name=\"inner\"/>\n"
      "<plane size=\"1\" back=\"mli_gold_capton\"/>");
  EXPECT_EQ(r.summary(),
            "3:23 E1311 unknown material 'mli_gold_capton' (did you mean 'mli_gold_kapton'?)\n"
            "2:30 E1311 unknown material 'iner' (did you mean 'inner'?)\n");
}

// A back has the holes of the front; others of its own are refused.
TEST(Backs, HolesAreThoseOfTheFront) {
  const std::string image = std::string("P6 1 1 255\n") + "\xff\x80\x40";
  const auto with = [&](const std::string& outer, const std::string& inner,
                        const std::string& back = "inner") {
    return read_files(
        {{"m.pxn", "<pangu_model ver=\"1\">\n<material name=\"outer\" back=\"" + back + "\">" +
                       outer + "</material>\n<material name=\"inner\">" + inner +
                       "</material>\n<plane size=\"1\" material=\"outer\"/><plane "
                       "size=\"1\" material=\"outer\"/></pangu_model>"},
         {"p.ppm", image}});
  };
  const std::string holes = "<cutout image=\"p.ppm\"/>";
  const Reading other = with("", holes);
  EXPECT_EQ(other.codes(), (std::multiset<std::string>{"W1410"})) << other.summary();
  EXPECT_EQ(sides(other), "outer/-, outer/-") << "said once";
  for (const std::string& inner : {std::string(), holes, "<diffuse>0.1 0.2 0.3</diffuse>" + holes})
    for (const std::string back : {"inner", "mli_aluminised"}) {
      const Reading same = with(holes, inner, back);
      EXPECT_EQ(same.summary(), "");
      const std::int32_t index = same.scene->instances[0].back;
      ASSERT_NE(index, scene::kNone);
      const materials::Material& made = same.scene->materials[static_cast<std::size_t>(index)];
      EXPECT_EQ(made.name, back);
      EXPECT_EQ(made.maps.cutout, same.scene->materials[0].maps.cutout);
    }
}

// Nobody sees the back of what is closed: nothing of it is made.
TEST(Backs, NotOfClosedShapes) {
  const Reading r = read_model(R"(
<material name="outer" back="inner"/>
<material name="inner"><diffuse>0.1 0.2 0.3</diffuse></material>
<sphere radius="1" material="outer"/>
<box size="1" material="outer"/>
<cylinder radius="1" height="1" caps="none" material="outer"/>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r), "outer/-, outer/-, outer/inner");
}

// What an appearance changes is the front.
TEST(Backs, StayWhereAnAppearanceChangesTheFront) {
  const Reading r = read_model(R"(
<material name="outer" back="inner"/>
<material name="inner"><diffuse>0.1 0.2 0.3</diffuse></material>
<node material="outer">
<appearance><material><diffuse>0.9 0.9 0.9</diffuse></material><child><plane size="1"/></child></appearance>
</node>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r), "material1/inner");
}

// Sheets have backs; blankets over faces lie on what they cover.
TEST(Backs, OfSheetsAndNotOfBlankets) {
  const Reading r = read_model(R"(
<material name="gold" preset="mli_gold_kapton"/>
<material name="edge" preset="mli_edge"/>
<mli type="flat" material="gold" edge="edge"><mli_settings><width>0.2</width><height>0.2</height><xgrid>20</xgrid></mli_settings>
<mli_operations preset="smooth"/></mli>
<box size="0.5" material="gold" foil="smooth"/>
<plane name="sheet" size="0.5" material="edge"/>
<mli name="cover" type="wrap" on="sheet" material="gold" back="mli_black" tape="edge"><mli_operations preset="smooth"/></mli>)");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(sides(r),
            "gold/mli_aluminised, edge/-, gold/-, edge/-, gold/-, gold/mli_black, edge/-");
}

}  // namespace
}  // namespace panwright::pxn::backs_test
