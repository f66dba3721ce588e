// The program as a user runs it: exit codes, streams, files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/diagnostic.h"
#include "image/png.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::program_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

const std::string kFigure8 = PANWRIGHT_SOURCE_DIR "/examples/paper/figure8.pxn";

std::string model(const std::string& body) {
  return "<?xml version=\"1.0\"?>\n<pangu_model ver=\"0\">\n" + body + "\n</pangu_model>\n";
}

// Commands that draw start again with large pages, unless the user sets the allocator.
TEST(Program, LargePagesChangeNoImage) {
  const TemporaryFolder folder;
  std::vector<std::string> images;
  for (const std::string variable : {"GLIBC_TUNABLES", "GLIBC_TUNABLES=glibc.malloc.perturb=0"}) {
    const std::string image = folder / "image.npy";
    const Outcome drawn = panwright(
        {"render", kFigure8, "-o", image, "--size", "48x32", "--camera", "0 -4 1"}, {variable});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    images.push_back(contents(image));
  }
  EXPECT_GT(images[0].size(), 3u * 4 * 48 * 32);
  EXPECT_EQ(images[0], images[1]);
}

TEST(Program, CompilesAndShowsFigure8) {
  const TemporaryFolder folder;
  const Outcome compile = panwright({"compile", kFigure8, "-o", folder / "f.pan"});
  EXPECT_EQ(compile.code, 0);
  EXPECT_THAT(compile.err,
              testing::MatchesRegex("wrote .*f.pan \\([0-9.]+ kB, 11880 triangles\\)\n"))
      << "figure 8 deserves no diagnostics";
  const Outcome info = panwright({"info", folder / "f.pan", "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  const json out = json::parse(info.out);
  EXPECT_EQ(out["schema_id"], "panwright/info/1");
  EXPECT_EQ(out["triangles"], 11880);
  EXPECT_EQ(out["unique_triangles"], 11880);
  EXPECT_GE(out["vertices"].get<int>(), 99 * 60 + 2);
  EXPECT_EQ(out["joints"], json::array());
  EXPECT_EQ(out["materials"].size(), 1u);
  EXPECT_EQ(out["materials"][0]["specular_model"], "cook-torrance");
  EXPECT_EQ(out["meshes"][0]["triangles"], 11880);
  // docs/conventions-models.md 11: off by 1.494e-3 of the radius
  EXPECT_NEAR(out["meshes"][0]["error"].get<double>(), 1.494e-3, 2e-6);
  for (const int axis : {0, 1, 2}) {
    EXPECT_NEAR(out["bounds"]["min"][axis].get<double>(), -1, 2e-3);
    EXPECT_NEAR(out["bounds"]["max"][axis].get<double>(), 1, 2e-3);
  }
  EXPECT_TRUE(out["nodes"][0]["parent"].is_null());
  EXPECT_THAT(panwright({"info", folder / "f.pan"}).out, HasSubstr("11880 triangles"));
}

TEST(Program, TheSameBytesEveryTime) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "copy");
  fs::copy_file(kFigure8, folder / "copy/figure8.pxn");
  ASSERT_EQ(panwright({"compile", kFigure8, "-o", folder / "a.pan", "-j", "1"}).code, 0);
  ASSERT_EQ(
      panwright({"compile", folder / "copy/figure8.pxn", "-o", folder / "b.pan", "-j", "2"}).code,
      0);
  EXPECT_TRUE(contents(folder / "a.pan") == contents(folder / "b.pan"));
  EXPECT_GT(contents(folder / "a.pan").size(), 100000u);
}

