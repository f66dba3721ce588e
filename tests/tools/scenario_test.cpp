// Scenarios as a user runs them: frames printed, rendered, and gone on with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/math.h"
#include "base/program.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::scenario_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;

class Scenarios : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  const std::string box_ = folder_.write(
      "box.pxn",
      "<pangu_model ver=\"1\"><joint name=\"lid\" type=\"revolute\" axis=\"1 0 0\" lower=\"0\" "
      "upper=\"90deg\"><box size=\"1\"/></joint></pangu_model>");
  // turned by 90 degrees about z: not its own inverse
  const std::string table_ = folder_.write(
      "way.csv",
      "time[s],camera.x[m],camera.y[m],camera.z[m],camera.qw[world_from_camera],camera.qx[world_"
      "from_camera],camera.qy[world_from_camera],camera.qz[world_from_camera],box.qw[world_from_"
      "model],box.qx[world_from_model],box.qy[world_from_model],box.qz[world_from_model],box.joint."
      "lid[deg]\n"
      "0,0,-6,0,0.70710678118654757,-0.70710678118654757,0,0,1,0,0,0,0\n"
      "10,1,-6,0,0.70710678118654757,-0.70710678118654757,0,0,"
      "0.70710678118654757,0,0,0.70710678118654757,60\n");
  const std::string scenario_ = folder_.write("run.toml",
                                              "step = 5\n[targets]\nbox = \"box.pxn\"\n"
                                              "[[source]]\nfile = \"way.csv\"\n"
                                              "[[source]]\nformula = \"fixed\"\nsun = [1, -2, 1]\n"
                                              "[view]\nsize = [24, 16]\nfov = 30\n"
                                              "engine = \"reference\"\nsamples = 2\n");

  Outcome run(const std::string& output, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"run", scenario_, "-o", folder_ / output, "--type", "npy"});
    return panwright(words);
  }
};

// Once, whatever the number of frames, and before the folder is begun.
TEST_F(Scenarios, MistakesOfLamps) {
  const Outcome done = panwright({"run", scenario_, "-o", folder_ / "lamps", "--lamp", "spt"});
  EXPECT_EQ(done.code, 2) << done.err;
  EXPECT_THAT(
      done.err,
      HasSubstr("has 'spt', expected spot, point, disc, led or the name of a lamp of a model"));
  EXPECT_EQ(done.err.find("expected spot"), done.err.rfind("expected spot")) << done.err;
  EXPECT_FALSE(fs::exists(folder_ / "lamps"));
  std::string text = contents(scenario_);
  const std::string own =
      folder_.write("own.toml", text + "lamp = [\"led on box/nowhere power 1\"]\n");
  const Outcome from_file = panwright({"run", own, "-o", folder_ / "own"});
  EXPECT_EQ(from_file.code, 1) << from_file.err;
  EXPECT_THAT(from_file.err, HasSubstr("nowhere"));
  EXPECT_EQ(from_file.err.find("nowhere"), from_file.err.rfind("nowhere")) << from_file.err;
  EXPECT_FALSE(fs::exists(folder_ / "own"));
}

TEST_F(Scenarios, FramesAreThoseOfRender) {
  const Outcome done = run("frames");
  ASSERT_EQ(done.code, 0) << done.err;
  const Outcome middle =
      panwright({"render",    "box=" + box_,
                 "-o",        folder_ / "middle.npy",
                 "--size",    "24x16",
                 "--fov",     "30",
                 "--engine",  "reference",
                 "--samples", "2",
                 "--sun",     "1 -2 1",
                 "--camera",  "0.5 -6 0",
                 "--quat",    "0.70710678118654757 -0.70710678118654757 0 0",
                 "--pose",    "box=0 0 0 0.92387953251128674 0 0 0.38268343236508978",
                 "--joint",   "lid=30deg"});
  ASSERT_EQ(middle.code, 0) << middle.err;
  EXPECT_TRUE(contents(folder_ / "frames/000001.npy") == contents(folder_ / "middle.npy"));
  EXPECT_FALSE(contents(folder_ / "frames/000000.npy") == contents(folder_ / "middle.npy"));
  EXPECT_FALSE(fs::exists(folder_ / "frames/000003.npy"));
  std::ifstream lines(folder_ / "frames/frames.jsonl");
  std::string line;
  std::vector<json> frames;
  while (std::getline(lines, line)) frames.push_back(json::parse(line));
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1]["time"], 5);
  EXPECT_EQ(frames[1]["camera"], json({0.5, -6.0, 0.0}));
  EXPECT_EQ(frames[1]["outputs"], json({"000001.npy"}));
  EXPECT_NEAR(frames[1]["poses"]["box"][6].get<double>(), 0.38268343236508978, 1e-15);
  EXPECT_NEAR(frames[2]["joints"]["box/lid"][0].get<double>(), 1.0471975511965976, 1e-15);
}

