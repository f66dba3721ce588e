// Compilations that find what earlier ones made: the same bytes, and one changed part alone.

#include "compiler/internal/kept_meshes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "base/file.h"
#include "compiler/compile.h"
#include "geometry/mesh/bytes.h"
#include "pan/model.h"

namespace panwright::compiler::kept_meshes_test {
namespace {

namespace fs = std::filesystem;

// A wavy sheet of n × n quads, as a file has it.
geometry::MeshShape waves(int n, double phase) {
  auto mesh = std::make_shared<geometry::Mesh>();
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      mesh->positions.push_back({x, y, 0.05 * det::sin(6 * x + phase) * det::sin(5 * y)});
      mesh->normals.push_back({0, 0, 1});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::uint32_t>(j * (n + 1) + i);
      const auto up = at + static_cast<std::uint32_t>(n) + 1;
      mesh->triangles.push_back({at, at + 1, up + 1});
      mesh->triangles.push_back({at, up + 1, up});
    }
  return mesh;
}

// Six exact shapes, one of them small, and two meshes, side by side; a decal on the first sphere.
scene::Scene parts() {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.materials.emplace_back();
  geometry::Tube pipe;
  pipe.path = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}};
  pipe.radius = 0.1;
  pipe.spline = true;
  pipe.counts = {32, 20};
  geometry::Sphere sphere, other;
  sphere.counts = geometry::SphereCounts{24, 24};
  other.counts = geometry::SphereCounts{25, 24};
  geometry::Torus torus;
  torus.counts = {40, 16};
  geometry::Dish dish;
  dish.thickness = 0.01;
  dish.counts = {40, 8};
  scene.shapes = {sphere, other, torus, dish, pipe, geometry::Box{}, waves(24, 0), waves(24, 0.3)};
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    scene.nodes.push_back({"n" + std::to_string(i), 0, {}, {}});
    scene.nodes.back().parent_from_node.translation = {3.0 * static_cast<double>(i), 0, 0};
    scene::Instance instance;
    instance.node = static_cast<std::int32_t>(i + 1);
    instance.shape = static_cast<std::int32_t>(i);
    scene.instances.push_back(instance);
  }
  scene.textures.push_back({"t", 1, 1, {255, 0, 0, 255}, false});
  scene::Decal decal;
  decal.at = {1, 0, 0};
  decal.width = decal.height = 0.2;
  scene.decals.push_back(decal);
  return scene;
}

class KeptMeshes : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-kept-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  struct Compiled {
    std::vector<std::byte> pan;
    std::string says;
    WorkCounts counts;
  };
  Compiled compile(const scene::Scene& scene, bool cached, std::size_t threads = 2) const {
    const WorkCache cache(folder);
    Options options;
    options.mesh_levels = true;
    if (cached) options.cache = &cache;
    DiagnosticLog log;
    Compiled out;
    auto bytes = compiled(scene, options, log, Job({threads, {}}));
    EXPECT_TRUE(bytes) << to_text(log);
    if (bytes) out.pan = *std::move(bytes);
    out.says = to_text(log);
    out.counts = cache.counts();
    return out;
  }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path());
    return out;
  }
  fs::path folder;
};

TEST_F(KeptMeshes, TheSameBytesWithAndWithoutWhateverTheThreads) {
  const Compiled without = compile(parts(), false);
  EXPECT_EQ(without.counts.all().made, 0u);
  const Compiled first = compile(parts(), true);
  EXPECT_EQ(first.pan, without.pan);
  // the box is made faster than a file is read
  EXPECT_EQ(first.counts[Work::meshes].made, 5u);
  const std::uint64_t levels = first.counts[Work::levels].made;
  EXPECT_GE(levels, 5u);
  for (const std::size_t threads : {1, 2, 4}) {
    const Compiled again = compile(parts(), true, threads);
    EXPECT_EQ(again.pan, without.pan) << threads;
    EXPECT_EQ(again.says, without.says);
    EXPECT_EQ(again.counts[Work::meshes].reused, 5u);
    EXPECT_EQ(again.counts[Work::levels].reused, levels);
    EXPECT_EQ(again.counts.all().made, 0u);
  }
}

TEST_F(KeptMeshes, AChangedPartIsMadeAlone) {
  compile(parts(), true);
  scene::Scene changed = parts();
  std::get<geometry::Torus>(changed.shapes[2]).tube_radius = 0.11;
  const Compiled exact = compile(changed, true);
  EXPECT_EQ(exact.pan, compile(changed, false).pan);
  EXPECT_EQ(exact.counts[Work::meshes].made, 1u);
  EXPECT_EQ(exact.counts[Work::meshes].reused, 4u);
  EXPECT_EQ(exact.counts[Work::levels].made, 1u);
  changed = parts();
  changed.shapes[7] = waves(24, 0.4);
  const Compiled mesh = compile(changed, true);
  EXPECT_EQ(mesh.pan, compile(changed, false).pan);
  EXPECT_EQ(mesh.counts[Work::meshes].made, 0u);
  EXPECT_EQ(mesh.counts[Work::levels].made, 1u);
  // names, places, materials, decals and order decide no mesh
  changed = parts();
  changed.nodes[3].name = "another";
  changed.nodes[3].parent_from_node.translation = {0, 9, 0};
  changed.materials[0].diffuse = Vec3(0.3);
  changed.decals[0].at = {0, 1, 0};
  std::swap(changed.instances[1], changed.instances[3]);
  const Compiled moved = compile(changed, true);
  EXPECT_EQ(moved.pan, compile(changed, false).pan);
  EXPECT_EQ(moved.counts.all().made, 0u);
}