TEST(Program, HelpNamesEveryCommandAndUsageIsTwo) {
  const Outcome help = panwright({"--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* command : {"compile", "check", "info", "render", "diff", "fmt", "upgrade",
                              "expand", "explain", "completion"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    EXPECT_EQ(panwright({command, "--help"}).code, 0);
  }
  EXPECT_EQ(panwright({}).code, 2);
  EXPECT_EQ(panwright({"compil"}).code, 2);
  EXPECT_EQ(panwright({"compile"}).code, 2);
  EXPECT_EQ(panwright({"compile", kFigure8, "--colour", "always"}).code, 2);
  EXPECT_EQ(panwright({"render", kFigure8, "--samples", "0"}).code, 2);
}

TEST(Program, ExitCodesOfBadInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(panwright({"compile", folder / "none.pxn", "-o", folder / "x.pan"}).code, 3);
  EXPECT_EQ(panwright({"compile", kFigure8, "-o", folder / "no/such/folder.pan"}).code, 3);
  EXPECT_EQ(panwright({"compile", folder.write("m.obj", "")}).code, 2);
  EXPECT_EQ(panwright({"info", folder / "none.pan"}).code, 3);
  for (const std::string& bytes : {std::string(), std::string("garbage"), std::string(4000, '\0')})
    EXPECT_EQ(panwright({"info", folder.write("bad.pan", bytes)}).code, 4);
  EXPECT_EQ(panwright({"check", folder.write("m.pxn", model("<spere/>"))}).code, 1);
  EXPECT_EQ(panwright({"explain", "E9999"}).code, 2);
}

TEST(Program, WritesWhatCouldBeReadAndSaysSo) {
  const TemporaryFolder folder;
  const std::string input =
      folder.write("m.pxn", model("<group><sphere rings=\"4\" quads=\"4\"/><spere/></group>"));
  const Outcome with = panwright({"compile", input, "-o", folder / "m.pan"});
  EXPECT_EQ(with.code, 1);
  EXPECT_THAT(with.err, HasSubstr("m.pxn:3:"));
  EXPECT_THAT(with.err, HasSubstr("did you mean 'sphere'?"));
  EXPECT_THAT(with.err, HasSubstr("without the parts that failed"));
  EXPECT_EQ(json::parse(panwright({"info", folder / "m.pan", "--json"}).out)["triangles"], 24);
  const Outcome without = panwright({"compile", folder.write("n.pxn", model("<spere/>"))});
  EXPECT_EQ(without.code, 1);
  EXPECT_FALSE(fs::exists(folder / "n.pan")) << "nothing is written where no -o says so";
}

TEST(Program, TheConvertersOfPanguUsers) {
  const TemporaryFolder folder;
  for (const char* name : {"pxntopan", "pxn2pan"}) {
    const std::string output = folder / (std::string(name) + ".pan");
    const Outcome outcome = support::run(
        {std::string(PANWRIGHT_BIN_DIR "/") + name, "-lic", "licence.txt", "-o", output, kFigure8});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("-lic is ignored"));
    EXPECT_TRUE(fs::exists(output));
  }
  EXPECT_TRUE(contents(folder / "pxntopan.pan") == contents(folder / "pxn2pan.pan"));
}

TEST(Program, JsonIsOneObjectOnStandardOutput) {
  const TemporaryFolder folder;
  const std::string bad = folder.write("m.pxn", model("<spere/>"));
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"compile", bad, "-o", folder / "x.pan", "--json"},
                                             {"check", bad, "--json"},
                                             {"info", bad, "--json"},
                                             {"explain", "E1101", "--json"},
                                             {"explain", "--json"},
                                             {"diff", bad, bad, "--json"},
                                             {"render", bad, "-o", folder / "x.png", "--json"}}) {
    const Outcome outcome = panwright(words);
    const json out = json::parse(outcome.out, nullptr, false);
    ASSERT_FALSE(out.is_discarded()) << words[0] << ": " << outcome.out;
    EXPECT_EQ(out["schema"], 1);
    EXPECT_EQ(out["schema_id"], "panwright/" + words[0] + "/1");
    EXPECT_EQ(out["command"], words[0]);
    EXPECT_EQ(out["exit_code"], outcome.code);
    if (words.size() > 2 && words[0] != "explain") {
      EXPECT_EQ(out["diagnostics"][0]["line"], 3) << words[0];
    }
  }
  const json version = json::parse(panwright({"--version", "--json"}).out);
  EXPECT_EQ(version["pan_format"], "1.2");
}

TEST(Program, ColorFollowsTheUserAndNoColor) {
  const TemporaryFolder folder;
  const std::string bad = folder.write("m.pxn", model("<spere/>"));
  EXPECT_THAT(panwright({"check", bad}).err, Not(HasSubstr("\x1b[")));
  EXPECT_THAT(panwright({"check", bad, "--color", "always"}).err, HasSubstr("\x1b["));
  EXPECT_THAT(panwright({"check", bad}, {"NO_COLOR=1", "TERM=xterm"}).err, Not(HasSubstr("\x1b[")));
}

TEST(Program, DepfileNamesEveryFileRead) {
  const TemporaryFolder folder;
  folder.write("parts/a part.pxn", model("<sphere rings=\"4\" quads=\"4\"/>"));
  const std::string top =
      folder.write("top.pxn", model("<include type=\"pxn\" file=\"parts/a part.pxn\"/>"));
  ASSERT_EQ(panwright({"compile", top, "-o", folder / "top.pan", "-M", folder / "top.d"}).code, 0);
  const std::string rule = contents(folder / "top.d");
  EXPECT_THAT(rule, HasSubstr(folder / "top.pan:"));
  EXPECT_THAT(rule, HasSubstr(folder / "top.pxn"));
  EXPECT_THAT(rule, HasSubstr(folder / "parts/a\\ part.pxn"));
}

