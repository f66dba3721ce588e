// No output destroys an input or another output; no stream that is closed or full ends the program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "image/png.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::outputs_test {
namespace {

namespace fs = std::filesystem;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

const std::string kProgram = PANWRIGHT_BIN_DIR "/panwright";

// The program below a shell; "$P" stands for it.
Outcome shell(const std::string& script) {
  return support::run({"/bin/sh", "-c", script}, {"P=" + kProgram});
}

class Outputs : public testing::Test {
 protected:
  void SetUp() override {
    part_ = folder_.write("part.pxn", R"(<pangu_model ver="1">
  <sphere radius="1"/>
</pangu_model>
)");
    model_ = folder_.write("model.pxn", R"(<pangu_model ver="1">
  <include file="part.pxn"/>
</pangu_model>
)");
    std::vector<std::uint8_t> texels(4 * 4 * 4, 200);
    folder_.write("panel.png", image::png_file(4, 4, texels));
    panel_ = folder_.write("panel.pxn", R"(<pangu_model ver="1">
  <material name="m" preset="white_z93" albedo_map="panel.png"/>
  <box size="1 1 1" material="m"/>
</pangu_model>
)");
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      before_[entry.path()] = contents(entry.path());
  }

  // Refused with E0206, and the folder is as it was.
  void refuses(const std::vector<std::string>& words, const std::string& says) {
    SCOPED_TRACE(testing::PrintToString(words));
    // in the folder, where outputs go that are not named
    std::vector<std::string> there{"/bin/sh", "-c", "cd \"$0\" && exec \"$@\"",
                                   folder_.path().string(), kProgram};
    there.insert(there.end(), words.begin(), words.end());
    const Outcome outcome = support::run(there);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("[E0206]"));
    EXPECT_THAT(outcome.err, HasSubstr(says));
    std::map<fs::path, std::string> after;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      after[entry.path()] = contents(entry.path());
    EXPECT_EQ(after, before_);
  }

  const TemporaryFolder folder_;
  std::string part_, model_, panel_;
  std::map<fs::path, std::string> before_;
};

TEST_F(Outputs, LeaveInputsWhole) {
  refuses({"check", model_, "--sarif", model_}, "--sarif");
  refuses({"check", model_, "--sarif", part_}, "--sarif");
  refuses({"expand", model_, "-o", part_}, "-o");
  refuses({"expand", model_, "-o", model_}, "-o");
  refuses({"compile", model_, "-o", folder_ / "a.pan", "-M", part_}, "--depfile");
  refuses({"compile", model_, "-o", folder_ / "a.pan", "-M", model_}, "--depfile");
  refuses({"render", panel_, "--size", "8x8"}, "panel.png");
}

// Files that a model names and that nobody reads.
TEST_F(Outputs, LeaveWhatIsNamedAndNotUsed) {
  const auto add = [&](const std::string& name, const std::string& text) {
    before_[folder_.path() / name] = text;
    return folder_.write(name, text);
  };
  add("used.png", contents(folder_ / "panel.png"));
  for (const char* name : {"m.png", "bump.png", "glow.png", "inner.png"}) add(name, "not an image");
  add("m.mtl", "newmtl a\nKd 1 1 1\nmap_Ks m.png\nmap_bump -bm 2 bump.png\n");
  const std::string obj =
      add("m.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::vector<std::string> small = {"--size", "8x8", "--units", "m"};
  const auto render = [&](const std::string& model, const std::string& image) {
    std::vector<std::string> words = {"render", model, "-o", folder_ / image};
    words.insert(words.end(), small.begin(), small.end());
    refuses(words, image);
  };
  refuses({"render", obj, "--size", "8x8", "--units", "m"}, "m.png");  // the default output
  render(obj, "bump.png");
  const std::string wrl =
      add("s.wrl",
          "#VRML V2.0 utf8\nShape { geometry Box {} }\nSwitch { choice [ Shape { appearance "
          "Appearance { texture ImageTexture { url \"inner.png\" } } geometry Box {} } ] }\n");
  render(wrl, "inner.png");
  const std::string gltf = add(
      "g.gltf",
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"images":[{"uri":"glow.png"}],)"
      R"("textures":[{"source":0}],"materials":[{"occlusionTexture":{"index":0}}],"meshes":[{"primitives":[)"
      R"({"attributes":{"POSITION":0},"material":0}]}],"accessors":[{"bufferView":0,"componentType":5126,)"
      R"("count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
      R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  render(gltf, "glow.png");
  refuses({"fmt", "--check", panel_, "--sarif", folder_ / "panel.png"}, "--sarif");
  refuses({"check", wrl, "--units", "m", "--sarif", folder_ / "inner.png"}, "--sarif");
  // what no model names may be written
  EXPECT_EQ(
      panwright({"render", obj, "--size", "8x8", "--units", "m", "-o", folder_ / "new.png"}).code,
      0);
}

// A pan knows what it was made of.
TEST_F(Outputs, LeaveWhatAPanWasMadeOf) {
  ASSERT_EQ(panwright({"compile", panel_, "-o", folder_ / "panel.pan"}).code, 0);
  before_[folder_ / "panel.pan"] = contents(folder_ / "panel.pan");
  refuses({"render", folder_ / "panel.pan", "--size", "8x8"}, "panel.png");
}

TEST_F(Outputs, AreDifferentFiles) {
  refuses({"compile", model_, "-o", folder_ / "a.pan", "-M", folder_ / "./a.pan"}, "one file");
  refuses({"compile", model_, "-o", folder_ / "a.pan", "--sarif", folder_ / "a.pan"}, "one file");
  const std::string relay = PANWRIGHT_SOURCE_DIR "/examples/cad/relay.wrl";
  refuses({"import", relay, "-o", folder_ / "y.pan", "--report", folder_ / "y.pan"}, "one file");
  const TemporaryFolder elsewhere;
  const std::string views = elsewhere.write(
      "views.json", R"([{"output": ")" + (folder_ / "v.png") + R"("}, {"output": ")" +
                        (elsewhere / "here/v.png") + R"("}])");
  fs::create_directory_symlink(folder_.path(), elsewhere / "here");
  refuses({"render", model_, "--views", views, "--size", "8x8"}, "one file");
}

