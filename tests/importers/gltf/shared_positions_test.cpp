// Primitives that share one accessor of positions: the same triangles as of accessors of their own,
// and memory by the triangles.
#include <gtest/gtest.h>

#include <set>

#include "tests/importers/gltf/sample.h"

namespace panwright::importers::gltf::shared_positions_test {
namespace {

// A row of triangles, one for each primitive; of `vertices` positions in all.
Sample row(std::size_t primitives, std::size_t vertices, bool own) {
  Sample sample;
  std::vector<float> positions, normals, texcoords;
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto x = static_cast<float>(v);
    positions.insert(positions.end(), {x, x * x / 1024, (v % 3 == 2) ? 1.0f : 0.0f});
    normals.insert(normals.end(), {0, v % 2 == 0 ? -1.0f : 1.0f, 0});
    texcoords.insert(texcoords.end(), {x / 64, 0.5f});
  }
  nlohmann::json shared;
  const auto add = [&](const std::vector<float>& p, const std::vector<float>& n,
                       const std::vector<float>& t) {
    nlohmann::json attributes = {{"POSITION", sample.numbers(p, kFloat, "VEC3", 3)},
                                 {"NORMAL", sample.numbers(n, kFloat, "VEC3", 3)},
                                 {"TEXCOORD_0", sample.numbers(t, kFloat, "VEC2", 2)}};
    nlohmann::json& accessor = sample.json["accessors"][attributes["POSITION"].get<std::size_t>()];
    float low[3] = {1e9f, 1e9f, 1e9f}, high[3] = {-1e9f, -1e9f, -1e9f};
    for (std::size_t i = 0; i < p.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], p[i]);
      high[i % 3] = std::max(high[i % 3], p[i]);
    }
    accessor["min"] = {low[0], low[1], low[2]};
    accessor["max"] = {high[0], high[1], high[2]};
    return attributes;
  };
  if (!own) shared = add(positions, normals, texcoords);
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < primitives; ++i) {
    // corners far apart, and not in ascending order
    const std::size_t corners[] = {i + vertices / 2, i, i + vertices / 4};
    std::vector<std::uint16_t> indices;
    if (own) {
      std::vector<float> p, n, t;
      std::set<std::size_t> ascending(std::begin(corners), std::end(corners));
      for (const std::size_t v : ascending) {
        p.insert(p.end(), &positions[3 * v], &positions[3 * v] + 3);
        n.insert(n.end(), &normals[3 * v], &normals[3 * v] + 3);
        t.insert(t.end(), &texcoords[2 * v], &texcoords[2 * v] + 2);
      }
      indices = {2, 0, 1};
      shared = add(p, n, t);
    } else {
      for (const std::size_t v : corners) indices.push_back(static_cast<std::uint16_t>(v));
    }
    list.push_back({{"attributes", shared},
                    {"indices", sample.numbers(indices, kUnsignedShort, "SCALAR", 1)}});
  }
  sample.json["meshes"] = {{{"primitives", list}}};
  sample.json["nodes"] = {{{"mesh", 0}}};
  sample.json["scenes"] = {{{"nodes", {0}}}};
  return sample;
}

TEST(SharedPositions, GiveTheMeshesOfPositionsOfTheirOwn) {
  const Loaded shared = load(row(20, 200, false).glb()), own = load(row(20, 200, true).glb());
  ASSERT_TRUE(shared.imported && own.imported) << shared.text() << own.text();
  EXPECT_EQ(shared.log.entries().size(), 0u) << shared.text();
  ASSERT_EQ(shared.imported->scene.instances.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    const geometry::Mesh& a = mesh_of(*shared.imported, i);
    const geometry::Mesh& b = mesh_of(*own.imported, i);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.texcoords, b.texcoords);
    EXPECT_EQ(a.triangles, b.triangles);
  }
}

TEST(SharedPositions, TakeMemoryByTheirTriangles) {
  Options options;
  options.limits.memory = 8u << 20;  // 2,000 times all 20,000 positions were 3.8 GB
  const Loaded loaded = load(row(2000, 20000, false).glb(), options);
  ASSERT_TRUE(loaded.imported) << loaded.text();
  EXPECT_FALSE(loaded.log.has_errors()) << loaded.text();
  ASSERT_EQ(loaded.imported->scene.shapes.size(), 2000u);
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < 2000; ++i) vertices += mesh_of(*loaded.imported, i).positions.size();
  EXPECT_EQ(vertices, 6000u);
}

TEST(SharedPositions, ProblemsOfTheAccessorAreReportedOnce) {
  Sample sample = row(20, 200, false);
  sample.json["accessors"][0]["max"] = {1, 2, 3};
  const Loaded loaded = load(sample.glb());
  std::size_t reports = 0;
  for (const Diagnostic& entry : loaded.log.entries()) reports += entry.code == Code("W6212");
  EXPECT_EQ(reports, 1u) << loaded.text();
}

}  // namespace
}  // namespace panwright::importers::gltf::shared_positions_test
