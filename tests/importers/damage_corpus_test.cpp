// Public CAD files, cut short and with bytes changed: never a crash, a hang or a silent refusal.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/file.h"
#include "importers/clean.h"
#include "importers/import.h"

namespace panwright::importers::damage_corpus_test {
namespace {

namespace fs = std::filesystem;

constexpr int kCuts = 500;
constexpr int kFlips = 2000;
// what a file may take, in seconds; measured 0.3 at most, on a busy machine
constexpr double kMostSeconds = 5;
// memory that a damaged file may ask for
constexpr std::uint64_t kMostMemory = 256ull << 20;

constexpr const char* kFiles[] = {
    "vrml-hard/openhrp3/PA10/j2.wrl",
    "vrml-hard/coin/vrml1.0/properties/shapehints.wrl",
    "spacecraft-vrml/mars-pathfinder/t947846D.wrl",
    "spacecraft-vrml/derived/cubesat6u-vtk.wrl",
    "spacecraft-vrml/derived/cubesat6u-freecad-gui.wrz",
    "spacecraft-gltf/m2020-ingenuity-leg01.glb",
    "spacecraft-gltf/tdrs-a-blender.glb",
    "spacecraft-gltf/grace-draco-webp.glb",
    "spacecraft-gltf/hubble-meshopt.glb",
    "spacecraft-gltf/ulysses-draco-webp.glb",
    "small-bodies/bennu.obj",
};

fs::path corpus() {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  return given != nullptr && *given != '\0' ? fs::path(given) : fs::path(PANWRIGHT_CORPUS_DIR);
}

// Bits of a counter (Steele and others' splitmix64).
std::uint64_t mixed(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15u;
  n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
  n = (n ^ n >> 27) * 0x94d049bb133111ebu;
  return n ^ n >> 31;
}

// Imports, cleans, and checks that what comes out is sound or refused with a reason.
void read_damaged(const std::string& name, const std::string& bytes, double& slowest) {
  const MemoryFile files[] = {{name, bytes}};
  Options options;
  options.limits.memory = kMostMemory;
  options.limits.texture_bytes = 64 << 20;
  DiagnosticLog log;
  const auto start = std::chrono::steady_clock::now();
  auto imported = import_memory(files, options, log);
  if (imported) {
    ASSERT_EQ(scene::check(imported->scene), "") << name;
    ASSERT_EQ(imported->materials.size(), imported->scene.materials.size());
    (void)clean_up(imported->scene, {}, log);
    ASSERT_EQ(scene::check(imported->scene), "") << name << ", cleaned";
  } else {
    ASSERT_TRUE(log.has_errors()) << name << " is refused without a reason";
  }
  const double seconds = seconds_since(start);
  slowest = std::max(slowest, seconds);
  ASSERT_FALSE(to_text(log).size() > 1u << 20);
}

class DamagedCorpus : public testing::TestWithParam<const char*> {};

TEST_P(DamagedCorpus, is_read_or_refused) {
  const fs::path path = corpus() / GetParam();
  if (!fs::exists(path)) GTEST_SKIP() << "no " << path;
  DiagnosticLog log;
  const auto whole = read_file(path, 1u << 30, log);
  ASSERT_TRUE(whole);
  const std::string name = path.filename().string();
  double slowest = 0;
  for (int i = 0; i < kCuts; ++i) {
    const std::size_t size = mixed(static_cast<std::uint64_t>(i)) % whole->size();
    read_damaged(name, whole->substr(0, size), slowest);
    ASSERT_FALSE(HasFatalFailure()) << "cut to " << size;
  }
  for (int i = 0; i < kFlips; ++i) {
    const std::uint64_t random = mixed(static_cast<std::uint64_t>(kCuts + i));
    std::string changed = *whole;
    // half of them near the beginning, where the structure of binary files is
    const std::size_t reach =
        i % 2 == 0 ? whole->size() : std::min<std::size_t>(whole->size(), 4096);
    char& byte = changed[random % reach];
    byte = static_cast<char>(byte ^ static_cast<char>(1 + (random >> 40) % 255));
    read_damaged(name, changed, slowest);
    ASSERT_FALSE(HasFatalFailure()) << "byte " << random % reach << " of change " << i;
  }
  EXPECT_LT(slowest, kMostSeconds);
  RecordProperty("slowest", std::to_string(slowest));
  std::printf("%s: slowest %.3f s\n", name.c_str(), slowest);
}

INSTANTIATE_TEST_SUITE_P(Files, DamagedCorpus, testing::ValuesIn(kFiles));

}  // namespace
}  // namespace panwright::importers::damage_corpus_test
