// The sky of views and scenarios by their date and orbit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scenario/dated_sky.h"
#include "sky/sky.h"
#include "sky/stars.h"
#include "workspace/frame.h"
#include "workspace/orbit_text.h"
#include "workspace/scenario.h"

namespace panwright::workspace::sky_by_date_test {
namespace {

using testing::HasSubstr;

Settings settings_of(std::initializer_list<std::pair<SettingId, std::string>> values) {
  Settings settings;
  DiagnosticLog log;
  for (const auto& [id, text] : values) EXPECT_TRUE(read_setting(id, text, settings, log)) << text;
  return settings;
}

Settings with_lens(Settings settings) {
  DiagnosticLog log;
  EXPECT_TRUE(read_setting(SettingId::fov, "30", settings, log));
  if (!settings.quat) EXPECT_TRUE(read_setting(SettingId::look_at, "-1 0.1 0", settings, log));
  return settings;
}

// Message of the first error; empty: there is a frame.
std::string problem_of(const Settings& settings) {
  const world::World world;
  DiagnosticLog log;
  View view;
  view.settings = with_lens(settings);
  const auto frame = FrameMaker(world).frame(view, log);
  return frame ? std::string() : log.entries().at(0).message;
}

Frame frame_of(const Settings& settings) {
  const world::World world;
  DiagnosticLog log;
  View view;
  view.settings = with_lens(settings);
  auto frame = FrameMaker(world).frame(view, log);
  EXPECT_TRUE(frame) << (log.entries().empty() ? "" : log.entries()[0].message);
  return frame ? *std::move(frame) : Frame();
}

constexpr const char* kDate = "2026-03-20T12:00:00";

TEST(OrbitText, ElementsStatesAndCentres) {
  scenario::Orbit orbit;
  EXPECT_EQ(read_orbit("a=8000km e=0.1 i=90deg raan=0 aop=0 nu=0", orbit), "");
  EXPECT_LT(glm::length(orbit.start.position - Vec3(7200e3, 0, 0)), 1e-6);
  EXPECT_NEAR(orbit.start.velocity.y, 0, 1e-9);
  EXPECT_NEAR(orbit.start.velocity.z, std::sqrt(scenario::kEarthGravity / 7.2e6 * 1.1), 1e-6);
  EXPECT_EQ(read_orbit("r=7000km 0 0 v=0 7.5km/s 100 axes=rtn epoch=2026-01-01T00:00:00", orbit),
            "");
  EXPECT_EQ(orbit.start.position, Vec3(7e6, 0, 0));
  EXPECT_EQ(orbit.start.velocity, Vec3(0, 7500, 100));
  EXPECT_EQ(orbit.axes, scenario::WorldAxes::rtn);
  EXPECT_TRUE(orbit.epoch);
  EXPECT_EQ(read_orbit("a=1838km about=moon", orbit), "");
  EXPECT_EQ(orbit.about, scenario::Centre::moon);
  EXPECT_EQ(read_orbit("moon", orbit), "");
  EXPECT_TRUE(orbit.at_centre);
}

TEST(OrbitText, RefusesWhatIsNoOrbit) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "semi-major axis"},
      {"mars", "semi-major axis"},
      {"a=6778", "outside the Earth, found one at 6.778 km"},
      {"a=400km", "outside the Earth"},
      {"a=6778 km", "a= with a length"},
      {"a=7000km e=1", "e= from 0"},
      {"a=7000km e=-0.1", "e= from 0"},
      {"a=7000km i=x", "i= with an angle"},
      {"a=7000km ran=3", "did you mean 'raan='"},
      {"a=7000km a=7000km", "a= once"},
      {"a=7000km r=1 2 3", "or a state"},
      {"i=3", "semi-major axis"},
      {"r=7000km 0 0", "v= with three speeds"},
      {"r=7000km 0 v=0 1 2", "r= with three lengths"},
      {"r=7000km 0 0 v=7km/s 0 0", "across the position"},
      {"r=7000km 0 0 v=0 7km/s 0 e=0", "beside a="},
      {"a=7000km about=mars", "about=earth"},
      {"a=7000km axes=lvlh", "axes=j2000 or axes=rtn"},
      {"a=7000km epoch=today", "epoch= with a date"},
      {"a=1e999km", "a= with a length"},
  };
  for (const auto& [text, message] : wrong) {
    scenario::Orbit orbit;
    EXPECT_THAT(read_orbit(text, orbit), HasSubstr(message)) << text;
  }
}

