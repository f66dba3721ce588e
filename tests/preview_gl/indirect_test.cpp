// Light between surfaces on the display: what shaders read of surfels is what light/surfels.h
// reads, whatever the pose, and nothing passes a plate.
#include <vector>

#include "light/surfels.h"
#include "models.h"
#include "transport/transport.h"
#include "world/camera.h"

namespace panwright::preview::indirect_test {
namespace {

using namespace testing_support;

constexpr double kAlbedo = 0.5;

world::World night(const geometry::Mesh& mesh, const world::Pose& pose) {
  world::World world;
  DiagnosticLog log;
  auto model = std::make_shared<const pan::Model>(model_of(single(mesh, lambert(kAlbedo))));
  EXPECT_TRUE(world.add("target", model, log)) << to_text(log);
  world.set_pose(0, pose);
  world.set_sun({.irradiance = Vec3(0)});
  return world;
}

// Surfels on both sides of a plate 4 m wide; those of the back have no light.
std::shared_ptr<const std::vector<light::SurfelLight>> patterned() {
  std::vector<light::Surfel> surfels;
  light::SurfelLight light;
  for (int side = 0; side < 2; ++side)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        const Vec3 at(0.2 * x - 1.9, 0.2 * y - 1.9, side == 0 ? 0.01 : -0.01);
        surfels.push_back({at, {0, 0, side == 0 ? 1 : -1}, 0.3});
        // two walls cross the front
        for (const Vec4& wall : {Vec4(1, 0, 0, -0.4), Vec4(0.6, 0.8, 0, 0.5)}) {
          light::Surfel& surfel = surfels.back();
          if (y < 8) continue;
          const bool beyond = glm::dot(wall, Vec4(at, 1)) < 0;
          surfel.limits[surfel.limit_count++] = beyond ? -wall : wall;
        }
        const auto e = side == 0 ? static_cast<float>(1 + 0.1 * x + 0.03 * y * y) : 0.0f;
        light.irradiance.push_back({e, 2 * e, 3 * e, static_cast<float>(1 / 0.3)});
      }
  light.grid = std::make_shared<const light::SurfelGrid>(light::surfel_grid(surfels, 0.2));
  light.stamp = next_stamp();
  return std::make_shared<const std::vector<light::SurfelLight>>(1, std::move(light));
}

image::Image drawn(const world::World& world, const world::Camera& camera,
                   const RenderOptions& options) {
  static Renderer renderer(shared_device());
  DiagnosticLog log;
  auto image = renderer.render(world, camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return image ? std::move(*image) : image::Image{};
}

TEST(Indirect, ShadersReadWhatTheLibraryReads) {
  const auto light = patterned();
  const world::Pose pose{{1e5, -2e5, 3e5}, glm::normalize(Quat(0.9, 0.1, -0.3, 0.2))};
  const world::World world = night(support::box({4, 4, 0.02}), pose);
  for (const double side : {1.0, -1.0}) {
    View view = looking_from({0.4, -0.3, 3 * side}, 5, 0.8, 48);
    view.camera.position = pose.translation + pose.rotation * view.camera.position;
    view.camera.world_from_camera = pose.rotation * view.camera.world_from_camera;
    // with two or more samples a side, each four next to one another have the light of their first
    for (const auto& [shadow_side, samples] : {std::pair{0u, 1u}, {512u, 1u}, {0u, 2u}, {0u, 4u}}) {
      RenderOptions options;
      options.shadow_side = shadow_side;
      options.samples = samples;
      options.ground_truth = true;
      options.indirect = light;
      const image::Image image = drawn(world, view.camera, options);
      double worst = 0;
      std::size_t seen = 0;
      for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
          const Quat back = glm::conjugate(pose.rotation);
          const unsigned quads = std::max(samples / 2, 1u);
          Vec3 expected(0);
          bool within = true;
          for (unsigned q = 0; q < quads * quads; ++q) {
            const double step = quads > 1 || samples > 1 ? 2.0 / samples : 1.0;
            const Vec2 place = Vec2(q % quads, q / quads) * step + 0.5 / samples;
            const geometry::Ray ray = world::pixel_ray(view.camera, Vec2(x, y) + place);
            const Vec3 origin = back * (ray.origin - pose.translation);
            const Vec3 direction = back * ray.direction;
            const Vec3 at = origin + direction * ((0.01 * side - origin.z) / direction.z);
            within = within && std::fabs(at.x) < 1.95 && std::fabs(at.y) < 1.95;
            expected += light::irradiance_at((*light)[0], at, {0, 0, side}) *
                        (kAlbedo / kPi / (quads * quads));
          }
          // a sample on the face's diagonal may miss both of its triangles
          const std::size_t pixel = std::size_t{y} * image.width + x;
          if (!within || image.coverage[pixel] < 1) continue;
          for (int k = 0; k < 3; ++k)
            worst = std::max(
                worst,
                std::fabs(image.radiance[3 * pixel + static_cast<std::size_t>(k)] - expected[k]));
          if (expected.x > 0) ++seen;
        }
      EXPECT_LT(worst, 2e-4);  // of 0.1 to 7
      EXPECT_EQ(seen > 500, side > 0);
    }
  }
}

// A glossy plate shows light by where it comes from: over all azimuths as much as if it came from
// all of them, and by its band.
TEST(Indirect, LobesShowTheSidesOfLight) {
  DiagnosticLog log;
  materials::Material gold;
  gold.weights = {0, 1, 0};
  gold.specular = Vec3(1);
  gold.specular_brdf = materials::Ggx{0.1, 0.1};
  gold.refract = Vec3(1.4);
  gold.extinction = Vec3(7.5);
  materials::fit(gold);
  world::World world;
  auto model =
      std::make_shared<const pan::Model>(model_of(single(support::box({4, 4, 0.02}), gold)));
  ASSERT_TRUE(world.add("target", model, log)) << to_text(log);
  world.set_sun({.irradiance = Vec3(0)});
  const auto shown = [&](const light::SurfelSides& sides, double height, double azimuth) {
    auto light = *patterned();
    for (auto& one : light[0].irradiance) one = {1, 1, 1, one[3]};
    light[0].sides.assign(light[0].irradiance.size(), sides);
    light[0].stamp = next_stamp();
    const Vec3 from(std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth),
                    std::sin(height));
    View view = looking_from(3.0 * from, 5, 0.2, 16);
    RenderOptions options;
    options.indirect = std::make_shared<const std::vector<light::SurfelLight>>(std::move(light));
    const image::Image image = drawn(world, view.camera, options);
    return static_cast<double>(image.radiance[3 * (8 * 16 + 8)]);
  };
  for (const double degrees : {10.0, 24.0, 50.0, 80.0}) {
    const double height = degrees * kDegree;
    const double even = shown({}, height, 0.1);
    // from all azimuths, and from about one
    double sum = 0, most = 0;
    for (int k = 0; k < 12; ++k) {
      const double one = shown({.across = {0.8f, 0, 0}}, height, 2 * kPi * k / 12);
      sum += one / 12;
      most = std::max(most, one);
      if (k == 6) {
        EXPECT_EQ(one, most);  // a mirror shows the other side
      }
    }
    EXPECT_NEAR(sum, even, 0.01 * even) << degrees;
    EXPECT_GT(most, (degrees < 70 ? 2.5 : 1.2) * even) << degrees;
    // from the lowest band alone: 16 times as bright there, and 0.3 of all light counts as even
    const double low = shown({.low = 1, .middle = 0, .high = 0}, height, 0.1);
    if (degrees < 11) EXPECT_NEAR(low, (0.3 + 0.7 * 16) * even, 0.05 * low);
    if (degrees > 60) EXPECT_NEAR(low, 0.3 * even, 0.01 * even);
  }
}

