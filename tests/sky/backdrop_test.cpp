// Bodies in images against closed forms of their flux and images of many rays.
#include "sky/backdrop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensor/camera_file.h"

namespace panwright::sky::backdrop_test {
namespace {

constexpr double kRadius = 6371e3;

world::Camera camera_of(std::uint32_t side, double degrees, const Vec3& toward) {
  world::Camera camera;
  world::set_field_of_view(camera, side, side, degrees * kDegree);
  DiagnosticLog log;
  camera.world_from_camera = *world::looking_at(Vec3(0), toward, std::nullopt, log);
  return camera;
}

world::World world_of(const Vec3& centre, const Vec3& sun) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.air = false;  // closed forms are of rough ground alone
  body.albedo = Vec3(0.3);
  body.radii = Vec3(kRadius);
  body.centre = centre;
  world.set_sky({body}, false);
  world.set_sun({.direction = sun});
  return world;
}

// Irradiance of a plane that faces the camera.
double flux(const std::vector<float>& image, const world::Camera& camera) {
  double sum = 0;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column) {
      const Vec2 at = (Vec2(column + 0.5, row + 0.5) - camera.principal) / camera.focal;
      sum += image[3 * (std::size_t{row} * camera.width + column)] *
             world::pixel_solid_angle(camera, column, row) /
             std::sqrt(1 + at.x * at.x + at.y * at.y);
    }
  return sum;
}

// Of a nadir plate with the Sun behind it: exact. From 400 km to a million radii, where the disc is
// a millionth of a pixel.
TEST(Backdrop, FluxOfDiscs) {
  for (const double h : {(kRadius + 400e3) / kRadius, 6.618, 60.3, 1e4, 1e6}) {
    const double c1 =
        h > 100 ? 2 / (3 * h * h)
                : 1 / (2 * h * h * h) + (1 + h * h) / (4 * h * h) -
                      std::pow(h * h - 1, 2) / (8 * h * h * h) * std::log((h + 1) / (h - 1));
    for (const double degrees : {h < 2 ? 152.0 : 20.0, h < 2 ? 145.0 : 35.0}) {
      const world::Camera camera = camera_of(512, degrees, {0, 1, 0.01});
      const world::World world = world_of(Vec3(0, h * kRadius, 0), {0, -1, 0});
      const double got = flux(backdrop(Sky(world), camera, 0), camera);
      const double tilt = std::cos(std::atan(0.01));
      EXPECT_NEAR(got / (0.3 * c1 * tilt), 1, 1e-3) << h << ' ' << degrees;
    }
  }
}

// Mean over many rays through a pixel, each against the ellipsoid.
Vec3 pixel_by_rays(const world::World& world, const world::Camera& camera, std::uint32_t column,
                   std::uint32_t row, int side) {
  Vec3 sum(0);
  const light::Body& body = world.bodies()[0];
  const Vec3 sun = glm::normalize(world.sun().direction);
  const Mat3 axes = glm::mat3_cast(body.world_from_body);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const auto ray =
          world::distorted_ray(camera, Vec2(column + (i + 0.5) / side, row + (j + 0.5) / side));
      if (!ray) continue;
      const Vec3 o = glm::transpose(axes) * (ray->origin - body.centre) / body.radii;
      const Vec3 d = glm::transpose(axes) * ray->direction / body.radii;
      const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1;
      if (b >= 0 || b * b <= a * c) continue;
      const double t = (-b - std::sqrt(b * b - a * c)) / a;
      const Vec3 normal = axes * glm::normalize((o + t * d) / body.radii);
      sum += body.albedo * std::max(0.0, glm::dot(normal, sun)) / kPi;
    }
  return sum / double(side * side);
}

double worst_pixel(const world::World& world, const world::Camera& camera) {
  const std::vector<float> image = backdrop(Sky(world), camera, 0);
  double worst = 0;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column)
      worst = std::max(worst, std::fabs(image[3 * (std::size_t{row} * camera.width + column)] -
                                        pixel_by_rays(world, camera, column, row, 32).x) /
                                  (0.3 / kPi));
  return worst;
}

