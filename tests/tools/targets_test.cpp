// Several targets, and work that is stopped, as a user sees them. The reference renderer draws, so
// that no OpenGL is needed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::targets_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

// `render` of targets with the reference, small.
Outcome traced(std::vector<std::string> words) {
  words.insert(words.begin(), "render");
  words.insert(words.end(), {"--engine", "reference", "--size", "32x24", "--samples", "2"});
  return panwright(words);
}

class Targets : public testing::Test {
 protected:
  std::string model(const std::string& name, const std::string& body) const {
    return folder_.write(name, "<pangu_model ver=\"1\">" + body + "</pangu_model>");
  }
  const TemporaryFolder folder_;
  const std::string ball_ =
      model("ball.pxn",
            "<sphere/><frame name=\"top\" translate=\"0 0 2\" forward=\"0 0 1\" "
            "up=\"0 1 0\"/>");
  const std::string box_ = model("box.pxn", "<box size=\"1\"/>");
};

TEST_F(Targets, ArePosedByNameOnTheCommandLineAndInViews) {
  const std::vector<std::string> camera = {"--camera", "0 -9 0", "--fov", "40", "--sun", "-1 -1 1"};
  std::vector<std::string> words = {ball_,    "b=" + box_,       "-o",     folder_ / "a.npz",
                                    "--pose", "b=2 0 0 1 0 0 0", "--pose", "ball=-2 0 0 1 0 0 0"};
  words.insert(words.end(), camera.begin(), camera.end());
  const Outcome one = traced(words);
  ASSERT_EQ(one.code, 0) << one.err;
  const std::string views =
      folder_.write("v.json", R"([{"pose": {"ball": [-2, 0, 0, 1, 0, 0, 0]}, "output": ")" +
                                  (folder_ / "b.npz") + R"("},
                    {"pose": {"b": "3 0 0 1 0 0 0"}, "output": ")" +
                                  (folder_ / "c.npz") + R"("},
                    {"output": ")" +
                                  (folder_ / "d.npz") + R"("}])");
  words = {ball_, "b=" + box_, "--views", views, "--pose", "b=2 0 0 1 0 0 0"};
  words.insert(words.end(), camera.begin(), camera.end());
  const Outcome many = traced(words);
  ASSERT_EQ(many.code, 0) << many.err;
  EXPECT_TRUE(contents(folder_ / "a.npz") == contents(folder_ / "b.npz"));
  EXPECT_FALSE(contents(folder_ / "a.npz") == contents(folder_ / "c.npz"));
  // a pose of one view is not there in the next
  words = {ball_, "b=" + box_, "-o", folder_ / "e.npz", "--pose", "b=2 0 0 1 0 0 0"};
  words.insert(words.end(), camera.begin(), camera.end());
  ASSERT_EQ(traced(words).code, 0);
  EXPECT_TRUE(contents(folder_ / "d.npz") == contents(folder_ / "e.npz"));
}

TEST_F(Targets, OneNeedsNoName) {
  const Outcome named = traced({ball_, "-o", folder_ / "a.npy", "--pose", "ball=1 0 0 1 0 0 0"});
  const Outcome plain = traced({ball_, "-o", folder_ / "b.npy", "--pose", "1 0 0 1 0 0 0"});
  const Outcome minus = traced({ball_, "-o", folder_ / "c.npy", "--pose", "-1 0 0 1 0 0 0"});
  EXPECT_EQ(named.code + plain.code + minus.code, 0) << named.err << plain.err << minus.err;
  EXPECT_TRUE(contents(folder_ / "a.npy") == contents(folder_ / "b.npy"));
  const Outcome framed = traced({ball_, box_, "-o", folder_ / "d.npy", "--camera-frame", "ball/top",
                                 "--fov", "60", "--pose", "box=0 0 5 1 0 0 0"});
  EXPECT_EQ(framed.code, 0) << framed.err;
}

