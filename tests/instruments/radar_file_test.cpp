// Files of RADARs and of their histograms.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "image/arrays.h"
#include "image/image.h"
#include "instruments/radar.h"
#include "instruments/radar_files.h"

namespace panwright::instruments::radar_file_test {
namespace {

constexpr const char* kSmall =
    "[signal]\nfrequency_hz = 1e10\nbandwidth_hz = 1e8\ndwell_s = 0.01\n"
    "[antenna]\nbeam_deg = [10, 5]\n[histogram]\nrange_m = [0, 100]\nspeed_m_s = [-5, 5]\n";

std::string problems_of(const std::string& text) {
  DiagnosticLog log;
  EXPECT_FALSE(read_radar(text, "radar.toml", log)) << text;
  return to_text(log);
}

TEST(RadarFile, HasItsNumbers) {
  DiagnosticLog log;
  const auto radar = read_radar(
      std::string(kSmall) +
          "[receiver]\nnoise_figure_db = 3\nlooks = 4\n[surfaces.foil]\nlaw = \"metal\"\n"
          "[surfaces.\"*\"]\nlaw = \"hagfors\"\nreflectance = 0.06\nslope_deg = 6.8\n[altimeter]\n",
      "radar.toml", log);
  ASSERT_TRUE(radar) << to_text(log);
  EXPECT_DOUBLE_EQ(radar->beam.x, 10 * kDegree);
  EXPECT_DOUBLE_EQ(radar->beam.y, 5 * kDegree);
  EXPECT_NEAR(radar->noise_figure, 1.9953, 1e-4);
  EXPECT_EQ(radar->looks, 4u);
  ASSERT_EQ(radar->surfaces.size(), 2u);
  EXPECT_EQ(radar->surfaces[0].law, ScatterLaw::metal);
  EXPECT_NEAR(radar->surfaces[1].slope, 0.11924, 1e-5);
  EXPECT_DOUBLE_EQ(radar->altimeter, 0.5);
  EXPECT_DOUBLE_EQ(radar->range_step(), kLightSpeed / 4e8);
}

TEST(RadarFile, MistakesAreNamed) {
  const std::string small(kSmall);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = small;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "signal"},
      {"[signal", "E0263"},
      {with("1e10", "-1"), "frequency_hz is -1, expected"},
      {with("frequency_hz", "frequency"), "frequency"},
      {with("1e8", "\"wide\""), "bandwidth_hz"},
      {with("[0, 100]", "[100, 0]"), "the lower first"},
      {with("[0, 100]", "[0, 1e9]"), "cells"},
      {with("[10, 5]", "[10]"), "beam_deg"},
      {small + "[surfaces.foil]\nlaw = \"metall\"\n", "did you mean 'metal'?"},
      {small + "[surfaces.foil]\nlaw = \"lambert\"\n", "albedo"},
      {small + "[surfaces]\nfoil = 3\n", "foil"},
      {small + "surfaces = 3\n", "E0263"},
      {small + "[receiver]\nlooks = 1.5\n", "whole number"},
      {small + "[altimeter]\nthreshold = 2\n", "threshold"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string problems = problems_of(text);
    EXPECT_NE(problems.find("E0263"), problems.npos) << problems;
    EXPECT_NE(problems.find(expected), problems.npos) << expected << "\n" << problems;
  }
}

// Every beginning of a file, and every byte changed: an answer, no crash.
TEST(RadarFile, DamagedTextsAreAnswered) {
  const std::string text = std::string(kSmall) + "[surfaces.\"*\"]\nlaw = \"metal\"\n";
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const char c : {'\0', '[', '"', '9'}) {
      std::string damaged = text;
      damaged[i] = c;
      for (const std::string& each : {damaged, text.substr(0, i)}) {
        DiagnosticLog log;
        const bool good = bool(read_radar(each, "radar.toml", log));
        EXPECT_EQ(good, !log.has_errors()) << each << to_text(log);
      }
    }
}

RadarHistogram small_histogram() {
  RadarHistogram h;
  h.ranges = 3;
  h.speeds = 2;
  h.first_range = 10;
  h.range_step = 0.5;
  h.first_speed = -1;
  h.speed_step = 2;
  h.power = {1, 2, 3, 4, 5, 6};
  h.mean_power = h.power;
  h.azimuth.assign(6, 0.1);
  h.elevation.assign(6, std::numeric_limits<double>::quiet_NaN());
  h.response_sum = 4.5;
  return h;
}

TEST(RadarFiles, ReadBack) {
  const auto folder = std::filesystem::temp_directory_path() / "panwright_radar_files";
  std::filesystem::create_directories(folder);
  DiagnosticLog log;
  const RadarHistogram h = small_histogram();
  for (const char* name : {"h.npz", "h.csv", "h.png", "h.exr"}) {
    EXPECT_TRUE(is_histogram_file(name));
    ASSERT_TRUE(write_histogram(h, folder / name, "{\"command\": \"radar\"}", log)) << to_text(log);
  }
  EXPECT_FALSE(is_histogram_file("h.npy"));
  const auto arrays = image::read_arrays(folder / "h.npz", {}, 1 << 20, log);
  ASSERT_TRUE(arrays) << to_text(log);
  for (const image::Array& each : *arrays) {
    if (each.name != "power_w") continue;
    EXPECT_EQ(each.shape, (std::vector<std::uint64_t>{2, 3}));
    double last = 0;
    std::memcpy(&last, each.data.data() + 5 * sizeof(double), sizeof last);
    EXPECT_EQ(last, 6);
  }
  for (const char* name : {"h.png", "h.exr"}) {
    const auto record = image::read_image_record(folder / name, log);
    ASSERT_TRUE(record) << to_text(log);
    EXPECT_EQ(*record, "{\"command\": \"radar\"}");
  }
  std::ifstream in(folder / "h.csv");
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_NE(text.str().find("\n10.5,1,5,5,0.1,\n"), std::string::npos) << text.str();
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace panwright::instruments::radar_file_test