TEST(SkyByDate, BodiesStandAtTrueRange) {
  const Frame frame = frame_of(settings_of({{SettingId::date, kDate},
                                            {SettingId::orbit, "a=7000km i=51.6 nu=40"},
                                            {SettingId::sky, "stars,earth,moon,sun"},
                                            {SettingId::sun_irradiance, "158.6 186.2 191.4"}}));
  ASSERT_TRUE(frame.sky && frame.sun);
  ASSERT_EQ(frame.sky->bodies.size(), 2u);
  const light::Body& earth = frame.sky->bodies[0];
  const light::Body& moon = frame.sky->bodies[1];
  EXPECT_EQ(earth.name, "earth");
  EXPECT_NEAR(glm::length(earth.centre), 7e6, 1e-6);
  EXPECT_GT(glm::length(moon.centre - earth.centre), 356e6);
  EXPECT_LT(glm::length(moon.centre - earth.centre), 407e6);
  EXPECT_TRUE(moon.photometry.rolo);
  EXPECT_TRUE(frame.sky->sun_visible);
  EXPECT_EQ(frame.sky->stars.faintest, 8);
  EXPECT_NEAR(frame.sky->stars.year, 2026.216, 0.003);
  EXPECT_NEAR(glm::length(frame.sky->stars.velocity), 29.9e3, 8e3);
  // 14 days after the perihelion's quarter: 0.996 AU on 20 March
  EXPECT_NEAR(frame.sun->distance, 0.9960, 1e-3);
  ASSERT_TRUE(frame.sun->irradiance);
  EXPECT_NEAR(frame.sun->irradiance->x, 158.6 / (0.9960 * 0.9960), 0.3);
  EXPECT_GT(frame.sun->direction.x, 0.9999);
}

TEST(SkyByDate, WhatIsGivenWins) {
  const Frame frame = frame_of(settings_of({{SettingId::date, kDate},
                                            {SettingId::orbit, "a=7000km"},
                                            {SettingId::sky, "earth moon"},
                                            {SettingId::sun, "0 0 1"},
                                            {SettingId::sun_distance, "2"},
                                            {SettingId::sun_irradiance, "100"},
                                            {SettingId::planet, "moon=1e8 0 0"},
                                            {SettingId::planet, "earth=albedo=0.5"}}));
  ASSERT_EQ(frame.sky->bodies.size(), 2u);
  EXPECT_EQ(frame.sky->bodies[0].centre, Vec3(1e8, 0, 0));
  EXPECT_NEAR(glm::length(frame.sky->bodies[1].centre), 7e6, 1e-6);
  EXPECT_EQ(frame.sky->bodies[1].albedo, Vec3(0.5));
  EXPECT_EQ(frame.sun->direction, Vec3(0, 0, 1));
  EXPECT_EQ(frame.sun->distance, 2);
  EXPECT_EQ(frame.sun->irradiance->x, 25);
  // without an orbit the Sun of --sky is that of the Earth's centre
  const Frame sun = frame_of(settings_of(
      {{SettingId::date, kDate}, {SettingId::sky, "sun"}, {SettingId::sun_irradiance, "100"}}));
  EXPECT_GT(sun.sun->direction.x, 0.9999);
  EXPECT_NEAR(sun.sun->distance, 0.9960, 1e-3);
  EXPECT_EQ(sun.sun->irradiance->x, 100);
  // and the irradiance stays that at the target
  const Frame plain = frame_of(settings_of({{SettingId::date, kDate},
                                            {SettingId::sun_distance, "2"},
                                            {SettingId::sun_irradiance, "100"},
                                            {SettingId::stars, "5"}}));
  EXPECT_EQ(plain.sun->irradiance->x, 100);
}