TEST_F(Scenarios, GoesOnWithWhatIsMissing) {
  ASSERT_EQ(run("whole").code, 0);
  ASSERT_EQ(run("part", {"--frames", "0..2"}).code, 0);
  fs::remove(folder_ / "part/000001.npy");
  EXPECT_THAT(run("part").err, HasSubstr("E8014"));
  const auto kept = fs::last_write_time(folder_ / "part/000000.npy");
  const Outcome again = run("part", {"--resume"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(fs::last_write_time(folder_ / "part/000000.npy"), kept);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "whole")) {
    ++files;
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(contents(entry.path().string()) == contents(folder_ / ("part/" + name))) << name;
  }
  EXPECT_EQ(files, 5u);
  // other frames, settings and models are another run
  EXPECT_THAT(run("part", {"--resume", "--every", "2"}).err, HasSubstr("frames.jsonl differs"));
  EXPECT_THAT(run("part", {"--resume", "--samples", "3"}).err, HasSubstr("run.json differs"));
  folder_.write("box.pxn",
                "<pangu_model ver=\"1\"><joint name=\"lid\" type=\"revolute\" "
                "lower=\"0\" upper=\"90deg\"><box size=\"2\"/></joint></pangu_model>");
  EXPECT_THAT(run("part", {"--resume"}).err, HasSubstr("run.json differs"));
  // files of no run are not written over
  fs::create_directories(folder_ / "own");
  folder_.write("own/000002.npy", "mine");
  EXPECT_THAT(run("own").err, HasSubstr("'000002.npy' of no run"));
  EXPECT_EQ(contents(folder_ / "own/000002.npy"), "mine");
  EXPECT_THAT(run("run.toml").err, HasSubstr("it is no folder"));
}

// The box of 1 m is 5.5 m before a camera of 12/tan(15 deg) pixels.
TEST_F(Scenarios, LabelsAreBesideTheImages) {
  const std::string labelled =
      folder_.write("labelled.toml",
                    contents(scenario_) + "[labels]\nflow = true\nparts = { lid = \"box/lid\" }\n");
  const auto labels = [&](const std::string& output, std::vector<std::string> words = {}) {
    words.insert(words.begin(), {"run", labelled, "-o", folder_ / output, "--type", "png"});
    return panwright(words);
  };
  const Outcome done = labels("whole");
  ASSERT_EQ(done.code, 0) << done.err;
  const json frame = json::parse(contents(folder_ / "whole/000000.labels.json"));
  EXPECT_EQ(frame["image"], "000000.png");
  EXPECT_EQ(frame["number"], 0);
  EXPECT_TRUE(frame["backward"].is_null());
  ASSERT_EQ(frame["things"].size(), 2u);
  EXPECT_EQ(frame["things"][0]["target"], "box");
  EXPECT_EQ(frame["things"][1]["label"], "lid");
  const double half = 12 / std::tan(kPi / 12) * 0.5 / 5.5;
  const double expected[] = {12 - half, 8 - half, 12 + half, 8 + half};
  for (const json& thing : frame["things"]) {
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(thing["amodal_box"][k].get<double>(), expected[k], 1e-6) << k;
    EXPECT_NEAR(thing["visible_pixels"].get<double>(), 4 * half * half, 1);
    EXPECT_EQ(thing["camera_from_thing"]["translation"][2].get<double>(), 6);
  }
  const json middle = json::parse(contents(folder_ / "whole/000001.labels.json"));
  EXPECT_EQ(middle["time"], 5.0);
  EXPECT_EQ(middle["forward"], "000001.forward.flo");
  EXPECT_TRUE(fs::exists(folder_ / "whole/000001.backward.flo"));
  // a frame without its labels is made again, to the same bytes
  ASSERT_EQ(labels("part").code, 0);
  fs::remove(folder_ / "part/000001.labels.json");
  fs::remove(folder_ / "part/000001.masks.npz");
  fs::remove(folder_ / "part/000000.masks.npz");
  const Outcome again = labels("part", {"--resume"});
  ASSERT_EQ(again.code, 0) << again.err;
  for (const auto& entry : fs::directory_iterator(folder_ / "whole")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(contents(entry.path().string()) == contents(folder_ / ("part/" + name))) << name;
  }
  // without flow it is another run; with an option, labels are those of targets alone
  EXPECT_THAT(run("whole", {"--resume", "--labels"}).err, HasSubstr("E8014"));
  ASSERT_EQ(run("plain", {"--labels", "--frames", "0"}).code, 0);
  const json plain = json::parse(contents(folder_ / "plain/000000.labels.json"));
  EXPECT_EQ(plain["things"].size(), 1u);
  EXPECT_EQ(plain["things"][0], frame["things"][0]);
}

