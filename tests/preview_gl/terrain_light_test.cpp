// Light of terrain on targets: against quadratures over a plain, and against the path tracer.
#include "materials/sample.h"
#include "preview/reference/ground_layer.h"
#include "sky/planetshine.h"
#include "sky/shine_table.h"
#include "tests/reference/reference_models.h"
#include "tests/support/terrain_models.h"

namespace panwright::preview::terrain_light_test {
namespace {

using namespace testing_support;

// Plain of 1,024 m, z = 0.
constexpr int kPosts = 1025;
constexpr double kHalf = 512;
constexpr std::uint32_t kPixels = 16;

world::ModelPtr plain() {
  static const world::ModelPtr model =
      support::plane_model(kPosts, std::vector<float>(std::size_t{kPosts} * kPosts, 0));
  return model;
}

world::ModelPtr moon() {
  static const world::ModelPtr model =
      support::globe_model(std::vector<float>(std::size_t{720} * 360, 0));
  return model;
}

world::World scene_of(const world::ModelPtr& ground, const pan::Contents& target,
                      const world::Pose& pose, const Vec3& to_sun) {
  DiagnosticLog log;
  world::World world;
  EXPECT_TRUE(world.add("ground", ground, log));
  EXPECT_TRUE(world.add("target", panwright::testing_support::shared(model_of(target)), pose, log));
  world::Sun sun = world.sun();
  sun.direction = to_sun;
  world.set_sun(sun);
  return world;
}

Vec3 sun_at(double elevation) {
  return {std::cos(elevation * kDegree), 0, std::sin(elevation * kDegree)};
}

// Looks along a direction at a point from a metre away, over a width.
world::Camera camera_at(const Vec3& at, const Vec3& along, double width) {
  DiagnosticLog log;
  world::Camera camera;
  world::set_orthographic(camera, kPixels, kPixels, width);
  camera.position = at - along;
  const Vec3 up = std::fabs(along.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
  camera.world_from_camera = *world::looking_at(camera.position, at, up, log);
  return camera;
}

// As the drawer does (workspace/drawer.cpp), without the Sun's own light.
image::Image drawn(const world::World& world, const world::Camera& camera) {
  DiagnosticLog log;
  RenderOptions options;
  options.samples = 2;
  options.ground_shine = GroundLayer().shine(world);
  options.sunlight = false;
  auto image = Renderer(shared_device()).render(world, camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return *std::move(image);
}

double mean(const image::Image& image) {
  double sum = 0;
  for (const float value : image.radiance) sum += double(value);
  return sum / static_cast<double>(image.radiance.size());
}

// Irradiance of a plate over the plain from below, by directions in steps of equal solid angles.
double quadrature(double height, const Vec3& normal, const Vec3& to_sun) {
  const materials::Material material = lunar_regolith();
  const materials::Scattering scattering(material);
  constexpr int kSteps = 600;
  double sum = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < 2 * kSteps; ++i) {
      const double down = (j + 0.5) / kSteps, across = std::sqrt(1 - down * down);
      const det::SinCos turn = det::sincos(kPi * (i + 0.5) / kSteps);
      const Vec3 along(across * turn.cos, across * turn.sin, -down);
      if (std::max(std::fabs(along.x), std::fabs(along.y)) * height / down > kHalf) continue;
      const double cosine = glm::dot(normal, along);
      if (!(cosine > 0)) continue;
      sum += cosine * to_sun.z * scattering.brdf(to_sun, -along, Vec3(0, 0, 1), Vec3(0), Vec3(1)).x;
    }
  return sum * kPi / kSteps / kSteps;
}

// Of rays alone, on a plate.
double irradiance_of(const world::World& world, const Vec3& normal) {
  const auto shine = GroundLayer().shine(world);
  double sum = 0;
  for (const light::ShinePart& part : (*shine)[1].parts)
    sum += part.irradiance.x * std::max(glm::dot(normal, part.direction), 0.0);
  return sum;
}

TEST(TerrainLight, OnPlatesOverAPlain) {
  constexpr double kHeight = 10, kAlbedo = 0.5;
  double worst_rays = 0, worst_image = 0;  // in parts of the largest
  for (const double elevation : {10.0, 45.0, 90.0}) {
    const Vec3 to_sun = sun_at(elevation);
    double most = 0, rays = 0, image = 0;
    // from the nadir towards the Sun
    for (const double tilt : {0.0, 45.0, 90.0, -90.0, 135.0, 180.0}) {
      const Vec3 normal(std::sin(tilt * kDegree), 0, -std::cos(tilt * kDegree));
      const Quat turn = glm::angleAxis(kPi - tilt * kDegree, Vec3(0, 1, 0));
      ASSERT_LT(glm::length(turn * Vec3(0, 0, 1) - normal), 1e-12);
      const world::World world = scene_of(plain(), single(plate(0.02, 0.02), lambert(kAlbedo)),
                                          {Vec3(0, 0, kHeight), turn}, to_sun);
      const double want = quadrature(kHeight, normal, to_sun);
      const double got =
          mean(drawn(world, camera_at(Vec3(0, 0, kHeight), -normal, 0.01))) * kPi / kAlbedo;
      most = std::max(most, want);
      rays = std::max(rays, std::fabs(irradiance_of(world, normal) - want));
      image = std::max(image, std::fabs(got - want));
    }
    printf("Sun %g: %.5f, rays %.2f %%, images %.2f %%\n", elevation, most, 100 * rays / most,
           100 * image / most);
    worst_rays = std::max(worst_rays, rays / most);
    worst_image = std::max(worst_image, image / most);
  }
  // measured: 2.9e-3; 1.5e-2 of a low Sun, else 3.8e-3
  EXPECT_LT(worst_rays, 0.006);
  EXPECT_LT(worst_image, 0.025);
}

// Irradiance of a plate that faces a smooth globe, by places on it.
double facing_globe(double distance, const Vec3& up, const Vec3& to_sun) {
  constexpr double kRadius = 1737400;
  const materials::Material material = lunar_regolith();
  const materials::Scattering scattering(material);
  constexpr int kSteps = 400;
  const Vec3 x = glm::normalize(glm::cross(up, Vec3(0.3, 0.5, 0.1))), y = glm::cross(up, x);
  const double edge = kRadius / distance;  // cosine of the limb's place
  double sum = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      // closer to each other below the plate
      const double t = (j + 0.5) / kSteps, along = 1 - (1 - edge) * t * t;
      const double across = std::sqrt(1 - along * along);
      const det::SinCos turn = det::sincos(2 * kPi * (i + 0.5) / kSteps);
      const Vec3 normal = along * up + across * (turn.cos * x + turn.sin * y);
      const Vec3 way = distance * up - kRadius * normal;
      const double length = glm::length(way);
      const Vec3 to_viewer = way / length;
      const double lit = glm::dot(normal, to_sun), seen = glm::dot(normal, to_viewer);
      if (!(lit > 0 && seen > 0)) continue;
      sum += scattering.brdf(to_sun, to_viewer, normal, Vec3(0), Vec3(1)).x * lit * seen *
             glm::dot(up, to_viewer) * 2 * t / (length * length);
    }
  return sum * 2 * kPi * (1 - edge) * kRadius * kRadius / (double{kSteps} * kSteps);
}

// All around the target, and by the cap of a globe that is far away.
TEST(TerrainLight, OverAGlobe) {
  const Vec3 up = glm::normalize(Vec3(0.8, 0.5, 0.2));
  const pan::Contents target = single(box(Vec3(1)), lambert(0.5));
  for (const double radii : {1.01, 1.6, 2.5, 50.0})
    for (const Vec3& to_sun :
         {up, glm::normalize(Vec3(-0.5, 0.8, 0.3)), glm::normalize(-up + 0.8 * Vec3(0, 0, 1))}) {
      const double distance = radii * 1737400;
      const world::World world =
          scene_of(moon(), target, {distance * up, Quat(1, 0, 0, 0)}, to_sun);
      const double want = facing_globe(distance, up, to_sun);
      const double most = facing_globe(distance, up, up);
      const double got = irradiance_of(world, -up);
      printf("%g radii, Sun %5.1f degrees from above: %.3e, %+.2f %% of the full globe's\n", radii,
             std::acos(glm::dot(up, to_sun)) / kDegree, want, 100 * (got - want) / most);
      EXPECT_NEAR(got, want, 0.005 * most);  // measured: 2.2e-3
    }
}

struct Errors {
  double mean = 0, rms = 0;  // in parts of the light
};
Errors errors_of(const world::World& world, const Vec3& at, const Vec3& normal, double width) {
  const world::Camera camera = camera_at(at, -0.5 * normal, width);
  ReferenceOptions options = direct_light(256);
  options.sun_disc = true;
  const image::Image direct = traced(world, camera, options).image;
  options.bounces = 1;
  const image::Image all = traced(world, camera, options).image;
  const image::Image image = drawn(world, camera);
  expect_no_nan(image);
  double want = 0, got = 0, squares = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const double right = double(all.radiance[3 * i] - direct.radiance[3 * i]);
    want += right;
    got += double(image.radiance[3 * i]);
    squares += std::pow(double(image.radiance[3 * i]) - right, 2);
  }
  return {got / want - 1, std::sqrt(squares * static_cast<double>(image.pixels())) / want};
}

// A box of 4 m x 4 m x 2 m: 1 m above the plain in its own shadow, 9 m above it, and 1 km above the
// Moon. Its underside, the side towards the Sun, that in the shade, and one beside.
TEST(TerrainLight, AsThePathTracer) {
  const pan::Contents craft = single(box({4, 4, 2}), lambert(0.5));
  for (const double height : {2.0, 10.0, 1000.0})
    for (const double elevation : {10.0, 45.0, 90.0}) {
      const bool high = height > 100;
      // of the Moon up is x
      const Quat turn = high ? glm::angleAxis(kPi / 2, Vec3(0, 1, 0)) : Quat(1, 0, 0, 0);
      const Vec3 at = high ? Vec3(1737400 + height, 0, 0) : Vec3(0, 0, height);
      const world::World world =
          scene_of(high ? moon() : plain(), craft, {at, turn}, turn * sun_at(elevation));
      printf("%g m, Sun %g:", height, elevation);
      for (const Vec3& normal : {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0)}) {
        const Errors found = errors_of(world, at + turn * (normal * Vec3(2, 2, 1)), turn * normal,
                                       normal.z != 0 ? 4 : 2);
        printf("  %+.1f %%, %.1f %% rms", 100 * found.mean, 100 * found.rms);
        const bool faint = normal.x > 0 && elevation < 20;  // a fifth of the other sides' light
        // measured: 2.0e-2, the faint side 7.0e-2; in its own shadow 7.9e-2. Pixels 5.2e-2, 7.5e-2;
        // 0.21, with the noise of the path tracer, 1e-2 to 4e-2
        EXPECT_LT(std::fabs(found.mean), height > 5 ? (faint ? 0.1 : 0.03) : 0.12);
        EXPECT_LT(found.rms, height > 5 ? (faint ? 0.12 : 0.08) : 0.3);
      }
      printf("\n");
    }
}

