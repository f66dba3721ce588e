// Command lines as users mistype them, and what the program says of itself: help, manual pages,
// completion. In this process, which is quicker than thousands of programs.

#include <fcntl.h>
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>

#include "base/job.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tools/command_table.h"
#include "tools/completion.h"
#include "tools/explain_examples.h"
#include "tools/progress_line.h"
#include "tools/run.h"
#include "tools/words.h"
#include "workspace/open.h"

namespace panwright::command_line_test {
namespace {

using support::Outcome;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

const std::string kFigure8 = PANWRIGHT_SOURCE_DIR "/examples/paper/figure8.pxn";

// Runs a command line in this process. Work that polls its job ends at once with 130.
Outcome run_here(const Words& words) {
  std::vector<const char*> argv{"panwright"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const Job job(JobOptions{1, {}});
  job.cancel();
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.code = tools::run(static_cast<int>(argv.size()), argv.data(), {job, {}});
  std::fflush(stdout);
  std::fflush(stderr);
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

struct Mistake {
  Words words;
  std::string says;
};

TEST(CommandLine, EachMistakeHasOneClearLine) {
  const std::vector<Mistake> mistakes = {
      {{"compil"}, "'compil' is not a command; did you mean 'compile'?"},
      {{"frobnicate"}, "'frobnicate' is not a command; `panwright help` lists them"},
      {{"help", "rendr"}, "'rendr' is not a command; did you mean 'render'?"},
      {{"--verison"}, "'--verison' is not an option of 'panwright'; did you mean '--version'?"},
      {{"-q", "info", "a"}, "'-q' precedes the command, expected `panwright info -q …`"},
      {{"render", "a", "--smaples", "3"},
       "'--smaples' is not an option of 'panwright render'; did you mean '--samples'?"},
      {{"render", "a", "-output", "b"}, "did you mean '--output'?"},
      {{"info", "a", "--nothing-like-it"}, "`panwright info --help` lists them"},
      {{"render", "a", "--size"}, "--size needs a value: --size WxH"},
      {{"render", "a", "--size", "--sun", "1"},
       "--size needs a value: --size WxH; '--sun' follows it"},
      {{"render", "a", "--size", ""}, "--size has an empty value, expected WxH"},
      {{"render", "a", "--engine="}, "--engine has an empty value, expected gl or reference"},
      {{"render", "a", "--engine", "gl", "--engine", "gl"}, "--engine is given twice"},
      {{"render", "a", "--engine", "openlg"}, "--engine is 'openlg', expected gl or reference"},
      {{"info", "a", "--color", "alwys"}, "did you mean 'always'?"},
      {{"info", "a", "b"}, "'b' is one argument too many: panwright info FILE"},
      {{"run", "a.csv", "tug=b.pxn", "-o", "c"}, "models of targets are --target tug=b.pxn"},
      {{"info", "a", "--json=1"}, "--json takes no value"},
      {{"info"}, "FILE is missing: panwright info FILE"},
      {{"info", ""}, "an argument has an empty value, expected FILE"},
      {{"export", "a"}, "-o FILE.glb is missing"},
      {{"render", "a", "-j", "-1"}, "--threads is '-1', expected a whole number from 0 to 1024"},
      {{"info", "a", "--threads", "1.5"}, "--threads is '1.5', expected a whole number"},
      {{"render", "a", "--sun", "1", "-1", "0.5"},
       "put quotes around the 3 numbers of --sun: --sun \"1 -1 0.5\""},
      {{"render", "a", "--camera", "0", "0", "3"},
       "put quotes around the 3 numbers of --camera: --camera \"0 0 3\""},
      {{"render", "a", "--camera", "0,", "-2km,", "3"}, "--camera \"0, -2km, 3\""},
      {{"render", "a", "--camera=0", "0", "3"}, "--camera \"0 0 3\""},
      {{"render", "a", "--pose", "a=0", "0", "3", "1", "0", "0", "0"},
       "put quotes around the 7 numbers of --pose: --pose a=\"0 0 3 1 0 0 0\""},
      {{"render", "a", "--size", "640", "480"}, "--size \"640 480\""},
      {{"render", "a", "--intrinsics", "9", "9", "4", "4"}, "--intrinsics \"9 9 4 4\""},
      {{"render", "a", "--noise", "3"}, "makes numbers with noise (docs/detector.md)"},
      {{"render", "a", "--skybox", "1"},
       "--stars V draws stars (docs/sky-by-date.md, docs/sky.md, docs/stars.md)"},
      {{"render", "a", "--exposure-time", "1"},
       "--ev STOPS, or --ev auto, sets the exposure of a PNG"},
      {{"render", "a", "--depth"}, "meta.json names the ids"},
      {{"render", "a", "--masks"}, "--labels of 'render'"},
      {{"render", "a", "--light", "1"}, "--lamp adds a light"},
      {{"render", "a", "--lens", "1"}, "sets the distortion of the lens (docs/cameras.md)"},
      {{"view", "a", "--noise", "3"}, "'--noise' is not an option of 'panwright view'"},
      {{"diff", "a"}, "is missing: panwright diff A B"},
      {{"compile", "a", "--max-error", "nan"},
       "--max-error is 'nan', expected a length, as 2mm or 0.002 (metres)"},
      {{"compile", "a", "--max-input", "99999999999GB"}, "expected a number of bytes, as 512MB"},
      {{"import", "a", "--weld", "1", "--no-weld"}, "--weld cannot be combined with --no-weld"},
      {{"import", "a", "--up", "y"}, "'--up' is not an option of 'panwright import'"},
      {{"material", "--svg", "/none/plots"},
       "--svg is '/none/plots', expected a folder, or a new one in an existing folder"},
      {{kFigure8}, "is a file, expected a command first, as in `panwright info"},
  };
  for (const Mistake& mistake : mistakes) {
    const Outcome outcome = run_here(mistake.words);
    EXPECT_EQ(outcome.code, 2) << mistake.says << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(mistake.says));
    EXPECT_THAT(outcome.err, testing::EndsWith(" [E0201]\n"));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(CommandLine, ValuesMayBeginWithAHyphenAndShortOptionsStandTogether) {
  // the file is not there, or the work is stopped: all options were taken
  for (const Words& words :
       {Words{"render", "none.pan", "--camera", "-1 0 0", "--sun", "-.5,1,0"},
        Words{"info", "none.pan", "-qj2"}, Words{"compile", "none.pxn", "-Dspan=1m", "-D", "n=2"},
        Words{"info", "--", "-none.pan"}, Words{"info", "none.pan", "--max-triangles", "3e8"},
        Words{"import", "none.wrl", "--up-axis", "z"}})
    EXPECT_THAT(run_here(words).code, testing::AnyOf(3, 130)) << words[0];
}

// Mutations of words: letters swapped, dropped, doubled, replaced; words dropped, doubled, swapped,
// emptied; options without values and values without options.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  Words mutated(Words words) {
    const unsigned count = 1 + below(3);
    for (unsigned i = 0; i < count; ++i) mutate(words);
    return words;
  }

 private:
  // note: not std::uniform_int_distribution, which differs between libraries
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  void mutate(Words& words) {
    if (words.empty()) words.emplace_back("--");
    const std::size_t at = below(words.size());
    std::string& word = words[at];
    switch (below(12)) {
      case 0:
        return void(words.erase(words.begin() + static_cast<std::ptrdiff_t>(at)));
      case 1:
        return void(words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), word));
      case 2:
        return std::swap(word, words[below(words.size())]);
      case 3:
        return word.clear();
      case 4:
        if (word.size() > 1) std::swap(word[below(word.size() - 1)], word.back());
        return;
      case 5:
        if (!word.empty()) word.erase(below(word.size()), 1);
        return;
      case 6:
        if (!word.empty()) word.insert(below(word.size()), 1, word[below(word.size())]);
        return;
      case 7:
        if (!word.empty()) word[below(word.size())] = static_cast<char>(1 + below(255));
        return;
      case 8:
        return void(word += "=");
      case 9:
        return void(word = "-" + word);
      case 10: {
        static const char* const kOdd[] = {"nan",      "-1",        "1e999", "--",
                                           "-",        "=",         "--=",   "--x=y",
                                           "0x10",     "1,2,3,4,5", "%s%n",  "18446744073709551616",
                                           "\xff\xfe", "-q",        "--json"};
        return void(word = kOdd[below(std::size(kOdd))]);
      }
      default:
        return void(words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), "--no-such"));
    }
  }

  std::mt19937 random_;
};

