// Joint values of worlds: what they move, what they leave, and what they point at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pan/writer.h"
#include "world/aim.h"
#include "world/evaluation.h"
#include "world/sweep.h"

namespace panwright::world::joints_test {
namespace {

geometry::JointValues one(double value) {
  geometry::JointValues out{};
  out[0] = value;
  return out;
}

pan::JointContent joint(std::string name, std::uint32_t node, geometry::JointKind kind,
                        const Vec3& axis, std::optional<std::pair<double, double>> limits = {}) {
  pan::JointContent out;
  out.name = std::move(name);
  out.node = node;
  out.joint.kind = kind;
  out.joint.axis = glm::normalize(axis);
  out.value = geometry::rest_values(kind);
  if (limits) {
    out.joint.limited = true;
    out.joint.lower = one(limits->first);
    out.joint.upper = one(limits->second);
  }
  return out;
}

geometry::Mesh cube(const Vec3& low, const Vec3& high) {
  geometry::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    mesh.normals.push_back(glm::normalize(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

ModelPtr model_of(const pan::Contents& contents) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(std::move(*model));
}

World world_of(const pan::Contents& contents) {
  World world;
  DiagnosticLog log;
  EXPECT_TRUE(world.add("craft", model_of(contents), log));
  return world;
}

pan::Contents empty_contents() {
  pan::Contents contents;
  contents.version = "test";
  contents.nodes = {{"root", -1, {0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}};
  contents.materials = {{}};
  contents.meshes = {pan::packed(cube(Vec3(-0.5), Vec3(0.5)), "cube")};
  return contents;
}

double difference(const Mat4& a, const Mat4& b) {
  double worst = 0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) worst = std::max(worst, std::fabs(a[c][r] - b[c][r]));
  return worst;
}

// A chain of links of 1 m along x, each turning about z.
pan::Contents arm(int links) {
  pan::Contents contents = empty_contents();
  for (int i = 0; i < links; ++i) {
    contents.nodes.push_back(
        {"link" + std::to_string(i), i, {i == 0 ? 0.0 : 1.0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}});
    contents.joints.push_back(joint("q" + std::to_string(i), static_cast<std::uint32_t>(i + 1),
                                    geometry::JointKind::revolute, {0, 0, 1}, {{-4, 4}}));
  }
  contents.instances = {{static_cast<std::uint32_t>(links), 0, 0, -1}};
  contents.keypoints = {{"tip", static_cast<std::uint32_t>(links), {1, 0, 0}}};
  return contents;
}

TEST(JointStates, ArmsReachWhereTheirAnglesTakeThem) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angles(-kPi, kPi);
  for (const int links : {2, 7, 100}) {
    World world = world_of(arm(links));
    double worst = 0;
    for (int run = 0; run < 20; ++run) {
      long double sum = 0, x = 0, y = 0;
      for (int i = 0; i < links; ++i) {
        const double q = angles(random);
        world.set_joint(0, static_cast<std::uint32_t>(i), one(q));
        sum += q;
        x += std::cos(sum);
        y += std::sin(sum);
      }
      const auto at = evaluated(world[0]);
      const Vec4 tip = at.model_from_nodes.back() * Vec4(1, 0, 0, 1);
      worst = std::max({worst, std::fabs(tip.x - static_cast<double>(x)),
                        std::fabs(tip.y - static_cast<double>(y))});
    }
    EXPECT_LE(worst, 1e-12) << links;  // measured 2e-16, 2e-15, 6e-14
  }
}

// Values are kept and matrices made from them: the millionth is as good as the first.
TEST(JointStates, AMillionUpdatesDoNotDrift) {
  World world = world_of(arm(2));
  InstanceEvaluation running;
  for (int i = 0; i < 1'000'000; ++i) {
    world.set_joint(0, 0, one(std::fmod(0.01 * i, 3)));
    running.update(world[0]);
  }
  world.set_joint(0, 0, one(0.625));
  world.set_joint(0, 1, one(-1.5));
  running.update(world[0]);
  const Vec4 tip = running.result().model_from_nodes.back() * Vec4(1, 0, 0, 1);
  EXPECT_NEAR(tip.x, std::cos(0.625) + std::cos(-0.875), 1e-15);
  EXPECT_NEAR(tip.y, std::sin(0.625) + std::sin(-0.875), 1e-15);
}

// A random tree with joints of every kind, mirrored and sheared nodes among them.
pan::Contents random_tree(std::mt19937_64& random, int nodes) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vec = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  pan::Contents contents = empty_contents();
  for (int i = 1; i < nodes; ++i) {
    Quat q(unit(random), unit(random), unit(random), unit(random));
    const int parent = std::uniform_int_distribution<int>(std::max(0, i - 5), i - 1)(random);
    contents.nodes.push_back(
        {"n" + std::to_string(i),
         parent,
         vec(),
         glm::normalize(q),
         {1 + 0.3 * unit(random), i % 3 ? 1.0 : -1.0, 1 + 0.3 * unit(random)}});
    contents.instances.push_back({static_cast<std::uint32_t>(i), 0, 0, -1});
    for (int k = 0; k < i % 3; ++k) {
      const auto kind = static_cast<geometry::JointKind>((i + 3 * k) % geometry::kJointKinds);
      contents.joints.push_back(joint("j" + std::to_string(i) + "_" + std::to_string(k),
                                      static_cast<std::uint32_t>(i), kind, vec() + Vec3(2, 0, 0)));
    }
  }
  return contents;
}

// Node by node from the root, with each joint's matrix from quaternions.
std::vector<Mat4> by_hand(const World& world) {
  const pan::Model& model = *world[0].model();
  const auto values = world[0].joint_values();
  std::vector<Mat4> out;
  for (std::size_t n = 0; n < model.nodes().size(); ++n) {
    const pan::layout::Node& node = model.nodes()[n];
    Mat4 m = glm::translate(Mat4(1),
                            Vec3(node.translation[0], node.translation[1], node.translation[2])) *
             glm::mat4_cast(
                 Quat(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3])) *
             glm::scale(Mat4(1), Vec3(node.scale[0], node.scale[1], node.scale[2]));
    for (std::size_t j = 0; j < values.size(); ++j) {
      const pan::layout::Joint& record = model.joints()[j];
      if (record.node != n) continue;
      const Vec3 axis(record.axis[0], record.axis[1], record.axis[2]);
      const auto turned = [](double angle, const Vec3& about) {
        return glm::mat4_cast(glm::angleAxis(angle, about));
      };
      const auto& v = values[j];
      const auto ball = [&](std::size_t first) {
        return turned(v[first + 2], {0, 0, 1}) * turned(v[first + 1], {0, 1, 0}) *
               turned(v[first], {1, 0, 0});
      };
      switch (static_cast<geometry::JointKind>(record.kind)) {
        case geometry::JointKind::fixed:
          break;
        case geometry::JointKind::revolute:
        case geometry::JointKind::continuous:
          m = m * turned(v[0], axis);
          break;
        case geometry::JointKind::prismatic:
          m = m * glm::translate(Mat4(1), v[0] * axis);
          break;
        case geometry::JointKind::ball:
          m = m * ball(0);
          break;
        case geometry::JointKind::general:
          m = m * glm::translate(Mat4(1), Vec3(v[6], v[7], v[8])) * ball(3) *
              glm::scale(Mat4(1), Vec3(v[0], v[1], v[2]));
          break;
        case geometry::JointKind::scale:
          m = m * glm::scale(Mat4(1), Vec3(axis.x != 0 ? v[0] : 1, axis.y != 0 ? v[0] : 1,
                                           axis.z != 0 ? v[0] : 1));
          break;
      }
    }
    out.push_back(node.parent < 0 ? m : out[static_cast<std::size_t>(node.parent)] * m);
  }
  return out;
}

TEST(JointStates, TreesOfAllKindsMoveAsTheirMatricesSay) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0;
  for (int run = 0; run < 20; ++run) {
    World world = world_of(random_tree(random, 30));
    InstanceEvaluation running;
    for (int step = 0; step < 30; ++step) {
      const auto count = static_cast<std::uint32_t>(world[0].model()->joints().size());
      const std::uint32_t j = std::uniform_int_distribution<std::uint32_t>(0, count - 1)(random);
      const auto kind = static_cast<geometry::JointKind>(world[0].model()->joints()[j].kind);
      geometry::JointValues values{};
      for (std::size_t i = 0; i < geometry::value_count(kind); ++i)
        values[i] = (geometry::unit_of(kind, i) == geometry::JointUnit::factor ? 1 : 0) +
                    0.5 * unit(random);
      if (step % 7 == 3)
        world.set_joint(0, j, std::nullopt);
      else
        world.set_joint(0, j, values);
      if (step % 5 == 4) world.set_node_visible(0, j % 30, step % 2);
      if (step % 11 == 6) {
        NodeTransform moved;
        moved.translation = Vec3(unit(random));
        world.set_node_transform(0, 1 + j % 20, moved);
      }
      if (step % 11 == 9) world.set_node_transform(0, 1 + j % 20, std::nullopt);
      running.update(world[0]);
      const EvaluatedInstance fresh = evaluated(world[0]);
      // what is worked out anew only where it changed has the same bits
      EXPECT_EQ(running.result().model_from_nodes, fresh.model_from_nodes);
      EXPECT_EQ(running.result().node_visible, fresh.node_visible);
      ASSERT_EQ(running.result().bounds.has_value(), fresh.bounds.has_value());
      if (fresh.bounds) {
        EXPECT_EQ(running.result().bounds->low, fresh.bounds->low);
        EXPECT_EQ(running.result().bounds->high, fresh.bounds->high);
      }
      if (!world[0].node_states().empty()) continue;
      const auto expected = by_hand(world);
      for (std::size_t n = 0; n < expected.size(); ++n) {
        double size = 1;
        for (int c = 0; c < 4; ++c) size = std::max(size, glm::length(expected[n][c]));
        worst = std::max(worst, difference(fresh.model_from_nodes[n], expected[n]) / size);
      }
    }
  }
  EXPECT_LE(worst, 1e-13);  // measured 5e-15
}

