// `panwright joints`, and joint values on other commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::joints_test {
namespace {

using nlohmann::json;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

// A door of 2 x 1 m on a hinge at the origin, a knob that follows, a post in its way.
constexpr const char* kDoor =
    "<pangu_model ver='1'><joint name='hinge' type='revolute' lower='0' upper='90' pointing='1 0 "
    "0'>"
    "<box name='door' size='2 0.02 1' translate='1 0 0'/><keypoint name='edge' at='2 0 0'/>"
    "<joint name='knob' type='continuous' axis='0 1 0' mimic='hinge' multiplier='2' "
    "translate='1.8 0 0'><box size='0.1'/></joint></joint>"
    "<box name='post' size='0.05 0.05 1' translate='0.7 1.2124 0'/></pangu_model>";

TEST(JointsCommand, ListsAndPlaces) {
  TemporaryFolder folder;
  const std::string file = folder.write("door.pxn", kDoor);
  const Outcome text = panwright({"joints", file, "--joint", "hinge=30deg"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_EQ(text.out,
            "hinge  revolute about 0 0 1, at 30 deg, 0 deg to 90 deg, points 1 0 0\n"
            "  knob  continuous about 0 1 0, at 60 deg, follows hinge times 2\n");
  const Outcome out = panwright({"joints", file, "--joint", "hinge=30deg", "--json"});
  const json result = json::parse(out.out);
  ASSERT_EQ(result["joints"].size(), 2u);
  EXPECT_EQ(result["joints"][1]["mimic"], "hinge");
  EXPECT_NEAR(result["joints"][1]["value"][0].get<double>(), std::acos(-1.0) / 3, 1e-15);
  for (const json& node : result["nodes"]) {
    if (node["name"] != "root/hinge/door") continue;
    // row-major: the centre of the door, 1 m out at 30 degrees
    EXPECT_NEAR(node["world_pose"][0][3].get<double>(), std::sqrt(0.75), 1e-15);
    EXPECT_NEAR(node["world_pose"][1][3].get<double>(), 0.5, 1e-15);
    EXPECT_EQ(node["world_pose"][3], json::parse("[0.0,0.0,0.0,1.0]"));
  }
  const Outcome info = panwright({"info", file, "--joint", "hinge=90deg", "--json"});
  EXPECT_NEAR(json::parse(info.out)["keypoints"][0]["world"][1].get<double>(), 2, 1e-15);
}

TEST(JointsCommand, ExportsWhatIsPosed) {
  TemporaryFolder folder;
  const std::string file = folder.write("door.pxn", kDoor);
  for (const char* more : {"--quiet", "--articulations"}) {
    const std::string glb = folder / "door.glb";
    ASSERT_EQ(panwright({"export", file, "-o", glb, "--joint", "hinge=60", more}).code, 0);
    const Outcome info = panwright({"info", glb, "--json"});
    const json keypoints = json::parse(info.out)["keypoints"];
    ASSERT_EQ(keypoints.size(), 1u) << info.out;
    EXPECT_EQ(keypoints[0]["name"], "edge");
    EXPECT_NEAR(keypoints[0]["world"][0].get<double>(), 1, 1e-12);
    EXPECT_NEAR(keypoints[0]["world"][1].get<double>(), std::sqrt(3.0), 1e-12);
  }
}

TEST(JointsCommand, SweepsAndAims) {
  TemporaryFolder folder;
  const std::string file = folder.write("door.pxn", kDoor);
  const Outcome sweep = panwright({"joints", file, "--sweep", "--steps", "91", "--json"});
  const json found = json::parse(sweep.out)["sweep"];
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found[0]["collisions"].size(), 1u);
  EXPECT_EQ(found[0]["collisions"][0]["a"], "root/hinge/door");
  EXPECT_EQ(found[0]["collisions"][0]["b"], "root/post");
  // half a door and half a post are 0.035/1.4 rad or less
  EXPECT_NEAR(found[0]["collisions"][0]["first"].get<double>(), std::acos(-1.0) / 3, 0.04);
  const Outcome aim = panwright({"joints", file, "--joint", "hinge=@1 1 5", "--json"});
  EXPECT_NEAR(json::parse(aim.out)["joints"][0]["value"][0].get<double>(), std::acos(-1.0) / 4,
              1e-15);
  const Outcome blind = panwright({"joints", file, "--joint", "hinge=@sun"});
  EXPECT_EQ(blind.code, 2);
  EXPECT_THAT(blind.err, HasSubstr("needs the direction: --sun"));
}

// A file of joints, options over it, and the same image from its record.
TEST(JointsCommand, ImagesAreMadeAgain) {
  TemporaryFolder folder;
  const std::string file = folder.write("door.pxn", kDoor);
  const std::string joints = folder.write("j.json", "{\"hinge\": 10}");
  const auto render = [&](std::vector<std::string> more, const std::string& output) {
    std::vector<std::string> words{"render",    file,    "-o",       output,
                                   "--size",    "40x30", "--engine", "reference",
                                   "--samples", "2",     "--camera", "1 -6 2"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome out = panwright(words);
    EXPECT_EQ(out.code, 0) << out.err;
    DiagnosticLog log;
    const auto bytes = read_file(output, 1u << 24, log);
    return bytes ? *bytes : std::string();
  };
  const std::string rest = render({}, folder / "rest.npy");
  const std::string posed = render({"--joints", joints, "--joint", "hinge=70"}, folder / "a.npy");
  EXPECT_NE(posed, rest);
  EXPECT_EQ(render({"--joint", "hinge=70deg"}, folder / "b.npy"), posed);
  (void)render({"--joint", "hinge=70deg"}, folder / "c.png");
  const std::string image = folder / "c.png", again = folder / "d.png";
  ASSERT_EQ(panwright({"render", "--again", image, "-o", again}).code, 0);
  DiagnosticLog log;
  EXPECT_EQ(*read_file(again, 1u << 24, log), *read_file(image, 1u << 24, log));
  const Outcome bad = panwright(
      {"render", file, "-o", folder / "e.npy", "--joints", folder.write("bad.json", "[1]")});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("E0203"));
}

// A budget decides what is in the image: its record keeps it, and two budgets are two builds.
TEST(BudgetOption, ImagesAreMadeAgain) {
  TemporaryFolder folder;
  const std::string file =
      folder.write("ball.pxn", "<pangu_model ver=\"1\"><sphere radius=\"1\"/></pangu_model>\n");
  const auto render = [&](std::vector<std::string> more, const std::string& output) {
    std::vector<std::string> words{"render", "-o", output};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome out = panwright(words);
    EXPECT_EQ(out.code, 0) << out.err;
    EXPECT_THAT(out.err, testing::Not(HasSubstr("warning"))) << out.err;
    DiagnosticLog log;
    const auto bytes = read_file(output, 1u << 24, log);
    return bytes ? *bytes : std::string();
  };
  const std::vector<std::string> view = {file,        "--size", "40x30",    "--engine", "reference",
                                         "--samples", "2",      "--camera", "1 -6 2"};
  const auto with = [&](const std::string& budget) {
    std::vector<std::string> words = view;
    words.insert(words.end(), {"--budget", budget});
    return words;
  };
  const std::string coarse = render(with("tolerance=0.1"), folder / "coarse.png");
  EXPECT_FALSE(coarse == render(with("tolerance=1mm"), folder / "fine.png"));
  EXPECT_TRUE(coarse == render({"--again", folder / "coarse.png"}, folder / "again.png"));
  const auto id = [&](const std::string& budget) {
    const Outcome out = panwright({"info", file, "--budget", budget, "--json"});
    EXPECT_EQ(out.code, 0) << out.err;
    const std::size_t at = out.out.find("build_id");
    return at == std::string::npos ? "" : out.out.substr(at, 60);
  };
  EXPECT_NE(id("tolerance=0.1"), "");
  EXPECT_NE(id("tolerance=0.1"), id("tolerance=0.2"));
}

}  // namespace
}  // namespace panwright::joints_test
