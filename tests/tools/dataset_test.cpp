// Data sets: laws against closed forms, the same bytes from any shards, crashes, damage, archives.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::dataset_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using Numbers = std::vector<double>;

std::map<std::string, std::string> tree_at(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      out[fs::relative(entry.path(), folder).string()] = contents(entry.path());
  return out;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream in(contents(file));
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

// The largest distance of an empirical distribution from one whose values are even in (0, 1).
double distance_from_even(Numbers values) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double worst = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto i = static_cast<double>(k);
    worst = std::max({worst, std::fabs(values[k] - i / n), std::fabs(values[k] - (i + 1) / n)});
  }
  return worst;
}

class Dataset : public testing::Test {
 protected:
  const TemporaryFolder folder_;

  Dataset() {
    folder_.write("box.pxn",
                  "<pangu_model ver=\"1\"><param name=\"side\" value=\"1\"/><keypoint "
                  "name=\"middle\" at=\"0 0 0\"/><box size=\"{side}\"/></pangu_model>");
  }

  std::string plan_text(const std::string& frames, const std::string& more = {},
                        const std::string& camera = {}) const {
    return "frames = " + frames + "\nseed = 5\n" + more +
           "\n[targets]\nbox = \"box.pxn\"\n[camera]\nrange = { log_uniform = [4, 40] }\n"
           "placement = 0.5\n" +
           camera +
           "[sun]\nphase = [10, 120]\n[labels]\n[view]\nsize = [40, 30]\nfov = 40\nengine = "
           "\"reference\"\nsamples = 1\n";
  }
  Outcome plan(const std::string& text, const std::string& output) const {
    return panwright({"dataset", "plan", folder_.write("plan.toml", text), "-o", folder_ / output});
  }
  Outcome act(const std::string& action, const std::string& set,
              std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"dataset", action, folder_ / set});
    return panwright(more);
  }
  void expect_same(const std::string& one, const std::string& other) const {
    const auto a = tree_at(folder_ / one), b = tree_at(folder_ / other);
    for (const auto& [name, bytes] : a)
      EXPECT_TRUE(b.contains(name) && b.at(name) == bytes) << name;
    EXPECT_EQ(a.size(), b.size());
  }
  // The columns of coverage.csv.
  std::map<std::string, Numbers> coverage(const std::string& set) const {
    const auto lines = lines_of(folder_ / (set + "/coverage.csv"));
    std::map<std::string, Numbers> out;
    std::vector<std::string> names;
    const auto cells = [](const std::string& line) {
      std::istringstream in(line);
      std::vector<std::string> all;
      for (std::string cell; std::getline(in, cell, ',');) all.push_back(cell);
      return all;
    };
    names = cells(lines[0]);
    for (std::size_t k = 1; k < lines.size(); ++k) {
      const auto values = cells(lines[k]);
      for (std::size_t i = 0; i < names.size(); ++i) out[names[i]].push_back(std::stod(values[i]));
    }
    return out;
  }
};

TEST_F(Dataset, LawsAreWhatThePlanSays) {
  const Outcome done = plan(plan_text("4000"), "set");
  ASSERT_EQ(done.code, 0) << done.err;
  auto columns = coverage("set");
  // Kolmogorov and Smirnov: 1.63 / sqrt(4000) = 0.026 at 1 %; measured 0.0075 to 0.0149
  constexpr double kMost = 0.026;
  Numbers range, phase, right, height, turn, roll;
  for (const double r : columns["range[m]"]) range.push_back(std::log(r / 4) / std::log(10));
  const double low = std::cos(10 * M_PI / 180), high = std::cos(120 * M_PI / 180);
  for (const double p : columns["phase[deg]"])
    phase.push_back((low - std::cos(p * M_PI / 180)) / (low - high));
  for (const double x : columns["place.x[px]"]) right.push_back((x - 10) / 20);
  std::size_t k = 0;
  for (const std::string& line : lines_of(folder_ / "set/frames.jsonl")) {
    const json row = json::parse(line);
    const Numbers at = row["camera"], sun = row["sun"];
    const double r = std::hypot(at[0], at[1], at[2]);
    EXPECT_NEAR(r, columns["range[m]"][k], 1e-5 * r);
    const double cosine = (at[0] * sun[0] + at[1] * sun[1] + at[2] * sun[2]) / r;
    EXPECT_NEAR(cosine, std::cos(columns["phase[deg]"][k++] * M_PI / 180), 2e-5);
    height.push_back(0.5 + 0.5 * at[2] / r);  // Archimedes: even on a sphere
    turn.push_back(0.5 + std::atan2(at[1], at[0]) / (2 * M_PI));
  }
  ASSERT_EQ(k, 4000u);
  EXPECT_LT(distance_from_even(range), kMost);
  EXPECT_LT(distance_from_even(phase), kMost);
  EXPECT_LT(distance_from_even(right), kMost);
  EXPECT_LT(distance_from_even(height), kMost);
  EXPECT_LT(distance_from_even(turn), kMost);
}