// A link that leads nowhere yet leads to the other output.
TEST_F(Outputs, AreDifferentFilesBehindLinks) {
  fs::create_symlink("a.pan", folder_ / "rule.d");
  before_[folder_ / "rule.d"] = "";
  refuses({"compile", model_, "-o", folder_ / "a.pan", "-M", folder_ / "rule.d"}, "one file");
  refuses({"compile", model_, "-o", folder_ / "a.pan", "--sarif", folder_ / "rule.d"}, "one file");
}

// A full disk: nothing that is half made stays.
TEST_F(Outputs, NewLeavesNothingHalfMade) {
  const std::string folder = folder_ / "models/probe";
  const Outcome full = shell("ulimit -f 1; \"$P\" new " + folder);
  EXPECT_EQ(full.code, 3);
  EXPECT_THAT(full.err, HasSubstr("E0103"));
  EXPECT_FALSE(fs::exists(folder_ / "models"));
  EXPECT_EQ(panwright({"new", folder}).code, 0);
}

// Disks of their own, each four times as large as the one before: all or nothing is made.
TEST_F(Outputs, NewLeavesNothingOnAFullDisk) {
  fs::create_directory(folder_ / "disk");
  bool failed = false, made = false;
  for (int pages = 1; pages <= 4096 && !made; pages *= 4) {
    SCOPED_TRACE(pages);
    const auto ran = support::run_on_disk(
        folder_ / "disk", static_cast<unsigned>(4 * pages),
        "\"$0\" new \"$1/a/probe\"; code=$?; find \"$1\" -mindepth 1; exit $code",
        {kProgram, folder_ / "disk"});
    if (!ran) GTEST_SKIP() << "no mounts without privilege here";
    const Outcome& out = *ran;
    made = out.code == 0;
    failed = failed || out.code == 3;
    if (made) {
      EXPECT_THAT(out.out, HasSubstr("a/probe/probe.pxn"));
      EXPECT_THAT(out.out, HasSubstr("a/probe/pxn.xsd"));
    } else {
      EXPECT_EQ(out.code, 3);
      EXPECT_EQ(out.out, "");
      EXPECT_THAT(out.err, HasSubstr("No space left"));
    }
  }
  EXPECT_TRUE(failed && made);
}

