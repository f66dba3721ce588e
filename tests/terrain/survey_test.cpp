// Statistics and hillshades against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "terrain/survey.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::survey_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;

// A plane on a local map of 10 m posts: `east` and `down` metres a post.
Survey survey_of(std::uint32_t width, std::uint32_t height, double east, double down,
                 const SurveyOptions& options, std::string* said = nullptr, float replaced = 0,
                 std::size_t replacements = 0) {
  const TemporaryFolder folder;
  std::string data;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const bool replace = std::size_t{y} * width + x < replacements;
      data += bytes_of(replace ? replaced : static_cast<float>(east * x + down * y), false);
    }
  (void)folder.write("a.dat", data);
  const std::string path = folder.write(
      "a.hdr",
      "ENVI\nsamples = " + std::to_string(width) + "\nlines = " + std::to_string(height) +
          "\nbands = 1\ndata type = 4\nbyte order = 0\nmap info = {Local, 1, 1, 0, 0, 10, 10}\n");
  DiagnosticLog log;
  DemOptions reading;
  reading.unit = 1;
  const auto dem = Dem::open(path, reading, log);
  EXPECT_TRUE(dem) << to_text(log);
  if (!dem) return {};
  const auto out = survey(*dem, options, log);
  EXPECT_TRUE(out) << to_text(log);
  if (said != nullptr) *said = to_text(log);
  return out ? *out : Survey{};
}

TEST(Survey, Plane) {
  const Survey s = survey_of(100, 80, 1, 2, {});
  ASSERT_EQ(s.slopes.size(), 7u);
  for (const SlopeStatistics& each : s.slopes) {
    EXPECT_EQ(each.metres, 10.0 * each.posts);
    // tangents 0.1 along rows and 0.2 along columns
    const double across = double(100 - each.posts) * 80, along = double(80 - each.posts) * 100;
    EXPECT_EQ(each.pairs, static_cast<std::uint64_t>(across + along));
    const double rms = std::sqrt((0.01 * across + 0.04 * along) / (across + along));
    EXPECT_NEAR(each.rms, std::atan(rms) / kDegree, 1e-6);
    const double median = across > along ? 0.1 : 0.2;
    EXPECT_NEAR(each.median, std::atan(median) / kDegree, 0.01) << each.posts;
  }
  EXPECT_EQ(s.least.height, 0);
  EXPECT_EQ(s.largest.height, 99 + 2 * 79);
  EXPECT_EQ(s.largest.column, 99u);
  EXPECT_EQ(s.largest.row, 79u);
  EXPECT_NEAR(s.mean, 49.5 + 79, 1e-9);
  // variances of discrete uniform distributions: (n² − 1)/12
  EXPECT_NEAR(s.deviation, std::sqrt((1e4 - 1) / 12 + 4 * (6400.0 - 1) / 12), 1e-9);
}

TEST(Survey, Plateau) {
  std::string said;
  const Survey s = survey_of(64, 64, 1, 2, {}, &said, -50, 100);
  EXPECT_EQ(s.least.posts, 100u);
  EXPECT_NE(said.find("plateau"), std::string::npos) << said;
  survey_of(64, 64, 1, 2, {}, &said);
  EXPECT_EQ(said.find("plateau"), std::string::npos) << said;
}

TEST(Survey, VoidsOnly) {
  std::string said;
  const Survey s = survey_of(8, 8, 0, 0, {}, &said, NAN, 64);
  EXPECT_EQ(s.valid, 0u);
  EXPECT_EQ(s.void_posts(), 64u);
  EXPECT_NE(said.find("no height"), std::string::npos) << said;
}

TEST(Survey, OnePost) {
  const Survey s = survey_of(1, 1, 0, 0, {64}, nullptr, 7, 1);
  EXPECT_EQ(s.valid, 1u);
  EXPECT_EQ(s.least.height, 7);
  EXPECT_TRUE(s.slopes.empty());
  EXPECT_EQ(s.shade.size(), 3u);
}

// A plane that rises by its tangent towards the light: 255 times the cosine of its incidence.
TEST(Survey, HillshadeOfAPlane) {
  SurveyOptions options;
  options.hillshade = 32;
  options.sun_azimuth = 90;  // the light comes from the right
  options.sun_elevation = 30;
  const Survey s = survey_of(64, 64, -5, 0, options);
  ASSERT_EQ(s.shade_width, 32u);
  EXPECT_EQ(s.block, 2u);
  EXPECT_EQ(s.exaggeration, 1);
  // falls to the right by 0.5: the normal leans to the light
  const double slope = std::atan(0.5) / kDegree;
  const double expected = 255 * std::cos((60 - slope) * kDegree);
  EXPECT_NEAR(s.shade[3 * (16 * 32 + 16)], expected, 0.51);
}

}  // namespace
}  // namespace panwright::terrain::survey_test
