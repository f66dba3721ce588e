// Skies by date on the command line, and what is found before a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/oracles.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::sky_by_date_program_test {
namespace {

using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(SkyByDateProgram, ListsStarsBesideTheEarth) {
  // from GEO the Earth has a radius of 8.7 degrees
  const auto stars = [](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"stars",   "--json", "--date", "2026-03-20T12:00:00",
                                      "--fov",   "16",     "--size", "100x100",
                                      "--stars", "6"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome done = panwright(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return nlohmann::json::parse(done.out)["stars"].size();
  };
  const std::vector<std::string> orbit = {"--orbit", "a=42164km nu=30 axes=rtn", "--look-at",
                                          "-1 0 0"};
  std::vector<std::string> behind = orbit;
  behind.insert(behind.end(), {"--sky", "stars,earth"});
  EXPECT_GT(stars(orbit), 10u);
  EXPECT_LE(stars(behind), stars(orbit) / 3) << "in the corners alone";
}

TEST(SkyByDateProgram, DrawsTheEarthHalfLit) {
  const TemporaryFolder folder;
  const std::string image = folder / "earth.npy";
  // the Sun stands at longitude 0 on the equator of J2000, 90 degrees from the radius
  const Outcome done = panwright({"render",
                                  "-o",
                                  image,
                                  "--size",
                                  "64x64",
                                  "--fov",
                                  "24",
                                  "--look-at",
                                  "-1 0 0",
                                  "--up",
                                  "0 0 1",
                                  "--date",
                                  "2026-03-20T14:46:00",
                                  "--sky",
                                  "earth",
                                  "--orbit",
                                  "a=42164km nu=90 axes=rtn",
                                  "--planet",
                                  "moon=1e8 0 0",
                                  "--planet",
                                  "rock=1e7 1e7 0 radius=1"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto read = oracles::read_npy(image);
  ASSERT_TRUE(read);
  double left = 0, right = 0;
  for (std::size_t row = 0; row < 64; ++row)
    for (std::size_t column = 0; column < 64; ++column)
      (column < 32 ? left : right) += read->rgb[3 * (64 * row + column)];
  // +x of J2000 is -y of the orbit's axes here: on the right of an image towards -x with z up
  EXPECT_GT(std::max(left, right), 1);
  EXPECT_LT(std::min(left, right), 0.01 * std::max(left, right));
}

const char* const kHead = "begin = 0\nend = 3\nstep = 1\n";
const char* const kSources =
    "[[source]]\nformula = \"fixed\"\nposition = [0, 0, 0]\nquat = [1, 0, 0, 0]\n";

TEST(SkyByDateProgram, ABadMapIsFoundOnceAndBeforeTheFolder) {
  const TemporaryFolder folder;
  const std::string scenario = folder.write(
      "a.toml", std::string(kHead) + kSources +
                    "[view]\nsize = [32, 32]\nfov = 30\nplanet = {earth = \"0 0 7000km "
                    "map=none.png\"}\n");
  const Outcome done = panwright({"run", scenario, "-o", folder / "out"});
  EXPECT_NE(done.code, 0);
  EXPECT_EQ(count_of(done.err, "E0101"), 1u) << done.err;
  EXPECT_THAT(done.err, HasSubstr(folder / "none.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(SkyByDateProgram, LinesOfCataloguesAreShown) {
  const TemporaryFolder folder;
  const std::string catalogue =
      folder.write("c.csv", "ra[deg],dec[deg],v[mag],name\n0,0,1,a\n0,91,1,b\n0,1\n");
  const Outcome done = panwright({"stars", "--look-at", "1 0 0", "--fov", "20", "--stars", "5",
                                  "--star-catalogue", catalogue});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, HasSubstr("c.csv:3:3: warning: expected dec[deg] from -90 to 90"));
  EXPECT_THAT(done.err, HasSubstr("c.csv:4:1: warning: expected 4 columns"));
}

TEST(SkyByDateProgram, FormatsAreCheckedBeforeARun) {
  const TemporaryFolder folder;
  folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  const auto run = [&](const std::string& labels, std::vector<std::string> more) {
    const std::string scenario = folder.write(
        "a.toml", std::string(kHead) +
                      "[targets]\nbox = \"box.pxn\"\n[[source]]\nformula = \"spin\"\n"
                      "target = \"box\"\nrate_deg_s = [0, 3, 0]\n[[source]]\nformula = \"fixed\"\n"
                      "position = [0, -5, 0]\n[view]\nsize = [24, 16]\nlook_at = [0, 0, 0]\n"
                      "samples = 1\n[labels]\n" +
                      labels);
    std::filesystem::remove_all(folder / "out");
    std::vector<std::string> words = {"run", scenario, "-o", folder / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return panwright(words);
  };
  const std::tuple<const char*, std::vector<std::string>, const char*> refused[] = {
      {"formats = \"bop\"\n", {}, "'bop' has depth, which this run does not write"},
      {"formats = \"bop\"\n", {"--type", "npz"}, "'bop' has PNG images"},
      {"formats = \"yolo\"\n", {"--type", "exr"}, "'yolo' has PNG images"},
      {"formats = \"kitti\"\n", {}, "'kitti' has flow"},
  };
  for (const auto& [labels, more, message] : refused) {
    const Outcome done = run(labels, more);
    EXPECT_NE(done.code, 0) << labels;
    EXPECT_THAT(done.err, HasSubstr("E9003"));
    EXPECT_THAT(done.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder / "out")) << labels;
  }
  // the last frame of a run has no flow, and is no loss
  const Outcome kitti = run("formats = \"kitti\"\nflow = true\n", {});
  EXPECT_EQ(kitti.code, 0) << kitti.err;
  EXPECT_THAT(kitti.err, Not(HasSubstr("W9002")));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/kitti/image_2/000002_11.png"));
}

TEST(SkyByDateProgram, InfoShowsKernels) {
  const std::string kernel = PANWRIGHT_SOURCE_DIR "/examples/ephemerides/client.xsp";
  const Outcome done = panwright({"info", kernel});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("SPK type 13 -99001 relative to EARTH (399) in J2000, "
                                  "2026-03-20T12:00:00 to 2026-03-20T13:40:00 TDB"));
  const TemporaryFolder folder;
  const std::string text = folder.write(
      "a.tpc", "KPL/PCK\n\\begindata\nBODY399_RADII = ( 6378 6378 6357 )\nBODY399_PM = ( 1 2 )\n");
  const Outcome variables = panwright({"info", text, "--json"});
  EXPECT_EQ(variables.code, 0) << variables.err;
  EXPECT_EQ(nlohmann::json::parse(variables.out)["variables"],
            nlohmann::json::parse("[\"BODY399_PM\", \"BODY399_RADII\"]"));
  const Outcome cut = panwright({"info", folder.write("cut.bsp", "DAF/SPK ")});
  EXPECT_NE(cut.code, 0);
  EXPECT_THAT(cut.err, HasSubstr("E8015"));
}

}  // namespace
}  // namespace panwright::sky_by_date_program_test
