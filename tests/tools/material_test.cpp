// `panwright material` as a user runs it: report, sheet, fit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/math.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::material_test {
namespace {

using nlohmann::json;
using support::contents;
using support::Outcome;
using support::TemporaryFolder;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

Outcome material(std::vector<std::string> words) {
  words.insert(words.begin(), {PANWRIGHT_BIN_DIR "/panwright", "material"});
  return support::run(words, {});
}

std::string text_of(const std::string& name, const std::string& fields) {
  return "<pangu_model ver=\"1\"><material name=\"" + name + "\">" + fields +
         "</material></pangu_model>";
}

TEST(MaterialCommand, TheReportBeginsWithAVerdict) {
  const Outcome good = material({"osr_silica"});
  EXPECT_EQ(good.code, 0) << good.err;
  EXPECT_THAT(
      good.out.substr(0, good.out.find("\n\n")),
      ContainsRegex("Energy: conserved \\(largest directional albedo 0\\.972 at 89\\.4°\\)\\. "
                    "Reciprocal\\. Safe in single precision"));
  const TemporaryFolder folder;
  const std::string bad = folder.write(
      "m.pxn", text_of("My Paint (v2)", "<diffuse>1 1 1</diffuse><oren>0.3rad</oren>"));
  const Outcome gains = material({bad});
  EXPECT_THAT(gains.out, HasSubstr("My Paint (v2): ")) << "as typed";
  EXPECT_THAT(gains.out, HasSubstr("Energy: GAINED, up to "));
  const json out = json::parse(material({bad, "--json"}).out);
  EXPECT_EQ(out["verdict"]["energy_conserved"], false);
  EXPECT_EQ(out["verdict"]["reciprocal"], true);
}

// A table of readings that a known surface gives: 0.3, 0.2 and 0.1 of the light, the same
// everywhere.
std::string table() {
  std::string text = "# theta_i, phi_i, theta_r, phi_r, reflectance\n";
  for (int light = 0; light <= 30; light += 30)
    for (int viewer = -60; viewer <= 60; viewer += 30) {
      text += std::to_string(light) + ",180," + std::to_string(viewer) + ",0";
      for (const double albedo : {0.3, 0.2, 0.1}) text += "," + std::to_string(albedo / kPi);
      text += "\n";
    }
  return text;
}

TEST(MaterialCommand, FitsATableOfColors) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "plots");
  const std::string color = folder.write("Foil #3.csv", table());
  const Outcome three = material({"--fit", color, "--svg", folder / "plots", "--json"});
  ASSERT_EQ(three.code, 0) << three.err;
  const json out = json::parse(three.out);
  EXPECT_EQ(out["bands"], 3);
  EXPECT_EQ(out["name"], "Foil #3");
  for (const auto& fit : out["fits"])
    if (fit["brdf"] == "Lambert") {
      EXPECT_EQ(fit["text"], "<diffuse> 0.3 0.2 0.1 </diffuse>");
      EXPECT_LT(fit["rms_decades"], 1e-5);
    }
  for (const char* band : {"red", "green", "blue"}) {
    const std::string svg = contents(folder / ("plots/Foil #3-fit-" + std::string(band) + ".svg"));
    EXPECT_THAT(svg, HasSubstr("<circle")) << "readings";
    EXPECT_THAT(svg, HasSubstr("<polyline")) << "the fit";
    EXPECT_THAT(svg, HasSubstr("Foil #3 in " + std::string(band)));
  }
}

TEST(MaterialCommand, AnInvalidTableIsOneError) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 300; ++i) text += "10 0 20 0 0.1 0.2\n";
  const Outcome outcome = material({"--fit", folder.write("t.csv", text)});
  EXPECT_EQ(outcome.code, 1);
  std::size_t count = 0;
  for (std::size_t at = 0; (at = outcome.err.find("E1409", at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 1u) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("6 numbers, expected 5, or 7 with three bands, and 299 lines"));
}

// A mirror shows the studio; in space it shows nothing here.
TEST(MaterialCommand, TheStudioIsForMirrors) {
  const TemporaryFolder folder;
  EXPECT_EQ(material({"osr_silica", "--render", folder / "g.png", "--engine", "gl"}).code, 2);
  const auto mean = [&](const std::string& light) {
    const std::string file = folder / (light + ".npy");
    const Outcome outcome = material({"osr_silica", "--render", file, "--light", light, "--engine",
                                      "reference", "--width", "60"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    // (H, W, 3) in float32 behind a header
    const std::string bytes = contents(file);
    double sum = 0;
    if (bytes.size() < 10) return sum;
    const std::size_t header =
        10 + static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    const std::size_t width = 60, height = 20 + 28 + 28;
    EXPECT_EQ(bytes.size(), header + 12 * width * height);
    if (bytes.size() != header + 12 * width * height) return sum;
    const auto shown = [&](std::size_t x, std::size_t y) {
      float value = 0;
      std::memcpy(&value, bytes.data() + header + 12 * (y * width + x), sizeof value);
      return kPi * double(value);
    };
    EXPECT_NEAR(shown(59, 29), 0.033, 1e-3) << "dark grey";
    for (std::size_t y = 34; y < 42; ++y)
      for (std::size_t x = 26; x < 34; ++x) sum += shown(x, y) / 64;
    return sum;
  };
  EXPECT_LT(mean("sun"), 1e-3);
  EXPECT_GT(mean("studio"), 0.3);
}

}  // namespace
}  // namespace panwright::material_test