// NASA: the Sun's total eclipse of 2024-04-08 is greatest at 18:17:21, above 25° 17.4′ N,
// 104° 08.3′ W; the path is 198 km wide.
TEST(SkyByDate, EclipsesAreWhereTheyWere) {
  std::string problem;
  const auto date =
      scenario::parse_epoch("2024-04-08T18:17:21", scenario::TimeSystem::utc, problem);
  scenario::Orbit centre;
  centre.at_centre = true;
  const auto at_centre = scenario::dated_sky(centre, *date);
  ASSERT_TRUE(at_centre);
  const auto share_at = [&](double latitude, double longitude) {
    const double f = latitude * kDegree, l = longitude * kDegree, squash = 6356752.3 / 6378137;
    // geodetic, a kilometre above the ellipsoid
    const double n = 6378137 / std::sqrt(std::cos(f) * std::cos(f) +
                                         squash * squash * std::sin(f) * std::sin(f));
    const Vec3 place((n + 1000) * std::cos(f) * std::cos(l), (n + 1000) * std::cos(f) * std::sin(l),
                     (squash * squash * n + 1000) * std::sin(f));
    const Vec3 r = at_centre->earth.world_from_body * place;
    const Frame frame = frame_of(
        settings_of({{SettingId::date, "2024-04-08T18:17:21"},
                     {SettingId::sky, "moon,earth,sun"},
                     {SettingId::orbit, "r=" + std::to_string(r.x) + " " + std::to_string(r.y) +
                                            " " + std::to_string(r.z) + " v=0 0 1000"}}));
    const world::World empty;
    world::World shown = empty;
    show(frame, empty, shown);
    return sky::Sky(shown).sun_share({0, 0, 0});
  };
  EXPECT_EQ(share_at(25.29, -104.138), 0);
  EXPECT_GT(share_at(27.29, -104.138), 0) << "200 km north";
  EXPECT_LT(share_at(27.29, -104.138), 0.1);
  EXPECT_EQ(share_at(-40, -104.138), 1);
}

// Aberration on by date: κ = 20.5″, towards the Earth's motion.
TEST(SkyByDate, StarsHaveAberrationByDate) {
  const Frame frame =
      frame_of(settings_of({{SettingId::date, "2020-03-20T00:00:00"}, {SettingId::stars, "5"}}));
  // astropy 5.2: ICRS (270°, 66.5°) to the GCRS of that date
  const Vec3 expected(-2.46395412e-06, -3.98840568e-01, 9.17020284e-01);
  light::Star star;
  star.direction = Vec3(0, -std::cos(66.5 * kDegree), std::sin(66.5 * kDegree));
  const Vec3 moved = sky::apparent_direction(star, 0, frame.sky->stars.velocity);
  EXPECT_LT(glm::length(moved - expected), 0.05 * kDegree / 3600);
  EXPECT_NEAR(glm::length(moved - star.direction) / (kDegree / 3600), 20.6, 0.5);
  const Frame without = frame_of(settings_of({{SettingId::stars, "5"}}));
  EXPECT_EQ(without.sky->stars.velocity, Vec3(0));
}

TEST(SkyByDate, SaysWhatIsMissing) {
  EXPECT_THAT(problem_of(settings_of({{SettingId::sky, "earth"}})),
              HasSubstr("place of the earth is not known"));
  EXPECT_THAT(problem_of(settings_of({{SettingId::planet, "moon=map=a.png"}})),
              HasSubstr("place of the moon is not known"));
  EXPECT_THAT(problem_of(settings_of({{SettingId::sky, "sun"}, {SettingId::orbit, "a=7000km"}})),
              HasSubstr("--orbit needs a date"));
  EXPECT_THAT(problem_of(settings_of({{SettingId::sky, "erth"}})),
              HasSubstr("did you mean 'earth'"));
  EXPECT_THAT(problem_of(settings_of({{SettingId::planet, "earht=0 0 7000km"}})),
              HasSubstr("did you mean 'earth'"));
  EXPECT_THAT(problem_of(settings_of(
                  {{SettingId::planet, "moon=1e8 0 0"}, {SettingId::planet, "moon=2e8 0 0"}})),
              HasSubstr("each body once"));
  EXPECT_THAT(problem_of(settings_of({{SettingId::sky, "earth"},
                                      {SettingId::orbit, "a=7000km"},
                                      {SettingId::date, "2060-01-01T00:00:00"}})),
              HasSubstr("from 1972 to 2050"));
  EXPECT_THAT(
      problem_of(settings_of({{SettingId::sky, "sun"}, {SettingId::star_catalogue, "a.csv"}})),
      HasSubstr("requires --stars V or --sky stars"));
  const world::World world;
  DiagnosticLog log;
  FrameMaker maker(world);
  View view;
  view.settings = with_lens(settings_of({{SettingId::stars, "11"}}));
  EXPECT_TRUE(maker.frame(view, log));
  EXPECT_TRUE(maker.frame(view, log));
  ASSERT_EQ(log.entries().size(), 1u) << "once";
  EXPECT_EQ(log.entries()[0].code, Code("W5041"));
}

