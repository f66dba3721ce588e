// Runs the fuzz targets over their corpus and over every pxn file of the tests and examples, in
// every build.

#include <gtest/gtest.h>

#include <filesystem>

#include "base/file.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/targets_gltf.h"
#include "tests/fuzz/targets_roundtrip.h"
#include "tests/fuzz/targets_scenario.h"
#include "tests/fuzz/targets_terrain.h"
#include "tests/support/paths.h"

namespace panwright::replay_test {
namespace {

void replay(const std::filesystem::path& folder, void (*target)(std::span<const std::byte>)) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    if (folder.filename() == "examples" && entry.path().parent_path().filename() == "blankets")
      continue;
    SCOPED_TRACE(entry.path().string());
    DiagnosticLog log;
    const auto bytes = read_file(entry.path(), 1 << 26, log);
    ASSERT_TRUE(bytes) << to_text(log);
    target(as_bytes(*bytes));
    ++files;
  }
  EXPECT_GT(files, 0) << folder;
}

TEST(Replay, PxnCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/pxn", fuzz::pxn); }
TEST(Replay, PxnTestFiles) { replay(PANWRIGHT_SOURCE_DIR "/tests/pxn/data", fuzz::pxn); }
TEST(Replay, Examples) { replay(PANWRIGHT_SOURCE_DIR "/examples", fuzz::pxn); }
TEST(Replay, Blankets) { replay(PANWRIGHT_SOURCE_DIR "/examples/blankets", fuzz::pxn); }
TEST(Replay, RoundtripCorpus) {
  replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/roundtrip",
         [](std::span<const std::byte> bytes) { fuzz::roundtrip(bytes); });
}
TEST(Replay, PanCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/pan", fuzz::pan); }
TEST(Replay, PanOfOlderFormats) { replay(PANWRIGHT_SOURCE_DIR "/tests/pan/data", fuzz::pan); }
TEST(Replay, VrmlCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/vrml", fuzz::vrml); }
TEST(Replay, GltfCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/gltf", fuzz::gltf); }
TEST(Replay, MeshCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/mesh", fuzz::mesh); }
TEST(Replay, ImageCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/image", fuzz::image); }
TEST(Replay, ScenarioCorpus) {
  replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/scenario",
         [](std::span<const std::byte> bytes) { fuzz::scenario(bytes); });
}
TEST(Replay, TerrainCorpus) {
  replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/terrain",
         [](std::span<const std::byte> bytes) { fuzz::terrain(bytes); });
}
TEST(Replay, DracoCorpus) { replay(PANWRIGHT_SOURCE_DIR "/tests/fuzz/corpus/draco", fuzz::draco); }

}  // namespace
}  // namespace panwright::replay_test
