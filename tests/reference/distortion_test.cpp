// Cameras with distortion: what a sphere covers, by closed forms and by the camera's own rays.
#include "tests/reference/lens_cases.h"

namespace panwright::preview::distortion_test {
namespace {

using namespace testing_support;

// Sum over pixels of coverage times solid angle: that of the sphere, 2π(1 - cos α). Worst of these:
// 4.5e-4, by the noise of 128 samples a pixel; facets take 2e-5.
TEST(ReferenceDistortion, SphereCoversItsSolidAngle) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(0.8)));
  for (const LensCase& each : kLensCases)
    for (const Vec3& place : {Vec3(0, 0, 4), Vec3(-1, 0.8, 3.4)}) {
      SCOPED_TRACE(each.name);
      const View view = sphere_through(each, place);
      const ReferenceImage result = traced(model, view, direct_light(128));
      double covered = 0;
      for (std::uint32_t row = 0; row < 128; ++row)
        for (std::uint32_t column = 0; column < 128; ++column)
          covered += result.image.coverage[row * 128 + column] *
                     world::pixel_solid_angle(view.camera, column, row);
      const double sine = 1 / glm::length(place);
      const double exact = 2 * kPi * (1 - std::sqrt(1 - sine * sine));
      printf("%s at %g %g %g: %+.2e\n", each.name, place.x, place.y, place.z, covered / exact - 1);
      EXPECT_NEAR(covered / exact, 1, 1e-3);
      expect_no_nan(result.image);
    }
}

// Truth layers hold what the ray through a pixel's centre meets.
TEST(ReferenceDistortion, TruthIsOfTheCentresRays) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(0.8)));
  for (const LensCase& each : kLensCases) {
    SCOPED_TRACE(each.name);
    const View view = sphere_through(each, {1.5, -1, 3});
    ReferenceOptions options = direct_light(8);
    options.ground_truth = true;
    const image::Image image = traced(model, view, options).image;
    int hits = 0;
    for (std::uint32_t row = 0; row < 128; ++row)
      for (std::uint32_t column = 0; column < 128; ++column) {
        const auto ray = world::distorted_ray(view.camera, {column + 0.5, row + 0.5});
        const double range = image.range[row * 128 + column];
        if (!ray) {
          EXPECT_TRUE(std::isinf(range));
          continue;
        }
        // of the sphere about the origin
        const double middle = -glm::dot(ray->origin, ray->direction);
        const double square = 1 - (glm::dot(ray->origin, ray->origin) - middle * middle);
        if (std::fabs(square) < 2e-3) continue;  // the outline of facets
        ASSERT_EQ(std::isfinite(range), square > 0) << column << ' ' << row;
        if (square < 0) continue;
        ++hits;
        EXPECT_NEAR(range, middle - std::sqrt(square), 3e-3);  // facets: 2.1e-3 near the outline
        const Vec3 local = glm::conjugate(view.camera.world_from_camera) * (range * ray->direction);
        EXPECT_NEAR(image.depth[row * 128 + column], local.z, 1e-5);
      }
    EXPECT_GT(hits, 300);
  }
}

// A sphere beside and behind the camera, which a pinhole cannot show.
TEST(ReferenceDistortion, FisheyeSeesBehindItself) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(0.8)));
  const LensCase fisheye{"fisheye", 24, sensor::Fisheye{}};
  const Vec3 place(4, 0, -1);
  const ReferenceImage result = traced(model, sphere_through(fisheye, place), direct_light(128));
  Vec2 centre(0);
  double sum = 0;
  for (int row = 0; row < 128; ++row)
    for (int column = 0; column < 128; ++column) {
      const double a = result.image.coverage[static_cast<std::size_t>(row * 128 + column)];
      sum += a;
      centre += a * Vec2(column + 0.5, row + 0.5);
    }
  ASSERT_GT(sum, 50);
  EXPECT_NEAR(centre.x / sum, 64 + 24 * std::atan2(4.0, -1.0), 0.2);
  EXPECT_NEAR(centre.y / sum, 64, 0.05);
}

}  // namespace
}  // namespace panwright::preview::distortion_test