TEST_F(Dataset, OtherLawsAndFramesStayWhenOneChanges) {
  ASSERT_EQ(plan(plan_text("20"), "one").code, 0);
  ASSERT_EQ(plan(plan_text("30", "[sample]\nev = { uniform = [-1, 1] }\n"), "other").code, 0);
  const auto a = lines_of(folder_ / "one/frames.jsonl"),
             b = lines_of(folder_ / "other/frames.jsonl");
  ASSERT_EQ(a.size(), 20u);
  ASSERT_EQ(b.size(), 30u);
  for (std::size_t k = 0; k < a.size(); ++k) {
    json other = json::parse(b[k]);
    EXPECT_LE(std::fabs(other["ev"].get<double>()), 1);
    other.erase("ev");
    EXPECT_EQ(json::parse(a[k]), other);
  }
}

// Lens, attitude, placement and sizes, against the labels' own projection and areas.
TEST_F(Dataset, FramesShowWhatWasPlanned) {
  const std::string text = plan_text("24", "[lens]\nfocal = { normal = [1, 0.05] }\n",
                                     "attitude = \"random\"\npixels = [30, 1e6]\n");
  ASSERT_EQ(plan(text, "set").code, 0);
  const Outcome done = act("run", "set");
  ASSERT_EQ(done.code, 0) << done.err;
  const auto columns = coverage("set");
  for (std::size_t k = 0; k < 24; ++k) {
    const json labels =
        json::parse(contents(folder_ / fmt::format("set/frames/{:06}.labels.json", k)));
    const json& thing = labels["things"][0];
    const Numbers pixel = thing["keypoints"][0]["pixel"];
    // six digits of the table: 5e-5 measured
    EXPECT_NEAR(pixel[0], columns.at("place.x[px]")[k], 1e-4);
    EXPECT_NEAR(pixel[1], columns.at("place.y[px]")[k], 1e-4);
    const double planned = columns.at("pixels")[k];
    EXPECT_GE(planned, 30);
    // a box is convex; the labels have 64 samples a pixel: 0.26 % measured
    EXPECT_NEAR(thing["visible_pixels"].get<double>(), planned, 0.006 * planned) << k;
  }
}

TEST_F(Dataset, OneShardAndSevenMakeTheSameTree) {
  for (const char* set : {"one", "seven", "killed"}) ASSERT_EQ(plan(plan_text("20"), set).code, 0);
  const Outcome whole = act("run", "one");
  ASSERT_EQ(whole.code, 0) << whole.err;
  for (const int k : {3, 0, 6, 1, 5, 2, 4})
    ASSERT_EQ(act("run", "seven", {"--shard", fmt::format("{}/7", k), "--threads", "1"}).code, 0);
  expect_same("one", "seven");
  EXPECT_EQ(tree_at(folder_ / "one/frames").size(), 20u * 4);

  std::size_t there = 0;
  const auto count = [&] {
    there = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_ / "killed/frames", ignored))
      there += entry.path().native().ends_with(".frame.json") ? 1 : 0;
    return there;
  };
  for (const std::size_t wanted : {3u, 7u, 11u})
    EXPECT_TRUE(support::run_and_kill(
        {PANWRIGHT_BIN_DIR "/panwright", "dataset", "run", folder_ / "killed"},
        [&] { return count() >= wanted; }));
  EXPECT_GE(count(), 11u);
  const Outcome again = act("run", "killed");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr(fmt::format("{} frame", there)));
  expect_same("one", "killed");
  EXPECT_EQ(act("check", "killed").code, 0);
}

