// Levels of detail of meshes in compiled models.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "compiler/compile.h"
#include "geometry/mesh/closest.h"
#include "pan/model.h"

namespace panwright::compiler::mesh_levels_test {
namespace {

// Half of a dish of n × n quads; the two halves meet at x = 0.
geometry::MeshShape half(int n, double from, double to) {
  auto mesh = std::make_shared<geometry::Mesh>();
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = from + (to - from) * i / n, y = 2.0 * j / n - 1;
      mesh->positions.push_back({x, y, 0.3 * (x * x + y * y)});
      mesh->normals.push_back(glm::normalize(Vec3(-0.6 * x, -0.6 * y, 1)));
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

scene::Scene scene_of(std::vector<geometry::Shape> shapes) {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.materials.emplace_back();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    scene.nodes.push_back({"n" + std::to_string(i), 0, {}, {}});
    scene::Instance instance;
    instance.node = static_cast<std::int32_t>(i + 1);
    instance.shape = static_cast<std::int32_t>(i);
    scene.instances.push_back(instance);
  }
  scene.shapes = std::move(shapes);
  return scene;
}

std::vector<std::byte> bytes_of(const scene::Scene& scene, bool levels, const Job& job = {}) {
  DiagnosticLog log;
  Options options;
  options.mesh_levels = levels;
  auto bytes = compiled(scene, options, log, job);
  EXPECT_TRUE(bytes) << to_text(log);
  return *std::move(bytes);
}

pan::Model load(const scene::Scene& scene, bool levels = true) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(bytes_of(scene, levels), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
}

geometry::Mesh unpacked(const pan::Model& model, std::uint32_t index) {
  geometry::Mesh mesh;
  const pan::MeshView view = model.mesh(index);
  const auto& origin = model.meshes()[index].origin;
  for (const auto& p : view.positions)
    mesh.positions.push_back(Vec3(origin[0], origin[1], origin[2]) + Vec3(p.x, p.y, p.z));
  for (std::size_t i = 0; i < view.indices.size(); i += 3)
    mesh.triangles.push_back({view.indices[i], view.indices[i + 1], view.indices[i + 2]});
  return mesh;
}

TEST(MeshLevels, AreMadeWhereTheyAreAskedFor) {
  const scene::Scene scene = scene_of({half(40, -1, 1), geometry::Box{}});
  EXPECT_TRUE(load(scene, false).levels().empty());
  const pan::Model model = load(scene);
  const auto levels = model.levels(0);
  ASSERT_GE(levels.size(), 2u);
  EXPECT_TRUE(model.levels(1).empty());  // 12 triangles
  const geometry::Mesh full = unpacked(model, model.instances()[0].mesh);
  std::set<std::array<double, 3>> places;
  for (const Vec3& p : full.positions) places.insert({p.x, p.y, p.z});
  std::size_t before = full.triangles.size();
  for (const pan::layout::Level& level : levels) {
    EXPECT_EQ(level.detail, 4 * level.error);
    EXPECT_EQ(level.material, model.instances()[0].material);
    const geometry::Mesh coarse = unpacked(model, level.mesh);
    EXPECT_LT(coarse.triangles.size(), before);
    before = coarse.triangles.size();
    // corners are where they were, to the bit
    for (const Vec3& p : coarse.positions) EXPECT_TRUE(places.contains({p.x, p.y, p.z}));
    // all of the full one's corners are within the bound
    for (const Vec3& p : full.positions)
      EXPECT_LE(geometry::closest_point(coarse, p)->distance, level.error);
    EXPECT_GE(model.meshes()[level.mesh].error, level.error);
  }
}

// A crack would open between halves whose common border came out differently.
TEST(MeshLevels, WhereMeshesMeetTheyGoOnMeeting) {
  const auto borders = [](const pan::Model& model, std::uint32_t mesh) {
    std::set<std::array<double, 3>> out;
    for (const Vec3& p : unpacked(model, mesh).positions)
      if (std::fabs(p.x) < 1e-6) out.insert({0, std::round(p.y * 1e5), std::round(p.z * 1e5)});
    return out;
  };
  const pan::Model model = load(scene_of({half(40, -1, 0), half(40, 0, 1)}));
  const auto want = borders(model, model.instances()[0].mesh);
  EXPECT_EQ(want.size(), 41u);
  for (std::uint32_t i = 0; i < 2; ++i) {
    ASSERT_GE(model.levels(i).size(), 2u) << i;
    for (const pan::layout::Level& level : model.levels(i))
      EXPECT_EQ(borders(model, level.mesh), want);
  }
  // alone, the border is as free as the rest
  const pan::Model alone = load(scene_of({half(40, -1, 0)}));
  ASSERT_GE(alone.levels(0).size(), 2u);
  EXPECT_LT(borders(alone, alone.levels(0).back().mesh).size(), 30u);
}

TEST(MeshLevels, TheBudgetSaysWhatAPixelMaySee) {
  scene::Scene scene = scene_of({half(60, -1, 1)});
  scene.budget.pixels = 0.5;
  const pan::Model looser = load(scene);
  EXPECT_EQ(looser.levels(0)[0].detail, 2 * looser.levels(0)[0].error);
  // a pixel sees 20 mm at the nearest: levels for less but the one that serves then are left out
  scene.budget = {};
  scene.budget.nearest = 20;
  scene.budget.ifov = 1e-3;
  const pan::Model near = load(scene);
  ASSERT_GE(near.levels(0).size(), 1u);
  EXPECT_GT(near.levels(0).back().detail, 0.02);
  if (near.levels(0).size() > 1) {
    EXPECT_GT(near.levels(0)[1].detail, 0.02);
  }
  EXPECT_EQ(near.meshes()[near.instances()[0].mesh].triangle_count, 7200u);
}

TEST(MeshLevels, MirroredAndStretchedInstancesShareThem) {
  scene::Scene scene = scene_of({half(40, -1, 1), half(40, -1, 1)});
  scene.nodes[2].parent_from_node.scale = Vec3(-2, 3, 0.5);
  scene.nodes[2].parent_from_node.translation = Vec3(50, 0, 0);
  const pan::Model model = load(scene);
  ASSERT_EQ(model.instances()[0].mesh, model.instances()[1].mesh);
  ASSERT_EQ(model.levels(0).size(), model.levels(1).size());
  for (std::size_t i = 0; i < model.levels(0).size(); ++i)
    EXPECT_EQ(model.levels(0)[i].mesh, model.levels(1)[i].mesh);
}

TEST(MeshLevels, SameBytesWhateverTheThreads) {
  const scene::Scene scene = scene_of({half(30, -1, 0), half(30, 0, 1), half(40, 2, 3)});
  EXPECT_EQ(bytes_of(scene, true, Job(JobOptions{1, {}})),
            bytes_of(scene, true, Job(JobOptions{4, {}})));
}

}  // namespace
}  // namespace panwright::compiler::mesh_levels_test
