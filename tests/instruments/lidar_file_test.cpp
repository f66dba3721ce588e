// Files of LiDARs, patterns of scans, and files of point clouds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "base/file.h"
#include "image/arrays.h"
#include "instruments/lidar.h"
#include "instruments/point_files.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/trace/trace_models.h"

namespace panwright::instruments::lidar_file_test {
namespace {

using support::TemporaryFolder;

Result<Lidar> read(const std::string& text, DiagnosticLog& log) {
  return read_lidar(text, "lidar.toml", {}, log);
}

TEST(LidarFile, ExamplesAreRead) {
  std::size_t count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(PANWRIGHT_SOURCE_DIR "/examples/lidar")) {
    if (entry.path().extension() != ".toml") continue;
    DiagnosticLog log;
    const auto text = read_file(entry.path(), 1 << 20, log);
    ASSERT_TRUE(text);
    const auto lidar = read_lidar(*text, entry.path().string(), entry.path().parent_path(), log);
    ASSERT_TRUE(lidar) << to_text(log);
    EXPECT_TRUE(log.entries().empty()) << to_text(log);
    EXPECT_FALSE(pulses_of(lidar->scan).empty());
    ++count;
  }
  EXPECT_GE(count, 3u);
}

TEST(LidarFile, HasSiUnits) {
  DiagnosticLog log;
  const auto lidar = read(R"(
name = "one"
[scan]
pattern = "raster"
columns = 3
rows = 2
azimuth_deg = [-90, 90]
elevation_deg = [30, -30]
rate_hz = 100
[beam]
wavelength_nm = 905
divergence_mrad = 2
pulse_ns = 4
[receiver]
mode = "photon"
aperture_mm = 30
[noise]
jitter_mm = 20
[detection]
method = "centroid"
echoes = "all"
gate_m = [1, 50]
bias_mm = -5
)",
                          log);
  ASSERT_TRUE(lidar) << to_text(log);
  EXPECT_NEAR(lidar->wavelength, 905e-9, 1e-20);
  EXPECT_DOUBLE_EQ(lidar->divergence, 2e-3);
  EXPECT_NEAR(lidar->pulse_fwhm, 4e-9, 1e-20);
  EXPECT_TRUE(lidar->photon_counting);
  EXPECT_DOUBLE_EQ(lidar->aperture, 0.03);
  EXPECT_DOUBLE_EQ(lidar->jitter, 0.02);
  EXPECT_EQ(lidar->method, RangeMethod::centroid);
  EXPECT_EQ(lidar->echoes, EchoChoice::all);
  EXPECT_EQ(lidar->gate, Vec2(1, 50));
  EXPECT_DOUBLE_EQ(lidar->bias, -0.005);
  const std::vector<Pulse> pulses = pulses_of(lidar->scan);
  ASSERT_EQ(pulses.size(), 6u);
  // left, middle, right above the boresight; then below
  const double c = std::cos(30 * kDegree), s = std::sin(30 * kDegree);
  EXPECT_NEAR(glm::length(pulses[0].direction - Vec3(-c, -s, 0)), 0, 1e-15);
  EXPECT_NEAR(glm::length(pulses[1].direction - Vec3(0, -s, c)), 0, 1e-15);
  EXPECT_NEAR(glm::length(pulses[5].direction - Vec3(c, s, 0)), 0, 1e-15);
  EXPECT_DOUBLE_EQ(pulses[5].time, 0.05);
}