TEST(TerrainLight, HardCases) {
  const pan::Contents target = single(box({4, 4, 2}), lambert(0.5));
  const world::Pose low{Vec3(0, 0, 3), Quat(1, 0, 0, 0)};
  const auto camera = [](const Vec3& at) { return camera_at(at + Vec3(0, 0, 4), {0, 0, -1}, 6); };
  GroundLayer layer;
  // no terrain
  world::World none;
  DiagnosticLog log;
  ASSERT_TRUE(none.add("target", panwright::testing_support::shared(model_of(target)), low, log));
  EXPECT_EQ(layer.shine(none), nullptr);
  // night: the Sun under the plain
  const world::World night = scene_of(plain(), target, low, {0.5, 0, -0.5});
  EXPECT_TRUE((*layer.shine(night))[1].parts.empty());
  EXPECT_EQ(mean(drawn(night, camera_at(Vec3(0, 0, 2), {0, 0, 0.5}, 3))), 0);
  // below ground, and so far away that nothing arrives
  for (const Vec3& at : {Vec3(0, 0, -5), Vec3(0, 0, 1e9), Vec3(1e7, 0, 2)}) {
    const world::World world = scene_of(plain(), target, {at, Quat(1, 0, 0, 0)}, sun_at(45));
    const image::Image image = drawn(world, camera(at));
    expect_no_nan(image);
    EXPECT_LT(mean(image), 1e-4);
  }
  // terrain itself gets none, nor do hidden targets
  world::World world = scene_of(plain(), target, low, sun_at(45));
  const auto shine = layer.shine(world);
  EXPECT_EQ((*shine)[0].stamp, 0u);
  EXPECT_NE((*shine)[1].stamp, 0u);
  EXPECT_FALSE((*shine)[1].shadows.empty());
  // the same bits on any number of threads
  const auto alone = GroundLayer().shine(world, Job({1, {}}));
  const auto many = GroundLayer().shine(world, Job({3, {}}));
  EXPECT_EQ((*alone)[1].radiance, (*many)[1].radiance);
  EXPECT_EQ((*alone)[1].is_ground, (*many)[1].is_ground);
  EXPECT_EQ((*alone)[1].parts.size(), (*many)[1].parts.size());
  // kept until something changes
  EXPECT_EQ(layer.shine(world), shine);
  world.set_pose(1, {Vec3(0, 0, 4), Quat(1, 0, 0, 0)});
  EXPECT_NE(layer.shine(world), shine);
}

