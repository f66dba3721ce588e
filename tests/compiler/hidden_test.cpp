#include "compiler/hidden.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "../geometry/shapes.h"
#include "assemblies.h"
#include "base/parallel.h"
#include "tests/support/ray_caster.h"

namespace panwright::compiler::hidden_test {
namespace {

using assemblies::Assembly;

const geometry::Mesh& mesh_of(const scene::Scene& scene, const scene::Instance& instance) {
  return *std::get<geometry::MeshShape>(scene.shapes[static_cast<std::size_t>(instance.shape)]);
}

using Corners = std::array<double, 9>;
Corners corners(const geometry::Mesh& mesh, const geometry::Triangle& t) {
  Corners out;
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      out[3 * k + static_cast<std::size_t>(axis)] = mesh.positions[t[k]][axis];
  return out;
}

struct Outcome {
  std::uint64_t hidden = 0;   // by construction
  std::uint64_t left = 0;     // of them, that are still there
  std::uint64_t visible = 0;  // by construction
  std::uint64_t lost = 0;     // of them, that are gone
  std::uint64_t slivers_left = 0;
  std::uint64_t slivers_gone = 0;
};

Outcome compare(const Assembly& assembly, const scene::Scene& pruned) {
  std::map<std::int32_t, std::set<Corners>> kept;  // by node
  for (const scene::Instance& instance : pruned.instances)
    for (const geometry::Triangle& t : mesh_of(pruned, instance).triangles)
      kept[instance.node].insert(corners(mesh_of(pruned, instance), t));
  Outcome out;
  for (std::size_t i = 0; i < assembly.scene.instances.size(); ++i) {
    const scene::Instance& instance = assembly.scene.instances[i];
    const geometry::Mesh& mesh = mesh_of(assembly.scene, instance);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool there = kept[instance.node].count(corners(mesh, mesh.triangles[t])) > 0;
      if (assembly.visible[i][t] == assemblies::kEither) {
        ++(there ? out.slivers_left : out.slivers_gone);
        continue;
      }
      const bool seen = assembly.visible[i][t] != 0;
      (seen ? out.visible : out.hidden) += 1;
      out.left += !seen && there;
      out.lost += seen && !there;
    }
  }
  return out;
}

support::RayCaster caster_of(const scene::Scene& scene) {
  support::RayCaster caster;
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  for (const scene::Instance& instance : scene.instances)
    caster.add(mesh_of(scene, instance), world[static_cast<std::size_t>(instance.node)]);
  caster.build();
  return caster;
}

// How many of so many random lines from outside to places in a ball meet something else than
// before.
std::uint64_t changed_rays(const scene::Scene& before, const scene::Scene& after,
                           std::uint64_t count, double aim, const Vec3& centre) {
  const support::RayCaster a = caster_of(before);
  const support::RayCaster b = caster_of(after);
  std::vector<std::uint64_t> changed(64, 0);
  parallel_for(changed.size(), [&](std::size_t task) {
    geometry::shapes::Random random(9001 + task);
    for (std::uint64_t i = 0; i < count / changed.size(); ++i) {
      const Vec3 from = 3.0 * random.direction();
      const Vec3 to = centre + aim * random() * random.direction();
      const geometry::Ray ray{from, to - from};
      const auto first = a.closest(ray);
      const auto second = b.closest(ray);
      const bool same = first.has_value() == second.has_value() &&
                        (!first || std::fabs(first->distance - second->distance) < 1e-5);
      changed[task] += !same;
    }
  });
  std::uint64_t sum = 0;
  for (const std::uint64_t one : changed) sum += one;
  return sum;
}

class Assemblies : public testing::TestWithParam<int> {
 protected:
  static Assembly make() {
    switch (GetParam()) {
      case 0:
        return assemblies::nested_boxes(5, 8);
      case 1:
        return assemblies::tank_in_a_bus(40, 0.05);
      case 2:
        // facets that 5e-5 of the lines through them show, or less
        return assemblies::tank_in_a_bus(12, 0.004);
      default:
        return assemblies::bolts_in_holes(4, 16, 3);
    }
  }
};

TEST_P(Assemblies, LoseWhatIsHiddenAndNothingElse) {
  const Assembly assembly = make();
  scene::Scene scene = assembly.scene;
  DiagnosticLog log;
  const HiddenReport report = *prune_hidden(scene, {}, log);
  EXPECT_EQ(scene::check(scene), "");
  EXPECT_TRUE(log.contains(Code("N6304")));
  const Outcome outcome = compare(assembly, scene);
  EXPECT_EQ(outcome.lost, 0u);
  EXPECT_LE(outcome.left, outcome.hidden / 50);
  EXPECT_EQ(changed_rays(assembly.scene, scene, 1'000'000, 0.9, Vec3(0)), 0u);
  // where the hole of the bus is
  EXPECT_EQ(changed_rays(assembly.scene, scene, 1'000'000, 0.05, Vec3(0, 0, 0.5)), 0u);
  const std::uint64_t slivers = outcome.slivers_left + outcome.slivers_gone;
  EXPECT_EQ(report.triangles_before, outcome.hidden + outcome.visible + slivers);
  EXPECT_EQ(report.triangles_after,
            outcome.visible - outcome.lost + outcome.left + outcome.slivers_left);
  EXPECT_EQ(report.instances_after, scene.instances.size());
  EXPECT_LT(report.open_share_each, 0.05);
}

TEST_P(Assemblies, TheSameWhateverTheThreads) {
  const Assembly assembly = make();
  HiddenOptions options;
  // not enough for one of them
  options.max_rays = GetParam() == 1 ? 400'000 : 2'000'000;
  std::vector<scene::Scene> results;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    results.push_back(assembly.scene);
    DiagnosticLog log;
    ASSERT_TRUE(prune_hidden(results.back(), options, log, Job({threads, {}})));
  }
  for (const scene::Scene& other : results) {
    ASSERT_EQ(other.instances.size(), results[0].instances.size());
    for (std::size_t i = 0; i < other.instances.size(); ++i) {
      EXPECT_EQ(mesh_of(other, other.instances[i]).positions,
                mesh_of(results[0], results[0].instances[i]).positions);
      EXPECT_EQ(mesh_of(other, other.instances[i]).triangles,
                mesh_of(results[0], results[0].instances[i]).triangles);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Hidden, Assemblies, testing::Values(0, 1, 2, 3));

// A box in a box.
Assembly two_boxes() { return assemblies::nested_boxes(2, 2); }

HiddenReport prune(scene::Scene& scene, HiddenOptions options = {}) {
  DiagnosticLog log;
  return *prune_hidden(scene, options, log);
}

TEST(Hidden, CutOutMaterialsHideNothing) {
  Assembly assembly = two_boxes();
  scene::Scene& scene = assembly.scene;
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].maps.cutout = 0;
  scene.instances[0].material = 1;
  EXPECT_EQ(prune(scene).triangles_after, 96u);
  // and are themselves seen through each other
  scene.instances[1].material = 1;
  EXPECT_EQ(prune(scene).triangles_after, 96u);
}

TEST(Hidden, WhatMayNotLoseKeepsAll) {
  Assembly assembly = two_boxes();
  HiddenOptions options;
  options.may_lose = {1, 0};
  EXPECT_EQ(prune(assembly.scene, options).triangles_after, 96u);
}

TEST(Hidden, WhatCarriesDecalsStaysWhole) {
  Assembly assembly = two_boxes();
  scene::Decal decal;
  decal.instance = 1;
  assembly.scene.textures.push_back({"a.png", 1, 1, {0, 0, 0, 0}, false});
  assembly.scene.decals.push_back(decal);
  EXPECT_EQ(prune(assembly.scene).triangles_after, 96u);
}

TEST(Hidden, SharedShapesLoseWhatAllOfThemHide) {
  Assembly assembly = two_boxes();
  scene::Scene& scene = assembly.scene;
  // the inner box once more, outside, half sunk into nothing
  scene::Instance copy = scene.instances[1];
  scene::Node node = scene.nodes[0];
  node.name = "away";
  node.parent = 0;
  node.parent_from_node.translation = {10, 0, 0};
  scene.nodes.push_back(node);
  copy.node = static_cast<std::int32_t>(scene.nodes.size()) - 1;
  scene.instances.push_back(copy);
  const HiddenReport report = prune(scene);
  // the instance within goes, the shape stays whole for the one outside
  EXPECT_EQ(report.instances_after, 2u);
  EXPECT_EQ(report.triangles_after, 96u);
  EXPECT_EQ(report.unique_after, 96u);
  EXPECT_EQ(scene::check(scene), "");
}

TEST(Hidden, ExactShapesGoAsAWhole) {
  Assembly assembly = two_boxes();
  scene::Scene& scene = assembly.scene;
  scene.shapes[1] = geometry::Shape(geometry::Cylinder{});
  scene.nodes[2].parent_from_node.scale = Vec3(0.1);
  EXPECT_EQ(prune(scene).instances_after, 1u);
  // one that hides
  Assembly other = two_boxes();
  geometry::Sphere shell;
  shell.radius = 3;
  other.scene.shapes[0] = geometry::Shape(shell);
  EXPECT_EQ(prune(other.scene).instances_after, 1u);
  EXPECT_TRUE(std::holds_alternative<geometry::Sphere>(other.scene.shapes[0]));
}

TEST(Hidden, OpenSheetsAreSeenFromBothSides) {
  assemblies::Builder builder("sheet");
  geometry::Mesh sheet;
  assemblies::add_quad(sheet, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  builder.add(builder.add_mesh(sheet), Vec3(0), true);
  builder.add(builder.add_mesh(assemblies::block({4, 4, 1}, 1)), Vec3(0.5, 0.5, 1), true);
  Assembly assembly = builder.done();
  // its front lies towards the block, 0.5 m away
  EXPECT_EQ(prune(assembly.scene).triangles_after, 14u);
}

TEST(Hidden, SurfacesInOneAnotherBothStay) {
  Assembly assembly = assemblies::nested_boxes(1, 2);
  scene::Scene& scene = assembly.scene;
  scene.instances.push_back(scene.instances[0]);
  EXPECT_EQ(prune(scene).triangles_after, 96u);
}

// What lies in one place is looked for once: as many rays as for one, and all of it stays or goes.
TEST(Hidden, ManyCopiesInOnePlace) {
  Assembly one = two_boxes();
  Assembly many = two_boxes();
  for (int i = 0; i < 50; ++i) {
    many.scene.instances.push_back(many.scene.instances[0]);
    many.scene.instances.push_back(many.scene.instances[1]);
  }
  const HiddenReport alone = prune(one.scene);
  const HiddenReport together = prune(many.scene);
  EXPECT_EQ(alone.triangles_after, 48u);
  EXPECT_EQ(together.triangles_after, 51 * 48u);
  EXPECT_EQ(together.hidden, 51 * alone.hidden);
  EXPECT_EQ(together.rays, alone.rays);
}

TEST(Hidden, EmptyAndFlatModels) {
  scene::Scene empty;
  empty.nodes.emplace_back();
  empty.nodes[0].name = "root";
  EXPECT_EQ(prune(empty).triangles_after, 0u);
  assemblies::Builder builder("point");
  geometry::Mesh point;
  point.positions.assign(3, Vec3(1));
  point.triangles = {{0, 1, 2}};
  builder.add(builder.add_mesh(point), Vec3(0), true);
  scene::Scene scene = builder.done().scene;
  EXPECT_EQ(scene::check(scene), "");
  prune(scene);
  EXPECT_EQ(scene::check(scene), "");
}

TEST(Hidden, FarAwayAndTinyModels) {
  for (const double size : {1e-6, 1e6}) {
    Assembly assembly = two_boxes();
    for (std::size_t i = 1; i < assembly.scene.nodes.size(); ++i) {
      assembly.scene.nodes[i].parent_from_node.scale = Vec3(size);
      assembly.scene.nodes[i].parent_from_node.translation = Vec3(1e4 * size, 0, 0);
    }
    EXPECT_EQ(prune(assembly.scene).triangles_after, 48u) << size;
  }
}

std::uint64_t triangles_of(const scene::Scene& scene) {
  std::uint64_t count = 0;
  for (const scene::Instance& instance : scene.instances)
    count += mesh_of(scene, instance).triangles.size();
  return count;
}

// A bumpy ball: nothing of it is hidden.
geometry::Mesh lumpy_ball(std::uint32_t rings, std::uint32_t quads) {
  geometry::Mesh mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < quads; ++j) {
      const double a = kPi * i / rings;
      const double b = 2 * kPi * j / quads;
      const Vec3 d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.positions.push_back((1 + 0.05 * std::sin(7 * d.x) * std::sin(9 * d.y)) * d);
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < quads; ++j) {
      const std::uint32_t next = (j + 1) % quads;
      const std::uint32_t low = (i + 1) * quads;
      if (i + 1 < rings) mesh.triangles.push_back({i * quads + j, low + j, low + next});
      if (i > 0) mesh.triangles.push_back({i * quads + j, low + next, i * quads + next});
    }
  mesh.closed = true;
  return mesh;
}

// What is in the open takes a ray or two for a triangle: the search does not cost more than the
// import.
TEST(Hidden, ASkinCostsARayForATriangle) {
  assemblies::Builder builder("skin");
  builder.add(builder.add_mesh(lumpy_ball(200, 200)), Vec3(0), true);
  Assembly assembly = builder.done();
  const HiddenReport report = prune(assembly.scene);
  EXPECT_EQ(report.triangles_after, report.triangles_before);
  EXPECT_LE(report.rays, 2 * report.triangles_before);
  EXPECT_FALSE(report.capped);
}

// Instances share what is known of their mesh: a field of them takes less than a ray for each
// triangle, and what the mesh hides from itself goes though most instances are far inside the heap.
TEST(Hidden, ManyInstancesOfOneMesh) {
  assemblies::Builder builder("heap");
  geometry::Mesh mesh = lumpy_ball(16, 16);
  const std::size_t outside = mesh.triangles.size();
  const geometry::Mesh within = assemblies::block(Vec3(0.4), 3);
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), within.positions.begin(), within.positions.end());
  for (const geometry::Triangle& t : within.triangles)
    mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  const std::int32_t shape = builder.add_mesh(mesh);
  geometry::shapes::Random random(5);
  constexpr std::size_t kInstances = 6000;
  for (std::size_t i = 0; i < kInstances; ++i)
    builder.add(shape, 10.0 * Vec3(random(), random(), random()), true);
  Assembly assembly = builder.done();
  const HiddenReport report = prune(assembly.scene);
  EXPECT_EQ(report.unique_after, outside);
  EXPECT_LT(report.rays, report.triangles_before);
  EXPECT_EQ(scene::check(assembly.scene), "");
}