// A line end ends a name in a dependency file.
TEST_F(Outputs, DependencyFilesRefuseNamesWithLineEnds) {
  const std::string odd = folder_ / "a\nb.pxn";
  fs::copy_file(part_, odd);
  const Outcome refused =
      panwright({"compile", odd, "-o", folder_ / "odd.pan", "-M", folder_ / "odd.d"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("line end"));
  EXPECT_FALSE(fs::exists(folder_ / "odd.pan") || fs::exists(folder_ / "odd.d"));
  EXPECT_EQ(panwright({"compile", odd, "-o", folder_ / "odd.pan"}).code, 0);
}

TEST_F(Outputs, InputsMayBePipesWithLateWriters) {
  const std::string moving = folder_.write(
      "moving.pxn",
      R"(<pangu_model ver="1"><joint name="a" type="continuous" axis="1 0 0"><box size="1"/></joint></pangu_model>)");
  const std::string pipe = folder_ / "pipe";
  const Outcome done = shell("mkfifo " + pipe + "; (sleep 0.3; echo '{\"a\": 10}' >" + pipe +
                             ") & \"$P\" joints " + moving + " --joints " + pipe + "; wait");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("10 deg"));
  // nobody writes: the first signal ends the wait
  const Outcome ended =
      support::run_and_signal({kProgram, "joints", moving, "--joints", pipe}, SIGTERM, 500'000);
  EXPECT_EQ(ended.code, 128 + SIGTERM);
}

#ifndef PANWRIGHT_SANITIZED
// One object, whatever happens; one code and one exit code of all commands.
TEST_F(Outputs, JsonSaysThatThereIsNoMemory) {
  const std::string large = folder_.write(
      "large.pxn",
      R"(<pangu_model ver="1"><ellipsoid radii="1" segments="100000" rings="100"/></pangu_model>)");
  for (const std::string& command :
       std::vector<std::string>{"check", "info", "compile -o " + (folder_ / "large.pan")}) {
    SCOPED_TRACE(command);
    const Outcome out = shell("ulimit -v 600000; \"$P\" " + command + " " + large + " --json");
    EXPECT_EQ(out.code, 1);
    const auto result = nlohmann::json::parse(out.out, nullptr, false);
    ASSERT_FALSE(result.is_discarded()) << out.out << out.err;
    EXPECT_EQ(result["exit_code"], 1);
    ASSERT_EQ(result["diagnostics"].size(), 1u) << out.out;
    EXPECT_EQ(result["diagnostics"][0]["code"], "E0002");
  }
}

// One view that does not fit is answered, and the next is drawn.
TEST_F(Outputs, StreamsOfViewsGoOnWithoutMemory) {
  const std::string lines = folder_.write(
      "lines", "{\"output\": \"" + (folder_ / "a.npy") + "\", \"size\": \"8x8\"}\n{\"output\": \"" +
                   (folder_ / "b.exr") + "\", \"size\": \"8000x8000\"}\n{\"output\": \"" +
                   (folder_ / "c.npy") + "\", \"size\": \"8x8\"}\n");
  const Outcome out = shell("ulimit -v 2000000; \"$P\" render " + part_ +
                            " --engine reference --samples 1 --views - <" + lines);
  EXPECT_EQ(out.code, 1) << out.err;
  std::istringstream answers(out.out);
  std::vector<bool> ok;
  for (std::string line; std::getline(answers, line);) {
    const auto answer = nlohmann::json::parse(line);
    ok.push_back(answer["ok"]);
    if (!ok.back()) EXPECT_EQ(answer["diagnostics"][0]["code"], "E5003") << line;
  }
  EXPECT_EQ(ok, (std::vector{true, false, true})) << out.out << out.err;
}
#endif

TEST_F(Outputs, MayBeDevicesAndPipes) {
  EXPECT_EQ(panwright({"check", model_, "--sarif", "/dev/null"}).code, 0);
  EXPECT_EQ(panwright({"check", model_, "--sarif", "/dev/full"}).code, 3);
  const Outcome sarif = panwright({"check", model_, "--sarif", "/dev/stdout"});
  EXPECT_EQ(sarif.code, 0) << sarif.err;
  EXPECT_THAT(sarif.out, HasSubstr("\"version\": \"2.1.0\""));
  EXPECT_THAT(sarif.out, HasSubstr("model.pxn: ok"));
  const Outcome rule = panwright({"compile", model_, "-o", folder_ / "a.pan", "-M", "/dev/stdout"});
  EXPECT_EQ(rule.code, 0) << rule.err;
  EXPECT_THAT(rule.out, HasSubstr("part.pxn"));
  const std::string pipe = folder_ / "pipe";
  const Outcome piped = shell("mkfifo " + pipe + "; cat " + pipe + " & \"$P\" check " + model_ +
                              " --sarif " + pipe + " >&2; wait");
  EXPECT_THAT(piped.out, HasSubstr("2.1.0")) << piped.err;
  EXPECT_TRUE(fs::is_fifo(pipe));
}

// docs/conventions.md 18
TEST_F(Outputs, AClosedPipeEndsTheProgramAsItEndsOthers) {
  const std::string code = folder_ / "code";
  const std::string go = folder_ / "go";
  shell("mkfifo " + go + "; (read x <" + go + "; \"$P\" info " + model_ + "; echo $? >" + code +
        ") | (exec <&-; echo x >" + go + ")");
  EXPECT_EQ(contents(code), "141\n");
}

TEST_F(Outputs, AreWrittenWhereNobodyListens) {
  const std::string go = "\"$P\" compile " + model_ + " -o " + (folder_ / "a.pan");
  const std::string broken = folder_.write("broken.pxn", "<pangu_model ver=\"1\"><spere/>");
  for (const char* streams : {" 2>&-", " >&-", " <&- >&- 2>&-", " 2>/dev/full"}) {
    SCOPED_TRACE(streams);
    fs::remove(folder_ / "a.pan");
    EXPECT_EQ(shell(go + streams).code, 0);
    EXPECT_TRUE(fs::exists(folder_ / "a.pan"));
    // a message that cannot be written is still what the exit code says
    EXPECT_EQ(shell("\"$P\" check " + broken + streams).code, 1);
  }
  EXPECT_EQ(shell("\"$P\" info " + model_ + " >/dev/full").code, 3);
  EXPECT_EQ(shell("\"$P\" info " + model_ + " >&-").code, 3);
  EXPECT_EQ(shell("\"$P\" info " + model_ + " --json >/dev/full 2>/dev/full").code, 3);
  // a result that nobody can read is not "the models differ"
  EXPECT_EQ(shell("\"$P\" diff " + part_ + " " + panel_).code, 1);
  EXPECT_EQ(shell("\"$P\" diff " + part_ + " " + panel_ + " >/dev/full").code, 3);
  EXPECT_EQ(shell("\"$P\" diff " + part_ + " " + part_ + " >/dev/full").code, 3);
  EXPECT_EQ(shell("\"$P\" info --nothing >/dev/full").code, 2);
}

TEST_F(Outputs, AboveTheLimitOfTheShellAreAnError) {
  // in blocks of 512 bytes
  const Outcome outcome =
      shell("ulimit -f 8; \"$P\" compile " + model_ + " -o " + (folder_ / "a.pan"));
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("E0103"));
  std::map<fs::path, std::string> after;
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    after[entry.path()] = contents(entry.path());
  EXPECT_EQ(after, before_);
}