class ScenarioByDate : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("panwright_sky_by_date_") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The frame of a time; an empty one where the message is reported.
  Frame at(const std::string& text, double time, const std::string& message = {}) {
    std::ofstream(folder_ / "a.toml") << text;
    DiagnosticLog log;
    const auto opened = open_scenario(folder_ / "a.toml", {}, log);
    const world::World world;
    Frame out;
    if (opened) {
      const auto frame = frame_at(*opened, time, log);
      const auto view = frame ? view_of(*opened, *frame, 0, world, log) : Result<View>(failed);
      auto made = view ? FrameMaker(world).frame(*view, log) : Result<Frame>(failed);
      if (made) out = *std::move(made);
    }
    const std::string found = log.entries().empty() ? "" : log.entries()[0].message;
    if (message.empty())
      EXPECT_EQ(log.errors(), 0u) << found;
    else
      EXPECT_THAT(found, HasSubstr(message));
    return out;
  }
  std::filesystem::path folder_;
};

constexpr const char* kView = "[view]\nfov = 30\nquat = [1, 0, 0, 0]\nsky = \"earth,moon,sun\"\n";
constexpr const char* kFixed = "[[source]]\nformula = \"fixed\"\nposition = [0, 0, 0]\n";

TEST_F(ScenarioByDate, ADatePerFrame) {
  const std::string head = "epoch = \"2026-03-20T12:00:00 UTC\"\n";
  const std::string text = head + kFixed + kView + "orbit = \"a=7000km i=90\"\n";
  const double quarter = kPi / 2 * std::sqrt(343e18 / scenario::kEarthGravity);
  const Frame begin = at(text, 0), later = at(text, quarter);
  EXPECT_LT(glm::length(begin.sky->bodies[0].centre - Vec3(-7e6, 0, 0)), 1e-3);
  EXPECT_LT(glm::length(later.sky->bodies[0].centre - Vec3(0, 0, -7e6)), 1e-2);
  // the Earth turns by 15.04° an hour
  const Quat turn =
      later.sky->bodies[0].world_from_body * glm::conjugate(begin.sky->bodies[0].world_from_body);
  EXPECT_NEAR(2 * std::acos(std::abs(turn.w)) / kDegree, 15.0411 * quarter / 3600, 1e-3);
  EXPECT_NE(later.sky->bodies[1].centre, begin.sky->bodies[1].centre);
  EXPECT_GT(begin.sun->direction.x, 0.999);
  // the date of the view is that of time 0 as well
  const std::string by_view =
      kFixed + std::string(kView) + "orbit = \"a=7000km i=90\"\ndate = \"2026-03-20T12:00:00\"\n";
  EXPECT_LT(glm::length(at(by_view, quarter).sky->bodies[0].centre - later.sky->bodies[0].centre),
            1e-3);
}

TEST_F(ScenarioByDate, SourcesAboutTheEarthNeedNoOrbit) {
  const std::string two_body =
      "epoch = \"2026-03-20T12:00:00 UTC\"\n[[source]]\nformula = \"two_body\"\n"
      "position = [7e6, 0, 0]\nvelocity = [0, 7500, 0]\n" +
      std::string(kView);
  const Frame frame = at(two_body, 0);
  EXPECT_EQ(frame.sky->bodies[0].centre, Vec3(0));
  EXPECT_EQ(frame.camera().position, Vec3(7e6, 0, 0));
  at(two_body + "orbit = \"a=7000km\"\n", 0, "origin in 'EARTH', and orbit gives it another place");
  at(two_body + "orbit = \"moon\"\n", 0, "origin in 'EARTH'");
  EXPECT_EQ(at(two_body + "orbit = \"earth\"\n", 0).sky->bodies[0].centre, Vec3(0));
}

