// Labels of terrain against closed forms: the disc of a globe, a horizon, craft before and behind
// the ground.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/labels/label_worlds.h"
#include "tests/support/terrain_models.h"

namespace panwright::labels::terrain_test {
namespace {

using namespace testing_support;
using panwright::support::globe_model;
using panwright::support::plane_model;

constexpr double kRadius = 1737400;

world::Camera camera_at(const Vec3& eye, const Vec3& aim, std::uint32_t size, double focal,
                        const Vec3& up = Vec3(0, 0, 1)) {
  DiagnosticLog log;
  world::Camera camera;
  camera.width = camera.height = size;
  camera.focal = Vec2(focal);
  camera.principal = Vec2(0.5 * size);
  camera.position = eye;
  camera.world_from_camera = *world::looking_at(eye, aim, up, log);
  return camera;
}

const Thing& thing(const FrameLabels& frame, const std::string& target) {
  for (const Thing& each : frame.things)
    if (each.target == target && each.label.empty()) return each;
  ADD_FAILURE() << target;
  return frame.things.front();
}

// The cone about a sphere cuts the image plane in a disc, of any size.
TEST(TerrainLabels, DiscOfAGlobe) {
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("moon", globe_model(std::vector<float>(720 * 360, 0)), log));
  constexpr double kDistance = 1e8, kSine = kRadius / kDistance;
  for (const double focal : {2000.0, 60.0}) {
    const auto frame =
        labelled(world, camera_at(kDistance * Vec3(0.6, -0.8, 0), Vec3(0), 100, focal));
    const Thing& moon = thing(frame, "moon");
    const double radius = focal * kSine / std::sqrt(1 - kSine * kSine);
    printf("globe of %.2f pixels: area %.5f\n", radius,
           moon.amodal_pixels / (kPi * radius * radius));
    // measured: 3e-5 of 35 pixels, 4.3e-3 of 1
    EXPECT_NEAR(moon.amodal_pixels / (kPi * radius * radius), 1, radius > 5 ? 2e-4 : 8e-3);
    EXPECT_EQ(moon.visible_pixels, moon.amodal_pixels);
    ASSERT_TRUE(moon.amodal_box);
    // to a sample
    const double within = std::min(0.15, 0.15 * radius);
    EXPECT_NEAR(moon.amodal_box->left, 50 - radius, within);
    EXPECT_NEAR(moon.amodal_box->bottom, 50 + radius, within);
    EXPECT_LT(glm::length(moon.camera_from_thing.translation - Vec3(0, 0, kDistance)), 1e-6);
  }
}

// A plane of 128 m from above: its border is a square of known pixels, and a slab hides some.
TEST(TerrainLabels, GroundBelowASlab) {
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("ground", plane_model(129, std::vector<float>(129 * 129, 0)), log));
  ModelMaker slab;
  slab.add(0, support::box({10, 10, 1}));
  ASSERT_TRUE(world.add("slab", slab.model(), {{0, 0, 10}, Quat(1, 0, 0, 0)}, log));
  ASSERT_TRUE(world.add("buried", slab.model(), {{20, 0, -30}, Quat(1, 0, 0, 0)}, log));
  // 100 m high: 0.5 pixels a metre on the ground
  const world::Camera camera = camera_at({0, 0, 100}, Vec3(0), 100, 50, Vec3(0, 1, 0));
  const auto frame = labelled(world, camera);
  const Thing& ground = thing(frame, "ground");
  ASSERT_TRUE(ground.amodal_box);
  EXPECT_NEAR(ground.amodal_box->left, 18, 0.13);
  EXPECT_NEAR(ground.amodal_box->right, 82, 0.13);
  // measured: 4,096 and 4,064.3
  EXPECT_NEAR(ground.amodal_pixels, 64 * 64, 20);
  const double side = 10 * 50 / 89.5;  // of the slab's top
  EXPECT_NEAR(ground.visible_pixels, 64 * 64 - side * side, 20);
  EXPECT_EQ(coverage_at(ground.visible, 50, 50), 0);
  EXPECT_EQ(coverage_at(ground.amodal, 50, 50), 255);
  EXPECT_EQ(coverage_at(ground.visible, 40, 50), 255);
  EXPECT_EQ(coverage_at(ground.amodal, 16, 50), 0);
  const Thing& buried = thing(frame, "buried");
  EXPECT_GT(buried.amodal_pixels, 10);
  EXPECT_EQ(buried.visible_pixels, 0);
  EXPECT_NEAR(thing(frame, "slab").visible_pixels, side * side, 0.02 * side * side);
  // the image's ids save rays, and change nothing
  image::Image layers;
  layers.width = layers.height = 100;
  layers.depth.assign(10000, 100);
  layers.range.assign(10000, 100);
  layers.target_id.assign(10000, 0);
  layers.node_id.assign(10000, 0);
  for (std::uint32_t y = 0; y < 100; ++y)
    for (std::uint32_t x = 0; x < 100; ++x) {
      const bool on_ground = coverage_at(ground.visible, x, y) > 127;
      const bool on_slab = coverage_at(thing(frame, "slab").visible, x, y) > 127;
      layers.target_id[100 * y + x] = on_ground ? 1 : on_slab ? 2 : 0;
      layers.node_id[100 * y + x] = on_ground || on_slab ? 1 : 0;
    }
  FrameContext context;
  context.layers = &layers;
  const auto quick = labelled(world, camera, {}, context);
  EXPECT_EQ(thing(quick, "ground").visible.coverage, ground.visible.coverage);
  EXPECT_EQ(thing(quick, "ground").amodal.coverage, ground.amodal.coverage);
  EXPECT_EQ(thing(quick, "slab").visible.coverage, thing(frame, "slab").visible.coverage);
}

