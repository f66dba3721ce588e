#include "sky/stars.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "light/light.h"

namespace panwright::sky::stars_test {
namespace {

constexpr double kLightSpeed = 299792458;

world::Camera camera_of(std::uint32_t width, std::uint32_t height, double fov_degrees) {
  world::Camera camera;
  world::set_field_of_view(camera, width, height, fov_degrees * kDegree);
  camera.position = {1e8, -2e8, 3e8};
  camera.world_from_camera = glm::normalize(Quat(0.3, -0.8, 0.2, 0.4));
  return camera;
}

image::Image image_of(const world::Camera& camera) {
  image::Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.radiance.assign(3 * image.pixels(), 0);
  image.coverage.assign(image.pixels(), 0);
  return image;
}

// Sum of radiance × solid angle, and its centre in the middle band.
struct Light {
  Vec3 flux{0};
  Vec2 centre{0};
};
Light light_of(const image::Image& image, const world::Camera& camera) {
  Light light;
  for (std::uint32_t row = 0; row < image.height; ++row)
    for (std::uint32_t column = 0; column < image.width; ++column) {
      const float* radiance = &image.radiance[3 * (std::size_t{row} * image.width + column)];
      const double angle = world::pixel_solid_angle(camera, column, row);
      light.flux += angle * Vec3(radiance[0], radiance[1], radiance[2]);
      light.centre += angle * radiance[1] * Vec2(column + 0.5, row + 0.5);
    }
  light.centre /= light.flux.y;
  return light;
}

// The angle to the velocity: tan(a'/2) = sqrt((1 − b)/(1 + b)) · tan(a/2), in the plane of both.
TEST(ApparentDirection, AberratesAsTheHalfAnglesSay) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    Star star;
    star.direction = glm::normalize(Vec3(normal(random), normal(random), normal(random)));
    const double beta = i % 2 == 0 ? 1e-4 : 0.3;
    const Vec3 axis = glm::normalize(Vec3(normal(random), normal(random), normal(random)));
    const Vec3 seen = apparent_direction(star, 0, beta * kLightSpeed * axis);
    const double before = angle_between(star.direction, axis), after = angle_between(seen, axis);
    EXPECT_NEAR(std::tan(after / 2), std::sqrt((1 - beta) / (1 + beta)) * std::tan(before / 2),
                1e-12 * (1 + std::tan(after / 2) * std::tan(after / 2)));
    EXPECT_NEAR(glm::dot(seen, glm::cross(star.direction, axis)), 0, 1e-15);
  }
}

// Magnitude 0 as Bessell 1998 has it, W/m²/nm: the zero points come from another star, and bands of
// other widths. Measured: 1.043, 1.013, 1.090.
TEST(StarIrradiance, IsNearTheZeroPointsOfTheBands) {
  const Vec3 ratio = star_irradiance(0, 0) / (100.0 * Vec3(2.177e-11, 3.631e-11, 6.32e-11));
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(ratio[band], 1, 0.1) << band;
}

TEST(StarIrradiance, OfTheSunIsTheSuns) {
  const Vec3 ratio = star_irradiance(-26.76, 0.65) / light::kSolarIrradiance;
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(ratio[band], 1, 1e-14) << band;
}

TEST(StarIrradiance, UnknownColoursAreTheSuns) {
  EXPECT_EQ(star_irradiance(3, std::nan("")), star_irradiance(3, 0.65));
  EXPECT_NEAR(star_irradiance(5, 1).y / star_irradiance(0, 1).y, 0.01, 1e-15);
}

