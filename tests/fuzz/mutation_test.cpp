// Files of each format, damaged in 500 ways that stay the same: what can be read is compiled,
// written and read back; what cannot is refused with a code. No crash, and a bound on each.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/file.h"
#include "importers/import.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/targets_roundtrip.h"
#include "tests/fuzz/targets_scenario.h"
#include "tests/fuzz/targets_terrain.h"
#include "tests/support/paths.h"

namespace panwright::mutation_test {
namespace {

namespace fs = std::filesystem;
using fuzz::Source;

constexpr std::uint64_t kMutations = 500;
// a process each
constexpr std::uint64_t kStepMutations = 60;

// Bits of a counter (Steele and others' splitmix64).
std::uint64_t mixed(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15u;
  n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
  n = (n ^ n >> 27) * 0x94d049bb133111ebu;
  return n ^ n >> 31;
}

// Random numbers of one mutation.
class Draws {
 public:
  explicit Draws(std::uint64_t mutation) : state_(mutation << 16) {}
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : mixed(state_++) % limit; }

 private:
  std::uint64_t state_;
};

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == ',' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

struct Range {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// A run of bytes around a place, none of which are of a kind.
template <class Stops>
Range run_at(const std::string& bytes, std::size_t at, const Stops& stops) {
  Range out{at, at};
  while (out.begin > 0 && !stops(bytes[out.begin - 1])) --out.begin;
  while (out.end < bytes.size() && !stops(bytes[out.end])) ++out.end;
  return out;
}

std::string with_other_number(std::string bytes, Draws& draws) {
  constexpr const char* kNumbers[] = {"0",          "-1",   "1e39", "4294967296", "0.5",
                                      "2147483647", "1e-9", "nan",  "99999",      "-0.0"};
  const std::size_t at = draws.below(bytes.size());
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    const std::size_t place = (at + k) % bytes.size();
    if (!is_digit(bytes[place])) continue;
    const Range number = run_at(bytes, place, [](char c) { return !is_digit(c) && c != '.'; });
    return bytes.replace(number.begin, number.end - number.begin,
                         kNumbers[draws.below(std::size(kNumbers))]);
  }
  return bytes;
}

// A run between blanks a second time, somewhere else.
std::string with_repeated_token(std::string bytes, Draws& draws) {
  const Range token = run_at(bytes, draws.below(bytes.size()), is_blank);
  constexpr std::size_t kLongest = 200;
  const std::string text =
      bytes.substr(token.begin, std::min(token.end - token.begin, kLongest)) + " ";
  const Range before = run_at(bytes, draws.below(bytes.size()), is_blank);
  return bytes.insert(before.begin, text);
}

std::string mutated(const std::string& whole, std::uint64_t mutation) {
  Draws draws(mutation);
  std::string bytes = whole;
  const auto flip = [&](std::size_t reach) {
    char& byte = bytes[draws.below(std::min(reach, bytes.size()))];
    byte = static_cast<char>(byte ^ static_cast<char>(1 + draws.below(255)));
  };
  switch (mutation % 5) {
    case 0:
      bytes.resize(draws.below(bytes.size()));
      break;
    case 1:
      return with_other_number(std::move(bytes), draws);
    case 2:
      return with_repeated_token(std::move(bytes), draws);
    case 3:
      flip(bytes.size());
      break;
    default:  // where headers are
      for (int i = 0; i < 3; ++i) flip(400);
      break;
  }
  return bytes;
}

std::string bytes_of(const std::string& file) {
  DiagnosticLog log;
  auto bytes = read_file(std::string(PANWRIGHT_SOURCE_DIR) + "/tests/" + file, 1 << 26, log);
  EXPECT_TRUE(bytes) << to_text(log);
  return bytes ? std::move(*bytes) : std::string(1, ' ');
}

// Spread over the files, which are sound as they are.
void damage(Source source, const std::vector<std::string>& files, std::uint64_t mutations) {
  std::vector<std::string> wholes;
  for (const std::string& file : files) {
    wholes.push_back(bytes_of(file));
    EXPECT_TRUE(fuzz::roundtrip(source, as_bytes(wholes.back()))) << file;
  }
  std::uint64_t written = 0;
  for (std::uint64_t i = 0; i < mutations; ++i) {
    const std::string bytes = mutated(wholes[i / 5 % wholes.size()], i);
    written += fuzz::roundtrip(source, as_bytes(bytes)) ? 1 : 0;
  }
  // both ends are reached
  EXPECT_GT(written, 0u);
  EXPECT_LT(written, mutations);
  testing::Test::RecordProperty("written", static_cast<int>(written));
}

TEST(Mutations, Pxn) {
  damage(Source::pxn, {"fuzz/corpus/pxn/level1.pxn", "fuzz/corpus/pxn/shapes.pxn"}, kMutations);
}
TEST(Mutations, Vrml) {
  damage(Source::vrml,
         {"fuzz/corpus/vrml/everything97.wrl", "fuzz/corpus/vrml/everything10.wrl",
          "fuzz/corpus/vrml/exporters97.wrl"},
         kMutations);
}
TEST(Mutations, Gltf) {
  damage(Source::gltf, {"fuzz/corpus/gltf/rich.gltf", "fuzz/corpus/gltf/files.gltf"}, kMutations);
}
TEST(Mutations, Glb) {
  damage(Source::gltf,
         {"fuzz/corpus/gltf/rich.glb", "fuzz/corpus/gltf/meshopt.glb",
          "fuzz/corpus/gltf/skin-morph-instances.glb"},
         kMutations);
}
TEST(Mutations, Obj) { damage(Source::obj, {"fuzz/corpus/mesh/rich.obj"}, kMutations); }
TEST(Mutations, Stl) {
  damage(Source::stl, {"fuzz/corpus/mesh/binary.stl", "fuzz/corpus/mesh/text.stl"}, kMutations);
}
TEST(Mutations, Ply) {
  damage(Source::ply,
         {"fuzz/corpus/mesh/little.ply", "fuzz/corpus/mesh/big.ply", "fuzz/corpus/mesh/text.ply"},
         kMutations);
}
TEST(Mutations, Urdf) {
  damage(Source::urdf, {"../examples/cad/arm.urdf", "fuzz/corpus/urdf/robot.urdf"}, kMutations);
}
TEST(Mutations, Mjcf) {
  damage(Source::mjcf, {"../examples/cad/arm_mjcf.xml", "fuzz/corpus/mjcf/model.xml"}, kMutations);
}
TEST(Mutations, Step) {
  if (!importers::reads_step()) GTEST_SKIP() << "built without OpenCASCADE";
  damage(Source::step, {"importers/step/data/W6602.step"}, kStepMutations);
}
TEST(Mutations, Trajectories) {
  std::vector<std::string> wholes;
  for (const char* file : {"orbit.oem", "orbit.xml", "attitude.aem", "flight.fli", "table.csv",
                           "basilisk.csv", "keys.json"}) {
    wholes.push_back(bytes_of(std::string("fuzz/corpus/scenario/") + file));
    EXPECT_GT(fuzz::scenario(as_bytes(wholes.back())), 0u) << file;
  }
  std::size_t read = 0;
  for (std::uint64_t i = 0; i < 7 * kMutations; ++i)
    read += fuzz::scenario(as_bytes(mutated(wholes[i / 5 % wholes.size()], i))) > 0 ? 1 : 0;
  EXPECT_GT(read, 7 * kMutations / 10);
  EXPECT_LT(read, 7 * kMutations);
}
TEST(Mutations, Terrain) {
  std::vector<std::string> wholes;
  for (const char* file :
       {"attached.img", "detached.lbl", "tiled.cub", "header.hdr", "label.xml", "strips.tif",
        "tiles.tif", "plates.tab", "plates.plt", "cube.icq", "plates.bds"}) {
    wholes.push_back(bytes_of(std::string("fuzz/corpus/terrain/") + file));
    EXPECT_TRUE(fuzz::terrain(as_bytes(wholes.back()))) << file;
  }
  std::size_t read = 0;
  for (std::uint64_t i = 0; i < 11 * kMutations; ++i)
    read += fuzz::terrain(as_bytes(mutated(wholes[i / 5 % wholes.size()], i))) ? 1 : 0;
  EXPECT_GT(read, 11 * kMutations / 10);
  EXPECT_LT(read, 11 * kMutations);
}
TEST(Mutations, Pan) {
  for (std::uint64_t i = 0; i < kMutations; ++i) {
    const std::string whole =
        bytes_of(i / 5 % 2 == 0 ? "fuzz/corpus/pan/small.bin" : "fuzz/corpus/pan/compressed.bin");
    fuzz::pan(as_bytes(mutated(whole, i)));
  }
}

}  // namespace
}  // namespace panwright::mutation_test
