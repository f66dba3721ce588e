#include "workspace/open.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/file.h"
#include "pxn/pxn.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::workspace::open_test {
namespace {

using support::TemporaryFolder;

const std::string kExamples = PANWRIGHT_SOURCE_DIR "/examples/";

std::string bytes_of(const pan::Model& model) {
  const auto bytes = model.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What the program writes for a file.
std::string written(const std::vector<std::string>& words, const std::string& output) {
  std::vector<std::string> all{PANWRIGHT_BIN_DIR "/panwright"};
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"-o", output});
  EXPECT_EQ(support::run(all).code, 0);
  return support::contents(output);
}

TEST(Open, GivesTheBytesThatTheProgramWrites) {
  const TemporaryFolder folder;
  const std::string relay = kExamples + "cad/relay.pxn";  // an import that loses hidden parts
  DiagnosticLog log;
  OpenReport report;
  const auto model = open(relay, {}, log, {}, &report);
  ASSERT_TRUE(model) << to_text(log);
  EXPECT_TRUE((*model)->checked());
  const std::string pan = written({"compile", relay}, folder / "relay.pan");
  EXPECT_TRUE(bytes_of(**model) == pan);
  ASSERT_TRUE(report.hidden);
  EXPECT_LT(report.hidden->triangles_after, report.hidden->triangles_before);
  std::vector<std::string> steps;
  for (const Step& step : report.steps) steps.push_back(step.name);
  EXPECT_THAT(steps,
              testing::ElementsAre("read " + relay, "remove hidden parts", "compile " + relay));

  const auto again = open(folder / "relay.pan", {}, log);
  ASSERT_TRUE(again) << to_text(log);
  EXPECT_TRUE(bytes_of(**again) == pan);

  OpenOptions keep;
  keep.prune = false;
  const auto whole = open(relay, keep, log);
  ASSERT_TRUE(whole);
  EXPECT_GT(bytes_of(**whole).size(), pan.size());
}

TEST(Open, ACadFileLosesWhatTheProgramTakesAway) {
  const TemporaryFolder folder;
  const std::string relay = kExamples + "cad/relay.wrl";
  DiagnosticLog log;
  OpenReport report;
  auto imported = read_cad(relay, {}, log, {}, &report);
  ASSERT_TRUE(imported);
  ASSERT_TRUE(report.mesh_report);
  EXPECT_GT(report.mesh_report->total.triangles_before, 0u);
  const auto done = write_pan(
      imported->scene, {},
      {.output = folder / "a.pan", .strip_sources = false, .storage = {}, .origin = " assume="},
      log);
  ASSERT_TRUE(done) << to_text(log);
  EXPECT_TRUE(support::contents(folder / "a.pan") == written({"import", relay}, folder / "b.pan"));
}

// An OBJ of one triangle, with a warning at a line of it.
constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n";

TEST(Open, ACadFileIsReadOnce) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.obj", kTriangle);
  OpenOptions options;
  options.cache = folder / "cache";
  struct Opened {
    std::string bytes, messages;
    bool was_read = false;
  };
  const auto opened = [&] {
    Opened out;
    DiagnosticLog log;
    OpenReport report;
    const auto model = open(path, options, log, {}, &report);
    EXPECT_TRUE(model) << to_text(log);
    if (model) out.bytes = bytes_of(**model);
    out.messages = to_text(log) + to_json(log);
    for (const Step& step : report.steps)
      out.was_read = out.was_read || step.name.starts_with("read ");
    return out;
  };
  const Opened first = opened();
  EXPECT_TRUE(first.was_read);
  EXPECT_THAT(first.messages, testing::HasSubstr("a face of 2 corners"));
  Opened again = opened();
  EXPECT_FALSE(again.was_read);
  EXPECT_TRUE(again.bytes == first.bytes);
  EXPECT_EQ(again.messages, first.messages);

  options.cad.units = "mm";
  EXPECT_TRUE(opened().was_read);
  options.cad = {};
  EXPECT_FALSE(opened().was_read);
  folder.write("a.obj", std::string(kTriangle) + "# other bytes\n");
  EXPECT_TRUE(opened().was_read);
  folder.write("a.obj", kTriangle);

  // damaged entries are none
  for (const auto& entry : std::filesystem::recursive_directory_iterator(options.cache))
    if (entry.is_regular_file()) std::filesystem::resize_file(entry, entry.file_size() / 2);
  again = opened();
  EXPECT_TRUE(again.was_read);
  EXPECT_TRUE(again.bytes == first.bytes);
  EXPECT_EQ(again.messages, first.messages);
}

