// Drawers give OpenGL the light of terrain, and tell of it.
#include <gtest/gtest.h>

#include "pan/writer.h"
#include "tests/support/shapes.h"
#include "tests/support/terrain_models.h"
#include "workspace/drawer.h"

namespace panwright::workspace::terrain_light_test {
namespace {

// A white plate that faces down, 5 m over a plain.
world::ModelPtr plate() {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(support::plate(1, 1), "mesh"));
  materials::Material white;
  white.diffuse = Vec3(1);
  contents.materials.push_back(white);
  contents.instances.push_back({0, 0, 0, -1});
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "plate.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(*std::move(model));
}

TEST(TerrainLight, OfDrawers) {
  constexpr int kSide = 257;
  const Quat down = glm::angleAxis(kPi, Vec3(1, 0, 0));
  DiagnosticLog log;
  world::World world;
  ASSERT_TRUE(world.add("ground",
                        support::plane_model(kSide, std::vector<float>(kSide * kSide, 0.0f)), log));
  ASSERT_TRUE(world.add("plate", plate(), {Vec3(0, 0, 5), down}, log));
  world.set_sun({.direction = glm::normalize(Vec3(1, 0, 1))});
  world::Camera camera;
  world::set_orthographic(camera, 4, 4, 0.5);
  camera.position = {0, 0, 4};
  camera.world_from_camera = *world::looking_at(camera.position, {0, 0, 5}, Vec3(0, 1, 0), log);
  DrawOptions options;
  options.samples = 1;
  options.context = preview::ContextKind::osmesa;
  auto drawer = Drawer::create(options, log);
  ASSERT_TRUE(drawer) << to_text(log);
  const auto first = drawer->draw(world, camera, false, log);
  ASSERT_TRUE(first && first->ground_light) << to_text(log);
  // of a plain that reflects 7.8 % of light at 45 degrees towards all sides, times 1/π
  EXPECT_NEAR(double(first->image.radiance[0]) * kPi, 0.0782,
              0.001);  // measured: 0.0776, the plain ends
  EXPECT_GT(first->ground_light->seconds, 0);
  EXPECT_NEAR(first->ground_light->share, 0.083, 0.002);  // measured: 0.0826
  // the same again: nothing is found anew
  const auto second = drawer->draw(world, camera, false, log);
  ASSERT_TRUE(second && second->ground_light);
  EXPECT_EQ(second->ground_light->seconds, 0);
  EXPECT_EQ(second->image.radiance, first->image.radiance);
  // without the plain
  world.set_visible(0, false);
  const auto dark = drawer->draw(world, camera, false, log);
  ASSERT_TRUE(dark) << to_text(log);
  EXPECT_EQ(dark->image.radiance[0], 0);
}

}  // namespace
}  // namespace panwright::workspace::terrain_light_test
