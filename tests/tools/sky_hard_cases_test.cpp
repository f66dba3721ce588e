// Extreme places of cameras, bodies and lamps: images are finite and bounded by both engines,
// --explain says what is where, and less of the Sun is less light.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/oracles.h"
#include "tests/support/process.h"

namespace panwright::sky_hard_cases_test {
namespace {

using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

struct HardCase {
  const char* name;
  std::vector<std::string> words;
  const char* explained;
};

const HardCase kCases[] = {
    {"in the air", {"--planet", "earth=0 0 -6390km"}, "the camera is in its air"},
    {"on the surface",
     {"--planet", "earth=0 0 -6371002 radius=6371km"},
     "earth: 2 m above its ground, 180 degrees wide, the camera is in its air"},
    {"inside", {"--planet", "earth=0 0 -6000km"}, "earth: not drawn, the camera is inside of it"},
    {"the Sun behind the limb",
     {"--planet", "earth=0 0 -6778km", "--sun", "0.1 0 -1"},
     "origin of 'box': no Sun, bodies hide it"},
    {"the Sun's disc on the limb",
     {"--planet", "earth=0 0 -6778km radius=6371km", "--sun", "0.9399 0 -0.34145", "--sky", "sun",
      "--look-at", "9399 0 -3414.5"},
     "disc of the Sun in the image: "},
    {"the last sunlight",
     {"--planet", "earth=0 0 -6778km radius=6371km air=sunset", "--sun", "0.9399 0 -0.34145"},
     "% of the Sun's light at 650, 550 and 450 nm, beside bodies and through air"},
    {"a planet that fills the image",
     {"--planet", "earth=0 -7000km 0", "--look-at", "0 -9 0", "--camera", "0 -5 0"},
     "degrees wide"},
    {"the Moon at the limb",
     {"--planet", "moon=0 3.8e8 0", "--planet", "earth=0 6778km -6371km"},
     "moon: 378263 km above its ground, 0.524 degrees wide"},
    {"a body before the target",
     {"--planet", "rock=0 -2 0.1 radius=0.2"},
     "rock: 2.802 m above its ground"},
    {"two bodies before the Sun",
     {"--planet", "a=200 0.4 0 radius=0.5", "--planet", "b=300 -0.9 0 radius=0.5", "--sun",
      "1 0 0"},
     "% of the Sun's light beside bodies"},
    {"a lamp inside", {"--lamp", "point intensity 1 radius 1cm"}, "lamps: 1 on a target"},
    {"a lamp at the pinhole", {"--lamp", "point on camera intensity 1"}, "lamps: 1 on a target"},
    {"stars at the limb and the edge",
     {"--stars", "8", "--planet", "earth=0 6778km -6371km"},
     "earth: "},
    {"1 m and 4e8 m",
     {"--planet", "moon=0.5e8 4e8 0", "--sky", "sun"},
     "moon: 401375 km above its ground"},
};

TEST(SkyHardCases, AreFiniteAndExplained) {
  const TemporaryFolder folder;
  const std::string box =
      folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  for (const HardCase& each : kCases)
    for (const char* engine : {"gl", "reference"}) {
#ifndef PANWRIGHT_GL
      if (*engine == 'g') continue;
#endif
      const std::string out = folder / "out.npy";
      std::vector<std::string> words = {"render", box,         "-o",       out,      "--engine",
                                        engine,   "--samples", "2",        "--size", "24x24",
                                        "--fov",  "40",        "--explain"};
      const auto unless_given = [&](const char* option, const char* value) {
        if (std::ranges::find(each.words, option) == each.words.end())
          words.insert(words.end(), {option, value});
      };
      unless_given("--camera", "0 -5 0");
      unless_given("--look-at", "0 0 0");
      unless_given("--sun", "0.3 -1 0.5");
      words.insert(words.end(), each.words.begin(), each.words.end());
      const Outcome done = panwright(words);
      ASSERT_EQ(done.code, 0) << each.name << '\n' << done.err;
      // lamps are counted where OpenGL draws
      if (*engine == 'g' || each.explained[0] != 'l')
        EXPECT_THAT(done.out + done.err, HasSubstr(each.explained)) << each.name;
      const auto image = oracles::read_npy(out);
      ASSERT_TRUE(image);
      // radiance of the Sun's disc: 1 over its solid angle; else white and a lamp at 5 m
      const double most = std::ranges::find(each.words, "sun") != each.words.end() ? 2e4 : 1;
      for (const float value : image->rgb)
        ASSERT_TRUE(std::isfinite(value) && value >= 0 && value <= most)
            << each.name << ' ' << engine << ' ' << value;
    }
}

// A box with the whole Sun, with a part of it, and with none; lit by nothing else.
TEST(SkyHardCases, LessOfTheSunIsLessLight) {
  const TemporaryFolder folder;
  const std::string box =
      folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  for (const char* engine : {"gl", "reference"}) {
#ifndef PANWRIGHT_GL
    if (*engine == 'g') continue;
#endif
    double last = 1e9;
    for (const char* radius : {"0.2", "0.45", "0.7", "2.5"}) {
      const std::string out = folder / "out.npy";
      const Outcome done = panwright(
          {"render",   box,      "-o",        out,
           "--engine", engine,   "--samples", "4",
           "--size",   "32x32",  "--fov",     "15",
           "--camera", "5 -3 0", "--look-at", "0 0 0",
           "--sun",    "1 0 0",  "--planet",  fmt::format("rock=150 0 0 radius={}", radius)});
      ASSERT_EQ(done.code, 0) << done.err;
      const auto image = oracles::read_npy(out);
      ASSERT_TRUE(image);
      double sum = 0;
      for (const float value : image->rgb) sum += value;
      EXPECT_LT(sum, last) << engine << ' ' << radius;
      last = sum;
    }
    EXPECT_LT(last, 1e-3) << engine;
  }
}

// Corner cubes send the light of a lamp at the camera back, by their effective aperture: 0.3239 of
// fused silica at 30 degrees (three mirrors traced, docs/choosing-a-material.md); of one beside the
// camera nothing.
TEST(SkyHardCases, CornerCubesAnswerLampsAtTheCamera) {
  const TemporaryFolder folder;
  const std::string cubes = folder.write(
      "cubes.pxn",
      "<pangu_model ver=\"1\"><material name=\"r\"><retroreflector index=\"1.46\" "
      "width=\"2mrad\"/></material><box size=\"0.2 0.01 0.2\" material=\"r\"/></pangu_model>");
  for (const char* engine : {"gl", "reference"}) {
#ifndef PANWRIGHT_GL
    if (*engine == 'g') continue;
#endif
    const auto flux = [&](const char* camera, const char* lamp) {
      const std::string out = folder / "out.npy";
      const Outcome done = panwright(
          {"render",           cubes,   "-o",     out,     "--engine", engine, "--samples", "8",
           "--size",           "16x16", "--ifov", "1mrad", "--camera", camera, "--look-at", "0 0 0",
           "--sun-irradiance", "0",     "--lamp", lamp});
      EXPECT_EQ(done.code, 0) << done.err;
      const auto image = oracles::read_npy(out);
      double sum = 0;
      for (const float value : image->rgb) sum += value;
      return sum;
    };
    const char* lamp = "point on camera intensity 100";
    const double front = flux("0 -20 0", lamp), aslant = flux("10 -17.3205 0", lamp);
    // 1.5 % measured: samples at the edges of a plate of 10 pixels
    EXPECT_NEAR(aslant / front / 0.3239, 1, 0.04) << engine;
    EXPECT_EQ(flux("0 -20 0", "point on camera at 1 0 0 intensity 100"), 0) << engine;
  }
}

}  // namespace
}  // namespace panwright::sky_hard_cases_test
