// Terrain in images against closed forms: a plateau that ends in a step, and its shadow; a globe.
#include "materials/sample.h"
#include "preview/reference/ground_layer.h"
#include "reference_models.h"
#include "tests/support/terrain_models.h"

namespace panwright::preview::terrain_test {
namespace {

using namespace testing_support;

constexpr double kTop = 5;  // metres, of the plateau; its edge at x = -6.5

// 65 x 65 posts of 1 m about the origin: the plateau up to column 25, ground at 0 from 26 on.
world::ModelPtr plateau() {
  std::vector<float> heights;
  for (int y = 0; y < 65; ++y)
    for (int x = 0; x < 65; ++x) heights.push_back(x <= 25 ? kTop : 0.0f);
  return support::plane_model(65, heights);
}

// Sun in the west, 30 degrees high, over the plateau.
const Vec3 kToSun(-std::sqrt(0.75), 0, 0.5);

world::World over(const world::ModelPtr& ground) {
  DiagnosticLog log;
  world::World world;
  EXPECT_TRUE(world.add("ground", ground, log));
  world::Sun sun = world.sun();
  sun.direction = kToSun;
  world.set_sun(sun);
  return world;
}

// 40 pixels of 1 m from above: column c covers x from c - 20 on.
world::Camera map_camera() {
  DiagnosticLog log;
  world::Camera camera;
  world::set_orthographic(camera, 40, 40, 40);
  camera.position = {0, 0, 100};
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
  return camera;
}

double lit_level() {
  materials::Material m;
  m.diffuse = Vec3(1);
  m.diffuse_brdf = materials::Hapke{
      .w = 0.384, .h = 0.052, .b0 = 1.70, .roughness = 23.657 * kDegree, .b = 0.229, .c = 0.426};
  materials::fit(m);
  const Vec3 up(0, 0, 1);
  return 0.5 * materials::Scattering(m).brdf(kToSun, up, up, Vec3(0), Vec3(1)).x;
}

float at(const image::Image& image, std::size_t column, std::size_t row) {
  return image.radiance[3 * (row * image.width + column)];
}

void expect_plateau(const image::Image& image) {
  const double lit = lit_level();
  // from the edge at x = -7, 5 m high, the shadow reaches 5/tan(30 deg) = 8.66 m: to x = 1.66
  for (std::size_t row : {0u, 13u, 39u}) {
    EXPECT_NEAR(at(image, 5, row), lit, 1e-6 * lit);
    EXPECT_NEAR(at(image, 25, row), lit, 1e-6 * lit);
    EXPECT_NEAR(at(image, 22, row), lit, 1e-6 * lit);
    EXPECT_EQ(at(image, 16, row), 0);
    EXPECT_EQ(at(image, 20, row), 0);
    // of the pixel from 1 to 2 m a share of 0.34 is lit
    EXPECT_NEAR(at(image, 21, row), 0.34 * lit, 0.2 * lit);
    const std::size_t k = row * 40;
    EXPECT_EQ(image.coverage[k + 5], 1);
    EXPECT_FLOAT_EQ(image.depth[k + 5], 95);
    EXPECT_FLOAT_EQ(image.depth[k + 25], 100);
    EXPECT_FLOAT_EQ(image.normal[3 * (k + 25) + 2], 1);
    EXPECT_EQ(image.target_id[k + 25], 1u);
    EXPECT_EQ(image.node_id[k + 25], 1u);
  }
}

TEST(ReferenceTerrain, LightAndShadowOfAPlateau) {
  ReferenceOptions options = direct_light(64);
  options.ground_truth = true;
  const ReferenceImage image = traced(over(plateau()), map_camera(), options);
  expect_plateau(image.image);
}

image::Image empty_image() {
  image::Image image;
  image.width = image.height = 40;
  image.radiance.assign(3 * 1600, 0);
  image.coverage.assign(1600, 0);
  image.depth.assign(1600, INFINITY);
  image.range.assign(1600, INFINITY);
  image.normal.assign(3 * 1600, 0);
  for (auto* ids : {&image.target_id, &image.node_id, &image.material_id}) ids->assign(1600, 0);
  return image;
}

TEST(ReferenceTerrain, LayerBeforeAndBehindTargets) {
  image::Image image = empty_image();
  // targets: before the ground, half a pixel of it, and behind it
  const auto put = [&](std::size_t column, float depth, float coverage) {
    const std::size_t pixel = 30 * 40 + column;
    image.depth[pixel] = depth;
    image.coverage[pixel] = coverage;
    image.radiance[3 * pixel] = 7 * coverage;
    image.target_id[pixel] = 2;
  };
  put(25, 50, 1);
  put(30, 50, 0.5f);
  put(35, 120, 1);
  GroundLayer layer;
  layer.add(over(plateau()), map_camera(), {.samples = 4, .sun_disc = false}, image);
  expect_plateau(image);
  const double lit = lit_level();
  EXPECT_EQ(at(image, 25, 30), 7);
  EXPECT_EQ(image.target_id[30 * 40 + 25], 2u);
  EXPECT_NEAR(at(image, 30, 30), 3.5 + 0.5 * lit, 1e-5);
  EXPECT_EQ(image.coverage[30 * 40 + 30], 1);
  EXPECT_NEAR(at(image, 35, 30), lit, 1e-6);
  EXPECT_FLOAT_EQ(image.depth[30 * 40 + 35], 100);
  EXPECT_EQ(image.target_id[30 * 40 + 35], 1u);
}

// A ball's shadow on the ground, and the plateau's on the ball.
TEST(ReferenceTerrain, ShadowsOfAndOnTargets) {
  const world::ModelPtr ball =
      panwright::testing_support::shared(model_of(single(sphere(24, 12), lambert(0.5))));
  for (const bool low : {false, true}) {
    world::World world = over(plateau());
    DiagnosticLog log;
    // high: its shadow on the ground lies 8 tan(60 deg) = 13.86 m to the east of it
    ASSERT_TRUE(
        world.add("ball", ball, {low ? Vec3(-4, 0, 1.2) : Vec3(0, 0, 8), Quat(1, 0, 0, 0)}, log));
    image::Image image = empty_image();
    GroundLayer layer;
    layer.add(world, map_camera(), {.samples = 4, .sun_disc = false}, image);
    EXPECT_EQ(at(image, 33, 19) == 0, !low);  // x = 13.5
    EXPECT_NEAR(at(image, 33, 25), lit_level(), 1e-6);
    const ReferenceImage truth = traced(world, map_camera(), direct_light(64));
    // the shadow leaves a corner of the pixel
    EXPECT_EQ(double(at(truth.image, 33, 19)) < 0.1 * lit_level(), !low);
    if (low) EXPECT_EQ(at(truth.image, 16, 19), 0);  // the ball, in shadow
    if (!low) EXPECT_GT(at(truth.image, 20, 19), 0);
  }
}

// A globe from afar: the area of its disc.
TEST(ReferenceTerrain, DiscOfAGlobe) {
  const world::World world = over(support::globe_model(std::vector<float>(720 * 360, 0)));
  constexpr double kDistance = 1e8, kRadius = 1737400;
  world::Camera camera;
  DiagnosticLog log;
  camera.width = camera.height = 40;
  camera.focal = Vec2(900);
  camera.principal = Vec2(20);
  camera.position = kDistance * Vec3(0.6, -0.8, 0);
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 0, 1), log);
  image::Image image = empty_image();
  GroundLayer().add(world, camera, {.samples = 8, .sun_disc = false}, image);
  double area = 0;
  for (const float share : image.coverage) area += double(share);
  // the cone of a sphere cuts the image plane in a disc
  const double sine = kRadius / kDistance;
  const double want = kPi * 900 * 900 * sine * sine / (1 - sine * sine);
  EXPECT_NEAR(area / want, 1, 1e-4);  // measured: 1.7e-5, of 64 rays a pixel
}