class Parameters : public testing::Test {
 protected:
  void SetUp() override {
    model_ = folder_.write("model.pxn", R"(<pangu_model ver="1">
  <param name="r" value="1m"/>
  <param name="h" value="1m"/>
  <cylinder radius="{r}" height="{h}"/>
</pangu_model>
)");
  }
  // What is printed after "build id".
  std::string identity(const std::vector<std::string>& defines) {
    std::vector<std::string> words{"compile", model_, "-o", folder_ / "m.pan", "-q"};
    for (const std::string& define : defines) words.insert(words.end(), {"-D", define});
    EXPECT_EQ(panwright(words).code, 0);
    const std::string text = panwright({"info", folder_ / "m.pan"}).out;
    const std::size_t at = text.find("build id");
    EXPECT_NE(at, std::string::npos) << text;
    return text.substr(at, text.find('\n', at) - at);
  }
  TemporaryFolder folder_;
  std::string model_;
};

// Equal identities mean equal models: values from the command line are part of them.
TEST_F(Parameters, ArePartOfTheIdentity) {
  const std::string plain = identity({});
  const std::string two = identity({"r=2m", "h=3m"});
  EXPECT_NE(identity({"r=2m"}), plain);
  EXPECT_NE(identity({"r=2m"}), identity({"r=3m"}));
  EXPECT_NE(two, identity({"r=3m", "h=2m"}));
  EXPECT_EQ(two, identity({"h=3m", "r=2m"}));
  EXPECT_THAT(panwright({"info", folder_ / "m.pan"}).out, HasSubstr(R"(h='3m' r='2m')"));
}