TEST(CommandLine, TwoThousandMutatedLinesEndWithOneMessage) {
  const TemporaryFolder folder;
  const std::string none = folder / "none.pxn";
  const std::vector<Words> lines = {
      {"compile", none, "-o", folder / "a.pan", "-D", "span=1m", "--max-error", "0.01"},
      {"import", folder / "none.wrl", "-o", folder / "b.pan", "--units", "mm", "--weld", "1e-4"},
      {"export", none, "-o", folder / "c.glb", "--max-triangles", "1000"},
      {"check", none, none, "--color", "never", "--threads", "2"},
      {"info", none, "--meshes", "--json"},
      {"render", none, "-o", folder / "d.png", "--size", "8x8", "--camera", "0 -5 0", "--fov=20"},
      {"render", none, "--engine", "reference", "--bounces", "2", "--seed", "7", "--samples", "4"},
      {"material", "white_z93", "--albedo", "0.5,1", "--engine", "gl"},
      {"diff", none, none, "--all"},
      {"fmt", none, "--check"},
      {"upgrade", none, "-o", folder / "e.pxn"},
      {"expand", none, "-o", folder / "f.pxn"},
      {"explain", "E1101"},
      {"help", "render"},
      {"version", "--json"},
      {"completion", "bash"},
  };
  // a word may become the name of an output: here, and not in the folder of the test
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  Mutator mutator(14);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    const Words words = mutator.mutated(lines[static_cast<std::size_t>(i) % lines.size()]);
    std::string line;
    for (const std::string& word : words) line += " '" + word + "'";
    const Outcome outcome = run_here(words);
    EXPECT_THAT(outcome.code, testing::AnyOf(0, 1, 2, 3, 130)) << line << outcome.err;
    for (const char* raw : {"terminate", "std::", "internal error", "Run with --help",
                            "The following argument", "Could not convert", "bad_alloc"})
      EXPECT_THAT(outcome.err, Not(HasSubstr(raw))) << line;
    if (outcome.code != 2 || words.empty()) continue;
    ++refused;
    if (std::find(words.begin(), words.end(), "--json") != words.end() && !outcome.out.empty()) {
      const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
      ASSERT_FALSE(json.is_discarded()) << line << outcome.out;
      EXPECT_GE(json["errors"], 1) << line;
      continue;
    }
    // one line each, with a code; several wrong values are several lines
    EXPECT_THAT(outcome.err, HasSubstr(" [E02")) << line;
    for (const char c : outcome.err)
      EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << line;
    EXPECT_LT(outcome.err.size(), 600u) << line;
  }
  std::filesystem::current_path(before);
  EXPECT_GT(refused, 800) << "most mutations are mistakes";
}