// Turning and moving the whole craft turns and moves all that joints do with it.
TEST(JointStates, DoNotDependOnWhereTheCraftIs) {
  std::mt19937_64 random(3);
  pan::Contents contents = random_tree(random, 25);
  World world = world_of(contents);
  const Quat turn = glm::normalize(Quat(0.3, -0.5, 0.7, 0.1));
  contents.nodes[0].translation = {5, -3, 2};
  contents.nodes[0].rotation = turn;
  World other = world_of(contents);
  for (std::uint32_t j = 0; j < world[0].model()->joints().size(); ++j)
    if (geometry::value_count(
            static_cast<geometry::JointKind>(world[0].model()->joints()[j].kind)) == 1)
      for (World* each : {&world, &other}) each->set_joint(0, j, one(0.3 + 0.01 * j));
  const Mat4 root = glm::translate(Mat4(1), Vec3(5, -3, 2)) * glm::mat4_cast(turn);
  const auto a = evaluated(world[0]), b = evaluated(other[0]);
  double worst = 0;
  for (std::size_t n = 0; n < a.model_from_nodes.size(); ++n)
    worst = std::max(worst, difference(root * a.model_from_nodes[n], b.model_from_nodes[n]));
  EXPECT_LE(worst, 1e-12);  // measured 5e-15
}