// Each mistake has its place and what would be accepted.
TEST(LidarFile, RefusesMistakesWithTheirPlace) {
  const struct {
    const char *text, *words;
  } cases[] = {
      {"", "scan"},
      {"[scan]\npattern = \"spirale\"\n", "did you mean 'spiral'"},
      {"[scan]\npattern = 3\n", "pattern"},
      {"[scan]\npattern = \"flash\"\ncolumns = 0\n", "columns is 0"},
      {"[scan]\npattern = \"flash\"\ncolumns = 1.5\n", "whole number"},
      {"[scan]\npattern = \"flash\"\nturns = 3\n", "turns"},
      {"[scan]\npattern = \"raster\"\ncolumns = 40000\nrows = 40000\n", "at most 50000000"},
      {"[scan]\npattern = \"raster\"\nazimuth_deg = [0]\n", "azimuth_deg"},
      {"[scan]\npattern = \"rotating\"\n", "elevations_deg"},
      {"[scan]\npattern = \"rotating\"\nelevations_deg = [0, 100]\n", "-90 to 90"},
      {"[scan]\npattern = \"file\"\nfile = \"none.csv\"\n", "none.csv"},
      {"[scan]\npattern = \"flash\"\n[beam]\nsub_rays = 0\n", "sub_rays is 0"},
      {"[scan]\npattern = \"flash\"\n[beam]\nsub_rays = 1e9\n", "1 to 1024"},
      {"[scan]\npattern = \"flash\"\n[beam]\npulse_energy_j = nan\n", "pulse_energy_j"},
      {"[scan]\npattern = \"flash\"\n[receiver]\nsample_ns = 1e-4\n", "thousandth"},
      {"[scan]\npattern = \"flash\"\n[receiver]\nsample_ns = 100\n", "between samples"},
      {"[scan]\npattern = \"flash\"\n[detection]\ngate_m = [5, 5]\n", "no length"},
      {"[scan]\npattern = \"flash\"\n[detektion]\n", "detektion"},
      {"[scan\n", ""},
  };
  for (const auto& [text, words] : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(read(text, log)) << text;
    EXPECT_NE(to_text(log).find(words), std::string::npos) << text << to_text(log);
  }
}

TEST(LidarFile, ReadsATableOfPulses) {
  const TemporaryFolder folder;
  folder.write("pulses.csv", "time_s,azimuth_deg,elevation_deg\n0,0,0\n0.5,90,0\n1,0,90\n");
  DiagnosticLog log;
  const std::string text = "[scan]\npattern = \"file\"\nfile = \"pulses.csv\"\n";
  const auto lidar = read_lidar(text, "lidar.toml", folder.path(), log);
  ASSERT_TRUE(lidar) << to_text(log);
  const auto pulses = pulses_of(lidar->scan);
  ASSERT_EQ(pulses.size(), 3u);
  EXPECT_NEAR(glm::length(pulses[1].direction - Vec3(1, 0, 0)), 0, 1e-15);
  EXPECT_NEAR(glm::length(pulses[2].direction - Vec3(0, -1, 0)), 0, 1e-15);
  EXPECT_EQ(pulses[2].time, 1);
  for (const char* wrong : {"1,0,0\n0,0,0\n", "0,0\n", "0,0,100\n", "0,x,0\n0,y,0\n", "#\n"}) {
    folder.write("pulses.csv", wrong);
    DiagnosticLog problems;
    EXPECT_FALSE(read_lidar(text, "lidar.toml", folder.path(), problems)) << wrong;
    EXPECT_TRUE(problems.has_errors());
  }
}

TEST(LidarScan, PatternsAreThoseOfTheirFormulas) {
  Scan scan;
  scan.pulses = 1001;
  scan.rate_hz = 1000;
  scan.pattern = ScanPattern::spiral;
  scan.radius = 0.1;
  scan.turns = 5;
  std::vector<Pulse> pulses = pulses_of(scan);
  EXPECT_NEAR(angle_between(pulses[1000].direction, Vec3(0, 0, 1)), 0.1, 1e-12);
  // constant speed beyond the middle: steps of one length
  const auto step = [&](std::size_t k) {
    return angle_between(pulses[k].direction, pulses[k + 1].direction);
  };
  EXPECT_NEAR(step(950) / step(300), 1, 0.01);

  scan.pattern = ScanPattern::lissajous;
  scan.amplitude = {0.2, 0.1};
  scan.frequency_hz = {3, 2};
  scan.phase = kPi / 2;
  pulses = pulses_of(scan);
  // periodic in 1/gcd(3, 2) = 1 s
  EXPECT_NEAR(glm::length(pulses[0].direction - pulses[1000].direction), 0, 1e-12);
  EXPECT_NEAR(std::atan2(pulses[0].direction.x, pulses[0].direction.z), 0.2, 1e-12);
  EXPECT_NEAR(std::asin(-pulses[125].direction.y), 0.1, 1e-12);

  scan.pattern = ScanPattern::rotating;
  scan.columns = 4;
  scan.azimuth = {-kPi, kPi};
  scan.channels = {0.1, -0.1};
  scan.rate_hz = 10;
  pulses = pulses_of(scan);
  ASSERT_EQ(pulses.size(), 8u);
  EXPECT_NEAR(pulses[0].direction.z, -std::cos(0.1), 1e-12);
  EXPECT_NEAR(pulses[0].direction.y, -std::sin(0.1), 1e-12);
  EXPECT_NEAR(pulses[1].direction.y, std::sin(0.1), 1e-12);
  EXPECT_NEAR(pulses[1].time, 0.05, 1e-12);
  EXPECT_EQ(pulses[7].row, 1u);
  EXPECT_EQ(pulses[7].column, 3u);

  scan.pattern = ScanPattern::flash;
  scan.columns = 4;
  scan.rows = 2;
  scan.fov = 90 * kDegree;
  pulses = pulses_of(scan);
  EXPECT_NEAR(pulses[0].direction.x / pulses[0].direction.z, -0.75, 1e-12);
  EXPECT_NEAR(pulses[0].direction.y / pulses[0].direction.z, -0.25, 1e-12);

  scan.pattern = ScanPattern::raster;
  scan.zigzag = true;
  pulses = pulses_of(scan);
  EXPECT_EQ(pulses[3].column, 3u);
  EXPECT_EQ(pulses[4].column, 3u);
  EXPECT_EQ(pulses[4].row, 1u);
}

