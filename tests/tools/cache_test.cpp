// What the program keeps between runs: counts, the same bytes, and processes that share a folder.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::cache_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

// Spheres, a box that wears a blanket, and a mesh whose quads are cut into two.
std::string model(const std::string& radius) {
  return "<pangu_model ver=\"1\">\n"
         "<repeat count=\"4\" var=\"i\"><sphere radius=\"{1 + i/10}\" rings=\"30\" quads=\"40\" "
         "translate=\"{4*i} 0 0\"/></repeat>\n"
         "<sphere radius=\"" +
         radius +
         "\" rings=\"30\" quads=\"40\" translate=\"0 5 0\"/>\n"
         "<box name=\"b\" size=\"1 0.8 0.6\" translate=\"0 0 9\"/>\n"
         "<mli type=\"wrap\" on=\"b\" standoff=\"1cm\"><mli_settings><width>1</width><height>1"
         "</height><xgrid>60</xgrid></mli_settings><mli_operations><random> 1mm </random>"
         "</mli_operations></mli>\n</pangu_model>\n";
}

class Cache : public testing::Test {
 protected:
  // Compiles into a.pan; `cache` of the result.
  json compile(const std::string& text, const std::vector<std::string>& options = {}) {
    std::vector<std::string> words{PANWRIGHT_BIN_DIR "/panwright",
                                   "compile",
                                   folder.write("m.pxn", text),
                                   "-o",
                                   folder / "a.pan",
                                   "--json"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = support::run(words, {here});
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    const json out = json::parse(outcome.out);
    return out.contains("cache") ? out["cache"] : json();
  }
  const TemporaryFolder folder;
  const std::string here = "PANWRIGHT_CACHE=" + folder / "cache";
};

json count(int reused, int made) { return {{"reused", reused}, {"made", made}}; }

TEST_F(Cache, OneChangedPartIsCompiledAlone) {
  EXPECT_TRUE(compile(model("2"), {"--no-cache"}).is_null());
  EXPECT_FALSE(fs::exists(folder / "cache"));
  const std::string without = contents(folder / "a.pan");
  const json first = compile(model("2"));
  EXPECT_EQ(first["meshes"], count(0, 5));
  EXPECT_EQ(first["foil"], count(0, 1));
  EXPECT_TRUE(contents(folder / "a.pan") == without);
  for (const char* threads : {"1", "2", "3"}) {
    const json again = compile(model("2"), {"-j", threads});
    EXPECT_EQ(again["meshes"], count(5, 0));
    EXPECT_EQ(again["foil"], count(1, 0));
    EXPECT_TRUE(contents(folder / "a.pan") == without);
  }
  const json changed = compile(model("2.5"));
  EXPECT_EQ(changed["meshes"], count(4, 1));
  EXPECT_EQ(changed["foil"], count(1, 0));
  const std::string other = contents(folder / "a.pan");
  compile(model("2.5"), {"--no-cache"});
  EXPECT_TRUE(contents(folder / "a.pan") == other);
  EXPECT_FALSE(other == without);
}

TEST_F(Cache, TimingsSayWhatWasReused) {
  compile(model("2"));
  const std::vector<std::string> words{PANWRIGHT_BIN_DIR "/panwright",
                                       "compile",
                                       folder / "m.pxn",
                                       "-o",
                                       folder / "a.pan",
                                       "--timings"};
  EXPECT_THAT(support::run(words, {here}).err,
              HasSubstr("from the cache: meshes: 5 of 5, foil: 1 of 1\n"));
  EXPECT_THAT(support::run(words).err, Not(HasSubstr("from the cache")));
}

TEST_F(Cache, ProcessesShareAFolder) {
  folder.write("m.pxn", model("2"));
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      for (int run = 0; run < 2; ++run)
        EXPECT_EQ(support::run({PANWRIGHT_BIN_DIR "/panwright", "compile", folder / "m.pxn", "-o",
                                folder / std::to_string(i) + ".pan"},
                               {here})
                      .code,
                  0);
    });
  for (std::thread& thread : threads) thread.join();
  compile(model("2"), {"--no-cache"});
  const std::string without = contents(folder / "a.pan");
  for (int i = 0; i < 4; ++i)
    EXPECT_TRUE(contents(folder / std::to_string(i) + ".pan") == without) << i;
}

