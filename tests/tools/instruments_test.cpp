// `panwright lookup` and `panwright lidar`: answers, files and mistakes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::instruments_test {
namespace {

using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

const std::string kExamples = PANWRIGHT_SOURCE_DIR "/examples/";

constexpr const char* kPlate =
    "<pangu_model ver=\"1\"><box name=\"b\" size=\"2m 2m 2m\"/></pangu_model>";

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

nlohmann::json json_of(const std::vector<std::string>& words) {
  const Outcome done = panwright(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return nlohmann::json::parse(done.out);
}

// A box of 2 m about the origin, seen along +y from 10 m.
TEST(LookupCommand, AnswersAboutABox) {
  const TemporaryFolder folder;
  const std::string model = folder.write("box.pxn", kPlate);
  const auto out = json_of({"lookup",      model,
                            "--camera",    "0 -10 0",
                            "--look-at",   "0 0 0",
                            "--fov",       "30",
                            "--size",      "100x100",
                            "--pixel",     "50 50",
                            "--pixel",     "1 1",
                            "--ray",       "1000000 0 0.5 -2 0 0",
                            "--elevation", "0.2 0.3",
                            "--nearest",   "0 0 5",
                            "--sight",     "5 0 0 -5 0 0",
                            "--sight",     "5 2 0 -5 2 0",
                            "-o",          folder / "answers.csv",
                            "--json"});
  const auto& surfaces = out["surfaces"];
  ASSERT_EQ(surfaces.size(), 5u);
  EXPECT_NEAR(surfaces[0]["distance"].get<double>(), 9, 1e-9);
  EXPECT_NEAR(surfaces[0]["position"][1].get<double>(), -1, 1e-9);
  EXPECT_NEAR(surfaces[0]["facet"][1].get<double>(), -1, 1e-9);
  EXPECT_FALSE(surfaces[1]["found"].get<bool>());
  EXPECT_NEAR(surfaces[2]["distance"].get<double>(), 999'999, 1e-6);
  EXPECT_NEAR(surfaces[3]["position"][2].get<double>(), 1, 1e-9);
  EXPECT_NEAR(surfaces[4]["distance"].get<double>(), 4, 1e-9);
  EXPECT_EQ(surfaces[4]["ids"][0], 1);
  EXPECT_FALSE(out["sights"][0]["open"].get<bool>());
  EXPECT_TRUE(out["sights"][1]["open"].get<bool>());
  const std::string table = bytes_of(folder / "answers.csv");
  EXPECT_THAT(table, HasSubstr("kind,column,row,distance,x,y,z"));
  EXPECT_THAT(table, HasSubstr("\nsight,5,2,0,-5,2,0,1\n"));
}

TEST(LookupCommand, ReadsManyQuestionsOfAFile) {
  const TemporaryFolder folder;
  const std::string model = folder.write("box.pxn", kPlate);
  std::string rows = "x,y # places\n";
  for (int i = 0; i < 1000; ++i) rows += "0.5," + std::to_string(i) + "\n";
  const auto out =
      json_of({"lookup", model, "--elevation", folder.write("places.csv", rows), "--json"});
  ASSERT_EQ(out["surfaces"].size(), 1000u);
  EXPECT_TRUE(out["surfaces"][0]["found"].get<bool>());
  EXPECT_FALSE(out["surfaces"][2]["found"].get<bool>());
}

TEST(LookupCommand, RefusesMistakes) {
  const TemporaryFolder folder;
  const std::string model = folder.write("box.pxn", kPlate);
  const auto problem = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"lookup", model});
    const Outcome done = panwright(words);
    EXPECT_EQ(done.code, 2) << done.err;
    return done.err;
  };
  EXPECT_THAT(problem({}), HasSubstr("no question"));
  EXPECT_THAT(problem({"--pixel", "1"}), HasSubstr("2 numbers"));
  EXPECT_THAT(problem({"--ray", "0 0 0 0 0 0"}), HasSubstr("direction 0 0 0"));
  EXPECT_THAT(problem({"--nearest", "1 2 nan"}), HasSubstr("3 numbers"));
  EXPECT_THAT(problem({"--pixel", folder.write("a.csv", "1,2\n3\n")}), HasSubstr("a.csv:2:1"));
}

