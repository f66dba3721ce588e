// Which levels are mixed in which parts.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "preview/frame/level_states.h"

namespace panwright::preview::level_states_test {
namespace {

struct Scene {
  world::Pose pose;
  AxisBox bounds{Vec3(-1), Vec3(1)};
  std::vector<double> steps{0.01, 0.02, 0.04, 0.08};
  LeveledTarget target() const { return {&pose, &bounds, &steps}; }
};

world::Camera camera_at(double distance, double focal = 1000) {
  world::Camera camera;
  camera.focal = Vec2(focal);
  camera.position = Vec3(0, 0, -distance);
  return camera;
}

TEST(LevelStates, APixelSeesTheNearestPointOfTheBox) {
  Scene scene;
  EXPECT_DOUBLE_EQ(pixel_on(camera_at(11), scene.pose, scene.bounds), 0.01);
  EXPECT_EQ(pixel_on(camera_at(0.5), scene.pose, scene.bounds), 0);
  scene.pose.translation = Vec3(3, 0, 0);
  scene.pose.rotation = glm::angleAxis(kPi / 2, Vec3(0, 1, 0));
  EXPECT_NEAR(pixel_on(camera_at(5), scene.pose, scene.bounds), std::sqrt(20.0) / 1000, 1e-15);
  world::Camera flat = camera_at(0.5);
  flat.projection = world::Projection::orthographic;
  EXPECT_DOUBLE_EQ(pixel_on(flat, scene.pose, scene.bounds), 1e-3);
}

std::vector<LevelState> level_states(const world::Camera& camera,
                                     std::span<const LeveledTarget> targets,
                                     const std::optional<double>& pixel) {
  LevelStateFinder finder;
  const auto states = finder.find(camera, targets, pixel);
  return {states.begin(), states.end()};
}

// Which of the steps each target is beyond, weighted: how coarse the image is in all.
double coarseness(const std::vector<LevelState>& states, const Scene& scene) {
  double sum = 0;
  for (const LevelState& state : states)
    for (const double pixel : state.pixels)
      for (const double step : scene.steps) sum += state.weight * (pixel >= step ? 1 : 0);
  return sum;
}

TEST(LevelStates, SharesAddUpAndNothingJumps) {
  const Scene scene;
  double before = 0;
  for (double range = 2; range < 400; range *= 1.001) {
    const LeveledTarget target = scene.target();
    const auto states = level_states(camera_at(range), std::span(&target, 1), {});
    double sum = 0;
    for (const LevelState& state : states) {
      EXPECT_GT(state.weight, 0);
      sum += state.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    const double now = coarseness(states, scene);
    EXPECT_GE(now, before - 1e-12) << range;
    // half an octave is 347 such steps; a pixel grows faster than the range here
    EXPECT_LT(now - before, 0.011) << range;
    before = now;
    // never coarser than a pixel by more than the fade
    const double pixel = pixel_on(camera_at(range), scene.pose, scene.bounds);
    for (const LevelState& state : states) EXPECT_LE(state.pixels[0], pixel * std::sqrt(2.0));
    EXPECT_LE(states.back().pixels[0], pixel);
  }
  EXPECT_EQ(before, 4);
}

TEST(LevelStates, WhatHasNoStepsThereTakesOneState) {
  Scene scene;
  LeveledTarget target = scene.target();
  // between 2 and 4 mm no level begins
  EXPECT_EQ(level_states(camera_at(1 + 3.8), std::span(&target, 1), {}).size(), 1u);
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), {}).size(), 2u);
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), 0.03).size(), 1u);
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), 0.03)[0].pixels[0], 0.03);
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), 0.0)[0].pixels[0], 0);
  target.steps = nullptr;
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), {}).size(), 1u);
  target.bounds = nullptr;
  EXPECT_EQ(level_states(camera_at(1 + 14.5), std::span(&target, 1), {}).size(), 1u);
}

TEST(LevelStates, ManyTargetsTakeFewStates) {
  const Scene scene;
  std::vector<world::Pose> poses(100);
  std::vector<LeveledTarget> targets;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].translation = Vec3(0, 0, 0.05 * static_cast<double>(i));
    targets.push_back({&poses[i], &scene.bounds, &scene.steps});
  }
  for (const std::size_t count : {1u, 2u, 3u, 4u, 100u}) {
    const auto states = level_states(camera_at(12.6), std::span(targets).first(count), {});
    EXPECT_LE(states.size(), 5u) << count;
    EXPECT_GE(states.size(), 2u) << count;
    double sum = 0;
    for (const LevelState& state : states) sum += state.weight;
    EXPECT_NEAR(sum, 1, 1e-15);
    // each target has its own share, to a quarter where they are many
    for (std::size_t i = 0; i < count; ++i) {
      double coarse = 0;
      for (const LevelState& state : states)
        if (state.pixels[i] >
            std::ldexp(1.0, std::ilogb(pixel_on(camera_at(12.6), poses[i], scene.bounds))))
          coarse += state.weight;
      const double pixel = pixel_on(camera_at(12.6), poses[i], scene.bounds);
      const double share =
          std::max(std::log2(pixel / std::ldexp(1.0, std::ilogb(pixel))) * 2 - 1, 0.0);
      EXPECT_NEAR(coarse, share, count > 3 ? 0.126 : 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace panwright::preview::level_states_test