TEST(JointStates, ChangeTheShapeStampOnlyWhereTheyChange) {
  World world = world_of(arm(2));
  const Stamp before = world[0].shape_stamp();
  world.set_joint(0, 1, std::nullopt);
  EXPECT_EQ(world[0].shape_stamp(), before);
  world.set_joint(0, 1, one(1));
  const Stamp moved = world[0].shape_stamp();
  EXPECT_NE(moved, before);
  world.set_joint(0, 1, one(1));
  EXPECT_EQ(world[0].shape_stamp(), moved);
  world.set_joint(0, 1, std::nullopt);
  EXPECT_NE(world[0].shape_stamp(), moved);
  EXPECT_TRUE(world[0].joint_states().empty());
  // limits apply when it is evaluated
  world.set_joint(0, 0, one(77));
  EXPECT_EQ(world[0].joint_values()[0][0], 4);
}

// ---- aims

TEST(Aim, AWingTurnsItsNormalToTheSun) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  pan::Contents contents = empty_contents();
  contents.nodes.push_back(
      {"yoke", 0, {0, 1, 0}, glm::normalize(Quat(0.9, 0.1, 0.2, -0.3)), {2, 2, 2}});
  contents.joints.push_back(joint("drive", 1, geometry::JointKind::continuous, {0.1, 1, 0.2}));
  contents.joints[0].pointing = glm::normalize(Vec3(0.2, 0, 1));
  contents.joints[0].points_at_sun = true;
  World world = world_of(contents);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    Pose pose;
    pose.translation = Vec3(100, 200, 300);
    pose.rotation =
        glm::normalize(Quat(normal(random), normal(random), normal(random), normal(random)));
    world.set_pose(0, pose);
    Sun sun;
    sun.direction = Vec3(normal(random), normal(random), normal(random));
    world.set_sun(sun);
    std::size_t unreached = 0;
    aim_at_sun(world, [&](std::size_t, std::uint32_t, double) { ++unreached; });
    EXPECT_EQ(unreached, 0u);  // no limits
    const auto cosine = [&](double q) {
      World other = world;
      other.set_joint(0, 0, one(q));
      const Mat3 m = Mat3(pose.matrix() * evaluated(other[0]).model_from_nodes[1]);
      return glm::dot(glm::normalize(m * Vec3(0.2, 0, 1)), glm::normalize(sun.direction));
    };
    const double q = world[0].joint_values()[0][0], found = cosine(q);
    for (const double step : {1e-7, 1e-3, 0.1, 1.0, 2.0, 3.0})
      for (const double sign : {-1.0, 1.0})
        worst = std::max(worst, cosine(q + sign * step) - found);
  }
  EXPECT_LE(worst, 1e-12);  // measured 3e-16
}