TEST(Backdrop, LimbsByManyRays) {
  // lit from the side, so that the limb is bright and the terminator in view
  world::World world = world_of(Vec3(0, 42164e3, 0), {1, -0.2, 0.1});
  EXPECT_LT(worst_pixel(world, camera_of(96, 25, {0.01, 1, 0.02})), 0.02);
  EXPECT_LT(worst_pixel(world, camera_of(48, 120, {0.01, 1, 0.02})), 0.02);
  light::Body flat = world.bodies()[0];
  flat.radii = Vec3(kRadius, 0.9 * kRadius, 0.6 * kRadius);
  flat.world_from_body = glm::normalize(Quat(0.8, 0.3, -0.2, 0.4));
  world.set_sky({flat}, false);
  EXPECT_LT(worst_pixel(world, camera_of(96, 25, {0.01, 1, 0.02})), 0.02);
  world::Camera lens = camera_of(96, 25, {0.01, 1, 0.02});
  lens.distortion =
      std::make_shared<sensor::DistortionMap>(*sensor::parse_distortion("brown -0.3 0.1 0 0"));
  EXPECT_LT(worst_pixel(world, lens), 0.02);
  world::Camera plan = camera_of(64, 25, {0.01, 1, 0.02});
  world::set_orthographic(plan, 64, 64, 3 * kRadius);
  EXPECT_LT(worst_pixel(world, plan), 0.02);
}

// A disc of one brightness: its area is that of its cone.
TEST(Backdrop, SunsDisc) {
  world::World world;
  world.set_sky({}, true);
  for (const double degrees : {1.0, 5.0, 60.0, 120.0})
    for (const double limb : {0.0, 0.6}) {
      world.set_sun({.direction = {0.003, 1, 0.002}, .limb_darkening = limb});
      const world::Camera camera = camera_of(256, degrees, {0, 1, 0});
      const double got = flux(backdrop(Sky(world), camera, 0), camera);
      EXPECT_NEAR(got, 1, 1e-3) << degrees << ' ' << limb;
    }
}

// A PSF moves light and keeps its sum, also at the image's edge, where light from outside comes in.
TEST(Backdrop, PointSpreadFunction) {
  const world::World world = world_of(Vec3(0, 42164e3, 0), {0, -1, 0});
  const world::Camera camera = camera_of(128, 30, {0, 1, 0});
  const std::vector<float> sharp = backdrop(Sky(world), camera, 0);
  const std::vector<float> blurred = backdrop(Sky(world), camera, 1.5);
  double sums[2] = {0, 0};
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    sums[0] += sharp[i];
    sums[1] += blurred[i];
  }
  EXPECT_NEAR(sums[1] / sums[0], 1, 1e-5);
  // the planet fills an image: constant but for its shading, to the last pixel
  const world::World near = world_of(Vec3(0, kRadius + 400e3, 0), {0, -1, 0});
  const world::Camera inner = camera_of(64, 5, {0, 1, 0});
  const std::vector<float> filled = backdrop(Sky(near), inner, 2);
  for (std::size_t i = 0; i < filled.size(); ++i) ASSERT_NEAR(filled[i], 0.3 / kPi, 1e-3) << i;
}

// Moon before the Earth's limb: nearer ones hide others; a camera within a body does not see it.
TEST(Backdrop, OrderAndInside) {
  world::World world = world_of(Vec3(0, 4e8, 0), {0, -1, 0});
  std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
  light::Body moon = bodies[0];
  moon.radii = Vec3(1737400);
  moon.centre = Vec3(0, 1e8, 0);
  moon.albedo = Vec3(0.03);
  bodies.push_back(moon);
  world.set_sky(bodies, true);
  const world::Camera camera = camera_of(65, 4, {0, 1, 0});
  const std::vector<float> image = backdrop(Sky(world), camera, 0);
  EXPECT_NEAR(image[3 * (32 * 65 + 32)], 0.03 / kPi, 1e-4);
  // beside the shadow that it casts
  bodies[1].centre = Vec3(0, 0, 0);
  world.set_sky(bodies, false);
  world.set_sun({.direction = {0.2, -1, 0}});
  const double cosine = 1 / std::sqrt(1.04);
  EXPECT_NEAR(backdrop(Sky(world), camera, 0)[3 * (32 * 65 + 32)], 0.3 / kPi * cosine, 1e-3);
  // on the surface, outwards and inwards
  bodies[1].centre = Vec3(0, -1737400, 0);
  world.set_sky(bodies, false);
  for (const float value : backdrop(Sky(world), camera, 0)) ASSERT_TRUE(std::isfinite(value));
  for (const float value : backdrop(Sky(world), camera_of(33, 100, {0, -1, 0}), 0))
    ASSERT_TRUE(std::isfinite(value) && value >= 0);
}

TEST(Backdrop, BehindTargets) {
  image::Image image;
  image.width = 2;
  image.height = 1;
  image.radiance = {1, 1, 1, 0.5f, 0.5f, 0.5f};
  image.coverage = {1, 0.25f};
  add_behind({8, 8, 8, 4, 4, 4}, image);
  EXPECT_EQ(image.radiance, (std::vector<float>{1, 1, 1, 3.5f, 3.5f, 3.5f}));
}

world::World with_air(const Vec3& centre, const Vec3& sun) {
  world::World world;
  light::Body body = *light::body_preset("earth");
  body.radii = Vec3(kRadius);
  body.centre = centre;
  world.set_sky({body}, false);
  world.set_sun({.direction = sun});
  return world;
}