TEST(StarsInView, AreThoseThatProjectIntoTheImage) {
  const StarCatalogue& catalogue = *hipparcos_stars();
  for (const double fov : {0.5, 20.0, 90.0, 160.0})
    for (const bool fisheye : {false, true}) {
      world::Camera camera = camera_of(300, 500, fov);
      if (fisheye)
        camera.distortion =
            std::make_shared<const sensor::DistortionMap>(sensor::Fisheye{{-0.02, 0.001, 0, 0}});
      light::Stars options;
      options.catalogue = hipparcos_stars();
      options.faintest = 7;
      options.year = 2026;
      if (fov > 50) options.velocity = {2e7, -1e7, 1.5e7};  // aberration of five degrees
      options.world_from_icrs = glm::normalize(Quat(0.1, 0.2, -0.7, 0.5));
      const auto stars = stars_in_view(options, camera, 3);
      std::size_t at = 0;
      for (std::size_t i = 0; i < catalogue.stars.size() && catalogue.stars[i].v <= 7; ++i) {
        world::Camera still = camera;
        still.position = Vec3(0);
        const Vec3 direction = options.world_from_icrs *
                               apparent_direction(catalogue.stars[i], 34.75, options.velocity);
        const auto pixel = world::project(still, direction);
        if (!pixel || pixel->x < -3 || pixel->x >= 303 || pixel->y < -3 || pixel->y >= 503)
          continue;
        ASSERT_LT(at, stars.size()) << fov;
        EXPECT_EQ(stars[at].index, i);
        EXPECT_LT(glm::length(stars[at].pixel - *pixel), 1e-8);
        ++at;
      }
      EXPECT_EQ(at, stars.size());
    }
}

TEST(StarsInView, OfAnOrthographicCameraAreNone) {
  world::Camera camera;
  world::set_orthographic(camera, 100, 100, 5);
  light::Stars stars;
  EXPECT_TRUE(stars_in_view(stars, world::Camera(), 0).empty());
  stars.catalogue = hipparcos_stars();
  EXPECT_FALSE(stars_in_view(stars, world::Camera(), 0).empty());
  EXPECT_TRUE(stars_in_view(stars, camera, 0).empty());
}

// A star at the limb: hidden where its direction is nearer to the centre than asin(R/d).
TEST(RemoveHidden, EndsAtTheLimb) {
  for (const double distance : {1.01, 6.0, 4e3, 1e7}) {
    constexpr double kRadius = 1737.4e3;
    light::Body moon = *light::body_preset("moon");
    moon.radii = Vec3(kRadius);
    const Vec3 camera(1e7, -2e6, 3e5);
    const Vec3 toward = glm::normalize(Vec3(1, 2, -3)), side = glm::normalize(Vec3(2, -1, 0));
    moon.centre = camera + distance * kRadius * toward;
    world::World world;
    world.set_sky({moon}, false);
    const double limb = std::asin(1 / distance);
    std::vector<StarInView> stars;
    for (const double angle : {0.0, limb * (1 - 1e-6), limb * (1 + 1e-6), kPi - 1e-9})
      stars.push_back({0, std::cos(angle) * toward + std::sin(angle) * side, {}, Vec3(1)});
    remove_hidden(Sky(world), camera, stars);
    ASSERT_EQ(stars.size(), 2u) << distance;
    EXPECT_GT(angle_between(stars[0].direction, toward), limb);
  }
}

// Flux within 1e-6; the centre of the pixels' sums is that of the star, but for what sampling a
// Gaussian averaged over pixels turns into an offset: exp(−2·(π·sigma)²)/π·sin(2π·x), residual
// below 1e-5 of a pixel.
TEST(AddStars, KeepsFluxAndCentre) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(20, 44);
  for (const double sigma : {0.0, 0.5, 0.8, 2.0})
    for (const bool distorted : {false, true}) {
      world::Camera camera = camera_of(64, 64, 2);
      if (distorted)
        camera.distortion =
            std::make_shared<const sensor::DistortionMap>(sensor::Brown{{-30, 200, 0.01, -0.02}});
      for (int i = 0; i < 20; ++i) {
        const Vec2 pixel(place(random), place(random));
        image::Image image = image_of(camera);
        const StarInView star{0, {}, pixel, star_irradiance(4, 1.2)};
        add_stars({&star, 1}, camera, sigma, Vec3(1), image);
        const Light light = light_of(image, camera);
        for (int band = 0; band < 3; ++band)
          EXPECT_NEAR(light.flux[band] / star.irradiance[band], 1, 1e-6) << sigma;
        for (int axis = 0; axis < 2; ++axis) {
          double expected = std::floor(pixel[axis]) + 0.5;
          if (sigma > 0)
            expected = pixel[axis] + std::exp(-2 * kPi * kPi * sigma * sigma) / kPi *
                                         std::sin(2 * kPi * pixel[axis]);
          EXPECT_NEAR(light.centre[axis], expected, 1e-5) << sigma << ' ' << pixel[axis];
        }
      }
    }
}

