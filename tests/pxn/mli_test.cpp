// <mli>: what stands in the text against the sheets of mli/, and what cannot be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mli/form.h"
#include "mli/preset.h"
#include "schemas/generated/pxn_schema.h"
#include "tests/pxn/reading.h"

namespace panwright::pxn::mli_test {
namespace {

using testing::HasSubstr;

std::string sheet(const std::string& attributes, const std::string& operations,
                  const std::string& settings =
                      "<width> 0.6 </width> <height> 0.3 </height> <xgrid> 60 </xgrid>") {
  return "<mli " + attributes + ">\n<mli_settings> " + settings +
         " </mli_settings>\n<mli_operations> " + operations + " </mli_operations>\n</mli>";
}

Reading read_1(const std::string& inside, const std::string& root = "",
               const Options& options = {}) {
  return read_files(
      {{"m.pxn", "<pangu_model ver=\"1\"" + root + ">\n" + inside + "\n</pangu_model>\n"}},
      options);
}

const geometry::Mesh& mesh_of(const Reading& r, std::size_t shape = 0) {
  return *std::get<geometry::MeshShape>(r.scene->shapes.at(shape));
}

// Figure 9 of the paper at its own level: vertices stand where x and y say, heights are 0 within 5
// of the left and right edges and 2.5 of the others, 4 on average and within 1 of it beyond 7, 3.5.
TEST(Mli, Figure9) {
  const Reading r = read_nodes(
      sheet("type=\"flat\"",
            "<random> 1.0 </random> <smooth> 4 </smooth> <constant> 4.0 </constant> <taper> 5 7 "
            "2.5 3.5 </taper>",
            "<width> 120 </width> <height> 60 </height> <xgrid> 240 </xgrid>"));
  EXPECT_EQ(r.summary(), "");
  const geometry::Mesh& mesh = mesh_of(r);
  // vertices of sharp edges stand again behind the others
  constexpr std::size_t kVertices = 241u * 121u;
  ASSERT_GE(mesh.positions.size(), kVertices);
  EXPECT_EQ(mesh.triangles.size(), 2u * 240u * 120u);
  EXPECT_FALSE(mesh.closed);
  double sum = 0, variance = 0, inner = 0;
  for (std::size_t i = 0; i < kVertices; ++i) {
    const Vec3 p = mesh.positions[i];
    EXPECT_EQ(p.x, 0.5 * static_cast<double>(i % 241) - 60);
    EXPECT_EQ(p.y, 0.5 * static_cast<double>(i / 241) - 30);
    const double x = 60 - std::fabs(p.x), y = 30 - std::fabs(p.y);
    if (x <= 5 || y <= 2.5) {
      EXPECT_EQ(p.z, 0) << p.x << " " << p.y;
    }
    if (x < 7 || y < 3.5) continue;
    inner += 1;
    sum += p.z - 4;
    variance += (p.z - 4) * (p.z - 4);
    EXPECT_LT(std::fabs(p.z - 4), 1);
  }
  // four passes leave 0.02847 of a third, here over 24,000 vertices of which about
  // 81 share each noise
  EXPECT_NEAR(sum / inner, 0, 4 * std::sqrt(1.0 / 3 / inner));
  EXPECT_NEAR(variance / inner / (0.02846788 / 3), 1, 0.15);
}

// Every operation and form of the text against the same recipe in C++.
TEST(Mli, TheTextIsTheRecipe) {
  const std::string operations =
      "<random> 1mm </random> <smooth> 2 </smooth> <constant> 5mm </constant>"
      "<wrinkle wavelength=\"10cm\" amplitude=\"1mm\" direction=\"30deg\" anisotropy=\"2\"/>"
      "<crease density=\"800\" depth=\"1mm\" length=\"4cm\" spread=\"0.4\" tail=\"3\" "
      "tail_share=\"0.2\"/>"
      "<fractal hurst=\"0.6\" rms=\"1mm\" longest=\"20cm\"/>"
      "<emboss pattern=\"diamond\" pitch=\"5cm\" depth=\"1mm\"/>"
      "<seam along=\"y\" position=\"20cm\" width=\"3cm\" height=\"1mm\" stitch=\"2cm\" "
      "pucker=\"0.5mm\"/>"
      "<button pitch=\"15cm\" radius=\"3mm\" reach=\"4cm\" pucker=\"0.5mm\"/>"
      "<crush size=\"8cm\" depth=\"1mm\"/> <slope_rms> 0.1 </slope_rms>"
      "<taper> 1cm 2cm 3cm 4cm </taper>";
  mli::Recipe recipe;
  recipe.width = 0.6;
  recipe.height = 0.3;
  recipe.xgrid = 60;
  recipe.seed = 7;
  recipe.operations = {mli::Random{1e-3},
                       mli::Smooth{2},
                       mli::Constant{5e-3},
                       mli::Wrinkle{0.1, 1e-3, 30 * kDegree, 2},
                       mli::Crease{800, 1e-3, 0.04, 0.4, 3, 0.2},
                       mli::Fractal{0.6, 1e-3, 0.2},
                       mli::Emboss{mli::Pattern::diamond, 0.05, 1e-3},
                       mli::Seam{false, 0.2, 0.03, 1e-3, 0.02, 0.5e-3},
                       mli::Button{0.15, 3e-3, 0.04, 0.5e-3},
                       mli::Crush{0.08, 1e-3},
                       mli::SlopeRms{0.1},
                       mli::Taper{0.01, 0.02, 0.03, 0.04}};
  DiagnosticLog log;
  const auto made = mli::made(recipe, {}, log);
  ASSERT_TRUE(made);
  const std::pair<std::string, mli::Form> forms[] = {
      {"type=\"flat\"", mli::Flat{}},
      {"type=\"tube\" radius=\"8cm\" length=\"20cm\" flange=\"1cm\"", mli::Tube{0.08, 0.2, 0.01}},
      {"type=\"tubular\"", mli::Tube{0, 0, 0}},
      {"type=\"conical\" radius=\"6cm\" top_radius=\"2cm\" length=\"10cm\" flange=\"1cm\"",
       mli::Cone{0.06, 0.02, 0.1, 0.01}},
      {"type=\"cone\"", mli::Cone{0.15, 0, 0.3 * std::sqrt(3.0) / 2, 0}},
      {"type=\"disc\" flange=\"1cm\"", mli::Disc{0.14, 0.01}},
      {"type=\"box\" size=\"10cm 8cm 6cm\" flange=\"1cm\"", mli::Box{{0.1, 0.08, 0.06}, 0.01}}};
  for (const auto& [attributes, form] : forms) {
    const Reading r = read_1(sheet(attributes + " seed=\"7\"", operations));
    EXPECT_EQ(r.log.errors(), 0u) << attributes << r.summary();
    if (r.log.errors() > 0) continue;
    const auto expected = mli::formed(*made, form, log);
    ASSERT_TRUE(expected) << attributes;
    const geometry::Mesh& mesh = mesh_of(r);
    // vertices of sharp edges stand again behind the others
    ASSERT_GE(mesh.positions.size(), expected->positions.size()) << attributes;
    double off = 0;
    for (std::size_t i = 0; i < expected->positions.size(); ++i)
      off = std::max(off, glm::length(mesh.positions[i] - expected->positions[i]));
    // last digits of numbers with units, 6e-17 m
    EXPECT_LT(off, 1e-15) << attributes;
    EXPECT_EQ(mesh.triangles.size(), expected->triangles.size()) << attributes;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << attributes;
  }
}

TEST(Mli, ASheetIsMadeOnceForEachSeed) {
  const Reading r =
      read_1("<repeat count=\"3\" var=\"k\">" +
             sheet("type=\"flat\" translate=\"{k} 0 0\"", "<random> 1mm </random>") + "</repeat>" +
             "<repeat count=\"3\" var=\"k\">" +
             sheet("type=\"flat\" seed=\"{k}\"", "<random> 1mm </random>") + "</repeat>");
  EXPECT_EQ(r.summary(), "");
  EXPECT_EQ(r.scene->instances.size(), 6u);
  EXPECT_EQ(r.scene->shapes.size(), 3u);
  ASSERT_EQ(r.scene->foils.size(), 3u);
  EXPECT_EQ(r.scene->foils[2].recipe.seed, 2u);
  EXPECT_EQ(r.scene->foils[2].source.line, 5u);
  // white noise: central differences have a² / 6 d², those at the 2 of 61 columns
  // and 2 of 31 rows, from one side, four times as much
  EXPECT_NEAR(r.scene->foils[0].statistics.slope_rms /
                  std::sqrt(1e-6 / 6 / 1e-4 * (2 + 3 * (2.0 / 61 + 2.0 / 31))),
              1, 0.03);  // measured 0.986: 1891 heights
}

TEST(Mli, LengthsAreInTheUnitsOfTheFile) {
  const std::string metres = sheet("type=\"tube\" radius=\"0.08\"", "<random> 0.001 </random>");
  const std::string millimetres =
      sheet("type=\"tube\" radius=\"80\"", "<random> 1 </random>",
            "<width> 600 </width> <height> 300 </height> <xgrid> 60 </xgrid>");
  const Reading a = read_1(metres), b = read_1(millimetres, " units=\"mm\"");
  EXPECT_EQ(a.summary() + b.summary(), "");
  for (std::size_t i = 0; i < mesh_of(a).positions.size(); ++i)
    // 1000 roundings of the last digit, of half a metre
    EXPECT_LT(glm::length(mesh_of(a).positions[i] - mesh_of(b).positions[i]), 1e-15);
}

TEST(Mli, WhatCannotBeMadeIsSaidWhereItStands) {
  const std::string level = "<constant> 1mm </constant>";
  const std::pair<std::string, std::string> cases[] = {
      {sheet("type=\"flat\" radius=\"1\"", level),
       "2:26 E7001 a sheet of type 'flat' has no radius\n"},
      {sheet("type=\"cone\" radius=\"1\"", level),
       "2:2 E7001 the cone has no length; a radius and a length are given together, or neither\n"},
      {sheet("type=\"tube\" radius=\"1\"", level), "2:2 E7001 the sheet is 0.6 by 0.3 m"},
      {sheet("type=\"box\"", level), "2:2 E7001 the form's flange is 0"},
      {sheet("type=\"flat\"", "<wrinkle wavelength=\"1mm\" amplitude=\"1mm\"/>"),
       "4:19 E7001 operation 1, wrinkle: wavelength 0.001 m is less than two cells"},
      {sheet("type=\"flat\"", "<taper> 0 0.4 0 0 </taper>"), "4:19 E7001 operation 1, taper"},
      {sheet("type=\"flat\"", "<slope_rms> 0.1 </slope_rms>"), "E7001"},
      {sheet("type=\"flat\"", "<crease depth=\"1mm\" length=\"2cm\"/>"),
       "4:19 E1103 the attribute 'density' of <crease> is missing"},
      {sheet("type=\"flat\"", "<emboss pattern=\"quilts\" pitch=\"9cm\" depth=\"1cm\"/>"),
       "E1204 pattern of <emboss> is 'quilts', expected quilt or diamond"},
      {sheet("type=\"flat\"", level, "<width> 1 </width> <height> 1 </height>"),
       "3:2 E1103 <mli_settings> needs <xgrid>"},
      {sheet("type=\"flat\"", level, "<width> 0 </width> <height> 1 </height> <xgrid> 4 </xgrid>"),
       "3:24 E1202 <width> is 0, expected more than 0"},
      {sheet("type=\"flat\"", level,
             "<width> 1 </width> <height> 1 </height> <xgrid> 10000000 </xgrid>"),
       "E1202 <xgrid> is 10000000, expected 1 to 100000"},
      {sheet("type=\"flat\"", level,
             "<width> 1 </width> <height> 1 </height> <xgrid> 5000 </xgrid>"),
       "3:57 E7001 the sheet has 25010001 vertices; all sheets of a model may have 20000000, and "
       "20000000 are left"},
      {sheet("type=\"flat\"", level,
             "<width> 1 </width> <height> 1 </height> <xgrid> 2.5 </xgrid>"),
       "3:64 E1201 '2.5' is not a whole number, expected 1 to 100000 for <xgrid>"},
      {sheet("type=\"flat\"", level,
             "<width> 1 </width> <height> 1 </height> <xgrid> 20 30 </xgrid>"),
       "3:57 E1203 <xgrid>: expected 1 whole number, found 2"},
      {sheet("type=\"flat\"", "<smooth> 1.9 </smooth>"),
       "4:27 E1201 '1.9' is not a whole number, expected 0 to 10000 for <smooth>"},
      {sheet("type=\"flat\"", "<smooth> 1mm </smooth>"),
       "4:27 E1212 a plain number is needed here, got a length (1mm)"},
      {sheet("type=\"sphere\"", level),
       "E1204 type of <mli> is 'sphere', expected flat or cone or conical or tube or tubular or "
       "disc or box"}};
  for (const auto& [text, expected] : cases) {
    const Reading r = read_1(text);
    EXPECT_THAT(r.summary(), HasSubstr(expected)) << text;
    EXPECT_GE(r.log.errors(), 1u) << text;
  }
  // said once, with the first run's number
  EXPECT_EQ(read_1("<repeat count=\"3\" var=\"k\">\n" +
                   sheet("type=\"flat\" radius=\"1\" seed=\"{k}\"", level) + "</repeat>")
                .summary(),
            "3:26 E7001 a sheet of type 'flat' has no radius, with k = 0\n");
}

// The words of the tables are those of the library, each with its material; what follows a preset
// comes after it.
TEST(Mli, Presets) {
  const schemas::Element& element =
      schemas::kPxn.elements[static_cast<std::size_t>(schemas::ElementId::mli_operations)];
  const auto words = element.attributes[schemas::attribute::mli_operations_preset].value.words;
  ASSERT_EQ(words.size(), mli::presets().size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const mli::Preset& preset = mli::presets()[i];
    EXPECT_EQ(words[i], preset.name);
    std::string text = sheet("type='flat' material='m'", "<constant> 1mm </constant>",
                             "<width> 0.2 </width> <height> 0.1 </height> <xgrid> 100 </xgrid>");
    text.replace(text.find("<mli_operations>"), 16,
                 "<mli_operations preset='" + std::string(preset.name) + "'>");
    const Reading r =
        read_1("<material name='m' preset='" + std::string(preset.material) + "'/>" + text);
    EXPECT_EQ(r.summary(), "") << preset.name;
    ASSERT_EQ(r.scene->foils.size(), 1u);
    EXPECT_NEAR(r.scene->foils[0].statistics.height_mean, 1e-3, 5e-3);
    EXPECT_EQ(mli::name_of(r.scene->foils[0].recipe.operations.back()), "constant");
    EXPECT_EQ(r.scene->foils[0].recipe.operations.size(),
              mli::preset_operations(preset.name, 0.1)->size() + 1);
  }
  // the place is the preset's
  std::string coarse = sheet("type='flat'", "");
  coarse.replace(coarse.find("<mli_operations>"), 16, "<mli_operations preset='embossed'>");
  EXPECT_THAT(read_1(coarse).summary(),
              HasSubstr("4:25 E7001 operation 3, emboss: pitch 0.008 m is less than two cells"));
}

TEST(Mli, NewOperationsBelongToLevel1) {
  EXPECT_THAT(read_nodes(sheet("type=\"flat\"", "<slope_rms> 0.1 </slope_rms>")).summary(),
              HasSubstr("E1106 'slope_rms' belongs to level 1"));
}

}  // namespace
}  // namespace panwright::pxn::mli_test