TEST_F(Dataset, DamageAndEditsAreFoundAndMadeAgain) {
  ASSERT_EQ(plan(plan_text("6"), "set").code, 0);
  ASSERT_EQ(act("run", "set").code, 0);
  const auto whole = tree_at(folder_ / "set/frames");
  std::string image = contents(folder_ / "set/frames/000001.png");
  image[image.size() / 2] ^= 1;
  folder_.write("set/frames/000001.png", image);
  fs::remove(folder_ / "set/frames/000002.masks.npz");
  fs::remove(folder_ / "set/frames/000003.frame.json");
  folder_.write("set/frames/mine.txt", "mine");
  const Outcome found = act("check", "set");
  EXPECT_EQ(found.code, 1);
  EXPECT_THAT(found.err, HasSubstr("2 frames are damaged: 000001, 000002"));
  EXPECT_THAT(found.err, HasSubstr("1 frame is missing: 000003"));
  EXPECT_THAT(found.err, HasSubstr("'mine.txt'"));
  EXPECT_THAT(found.err, HasSubstr("E8018"));
  EXPECT_NE(act("pack", "set", {"-o", folder_ / "archives"}).code, 0);
  fs::remove(folder_ / "set/frames/mine.txt");
  const Outcome again = act("run", "set");
  EXPECT_THAT(again.err, HasSubstr("3 frames kept, 3 rendered"));
  EXPECT_EQ(tree_at(folder_ / "set/frames"), whole);

  // an edit of one row makes this frame alone
  std::string rows = contents(folder_ / "set/frames.jsonl");
  const std::size_t at = rows.find("\"name\":\"000004\"");
  rows.insert(at, "\"ev\":2,");
  folder_.write("set/frames.jsonl", rows);
  EXPECT_THAT(act("check", "set").err, HasSubstr("1 frame is of another row"));
  EXPECT_THAT(act("run", "set").err, HasSubstr("5 frames kept, 1 rendered"));
  EXPECT_NE(contents(folder_ / "set/frames/000004.png"), whole.at("000004.png"));
  EXPECT_EQ(act("check", "set").code, 0);
}

// Rows hold the attitude that the camera file's mount turns, with a lens of their own too.
TEST_F(Dataset, AMountStays) {
  folder_.write("camera.toml", "size = [40, 30]\nfocal = [60, 60]\nmount = [0.8, 0.6, 0, 0]\n");
  std::string text = plan_text("3");
  text.replace(text.find("size = [40, 30]\nfov = 40\n"), 25, "camera_file = \"camera.toml\"\n");
  const Outcome plain = plan(text, "plain");
  ASSERT_EQ(plain.code, 0) << plain.err;
  const Outcome bent = plan(text + "[lens]\nfocal = { uniform = [0.9, 1.1] }\n", "bent");
  ASSERT_EQ(bent.code, 0) << bent.err;
  const auto rows = lines_of(folder_ / "plain/frames.jsonl"),
             own = lines_of(folder_ / "bent/frames.jsonl");
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(own.size(), 3u);
  ASSERT_EQ(act("run", "plain").code, 0);
  const Outcome run = act("run", "bent");
  ASSERT_EQ(run.code, 0) << run.err;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name = fmt::format("frames/{:06}.labels.json", k);
    const auto attitude = [&](const std::string& set) {
      const json frame = json::parse(contents(folder_ / (set + "/" + name)));
      const json& q = frame["camera"]["world_from_camera"];
      return Numbers{q[0], q[1], q[2], q[3]};
    };
    for (const auto& [set, row] : {std::pair("plain", rows[k]), std::pair("bent", own[k])}) {
      const json q = json::parse(row)["quat"];
      const Numbers a{q[0], q[1], q[2], q[3]};
      // row · mount, a turn about x
      const Numbers turned{0.8 * a[0] - 0.6 * a[1], 0.8 * a[1] + 0.6 * a[0],
                           0.8 * a[2] + 0.6 * a[3], 0.8 * a[3] - 0.6 * a[2]};
      const Numbers found = attitude(set);
      double same = 0;
      for (std::size_t i = 0; i < 4; ++i) same += turned[i] * found[i];
      EXPECT_NEAR(std::fabs(same), 1, 1e-12) << set << " " << k;
    }
  }
}