// Of many stars the shares of pixels are read from a table: as of each by itself, residual 6e-8 of
// the brightest pixel, in wide fields too.
TEST(AddStars, ManyAreTheSumOfEach) {
  std::mt19937_64 random(5);
  const world::Camera camera = camera_of(160, 120, 100);
  std::uniform_real_distribution<double> place(-3, 163);
  for (const double sigma : {0.3, 0.8, 2.5}) {
    std::vector<StarInView> stars;
    for (int i = 0; i < 1000; ++i)
      stars.push_back({0, {}, {place(random), 0.75 * place(random)}, Vec3(1e-9)});
    image::Image together = image_of(camera), each = image_of(camera);
    add_stars(stars, camera, sigma, Vec3(1), together);
    for (const StarInView& star : stars) add_stars({&star, 1}, camera, sigma, Vec3(1), each);
    const float brightest = *std::ranges::max_element(each.radiance);
    float worst = 0;
    for (std::size_t i = 0; i < each.radiance.size(); ++i)
      worst = std::max(worst, std::fabs(together.radiance[i] - each.radiance[i]));
    EXPECT_GT(worst, 0.0f) << sigma;  // else there was no table
    EXPECT_LT(worst, 3e-7f * brightest) << sigma;
  }
}

// The solid angles of pixels far off the axis of a wide field, residual 8e-8 (floats); by series
// where a star is small beside the field.
TEST(AddStars, KeepsFluxInWideFields) {
  for (const auto& [side, fov] :
       {std::pair(160, 20.0), {160, 60}, {160, 100}, {160, 150}, {512, 50}}) {
    const world::Camera camera = camera_of(side, side, fov);
    for (const Vec2& pixel : {Vec2(80.2, 80.7), Vec2(150.3, 8.9), Vec2(9.1, 80)}) {
      image::Image image = image_of(camera);
      const StarInView star{0, {}, pixel * (side / 160.0), Vec3(1e-9)};
      add_stars({&star, 1}, camera, 0.8, Vec3(1), image);
      EXPECT_NEAR(light_of(image, camera).flux.x, 1e-9, 1e-7 * 1e-9) << fov;
    }
  }
}

TEST(AddStars, HidesThemBehindWhatCoversTheirPixel) {
  const world::Camera camera = camera_of(9, 9, 2);
  const StarInView star{0, {}, {4.5, 4.5}, Vec3(1e-9)};
  for (const float covered : {0.0f, 0.25f, 1.0f}) {
    image::Image image = image_of(camera);
    image.coverage[4 * 9 + 4] = covered;
    add_stars({&star, 1}, camera, 0.7, Vec3(2), image);
    const double flux = light_of(image, camera).flux.x;
    EXPECT_NEAR(flux, 0.5e-9 * (1 - covered), 1e-6 * 1e-9);
  }
}

TEST(AddStars, AtTheBorderAddsWhatFallsInside) {
  const world::Camera camera = camera_of(32, 32, 1);
  for (const Vec2& pixel : {Vec2(0, 16), Vec2(32, 16), Vec2(16, 0), Vec2(16, 32)}) {
    image::Image image = image_of(camera);
    const StarInView star{0, {}, pixel, Vec3(1e-9)};
    add_stars({&star, 1}, camera, 1.5, Vec3(1), image);
    EXPECT_NEAR(light_of(image, camera).flux.x, 0.5e-9, 1e-6 * 1e-9);
  }
}

}  // namespace
}  // namespace panwright::sky::stars_test
