// Scenes of several targets: batches, any hit, levels, hidden parts, frames of rays, what is kept.
#include "trace/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/trace/trace_models.h"

namespace panwright::trace::scene_test {
namespace {

using namespace testing_support;

// Boxes and plates with holes, stretched and mirrored, in several poses; some hidden.
world::World assorted(const std::vector<std::uint8_t>& rgba) {
  pan::Contents contents = single(box({1, 2, 0.5}));
  contents.meshes.push_back(pan::packed(plate(3, 1), "plate"));
  contents.textures.push_back({"grid", 4, 2, true, rgba});
  contents.materials.emplace_back();
  contents.materials[1].maps.cutout = 0;
  contents.materials[1].maps.threshold = 0.5;
  const Quat turn = glm::angleAxis(0.9, glm::normalize(Vec3(1, 2, -1)));
  contents.nodes.push_back({"stretched", 0, Vec3(1.5, 0, 0.2), turn, Vec3(0.5, 1.5, 0.8)});
  contents.nodes.push_back({"mirror", 1, Vec3(-0.5, 1, 0), turn, Vec3(-1, 0.7, 1)});
  contents.nodes.push_back({"panel", 0, Vec3(-2, 0.3, -0.4), turn, Vec3(1, -1, 1)});
  contents.instances = {{0, 0, 0, -1}, {1, 0, 0, -1}, {2, 1, 1, -1}, {3, 1, 0, -1}};
  Random random(7);
  world::World world;
  for (int i = 0; i < 6; ++i)
    add(world, "target " + std::to_string(i), contents, {random.in_cube(4), random.rotation()});
  world.set_visible(0, false);
  world.set_node_visible(3, 1, false);
  return world;
}

std::vector<std::uint8_t> grid() {
  std::vector<std::uint8_t> rgba(4 * 8, 255);
  for (std::size_t i = 3; i < rgba.size(); i += 8) rgba[i] = 0;
  return rgba;
}

std::vector<Ray> rays_into(std::size_t count) {
  Random random(8);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 origin = random.in_cube(6);
    rays.push_back(ray(origin, random.in_cube(4) - origin));
    if (i % 3 == 0) rays.back().max_distance = random.between(0, 12);
    if (i % 5 == 0) rays.back().min_distance = random.between(0, 2);
  }
  return rays;
}

bool same(const Hit& a, const Hit& b) {
  return a.distance == b.distance && a.target == b.target && a.part == b.part &&
         a.triangle == b.triangle && a.barycentric == b.barycentric && a.front == b.front &&
         a.direction == b.direction;
}

TEST(TraceScene, BatchesAreSingleRaysAndAnyIsNearest) {
  const std::vector<std::uint8_t> rgba = grid();
  Scene scene;
  scene.update(assorted(rgba));
  const std::vector<Ray> rays = rays_into(5000);
  for (const Insides insides : {Insides::pass, Insides::stop}) {
    std::vector<Hit> one(rays.size()), three(rays.size());
    std::vector<std::uint8_t> found(rays.size());
    run_on_threads(Job({1, {}}), [&] { scene.nearest(rays, one, insides); });
    run_on_threads(Job({3, {}}), [&] { scene.nearest(rays, three, insides); });
    scene.any(rays, found, insides);
    std::size_t hits = 0, holes = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit hit = scene.nearest(rays[i], insides);
      EXPECT_TRUE(same(hit, one[i]) && same(hit, three[i])) << i;
      EXPECT_EQ(scene.any(rays[i], insides), static_cast<bool>(hit)) << i;
      EXPECT_EQ(found[i], hit ? 1 : 0) << i;
      if (!hit) continue;
      ++hits;
      EXPECT_GE(hit.distance, rays[i].min_distance);
      EXPECT_LE(hit.distance, rays[i].max_distance);
      const Ids ids = scene.ids(hit);
      EXPECT_NE(ids.target, 1u);                         // hidden
      EXPECT_FALSE(ids.target == 4u && ids.node == 2u);  // a hidden node
      EXPECT_FALSE(ids.target == 4u && ids.node == 3u);  // below it
      EXPECT_EQ(insides == Insides::pass && scene.is_inside(hit), false);
      holes += ids.material == 2;
    }
    printf("%zu of %zu rays hit\n", hits, rays.size());
    EXPECT_GT(hits, 500u);
    EXPECT_GT(holes, 20u);
  }
  EXPECT_EQ(scene.ids(Hit{}).target, 0u);
}