TEST(Aim, AGimbalPointsAtAPlaceItIsMovedAwayFrom) {
  pan::Contents contents = empty_contents();
  contents.nodes.push_back({"mast", 0, {0, 0, 1}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.nodes.push_back({"dish", 1, {0.5, 0, 0.2}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.joints.push_back(joint("az", 1, geometry::JointKind::continuous, {0, 0, 1}));
  contents.joints.push_back(joint("el", 2, geometry::JointKind::revolute, {0, 1, 0}, {{-2, 2}}));
  contents.joints[1].pointing = Vec3(0, 0, 1);
  contents.joints[1].gimbal = 0;
  World world = world_of(contents);
  EXPECT_FALSE(can_aim(*world[0].model(), 0));
  ASSERT_TRUE(can_aim(*world[0].model(), 1));
  Pose pose;
  pose.translation = Vec3(10, 0, 0);
  pose.rotation = glm::angleAxis(0.7, glm::normalize(Vec3(1, 1, 0)));
  world.set_pose(0, pose);
  const Vec3 place(12, 5, 1);  // a few metres away: the origin of the dish swings along
  EXPECT_LE(aim_at_point(world, 0, 1, place).error, 1e-12);
  const Mat4 m = pose.matrix() * evaluated(world[0]).model_from_nodes[2];
  EXPECT_LE(angle_between(Vec3(m * Vec4(0, 0, 1, 0)), place - Vec3(m[3])), 1e-12);
  // towards where only the limit of the elevation keeps it from
  const Aimed down = aim(world, 0, 1, pose.rotation * Vec3(0, 0, -1));
  EXPECT_NEAR(down.error, kPi - 2, 1e-12);
  EXPECT_NEAR(down.least, 0, 1e-12);
  EXPECT_TRUE(down.limited());
}

TEST(Aim, WhatIsGivenAValueStaysThere) {
  pan::Contents contents = empty_contents();
  contents.nodes.push_back({"wing", 0, {0, 1, 0}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.joints.push_back(joint("drive", 1, geometry::JointKind::revolute, {0, 1, 0}, {{-1, 1}}));
  contents.joints[0].pointing = Vec3(0, 0, 1);
  contents.joints[0].points_at_sun = true;
  World world = world_of(contents);
  Sun sun;
  sun.direction = Vec3(1, 0, 0);  // at 90 degrees: the limit is at 57
  world.set_sun(sun);
  double left = 0;
  aim_at_sun(world, [&](std::size_t, std::uint32_t, double error) { left = error; });
  EXPECT_NEAR(left, kPi / 2 - 1, 1e-14);
  EXPECT_EQ(world[0].joint_values()[0][0], 1);
  sun.direction = Vec3(1, 0, 1);  // it follows the Sun
  world.set_sun(sun);
  aim_at_sun(world);
  EXPECT_NEAR(world[0].joint_values()[0][0], kPi / 4, 1e-15);
  world.set_joint(0, 0, one(-0.5));
  aim_at_sun(world);
  EXPECT_EQ(world[0].joint_values()[0][0], -0.5);
}

// ---- sweeps

TEST(Sweep, TrianglesCutOrTouch) {
  const Vec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Vec3 through[3] = {{0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.3, 0.2, 1}};
  const Vec3 beside[3] = {{2, 0.2, -1}, {2, 0.2, 1}, {2.1, 0.2, 1}};
  const Vec3 standing[3] = {{0.2, 0.2, 0}, {0.3, 0.2, 0}, {0.2, 0.2, 1}};
  const Vec3 same_plane[3] = {{0.1, 0.1, 0}, {0.9, 0.1, 0}, {0.1, 0.9, 0}};
  EXPECT_TRUE(triangles_cut(a, through, 1e-9));
  EXPECT_TRUE(triangles_cut(through, a, 1e-9));
  EXPECT_FALSE(triangles_cut(a, beside, 1e-9));
  EXPECT_FALSE(triangles_cut(a, standing, 1e-9));
  EXPECT_FALSE(triangles_cut(a, same_plane, 1e-9));
  const Vec3 line[3] = {{0, 0, -1}, {0.5, 0.2, 0}, {1, 0.4, 1}};
  EXPECT_FALSE(triangles_cut(a, line, 1e-9));  // no area
}

// A lever of 2 m meets a post at (cos 60°, sin 60°)·1.5, as thick as it is.
TEST(Sweep, NamesWhatAPartRunsInto) {
  pan::Contents contents = empty_contents();
  contents.meshes = {pan::packed(cube({0, -0.01, -0.01}, {2, 0.01, 0.01}), "lever"),
                     pan::packed(cube({-0.01, -0.01, -1}, {0.01, 0.01, 1}), "post")};
  contents.nodes.push_back({"lever", 0, {0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.nodes.push_back(
      {"post", 0, {1.5 * std::cos(kPi / 3), 1.5 * std::sin(kPi / 3), 0}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.nodes.push_back({"near", 0, {0.5, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}});
  contents.instances = {{1, 0, 0, -1}, {2, 1, 0, -1}, {3, 1, 0, -1}};
  contents.joints = {joint("hinge", 1, geometry::JointKind::revolute, {0, 0, 1}, {{0, kPi / 2}})};
  const World world = world_of(contents);
  DiagnosticLog log;
  const auto found = swept(world, 0, {}, 91, log);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  const SweptJoint& sweep = (*found)[0];
  EXPECT_EQ(sweep.positions, 91u);
  EXPECT_NEAR(sweep.bounds.high.x, 2, 1e-6);
  EXPECT_NEAR(sweep.bounds.high.y, 2, 1e-6);
  // the post that the lever stands in now is not told; the other at 60 degrees, where half the
  // lever's width and half the post's width are (0.01 + 0.014)/1.5 rad or less
  ASSERT_EQ(sweep.collisions.size(), 1u);
  EXPECT_EQ(sweep.collisions[0].node_a, 1u);
  EXPECT_EQ(sweep.collisions[0].node_b, 2u);
  EXPECT_NEAR(sweep.collisions[0].first, kPi / 3, 0.017);
  EXPECT_NEAR(sweep.collisions[0].last, kPi / 3, 0.017);
  EXPECT_GE(sweep.collisions[0].positions, 1u);
}

}  // namespace
}  // namespace panwright::world::joints_test