// `import` cleans meshes; another option of cleaning cleans them anew.
TEST_F(Cache, ImportsReuseCleanedMeshes) {
  std::string obj;
  constexpr int kSide = 40;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i)
      obj += "v " + std::to_string(i) + " " + std::to_string(j) + " " +
             std::to_string((i * i + j) % 7) + "\n";
  for (int j = 0; j < kSide; ++j)
    for (int i = 1; i <= kSide; ++i) {
      const int at = j * (kSide + 1) + i, up = at + kSide + 1;
      obj += "f " + std::to_string(at) + " " + std::to_string(at + 1) + " " +
             std::to_string(up + 1) + " " + std::to_string(up) + "\n";
    }
  const std::string file = folder.write("net.obj", obj);
  const auto import = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{PANWRIGHT_BIN_DIR "/panwright",
                                   "import",
                                   file,
                                   "--units",
                                   "m",
                                   "-o",
                                   folder / "a.pan",
                                   "--json"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = support::run(words, {here});
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    json out = json::parse(outcome.out);
    return std::pair{out.contains("cache") ? out["cache"]["cleaned"] : json(),
                     out["diagnostics"].dump() + contents(folder / "a.pan")};
  };
  const auto without = import({"--no-cache"});
  const auto first = import({});
  const auto again = import({});
  EXPECT_EQ(first.first, count(0, 1));
  EXPECT_EQ(again.first, count(1, 0));
  EXPECT_TRUE(first.second == without.second);
  EXPECT_TRUE(again.second == without.second);
  EXPECT_EQ(import({"--crease", "10"}).first, count(0, 1));
}

// With the cache and without: the same file and the same JSON, whatever the options.
TEST_F(Cache, ChangesNoImport) {
  const std::string glb = folder / "relay.glb";
  ASSERT_EQ(support::run({PANWRIGHT_BIN_DIR "/panwright", "export",
                          PANWRIGHT_SOURCE_DIR "/examples/cad/relay.pxn", "-o", glb})
                .code,
            0);
  const auto import = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{
        PANWRIGHT_BIN_DIR "/panwright", "import", glb, "-o", folder / "a.pan", "--json"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = support::run(words, {here});
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    json out = json::parse(outcome.out);
    out.erase("cache");
    if (out.contains("removed")) {
      out["removed"].erase("seconds");
      out["removed"].erase("cached");
    }
    return out.dump() + contents(folder / "a.pan");
  };
  const auto expect_same = [&](const std::vector<std::string>& options) {
    std::vector<std::string> plain = options;
    plain.emplace_back("--no-cache");
    const std::string without = import(plain);
    fs::remove(folder / "a.pan");
    EXPECT_TRUE(import(options) == without);
  };
  expect_same({});
  expect_same({});
  expect_same({"--units", "mm"});
  expect_same({"--crease", "10"});
  expect_same({"--mesh-levels"});
  expect_same({"--compress"});
  expect_same({"--keep-hidden"});
  expect_same({"--max-error", "2mm"});
  expect_same({"--report", folder / "r.txt"});
  expect_same({});
  for (const auto& entry : fs::directory_iterator(folder / "cache/work"))
    fs::resize_file(entry.path(), entry.file_size() - 1);
  expect_same({});
  expect_same({});
  // another file of that name
  std::string bytes = contents(glb);
  const std::size_t name = bytes.find("\"name\":\"");
  ASSERT_NE(name, bytes.npos);
  bytes[name + 8] = bytes[name + 8] == 'Q' ? 'R' : 'Q';
  folder.write("relay.glb", bytes);
  expect_same({});
}

}  // namespace
}  // namespace panwright::cache_test