TEST_F(ScenarioByDate, RelativeOrbitsHaveTheAxesOfTheirOrbit) {
  const std::string relative =
      "epoch = \"2026-03-20T12:00:00 UTC\"\n[[source]]\nformula = \"clohessy_wiltshire\"\n"
      "position = [0, -200, 0]\nrate = 1.08e-3\n" +
      std::string(kView);
  const Frame frame = at(relative + "orbit = \"a=7000km i=50 raan=20\"\n", 1000);
  EXPECT_LT(glm::length(frame.sky->bodies[0].centre - Vec3(-7e6, 0, 0)), 1e-2);
  at(relative + "orbit = \"a=7000km axes=j2000\"\n", 0, "axes that turn with its orbit");
  at(relative, 0, "needs the orbit whose axes");
  at(relative + "sun = [1, 0, 0]\n", 0, "place of the earth is not known");
}

TEST_F(ScenarioByDate, StarsWithoutTheOrbitOfTheirAxesAreAWarning) {
  const auto codes = [&](const std::string& formula, const std::string& view) {
    std::ofstream(folder_ / "a.toml")
        << "epoch = \"2026-03-20T12:00:00 UTC\"\n[[source]]\nformula = \"" << formula
        << "\"\nposition = [0, -200, 0]\n"
        << (formula == "fixed" ? "" : "rate = 1.08e-3\n") << "[view]\nfov = 30\n"
        << view;
    DiagnosticLog log;
    const auto opened = open_scenario(folder_ / "a.toml", {}, log);
    EXPECT_TRUE(opened) << to_text(log);
    if (opened) check_stars(*opened, log);
    return to_text(log);
  };
  EXPECT_THAT(codes("clohessy_wiltshire", "stars = 6\n"), HasSubstr("W8019"));
  EXPECT_THAT(codes("clohessy_wiltshire", "sky = \"stars\"\n"), HasSubstr("W8019"));
  EXPECT_EQ(codes("clohessy_wiltshire", "stars = 6\norbit = \"a=7000km\"\n"), "");
  EXPECT_EQ(codes("clohessy_wiltshire", ""), "");
  EXPECT_EQ(codes("fixed", "stars = 6\n"), "");
}

TEST_F(ScenarioByDate, FilesAreThoseOfTheScenariosFolder) {
  std::ofstream(folder_ / "red.ppm") << "P3 2 1 255 200 0 0 100 0 0\n";
  std::ofstream(folder_ / "own.csv") << "ra[deg],dec[deg],v[mag]\n1,2,3\n";
  const Frame frame = at(kFixed + std::string(kView) +
                             "orbit = \"a=7000km\"\ndate = \"2026-03-20T12:00:00\"\nstars = 5\n"
                             "star_catalogue = \"own.csv\"\nplanet = {earth = \"map=red.ppm\"}\n",
                         0);
  EXPECT_NE(frame.sky->bodies[0].map, nullptr);
  const Frame cloudy = at(kFixed + std::string(kView) +
                              "orbit = \"a=7000km\"\ndate = \"2026-03-20T12:00:00\"\n"
                              "planet = {earth = \"clouds=red.ppm night=red.ppm\"}\n",
                          0);
  EXPECT_NE(cloudy.sky->bodies[0].map, nullptr);
  EXPECT_NE(cloudy.sky->bodies[0].night, nullptr);
  EXPECT_EQ(frame.sky->stars.catalogue->stars.size(), 1u);
}