TEST(Open, ACadFileThatNamesOthersIsReadEachTime) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("a.obj", "mtllib a.mtl\nusemtl m\n" + std::string(kTriangle));
  OpenOptions options;
  options.cache = folder / "cache";
  const auto colour = [&] {
    DiagnosticLog log;
    const auto model = open(path, options, log);
    EXPECT_TRUE(model);
    return model ? bytes_of(**model) : std::string();
  };
  const std::string missing = colour();
  folder.write("a.mtl", "newmtl m\nKd 1 0 0\n");
  const std::string red = colour();
  EXPECT_TRUE(red != missing);
  folder.write("a.mtl", "newmtl m\nKd 0 1 0\n");
  EXPECT_TRUE(colour() != red);
}

TEST(Open, RefusesWhatItCannotRead) {
  const TemporaryFolder folder;
  const auto code = [](const std::string& path, const OpenOptions& options = {}) {
    DiagnosticLog log;
    EXPECT_FALSE(open(path, options, log));
    return log.entries().empty() ? std::string()
                                 : std::string(code_info(log.entries()[0].code).name);
  };
  EXPECT_EQ(code(folder.write("a.txt", "")), "E0202");
  EXPECT_EQ(code(folder / "none.pan"), "E0101");
  EXPECT_EQ(code(folder / "none.pxn"), "E0101");
  EXPECT_EQ(code(folder.write("a.pan", "nothing")), "E4001");
  EXPECT_EQ(code(folder.write("a.pxn", "<")), "E1001");
  const std::string relay = kExamples + "cad/relay.wrl";
  OpenOptions options;
  options.cad.units = "furlong";
  EXPECT_EQ(code(relay, options), "E0201");
  options.cad = {};
  options.cad.up = "x";
  EXPECT_EQ(code(relay, options), "E0201");
  options.cad = {};
  options.cad.assume = "word";
  EXPECT_EQ(code(relay, options), "E0201");
}

TEST(Open, WhatCanBeReadInPartIsOpenedAndSaysSo) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const auto model = open(
      folder.write("m.pxn", "<pangu_model ver=\"1\"><sphere/><spere/></pangu_model>"), {}, log);
  EXPECT_TRUE(model);
  EXPECT_TRUE(log.has_errors());
}

TEST(Open, AModelOutlivesItsFileAndTheWorldsThatHeldIt) {
  const TemporaryFolder folder;
  const std::string path = folder / "f.pan";
  const std::string bytes = written({"compile", kExamples + "paper/figure8.pxn"}, path);
  world::ModelPtr shared;
  {
    DiagnosticLog log;
    world::World world;
    const auto model = open(path, {}, log);
    ASSERT_TRUE(model && world.add("a", *model, log));
    shared = world[0].model();
  }
  ASSERT_TRUE(std::filesystem::remove(path));
  EXPECT_TRUE(bytes_of(*shared) == bytes);
}

TEST(IsCad, GoesByTheExtension) {
  for (const char* name : {"a.wrl", "b.WRL.gz", "c.glb", "d.gltf", "e.obj", "f.STL", "g.ply",
                           "h.step", "i.stp", "j.wrz", "k.vrml"})
    EXPECT_TRUE(is_cad(name)) << name;
  for (const char* name : {"a.pan", "b.pxn", "c.gz", "wrl", ".wrl", "d"})
    EXPECT_FALSE(is_cad(name)) << name;
}

}  // namespace
}  // namespace panwright::workspace::open_test