// What the rays do not suffice for stays, and that is said.
TEST(Hidden, WhatIsNotDecidedStays) {
  Assembly assembly = assemblies::nested_boxes(3, 40);
  const std::uint64_t before = triangles_of(assembly.scene);
  HiddenOptions options;
  options.max_rays = 0;
  DiagnosticLog log;
  const HiddenReport report = *prune_hidden(assembly.scene, options, log);
  EXPECT_TRUE(report.capped);
  EXPECT_GT(report.ambiguous, 0u);
  EXPECT_EQ(report.triangles_after + report.hidden, before);
  EXPECT_LE(report.rays, 5 * before);
  EXPECT_TRUE(log.contains(Code("N6304")));
}

// A box in a box whose lid a joint opens. Oracle: what is seen at any of four joint values.
TEST(Hidden, WhatAJointUncoversStays) {
  const auto make = [](bool can_move) {
    assemblies::Builder builder("chest");
    geometry::Mesh chest = assemblies::block(Vec3(2), 4);
    chest.triangles.resize(chest.triangles.size() - 2 * 4 * 4);  // its top
    builder.add(builder.add_mesh(chest), Vec3(0), true);
    builder.add(builder.add_mesh(assemblies::block(Vec3(1), 4)), Vec3(0), true);
    // a block in the block: no joint uncovers it
    builder.add(builder.add_mesh(assemblies::block(Vec3(0.5), 4)), Vec3(0), false);
    builder.add(builder.add_mesh(assemblies::block({2, 2, 0.1}, 4)), Vec3(0, 0, 1.05), true);
    Assembly assembly = builder.done();
    scene::Joint hinge;
    hinge.name = "hinge";
    hinge.node = assembly.scene.instances[3].node;
    hinge.kind = scene::JointKind::prismatic;
    hinge.axis = {1, 0, 0};
    hinge.lower = {0};
    hinge.upper = {can_move ? 1.5 : 0};
    assembly.scene.joints.push_back(hinge);
    return assembly;
  };
  Assembly fixed = make(false);
  EXPECT_LT(prune(fixed.scene).triangles_after, 4 * 192u - 2 * 192u);
  Assembly moving = make(true);
  const scene::Scene before = moving.scene;
  prune(moving.scene);
  // at rest and wherever the lid is, nothing else is met than before
  for (const double value : {0.0, 0.3, 0.9, 1.5}) {
    scene::Scene a = before;
    scene::Scene b = moving.scene;
    for (scene::Scene* scene : {&a, &b})
      scene->nodes[static_cast<std::size_t>(before.joints[0].node)]
          .parent_from_node.translation.x += value;
    EXPECT_EQ(changed_rays(a, b, 200'000, 1.2, Vec3(0)), 0u) << value;
  }
  EXPECT_EQ(moving.scene.instances.size(), 3u);
}

}  // namespace
}  // namespace panwright::compiler::hidden_test
