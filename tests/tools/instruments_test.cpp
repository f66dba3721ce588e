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

// A camera that flies towards a box at 1 m/s, with a LiDAR and a RADAR beside it.
class RunInstruments : public testing::Test {
 protected:
  const TemporaryFolder folder_;

  RunInstruments() {
    folder_.write("box.pxn", kPlate);
    folder_.write("course.csv",
                  "time[s],camera.x[m],camera.y[m],camera.z[m],camera.qw[world_from_camera],"
                  "camera.qx[world_from_camera],camera.qy[world_from_camera],"
                  "camera.qz[world_from_camera]\n"
                  "0,0,0,-30,1,0,0,0\n10,0,0,-20,1,0,0,0\n");
    folder_.write("lidar.toml",
                  "[scan]\npattern = \"raster\"\ncolumns = 12\nrows = 10\nazimuth_deg = [-3, 3]\n"
                  "elevation_deg = [-3, 3]\nrate_hz = 200\n[beam]\npulse_energy_j = 1e-5\n"
                  "[noise]\nelectronics_e = 5\njitter_mm = 10\n");
    folder_.write("radar.toml",
                  "[signal]\nfrequency_hz = 10e9\nbandwidth_hz = 150e6\ndwell_s = 0.1\n"
                  "[antenna]\nbeam_deg = [20, 20]\n[receiver]\nlooks = 2\n[histogram]\n"
                  "range_m = [10, 40]\nspeed_m_s = [-2, 2]\nrays = 32\n"
                  "[surfaces.\"*\"]\nlaw = \"lambert\"\nalbedo = 0.3\n");
  }

  std::string scenario(const std::string& instruments,
                       const std::string& head = "end = 4\n") const {
    return folder_.write("run.toml",
                         head +
                             "step = 2\n[targets]\nbox = \"box.pxn\"\n"
                             "[[source]]\nfile = \"course.csv\"\n"
                             "[[source]]\nformula = \"fixed\"\nsun = [1, -1, -1]\n"
                             "[view]\nsize = [16, 12]\nfov = 20\nengine = \"reference\"\n"
                             "samples = 1\nnoise_seed = 7\n" +
                             instruments);
  }
  Outcome run(const std::string& file, const std::string& output,
              std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", file, "-o", folder_ / output});
    return panwright(more);
  }
};

TEST_F(RunInstruments, MeasureEachFrameAsTheCommandsDo) {
  const std::string file = scenario(
      "[[instrument]]\nlidar = \"lidar.toml\"\nframe = \"box\"\n"
      "[[instrument]]\nname = \"echoes\"\nradar = \"radar.toml\"\ntypes = [\"csv\", \"npz\"]\n");
  const Outcome done = run(file, "frames");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("000002.lidar.npz: "));
  for (int k = 0; k < 3; ++k) {
    const std::string stem = "frames/00000" + std::to_string(k);
    const std::vector<std::string> at = {"--at", std::to_string(2 * k), "--frame-number",
                                         std::to_string(k)};
    std::vector<std::string> lidar = {"lidar",   file,  "--lidar", folder_ / "lidar.toml",
                                      "--frame", "box", "-o",      folder_ / "alone.npz"};
    lidar.insert(lidar.end(), at.begin(), at.end());
    ASSERT_EQ(panwright(lidar).code, 0);
    EXPECT_TRUE(bytes_of(folder_ / "alone.npz") == bytes_of(folder_ / (stem + ".lidar.npz"))) << k;
    // the second instrument has other noise
    std::vector<std::string> radar = {"radar",        file, "--radar", folder_ / "radar.toml",
                                      "--noise-seed", "8",  "-o",      folder_ / "alone.csv"};
    radar.insert(radar.end(), at.begin(), at.end());
    ASSERT_EQ(panwright(radar).code, 0);
    EXPECT_TRUE(bytes_of(folder_ / "alone.csv") == bytes_of(folder_ / (stem + ".echoes.csv"))) << k;
  }
  EXPECT_NE(bytes_of(folder_ / "frames/000000.echoes.csv"),
            bytes_of(folder_ / "frames/000001.echoes.csv"));
  std::istringstream lines(bytes_of(folder_ / "frames/frames.jsonl"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["measured"],
            (nlohmann::json{"000000.lidar.npz", "000000.echoes.csv", "000000.echoes.npz"}));
}