// A smooth sphere under the regolith's law, lit and seen as the globe: radiance along a ray.
struct SmoothSphere {
  static constexpr double kRadius = 1737400;
  Vec3 eye, to_sun;
  materials::Material material;

  SmoothSphere(const Vec3& from, const Vec3& sun) : eye(from), to_sun(sun) {
    material.diffuse = Vec3(1);
    material.diffuse_brdf = materials::Hapke{
        .w = 0.384, .h = 0.052, .b0 = 1.70, .roughness = 23.657 * kDegree, .b = 0.229, .c = 0.426};
    materials::fit(material);
  }

  // cosine: of the Sun; below 0 where the ray passes by.
  double radiance(const materials::Scattering& scattering, const Vec3& direction,
                  double& cosine) const {
    cosine = -1;
    const double along = -glm::dot(eye, direction);
    const double left = kRadius * kRadius - (glm::dot(eye, eye) - along * along);
    if (!(left > 0)) return 0;
    const Vec3 normal = glm::normalize(eye + (along - std::sqrt(left)) * direction);
    cosine = std::max(glm::dot(normal, to_sun), 0.0);
    if (!(cosine > 0)) return 0;
    return cosine * scattering.brdf(to_sun, -direction, normal, Vec3(0), Vec3(1)).x;
  }
};