// Pixels of limb and air against the mean of rays in them: at 400 km, in GEO, and where the air is
// a part of a pixel. Worst: 0.004 of white.
TEST(Backdrop, AirByManyRays) {
  for (const double height : {400e3, 35793e3, 200e6}) {
    const world::World world =
        with_air(Vec3(0, kRadius + height, 0), height < 1e6 ? Vec3(1, 0.2, 0.3) : Vec3(1, -0.4, 0));
    const Sky sky(world);
    const double limb = std::asin(kRadius / (kRadius + height));
    const world::Camera camera =
        camera_of(40, height < 1e6 ? 8 : 2.6 * limb / kDegree,
                  height < 1e6 ? Vec3(std::sin(limb), std::cos(limb), 0) : Vec3(0.001, 1, 0));
    const std::vector<float> image = backdrop(sky, camera, 0);
    constexpr int kSide = 24;
    double worst = 0, beside = 0;
    for (std::uint32_t row = 0; row < camera.height; ++row)
      for (std::uint32_t column = 0; column < camera.width; ++column) {
        Vec3 sum(0);
        for (int i = 0; i < kSide * kSide; ++i) {
          const auto ray = *world::distorted_ray(
              camera, Vec2(column + (i % kSide + 0.5) / kSide, row + (i / kSide + 0.5) / kSide));
          const Vec3 from = sky.shape(0).from(ray.origin), along = ray.direction;
          const double b = glm::dot(from, along), c = glm::dot(from, from) - 1;
          if (b < 0 && b * b > c) {
            const Vec3 place = glm::normalize(from + (-b - std::sqrt(b * b - c)) * along);
            sum += sky.radiance(0, place, -along, 0);
          } else {
            sum += sky.air_light(0, from, along).light;
            beside = std::max(beside, sky.air_light(0, from, along).light.z);
          }
        }
        for (int k = 0; k < 3; ++k)
          worst = std::max(
              worst,
              std::fabs(image[3 * (row * camera.width + column) + static_cast<std::size_t>(k)] -
                        sum[k] / (kSide * kSide)) /
                  (0.3 / kPi));
      }
    EXPECT_LT(worst, 0.01) << height;
    EXPECT_GT(beside, 0.05) << height;
  }
}

// All of the light of a disc with its air: in GEO, and as a small part of a pixel.
TEST(Backdrop, FluxWithAirFarAway) {
  const auto share = [&](double h, double degrees) {
    const world::World world = with_air(Vec3(0, h * kRadius, 0), {0.5, -1, 0});
    const world::Camera camera = camera_of(256, degrees, {0.001, 1, 0});
    return flux(backdrop(Sky(world), camera, 0), camera) * h * h;
  };
  const double want = share(60, 4);
  EXPECT_NEAR(share(60, 30) / want, 1, 3e-3);
  EXPECT_NEAR(share(1e3, 30) / want, 1, 0.02);  // a little more of the sphere is in view
  EXPECT_NEAR(share(1e6, 30) / share(1e3, 30), 1, 3e-3);
}

// On the ground, in the air and just above it: the sky by day, ordered and finite.
TEST(Backdrop, CameraInTheAir) {
  double before = 1;
  for (const double height : {0.0, 10.0, 10e3, 60e3, 99.9e3, 100.1e3}) {
    const world::World world = with_air(Vec3(0, -kRadius - height, 0), {0.3, 1, 0});
    for (const Vec3& toward : {Vec3(0, 1, 0.2), Vec3(1, 0.01, 0), Vec3(0.2, -1, 0)}) {
      const std::vector<float> image = backdrop(Sky(world), camera_of(24, 60, toward), 0);
      for (const float value : image) ASSERT_TRUE(std::isfinite(value) && value >= 0) << height;
      if (toward.y == 1) {
        const double sky = image[3 * (12 * 24 + 12) + 2];
        EXPECT_LE(sky, before) << height;
        before = sky;
      }
    }
  }
  EXPECT_LT(before, 1e-6);
}

// The Sun's disc sets behind the air: redder and weaker, then gone.
TEST(Backdrop, SunBehindTheLimb) {
  Vec3 last(1e9);
  for (const double height : {60e3, 25e3, 12e3, 5e3, -40e3}) {
    const double distance = kRadius + 400e3, angle = std::asin((kRadius + height) / distance);
    const Vec3 sun(std::sin(angle), std::cos(angle), 0);
    world::World world = with_air(Vec3(0, distance, 0), sun);
    const world::Camera camera = camera_of(64, 0.2, sun);
    const std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
    world.set_sky(bodies, false);
    const std::vector<float> alone = backdrop(Sky(world), camera, 0);
    world.set_sky(bodies, true);
    const std::vector<float> both = backdrop(Sky(world), camera, 0);
    const std::size_t middle = 3 * (32 * 64 + 32);
    Vec3 light;
    for (int k = 0; k < 3; ++k) light[k] = both[middle + k] - alone[middle + k];
    for (int k = 0; k < 3; ++k) EXPECT_LE(light[k], last[k]);
    if (height == 12e3) EXPECT_GT(light.x, 3 * light.z);
    if (height < 0) EXPECT_EQ(light, Vec3(0));
    last = light;
  }
}