// Views files with members renamed, gone, doubled and of other types, and with damaged bytes.
class ViewsMutator {
 public:
  explicit ViewsMutator(unsigned seed) : random_(seed) {}

  std::string mutated(nlohmann::ordered_json views) {
    const std::size_t count = 1 + below(3);
    for (std::size_t i = 0; i < count; ++i)
      if (views.is_array() && !views.empty()) mutate(views[below(views.size())], views);
    std::string text = views.dump();
    if (below(3) == 0)
      for (std::size_t i = 0; i <= below(3); ++i)
        text[below(text.size())] = static_cast<char>(1 + below(255));
    if (below(8) == 0) text.resize(below(text.size()));
    return text;
  }

 private:
  using Json = nlohmann::ordered_json;
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  Json odd() {
    switch (below(12)) {
      case 0:
        return nullptr;
      case 1:
        return -1;
      case 2:
        return 1e300;
      case 3:
        return "";
      case 4:
        return "nan";
      case 5:
        return Json::array();
      case 6:
        return Json::object();
      case 7:
        return {1, "two", nullptr};
      case 8:
        return true;
      case 9:
        return "%s\n\x01";
      case 10:
        return {{"a", {{"b", 1}}}};
      default:
        return std::string(3000, 'x');
    }
  }

  void mutate(Json& view, Json& views) {
    if (!view.is_object() || view.empty() || below(10) == 0) {
      Json value = odd();
      view.swap(value);
      return;
    }
    auto member = view.begin();
    for (std::size_t i = below(view.size()); i > 0; --i) ++member;
    const std::string key = member.key();
    switch (below(6)) {
      case 0:
        view.erase(key);
        return;
      case 1: {  // misspelt
        std::string name = key;
        name[below(name.size())] = static_cast<char>('a' + below(26));
        view[name] = member.value();
        return;
      }
      case 2: {
        Json copy = view;  // note: view is a part of views
        views.push_back(std::move(copy));
        return;
      }
      case 3:
        if (member.value().is_array()) {
          if (below(2) == 0 || member.value().empty())
            member.value().push_back(odd());
          else
            member.value()[below(member.value().size())] = odd();
          return;
        }
        [[fallthrough]];
      default:
        member.value() = odd();
    }
  }