// Bodies of the sky behind terrain add nothing: a Moon under the plain.
TEST(TerrainLight, HidesBodies) {
  const pan::Contents target = single(plate(0.02, 0.02), lambert(0.5));
  const Quat down = glm::angleAxis(kPi, Vec3(1, 0, 0));
  world::World world = scene_of(plain(), target, {Vec3(0, 0, 10), down}, sun_at(45));
  const world::Camera camera = camera_at(Vec3(0, 0, 10), {0, 0, 1}, 0.01);
  const double alone = mean(drawn(world, camera));
  light::Body body = *light::body_preset("moon");
  body.photometry = {};
  body.albedo = Vec3(0.5);
  body.centre = Vec3(0, 0, -1737400 - 20);
  world.set_sky({body}, false);
  const double both = mean(drawn(world, camera));
  world.set_visible(0, false);
  EXPECT_EQ((*GroundLayer().shine(world))[1].parts.size(), 0u);
  const double behind = mean(drawn(world, camera));
  printf("plain %.5f, with a Moon under it %.5f, that alone %.5f\n", alone, both, behind);
  EXPECT_GT(behind, alone);
  EXPECT_NEAR(both, alone, 0.02 * behind);  // measured: 6.6e-3, beyond the plain's edge
}

}  // namespace
}  // namespace panwright::preview::terrain_light_test
