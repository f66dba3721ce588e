// Searches that were made before: the same result, and never that of something else.

#include "compiler/internal/visibility_cache.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "assemblies.h"
#include "compiler/compile.h"
#include "compiler/hidden.h"

namespace panwright::compiler::visibility_cache_test {
namespace {

namespace fs = std::filesystem;
using internal::Visibility;
using internal::VisibilityModel;
using internal::VisibilityOptions;

// A chest without a lid, in numbers that every compiler makes alike; a block that shows through the
// top, one in it that does not, and one more of both.
scene::Scene chest() {
  assemblies::Builder builder("chest");
  geometry::Mesh open = assemblies::block(Vec3(2), 8);
  open.triangles.resize(open.triangles.size() - 2 * 8 * 8);
  const std::int32_t inner = builder.add_mesh(assemblies::block(Vec3(0.75), 6));
  const std::int32_t hidden = builder.add_mesh(assemblies::block(Vec3(0.5), 6));
  builder.add(builder.add_mesh(open), Vec3(0), true);
  for (const double x : {-0.45, 0.45}) {
    builder.add(inner, Vec3(x, 0, -0.5), true);
    builder.add(hidden, Vec3(x, 0, -0.5), false);
  }
  return builder.done().scene;
}

VisibilityModel model_of(const scene::Scene& scene) {
  VisibilityModel model;
  for (const geometry::Shape& shape : scene.shapes) {
    model.meshes.push_back(std::get<geometry::MeshShape>(shape));
    model.divisible.push_back(1);
  }
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  for (const scene::Instance& instance : scene.instances) {
    internal::VisibilityPart part;
    part.mesh = static_cast<std::uint32_t>(instance.shape);
    part.world_from_mesh = world[static_cast<std::size_t>(instance.node)];
    model.parts.push_back(part);
  }
  return model;
}

std::vector<std::byte> bytes_of(const Visibility& found) {
  ByteWriter to;
  internal::write_visibility(found, to);
  return to.take();
}

constexpr std::uint64_t kRays = 500'000;  // more than are worth keeping

class VisibilityCache : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "panwright-visibility-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
    fs::remove(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  struct Pruned {
    std::vector<std::byte> pan;
    std::string says;
    HiddenReport report;
  };
  Pruned prune(scene::Scene scene, const WorkCache* cache, HiddenOptions options = {}) {
    options.cache = cache;
    options.max_rays = kRays;
    DiagnosticLog log;
    Pruned out;
    out.report = *prune_hidden(scene, options, log);
    out.says = to_text(log);
    // which a compiled mesh needs, and the search does not
    for (geometry::Shape& shape : scene.shapes)
      if (auto* mesh = std::get_if<geometry::MeshShape>(&shape)) {
        auto with_normals = std::make_shared<geometry::Mesh>(**mesh);
        with_normals->normals.assign(with_normals->positions.size(), Vec3(0, 0, 1));
        *mesh = std::move(with_normals);
      }
    out.pan = *compiled(scene, {}, log);
    return out;
  }
  std::size_t entries() const {
    if (!fs::exists(folder)) return 0;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }
  fs::path folder;
};

TEST_F(VisibilityCache, AHitIsEqualToTheBit) {
  const WorkCache cache(folder);
  const Pruned without = prune(chest(), nullptr);
  const Pruned first = prune(chest(), &cache);
  EXPECT_EQ(entries(), 1u);
  const Pruned second = prune(chest(), &cache);
  EXPECT_FALSE(without.report.cached);
  EXPECT_FALSE(first.report.cached);
  EXPECT_TRUE(second.report.cached);
  EXPECT_LT(without.report.triangles_after, without.report.triangles_before);
  for (const Pruned* one : {&first, &second}) {
    EXPECT_EQ(one->pan, without.pan);
    EXPECT_EQ(one->says, without.says);
    EXPECT_EQ(one->report.rays, without.report.rays);
    EXPECT_EQ(one->report.ambiguous, without.report.ambiguous);
    EXPECT_EQ(one->report.open_share, without.report.open_share);
    EXPECT_EQ(one->report.instances_after, without.report.instances_after);
  }
  EXPECT_NE(without.says.find("N6304"), std::string::npos);
}

TEST_F(VisibilityCache, WhatIsDamagedIsSearchedAnew) {
  const WorkCache cache(folder);
  const Pruned first = prune(chest(), &cache);
  const fs::path entry = fs::directory_iterator(folder)->path();
  {
    std::fstream file(entry, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(60);
    file.put('x');
  }
  const Pruned second = prune(chest(), &cache);
  EXPECT_FALSE(second.report.cached);
  EXPECT_EQ(second.pan, first.pan);
  EXPECT_TRUE(prune(chest(), &cache).report.cached) << "and kept again";
}

// What lies in a cache under a right key with a right checksum, and is of another model.
TEST_F(VisibilityCache, AnEntryOfAnotherShapeIsNone) {
  const VisibilityModel model = model_of(chest());
  const std::vector<std::byte> bytes = bytes_of(internal::visibility_of(model, {64, kRays, 0}, {}));
  const auto read = [](std::span<const std::byte> from, const VisibilityModel& of) {
    ByteReader reader(from);
    const Visibility found = internal::read_visibility(of, reader);
    return reader.at_end() ? std::optional(found) : std::nullopt;
  };
  const auto back = read(bytes, model);
  ASSERT_TRUE(back);
  EXPECT_EQ(bytes_of(*back), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(read(std::span(bytes).first(size), model)) << size;
  VisibilityModel other = model;
  other.parts.pop_back();
  EXPECT_FALSE(read(bytes, other));
  other = model;
  std::swap(other.meshes[0], other.meshes[2]);
  EXPECT_FALSE(read(bytes, other));
}

TEST_F(VisibilityCache, EveryInputIsInTheKey) {
  const VisibilityModel model = model_of(chest());
  const VisibilityOptions usual{64, 1'000'000, 0};
  std::set<Hash128> keys{internal::visibility_key(model, usual)};
  std::size_t count = 1;
  const auto expect_new = [&](const char* what, const VisibilityModel& other,
                              const VisibilityOptions& options) {
    EXPECT_EQ(internal::visibility_key(other, options), internal::visibility_key(other, options));
    keys.insert(internal::visibility_key(other, options));
    EXPECT_EQ(keys.size(), ++count) << what;
  };
  const auto with_mesh = [&](const auto& change) {
    VisibilityModel other = model;
    auto mesh = std::make_shared<geometry::Mesh>(*model.meshes[1]);
    change(*mesh);
    other.meshes[1] = mesh;
    return other;
  };
  const auto with_part = [&](const auto& change) {
    VisibilityModel other = model;
    change(other.parts[2]);
    return other;
  };
  expect_new("position", with_mesh([](geometry::Mesh& m) { m.positions[5].y += 1e-15; }), usual);
  expect_new("unused position",
             with_mesh([](geometry::Mesh& m) { m.positions.push_back(Vec3(0)); }), usual);
  expect_new("winding",
             with_mesh([](geometry::Mesh& m) { std::swap(m.triangles[3][0], m.triangles[3][1]); }),
             usual);
  expect_new("triangle", with_mesh([](geometry::Mesh& m) { m.triangles.pop_back(); }), usual);
  expect_new("mesh", with_part([](internal::VisibilityPart& p) { p.mesh = 2; }), usual);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      expect_new("place", with_part([&](internal::VisibilityPart& p) {
                   p.world_from_mesh[column][row] += 1e-9 * (1 + column);
                 }),
                 usual);
  expect_new("cut-out", with_part([](internal::VisibilityPart& p) { p.transparent = true; }),
             usual);
  expect_new("kept", with_part([](internal::VisibilityPart& p) { p.candidate = false; }), usual);
  VisibilityModel other = model;
  other.divisible[1] = 0;
  expect_new("divisible", other, usual);
  other = model;
  other.parts.pop_back();
  expect_new("part", other, usual);
  expect_new("rays", model, {65, 1'000'000, 0});
  expect_new("bound", model, {64, 1'000'001, 0});
  expect_new("slack", model, {64, 1'000'000, 1e-6});
  // what the search does not see
  auto mesh = std::make_shared<geometry::Mesh>(*model.meshes[1]);
  mesh->normals.assign(mesh->positions.size(), Vec3(0, 0, 1));
  mesh->error = 1;
  other = model;
  other.meshes[1] = mesh;
  EXPECT_EQ(internal::visibility_key(other, usual), internal::visibility_key(model, usual));
}

// One cache for a lid that is fixed, that slides, and whose range has no length.
TEST_F(VisibilityCache, JointsMakeOtherModels) {
  const WorkCache cache(folder);
  scene::Scene closed = chest();
  closed.shapes.push_back(
      std::make_shared<const geometry::Mesh>(assemblies::block({2, 2, 0.1}, 8)));
  scene::Node node;
  node.name = "lid";
  node.parent = 0;
  node.parent_from_node.translation = {0, 0, 1.05};
  closed.nodes.push_back(node);
  scene::Instance lid;
  lid.node = static_cast<std::int32_t>(closed.nodes.size() - 1);
  lid.shape = static_cast<std::int32_t>(closed.shapes.size() - 1);
  closed.instances.push_back(lid);
  scene::Scene sliding = closed;
  scene::Joint joint;
  joint.name = "slide";
  joint.node = lid.node;
  joint.kind = scene::JointKind::prismatic;
  joint.axis = {1, 0, 0};
  joint.lower = {0};
  joint.upper = {1.5};
  sliding.joints.push_back(joint);
  scene::Scene stuck = sliding;
  stuck.joints[0].upper = {0};
  std::set<std::uint64_t> left;
  for (int run = 0; run < 2; ++run)
    for (const scene::Scene* scene : {&closed, &sliding, &stuck}) {
      const Pruned with = prune(*scene, &cache);
      const Pruned without = prune(*scene, nullptr);
      EXPECT_EQ(with.pan, without.pan);
      EXPECT_EQ(with.says, without.says);
      left.insert(with.report.triangles_after);
    }
  EXPECT_EQ(left.size(), 2u) << "a lid that can move uncovers";
}

TEST_F(VisibilityCache, SmallSearchesLeaveNoFiles) {
  const WorkCache cache(folder);
  const Pruned done = prune(assemblies::nested_boxes(1, 2).scene, &cache);
  EXPECT_FALSE(done.report.cached);
  EXPECT_EQ(entries(), 0u);
}

// The same result on any machine and from any compiler.
TEST_F(VisibilityCache, FindsTheSame) {
  const Visibility found = internal::visibility_of(model_of(chest()), {64, kRays, 0}, {});
  EXPECT_EQ(hash128(bytes_of(found)).hex(), "bad4f0dcbe66f7ae80a1d3c69f1f29f0");
}

}  // namespace
}  // namespace panwright::compiler::visibility_cache_test
