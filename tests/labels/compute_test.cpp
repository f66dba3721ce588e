// Labels of a frame against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "labels/parts.h"
#include "sensor/lens.h"
#include "tests/labels/label_worlds.h"

namespace panwright::labels::compute_test {
namespace {

using namespace testing_support;
using support::box;
using support::plate;

// Looks along +z of the world from its origin: camera axes are the world's.
world::Camera plain_camera(std::uint32_t width = 64, std::uint32_t height = 48,
                           double focal = 100) {
  world::Camera camera;
  camera.width = width;
  camera.height = height;
  camera.focal = Vec2(focal);
  camera.principal = Vec2(width, height) / 2.0;
  return camera;
}

void add(world::World& world, const std::string& name, const ModelMaker& maker,
         const world::Pose& pose) {
  DiagnosticLog log;
  ASSERT_TRUE(world.add(name, maker.model(), pose, log)) << to_text(log);
}

ModelMaker single(const geometry::Mesh& mesh) {
  ModelMaker maker;
  maker.add(0, mesh);
  return maker;
}

// a plate of exact binary sides, its back to the camera or not
// A blanket beside its shape is a part of it; another node of such a name is not.
TEST(Labels, BlanketsBelongToTheirShapes) {
  ModelMaker maker;
  const auto bus = maker.node("bus", 0, Vec3(0)), foil = maker.node("bus_foil", 0, Vec3(0));
  const auto wing = maker.node("wing", 0, Vec3(0)), other = maker.node("wing_foil", wing, Vec3(0));
  for (const auto node : {bus, foil, wing, other}) maker.add(node, support::box(Vec3(1)));
  maker.contents.labels.push_back({"wing", static_cast<std::uint32_t>(wing)});
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("craft", maker.model(), log)) << to_text(log);
  for (const char* const path : {"bus", "craft/root/bus"}) {
    const auto named = named_things(world, {{"body", path}}, log);
    ASSERT_TRUE(named) << to_text(log);
    ASSERT_EQ(named->things.size(), 3u);
    EXPECT_EQ(named->things[1].label, "body");
    EXPECT_EQ(named->things[1].nodes, (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(named->things[2].nodes, std::vector<std::uint32_t>{3});  // its child is within
  }
}

TEST(LabelsCompute, APlateCoversTheAreaOfItsRectangle) {
  world::World world;
  // 20.5 by 10.25 pixels about pixel (30.25, 20.125)
  add(world, "plate", single(plate(0.8203125, 0.41015625)),
      {{-0.0703125, -0.1552734375, 4}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  ASSERT_EQ(frame.things.size(), 1u);
  const Thing& thing = frame.things[0];
  ASSERT_TRUE(thing.amodal_box && thing.visible_box);
  const double left = 32 - 1.7578125 - 10.25390625, top = 24 - 3.8818359375 - 5.126953125;
  // measured: 1e-14; positions are floats, here exact
  EXPECT_NEAR(thing.amodal_box->left, left, 1e-9);
  EXPECT_NEAR(thing.amodal_box->top, top, 1e-9);
  EXPECT_NEAR(thing.amodal_box->right, left + 20.5078125, 1e-9);
  EXPECT_NEAR(thing.amodal_box->bottom, top + 10.25390625, 1e-9);
  EXPECT_EQ(*thing.amodal_box, *thing.visible_box);
  EXPECT_EQ(thing.amodal, thing.visible);
  EXPECT_EQ(thing.amodal_pixels, thing.visible_pixels);
  // 8 rows of samples a pixel: 1/16 of a row of pixels at either edge
  EXPECT_NEAR(thing.amodal_pixels, 20.5078125 * 10.25390625, 20.6 / 8);
}

TEST(LabelsCompute, HalfCoveredPixelsAreHalf) {
  world::World world;
  // x 20.5 to 40.5, y 10 to 30 pixels
  add(world, "plate", single(plate(1, 1)), {{0.625 - 0.7 + 0.0, -0.2, 5}, {1, 0, 0, 0}});
  world::Camera camera = plain_camera();
  camera.principal = {32 - 0.0, 24};
  const FrameLabels frame = labelled(world, camera);
  const Thing& thing = frame.things[0];
  ASSERT_TRUE(thing.amodal_box);
  EXPECT_NEAR(thing.amodal_box->left, 20.5, 1e-6);
  EXPECT_NEAR(thing.amodal_box->top, 10, 1e-6);
  for (std::uint32_t y = 10; y < 30; ++y) {
    EXPECT_EQ(coverage_at(thing.visible, 20, y), 128) << y;
    EXPECT_EQ(coverage_at(thing.visible, 40, y), 128) << y;
    EXPECT_EQ(coverage_at(thing.visible, 30, y), 255) << y;
    EXPECT_EQ(coverage_at(thing.visible, 41, y), 0) << y;
  }
  EXPECT_EQ(thing.amodal.width, 21u);
  EXPECT_EQ(thing.amodal.height, 20u);
  EXPECT_EQ(thing.amodal_pixels, 400);
}

TEST(LabelsCompute, WhatAPlateHidesIsNotVisible) {
  world::World world;
  // far: 20 by 20 pixels; near: hides its right quarter, and reaches beyond
  add(world, "far", single(plate(2, 2)), {{0, 0, 10}, {1, 0, 0, 0}});
  add(world, "near", single(plate(0.5, 2)), {{0.5, 0, 5}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  const Thing &far = frame.things[0], &near = frame.things[1];
  EXPECT_EQ(far.id, 1u);
  EXPECT_EQ(near.id, 2u);
  EXPECT_EQ(far.target, "far");
  EXPECT_EQ(far.amodal_pixels, 400);
  EXPECT_EQ(far.visible_pixels, 300);
  EXPECT_EQ(near.visible_pixels, near.amodal_pixels);
  EXPECT_EQ(near.amodal_pixels, 400);
  ASSERT_TRUE(far.visible_box && far.amodal_box);
  EXPECT_NEAR(far.visible_box->left, 22, 1e-9);
  EXPECT_NEAR(far.visible_box->right, 37, 1e-9);
  EXPECT_NEAR(far.amodal_box->right, 42, 1e-9);
  EXPECT_EQ(coverage_at(far.visible, 37, 24), 0);
  EXPECT_EQ(coverage_at(far.amodal, 37, 24), 255);
  EXPECT_EQ(coverage_at(near.visible, 37, 24), 255);
}

TEST(LabelsCompute, ABoxHasThePlacesOfItsCorners) {
  Numbers numbers(1);
  const Vec3 sides(0.5, 0.75, 1.25);
  world::World world;
  add(world, "box", single(box(sides)), {});
  double worst = 0;
  for (int k = 0; k < 50; ++k) {
    const world::Pose pose{{numbers.between(-1, 1), numbers.between(-1, 1), 5}, numbers.rotation()};
    world.set_pose(0, pose);
    const world::Camera camera = plain_camera(640, 480, 700);
    const FrameLabels frame = labelled(world, camera);
    const Thing& thing = frame.things[0];
    Vec2 low(1e9), high(-1e9);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p =
          pose.rotation *
              (sides * 0.5 * Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)) +
          pose.translation;
      const Vec2 at = 700.0 * Vec2(p) / p.z + camera.principal;
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
    ASSERT_TRUE(thing.amodal_box);
    for (const double off : {thing.amodal_box->left - low.x, thing.amodal_box->top - low.y,
                             thing.amodal_box->right - high.x, thing.amodal_box->bottom - high.y})
      worst = std::max(worst, std::fabs(off));
    EXPECT_EQ(thing.camera_from_thing.translation, pose.translation);
    EXPECT_NEAR(std::fabs(glm::dot(thing.camera_from_thing.rotation, pose.rotation)), 1, 1e-14);
    EXPECT_GE(thing.camera_from_thing.rotation.w, 0);
  }
  // measured: 5e-13
  EXPECT_LT(worst, 1e-10);
}

geometry::Mesh ball(double radius, int rings) {
  geometry::Mesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double t = kPi * i / rings, p = 2 * kPi * j / around;
      const Vec3 n(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
      mesh.positions.push_back(radius * n);
      mesh.normals.push_back(n);
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * around + j % around); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < rings) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  mesh.closed = true;
  return mesh;
}

TEST(LabelsCompute, ASphereCoversItsDisc) {
  world::World world;
  add(world, "ball", single(ball(1, 200)), {{0, 0, 8}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera(512, 512, 1000));
  const Thing& thing = frame.things[0];
  const double radius = 1000 / std::sqrt(63.0);
  ASSERT_TRUE(thing.amodal_box);
  // measured: area 2e-4, the mesh's own; box 0.008 pixels
  EXPECT_NEAR(thing.amodal_pixels / (kPi * radius * radius), 1, 4e-4);
  EXPECT_NEAR(thing.amodal_box->left, 256 - radius, 0.02);
  EXPECT_NEAR(thing.amodal_box->bottom, 256 + radius, 0.02);
  EXPECT_EQ(thing.visible_pixels, thing.amodal_pixels);
}

TEST(LabelsCompute, ATargetWithinAPixelHasItsArea) {
  world::World world;
  add(world, "speck", single(plate(0.25, 0.125)), {{0.3, 0.2, 100}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  const Thing& thing = frame.things[0];
  EXPECT_NEAR(thing.amodal_pixels, 0.25 * 0.125, 2e-3);
  EXPECT_EQ(thing.visible_pixels, thing.amodal_pixels);
  ASSERT_TRUE(thing.visible_box);
  EXPECT_NEAR(thing.visible_box->left, 32.175, 1e-9);
  EXPECT_EQ(coverage_at(thing.visible, 32, 24), std::lround(255 * thing.visible_pixels));
}

TEST(LabelsCompute, ATargetWithinAPixelHidesAndIsHidden) {
  world::World world;
  add(world, "near", single(plate(0.25, 0.25)), {{0.325, 0.325, 100}, {1, 0, 0, 0}});
  add(world, "far", single(plate(1, 0.5)), {{0.65, 0.65, 200}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  EXPECT_EQ(frame.things[0].visible_pixels, frame.things[0].amodal_pixels);
  EXPECT_NEAR(frame.things[1].visible_pixels / frame.things[1].amodal_pixels, 0.5, 0.02);
}

TEST(LabelsCompute, ALongThinRodHasItsArea) {
  world::World world;
  add(world, "rod", single(plate(10, 0.01)), {{0, 0.0123, 20}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  const Thing& thing = frame.things[0];
  EXPECT_NEAR(thing.amodal_pixels, 50 * 0.05, 0.15);
  ASSERT_TRUE(thing.visible_box);
  EXPECT_NEAR(thing.visible_box->right, 57, 1e-9);
}

TEST(LabelsCompute, WhatIsOutsideTheImageCountsAsHiddenNotAsGone) {
  world::World world;
  // x 54 to 74: half of it beyond the right edge at 64
  add(world, "plate", single(plate(1, 1)), {{1.6, 0, 5}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  const Thing& thing = frame.things[0];
  EXPECT_EQ(thing.amodal_pixels, 400);
  EXPECT_EQ(thing.visible_pixels, 200);
  ASSERT_TRUE(thing.amodal_box && thing.visible_box);
  EXPECT_NEAR(thing.amodal_box->right, 74, 1e-9);
  EXPECT_NEAR(thing.visible_box->right, 64, 1e-9);
  EXPECT_EQ(thing.amodal.width, 10u);
}

TEST(LabelsCompute, WhatReachesBehindTheCameraIsCut) {
  world::World world;
  // a floor at y = 1, from behind the camera to 50 m: its far edge is at 24 + 100/50
  add(world, "floor", single(plate(200, 100)), {{0, 1, 0}, glm::angleAxis(kPi / 2, Vec3(1, 0, 0))});
  add(world, "behind", single(plate(1, 1)), {{0, 0, -5}, {1, 0, 0, 0}});
  const FrameLabels frame = labelled(world, plain_camera());
  const Thing& floor = frame.things[0];
  ASSERT_TRUE(floor.amodal_box && floor.visible_box);
  EXPECT_NEAR(floor.amodal_box->top, 26, 1e-9);
  EXPECT_EQ(floor.amodal_box->left, -64);
  EXPECT_EQ(floor.amodal_box->right, 128);
  EXPECT_EQ(floor.amodal_box->bottom, 96);
  EXPECT_EQ(floor.amodal_pixels, 192 * 70);
  EXPECT_EQ(floor.visible_pixels, 64 * 22);
  const Thing& behind = frame.things[1];
  EXPECT_FALSE(behind.amodal_box || behind.visible_box);
  EXPECT_EQ(behind.amodal_pixels, 0);
  EXPECT_TRUE(behind.amodal.coverage.empty());
}

TEST(LabelsCompute, DistortionBendsEdges) {
  world::World world;
  add(world, "plate", single(plate(4, 3)), {{0.3, 0.1, 5}, {1, 0, 0, 0}});
  world::Camera camera = plain_camera(640, 480, 500);
  sensor::Brown brown;
  brown.k = {-0.25, 0.06, 1e-3, -5e-4};
  camera.distortion = std::make_shared<const sensor::DistortionMap>(brown);
  const FrameLabels frame = labelled(world, camera);
  const Thing& thing = frame.things[0];
  // edges in small steps, by OpenCV's formula
  const auto place = [&](double x, double y) {
    const double r2 = x * x + y * y, radial = 1 - 0.25 * r2 + 0.06 * r2 * r2;
    const double p1 = 1e-3, p2 = -5e-4;
    return Vec2(x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) *
               500.0 +
           camera.principal;
  };
  const Vec2 low((0.3 - 2) / 5, (0.1 - 1.5) / 5), high((0.3 + 2) / 5, (0.1 + 1.5) / 5);
  std::vector<Vec2> outline;
  constexpr int kSteps = 4000;
  const Vec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k < kSteps; ++k) {
      const Vec2 p = glm::mix(corners[side], corners[(side + 1) % 4], double(k) / kSteps);
      outline.push_back(place(p.x, p.y));
    }
  Vec2 least(1e9), most(-1e9);
  double area = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 &a = outline[k], &b = outline[(k + 1) % outline.size()];
    area += 0.5 * (a.x * b.y - b.x * a.y);
    least = glm::min(least, a);
    most = glm::max(most, a);
  }
  ASSERT_TRUE(thing.amodal_box);
  // measured: 0.006 pixels; of the corners alone 12
  EXPECT_NEAR(thing.amodal_box->left, least.x, 0.02);
  EXPECT_NEAR(thing.amodal_box->right, most.x, 0.02);
  EXPECT_NEAR(thing.amodal_box->top, least.y, 0.02);
  EXPECT_NEAR(thing.amodal_box->bottom, most.y, 0.02);
  EXPECT_NEAR(thing.amodal_pixels / area, 1, 2e-4);
}

TEST(LabelsCompute, OrthographicCamerasHaveTheSameSizeAtAnyDistance) {
  world::World world;
  add(world, "near", single(plate(1, 1)), {{-1, 0, 5}, {1, 0, 0, 0}});
  add(world, "far", single(plate(1, 1)), {{1, 0, 500}, {1, 0, 0, 0}});
  add(world, "behind", single(plate(1, 1)), {{0, 1, -5}, {1, 0, 0, 0}});
  world::Camera camera = plain_camera(64, 48, 16);
  camera.projection = world::Projection::orthographic;
  const FrameLabels frame = labelled(world, camera);
  EXPECT_EQ(frame.things[0].visible_pixels, 256);
  EXPECT_EQ(frame.things[1].visible_pixels, 256);
  EXPECT_EQ(frame.things[2].visible_pixels, 0);
}

TEST(LabelsCompute, PartsShareTheirTarget) {
  ModelMaker maker;
  const std::int32_t body = maker.node("body", 0, {0, 0, 0});
  const std::int32_t wing = maker.node("wing", body, {2, 0, -1}, {0, 0, 0, 1});
  const std::int32_t cell = maker.node("cell", wing, {0, 0, -0.5});
  maker.add(body, plate(2, 2));
  maker.add(wing, plate(2, 1));
  maker.add(cell, plate(0.5, 0.5));
  world::World world;
  add(world, "craft", maker, {{0, 0, 10}, {1, 0, 0, 0}});
  LabelOptions options;
  options.parts = {{"hull", "craft/root/body"}, {"array", "wing"}, {"cell", "wing/cell"}};
  const FrameLabels frame = labelled(world, plain_camera(128, 64), options);
  ASSERT_EQ(frame.things.size(), 4u);
  EXPECT_EQ(frame.things[0].label, "");
  EXPECT_EQ(frame.things[1].label, "hull");
  EXPECT_EQ(frame.things[2].label, "array");
  EXPECT_EQ(frame.things[3].label, "cell");
  for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(frame.things[k].id, k + 1);
  // the hull is the node with all below it: the whole
  EXPECT_EQ(frame.things[0].visible, frame.things[1].visible);
  EXPECT_EQ(frame.things[0].amodal, frame.things[1].amodal);
  // the wing hides the body's side from x = 1·100/9 on; the cell lies before the wing
  const Thing &array = frame.things[2], &small = frame.things[3];
  EXPECT_EQ(array.visible_pixels, array.amodal_pixels);
  EXPECT_EQ(small.visible_pixels, small.amodal_pixels);
  EXPECT_NEAR(array.amodal_pixels, 2 * 1 * 10000 / 81.0, 3);
  EXPECT_NEAR(small.amodal_pixels, 0.25 * 10000 / (8.5 * 8.5), 1);
  EXPECT_EQ(array.camera_from_thing.translation, Vec3(2, 0, 9));
  EXPECT_EQ(array.camera_from_thing.rotation, Quat(0, 0, 0, 1));
}

TEST(LabelsCompute, ModelsNamePartsToo) {
  ModelMaker maker;
  const std::int32_t left = maker.node("left", 0, {-1, 0, 0});
  const std::int32_t right = maker.node("right", 0, {1, 0, 0});
  maker.add(left, plate(1, 1));
  maker.add(right, plate(1, 1));
  maker.contents.labels = {{"panel", static_cast<std::uint32_t>(left)},
                           {"panel", static_cast<std::uint32_t>(right)}};
  world::World world;
  add(world, "craft", maker, {{0, 0, 10}, {1, 0, 0, 0}});
  LabelOptions options;
  options.parts = {{"one", "left"}};
  const FrameLabels frame = labelled(world, plain_camera(), options);
  ASSERT_EQ(frame.things.size(), 3u);
  // all of one label are one part, whose pose is that of the first node
  EXPECT_EQ(frame.things[1].label, "panel");
  EXPECT_EQ(frame.things[1].amodal_pixels, 200);
  EXPECT_EQ(frame.things[1].visible, frame.things[0].visible);
  EXPECT_EQ(frame.things[1].camera_from_thing.translation, Vec3(-1, 0, 10));
  EXPECT_EQ(frame.things[2].label, "one");
  EXPECT_EQ(frame.things[2].amodal_pixels, 100);
}

TEST(LabelsCompute, AnUnknownPartIsAnError) {
  world::World world;
  add(world, "craft", single(plate(1, 1)), {{0, 0, 10}, {1, 0, 0, 0}});
  DiagnosticLog log;
  Labeller labeller({.parts = {{"wing", "craft/root/wings"}}});
  EXPECT_FALSE(labeller.label(world, plain_camera(), {}, log));
  EXPECT_TRUE(log.contains(Code("E9005")));
}

// On a plate that faces the Sun: the Earth's shadow is a cylinder to the Sun's centre.
TEST(LabelsCompute, KeypointsInAnEclipseAreNotLit) {
  ModelMaker maker = single(plate(1, 1));
  maker.contents.keypoints.push_back({"middle", 0, Vec3(0)});
  constexpr double kEarth = 6371e3;
  for (const double beside : {0.9, 0.9999, 1.0001, 1.1})
    for (const double behind : {-1.0, 1.0}) {
      world::World world;
      add(world, "plate", maker, {{0, 0, 4}, {1, 0, 0, 0}});
      world.set_sun({.direction = {0, 0, -1}});
      light::Body earth = *light::body_preset("earth");
      earth.air = false;
      earth.radii = Vec3(kEarth);
      earth.centre = Vec3(beside * kEarth, 0, -behind * 2 * kEarth);
      world.set_sky({earth}, false);
      const FrameLabels frame = labelled(world, plain_camera());
      ASSERT_EQ(frame.things[0].keypoints.size(), 1u);
      EXPECT_EQ(frame.things[0].keypoints[0].lit, beside > 1 || behind < 0) << beside << behind;
    }
}

}  // namespace
}  // namespace panwright::labels::compute_test