TEST_F(RunInstruments, StandWhereTheyAreMounted) {
  folder_.write("pulses.csv", "0,0,0\n");
  folder_.write("axis.toml", "[scan]\npattern = \"file\"\nfile = \"pulses.csv\"\n");
  const std::string head = "[[instrument]]\nlidar = \"axis.toml\"\nideal = true\ntypes = \"csv\"\n";
  const Outcome done = run(
      scenario(head + "name = \"plain\"\n" + head + "name = \"before\"\nposition = [0.5, 0, 5]\n" +
               head + "name = \"back\"\nquat = [0, 0, 1, 0]\n"),
      "frames");
  ASSERT_EQ(done.code, 0) << done.err;
  const auto range_of = [&](const std::string& name) {
    std::istringstream table(bytes_of(folder_ / ("frames/000001." + name + ".csv")));
    std::string field;
    std::getline(table, field);
    for (int k = 0; k < 4; ++k)
      if (!std::getline(table, field, ',')) return 0.0;
    return std::stod(field);
  };
  EXPECT_NEAR(range_of("plain"), 27, 1e-9);
  EXPECT_NEAR(range_of("before"), 22, 1e-9);
  EXPECT_EQ(range_of("back"), 0);  // no echo
}

TEST_F(RunInstruments, DamagedFilesAreMadeAgain) {
  const std::string instruments =
      "[[instrument]]\nlidar = \"lidar.toml\"\ntypes = [\"npz\", \"pcd\", \"ply\", \"csv\", "
      "\"las\"]\n[[instrument]]\nradar = \"radar.toml\"\ntypes = [\"npz\", \"csv\", \"png\", "
      "\"exr\"]\n[labels]\n";
  const std::string file = scenario(instruments);
  ASSERT_EQ(run(file, "whole").code, 0);
  std::vector<std::string> names;
  for (const char* type : {"npz", "pcd", "ply", "csv", "las"})
    names.push_back(std::string("000001.lidar.") + type);
  for (const char* type : {"npz", "csv", "png", "exr"})
    names.push_back(std::string("000001.radar.") + type);
  ASSERT_EQ(run(file, "part").code, 0);
  EXPECT_THAT(run(file, "part", {"--resume"}).err, HasSubstr("3 frames kept"));
  for (const std::string& name : names) {
    const std::string path = folder_ / ("part/" + name);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 7);
    const Outcome again = run(file, "part", {"--resume"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr("2 frames kept")) << name;
    EXPECT_THAT(again.err, HasSubstr("1 frame not whole")) << name;
    EXPECT_TRUE(bytes_of(path) == bytes_of(folder_ / ("whole/" + name))) << name;
  }
  // labels of the folder read on
  const Outcome labels = panwright({"labels", folder_ / "part", "-o", folder_ / "coco", "--format",
                                    "coco", "--target", "box=" + (folder_ / "box.pxn")});
  EXPECT_EQ(labels.code, 0) << labels.err;
  // another instrument is another run
  folder_.write("radar.toml", bytes_of(folder_ / "radar.toml") + "# other\n");
  EXPECT_THAT(run(file, "part", {"--resume"}).err, HasSubstr("[E8014]"));
}

TEST_F(RunInstruments, MistakesAreFoundBeforeAnythingIsDrawn) {
  const auto problem = [&](const std::string& instruments, const std::string& head = "end = 4\n") {
    const Outcome done = run(scenario(instruments, head), "none");
    EXPECT_NE(done.code, 0) << instruments;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none/000000.png")) << instruments;
    return done.err;
  };
  const std::string lidar = "[[instrument]]\nlidar = \"lidar.toml\"\n";
  EXPECT_THAT(problem("[[instrument]]\n"), HasSubstr("one of lidar and radar"));
  EXPECT_THAT(problem(lidar + "radar = \"radar.toml\"\n"), HasSubstr("one of lidar and radar"));
  EXPECT_THAT(problem(lidar + "types = [\"png\"]\n"), HasSubstr("expected .npz, .pcd"));
  EXPECT_THAT(problem(lidar + lidar), HasSubstr("two instruments have the name 'lidar'"));
  EXPECT_THAT(problem(lidar + "name = \"a/b\"\n"), HasSubstr("run.toml:"));
  EXPECT_THAT(problem(lidar + "name = \"masks\"\n"), HasSubstr("a name of labels"));
  EXPECT_THAT(problem(lidar + "frame = \"boks\"\n"), HasSubstr("[E5011]"));
  EXPECT_THAT(problem(lidar + "quat = [1, 1, 0, 0]\n"), HasSubstr("quat is not of length 1"));
  EXPECT_THAT(problem("[[instrument]]\nlidar = \"none.toml\"\n"), HasSubstr("[E0101]"));
  EXPECT_THAT(problem("[[instrument]]\nradar = \"lidar.toml\"\n"), HasSubstr("[E0263]"));
  // the scan of the last frame ends after the course
  const std::string late = problem(lidar, "end = 10\n");
  EXPECT_THAT(late, HasSubstr("[E8003]"));
  EXPECT_THAT(late, HasSubstr("lidar measures for 0.595 s from the frame at 10 s"));
}

}  // namespace
}  // namespace panwright::instruments_test