// From 2 m over level ground, looking at the horizon: the ground fills what is below it, and the
// area is counted to three images.
TEST(TerrainLabels, HorizonAndHiddenKeypoint) {
  std::vector<float> heights;
  for (int row = 0; row < 257; ++row)
    for (int column = 0; column < 257; ++column) heights.push_back(column == 140 ? 3.0f : 0.0f);
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("ground", plane_model(257, heights), log));
  ModelMaker craft;
  craft.add(0, support::box({1, 1, 1}));
  craft.contents.keypoints.push_back({"low", 0, Vec3(-0.5, 0, 0.4)});
  craft.contents.keypoints.push_back({"front", 0, Vec3(-0.5, 0, 0.4)});
  // behind the wall at x = 12, and before it
  ASSERT_TRUE(world.add("behind", craft.model(), {{20, 0, 0.5}, Quat(1, 0, 0, 0)}, log));
  ASSERT_TRUE(world.add("before", craft.model(), {{8, 2, 0.5}, Quat(1, 0, 0, 0)}, log));
  const auto frame = labelled(world, camera_at({-20, 0, 2}, {0, 0, 2}, 64, 64));
  const Thing& ground = thing(frame, "ground");
  EXPECT_GT(ground.amodal_pixels, ground.visible_pixels);
  // the wall's top is 1 m over the eye, 31 m away
  EXPECT_EQ(coverage_at(ground.visible, 32, 29), 0);
  EXPECT_EQ(coverage_at(ground.visible, 32, 30), 255);
  EXPECT_EQ(thing(frame, "behind").visible_pixels, 0);
  EXPECT_GT(thing(frame, "behind").amodal_pixels, 1);
  EXPECT_GT(thing(frame, "before").visible_pixels, 3);
  EXPECT_TRUE(thing(frame, "behind").keypoints.at(0).occluded);
  EXPECT_FALSE(thing(frame, "before").keypoints.at(0).occluded);
}

}  // namespace
}  // namespace panwright::labels::terrain_test