  std::mt19937 random_;
};

TEST(CommandLine, TwoThousandMutatedViewsFilesEndWithClearMessages) {
  const TemporaryFolder folder;
  const auto views = nlohmann::ordered_json::parse(R"([
    {"name": "far", "camera": [0, -60, 4], "fov": 10, "outputs": ["far.png", "far.npz"], "size": [8, 8], "ev": "auto"},
    {"name": "near", "camera": [0, -12, 3], "look-at": [0, 0, 1], "ifov": "0.2mrad", "output": "near.exr", "sun": [1, 0, 0.5],
     "pose": {"figure8": [0.4, 0, 0, 0.9990482, 0, 0, 0.0436194]}, "samples": 4, "irradiance": 1361, "define": {"span": "1m"}},
    {"camera": [0, -12, 3], "ortho": 4, "output": "checked.npy", "engine": "reference", "samples": 8, "bounces": 2,
     "joint": {"wing": 90}, "targets": ["a=figure8.pxn"]}])");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::filesystem::copy_file(kFigure8, "figure8.pxn");
  ViewsMutator mutator(15);
  int refused = 0;
  std::size_t longest = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = mutator.mutated(views);
    const std::string file = folder.write("views.json", text);
    const Outcome outcome = run_here({"render", "figure8.pxn", "--views", file, "--quiet"});
    // 130: sound, and this job is cancelled; 1 to 3 as documented
    EXPECT_THAT(outcome.code, testing::AnyOf(1, 2, 3, 130)) << text << outcome.err;
    for (const char* raw : {"terminate", "std::", "internal error", "json.exception", "parse error",
                            "nlohmann", "type_error", "bad_alloc"})
      EXPECT_THAT(outcome.err, Not(HasSubstr(raw))) << text;
    if (outcome.code == 130) continue;
    ++refused;
    EXPECT_THAT(outcome.err, testing::ContainsRegex("(error: .*|\\[E[0-9]{4}\\])")) << text;
    for (const char c : outcome.err)
      ASSERT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << text << outcome.err;
    longest = std::max(longest, outcome.err.size());
  }
  std::filesystem::current_path(before);
  EXPECT_GT(refused, 1000) << "most mutations are mistakes";
  EXPECT_LT(longest, 6000u) << "of all problems of a file";
}

TEST(Help, EveryCommandHasItsManualPage) {
  const std::string text = support::contents(PANWRIGHT_SOURCE_DIR "/tools/CMakeLists.txt");
  const std::size_t begin = text.find("set(commands ");
  ASSERT_NE(begin, text.npos);
  std::string built = text.substr(begin + 12, text.find(')', begin) - begin - 12) + " ";
  for (const tools::DescribedCommand& each : tools::command_table())
    EXPECT_THAT(built, HasSubstr(fmt::format(" {} ", each.command.name)));
}