// The nearest of all targets, each asked in a scene of its own; at any place of the observer.
// From beams of 0.1 mrad to all directions, along axes and across them.
TEST(TraceScene, BundlesAreSingleRays) {
  const std::vector<std::uint8_t> rgba = grid();
  world::World one;
  pan::Contents contents = single(box({1, 2, 0.5}));
  contents.nodes.push_back({"other", 0, Vec3(1.5, 0, 0.2), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({1, 0, 0, -1});
  add(one, "one", contents, {Vec3(0.3, 0, 0), glm::angleAxis(0.3, Vec3(0, 0, 1))});
  for (const world::World& world : {assorted(rgba), one}) {
    Scene scene;
    scene.update(world);
    Random random(11);
    std::size_t hits = 0, misses = 0;
    for (int k = 0; k < 600; ++k) {
      scene.place_observer({random.in_cube(6), random.rotation()});
      const Vec3 origin = k % 3 == 0 ? Vec3(0) : random.in_cube(3);
      Vec3 axis = scene.observer().position;
      axis = k % 4 == 0 ? Vec3(k % 8 == 0 ? 1 : 0, 0, k % 8 == 0 ? 0 : -1)
                        : (random.in_cube(1) - axis) * scene.observer().world_from - origin;
      const double spread = std::pow(10, -4 + 4.5 * random.between(0, 1));
      std::vector<Ray> rays;
      for (int i = 0; i < 1 + k % 40; ++i) {
        rays.push_back(ray(origin, glm::normalize(axis) + spread * random.in_cube(1)));
        rays.back().max_distance = k % 5 == 0 ? 5 : 1e30;
        rays.back().min_distance = k % 7 == 0 ? 1 : 0;
      }
      for (const Insides insides : {Insides::pass, Insides::stop}) {
        std::vector<Hit> found(rays.size());
        scene.nearest_bundle(rays, found, insides);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const Hit hit = scene.nearest(rays[i], insides);
          EXPECT_TRUE(same(hit, found[i])) << k << ' ' << i;
          (hit ? hits : misses) += 1;
        }
      }
    }
    EXPECT_GT(hits, 1000u);
    EXPECT_GT(misses, 1000u);
  }
}

TEST(TraceScene, TheNearestTargetWins) {
  const std::vector<std::uint8_t> rgba = grid();
  const world::World world = assorted(rgba);
  Scene scene;
  scene.update(world);
  std::vector<Scene> alone(world.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    world::World one = world;
    for (std::size_t k = 0; k < world.size(); ++k)
      if (k != i) one.set_visible(k, false);
    alone[i].update(one);
  }
  Random random(9);
  const world::Pose observer{random.in_cube(5), random.rotation()};
  std::size_t hits = 0;
  for (const Ray& each : rays_into(2000)) {
    Hit best;
    for (const Scene& one : alone)
      if (const Hit hit = one.nearest(each); hit.distance < best.distance) best = hit;
    const Hit hit = scene.nearest(each);
    EXPECT_TRUE(same(hit, best));
    hits += hit ? 1 : 0;
    // the same ray from the observer, and from the frame of a target
    scene.place_observer(observer);
    const Mat3 turned = glm::mat3_cast(glm::conjugate(observer.rotation));
    Ray from_there = each;
    from_there.origin = turned * (each.origin - observer.translation);
    from_there.direction = turned * each.direction;
    const Hit again = scene.nearest(from_there);
    Ray from_target = each;
    from_target.frame = 2;
    const Affine to = scene.observer_from(2);
    const Mat3 back = glm::transpose(to.linear);
    from_target.origin = back * (from_there.origin - to.offset);
    from_target.direction = back * from_there.direction;
    const Hit third = scene.nearest(from_target);
    scene.place_observer({});
    for (const Hit& other : {again, third}) {
      ASSERT_EQ(static_cast<bool>(other), static_cast<bool>(hit));
      if (!hit) continue;
      EXPECT_NEAR(other.distance, hit.distance, 1e-13 * (1 + hit.distance));
      EXPECT_EQ(other.target, hit.target);
    }
  }
  EXPECT_GT(hits, 200u);
}

// Boxes of 2, 1.8 and 1.6 m as levels of one instance, twice as large in the world.
TEST(TraceLevels, ChosenByTheFootprint) {
  pan::Contents contents = single(box(Vec3(2)));
  contents.meshes.push_back(pan::packed(box(Vec3(1.8)), "near"));
  contents.meshes.push_back(pan::packed(box(Vec3(1.6)), "far"));
  contents.materials.emplace_back();
  contents.nodes[0].scale = Vec3(2);
  contents.levels = {{0.1, 0.1, 0, 1, 0, 0}, {1, 0.2, 0, 2, 1, 0}};
  world::World world;
  add(world, "craft", contents);
  const auto distance = [&](double footprint) {
    Scene scene({footprint});
    scene.update(world);
    const Hit hit = scene.nearest(ray({0.1, 0.2, 10}, {0, 0, -1}));
    EXPECT_EQ(scene.ids(hit).instance, 1u);
    EXPECT_EQ(scene.ids(hit).material, 1u);  // the instance's, at any level
    EXPECT_NEAR(scene.surface(hit).position.z, 10 - hit.distance, 1e-6);
    return hit.distance;
  };
  EXPECT_NEAR(distance(0), 8, 1e-6);
  EXPECT_NEAR(distance(0.19), 8, 1e-6);
  EXPECT_NEAR(distance(0.21), 8.2, 1e-6);
  EXPECT_NEAR(distance(1.99), 8.2, 1e-6);
  EXPECT_NEAR(distance(2.01), 8.4, 1e-6);
}

// What did not change is not built again, and models that nobody else holds go.
TEST(TraceScene, StructuresAreKeptByStamps) {
  world::World world;
  add(world, "a", single(box(Vec3(1))));
  DiagnosticLog log;
  ASSERT_TRUE(world.add("b", world[0].model(), {{3, 0, 0}, {1, 0, 0, 0}}, log));
  Scene scene;
  scene.update(world);
  EXPECT_EQ(scene.work().models, 1u);
  EXPECT_EQ(scene.work().shapes, 2u);
  EXPECT_EQ(scene.work().poses, 2u);
  world.set_pose(1, {{4, 0, 0}, {1, 0, 0, 0}});
  scene.update(world);
  EXPECT_EQ(scene.work().shapes, 2u);
  EXPECT_EQ(scene.work().poses, 3u);
  EXPECT_NEAR(scene.nearest(ray({0, 0, 0.1}, {1, 0, 0})).distance, 3.5, 1e-15);
  const std::weak_ptr<const pan::Model> held = world[0].model();
  world = {};
  scene.update(world);
  EXPECT_TRUE(held.expired());
  EXPECT_FALSE(scene.nearest(ray({0, 0, 0.1}, {1, 0, 0})));
}

TEST(TraceScene, CancelledBatchesThrow) {
  world::World world;
  add(world, "a", single(box(Vec3(1))));
  Scene scene;
  scene.update(world);
  const Job job({1, {}});
  job.cancel();
  const std::vector<Ray> rays = rays_into(1000);
  std::vector<Hit> hits(rays.size());
  EXPECT_THROW(scene.nearest(rays, hits, Insides::pass, job), Cancelled);
  EXPECT_THROW(Scene().update(world, job), Cancelled);
}

}  // namespace
}  // namespace panwright::trace::scene_test