TEST_F(Parameters, OfAPanAreAnError) {
  identity({});
  const Outcome outcome = panwright({"info", folder_ / "m.pan"});
  EXPECT_EQ(outcome.code, 0);
  const Outcome told = panwright({"diff", folder_ / "m.pan", folder_ / "m.pan", "-D", "r=2m"});
  EXPECT_THAT(told.err, HasSubstr("-D has no effect on a .pan file")) << told.out;
  EXPECT_THAT(told.err, HasSubstr("E1225"));
  EXPECT_EQ(panwright({"render", folder_ / "m.pan", "-D", "r=2m", "-o", folder_ / "r.png"}).code,
            1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r.png"));
  // beside a text they are the text's
  const Outcome both = panwright({"diff", model_, folder_ / "m.pan", "-D", "r=2m"});
  EXPECT_THAT(both.err, Not(HasSubstr("E1225")));
}

// What could be read of a model with errors is written where the user said where to, and that is
// said.
TEST_F(Parameters, OfNoModelAreErrorsAfterWhichNothingIsDrawnUnasked) {
  const auto in_folder = [&](std::vector<std::string> words) {
    std::vector<std::string> there{"/bin/sh", "-c", "cd \"$0\" && exec \"$@\"",
                                   folder_.path().string(), kProgram};
    there.insert(there.end(), words.begin(), words.end());
    return support::run(there);
  };
  for (const char* command : {"render", "compile"}) {
    const Outcome outcome = in_folder({command, "model.pxn", "-D", "q=3"});
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("E1225"));
    EXPECT_THAT(outcome.err, HasSubstr("nothing is written"));
    EXPECT_FALSE(fs::exists(folder_ / "model.png"));
    EXPECT_FALSE(fs::exists(folder_ / "model.pan"));
  }
}

// The folder of an output that is not there is said before the work, not after it.
TEST_F(Parameters, FoldersThatAreMissing) {
  const Outcome outcome = panwright({"compile", model_, "-D", "q=3", "-o", folder_ / "none/m.pan"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("there is no folder"));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("E1225")));
}

// An image where the user named it, of what could be read, says what it is of.
TEST_F(Outputs, ImagesOfModelsWithErrorsSaySo) {
  const std::string wrong = folder_.write(
      "wrong.pxn",
      "<pangu_model ver=\"1\">\n<sphere radius=\"1\" material=\"golld\"/>\n</pangu_model>");
  const auto drawn = [&](const std::string& model) {
    return panwright({"render", model, "-o", folder_ / "image.png", "--size", "16x16", "--engine",
                      "reference", "--samples", "1"});
  };
  const Outcome outcome = drawn(wrong);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("E1311"));
  EXPECT_THAT(outcome.out, HasSubstr(", without the parts and materials that failed\n"));
  EXPECT_TRUE(fs::exists(folder_ / "image.png"));
  EXPECT_THAT(drawn(part_).out, Not(HasSubstr("failed")));
}

class GroundOutputs : public testing::Test {
 protected:
  // A text with terrain, and more.
  std::string text(const std::string& more) const {
    for (const char* name : {"crater.lbl", "crater.img"})
      folder_.write(name, contents(std::string(PANWRIGHT_SOURCE_DIR "/examples/terrain/") + name));
    return folder_.write("ground.pxn",
                         "<pangu_model ver=\"1\">\n<terrain error=\"5m\"><dem file=\"crater.lbl\" "
                         "reduce=\"8\"/></terrain>\n" +
                             more + "</pangu_model>\n");
  }
  const TemporaryFolder folder_;
};

TEST_F(GroundOutputs, TerrainWithErrorsIsNotTiledAndTheOutputIsNotAskedFor) {
  const std::string output = folder_ / "ground.pan";
  const Outcome done = panwright({"compile", text("<spere/>\n"), "-o", output});
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.err, HasSubstr("nothing is written"));
  EXPECT_THAT(done.err, Not(HasSubstr(" -o")));
  EXPECT_FALSE(fs::exists(output));
}

TEST_F(GroundOutputs, ImagesOfTerrainAloneHaveRaysAndNoSamples) {
  const std::string ground = folder_ / "ground.pan";
  ASSERT_EQ(panwright({"compile", text(""), "-o", ground}).code, 0);
  const auto line = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"render",   ground, "-o",    folder_ / "a.png", "--camera",
                                   "0 0 3000", "--up", "0 1 0", "--size",          "16x16"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome done = panwright(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return done.out;
  };
  EXPECT_THAT(line({}), HasSubstr("16 x 16, gl, terrain by 4 rays a pixel, "));
  EXPECT_THAT(line({"--samples", "3"}), HasSubstr("terrain by 9 rays a pixel"));
  EXPECT_THAT(line({"--engine", "reference"}), Not(HasSubstr("terrain by")));
}

}  // namespace
}  // namespace panwright::outputs_test
