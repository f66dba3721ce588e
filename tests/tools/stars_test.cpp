// Stars in images and in the list of `panwright stars`.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/oracles.h"
#include "tests/support/process.h"

namespace panwright::stars_test {
namespace {

using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

constexpr double kDegree = 3.14159265358979323846 / 180;

nlohmann::json listed(std::vector<std::string> words) {
  words.insert(words.begin(), "stars");
  words.push_back("--json");
  const Outcome done = panwright(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return nlohmann::json::parse(done.out)["stars"];
}

// Betelgeuse, 88.79 degrees east and 7.41 north: a camera that looks there with the north up has it
// in its middle, and Bellatrix, 7.5 degrees west of it, on the right.
TEST(Stars, AreListedFromTheBrightest) {
  const auto at = [](double ra, double dec) {
    return fmt::format("{} {} {}", std::cos(dec * kDegree) * std::cos(ra * kDegree),
                       std::cos(dec * kDegree) * std::sin(ra * kDegree), std::sin(dec * kDegree));
  };
  const auto stars = listed(
      {"--look-at", at(88.7929, 7.4071), "--fov", "20", "--size", "400x400", "--stars", "3"});
  ASSERT_GE(stars.size(), 2u);
  EXPECT_EQ(stars[0]["name"], "Betelgeuse");
  EXPECT_EQ(stars[0]["hip"], 27989);
  for (int axis = 0; axis < 2; ++axis)
    EXPECT_NEAR(stars[0]["pixel"][axis].get<double>(), 200, 0.05);
  EXPECT_EQ(stars[1]["name"], "Bellatrix");
  EXPECT_GT(stars[1]["pixel"][0].get<double>(), 300);
  for (const auto& star : stars) EXPECT_LE(star["v"].get<double>(), 3);
}

// The image of a sky alone has the flux of the list, in the pixels of the list.
TEST(Stars, OfAnImageAreThoseOfTheList) {
  const TemporaryFolder folder;
  for (const std::string engine : {"gl", "reference"}) {
    const std::string file = folder / (engine + ".npy");
    std::vector<std::string> view = {"--look-at", "0.1 1 0", "--fov",   "10",
                                     "--size",    "200x150", "--stars", "6"};
    std::vector<std::string> render = view;
    render.insert(render.begin(), "render");
    for (const std::string& word :
         {std::string("--psf"), std::string("0.7"), std::string("--engine"), engine,
          std::string("--sun-irradiance"), std::string("1"), std::string("-o"), file})
      render.push_back(word);
    const Outcome done = panwright(render);
    ASSERT_EQ(done.code, 0) << done.err;
    const auto image = oracles::read_npy(file);
    ASSERT_TRUE(image);
    double flux = 0, expected = 0;
    const double focal = 100 / std::tan(5 * kDegree);
    for (std::size_t row = 0; row < 150; ++row)
      for (std::size_t column = 0; column < 200; ++column) {
        const double x = (static_cast<double>(column) + 0.5 - 100) / focal;
        const double y = (static_cast<double>(row) + 0.5 - 75) / focal;
        flux += image->rgb[3 * (row * 200 + column) + 1] / (focal * focal) /
                std::pow(1 + x * x + y * y, 1.5);
      }
    std::size_t inside = 0;
    for (const auto& star : listed(view)) {
      const double column = star["pixel"][0], row = star["pixel"][1];
      if (column > 5 && column < 195 && row > 5 && row < 145) ++inside;
      expected += star["irradiance"][1].get<double>();
    }
    EXPECT_GT(inside, 10u);
    // stars at the border lose a part
    EXPECT_NEAR(flux / expected, 1, 0.03) << engine;
  }
}

TEST(Stars, OfOnesOwnCatalogueMoveToTheDate) {
  const TemporaryFolder folder;
  const std::string file = folder.write(
      "own.csv", "# epoch 2000\nra[deg],dec[deg],pm_ra[mas/yr],v[mag],name\n0,0,36000,5,runner\n");
  std::vector<std::string> words = {"--star-catalogue", file,     "--stars", "6",
                                    "--look-at",        "1 0 0",  "--ifov",  "60arcsec",
                                    "--size",           "100x100"};
  EXPECT_NEAR(listed(words)[0]["pixel"][0].get<double>(), 50, 1e-6);
  // 25 years and 18 hours at 36 arcsec a year, to the east, which is to the left; 3.57 arcsec of
  // aberration to the right: together by astropy 5.2
  words.insert(words.end(), {"--date", "2025-01-01T12:00:00"});
  EXPECT_NEAR(listed(words)[0]["pixel"][0].get<double>(), 35.0581093, 5e-4);
}

TEST(Stars, NeedALens) {
  const Outcome done = panwright({"stars", "--look-at", "1 0 0"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("--fov"));
}

TEST(Stars, NeedADirection) {
  const Outcome done = panwright({"stars", "--fov", "10"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("--quat"));
}

// A camera that turns by 5 pixels in the exposure, and sees stars alone: they streak.
TEST(Stars, StreakAsTheCameraTurns) {
  const TemporaryFolder folder;
  const std::string scenario = folder.write(
      "turn.toml",
      "begin = 0\nend = 2\nstep = 1\n[[source]]\nformula = \"spin\"\nrate_deg_s = [0, 0.5, 0]\n"
      "[view]\nsize = [200, 200]\nfov = 20\nstars = 6\npsf = 0.8\n");
  double peaks[2];
  for (const bool exposed : {false, true}) {
    const std::string out = folder / (exposed ? "streaks" : "dots");
    std::vector<std::string> words = {"run", scenario, "-o", out, "--at", "1", "--type", "npy"};
    if (exposed) words.insert(words.end(), {"--exposure", "1"});
    const Outcome done = panwright(words);
    ASSERT_EQ(done.code, 0) << done.err;
    const auto image = oracles::read_npy(out + "/000000.npy");
    ASSERT_TRUE(image);
    peaks[exposed] = *std::ranges::max_element(image->rgb);
  }
  EXPECT_GT(peaks[1], 0);
  EXPECT_LT(peaks[1], 0.6 * peaks[0]);
}

TEST(Stars, WithoutThemAnImageNeedsATarget) {
  const Outcome done = panwright({"render", "--fov", "10"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("no model is given"));
}

}  // namespace
}  // namespace panwright::stars_test