TEST_F(KeptMeshes, DamagedAndForeignEntriesAreReplaced) {
  const Compiled first = compile(parts(), true);
  const std::uint64_t all = first.counts.all().made;
  const auto damage = [&](const std::function<void(const fs::path&)>& change) {
    for (const fs::path& entry : entries()) change(entry);
    const Compiled again = compile(parts(), true);
    EXPECT_EQ(again.pan, first.pan);
    EXPECT_EQ(again.says, first.says);
    EXPECT_EQ(again.counts.all().made, all);
    EXPECT_EQ(compile(parts(), true).counts.all().made, 0u) << "and kept again";
  };
  damage([](const fs::path& entry) { fs::resize_file(entry, fs::file_size(entry) / 2); });
  damage([](const fs::path& entry) { fs::resize_file(entry, 0); });
  damage([](const fs::path& entry) {
    std::fstream file(entry, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(entry) - 5));
    file.put('#');
  });
  // each has the next one's name
  std::vector<fs::path> names = entries();
  fs::rename(names.back(), folder / "last");
  for (std::size_t i = names.size() - 1; i > 0; --i) fs::rename(names[i - 1], names[i]);
  fs::rename(folder / "last", names[0]);
  damage([](const fs::path&) {});
}

TEST_F(KeptMeshes, WhatABudgetSimplifiesIsKept) {
  scene::Scene scene = parts();
  scene.budget.nearest = 200;
  scene.budget.ifov = 1e-4;
  scene.budget.pixels = 0.5;
  const Compiled without = compile(scene, false);
  const Compiled first = compile(scene, true);
  const Compiled again = compile(scene, true);
  EXPECT_EQ(first.pan, without.pan);
  EXPECT_EQ(again.pan, without.pan);
  EXPECT_EQ(again.says, without.says);
  EXPECT_EQ(first.counts[Work::simplified].made, 2u);
  EXPECT_EQ(again.counts[Work::simplified].reused, 2u);
  EXPECT_EQ(again.counts.all().made, 0u);
}

TEST(MeshKeys, HoldEveryInput) {
  geometry::Shape sphere = geometry::Sphere{}, larger = geometry::Ellipsoid{};
  internal::MeshJob job;
  job.shape = &sphere;
  job.hash = geometry::hash_of(sphere);
  const geometry::TessellationOptions usual;
  std::set<Hash128> keys{internal::mesh_key(job, usual)};
  std::size_t count = 1;
  const auto expect_new = [&](const char* what, const internal::MeshJob& other,
                              const geometry::TessellationOptions& options) {
    keys.insert(internal::mesh_key(other, options));
    EXPECT_EQ(keys.size(), ++count) << what;
  };
  const auto with_options = [&](const auto& change) {
    geometry::TessellationOptions options;
    change(options);
    return options;
  };
  const auto with_job = [&](const auto& change) {
    internal::MeshJob other = job;
    change(other);
    return other;
  };
  expect_new("error", job, with_options([](auto& o) { o.max_error *= 1 + 1e-15; }));
  expect_new("texcoords", job, with_options([](auto& o) { o.texcoords = true; }));
  expect_new("limit", job, with_options([](auto& o) { o.max_triangles = 100; }));
  expect_new("segments", job, with_options([](auto& o) { o.edge_segments = 12; }));
  expect_new("shape", with_job([&](auto& j) { j.hash = geometry::hash_of(larger); }), usual);
  expect_new("boxed", with_job([](auto& j) { j.boxed = true; }), usual);
  const auto projected = [](auto& j) {
    j.textured = true;
    j.mapping = scene::Mapping::sphere;
  };
  expect_new("projected", with_job(projected), usual);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      expect_new("projection", with_job([&](auto& j) {
                   projected(j);
                   j.texture_from_shape[column][row] += 1e-9 * (1 + column);
                 }),
                 usual);
  // what is no part of the mesh
  job.max_error = 7;
  job.decals = {1, 2};
  EXPECT_TRUE(keys.contains(internal::mesh_key(job, usual)));
}

// What lies under a right key with a right checksum, and is no mesh.
TEST(MeshBytes, UnsoundMeshesAreRefused) {
  const pan::PackedMesh good = pan::packed(*waves(3, 0), "");
  const auto reads = [](const pan::PackedMesh& mesh) {
    ByteWriter to;
    internal::write_packed(mesh, to);
    ByteReader from(to.bytes());
    const pan::PackedMesh back = internal::read_packed(from);
    return from.at_end() && back.positions == mesh.positions && back.indices == mesh.indices;
  };
  EXPECT_TRUE(reads(good));
  const auto refused = [&](const char* what, const auto& change) {
    pan::PackedMesh bad = good;
    change(bad);
    EXPECT_FALSE(reads(bad)) << what;
  };
  refused("index", [](auto& m) { m.indices[4] = 16; });
  refused("no triangle", [](auto& m) { m.indices.clear(); });
  refused("part of a triangle", [](auto& m) { m.indices.pop_back(); });
  refused("normals", [](auto& m) { m.normals.pop_back(); });
  refused("texcoords", [](auto& m) { m.texcoords.resize(3); });
  refused("number", [](auto& m) { m.positions[3] = NAN; });
  refused("origin", [](auto& m) { m.origin.y = HUGE_VAL; });
  ByteWriter to;
  internal::write_packed(good, to);
  for (std::size_t size = 0; size < to.bytes().size(); ++size) {
    ByteReader from(to.bytes().first(size));
    internal::read_packed(from);
    EXPECT_FALSE(from.at_end()) << size;
  }
  geometry::Mesh mesh = *waves(3, 0);
  mesh.triangles[2][1] = 16;
  ByteWriter other;
  geometry::write(mesh, other);
  ByteReader from(other.bytes());
  geometry::read_mesh(from);
  EXPECT_FALSE(from.good());
}

}  // namespace
}  // namespace panwright::compiler::kept_meshes_test