// Without light between surfaces, images are those of before, and become so again.
TEST(Indirect, OffIsAsBefore) {
  const world::World world = night(support::box({4, 4, 0.02}), {});
  const View view = looking_from({0.4, -0.3, 3}, 5, 0.8, 32);
  RenderOptions options;
  const image::Image before = drawn(world, view.camera, options);
  options.indirect = patterned();
  EXPECT_NE(drawn(world, view.camera, options).radiance, before.radiance);
  options.indirect.reset();
  EXPECT_EQ(drawn(world, view.camera, options).radiance, before.radiance);
}

// An imposter has the light of the image.
TEST(Indirect, ImpostersHaveIt) {
  const world::World world = night(support::box({4, 4, 0.02}), {});
  const View view = looking_from({0.4, -0.3, 40}, 5, 0.3, 48);
  RenderOptions options;
  options.indirect = patterned();
  options.samples = 16;
  options.imposters = Imposters::off;
  const auto flux = [&] {
    double sum = 0;
    for (const float value : drawn(world, view.camera, options).radiance) sum += value;
    return sum;
  };
  const double direct = flux();
  options.imposters = Imposters::always;
  EXPECT_GT(direct, 0);
  EXPECT_NEAR(flux(), direct, 2e-3 * direct);
}

}  // namespace
}  // namespace panwright::preview::indirect_test