std::vector<std::string> scan_of(const std::string& model, const std::string& output) {
  return {"lidar",    model,     "--lidar",   kExamples + "lidar/scanning_rvs.toml",
          "--camera", "0 -30 5", "--look-at", "0 0 0",
          "-o",       output};
}

TEST(LidarCommand, WritesTheSameBytesWithAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string model = folder.write("box.pxn", kPlate);
  for (const char* type : {"npz", "pcd", "ply", "csv", "las"}) {
    std::vector<std::string> files;
    for (const char* threads : {"1", "3"}) {
      files.push_back(folder / (std::string(threads) + "." + type));
      auto words = scan_of(model, files.back());
      words.insert(words.end(), {"--threads", threads, "--noise-seed", "5"});
      ASSERT_EQ(panwright(words).code, 0);
    }
    EXPECT_EQ(bytes_of(files[0]), bytes_of(files[1])) << type;
    EXPECT_GT(bytes_of(files[0]).size(), 10'000u) << type;
  }
  auto words = scan_of(model, folder / "other.csv");
  words.insert(words.end(), {"--noise-seed", "6"});
  ASSERT_EQ(panwright(words).code, 0);
  EXPECT_NE(bytes_of(folder / "other.csv"), bytes_of(folder / "1.csv"));
}

// A target that flies towards the instrument at 1 m/s: ranges of the ideal scan follow the time.
TEST(LidarCommand, FollowsAScenarioFromPulseToPulse) {
  const TemporaryFolder folder;
  folder.write("box.pxn", kPlate);
  folder.write("course.csv",
               "time[s],camera.x[m],camera.y[m],camera.z[m],camera.qw[world_from_camera],"
               "camera.qx[world_from_camera],camera.qy[world_from_camera],"
               "camera.qz[world_from_camera]\n"
               "0,0,0,-30,1,0,0,0\n10,0,0,-20,1,0,0,0\n");
  folder.write("pulses.csv", "0,0,0\n1,0,0\n2,0,0\n4,0,0\n");
  const std::string lidar =
      folder.write("lidar.toml", "[scan]\npattern = \"file\"\nfile = \"pulses.csv\"\n");
  const Outcome done =
      panwright({"lidar", folder / "course.csv", "--target", "box=" + (folder / "box.pxn"),
                 "--lidar", lidar, "--at", "1", "--ideal", "-o", folder / "scan.csv"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::istringstream table(bytes_of(folder / "scan.csv"));
  std::string line;
  std::getline(table, line);
  for (const double expected : {28.0, 27.0, 26.0, 24.0}) {
    ASSERT_TRUE(std::getline(table, line));
    std::istringstream row(line);
    std::string field;
    for (int k = 0; k < 4; ++k) std::getline(row, field, ',');
    EXPECT_NEAR(std::stod(field), expected, 1e-9) << line;
  }
}

TEST(LidarCommand, RefusesMistakes) {
  const TemporaryFolder folder;
  const std::string model = folder.write("box.pxn", kPlate);
  EXPECT_THAT(panwright(scan_of(model, folder / "a.png")).err, HasSubstr("[E0202]"));
  auto words = scan_of(model, folder / "a.csv");
  words.insert(words.end(), {"--frame", "boks"});
  EXPECT_THAT(panwright(words).err, HasSubstr("[E5011]"));
  words = scan_of(model, folder / "a.csv");
  words.insert(words.end(), {"--at", "3"});
  EXPECT_THAT(panwright(words).err, HasSubstr("--at needs a scenario"));
  words = scan_of(model, folder / "a.csv");
  words[3] = folder.write("wrong.toml", "[scan]\npattern = \"flash\"\nrows = -1\n");
  EXPECT_THAT(panwright(words).err, HasSubstr("wrong.toml:3:8"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
}

}  // namespace
}  // namespace panwright::instruments_test
