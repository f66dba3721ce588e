#include "workspace/open.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/file.h"
#include "pxn/pxn.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/terrain_models.h"
#include "workspace/drawer.h"

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

// A file with a damaged tile of terrain opens; images have a void there, and name it. A check
// refuses the file.
TEST(Open, LeavesOutDamagedTilesOfTerrain) {
  constexpr int kSide = 600;  // 3 x 3 tiles
  const TemporaryFolder folder;
  const world::ModelPtr whole =
      support::plane_model(kSide, std::vector<float>(kSide * kSide, 1.0f));
  std::string bytes = bytes_of(*whole);
  {
    DiagnosticLog log;
    const auto tiles = terrain::Tiles::of(whole, log);
    ASSERT_TRUE(tiles && *tiles);
    bytes[128 + (**tiles).records()[4].offset + 77] ^= 1;
  }
  const std::string path = folder.write("damaged.pan", bytes);
  DiagnosticLog log;
  const auto model = open(path, {}, log);
  ASSERT_TRUE(model) << to_text(log);
  EXPECT_TRUE(log.entries().empty()) << to_text(log);
  world::World world;
  ASSERT_TRUE(world.add("ground", *model, log));
  world::Camera camera;
  world::set_orthographic(camera, 10, 10, 500);  // pixels of 50 m
  camera.position = {0, 0, 100};
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
  DrawOptions options;
  options.engine = Engine::reference;
  options.reference.samples = 8;
  Drawer drawer(options);
  const auto drawn = drawer.draw(world, camera, false, log);
  ASSERT_TRUE(drawn) << to_text(log);
  // the tile of columns and rows 256 to 512: x from -43.5 to 212.5, y from -212.5 to 43.5
  const auto share = [&](int column, int row) {
    return drawn->image.coverage[static_cast<std::size_t>(10 * row + column)];
  };
  EXPECT_EQ(share(6, 6), 0);
  EXPECT_EQ(share(2, 6), 1);
  EXPECT_EQ(share(6, 2), 1);
  EXPECT_EQ(log.errors(), 0u) << to_text(log);
  ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
  EXPECT_EQ(log.entries()[0].code, Code("W9615"));
  const auto checked = support::run({PANWRIGHT_BIN_DIR "/panwright", "check", path});
  EXPECT_EQ(checked.code, 4);
  EXPECT_THAT(checked.err, testing::HasSubstr("E9611"));
}

// A shape model is written as a model with its plates, closed, of the regolith of terrain.
TEST(ShapeScene, AFileOfASmallBody) {
  const TemporaryFolder folder;
  const std::string tab = folder.write("octahedron.tab",
                                       "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
                                       "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\n"
                                       "f 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n");
  const std::string pan = written({"dem", tab, "--unit", "km"}, folder / "body.pan");
  DiagnosticLog log;
  const auto model = open(folder / "body.pan", {}, log);
  ASSERT_TRUE(model) << to_text(log);
  ASSERT_EQ((*model)->meshes().size(), 1u);
  EXPECT_EQ((*model)->meshes()[0].triangle_count, 8u);
  EXPECT_TRUE((*model)->meshes()[0].flags & pan::layout::kMeshClosed);
  EXPECT_EQ((*model)->material_name(0), "regolith");
  EXPECT_EQ((*model)->node_name(0), "octahedron");
  ASSERT_EQ((*model)->inputs().size(), 1u);
  const auto bounds = (*model)->world_bounds();
  ASSERT_TRUE(bounds);
  EXPECT_NEAR(bounds->high.x, 1000, 1e-3);
  EXPECT_NEAR(bounds->low.z, -1000, 1e-3);
  EXPECT_TRUE(written({"dem", tab, "--unit", "km"}, folder / "again.pan") == pan);
}

// What has a command of its own is refused with it.
TEST(Open, FilesOfTheGroundAreToldTheirCommand) {
  const TemporaryFolder folder;
  const std::string tab = folder.write("body.tab", "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
  const std::string map = folder.write("map.lbl", "PDS_VERSION_ID = PDS3\n");
  const std::string text = folder.write("notes.txt", "nothing\n");
  for (const auto& [path, hint] :
       {std::pair(tab, "a shape model: panwright dem " + tab + " -o body.pan"),
        std::pair(map, "elevations: panwright dem " + map + " -o map.pan"),
        std::pair(text, std::string())}) {
    DiagnosticLog log;
    EXPECT_FALSE(open(path, {}, log));
    ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
    EXPECT_EQ(log.entries()[0].code, Code("E0202"));
    EXPECT_EQ(log.entries()[0].hint, hint);
  }
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
