// Bodies of the sky from texts, and what is wrong with them.
#include "workspace/sky_settings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "workspace/frame.h"

namespace panwright::workspace::sky_settings_test {
namespace {

std::string first_error(const DiagnosticLog& log) {
  return log.entries().empty() ? std::string() : log.entries()[0].message;
}

Settings with(const std::string& planet) {
  Settings settings;
  DiagnosticLog log;
  EXPECT_TRUE(read_setting(SettingId::planet, planet, settings, log));
  return settings;
}

std::shared_ptr<const SkyState> sky_of(const Settings& settings) {
  DiagnosticLog log;
  EXPECT_TRUE(check_sky(settings, log)) << first_error(log);
  auto sky = SkyReader().read(settings, {}, log);
  EXPECT_TRUE(sky);
  return sky ? *sky : nullptr;
}

TEST(SkySettings, BodiesByText) {
  const auto earth = sky_of(with("earth=0 0 -6778km"));
  ASSERT_EQ(earth->bodies.size(), 1u);
  EXPECT_EQ(earth->bodies[0].centre, Vec3(0, 0, -6778e3));
  EXPECT_EQ(earth->bodies[0].radii.x, 6378137);
  EXPECT_FALSE(earth->sun_visible);
  const auto rock =
      sky_of(with("rock=1 2 3, 0 0 0 1, radius=2km 1km 900m albedo=0.05 law=hapke 0.3 -0.2 1 0.1"));
  const light::Body& body = rock->bodies[0];
  EXPECT_EQ(body.radii, Vec3(2000, 1000, 900));
  EXPECT_EQ(body.albedo, Vec3(0.05));
  EXPECT_EQ(body.world_from_body, Quat(0, 0, 0, 1));
  EXPECT_EQ(body.photometry.law, light::Law::hapke);
  EXPECT_EQ(body.photometry.surge_width, 0.1);
  EXPECT_TRUE(sky_of(with("moon=1e8 0 0"))->bodies[0].photometry.rolo);
  Settings two = with("moon=1e8 0 0");
  DiagnosticLog log;
  EXPECT_TRUE(read_setting(SettingId::planet, "earth=2e8 0 0", two, log));
  EXPECT_TRUE(read_setting(SettingId::sky, "sun", two, log));
  ASSERT_EQ(sky_of(two)->bodies.size(), 2u);
  EXPECT_EQ(sky_of(two)->bodies[1].centre.x, 2e8);
  EXPECT_TRUE(sky_of(two)->sun_visible);
  EXPECT_EQ(sky_of(Settings()), nullptr);
  // read back from what is written
  for (const std::string& text : setting_texts(SettingId::planet, two))
    EXPECT_TRUE(text == "moon=1e8 0 0" || text == "earth=2e8 0 0") << text;
}

TEST(SkySettings, RefusesWhatCannotBe) {
  for (const char* wrong :
       {"=0 0 1", "earth=0 0", "earth=0 0 x", "earth=0 0 1 2 0 0 0", "earth=0 0 1 1 0 0",
        "mars=0 0 1e7", "mars=0 0 1e7 radius=0", "mars=0 0 1e7 radius=-1",
        "mars=0 0 1e7 radius=1 2", "mars=0 0 1e7 radius=1 1 1000", "earth=0 0 1e7 albedo=-1",
        "earth=0 0 1e7 albedo=", "earth=0 0 1e7 law=phong", "earth=0 0 1e7 law=hapke 2 0 0 0.1",
        "earth=0 0 1e7 law=hapke 1", "earth=0 0 1e7 colour=1",
        "earth=0 0 1e7 map=", "earth=0 0 1e400"}) {
    DiagnosticLog log;
    const Settings settings = with(wrong);
    EXPECT_FALSE(check_sky(settings, log)) << wrong;
    ASSERT_EQ(log.entries().size(), 1u) << wrong;
    EXPECT_EQ(log.entries()[0].code, Code("E0201"));
    EXPECT_NE(first_error(log).find("--planet"), std::string::npos);
  }
  Settings settings;
  settings.sky = "sun pluto";
  DiagnosticLog log;
  EXPECT_FALSE(check_sky(settings, log));
  EXPECT_NE(first_error(log).find("pluto"), std::string::npos);
}

// A map that is missing, none, or not twice as wide as high.
TEST(SkySettings, RefusesMaps) {
  const auto folder = std::filesystem::temp_directory_path() / "panwright_sky_settings";
  std::filesystem::create_directories(folder);
  const auto code_of = [&](const std::string& name) {
    DiagnosticLog log;
    EXPECT_FALSE(SkyReader().read(with("earth=0 0 1e7 map=" + (folder / name).string()), {}, log));
    return log.entries().empty() ? Code("E0001") : log.entries()[0].code;
  };
  EXPECT_EQ(code_of("missing.png"), Code("E0101"));
  std::ofstream(folder / "text.png") << "no image";
  EXPECT_EQ(code_of("text.png"), Code("E3001"));
  std::ofstream(folder / "square.ppm") << "P3 2 2 255 1 2 3 4 5 6 7 8 9 1 2 3\n";
  EXPECT_EQ(code_of("square.ppm"), Code("E0201"));
  // a black band stays at its albedo
  std::ofstream(folder / "red.ppm") << "P3 2 1 255 200 0 0 100 0 0\n";
  const auto sky = sky_of(with("earth=0 0 1e7 map=" + (folder / "red.ppm").string()));
  ASSERT_NE(sky->bodies[0].map, nullptr);
  const Vec3 mean =
      0.5 * (sky->bodies[0].map->at({0, 1, 0}, 0) + sky->bodies[0].map->at({0, -1, 0}, 0));
  EXPECT_NEAR(mean.x, 1, 1e-6);
  EXPECT_NEAR(mean.y, 1, 1e-6);
  std::filesystem::remove_all(folder);
}

// Air by default, by name, and where it cannot be.
TEST(SkySettings, Air) {
  EXPECT_TRUE(sky_of(with("earth=0 0 -6778km"))->bodies[0].air);
  EXPECT_FALSE(sky_of(with("earth=0 0 -6778km air=none"))->bodies[0].air);
  EXPECT_FALSE(sky_of(with("earth=0 0 -6778km law=lommel-seeliger"))->bodies[0].air);
  EXPECT_FALSE(sky_of(with("earth=0 0 -50 radius=20"))->bodies[0].air);
  EXPECT_FALSE(sky_of(with("moon=1e8 0 0"))->bodies[0].air);
  EXPECT_TRUE(sky_of(with("venus=0 0 -9000km radius=6052km air=earth"))->bodies[0].air);
  for (const char* wrong :
       {"earth=0 0 -6778km air=mars", "earth=0 0 -50 radius=20 air=earth", "moon=1e8 0 0 air=earth",
        "earth=0 0 -6778km air=", "earth=0 0 -6778km air=Sunset",
        "earth=0 0 -6778km air=sunset earth", "earth=0 0 -50 radius=20 air=sunset",
        "moon=1e8 0 0 air=sunset", "earth=0 0 -6778km law=rolo air=sunset"}) {
    DiagnosticLog log;
    EXPECT_FALSE(check_sky(with(wrong), log)) << wrong;
    EXPECT_NE(first_error(log).find("air="), std::string::npos) << first_error(log);
    EXPECT_NE(first_error(log).find("expected air=earth"), std::string::npos) << first_error(log);
  }
}

// The last sunlight through air: by its name alone, and the same from what is written.
TEST(SkySettings, LastSunlight) {
  EXPECT_FALSE(sky_of(with("earth=0 0 -6778km"))->bodies[0].sunset);
  EXPECT_FALSE(sky_of(with("earth=0 0 -6778km air=earth"))->bodies[0].sunset);
  EXPECT_FALSE(sky_of(with("earth=0 0 -6778km air=none"))->bodies[0].sunset);
  for (const char* text :
       {"earth=0 0 -6778km air=sunset", "venus=0 0 -9000km air=sunset radius=6052km albedo=0.7"}) {
    const Settings settings = with(text);
    const light::Body body = sky_of(settings)->bodies[0];
    EXPECT_TRUE(body.air && body.sunset) << text;
    for (const std::string& written : setting_texts(SettingId::planet, settings)) {
      const light::Body again = sky_of(with(written))->bodies[0];
      EXPECT_TRUE(again.air && again.sunset) << written;
      EXPECT_EQ(again.albedo, body.albedo) << written;
    }
  }
}

// Ground, clouds and night from files with blanks in their names; holes; an albedo below the air's.
TEST(SkySettings, Maps) {
  const auto folder = std::filesystem::temp_directory_path() / "panwright_sky maps";
  std::filesystem::create_directories(folder);
  const auto at = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(at("a b.ppm")) << "P3 2 1 255 200 0 0 100 0 0\n";
  std::ofstream(at("c.ppm")) << "P3 2 1 255 255 255 255 0 0 0\n";
  const auto sky = sky_of(with("earth=0 0 1e7 air=none albedo=0.5 map=" + at("a b.ppm") +
                               " night=" + at("a b.ppm") + " clouds=" + at("c.ppm")));
  const light::Body& body = sky->bodies[0];
  ASSERT_TRUE(body.map && body.night);
  // all cloud in the west: 0.75 of a mean of 0.5
  EXPECT_NEAR(body.map->at({0, -1, 0}, 0).x, 0.75 / 0.5, 1e-6);
  EXPECT_NEAR(body.map->at({0, 1, 0}, 0).x, 0.25 / 0.5, 1e-6);
  EXPECT_NEAR(body.night->at({0, -1, 0}, 0).x, 0.5776, 1e-3);  // sRGB 200
  const auto codes = [&](const std::string& text) {
    DiagnosticLog log;
    EXPECT_TRUE(SkyReader().read(with(text), {}, log)) << first_error(log);
    std::vector<Code> out;
    for (const auto& entry : log.entries()) out.push_back(entry.code);
    return out;
  };
  EXPECT_EQ(codes("earth=0 0 1e7 clouds=" + at("c.ppm")), std::vector{Code("W5043")});
  EXPECT_EQ(codes("earth=0 0 1e7 albedo=0.01 map=" + at("c.ppm")), std::vector{Code("W5043")});
  EXPECT_EQ(codes("earth=0 0 1e7 albedo=0.5 clouds=" + at("c.ppm")), std::vector<Code>{});
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace panwright::workspace::sky_settings_test