TEST_F(Targets, WhatIsWrongIsNamed) {
  const auto says = [&](std::vector<std::string> words, const char* code, const char* part) {
    words.insert(words.end(), {"-o", folder_ / "x.png"});
    const Outcome outcome = traced(words);
    EXPECT_NE(outcome.code, 0);
    EXPECT_THAT(outcome.err, HasSubstr(code));
    EXPECT_THAT(outcome.err, HasSubstr(part));
    EXPECT_FALSE(fs::exists(folder_ / "x.png"));
  };
  says({ball_, ball_}, "[E5009]", "'ball'");
  says({ball_, box_, "--pose", "bal=0 0 0 1 0 0 0"}, "[E5011]", "ball");
  says({ball_, box_, "--pose", "0 0 0 1 0 0 0"}, "[E0201]", "NAME=");
  says({ball_, "--pose", "ball=0 0 0"}, "[E0201]", "--pose ball is '0 0 0'");
  says({ball_, "--pose", "0 0 0"}, "[E0201]", "--pose is '0 0 0', expected seven numbers");
  says({ball_, "--pose", "ball=0 0 0 1 0 0 0", "--pose", "ball=1 0 0 1 0 0 0"}, "[E0201]",
       "twice for 'ball'");
  says({ball_, box_, "--camera-frame", "top/top"}, "[E5005]", "TARGET/FRAME");
  says({ball_, folder_ / "none.pan"}, "[E0101]", "none.pan");
  const std::string views =
      folder_.write("v.json", R"([{"pose": {"cube": [0, 0, 0, 1, 0, 0, 0]}, "output": ")" +
                                  (folder_ / "y.png") + R"("}])");
  const Outcome outcome = traced({ball_, box_, "--views", views});
  EXPECT_THAT(outcome.err, HasSubstr("[E5011]"));
}

TEST_F(Targets, TheDefaultCameraSeesThemAll) {
  const Outcome outcome = traced({ball_, box_, "-o", folder_ / "a.npz", "--json", "--pose",
                                  "ball=-20 0 0 1 0 0 0", "--pose", "box=20 0 0 1 0 0 0"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json out = json::parse(outcome.out);
  EXPECT_EQ(out["warnings"], 0) << "something is in view";
  EXPECT_EQ(out["images"].size(), 1u);
}

// Stopped at any moment: whole images, or none, and the shell is told.
TEST_F(Targets, ASignalLeavesWholeImages) {
  std::string views = "[";
  for (int i = 0; i < 40; ++i)
    views += std::string(i > 0 ? "," : "") + "{\"camera\": [" + std::to_string(i) +
             ", -9, 1], \"output\": \"" + (folder_ / ("v" + std::to_string(i) + ".npy")) + "\"}";
  const std::vector<std::string> words = {PANWRIGHT_BIN_DIR "/panwright",
                                          "render",
                                          ball_,
                                          "--engine",
                                          "reference",
                                          "--size",
                                          "96x96",
                                          "--samples",
                                          "8",
                                          "--views",
                                          folder_.write("v.json", views + "]")};
  int stopped = 0;
  for (unsigned microseconds = 2000; microseconds < 1'500'000; microseconds *= 3) {
    const Outcome outcome = support::run_and_signal(words, SIGTERM, microseconds);
    if (outcome.code != 0) {
      EXPECT_EQ(outcome.code, 128 + SIGTERM);
      ++stopped;
    }
    std::size_t images = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      EXPECT_TRUE(name.ends_with(".npy") || name.ends_with(".pxn") || name == "v.json") << name;
      if (!name.ends_with(".npy")) continue;
      ++images;
      EXPECT_EQ(fs::file_size(entry.path()), 128 + 96 * 96 * 3 * 4) << name;
      fs::remove(entry.path());
    }
    if (outcome.code == 0) {
      EXPECT_EQ(images, 40u);
    }
  }
  EXPECT_GT(stopped, 2) << "the signals came too late to mean anything";
}

}  // namespace
}  // namespace panwright::targets_test