LidarCloud cloud_of_two() {
  LidarCloud cloud;
  cloud.columns = 2;
  cloud.rows = 2;
  for (std::uint32_t k = 0; k < 4; ++k)
    cloud.pulses.push_back({0.25 * k, Vec3(0, 0, 1), k / 2, k % 2});
  cloud.status = {PulseStatus::echo, PulseStatus::no_echo, PulseStatus::out_of_gate,
                  PulseStatus::echo};
  cloud.poses.push_back({});
  LidarPoint point;
  point.range = 12.25;
  point.true_range = 12.125;
  point.intensity = 100;
  point.reflectance = 0.25;
  point.position = {1.5, -2.25, 12};
  point.cosine = 0.5;
  point.ids = {1, 2, 3, 4};
  cloud.points.push_back(point);
  point.pulse = 3;
  point.time = 0.75;
  point.position = {-1e4, 3, 1e-3};
  point.flags = kFalseAlarm;
  point.true_range = std::nan("");
  cloud.points.push_back(point);
  return cloud;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Places of the specification of LAS 1.4, tables 3, 4, 15 and 24.
TEST(PointFiles, LasIsAsItsSpecificationSays) {
  const TemporaryFolder folder;
  const LidarCloud cloud = cloud_of_two();
  DiagnosticLog log;
  ASSERT_TRUE(write_points(cloud, folder / "a.las", "panwright test", log)) << to_text(log);
  const std::string las = bytes_of(folder / "a.las");
  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(las[24], 1);
  EXPECT_EQ(las[25], 4);
  EXPECT_EQ(number_at<std::uint16_t>(las, 94), 375);
  const auto offset = number_at<std::uint32_t>(las, 96);
  EXPECT_EQ(number_at<std::uint32_t>(las, 100), 1u);
  EXPECT_EQ(las[104], 6);
  const auto length = number_at<std::uint16_t>(las, 105);
  EXPECT_EQ(number_at<std::uint64_t>(las, 247), 2u);
  EXPECT_EQ(number_at<std::uint64_t>(las, 255), 2u);  // first returns
  EXPECT_EQ(las.size(), offset + 2u * length);
  EXPECT_EQ(std::string(las.c_str() + 377), "LASF_Spec");
  EXPECT_EQ(number_at<std::uint16_t>(las, 393), 4);
  const auto record = number_at<std::uint16_t>(las, 395);
  EXPECT_EQ(offset, 375u + 54u + record);
  std::size_t extra = 0;
  std::size_t range_at = 0;
  const std::size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  for (std::size_t at = 429; at < offset; at += 192) {
    if (std::string(las.c_str() + at + 4) == "range") range_at = extra;
    extra += sizes[static_cast<std::size_t>(las[at + 2])];
  }
  EXPECT_EQ(length, 30 + extra);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t p = offset + i * length;
    for (std::size_t k = 0; k < 3; ++k) {
      const double scale = number_at<double>(las, 131 + 8 * k);
      const double from = number_at<double>(las, 155 + 8 * k);
      EXPECT_NEAR(number_at<std::int32_t>(las, p + 4 * k) * scale + from,
                  cloud.points[i].position[static_cast<int>(k)], scale);
      EXPECT_LE(number_at<double>(las, 187 + 16 * k),
                cloud.points[i].position[static_cast<int>(k)] + scale);
      EXPECT_GE(number_at<double>(las, 179 + 16 * k),
                cloud.points[i].position[static_cast<int>(k)] - scale);
    }
    EXPECT_EQ(number_at<std::uint16_t>(las, p + 12), 2500);
    EXPECT_EQ(las[p + 14], 0x11);
    EXPECT_EQ(las[p + 16], i == 0 ? 1 : 7);
    EXPECT_EQ(number_at<double>(las, p + 22), cloud.points[i].time);
    EXPECT_EQ(number_at<double>(las, p + 30 + range_at), 12.25);
  }
}