TEST_F(Scenarios, MistakesInLabelsAreFoundBeforeImages) {
  const auto problem = [&](const std::string& text) {
    const std::string bad = folder_.write("bad.toml", contents(scenario_) + "[labels]\n" + text);
    const Outcome done = panwright({"run", bad, "-o", folder_ / "bad"});
    EXPECT_NE(done.code, 0);
    EXPECT_FALSE(fs::exists(folder_ / "bad/000000.png"));
    EXPECT_FALSE(fs::exists(folder_ / "bad/frames.jsonl"));
    return done.err;
  };
  EXPECT_THAT(problem("parts = { lid = \"box/root/lids\" }\n"), HasSubstr("E9005"));
  EXPECT_THAT(problem("parts = { lid = \"box/root/lids\" }\n"), HasSubstr("did you mean 'lid'?"));
  EXPECT_THAT(problem("formats = [\"cocoa\"]\n"), HasSubstr("did you mean 'coco'?"));
  EXPECT_THAT(problem("formats = 3\n"), HasSubstr("a format is a number, expected its name"));
  EXPECT_THAT(problem("parts = { lid = 3 }\n"), HasSubstr("expected the path of a node"));
  EXPECT_THAT(problem("parts = \"lid\"\n"), HasSubstr("not a table of nodes by label"));
  EXPECT_THAT(problem("keypoint_slack = 0\n"), HasSubstr("not above 0"));
  EXPECT_THAT(problem("flows = true\n"), HasSubstr("did you mean 'flow'?"));
}

TEST_F(Scenarios, FramesAreChosen) {
  const auto numbers = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"scenario", scenario_, "--json"});
    const json done = json::parse(panwright(words).out);
    std::vector<double> out;
    for (const json& frame : done["frames"]) out.push_back(frame["time"]);
    return out;
  };
  using Times = std::vector<double>;
  EXPECT_EQ(numbers({}), Times({0, 5, 10}));
  EXPECT_EQ(numbers({"--every", "2.5", "--frames", "1..3"}), Times({2.5, 5, 7.5}));
  EXPECT_EQ(numbers({"--frames", "2.."}), Times({10}));
  EXPECT_EQ(numbers({"--at", "1", "--at", "0.25"}), Times({1, 0.25}));
  for (const auto& [words, expected] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--frames", "3"}, "--frames asks for frame 3; there are 3 frames, from 0"},
           {{"--frames", "2..1"}, "expected N, N..M or N.."},
           {{"--at", "11"}, "E8003"},
           {{"--at", "soon"}, "expected seconds"},
           {{"--every", "0"}, "--every"},
           {{"--every", "1e-9"}, "more than 10000000 frames"}}) {
    std::vector<std::string> all = {"scenario", scenario_};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome done = panwright(all);
    EXPECT_NE(done.code, 0) << words.back();
    EXPECT_THAT(done.err, HasSubstr(expected));
  }
}

