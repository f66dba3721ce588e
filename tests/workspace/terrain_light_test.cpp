// Drawers give OpenGL the light of terrain, and tell of it.
#include <gtest/gtest.h>

#include <cstring>

#include "pan/writer.h"
#include "pxn/pxn.h"
#include "tests/support/process.h"
#include "tests/support/shapes.h"
#include "tests/support/terrain_models.h"
#include "workspace/drawer.h"
#include "workspace/terrain.h"

namespace panwright::workspace::terrain_light_test {
namespace {

constexpr int kPosts = 257;  // of the plain, 1 m apart

// A white plate about the origin, its normal z.
world::ModelPtr white_plate(double side) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(support::plate(side, side), "mesh"));
  materials::Material white;
  white.diffuse = Vec3(1);
  contents.materials.push_back(white);
  contents.instances.push_back({0, 0, 0, -1});
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "plate.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(*std::move(model));
}

// A plain of a text's material.
world::ModelPtr plain_of(const std::string& material) {
  const support::TemporaryFolder folder;
  (void)folder.write("flat.dat", std::string(std::size_t{4} * kPosts * kPosts, 0));
  (void)folder.write("flat.hdr",
                     "ENVI\nsamples = 257\nlines = 257\nbands = 1\ndata type = 4\nbyte order = 0\n"
                     "map info = {Local, 1, 1, -128.5, 128.5, 1, 1}\n");
  const auto path =
      folder.write("m.pxn", "<pangu_model ver=\"1\"><material name=\"m\">" + material +
                                "</material><terrain material=\"m\"><dem "
                                "file=\"flat.hdr\" unit=\"m\" values=\"height\"/>"
                                "</terrain></pangu_model>\n");
  std::optional<pxn::TerrainText> terrain;
  pxn::Options options;
  options.terrain = &terrain;
  DiagnosticLog log;
  if (!pxn::read(path, options, log) || !terrain) {
    ADD_FAILURE() << to_text(log);
    return nullptr;
  }
  const auto model = terrain_model(*terrain, folder.path(), log);
  EXPECT_TRUE(model) << to_text(log);
  return model ? *model : nullptr;
}

// A plate at a height over a plain, and a camera before it; the Sun 45 degrees high over x.
struct PlateView {
  world::World world;
  world::Camera camera;

  PlateView(const world::ModelPtr& ground, double side, double height, const Vec3& normal) {
    DiagnosticLog log;
    EXPECT_TRUE(world.add("ground", ground, log));
    const Vec3 at(0, 0, height);
    const bool down = normal.z < -0.5;
    // z to the normal
    const Quat turn = down ? glm::angleAxis(kPi, Vec3(1, 0, 0))
                           : glm::angleAxis(kPi / 2, glm::cross(Vec3(0, 0, 1), normal));
    EXPECT_TRUE(world.add("plate", white_plate(side), {at, turn}, log));
    world.set_sun({.direction = glm::normalize(Vec3(1, 0, 1))});
    world::set_orthographic(camera, 4, 4, 0.5 * side);
    camera.position = at + 0.5 * normal;
    const Vec3 up = down ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    camera.world_from_camera = *world::looking_at(camera.position, at, up, log);
  }
};

Drawer drawer_of_gl() {
  DrawOptions options;
  options.samples = 1;
  options.context = preview::ContextKind::osmesa;
  return Drawer(options);
}

TEST(TerrainLight, OfDrawers) {
  PlateView view(
      support::plane_model(kPosts, std::vector<float>(std::size_t{kPosts} * kPosts, 0.0f)), 1, 5,
      {0, 0, -1});
  DiagnosticLog log;
  Drawer drawer = drawer_of_gl();
  const auto first = drawer.draw(view.world, view.camera, false, log);
  EXPECT_NE(drawer.info().renderer, "");  // of the plate
  ASSERT_TRUE(first && first->ground_light) << to_text(log);
  // regolith sends 7.8 % of this light down's way
  EXPECT_NEAR(double(first->image.radiance[0]) * kPi, 0.0782, 0.001);  // measured: 0.0776
  EXPECT_GT(first->ground_light->seconds, 0);
  EXPECT_NEAR(first->ground_light->share, 0.083, 0.002);  // measured: 0.0826
  EXPECT_TRUE(log.entries().empty()) << to_text(log);  // the ground is ten times half its side away
  // the same again: nothing is found anew
  const auto second = drawer.draw(view.world, view.camera, false, log);
  ASSERT_TRUE(second && second->ground_light);
  EXPECT_EQ(second->ground_light->seconds, 0);
  EXPECT_EQ(second->image.radiance, first->image.radiance);
  // without the plain
  view.world.set_visible(0, false);
  const auto dark = drawer.draw(view.world, view.camera, false, log);
  ASSERT_TRUE(dark) << to_text(log);
  EXPECT_EQ(dark->image.radiance[0], 0);
}

// Half a side of 10 m over 1 m of height.
TEST(TerrainLight, WarnsOfLargeTargetsNearTheGround) {
  const PlateView view(
      support::plane_model(kPosts, std::vector<float>(std::size_t{kPosts} * kPosts, 0.0f)), 20, 1,
      {0, 0, -1});
  DiagnosticLog log;
  ASSERT_TRUE(drawer_of_gl().draw(view.world, view.camera, false, log)) << to_text(log);
  ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
  EXPECT_EQ(log.entries()[0].code, Code("W5021"));
  EXPECT_NE(log.entries()[0].message.find("'plate'"), std::string::npos);
}

// Over a wide Lambert plain a plate that faces down gets albedo times the Sun's light on the
// ground, a plate that stands on end half of it.
TEST(TerrainLight, OfALambertPlain) {
  const world::ModelPtr ground = plain_of("<lambert/><diffuse> 0.3 0.2 0.1 </diffuse>");
  ASSERT_NE(ground, nullptr);
  Drawer drawer = drawer_of_gl();
  const double lit = std::sqrt(0.5);  // cosine
  // on end away from the Sun; towards it the Sun itself shines
  for (const Vec3& normal : {Vec3(0, 0, -1), Vec3(-1, 0, 0)}) {
    const PlateView view(ground, 0.02, 1, normal);
    DiagnosticLog log;
    const auto drawn = drawer.draw(view.world, view.camera, false, log);
    ASSERT_TRUE(drawn) << to_text(log);
    // beyond the plain's edge there is none: 1 m over 128 m
    const double whole = normal.z < 0 ? 1 : 0.5 - 1 / (kPi * 128);
    for (std::size_t k = 0; k < 3; ++k) {
      const double want = (0.3 - 0.1 * double(k)) * lit * whole;
      // measured: 9.3e-3 at most
      EXPECT_NEAR(kPi * double(drawn->image.radiance[k]) / want, 1, 0.015) << normal.x << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace panwright::workspace::terrain_light_test