// Apparent places from the Earth's centre: astropy 5.2 (ERFA), SkyCoord.apply_space_motion() from
// J1991.25 of the rows of Hipparcos, then to GCRS, with the light's deflection by the Sun and
// without parallax. Degrees.
struct Apparent {
  std::uint32_t hip;
  double ra, dec;
};
struct NightSky {
  const char* date;
  std::vector<Apparent> stars;
};
// motions: Groombridge 1830 7.1 arcsec a year, Lacaille 9352 6.9, 61 Cygni 5.3, 40 Eridani 4.1,
// alpha Centauri 3.7, Arcturus 2.3, Sirius 1.3; at the poles Polaris and sigma Octantis
const NightSky kNightSkies[] = {
    {"1991-04-02T13:30:00",
     {{57939, 178.238992109, 37.731841958},
      {114046, 346.440708037, -35.856750186},
      {104214, 316.708029877, 38.737052383},
      {19849, 63.820191005, -7.647302884},
      {71683, 219.929954608, -60.834118219},
      {32349, 101.288428621, -16.716775693},
      {11767, 37.576597116, 89.266349239},
      {60718, 186.661281500, -63.100533409},
      {27989, 88.791622494, 7.405492170},
      {104382, 317.028440698, -88.952240141},
      {69673, 213.923279501, 19.184544172}}},
    {"2004-01-05T00:00:00",
     {{57939, 178.252331961, 37.708357227},
      {114046, 346.472964766, -35.855062601},
      {104214, 316.724572394, 38.754626105},
      {19849, 63.820001233, -7.657709673},
      {71683, 219.888273965, -60.829230643},
      {32349, 101.292530502, -16.718050540},
      {11767, 38.150420812, 89.269295885},
      {60718, 186.650836628, -63.094252406},
      {27989, 88.798603561, 7.406706217},
      {104382, 316.935156578, -88.959747186},
      {69673, 213.911812735, 19.177897644}}},
    {"2026-07-03T18:00:00",
     {{57939, 178.280612931, 37.679556712},
      {114046, 346.531063101, -35.839935241},
      {104214, 316.769774377, 38.771670834},
      {19849, 63.796847634, -7.677166239},
      {71683, 219.852124652, -60.834441775},
      {32349, 101.277130310, -16.724723043},
      {11767, 37.780559994, 89.259073443},
      {60718, 186.648163498, -63.103967523},
      {27989, 88.787626088, 7.407428728},
      {104382, 317.450582314, -88.953108142},
      {69673, 213.909127061, 19.169789079}}},
    {"2045-10-20T06:30:00",
     {{57939, 178.303419509, 37.644595067},
      {114046, 346.577819381, -35.836635541},
      {104214, 316.794611734, 38.795619846},
      {19849, 63.793718195, -7.693981184},
      {71683, 219.795267893, -60.827638570},
      {32349, 101.281662779, -16.728287131},
      {11767, 38.409734256, 89.263192075},
      {60718, 186.637693685, -63.096504188},
      {27989, 88.796056303, 7.408606006},
      {104382, 317.302287868, -88.961494632},
      {69673, 213.894930476, 19.159008844}}},
};

// Within 0.1 arcsec, by proper motion and aberration of a date.
TEST(SkyByDate, StarsStandWhereAnIndependentReductionHasThem) {
  double worst = 0;
  for (const NightSky& night : kNightSkies) {
    const Frame frame =
        frame_of(settings_of({{SettingId::date, night.date}, {SettingId::stars, "8"}}));
    ASSERT_TRUE(frame.sky);
    const light::Stars& stars = frame.sky->stars;
    std::size_t found = 0;
    for (const Apparent& want : night.stars)
      for (const light::Star& star : stars.catalogue->stars) {
        if (star.hip != want.hip) continue;
        const Vec3 at =
            sky::apparent_direction(star, stars.year - stars.catalogue->epoch, stars.velocity);
        const double ra = want.ra * kDegree, dec = want.dec * kDegree;
        const Vec3 there(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
        const double off = glm::length(at - there) / kDegree * 3600;
        worst = std::max(worst, off);
        EXPECT_LT(off, 0.1) << night.date << ' ' << star.hip;
        ++found;
      }
    EXPECT_EQ(found, night.stars.size()) << night.date;
  }
  printf("stars: at most %.3f arcsec\n", worst);
}

}  // namespace
}  // namespace panwright::workspace::sky_by_date_test
