// `panwright mli` as a user runs it: statistics, files, refusals.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::mli_test {
namespace {

using nlohmann::json;
using support::contents;
using support::Outcome;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kBlankets = PANWRIGHT_SOURCE_DIR "/examples/blankets/blankets.pxn";

Outcome mli(std::vector<std::string> words) {
  words.insert(words.begin(), {PANWRIGHT_BIN_DIR "/panwright", "mli"});
  return support::run(words, {});
}

json sheet_of(const std::vector<std::string>& words) {
  std::vector<std::string> all = words;
  all.emplace_back("--json");
  const Outcome done = mli(all);
  EXPECT_EQ(done.code, 0) << done.err;
  const json out = json::parse(done.out);
  EXPECT_EQ(out["sheets"].size(), 1u);
  return out["sheets"].empty() ? json() : out["sheets"][0];
}

TEST(MliCommand, EveryPresetIsASheetOfItsOwnKind) {
  for (const auto& [name, slope] : {std::pair("crinkled", 0.3), std::pair("smooth", 0.05)}) {
    const json sheet = sheet_of({name});
    // scaled to it: residual 1e-16
    EXPECT_NEAR(sheet["slope_rms"].get<double>(), slope, 1e-9) << name;
  }
  EXPECT_EQ(sheet_of({"quilted"})["material"], "mli_beta_cloth");
  EXPECT_EQ(sheet_of({"embossed"})["operations"].back(), "emboss");
  EXPECT_EQ(sheet_of({"taped"})["name"], "taped");
}

TEST(MliCommand, SeedsGiveOtherSheetsAndTheSameSeedTheSame) {
  const json one = sheet_of({"crinkled"});
  EXPECT_EQ(one["checksum"], sheet_of({"crinkled", "--seed", "1", "--threads", "1"})["checksum"]);
  EXPECT_NE(one["checksum"], sheet_of({"crinkled", "--seed", "2"})["checksum"]);
  const json small = sheet_of({"crinkled", "--sheet-width", "0.3", "--cells", "100"});
  EXPECT_EQ(small["cells"], json({100, 100}));
  EXPECT_EQ(small["height"], 0.3) << "as high as wide";
}

TEST(MliCommand, SheetsOfModelsByNameAndNumberAndOfPanFiles) {
  const json named = sheet_of({kBlankets, "--sheet", "smooth"});
  EXPECT_EQ(named["checksum"], sheet_of({kBlankets, "--sheet", "2"})["checksum"]);
  EXPECT_NE(named["checksum"], sheet_of({kBlankets, "--sheet", "2", "-D", "seed=3"})["checksum"]);
  const TemporaryFolder folder;
  const std::string pan = folder / "b.pan";
  ASSERT_EQ(
      support::run({PANWRIGHT_BIN_DIR "/panwright", "compile", kBlankets, "-o", pan}, {}).code, 0);
  const json stored = sheet_of({pan, "--sheet", "2"});
  // the same numbers, read from a section of the file
  for (const char* number : {"heights", "height_rms", "slope_covariance", "slope_rms",
                             "slope_rms_axes", "correlation_length", "cells", "seed"})
    EXPECT_EQ(stored[number], named[number]) << number;
  EXPECT_FALSE(stored.contains("checksum"));
  const Outcome image = mli({pan, "--sheet", "2", "--height", folder / "h.npy"});
  EXPECT_EQ(image.code, 2);
  EXPECT_THAT(image.err, HasSubstr("a pan file holds its statistics only"));
  EXPECT_FALSE(std::filesystem::exists(folder / "h.npy"));
}

TEST(MliCommand, FitsARecipeThatCanBePasted) {
  const json sheet =
      sheet_of({"crinkled", "--cells", "100", "--fit", "slope_rms=0.1 correlation=2cm"});
  const json& fit = sheet["fit"];
  EXPECT_NEAR(sheet["slope_rms"].get<double>(), 0.1, 1e-9);
  ASSERT_EQ(fit["statistics"][1]["name"], "correlation");
  EXPECT_NEAR(fit["statistics"][1]["fitted"].get<double>(), 0.02, 0.006 * 0.02);
  // on sheets that it has not seen; residual 0.3 of a standard error
  EXPECT_NEAR(fit["statistics"][1]["checked"].get<double>(), 0.02,
              5 * fit["statistics"][1]["standard_error"].get<double>());
  EXPECT_TRUE(fit["statistics"][2]["asked"].is_null());
  const TemporaryFolder folder;
  const std::string file = folder.write(
      "a.pxn", "<pangu_model ver=\"1\">\n" + fit["pxn"].get<std::string>() + "</pangu_model>\n");
  EXPECT_EQ(sheet_of({file})["checksum"], sheet["checksum"]) << fit["pxn"];
  // every operation reads back as the same
  const std::string all = folder.write("all.pxn", R"(<pangu_model ver="1">
    <mli type="flat" seed="7"><mli_settings><width>0.5</width><height>0.4</height><xgrid>120</xgrid></mli_settings>
    <mli_operations><random>1mm</random><smooth>3</smooth><constant>2mm</constant>
    <crease density="900" depth="1mm" length="5cm"/><wrinkle wavelength="9cm" amplitude="1mm" direction="35deg"/>
    <fractal rms="0.3mm"/><emboss pattern="diamond" pitch="3cm" depth="1mm"/><emboss pattern="quilt" pitch="7cm" depth="1mm"/>
    <seam along="y" position="20cm" width="25mm" height="0.8mm" stitch="12mm" pucker="0.4mm"/>
    <button pitch="15cm" radius="3mm" reach="4cm" pucker="0.8mm"/><crush size="8cm" depth="1mm"/>
    <taper>1cm 3cm 1cm 3cm</taper></mli_operations></mli></pangu_model>)");
  json fitted = sheet_of({all, "--fit", "slope_rms=0.2"});
  const std::string again =
      folder.write("again.pxn", "<pangu_model ver=\"1\">\n" +
                                    fitted["fit"]["pxn"].get<std::string>() + "</pangu_model>\n");
  EXPECT_EQ(sheet_of({again})["checksum"], fitted["checksum"]) << fitted["fit"]["pxn"];
  EXPECT_EQ(fitted["operations"].size(), 13u);
}

TEST(MliCommand, WritesImagesHeightsAndHistograms) {
  const TemporaryFolder folder;
  const Outcome done = mli({"crinkled", "-o", folder / "i.png", "--width", "32", "--cells", "60",
                            "--height", folder / "h.exr", "--histogram", folder / "s.svg"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(contents(folder / "i.png"), StartsWith("\x89PNG"));
  EXPECT_THAT(contents(folder / "h.exr"), StartsWith("\x76\x2f\x31\x01"));
  const std::string plot = contents(folder / "s.svg");
  for (const char* word : {"along x", "along y", "Gaussian x", "Gaussian y", "slope dh/dx"})
    EXPECT_THAT(plot, HasSubstr(word));
  EXPECT_THAT(mli({"crinkled", "--height", folder / "h.png"}).err, HasSubstr("65535 is 0."));
}

TEST(MliCommand, RefusesWithOneMessage) {
  const TemporaryFolder folder;
  const std::string flat =
      folder.write("flat.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  const struct {
    std::vector<std::string> words;
    int code;
    const char* message;
  } cases[] = {
      {{"crinkld"}, 2, "did you mean 'crinkled'?"},
      {{"hull.wrl"}, 2, "sheets of foil are read from .pxn and .pan files, not '.wrl'"},
      {{"crinkled", "-o", folder / "a.gif"}, 2, "images are written as"},
      {{"crinkled", "--height", folder / "a.tif"}, 2, "heights are written as"},
      {{"crinkled", "--histogram", folder / "a.png"}, 2, "histograms are written as .svg"},
      {{"crinkled", "-o", folder / "a.png", "--height", folder / "a.png"}, 2, "[E0206]"},
      {{"crinkled", "--fit", "corelation=2cm"}, 2, "'corelation=2cm' is not valid"},
      {{"crinkled", "--fit", "slope_rms=0.1 slope_rms=0.2"}, 2, "each once"},
      {{"crinkled", "--fit", " "}, 2, "[E0201]"},
      {{"crinkled", "--fit", "slope_rms=-1"}, 1, "slope_rms is -1"},
      {{"crinkled", "--sheet", "1"}, 2, "a preset is one sheet"},
      {{"crinkled", "--seed", "1.5"}, 2, "--seed takes whole numbers"},
      {{kBlankets, "--sheet-width", "1"}, 2, "have their own sizes"},
      {{kBlankets, "--height", folder / "a.npy"}, 2, "the file has 5 sheets"},
      {{kBlankets, "--sheet", "tapd"}, 1, "did you mean 'taped'?"},
      {{kBlankets, "--sheet", "0"}, 1, "there are 5 sheets"},
      {{flat}, 1, "the file has no sheet of foil"},
      {{folder / "none.pxn"}, 3, "[E0101]"},
      {{"smooth", "--cells", "2"}, 1, "[E7001]"},
  };
  for (const auto& each : cases) {
    const Outcome done = mli(each.words);
    EXPECT_EQ(done.code, each.code) << each.words[0] << "\n" << done.err;
    EXPECT_THAT(done.err, HasSubstr(each.message));
    EXPECT_EQ(done.out, "") << each.message;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

}  // namespace
}  // namespace panwright::mli_test
