// Files of all kinds, cut short and with bytes changed: what can be read is, or a reason is given.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "base/clock.h"
#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::damage_test {
namespace {

constexpr int kCuts = 500;
constexpr int kChanges = 2000;
constexpr double kMostSeconds = 5;

// Bits of a counter (Steele and others' splitmix64).
std::uint64_t mixed(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15u;
  n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
  n = (n ^ n >> 27) * 0x94d049bb133111ebu;
  return n ^ n >> 31;
}

double read_damaged(const std::string& name, const std::string& bytes) {
  Options options;
  options.limits.memory = 64 << 20;
  const auto start = std::chrono::steady_clock::now();
  const auto out = read_meshes({{name, bytes}}, options);
  if (out->out) {
    EXPECT_EQ(scene::check(out->scene()), "") << name;
    EXPECT_EQ(out->out->materials.size(), out->scene().materials.size());
  } else {
    EXPECT_TRUE(out->log.has_errors()) << name << " is refused without a reason";
  }
  EXPECT_LT(out->text().size(), 1u << 20);
  return seconds_since(start);
}

// Everything that OBJ has.
std::string rich_obj() {
  std::string out = "mtllib none.mtl\no bus\nvt 0 0\nvt 1 0.5\nvn 0 0 1\n" + obj_of(ball(8, 10));
  return out +
         "g a b\ns 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1 4/2/1\ns off\nf -1 -2 \\\n-3\nl 1 2\n"
         "v 1 2 3 0.5 0.5 0.5\nf 1//1 2//1 -1//1\n";
}

TEST(DamagedMeshes, AreReadOrRefused) {
  Polyhedron triangles = ball(8, 10);
  for (auto& face : triangles.faces) face.resize(3);
  const Polyhedron quads = ball(8, 10);
  const std::pair<std::string, std::string> files[] = {{"m.obj", rich_obj()},
                                                       {"text.stl", stl_text_of(quads)},
                                                       {"binary.stl", stl_binary_of(triangles)},
                                                       {"text.ply", ply_of(quads, Order::text)},
                                                       {"little.ply", ply_of(quads, Order::little)},
                                                       {"big.ply", ply_of(quads, Order::big)}};
  for (const auto& [name, whole] : files) {
    double slowest = 0;
    for (int i = 0; i < kCuts; ++i) {
      const std::size_t size = mixed(static_cast<std::uint64_t>(i)) % whole.size();
      slowest = std::max(slowest, read_damaged(name, whole.substr(0, size)));
      ASSERT_FALSE(HasFailure()) << name << " cut to " << size;
    }
    for (int i = 0; i < kChanges; ++i) {
      const std::uint64_t random = mixed(static_cast<std::uint64_t>(kCuts + i));
      std::string changed = whole;
      // half of them near the beginning, where the header is
      const std::size_t reach =
          i % 2 == 0 ? whole.size() : std::min<std::size_t>(400, whole.size());
      char& byte = changed[random % reach];
      byte = static_cast<char>(byte ^ static_cast<char>(1 + (random >> 40) % 255));
      slowest = std::max(slowest, read_damaged(name, changed));
      ASSERT_FALSE(HasFailure()) << name << " byte " << random % reach << " of change " << i;
    }
    EXPECT_LT(slowest, kMostSeconds) << name;
    std::printf("%s: slowest %.3f s\n", name.c_str(), slowest);
  }
}

}  // namespace
}  // namespace panwright::importers::damage_test