TEST(Program, SarifFileHoldsTheDiagnostics) {
  const TemporaryFolder folder;
  const std::string bad = folder.write("m.pxn", model("<spere/>"));
  EXPECT_EQ(panwright({"check", bad, "--sarif", folder / "out.sarif"}).code, 1);
  const json sarif = json::parse(contents(folder / "out.sarif"));
  EXPECT_EQ(sarif["version"], "2.1.0");
  EXPECT_EQ(sarif["runs"][0]["results"][0]["ruleId"], "E1101");
}

// Work without an end: the model is never known this well.
TEST(Program, SignalsEndItAsTheyEndOthers) {
  const TemporaryFolder folder;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Outcome outcome = support::run_and_signal(
        {PANWRIGHT_BIN_DIR "/panwright", "render", kFigure8, "-o", folder / "a.npy", "--engine",
         "reference", "--until-error", "1e-9", "--size", "64x64"},
        signal, 500'000);
    EXPECT_EQ(outcome.code, 128 + signal) << outcome.err;
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

// Nothing is not the default.
TEST(Program, EmptyValuesOfOptionsAreRefused) {
  const TemporaryFolder folder;
  for (const char* option : {"--samples", "--pixel-error", "--until-error"}) {
    const Outcome outcome =
        panwright({"render", kFigure8, "-o", folder / "a.png", "--size", "8x8", option, "",
                   "--engine", std::string(option) == "--until-error" ? "reference" : "gl"});
    EXPECT_EQ(outcome.code, 2) << option << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("[E0201]"));
    EXPECT_THAT(outcome.err, HasSubstr(option));
  }
  EXPECT_EQ(panwright({"material", "white_z93", "--albedo", ""}).code, 2);
}

// Samples of a material have its textures.
TEST(Program, SamplesOfATexturedMaterial) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 16; ++i) texels.insert(texels.end(), {0, 255, 0, 255});
  folder.write("green.png", image::png_file(4, 4, texels));
  std::vector<std::uint8_t> upright;
  for (int i = 0; i < 16; ++i) upright.insert(upright.end(), {128, 128, 255, 255});
  folder.write("upright.png", image::png_file(4, 4, upright));
  const auto render = [&](const std::string& maps, const std::string& output) {
    const std::string file =
        folder.write("m.pxn",
                     "<pangu_model ver=\"1\"><material name=\"plain\" preset=\"white_z93\"/>"
                     "<material name=\"m\" preset=\"white_z93\" " +
                         maps + "/></pangu_model>");
    const Outcome outcome = panwright({"material", file, "--name", "m", "--engine", "reference",
                                       "--width", "60", "--render", folder / output});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return contents(folder / output);
  };
  const std::string plain = render("", "plain.png");
  // the second texture of the file
  const std::string green =
      render("normal_map=\"upright.png\" albedo_map=\"green.png\"", "green.png.png");
  EXPECT_NE(plain, green);
}

TEST(Program, DiffSeesWhatChanged) {
  const TemporaryFolder folder;
  const std::string a = folder.write("a.pxn", model("<sphere rings=\"4\" quads=\"4\"/>"));
  const std::string b = folder.write("b.pxn", model("<sphere rings=\"4\" quads=\"5\"/>"));
  EXPECT_EQ(panwright({"diff", a, a}).code, 0);
  const Outcome outcome = panwright({"diff", a, b});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("24"));
  EXPECT_THAT(outcome.out, HasSubstr("30"));
}

TEST(Program, ExplainKnowsEveryCode) {
  const Outcome list = panwright({"explain"});
  EXPECT_EQ(list.code, 0);
  for (const CodeInfo& info : all_codes()) EXPECT_THAT(list.out, HasSubstr(std::string(info.name)));
  EXPECT_THAT(panwright({"explain", "e1101"}).out, HasSubstr("E1101 (error)"));
}

TEST(Program, TimingsShowTheSync) {
  const TemporaryFolder folder;
  const Outcome outcome = panwright({"compile", kFigure8, "-o", folder / "f.pan", "--timings"});
  EXPECT_THAT(outcome.err, HasSubstr("tessellate"));
  EXPECT_THAT(outcome.err, HasSubstr("sync to disk"));
}

