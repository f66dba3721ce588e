#include "sky/star_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace panwright::sky::star_catalogue_test {
namespace {

Vec3 direction(double ra_degrees, double dec_degrees) {
  const double ra = ra_degrees * kDegree, dec = dec_degrees * kDegree;
  return {std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec)};
}

const Star& star_of(std::uint32_t hip) {
  const auto& stars = hipparcos_stars()->stars;
  const auto found = std::ranges::find(stars, hip, &Star::hip);
  EXPECT_NE(found, stars.end());
  return *found;
}

TEST(HipparcosStars, AreAllThere) {
  const StarCatalogue& catalogue = *hipparcos_stars();
  EXPECT_EQ(catalogue.stars.size(), 41057u);
  EXPECT_EQ(catalogue.epoch, 1991.25);
  EXPECT_TRUE(std::ranges::is_sorted(catalogue.stars, {}, &Star::v));
  EXPECT_EQ(catalogue.stars.front().name, "Sirius");
  for (const Star& star : catalogue.stars) {
    ASSERT_NEAR(glm::length(star.direction), 1, 1e-15) << star.hip;
    ASSERT_NEAR(glm::dot(star.direction, star.motion), 0, 1e-19) << star.hip;
  }
}

// Positions at J2000 as SIMBAD gives them, of stars that move by up to 33 arcsec in between.
TEST(HipparcosStars, MoveToTheirPlacesInTheYear2000) {
  struct Known {
    std::uint32_t hip;
    double ra, dec;  // degrees
  };
  constexpr double kArcsec = kDegree / 3600;
  for (const Known& known : {Known{32349, 101.28715533, -16.71611586},   // Sirius
                             Known{91262, 279.23473479, 38.78368896},    // Vega
                             Known{69673, 213.91530029, 19.18240916},    // Arcturus
                             Known{71683, 219.90205833, -60.83399269},   // alpha Centauri A
                             Known{104214, 316.72474829, 38.74941732},   // 61 Cygni A
                             Known{11767, 37.95456067, 89.26410897}}) {  // Polaris
    const Star& star = star_of(known.hip);
    const Vec3 moved = glm::normalize(star.direction + 8.75 * star.motion);
    EXPECT_LT(angle_between(moved, direction(known.ra, known.dec)), 0.1 * kArcsec) << known.hip;
  }
}

TEST(ParseStars, ReadsColumnsInAnyOrder) {
  DiagnosticLog log;
  const auto stars = parse_stars(
      "\xef\xbb\xbf# epoch 2016\r\n# mine\r\nv[mag],name,dec[deg],other,ra[deg],hip\r\n"
      "6.5, faint ,0,x,0,7\r\n-1,,90,,180,\r\n",
      "mine.csv", log);
  ASSERT_TRUE(stars);
  EXPECT_TRUE(log.entries().empty());
  EXPECT_EQ(stars->epoch, 2016);
  ASSERT_EQ(stars->stars.size(), 2u);
  EXPECT_EQ(stars->stars[0].v, -1);
  EXPECT_TRUE(std::isnan(stars->stars[0].b_v));
  EXPECT_NEAR(stars->stars[0].direction.z, 1, 1e-15);
  EXPECT_EQ(stars->stars[1].name, "faint");
  EXPECT_EQ(stars->stars[1].hip, 7u);
  EXPECT_EQ(stars->stars[1].direction, Vec3(1, 0, 0));
  EXPECT_EQ(stars->stars[1].motion, Vec3(0));
}

TEST(ParseStars, NamesBrokenLinesAndKeepsTheOthers) {
  DiagnosticLog log;
  std::string text = "ra[deg],dec[deg],v[mag],b_v[mag],pm_ra[mas/yr]\n10,20,3,,\n";
  text += "x,20,3,,\n10,91,3,,\n10,20,,,\n10,20,3,99,\n10,20,3,,1e9\n10\n10,nan,3\n";
  const auto stars = parse_stars(text, "broken.csv", log);
  ASSERT_TRUE(stars);
  EXPECT_EQ(stars->stars.size(), 1u);
  ASSERT_EQ(log.entries().size(), 7u);
  for (std::uint32_t i = 0; i < 7; ++i) {
    EXPECT_EQ(log.entries()[i].code, Code("W5041"));
    EXPECT_EQ(log.sources().position(0, log.entries()[i].where.begin).line, 3 + i);
  }
}

TEST(ParseStars, ReportsTenBrokenLinesAndTheNumberOfTheOthers) {
  DiagnosticLog log;
  std::string text = "ra[deg],dec[deg],v[mag]\n1,2,3\n";
  for (int i = 0; i < 1000; ++i) text += "no star\n";
  ASSERT_TRUE(parse_stars(text, "broken.csv", log));
  ASSERT_EQ(log.entries().size(), 11u);
  EXPECT_THAT(log.entries().back().message, testing::HasSubstr("990 lines more"));
}

TEST(ParseStars, RefusesWhatIsNoCatalogue) {
  for (const char* text :
       {"", "# epoch 2000\n", "ra[deg],dec[deg],v[mag]\n", "ra,dec,v\n1,2,3\n",
        "ra[deg],v[mag]\n1,2\n", "# epoch soon\nra[deg],dec[deg],v[mag]\n1,2,3\n",
        "# epoch 1e9\nra[deg],dec[deg],v[mag]\n1,2,3\n", "\x01\x02\x03",
        "ra[deg],dec[deg],v[mag]\nx"}) {
    DiagnosticLog log;
    EXPECT_FALSE(parse_stars(text, "no.csv", log)) << text;
    EXPECT_TRUE(log.has_errors()) << text;
  }
}

}  // namespace
}  // namespace panwright::sky::star_catalogue_test