// 1 m and 4e8 m: a target of depth 5 m, a rock before it and one behind, the Moon behind all.
TEST(Backdrop, BodiesBeforeTargets) {
  world::World world;
  const auto rock_of = [](double radius, const Vec3& centre, double albedo) {
    light::Body body;
    body.radii = Vec3(radius);
    body.centre = centre;
    body.albedo = Vec3(albedo);
    return body;
  };
  world.set_sky({rock_of(0.1, {0.2, 1, 0}, 0.2), rock_of(0.5, {-1, 9, 0}, 0.4),
                 rock_of(1.7e6, {0, 3.8e8, 0}, 0.6)},
                false);
  world.set_sun({.direction = {0, -1, 0}});
  const Sky sky(world);
  EXPECT_TRUE(may_hide(sky, Vec3(0), 1));
  EXPECT_FALSE(may_hide(sky, Vec3(0), 0.5));
  const world::Camera camera = camera_of(101, 40, {0, 1, 0});
  for (const double sigma : {0.0, 1.0}) {
    image::Image image;
    image.width = image.height = 101;
    const std::size_t count = image.pixels();
    image.radiance.assign(3 * count, 0.25f);
    image.coverage.assign(count, 1);
    image.depth.assign(count, 5);
    image.range.assign(count, 5);
    image.normal.assign(3 * count, 1);
    image.target_id.assign(count, 1);
    image.node_id.assign(count, 1);
    image.material_id.assign(count, 1);
    // free sky below
    for (std::size_t i = 60 * 101; i < count; ++i) {
      image.coverage[i] = 0;
      image.depth[i] = INFINITY;
      for (std::size_t k = 0; k < 3; ++k) image.radiance[3 * i + k] = 0;
    }
    add_around(sky, camera, sigma, image);
    const auto at = [&](const Vec3& direction) {
      const Vec2 pixel = *world::project(camera, direction);
      return static_cast<std::size_t>(pixel.y) * 101 + static_cast<std::size_t>(pixel.x);
    };
    const std::size_t rock = at({0.2, 1, 0}), far = at({-1, 9, 0}), moon = at({0, 1, 0});
    EXPECT_NEAR(image.radiance[3 * rock], 0.2 / kPi, 2e-3) << sigma;
    EXPECT_NEAR(image.coverage[rock], 0, 1e-5);
    EXPECT_EQ(image.target_id[rock], 0u);
    EXPECT_EQ(image.depth[rock], INFINITY);
    EXPECT_FLOAT_EQ(image.radiance[3 * far], 0.25f);
    EXPECT_EQ(image.target_id[far], 1u);
    EXPECT_FLOAT_EQ(image.radiance[3 * moon], 0.25f);
    EXPECT_EQ(image.radiance[3 * (count - 1)], 0);
  }
}

// Their discs meet: nothing darker or brighter than both, and all pixels of a row ordered.
TEST(Backdrop, MoonTouchesTheLimb) {
  world::World world = with_air(Vec3(0, 42164e3, 0), {0.3, -1, 0});
  std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
  light::Body moon = *light::body_preset("moon");
  const double angle = std::asin(kRadius / 42164e3) + std::asin(moon.radii.x / 4e8);
  moon.centre = 4e8 * Vec3(std::sin(angle), std::cos(angle), 0);
  const double limb = std::asin(kRadius / 42164e3);
  const world::Camera camera = camera_of(101, 2, {std::sin(limb), std::cos(limb), 0});
  const std::vector<float> earth = backdrop(Sky(world), camera, 0);
  world.set_sky({moon}, false);
  const std::vector<float> behind = backdrop(Sky(world), camera, 0);
  bodies.push_back(moon);
  world.set_sky(bodies, false);
  const std::vector<float> both = backdrop(Sky(world), camera, 0);
  double most = 0;
  for (std::size_t i = 0; i < both.size(); ++i) {
    ASSERT_LE(both[i], earth[i] + behind[i] + 1e-6) << i;
    ASSERT_GE(both[i], earth[i] - 1e-6) << i;
    most = std::max(most, static_cast<double>(behind[i]));
  }
  EXPECT_GT(most, 0.01);
}

}  // namespace
}  // namespace panwright::sky::backdrop_test