TEST(Program, CompletionScriptsAreValid) {
  const TemporaryFolder folder;
  const std::string script = folder.write("c.bash", panwright({"completion", "bash"}).out);
  EXPECT_EQ(support::run({"bash", "-n", script}).code, 0);
  const Outcome outcome = support::run(
      {"bash", "-c",
       "source " + script +
           "; p=" PANWRIGHT_BIN_DIR "/panwright;"
           "COMP_WORDS=($p ren); COMP_CWORD=1; _panwright; echo ${COMPREPLY[0]};"
           "COMP_WORDS=($p render --cam); COMP_CWORD=2; _panwright; echo ${COMPREPLY[@]};"
           "COMP_WORDS=($p render --engine = r); COMP_CWORD=4; _panwright; echo ${COMPREPLY[@]}"});
  EXPECT_EQ(outcome.out, "render\n--camera --camera-frame --camera-file\nreference\n");
  for (const char* shell : {"zsh", "fish"})
    EXPECT_THAT(panwright({"completion", shell}).out, HasSubstr("complete --"));
}

// A compile killed at any moment leaves the old output whole: it is either the old file or the
// complete new one, and nothing else lies in the folder but, at worst, a temporary file.
TEST(Program, KilledCompilesLeaveAWholeFile) {
  const TemporaryFolder folder;
  const std::string small = folder.write("s.pxn", model("<sphere rings=\"4\" quads=\"4\"/>"));
  const std::string large = folder.write("l.pxn", model("<sphere rings=\"700\" quads=\"700\"/>"));
  const std::string output = folder / "out.pan";
  ASSERT_EQ(panwright({"compile", large, "-o", output}).code, 0);
  const std::string complete = contents(output);
  ASSERT_EQ(panwright({"compile", small, "-o", output}).code, 0);
  const std::string old = contents(output);
  ASSERT_FALSE(old == complete);
  int killed = 0;
  for (unsigned microseconds = 0; microseconds < 400000;
       microseconds += 1 + microseconds / 4 + 1500) {
    killed += support::run_and_kill(
        {PANWRIGHT_BIN_DIR "/panwright", "compile", large, "-o", output}, microseconds);
    const std::string now = contents(output);
    EXPECT_TRUE(now == old || now == complete) << "after " << microseconds << " µs";
    if (now == complete) {
      ASSERT_EQ(panwright({"compile", small, "-o", output}).code, 0);
    }
  }
  EXPECT_GT(killed, 5) << "the kills came too late to mean anything";
}

TEST(Program, LocalesChangeNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(panwright({"compile", kFigure8, "-o", folder / "a.pan"}).code, 0);
  ASSERT_EQ(panwright({"compile", kFigure8, "-o", folder / "b.pan"}, {"LC_ALL=de_DE.UTF-8"}).code,
            0);
  EXPECT_TRUE(contents(folder / "a.pan") == contents(folder / "b.pan"));
}

// A text that is checked again whenever it or what it includes changes.
TEST(Program, WatchesWhatItChecks) {
  const TemporaryFolder folder;
  const auto text = [](const std::string& body) {
    return "<pangu_model ver=\"1\">" + body + "</pangu_model>\n";
  };
  folder.write("part.pxn", text("<sphere radius=\"1\"/>"));
  const std::string whole = folder.write("whole.pxn", text("<include file=\"part.pxn\"/>"));
  const std::vector<std::string> edits = {"<sfere radius=\"1\"/>", "<sphere radius=\"2\"/>"};
  std::size_t made = 0;
  const auto edit = [&](const std::string& out) {
    std::size_t checks = 0;
    for (auto at = out.find("watching"); at != out.npos; at = out.find("watching", at + 1))
      checks += out.find('\n', at) != out.npos;
    if (checks <= made) return false;
    if (made == edits.size()) return true;
    folder.write("part.pxn", text(edits[made++]));
    return false;
  };
  const Outcome done = support::run_and_signal(
      {PANWRIGHT_BIN_DIR "/panwright", "check", "--watch", whole}, SIGINT, edit);
  EXPECT_EQ(done.code, 128 + SIGINT) << done.err;
  EXPECT_THAT(done.out,
              testing::ContainsRegex("ok, 2 x 2 x 2 m.*\nwatching 2 files\n(.*\n)*watching 2 "
                                     "files\n(.*\n)*.*ok, 4 x 4 x 4 m.*\nwatching 2 files\n$"));
  EXPECT_THAT(done.err, HasSubstr("E1101"));
  EXPECT_EQ(panwright({"check", "--watch", "--json", whole}).code, 2);
}

}  // namespace
}  // namespace panwright::program_test