TEST_F(Scenarios, MistakesAreAtTheirPlaces) {
  const auto problem = [&](const std::string& text) {
    return panwright({"scenario", folder_.write("bad.toml", text)}).err;
  };
  EXPECT_THAT(problem("step = 1\n"), HasSubstr("no source"));
  EXPECT_THAT(problem("stp = 1\n[[source]]\nfile = \"way.csv\"\n"),
              HasSubstr("bad.toml:1:7: error: 'stp' is no member of a scenario"));
  EXPECT_THAT(problem("stp = 1\n"), HasSubstr("did you mean 'step'?"));
  EXPECT_THAT(problem("step = -1\n"), HasSubstr("step is not above 0"));
  EXPECT_THAT(problem("begin = 2\nend = 1\n"), HasSubstr("end is before begin"));
  EXPECT_THAT(problem("epoch = \"2026-13-01T00:00:00 UTC\"\n"), HasSubstr("bad.toml:1:9"));
  EXPECT_THAT(problem("[[source]]\nformula = \"orbit\"\n"), HasSubstr("formula is 'orbit'"));
  EXPECT_THAT(problem("[[source]]\nformula = \"spin\"\ntarget = \"a\"\nquat = [2, 0, 0, 0]\n"
                      "rate_deg_s = [1, 0, 0]\n"),
              HasSubstr("bad.toml:4:8: error: quat is not of length 1"));
  EXPECT_THAT(problem("[[source]]\nfile = \"none.csv\"\n"), HasSubstr("E0101"));
  EXPECT_THAT(problem("[[source]]\nfile = \"box.pxn\"\n"), HasSubstr("E0202"));
  EXPECT_THAT(problem("[view]\nfof = 3\n"), HasSubstr("did you mean 'fov'?"));
  const std::string fixed = "[[source]]\nformula = \"fixed\"\nsun = [1, 0, 0]\n";
  EXPECT_THAT(problem(fixed + fixed),
              HasSubstr("bad.toml:4:1: error: a source above gives the direction of the Sun"));
  // keypoints are all of them: none is chosen by a name, which no model might have
  EXPECT_THAT(problem("[labels]\nkeypoints = [\"nose\"]\n"),
              HasSubstr("bad.toml:2:13: error: 'keypoints' is no member of labels"));
  EXPECT_THAT(problem("[view]\nfov = 300\n"), HasSubstr("bad.toml:2:7: error: --fov is"));
  EXPECT_THAT(problem("[view]\nfov = [1]\n"), HasSubstr("error: 'fov' has the wrong type, exp"));
  EXPECT_THAT(problem("[view]\nlamp = 5\n"),
              HasSubstr("error: 'lamp' has the wrong type, expected a"));
  // only a run needs models
  const std::string bare = folder_.write("bare.toml", "[[source]]\nfile = \"way.csv\"\n");
  EXPECT_EQ(panwright({"scenario", bare}).code, 0);
  EXPECT_THAT(panwright({"run", bare, "-o", folder_ / "bare"}).err,
              HasSubstr("names no model of a target"));
  EXPECT_FALSE(fs::exists(folder_ / "bare"));
}