struct GlobeErrors {
  double flux = 0;   // relative
  double worst = 0;  // of pixels that the Sun lights from 10 degrees or more over the horizon
};

GlobeErrors errors_of(const image::Image& image, const world::Camera& camera) {
  const SmoothSphere sphere(camera.position, kToSun);
  const materials::Scattering scattering(sphere.material);
  constexpr int kParts = 16;
  double sum = 0, want = 0;
  GlobeErrors out;
  for (std::uint32_t y = 0; y < camera.height; ++y)
    for (std::uint32_t x = 0; x < camera.width; ++x) {
      double mean = 0, least = 1;
      for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
          const Vec2 place(x + (i + 0.5) / kParts, y + (j + 0.5) / kParts);
          double cosine = 0;
          mean += sphere.radiance(scattering, world::pixel_ray(camera, place).direction, cosine) /
                  (kParts * kParts);
          least = std::min(least, cosine);
        }
      const double solid = world::pixel_solid_angle(camera, x, y);
      const double found = double(at(image, x, y));
      sum += found * solid;
      want += mean * solid;
      if (least > std::sin(10 * kDegree))
        out.worst = std::max(out.worst, std::fabs(found / mean - 1));
    }
  out.flux = sum / want - 1;
  return out;
}

// Flux and pixels of a lit globe are those of the smooth sphere, close by and from afar, by both
// engines; of flat triangles they are not.
TEST(ReferenceTerrain, GlobeIsLitAsASmoothSphere) {
  const world::World world = over(support::globe_model(std::vector<float>(720 * 360, 0)));
  DiagnosticLog log;
  for (const double distance : {1e8, 4e6}) {
    world::Camera camera;
    camera.width = camera.height = 40;
    camera.focal = Vec2(distance > 1e7 ? 900 : 35);
    camera.principal = Vec2(20);
    camera.position = distance * glm::normalize(Vec3(-0.5, -0.8, 0.1));
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 0, 1), log);
    const auto drawn = [&](bool flat) {
      image::Image image = empty_image();
      GroundOptions options;
      options.samples = 8;
      options.sun_disc = false;
      options.flat = flat;
      GroundLayer().add(world, camera, options, image);
      return errors_of(image, camera);
    };
    const GlobeErrors smooth = drawn(false), flat = drawn(true);
    const GlobeErrors reference = errors_of(traced(world, camera, direct_light(256)).image, camera);
    printf("globe from %.0e m: flux %+.1e, worst pixel %.1e; flat %+.1e, %.1e; reference %+.1e\n",
           distance, smooth.flux, smooth.worst, flat.flux, flat.worst, reference.flux);
    // measured: 2.1e-4 and 1.0e-4, of 64 rays a pixel; pixels 7e-5 and 3e-5, flat 1.2e-2 and 4e-3
    EXPECT_LT(std::fabs(smooth.flux), 1e-3);
    EXPECT_LT(smooth.worst, 5e-4);
    EXPECT_GT(flat.worst, 10 * smooth.worst);
    // measured: 8e-5 and 1.9e-4, of random places
    EXPECT_LT(std::fabs(reference.flux), 1e-3);
  }
}

}  // namespace
}  // namespace panwright::preview::terrain_test
