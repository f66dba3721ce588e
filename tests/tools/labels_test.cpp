// Labels beside the images of `render`, and of the part of a camera that is read out.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "image/arrays.h"
#include "tests/support/process.h"

namespace panwright::tool_labels_test {
namespace {

using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

class ToolLabels : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  const std::string box_ = folder_.write(
      "box.pxn",
      "<pangu_model ver=\"1\"><keypoint name=\"tip\" at=\"0.5 -0.5 0.5\"/><node name=\"top\" "
      "label=\"lid\" translate=\"0 0 1\"><box size=\"0.5\"/></node><box "
      "size=\"1\"/></pangu_model>");

  std::vector<std::string> render(const std::string& output, std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"render", box_, "-o", folder_ / output, "--camera", "1 -6 2", "--sun", "1 -2 1",
                 "--engine", "reference", "--samples", "1", "--labels"});
    return more;
  }
  json labels(const std::string& name) const {
    return json::parse(contents(folder_ / (name + ".labels.json")));
  }
};

TEST_F(ToolLabels, OfAViewAreThoseOfARun) {
  const Outcome done = panwright(render("000000.png", {"--size", "64x48", "--fov", "30"}));
  ASSERT_EQ(done.code, 0) << done.err;
  const json frame = labels("000000");
  EXPECT_EQ(frame["image"], "000000.png");
  ASSERT_EQ(frame["things"].size(), 2u);
  EXPECT_EQ(frame["things"][1]["label"], "lid");
  const std::string scenario =
      folder_.write("run.toml",
                    "begin = 0\nend = 0\nstep = 1\n[targets]\nbox = \"box.pxn\"\n[[source]]\n"
                    "formula = \"fixed\"\nposition = [1, -6, 2]\nsun = [1, -2, 1]\n[view]\n"
                    "look_at = [0, 0, 0]\nsize = [64, 48]\nfov = 30\nengine = \"reference\"\n"
                    "samples = 1\n[labels]\n");
  const Outcome run = panwright({"run", scenario, "-o", folder_ / "frames"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* file : {"000000.labels.json", "000000.masks.npz"})
    EXPECT_TRUE(contents(folder_ / file) == contents(folder_ / (std::string("frames/") + file)))
        << file;
  const Outcome coco =
      panwright({"labels", folder_ / "frames", "-o", folder_ / "coco", "--format", "coco"});
  EXPECT_EQ(coco.code, 0) << coco.err;
}

TEST_F(ToolLabels, OfViewsHaveTheirNames) {
  const std::string views = folder_.write(
      "views.json",
      fmt::format(
          "[{{\"output\": \"{0}/a.png\"}}, {{\"output\": \"{0}/b.png\", \"camera\": [0, -9, "
          "0]}}]",
          folder_.path().string()));
  const Outcome done = panwright({"render", box_, "--views", views, "--labels", "--engine",
                                  "reference", "--samples", "1", "--size", "32"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(labels("a")["number"], 0);
  EXPECT_EQ(labels("b")["number"], 1);
  EXPECT_NE(labels("a")["things"], labels("b")["things"]);
  // two images of one name would have the same labels
  const std::string same = folder_.write(
      "same.json", fmt::format("[{{\"output\": \"{0}/a.png\"}}, {{\"output\": \"{0}/a.npz\"}}]",
                               folder_.path().string()));
  const Outcome twice = panwright({"render", box_, "--views", same, "--labels", "--engine",
                                   "reference", "--samples", "1", "--size", "32"});
  EXPECT_NE(twice.code, 0);
  EXPECT_THAT(twice.err, HasSubstr("E0206"));
  const Outcome stream = panwright({"render", box_, "--views", "-", "--labels"});
  EXPECT_THAT(stream.err, HasSubstr("--labels cannot be combined with --views -"));
}

// The region of a camera file sees a part of the same image.
TEST_F(ToolLabels, OfARegionAreCutOutOfTheWhole) {
  const std::string lens =
      "size = [64, 48]\nfocal = [120, 120]\ndistortion = \"brown\"\ncoefficients = [-0.2, 0.1]\n";
  constexpr int kLeft = 30, kTop = 12, kWidth = 24, kHeight = 20;
  const std::string whole = folder_.write("whole.toml", lens);
  const std::string part = folder_.write(
      "part.toml", lens + fmt::format("region = [{}, {}, {}, {}]\n", kLeft, kTop, kWidth, kHeight));
  ASSERT_EQ(panwright(render("whole.png", {"--camera-file", whole})).code, 0);
  const Outcome done = panwright(render("part.png", {"--camera-file", part}));
  ASSERT_EQ(done.code, 0) << done.err;
  const json all = labels("whole")["things"][0], cut = labels("part")["things"][0];
  EXPECT_EQ(all["camera_from_thing"], cut["camera_from_thing"]);
  const double shift[] = {kLeft, kTop};
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(cut["amodal_box"][k].get<double>(),
                all["amodal_box"][k].get<double>() - shift[k % 2], 1e-9);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(cut["keypoints"][0]["pixel"][k].get<double>(),
                all["keypoints"][0]["pixel"][k].get<double>() - shift[k], 1e-9);
  // each pixel of the part has the coverage of the whole
  const auto mask = [&](const std::string& name, const json& thing, int x, int y) {
    DiagnosticLog log;
    const auto arrays = image::read_arrays(folder_ / (name + ".masks.npz"), {}, 1 << 20, log);
    const json& place = thing["visible"];
    const int i = x - place["left"].get<int>(), j = y - place["top"].get<int>();
    const int width = place["width"], height = place["height"];
    if (!arrays || i < 0 || j < 0 || i >= width || j >= height) return 0;
    for (const auto& each : *arrays)
      if (each.name == thing["id"].dump() + ".visible")
        return std::to_integer<int>(each.data[static_cast<std::size_t>(j * width + i)]);
    return 0;
  };
  int covered = 0, different = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int a = mask("part", cut, x, y), b = mask("whole", all, x + kLeft, y + kTop);
      covered += a > 0;
      different += std::abs(a - b) > 4;  // of 255: a sample of 64 at an edge
    }
  EXPECT_GT(covered, 50);
  EXPECT_EQ(different, 0);
}

TEST_F(ToolLabels, WithoutKeypointsHaveNoPoses) {
  folder_.write("plain.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  std::filesystem::create_directory(folder_ / "set");
  const Outcome done =
      panwright({"render", folder_ / "plain.pxn", "-o", folder_ / "set/a.png", "--labels",
                 "--engine", "reference", "--samples", "1", "--size", "32"});
  ASSERT_EQ(done.code, 0) << done.err;
  const Outcome yolo =
      panwright({"labels", folder_ / "set", "-o", folder_ / "yolo", "--format", "yolo-pose"});
  EXPECT_EQ(yolo.code, 0) << yolo.err;
  EXPECT_THAT(yolo.err, HasSubstr("W9002"));
  EXPECT_THAT(yolo.err, HasSubstr("no model has keypoints"));
}

}  // namespace
}  // namespace panwright::tool_labels_test