// The same scenario as TOML and as JSON: the same frames.
TEST_F(Scenarios, AreJsonToo) {
  const std::string file =
      folder_.write("run.json",
                    "{\"step\": 5, \"targets\": {\"box\": \"box.pxn\"},\n"
                    "\"source\": [{\"file\": \"way.csv\"},\n"
                    "{\"formula\": \"fixed\", \"sun\": [1, -2, 1]}],\n"
                    "\"labels\": {\"flow\": true},\n"
                    "\"view\": {\"size\": [24, 16], \"fov\": 30, \"engine\": \"reference\", "
                    "\"samples\": 2}}");
  const auto frames = [&](const std::string& path) {
    const Outcome done = panwright({"scenario", path, "--json"});
    EXPECT_EQ(done.code, 0) << done.err;
    return json::parse(done.out)["frames"];
  };
  EXPECT_EQ(frames(file), frames(scenario_));
  const Outcome done = panwright({"run", file, "-o", folder_ / "json", "--type", "npy"});
  ASSERT_EQ(done.code, 0) << done.err;
  ASSERT_EQ(run("toml").code, 0);
  EXPECT_EQ(contents(folder_ / "json/000001.npy"), contents(folder_ / "toml/000001.npy"));
  EXPECT_TRUE(fs::exists(folder_ / "json/000000.forward.flo"));
  EXPECT_THAT(panwright({"scenario", folder_.write("bad.json",
                                                   "{\"source\": [{\"file\": \"way.csv\"}],\n"
                                                   "\"stp\": 1}")})
                  .err,
              HasSubstr("bad.json:2:8: error: 'stp' is no member of a scenario"));
}

// Frames of 42 and Basilisk: positions in metres; x y z w, and Rodrigues parameters of the passive
// matrix, both as they are.
TEST_F(Scenarios, SourcesOfSimulators) {
  folder_.write("time.42", "0\n10\n");
  folder_.write("PosR.42", "1 2 3\n3 2 1\n");
  folder_.write("qbn.42", "0 0 0 1\n0 0 0.6 0.8\n");
  // the turn of qbn.42: tan(angle/4) about z, with cos(angle/2) = 0.8
  folder_.write(
      "sc.csv",
      "time[s],sigma_BN[0],sigma_BN[1],sigma_BN[2]\n0,0,0,0\n10,0,0,0.33333333333333331\n");
  const auto pose = [&](const std::string& source) {
    const std::string file =
        folder_.write("simulated.toml", "[targets]\nbox = \"box.pxn\"\n[[source]]\n" + source);
    const Outcome done = panwright({"scenario", file, "--at", "10", "--json"});
    return done.code == 0 ? json::parse(done.out)["frames"][0]["poses"]["box"]
                          : json(panwright({"scenario", file, "--at", "10"}).err);
  };
  EXPECT_EQ(pose("simulator = \"42\"\ntarget = \"box\"\ntime = \"time.42\"\n"
                 "position = \"PosR.42\"\nrotation = \"qbn.42\"\n"),
            json({3.0, 2.0, 1.0, 0.8, 0.0, 0.0, 0.6}));
  const json other = pose("simulator = \"basilisk\"\ntarget = \"box\"\nfile = \"sc.csv\"\n");
  ASSERT_EQ(other.size(), 7u) << other;
  EXPECT_NEAR(other[3].get<double>(), 0.8, 1e-15);
  EXPECT_NEAR(other[6].get<double>(), 0.6, 1e-15);
  EXPECT_THAT(pose("simulator = \"43\"\n").get<std::string>(),
              HasSubstr("simulated.toml:4:13: error: simulator is '43', expected 42 or basilisk"));
  EXPECT_THAT(pose("simulator = \"42\"\nposition = \"PosR.42\"\n").get<std::string>(),
              HasSubstr("time is missing"));
  EXPECT_THAT(pose("simulator = \"42\"\ntime = \"time.42\"\n").get<std::string>(),
              HasSubstr("42 needs position or rotation"));
  EXPECT_THAT(
      pose("simulator = \"42\"\ntime = \"none.42\"\nposition = \"PosR.42\"\n").get<std::string>(),
      HasSubstr("E0101"));
}

// Views, as a table of frames by their order: what `render --views` takes.
TEST_F(Scenarios, ViewsAreASource) {
  const std::string views = folder_.write(
      "views.jsonl",
      "{\"camera\": [0, -6, 0], \"look-at\": [0, 0, 0], \"joint\": {\"box/lid\": \"10deg\"}}\n"
      "{\"camera\": [1, -6, 0], \"look-at\": [0, 0, 0], \"joint\": {\"box/lid\": \"60deg\"}}\n");
  const std::vector<std::string> settings = {"--size",    "24x16",  "--fov",    "30",
                                             "--sun",     "1 -2 1", "--engine", "reference",
                                             "--samples", "2"};
  std::vector<std::string> words = {"run",    views, "-o",       folder_ / "of_views",
                                    "--type", "npy", "--target", "box=" + box_};
  words.insert(words.end(), settings.begin(), settings.end());
  const Outcome done = panwright(words);
  ASSERT_EQ(done.code, 0) << done.err;
  words = {"render", box_, "-o", folder_ / "one.npy", "--camera", "1 -6 0", "--joint", "lid=60deg"};
  words.insert(words.end(), settings.begin(), settings.end());
  ASSERT_EQ(panwright(words).code, 0);
  EXPECT_EQ(contents(folder_ / "of_views/000001.npy"), contents(folder_ / "one.npy"));
}