TEST_F(Dataset, FramesAreTakenOnce) {
  ASSERT_EQ(plan(plan_text("6"), "set").code, 0);
  const int descriptor = ::open((folder_ / "set/set.json").c_str(), O_RDWR | O_CLOEXEC);
  struct flock lock {};
  lock.l_type = F_WRLCK, lock.l_whence = SEEK_SET, lock.l_start = 2, lock.l_len = 2;
  ASSERT_EQ(::fcntl(descriptor, F_OFD_SETLK, &lock), 0);
  const Outcome twice = act("run", "set", {"--shard", "1/2"});
  EXPECT_EQ(twice.code, 1);
  EXPECT_THAT(twice.err, HasSubstr("another process renders some of the frames 3 to 5"));
  EXPECT_EQ(act("run", "set", {"--shard", "2/3"}).code, 0);
  ::close(descriptor);
  EXPECT_EQ(act("run", "set", {"--shard", "1/2"}).code, 0);
}

TEST_F(Dataset, AFullDiskLosesNothing) {
  ASSERT_EQ(plan(plan_text("4"), "set").code, 0);
  ASSERT_EQ(plan(plan_text("4"), "whole").code, 0);
  ASSERT_EQ(act("run", "whole").code, 0);
  const Outcome full =
      support::run({"bash", "-c", "trap '' XFSZ; ulimit -f 1; exec \"$0\" dataset run \"$1\"",
                    PANWRIGHT_BIN_DIR "/panwright", folder_ / "set"});
  EXPECT_EQ(full.code, 3) << full.err;
  EXPECT_THAT(full.err, HasSubstr("E0103"));
  EXPECT_EQ(act("run", "set").code, 0);
  expect_same("whole", "set");
}

TEST_F(Dataset, AnotherModelIsRefused) {
  ASSERT_EQ(plan(plan_text("3"), "set").code, 0);
  folder_.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"2\"/></pangu_model>");
  const Outcome other = act("run", "set");
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err, HasSubstr("the model of 'box' is not that of the plan"));
}

TEST_F(Dataset, ParametersOfModelsAreDrawn) {
  const std::string text = plan_text("8", "[sample]\ndefine = { side = { choice = [0.5, 1] } }\n");
  const Outcome planned = plan(text, "set");
  ASSERT_EQ(planned.code, 0) << planned.err;
  const Outcome done = act("run", "set");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(act("check", "set").code, 0);
  std::map<std::string, int> seen;
  for (const std::string& line : lines_of(folder_ / "set/frames.jsonl"))
    ++seen[json::parse(line)["define"]["side"].dump()];
  EXPECT_EQ(seen.size(), 2u);
}

TEST_F(Dataset, ArchivesAreThoseOfTar) {
  ASSERT_EQ(plan(plan_text("5"), "set").code, 0);
  ASSERT_EQ(act("run", "set").code, 0);
  for (const char* output : {"a", "b"})
    ASSERT_EQ(act("pack", "set", {"-o", folder_ / output, "--per-shard", "2"}).code, 0);
  expect_same("a", "b");
  fs::create_directory(folder_ / "out");
  std::string list;
  for (int k = 0; k < 3; ++k) {
    const Outcome tar = support::run(
        {"tar", "-C", folder_ / "out", "-xvf", folder_ / fmt::format("a/shard-{:06}.tar", k)});
    ASSERT_EQ(tar.code, 0) << tar.err;
    list += tar.out;
  }
  expect_same("set/frames", "out");
  // all files of a key stand together, as WebDataset needs them
  EXPECT_THAT(list,
              HasSubstr("000001.png\n000001.labels.json\n000001.masks.npz\n000001.frame.json\n"));
}

