#include "world/evaluation.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/pan_sample.h"

namespace panwright::world::evaluation_test {
namespace {

ModelPtr small_model() {
  DiagnosticLog log;
  auto opened = pan::Model::from_bytes(support::small_pan(), "small.pan", log);
  EXPECT_TRUE(opened && opened->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(std::move(*opened));
}

World world_of(std::size_t targets) {
  World world;
  DiagnosticLog log;
  const ModelPtr model = small_model();
  for (std::size_t i = 0; i < targets; ++i)
    EXPECT_TRUE(world.add("t" + std::to_string(i), model, log));
  return world;
}

TEST(Evaluation, WithoutChangesItIsTheModel) {
  const World world = world_of(1);
  const EvaluatedInstance found = evaluated(world[0]);
  EXPECT_EQ(found.model_from_nodes, world[0].model()->world_from_nodes());
  const auto exact = exact_bounds(world[0]);
  const auto model = world[0].model()->world_bounds();
  ASSERT_TRUE(exact && model && found.bounds);
  EXPECT_EQ(exact->low, model->low);
  EXPECT_EQ(exact->high, model->high);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(found.bounds->low[k], exact->low[k]);
    EXPECT_GE(found.bounds->high[k], exact->high[k]);
  }
}

TEST(Evaluation, ANodeTakesWhatIsBelowItAlong) {
  World world = world_of(1);
  const auto& nodes = world[0].model()->nodes();
  NodeTransform turned;
  turned.translation = Vec3(10, 0, 0);
  turned.rotation = glm::angleAxis(kPi / 2, Vec3(0, 0, 1));
  world.set_node_transform(0, 0, turned);
  const EvaluatedInstance found = evaluated(world[0]);
  const auto old = world[0].model()->world_from_nodes();
  const Mat4 root = glm::inverse(pan::parent_from_node(nodes[0]));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Mat4 expected = turned.matrix() * root * old[i];
    for (int c = 0; c < 4; ++c)
      EXPECT_LE(glm::length(found.model_from_nodes[i][c] - expected[c]), 1e-13)
          << i;  // measured 2e-15
  }
}

TEST(Evaluation, AHiddenNodeHidesWhatIsBelowIt) {
  World world = world_of(1);
  world.set_node_visible(0, 0, false);
  const EvaluatedInstance found = evaluated(world[0]);
  for (const std::uint8_t visible : found.node_visible) EXPECT_EQ(visible, 0);
  EXPECT_FALSE(found.bounds);
  EXPECT_FALSE(exact_bounds(world[0]));
}

TEST(Evaluation, AfterRandomEditsItIsWhatAFreshOneIs) {
  World world = world_of(4);
  Evaluation kept;
  std::mt19937 random(7);
  const auto number = [&] { return std::uniform_real_distribution<double>(-2, 2)(random); };
  const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int round = 0; round < 2000; ++round) {
    const std::size_t target = below(world.size());
    const std::uint32_t node = below(world[target].model()->nodes().size());
    switch (below(6)) {
      case 0:
        world.set_pose(target, {Vec3(number(), number(), number()),
                                glm::normalize(Quat(number() + 3, number(), number(), number()))});
        break;
      case 1: {
        NodeTransform t;
        t.translation = Vec3(number(), number(), number());
        t.scale = Vec3(1.5, -0.5, 2);
        world.set_node_transform(target, node, t);
        break;
      }
      case 2:
        world.set_node_transform(target, node, std::nullopt);
        break;
      case 3:
        world.set_node_visible(target, node, below(2) != 0);
        break;
      case 4:
        world.set_visible(target, below(2) != 0);
        break;
      case 5: {
        // remove one and put another in its place, which has the same index
        if (below(10) != 0) break;
        const ModelPtr model = world[target].model();
        world.remove(target);
        DiagnosticLog log;
        ASSERT_TRUE(world.add("new" + std::to_string(round), model, log));
        break;
      }
    }
    if (below(3) != 0) continue;  // several edits between two updates
    kept.update(world);
    Evaluation fresh;
    fresh.update(world);
    ASSERT_EQ(kept.size(), fresh.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      ASSERT_EQ(kept[i].model_from_nodes, fresh[i].model_from_nodes);
      ASSERT_EQ(kept[i].node_visible, fresh[i].node_visible);
      ASSERT_EQ(kept[i].bounds.has_value(), fresh[i].bounds.has_value());
      if (kept[i].bounds) {
        ASSERT_EQ(kept[i].bounds->low, fresh[i].bounds->low);
        ASSERT_EQ(kept[i].bounds->high, fresh[i].bounds->high);
      }
    }
  }
}

TEST(Evaluation, ACameraRidesOnAFrameOfAMovedNode) {
  World world = world_of(1);
  const pan::Model& model = *world[0].model();
  const std::string name(model.frame_name(0));
  DiagnosticLog log;
  Camera before;
  ASSERT_TRUE(place_in_frame(before, world, 0, name, log));
  Pose moved;
  moved.translation = Vec3(0, 0, 5);
  moved.rotation = glm::angleAxis(0.3, glm::normalize(Vec3(1, 2, 3)));
  world.set_pose(0, moved);
  Camera after;
  ASSERT_TRUE(place_in_frame(after, world, 0, name, log));
  EXPECT_LE(glm::length(after.position - (moved.rotation * before.position + moved.translation)),
            1e-14);  // measured 1e-15
  EXPECT_FALSE(place_in_frame(after, world, 0, "no such frame", log));
  EXPECT_TRUE(log.contains(Code("E5005")));
}

}  // namespace
}  // namespace panwright::world::evaluation_test