// Names that the models alone know are wrong for `scenario` as for `run`, in the same words.
TEST_F(Scenarios, JointsThatNoTargetHas) {
  std::string table = contents(table_);
  table.replace(table.find("box.joint.lid"), 13, "box.joint.lit");
  folder_.write("lit.csv", table);
  std::string text = contents(scenario_);
  text.replace(text.find("way.csv"), 7, "lit.csv");
  const std::string bad = folder_.write("lit.toml", text);
  const Outcome printed = panwright({"scenario", bad});
  const Outcome drawn = panwright({"run", bad, "-o", folder_ / "lit"});
  EXPECT_EQ(printed.code, drawn.code);
  EXPECT_THAT(printed.err, HasSubstr("unknown joint 'box/lit'"));
  EXPECT_EQ(printed.err, drawn.err);
  EXPECT_THAT(printed.out, testing::IsEmpty());
  // a trajectory alone names no models
  EXPECT_EQ(panwright({"scenario", folder_ / "lit.csv"}).code, 0);
  EXPECT_THAT(panwright({"scenario", folder_ / "lit.csv", "--target", "box=" + box_}).err,
              HasSubstr("unknown joint 'box/lit'"));
}

// Sources move by their offset, dates or not; what lies outside of them is never cut in silence.
TEST_F(Scenarios, TimesAreThoseOfTheSources) {
  folder_.write("dated.csv",
                "time[UTC],camera.x[m],camera.y[m],camera.z[m]\n"
                "2026-01-01T00:00:00,0,0,0\n2026-01-01T00:01:00,60,0,0\n");
  const auto camera = [&](const std::string& source, const std::string& time) {
    const std::string file = folder_.write(
        "offset.toml",
        "epoch = \"2026-01-01T00:00:00 UTC\"\n[[source]]\nfile = \"dated.csv\"\n" + source);
    return json::parse(
               panwright({"scenario", file, "--at", time, "--json"}).out)["frames"][0]["camera"][0]
        .get<double>();
  };
  EXPECT_EQ(camera("", "30"), 30);
  EXPECT_EQ(camera("offset = 10\n", "30"), 20);
  EXPECT_EQ(camera("offset = -20\n", "30"), 50);
  for (const char* bounds : {"end = 11\n", "begin = -1\n", "begin = 20\nend = 30\n"}) {
    const std::string text = contents(scenario_);
    const Outcome done = panwright({"scenario", folder_.write("cut.toml", bounds + text)});
    EXPECT_THAT(done.err, HasSubstr("the sources cover 0 s to 10 s")) << bounds;
    EXPECT_THAT(done.err, AllOf(HasSubstr("cut.toml:1:"), HasSubstr("E8003")));
  }
  const std::string falls = folder_.write(
      "falls.toml",
      "[targets]\nbox = \"box.pxn\"\n[[source]]\nformula = \"two_body\"\ntarget = \"box\"\n"
      "position = [7e6, 0, 0]\nvelocity = [0, 0, 0]\n");
  EXPECT_THAT(panwright({"scenario", falls}).err,
              AllOf(HasSubstr("falls.toml:3:"), HasSubstr("E8003")));
  EXPECT_THAT(panwright({"scenario", scenario_, "--frames", "1..3"}).err,
              HasSubstr("asks for frame 3"));
}

