// Terrain's shadow on targets against the path tracer: sharp, in a wide penumbra, and none.
#include "preview/reference/ground_layer.h"
#include "tests/reference/reference_models.h"
#include "tests/support/terrain_models.h"

namespace panwright::preview::terrain_shadow_test {
namespace {

using namespace testing_support;

// A plateau of 5 m that ends at x = -7, the Sun in the west, 30 degrees high: its shadow's edge is
// 5 - (x + 7) tan(30 deg) high. A ball of 1 m.
world::World scene_of(double height, double sun_distance) {
  std::vector<float> heights;
  for (int y = 0; y < 65; ++y)
    for (int x = 0; x < 65; ++x) heights.push_back(x <= 25 ? 5.0f : 0.0f);
  DiagnosticLog log;
  world::World world;
  EXPECT_TRUE(world.add("ground", support::plane_model(65, heights), log));
  const world::ModelPtr ball =
      panwright::testing_support::shared(model_of(single(sphere(120, 60), lambert(0.5))));
  EXPECT_TRUE(world.add("ball", ball, {Vec3(-4, 0, height), Quat(1, 0, 0, 0)}, log));
  world::Sun sun = world.sun();
  sun.direction = Vec3(-std::sqrt(0.75), 0, 0.5);
  sun.distance = sun_distance;
  world.set_sun(sun);
  return world;
}

// From the south-west, at the ball: no ground in view.
world::Camera camera_at(double height) {
  DiagnosticLog log;
  world::Camera camera;
  world::set_orthographic(camera, 64, 64, 2.4);
  const Vec3 ball(-4, 0, height);
  camera.position = ball + Vec3(-1.5, -1.5, 4);
  camera.world_from_camera = *world::looking_at(camera.position, ball, Vec3(0, 0, 1), log);
  return camera;
}

struct Difference {
  double flux = 0, rms = 0;  // of the ball, in parts of its flux and of a pixel that faces the Sun
};

// As the drawer does (workspace/drawer.cpp).
image::Image shaded(const world::World& world, const world::Camera& camera, bool& shades) {
  DiagnosticLog log;
  Renderer renderer(shared_device());
  RenderOptions options;
  options.samples = 8;
  options.ground_truth = true;
  auto image = renderer.render(world, camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  const std::vector<float> shares = GroundLayer().sun_shares(world, camera, true, *image);
  shades = !shares.empty();
  if (!shades) return *std::move(image);
  options.sunlight = false;
  const auto rest = renderer.render(world, camera, options, log);
  EXPECT_TRUE(rest) << to_text(log);
  shade(shares, *rest, *image);
  return *std::move(image);
}

Difference difference(const image::Image& image, const image::Image& truth) {
  Difference out;
  double flux = 0, squares = 0, want = 0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.target_id[i] != 2) continue;
    const double got = double(image.radiance[3 * i]), right = double(truth.radiance[3 * i]);
    flux += got;
    want += right;
    squares += (got - right) * (got - right);
    ++pixels;
  }
  EXPECT_GT(pixels, 1000u);
  out.flux = want > 0 ? flux / want - 1 : flux;
  out.rms = std::sqrt(squares / double(pixels)) / (0.5 / kPi);
  return out;
}

TEST(TerrainShadow, OnABallAsThePathTracer) {
  // the shadow's edge is 3.27 m high at the ball's middle
  for (const double distance : {1.0, 0.05})
    for (const double height : {3.2, 2.6}) {
      const world::World world = scene_of(height, distance);
      const world::Camera camera = camera_at(height);
      ReferenceOptions options = direct_light(256);
      options.sun_disc = true;
      const image::Image truth = traced(world, camera, options).image;
      bool shades = false;
      const image::Image image = shaded(world, camera, shades);
      EXPECT_TRUE(shades);
      const Difference found = difference(image, truth);
      printf("ball at %.1f m, Sun at %.2f AU: flux %+.1e, pixels %.1e rms\n", height, distance,
             found.flux, found.rms);
      // measured: 2.5e-3, 4.2e-3; 6.0e-4, and 2.9e-2 of the little that the deep shadow leaves.
      // Pixels 2.1e-2, 1.2e-2 at the sharp edge, which has one share a pixel; 7.4e-3, 9.2e-3 in the
      // wide penumbra
      EXPECT_LT(std::fabs(found.flux), height > 3 ? 0.01 : 0.06);
      EXPECT_LT(found.rms, distance > 0.5 ? 0.04 : 0.016);
    }
}

// High above all ground no ray is cast; in full shadow nothing of the Sun is left.
TEST(TerrainShadow, AllOrNothing) {
  bool shades = true;
  (void)shaded(scene_of(6.5, 1), camera_at(6.5), shades);
  EXPECT_FALSE(shades);
  const image::Image dark = shaded(scene_of(1.2, 1), camera_at(1.2), shades);
  EXPECT_TRUE(shades);
  for (std::size_t i = 0; i < dark.pixels(); ++i) {
    if (dark.target_id[i] == 2) EXPECT_EQ(dark.radiance[3 * i], 0) << i;
  }
}

}  // namespace
}  // namespace panwright::preview::terrain_shadow_test