TEST(PointFiles, PcdIsOrganised) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  ASSERT_TRUE(write_points(cloud_of_two(), folder / "a.pcd", "", log));
  const std::string pcd = bytes_of(folder / "a.pcd");
  const std::size_t end = pcd.find("DATA binary\n");
  ASSERT_NE(end, std::string::npos);
  EXPECT_NE(pcd.find("WIDTH 2\nHEIGHT 2\n"), std::string::npos);
  const std::size_t data = end + 12, point = 4 * 4 + 8 * 3 + 4 + 2 + 12;
  ASSERT_EQ(pcd.size(), data + 4 * point);
  EXPECT_EQ(number_at<float>(pcd, data), 1.5f);
  EXPECT_TRUE(std::isnan(number_at<float>(pcd, data + point)));
  EXPECT_EQ(number_at<double>(pcd, data + point + 24), 0.25);
  EXPECT_EQ(number_at<float>(pcd, data + 3 * point + 4), 3.0f);
  EXPECT_EQ(number_at<double>(pcd, data + 16), 12.25);
}

TEST(PointFiles, NpzPlyAndCsvHoldThePoints) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const LidarCloud cloud = cloud_of_two();
  for (const char* name : {"a.npz", "a.ply", "a.csv"})
    ASSERT_TRUE(write_points(cloud, folder / name, "", log)) << to_text(log);
  const auto arrays = image::read_arrays(folder / "a.npz", {}, 1 << 20, log);
  ASSERT_TRUE(arrays) << to_text(log);
  const auto array = [&](const std::string& name) {
    const auto at = std::ranges::find(*arrays, name, &image::Array::name);
    EXPECT_NE(at, arrays->end()) << name;
    return *at;
  };
  EXPECT_EQ(array("position").shape, (std::vector<std::uint64_t>{2, 3}));
  double position[6];
  std::memcpy(position, array("position").data.data(), sizeof position);
  EXPECT_EQ(position[1], -2.25);
  EXPECT_EQ(position[3], -1e4);
  EXPECT_EQ(array("pulse_status").data[2], std::byte{2});
  EXPECT_EQ(array("world_from_instrument").shape, (std::vector<std::uint64_t>{1, 7}));
  const std::string ply = bytes_of(folder / "a.ply");
  const std::size_t data = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size(), data + 2u * (24 + 8 + 24 + 4 + 3 + 16));
  EXPECT_EQ(number_at<double>(ply, data + 8), -2.25);
  const std::string csv = bytes_of(folder / "a.csv");
  EXPECT_NE(csv.find("\n1.5,-2.25,12,12.25,100,0.25,0,0,0,0,0,1,0,12.125,0,0.5,1,2,3,4\n"),
            std::string::npos)
      << csv;
  EXPECT_NE(csv.find(",2,,0,0.5,1,2,3,4\n"), std::string::npos) << csv;
}

TEST(PointFiles, OfNoPointsAreWritten) {
  const TemporaryFolder folder;
  LidarCloud none;
  for (const char* name : {"a.npz", "a.pcd", "a.ply", "a.csv", "a.las"}) {
    DiagnosticLog log;
    EXPECT_TRUE(is_point_file(name));
    EXPECT_TRUE(write_points(none, folder / name, "", log)) << to_text(log);
  }
  EXPECT_FALSE(is_point_file("a.png"));
}

}  // namespace
}  // namespace panwright::instruments::lidar_file_test