TEST_F(Scenarios, NamesOfTargetsAreChecked) {
  const auto problem = [&](const std::string& text) {
    return panwright(
               {"scenario", folder_.write("names.toml", "[targets]\nbox = \"box.pxn\"\n" + text)})
        .err;
  };
  EXPECT_THAT(problem("[[source]]\nformula = \"fixed\"\ntarget = \"bx\"\n"),
              HasSubstr("names.toml:5:10: error: no target has the name 'bx'"));
  EXPECT_THAT(problem("[look_at]\ntarget = \"bax\"\n[[source]]\nfile = \"way.csv\"\n"),
              HasSubstr("did you mean 'box'?"));
  // members of another kind of source
  EXPECT_THAT(problem("[[source]]\nformula = \"fixed\"\nvelocity = [1, 0, 0]\n"),
              HasSubstr("'velocity' is no member of a source"));
  EXPECT_THAT(problem("[[source]]\nfile = \"way.csv\"\nobjects = {}\n"),
              HasSubstr("'objects' is no member of a source"));
  // files that only a run reads
  EXPECT_THAT(panwright({"scenario", folder_.write("none.toml",
                                                   "[targets]\nbox = \"none.pan\"\n"
                                                   "[[source]]\nfile = \"way.csv\"\n")})
                  .err,
              HasSubstr("E0101"));
}

TEST_F(Scenarios, CourseIsDrawn) {
  const std::string svg = folder_ / "course.svg";
  const Outcome done = panwright({"scenario", scenario_, "--plot", svg});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("3 frames, 0 s to 10 s"));
  EXPECT_THAT(done.out, HasSubstr("the rotation of target 'box'"));
  EXPECT_THAT(contents(svg), HasSubstr("Range"));
  EXPECT_THAT(contents(svg), HasSubstr("Phase angle"));
  // at first the front of a cube of 1 m, 5.5 m away: (24/2/tan(15 deg)/5.5)² = 66.30 pixels; turned
  // it covers more
  EXPECT_THAT(contents(svg), HasSubstr("Convex outline"));
  EXPECT_THAT(contents(svg), HasSubstr("Share in the image"));
  EXPECT_THAT(contents(svg), testing::Not(HasSubstr("Share of the Sun")));
  EXPECT_THAT(done.out, HasSubstr("    66.3 to "));
  EXPECT_THAT(done.out, HasSubstr("pixels; in the image in 3 of 3 frames"));
}

// A camera that looks past the box, and one that has it at half of its edge; a planet before the
// Sun.
TEST_F(Scenarios, CourseHasTheImageAndEclipses) {
  const std::string file = folder_.write(
      "past.toml",
      "begin = 0\nend = 2\nstep = 1\n[targets]\nbox = \"box.pxn\"\n"
      "[[source]]\nfile = \"past.csv\"\n[[source]]\nformula = \"fixed\"\nsun = [0, 0, 1]\n"
      "[view]\nsize = [24, 16]\northo = 4\nplanet = { rock = \"0 0 9km radius=1km\" }\n");
  // the boresight is +y and x stays right: the image spans 2 m to either side
  folder_.write(
      "past.csv",
      "time[s],camera.x[m],camera.y[m],camera.z[m],camera.qw[world_from_camera],camera.qx["
      "world_from_camera],camera.qy[world_from_camera],camera.qz[world_from_camera],box.x["
      "m],box.y[m],box.z[m]\n"
      "0,0,-6,0,0.70710678118654757,-0.70710678118654757,0,0,0,0,0\n"
      "1,2,-6,0,0.70710678118654757,-0.70710678118654757,0,0,0,0,0\n"
      "2,5,-6,0,0.70710678118654757,-0.70710678118654757,0,0,0,0,0\n");
  const Outcome done = panwright({"scenario", file, "--plot", folder_ / "past.svg"});
  ASSERT_EQ(done.code, 0) << done.err;
  // 1 m is 6 pixels; half of the second frame's box is in the image, none of the third's
  EXPECT_THAT(done.out,
              HasSubstr("    0 to 36 pixels; in the image in 2 of 3 frames; 0 to 0 of the Sun"));
}

