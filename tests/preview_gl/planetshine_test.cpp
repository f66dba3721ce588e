// Light of a planet on plates against a quadrature over its disc (sky/planetshine.h, which has
// closed forms of its own for an oracle).
#include "sky/planetshine.h"

#include "materials/brdf.h"
#include "models.h"
#include "tests/support/earthshine.h"
#include "tests/support/view_world.h"

namespace panwright::preview::planetshine_test {
namespace {

using namespace testing_support;
using panwright::testing_support::Earthshine;
using panwright::testing_support::gold;

constexpr std::uint32_t kSide = 16;

// A plate in low orbit, turned by `tilt` from the nadir towards the Sun's side, lit by the planet
// alone: the Sun is behind it or has set.
struct Scene {
  world::World world;
  world::Camera camera;
  Vec3 normal;
};

Scene scene_of(const pan::Model& model, double tilt, const Vec3& to_sun) {
  View view;
  view.to_sun = to_sun;
  Scene scene{panwright::testing_support::world_of(model, view), {}, {}};
  light::Body body = *light::body_preset("earth");
  body.air = false;
  body.albedo = Vec3(0.3);
  body.air = false;  // closed forms are of rough ground alone
  body.albedo = Vec3(0.3);
  body.centre = {0, 0, -6771e3};
  body.radii = Vec3(6371e3);
  scene.world.set_sky({body}, false);
  // the plate's normal is z of its model
  const Quat turn = glm::angleAxis(kPi + tilt, Vec3(0, 1, 0));
  scene.world.set_pose(0, {Vec3(0), turn});
  scene.normal = turn * Vec3(0, 0, 1);
  DiagnosticLog log;
  world::set_orthographic(scene.camera, kSide, kSide, 0.5);
  scene.camera.position = 3.0 * scene.normal;
  scene.camera.world_from_camera =
      *world::looking_at(scene.camera.position, Vec3(0), Vec3(0, 1, 0), log);
  return scene;
}

double irradiance_of(const Scene& scene, const RenderOptions& options) {
  DiagnosticLog log;
  const auto image = Renderer(shared_device()).render(scene.world, scene.camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  double sum = 0;
  for (const float value : image->radiance) {
    EXPECT_TRUE(std::isfinite(value));
    sum += value;
  }
  return sum / static_cast<double>(image->radiance.size()) * kPi / 0.5;
}

TEST(Planetshine, OnTiltedPlates) {
  const pan::Model model = model_of(single(plate(4, 4), lambert(0.5)));
  RenderOptions few, many;
  few.samples = 1;
  many.samples = 0;
  many.pixel_error = 0.01;
  for (const double zenith : {20.0, 70.0, 90.0}) {
    const Vec3 to_sun(std::sin(zenith * kDegree), 0, std::cos(zenith * kDegree));
    double largest = 0, of_few = 0, of_many = 0;
    for (int tilt = -80; tilt <= 160; tilt += 40) {
      const Scene scene = scene_of(model, tilt * kDegree, to_sun);
      const double want = sky::irradiance(sky::Sky(scene.world), Vec3(0), scene.normal).x;
      largest = std::max(largest, want);
      if (glm::dot(scene.normal, glm::normalize(to_sun)) > -0.01) continue;
      of_few = std::max(of_few, std::fabs(irradiance_of(scene, few) - want));
      of_many = std::max(of_many, std::fabs(irradiance_of(scene, many) - want));
    }
    std::printf("zenith %g: %.2f %%, %.2f %%\n", zenith, 100 * of_few / largest,
                100 * of_many / largest);
    // measured: 0.25, 0.24, 0.63 %; 0.25, 0.28, 0.50 %
    const double most = (zenith < 80 ? 0.005 : 0.008) * largest;
    EXPECT_LT(of_few, most) << zenith;
    EXPECT_LT(of_many, most) << zenith;
  }
}

TEST(Planetshine, GoldSphere) {
  for (const double slope : {0.05, 0.15, 0.4}) {
    const materials::Material material = gold(slope);
    View view;
    view.to_sun = {0.5, 0, -1};
    const pan::Model model = model_of(single(sphere(100, 140), material));
    world::World world = panwright::testing_support::world_of(model, view);
    light::Body body = *light::body_preset("earth");
    body.air = false;
    body.albedo = Vec3(0.3);
    body.centre = {0, 0, 6771e3};
    body.radii = Vec3(6371e3);
    world::Camera camera;
    DiagnosticLog log;
    const Vec3 to_viewer = glm::normalize(Vec3(0.9, -0.3, 0.3));
    world::set_orthographic(camera, 128, 128, 2.05);
    camera.position = 5.0 * to_viewer;
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log);
    RenderOptions options;
    options.samples = 1;
    double sums[2] = {0, 0};
    Renderer renderer(shared_device());
    for (int k = 0; k < 2; ++k) {
      world.set_sky(k == 0 ? std::vector<light::Body>{} : std::vector{body}, false);
      const auto image = renderer.render(world, camera, options, log);
      ASSERT_TRUE(image) << to_text(log);
      for (std::size_t i = 0; i < image->radiance.size(); i += 3)
        sums[k] += static_cast<double>(image->radiance[i]);
    }
    const double got = (sums[1] - sums[0]) * std::pow(2.05 / 128, 2);
    const Earthshine earth{.to_sun = glm::normalize(world.sun().direction)};
    const double want = earth.intensity(material, to_viewer);
    std::printf("gold %g: %.2f %%\n", slope, 100 * (got / want - 1));
    // measured: 0.1, 0.6, 0.0 %
    EXPECT_NEAR(got / want, 1, 0.01) << slope;
  }
}

TEST(Planetshine, SteadyFramesMakeNothingAnew) {
  const pan::Model model = model_of(single(plate(4, 4), lambert(0.5)));
  const Scene scene = scene_of(model, 0.3, {0.3, 0.2, 1});
  Renderer renderer(shared_device());
  DiagnosticLog log;
  ASSERT_TRUE(renderer.render(scene.world, scene.camera, {}, log));
  const auto first = renderer.render(scene.world, scene.camera, {}, log);
  const std::uint64_t maps = renderer.counts().shadow_maps;
  const std::uint64_t made = shared_device()->counts().allocations;
  const auto second = renderer.render(scene.world, scene.camera, {}, log);
  ASSERT_TRUE(first && second) << to_text(log);
  EXPECT_EQ(renderer.counts().shadow_maps, maps);
  EXPECT_EQ(shared_device()->counts().allocations, made);
  EXPECT_EQ(first->radiance, second->radiance);
}

TEST(Planetshine, ADarkSunHasNoShadowMaps) {
  const pan::Model model = model_of(single(sphere(20, 30), lambert(0.5)));
  world::World world = panwright::testing_support::world_of(model, View{});
  world::Camera camera;
  DiagnosticLog log;
  world::set_orthographic(camera, kSide, kSide, 2.5);
  camera.position = {0, -5, 0};
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log);
  Renderer renderer(shared_device());
  world::Sun sun = world.sun();
  for (const double irradiance : {0.0, 1.0}) {
    sun.irradiance = Vec3(irradiance);
    world.set_sun(sun);
    const std::uint64_t before = renderer.counts().shadow_maps;
    const auto image = renderer.render(world, camera, {}, log);
    ASSERT_TRUE(image) << to_text(log);
    EXPECT_EQ(renderer.counts().shadow_maps > before, irradiance > 0);
    EXPECT_EQ(*std::ranges::max_element(image->radiance) > 0, irradiance > 0);
  }
}

// Limbs of spheres with lobes far narrower than the planet.
TEST(Planetshine, IsFiniteWithEveryLobe) {
  for (const double slope : {0.002, 0.4})
    for (const int kind : {0, 1, 2}) {
      materials::Material material = lambert(0.3);
      material.specular = Vec3(0.5);
      material.weights = {0.5, 0.5, 0};
      if (kind == 0) material.specular_brdf = materials::BlinnPhong{2 / (slope * slope)};
      if (kind == 1) material.specular_brdf = materials::CookTorrance{.alpha = slope};
      if (kind == 2) material.specular_brdf = materials::Ggx{.alpha_x = slope, .alpha_y = slope};
      const Scene scene = scene_of(model_of(single(sphere(60, 80), material)), 0.3, {0.3, 0.2, 1});
      for (const unsigned samples : {1u, 3u}) {
        RenderOptions options;
        options.samples = samples;
        EXPECT_GT(irradiance_of(scene, options), 0) << slope << ' ' << kind;
      }
    }
}

}  // namespace
}  // namespace panwright::preview::planetshine_test