TEST(Help, EveryCommandHasItsOwnThreeExamplesAndEveryOptionAHelp) {
  const Outcome all = run_here({"help"});
  EXPECT_EQ(all.code, 0);
  for (const tools::DescribedCommand& each : tools::command_table()) {
    EXPECT_THAT(all.out, HasSubstr(each.command.name));
    EXPECT_EQ(each.examples.size(), 3u) << each.command.name;
    const Outcome help = run_here({"help", each.command.name});
    EXPECT_EQ(help.out, run_here({each.command.name, "--help"}).out);
    const Outcome page = run_here({"help", each.command.name, "--man"});
    EXPECT_THAT(page.out, testing::StartsWith(".TH ")) << each.command.name;
    for (const tools::Example& example : each.examples)
      EXPECT_THAT(help.out, HasSubstr(std::string(example.words)));
    std::set<std::string> names;
    for (const tools::Option& option : each.arguments->options()) {
      EXPECT_FALSE(option.help.empty()) << each.command.name << " " << option.name();
      if (!option.argument) {
        EXPECT_THAT(help.out, HasSubstr("  " + option.names.front()));
      }
      for (const std::string& name : option.names)
        EXPECT_TRUE(names.insert(name).second) << each.command.name << " " << name;
    }
    // a line for a terminal, but for examples
    std::size_t longest = 0, begin = 0;
    const std::string text = help.out.substr(0, help.out.find("\nExamples"));
    for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
      longest = std::max(longest, tools::characters(text.substr(begin, end - begin)));
    EXPECT_LE(longest, 100u) << each.command.name;
  }
}

// As the help says: from a copy of examples/, each command's in one of its own.
TEST(Help, ExamplesRun) {
  for (const tools::DescribedCommand& each : tools::command_table()) {
#ifndef PANWRIGHT_GL
    if (each.command.name == "render" || each.command.name == "run" ||
        each.command.name == "material" || each.command.name == "dataset")
      continue;
#endif
    // these end with their user: tests/studio/window.py, tests/server/protocol_test.py
    if (each.command.name == "view" || each.command.name == "serve") continue;
    const TemporaryFolder folder;
    std::filesystem::copy(PANWRIGHT_SOURCE_DIR "/examples", folder.path(),
                          std::filesystem::copy_options::recursive);
    for (const tools::Example& example : each.examples) {
      std::string line = "panwright " + each.command.name + " " + std::string(example.words);
      if (const auto pipe = line.find(" | "); pipe != std::string::npos) line.resize(pipe);
      const Outcome outcome =
          support::run({"/bin/sh", "-c", "cd \"$0\" && PATH=\"$1:$PATH\" && " + line,
                        folder.path().string(), PANWRIGHT_BIN_DIR});
      EXPECT_EQ(outcome.code, 0) << line << "\n" << outcome.err;
      EXPECT_THAT(outcome.err, Not(HasSubstr("error"))) << line;
      // export says what glTF does not keep
      if (each.command.name != "export") {
        EXPECT_THAT(outcome.err, Not(HasSubstr("warning"))) << line;
      }
      const bool writes = line.find(" -o ") != std::string::npos && !line.ends_with(" -o -");
      if (writes && each.command.name != "render" && each.command.name != "run") {
        EXPECT_THAT(outcome.err, HasSubstr("wrote ")) << line;
      }
    }
  }
}

// Manual pages without a warning of the program that sets them.
TEST(Help, ManualPagesAreWellFormed) {
  if (!std::filesystem::exists("/usr/bin/groff")) GTEST_SKIP() << "groff is not installed";
  const TemporaryFolder folder;
  for (const char* name : {"", "render", "import", "material"}) {
    const Words words = *name == '\0' ? Words{"help", "--man"} : Words{"help", name, "--man"};
    const std::string page = folder.write("page.1", run_here(words).out);
    const Outcome set =
        support::run({"/usr/bin/groff", "-K", "utf8", "-man", "-Tutf8", "-ww", "-z", page});
    EXPECT_EQ(set.code, 0);
    EXPECT_EQ(set.err, "") << name;
  }
}

// Whether the diagnostics of a text of the language have a code.
bool reports(std::string text, Code code) {
  const TemporaryFolder folder;
  if (text.find("<pangu_model") == std::string::npos)
    text = "<pangu_model ver=\"1\">\n" + text + "\n</pangu_model>\n";
  DiagnosticLog log;
  workspace::OpenOptions options;
  (void)workspace::open(folder.write("m.pxn", text), options, log);
  return log.contains(code);
}