// A lens from a file: the record has its numbers, so that the image is made again without it.
TEST_F(Scenarios, CameraFilesWithDistortion) {
  const std::string camera =
      folder_.write("camera.toml",
                    "size = [24, 16]\nfocal = 30\ndistortion = \"brown\"\ncoefficients = [-0.2]\n");
  const std::string image = folder_ / "a.exr", again = folder_ / "b.exr";
  const std::vector<std::string> words = {"render",        box_,   "-o",       image,
                                          "--camera-file", camera, "--camera", "0 -4 0"};
  EXPECT_EQ(panwright(words).code, 0);
  std::vector<std::string> traced = words;
  traced.insert(traced.end(), {"--engine", "reference", "--samples", "2"});
  const Outcome first = panwright(traced);
  ASSERT_EQ(first.code, 0) << first.err;
  fs::remove(camera);
  const Outcome second = panwright({"render", "--again", image, "-o", again});
  ASSERT_EQ(second.code, 0) << second.err;
  EXPECT_TRUE(contents(image) == contents(again));
  // a pupil that moves, once for all views
  const std::string moving = folder_.write("moving.toml",
                                           "size = 24\nfocal = 30\ndistortion = \"cahvore\"\n"
                                           "r = [0, 0, 0]\ne = [0.01, 0, 0]\n");
  const Outcome refused =
      panwright({"render", box_, "-o", image, "--camera-file", moving, "--camera", "0 -4 0"});
  EXPECT_NE(refused.code, 0);
  EXPECT_THAT(refused.err, HasSubstr("requires --engine reference"));
  EXPECT_THAT(panwright({"render", box_, "-o", image, "--engine", "reference", "--distortion",
                         "brown -0.2"})
                  .err,
              HasSubstr("expected --intrinsics beside it"));
  EXPECT_THAT(panwright({"render", box_, "-o", image, "--camera-file", camera, "--fov", "3"}).err,
              HasSubstr("--camera-file cannot be combined"));
}

// The contact sheet and the video are of all frames, those kept from before included.
TEST_F(Scenarios, SheetAndVideo) {
  const auto run_png = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"run", scenario_, "-o", folder_ / "frames"});
    return panwright(words);
  };
  const std::string sheet = folder_ / "frames/sheet.png", video = folder_ / "video.png";
  Outcome done = run_png({"--sheet", sheet, "--video", video});  // the folder is new
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("sheet.png"));
  const std::string first = contents(video), small = contents(sheet);
  // 3 frames, as the number after acTL says
  EXPECT_EQ(first.substr(first.find("acTL") + 4, 4), std::string("\0\0\0\3", 4));
  fs::remove(folder_ / "frames/000001.png");
  done = run_png({"--resume", "--sheet", sheet, "--video", video});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(contents(video), first);
  EXPECT_EQ(contents(sheet), small);

  if (!find_program("ffprobe").empty()) {
    const std::string joined = folder_ / "video.mp4";
    done = run_png({"--resume", "--video", joined});
    ASSERT_EQ(done.code, 0) << done.err;
    const Outcome probed =
        support::run({find_program("ffprobe"), "-v", "error", "-count_frames", "-show_entries",
                      "stream=nb_read_frames,r_frame_rate", "-of", "csv", joined});
    EXPECT_THAT(probed.out, HasSubstr("stream,25/1,3"));
  }

  // mistakes are found before a frame is drawn
  for (const auto& [words, expected] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--sheet", folder_ / "sheet.jpg"}, "expected a .png file"},
           {{"--video", folder_ / "video.wmv"}, "expected .png or .mp4"},
           {{"--video", video, "--type", "npy"}, "expected --type png"},
           {{"--sheet", video, "--video", video}, "E0206"},
           {{"--sheet", box_ + ".png", "--video", folder_ / "new/000001.png"}, "E0206"}}) {
    std::vector<std::string> all{"run", scenario_, "-o", folder_ / "new"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome bad = panwright(all);
    EXPECT_NE(bad.code, 0) << words[1];
    EXPECT_THAT(bad.err, HasSubstr(expected));
    EXPECT_FALSE(fs::exists(folder_ / "new/000000.png"));
  }
}

}  // namespace
}  // namespace panwright::scenario_command_test