TEST_F(Dataset, BadPlansAreRefusedWithAPlace) {
  const auto refused = [&](const std::string& text, const std::string& words) {
    const Outcome done = plan(text, "bad");
    EXPECT_EQ(done.code, 1) << text << done.err;
    EXPECT_THAT(done.err, HasSubstr(words)) << text;
    EXPECT_THAT(done.err, HasSubstr("E8017")) << text;
    EXPECT_FALSE(fs::exists(folder_ / "bad"));
  };
  refused(plan_text("0"), "frames is 0");
  refused(plan_text("1e12"), "expected a whole number");
  refused(plan_text("3", "fames = 2"), "fames");
  refused(plan_text("3", {}, "roll = { unifrom = [0, 1] }\n"), "roll is no law");
  refused(plan_text("3", {}, "roll = { uniform = [1, 0] }\n"), "above the second");
  refused(plan_text("3", {}, "roll = { choice = [] }\n"), "no list of values");
  refused(plan_text("3", {}, "roll = { choice = [\"a\"] }\n"), "expected numbers");
  refused(plan_text("3", {}, "target = \"bax\"\n"), "no target has the name 'bax'");
  refused(plan_text("3", {}, "direction = { axis = [0, 0, 0], within = 5 }\n"), "no length");
  refused(plan_text("3", {}, "pixels = [9, 1]\n"), "above the second");
  refused(plan_text("3", "[sample]\nevv = 1\n"), "did you mean 'ev'?");
  refused(plan_text("3", "[sample]\nfov = { uniform = [1, 2] }\n"), "drawn by [camera]");
  refused(plan_text("3", {}, "pixels = [1e5, 1e6]\n"),
          "the target's pixels are out of bounds (2000 times)");
  refused(plan_text("3", "keep_out = [{ axis = [0, 0, 1], within = 180 }]\n"),
          "the camera is in a keep_out (2000 times)");
  EXPECT_THAT(plan(plan_text("3", "[sample]\nev = { choice = [[1]] }\n"), "bad").err,
              HasSubstr("ev"));
  std::string dark = plan_text("3");
  dark.erase(dark.find("[sun]"), dark.find("[labels]") - dark.find("[sun]"));
  refused(dark, "the plan has no Sun");
  EXPECT_THAT(plan(plan_text("3", "types = [\"tif\"]\n"), "bad").err, HasSubstr("E0202"));
  EXPECT_THAT(plan(plan_text("3", "[sample]\ndefine = { sied = 1 }\n"), "bad").err,
              HasSubstr("E1225"));
  EXPECT_FALSE(fs::exists(folder_ / "bad"));
  EXPECT_EQ(act("run", "none").code, 1);
  EXPECT_EQ(plan(plan_text("3"), "set").code, 0);
  EXPECT_THAT(plan(plan_text("3"), "set").err, HasSubstr("not empty"));
  for (const char* shard : {"2/2", "1", "a/b", "0/0", "-1/2", "0/2x"})
    EXPECT_EQ(act("run", "set", {"--shard", shard}).code, 2) << shard;
  folder_.write("set/frames.jsonl",
                "{\"name\":\"a\"}\n{\"name\":\"a\"}\n{\"name\":\"../b\"}\n[]\n");
  const Outcome rows = act("run", "set");
  EXPECT_EQ(rows.code, 1);
  EXPECT_THAT(rows.err, HasSubstr("two rows have the name 'a'"));
  EXPECT_THAT(rows.err, HasSubstr("row 2 has no name"));
  folder_.write("set/set.json", "{}");
  EXPECT_EQ(act("check", "set").code, 1);
}

}  // namespace
}  // namespace panwright::dataset_test