TEST(Explain, EveryCodeHasAnExampleAndTextsBringItAboutUntilCured) {
  int texts = 0;
  for (const CodeInfo& info : all_codes()) {
    const Code code = *code_from_name(info.name);
    const tools::CodeExample* example = tools::example_of(code);
    ASSERT_NE(example, nullptr) << info.name;
    EXPECT_NE(example->example, example->cure) << info.name;
    EXPECT_THAT(run_here({"explain", std::string(info.name)}).out,
                HasSubstr("\nCure:\n    " + std::string(example->cure.substr(0, 20))));
    // complete texts; others are fragments with words around them
    if (!example->example.starts_with('<') || !example->example.ends_with('>')) continue;
    ++texts;
    EXPECT_TRUE(reports(std::string(example->example), code)) << info.name;
    if (example->cure.starts_with('<') && example->cure.ends_with('>')) {
      EXPECT_FALSE(reports(std::string(example->cure), code)) << info.name;
    }
  }
  EXPECT_GT(texts, 40);
}

std::set<std::string> texts(const tools::Candidates& found) {
  std::set<std::string> out;
  for (const auto& word : found.words) out.insert(word.text);
  return out;
}

TEST(Completion, KnowsCommandsOptionsValuesPresetsAndFrames) {
  using tools::candidates;
  const std::string cubesat = PANWRIGHT_SOURCE_DIR "/examples/cubesat/cubesat.pxn";
  const std::string client = PANWRIGHT_SOURCE_DIR "/examples/client/client.pxn";
  EXPECT_EQ(texts(candidates({"re"}, {})), std::set<std::string>({"render"}));
  EXPECT_EQ(texts(candidates({"info", "--me"}, {})), std::set<std::string>({"--meshes"}));
  EXPECT_EQ(texts(candidates({"render", "a", "--engine", ""}, {})),
            std::set<std::string>({"gl", "reference"}));
  EXPECT_EQ(texts(candidates({"render", "a", "--engine=r"}, {})),
            std::set<std::string>({"--engine=reference"}));
  EXPECT_EQ(texts(candidates({"render", "a", "--engine", "=", "r"}, {})),
            std::set<std::string>({"reference"}));
  EXPECT_TRUE(texts(candidates({"material", "white_z"}, {})).contains("white_z93"));
  EXPECT_EQ(texts(candidates({"mli", "qu"}, {})), std::set<std::string>({"quilted"}));
  EXPECT_TRUE(candidates({"mli", ""}, {}).files);
  EXPECT_TRUE(texts(candidates({"explain", "E11"}, {})).contains("E1101"));
  EXPECT_TRUE(texts(candidates({"help", "c"}, {})).contains("completion"));
  const auto input = candidates({"compile", ""}, {});
  EXPECT_TRUE(input.files);
  EXPECT_EQ(input.extension, ".pxn");
  const auto one = texts(candidates({"render", client, "--camera-frame", ""}, {}));
  EXPECT_FALSE(one.empty());
  const auto two = texts(candidates({"render", client, cubesat, "--camera-frame", "client/"}, {}));
  EXPECT_EQ(two.size(), one.size());
}

TEST(Progress, SaysHowMuchHowFastAndHowLong) {
  EXPECT_EQ(tools::progress_words({"rendering", 10, 40, 0, false}, 5),
            "rendering  25 %, 10 of 40, 2/s, 15 s left");
  // a quarter of the views, a tenth of the work
  EXPECT_EQ(tools::progress_words({"rendering", 10, 40, 0, false, 0.1}, 5),
            "rendering  10 %, 10 of 40, 2/s, 45 s left");
  EXPECT_EQ(tools::progress_words({"hiding", 1'500'000, 3'000'000, 0, false}, 300),
            "hiding  50 %, 1.5M of 3M, 5000/s, 5 min left");
  EXPECT_EQ(tools::progress_words({"reading", 0, 0, 0, false}, 4), "reading: 4 s");
}

}  // namespace
}  // namespace panwright::command_line_test
