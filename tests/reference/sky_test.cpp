// Light of bodies, eclipses and backgrounds against closed forms, a quadrature and the other way.
#include "materials/sample.h"
#include "reference_models.h"
#include "sky/backdrop.h"
#include "tests/support/earthshine.h"

namespace panwright::preview::sky_test {
namespace {

using namespace testing_support;
using panwright::testing_support::Earthshine;
using panwright::testing_support::gold;

constexpr double kRadius = 6371e3;

pan::Contents plate(double half, double height, const materials::Material& material) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.materials.push_back(material);
  geometry::Mesh mesh;
  mesh.positions = {
      {-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  contents.instances.push_back({0, 0, 0, -1});
  contents.meshes.push_back(pan::packed(mesh, "plate"));
  return contents;
}

// A plate at the origin that faces the Earth above it, seen from there; the Sun is behind the
// plate, at a zenith angle of the place below it.
world::World over_earth(const pan::Model& model, double height, double zenith, double tilt = 0) {
  View view;
  const double z = zenith * kDegree;
  view.to_sun = {std::sin(z), 0, -std::cos(z)};
  const double half = 0.5 * tilt * kDegree;
  view.world_from_model.rotation = Quat(std::cos(half), 0, std::sin(half), 0);
  world::World world = panwright::testing_support::world_of(model, view);
  light::Body earth = *light::body_preset("earth");
  earth.air = false;  // closed forms are of rough ground alone
  earth.albedo = Vec3(0.3);
  earth.radii = Vec3(kRadius);
  earth.centre = {0, 0, kRadius + height};
  world.set_sky({earth}, false);
  return world;
}

// From above, near enough to see nothing but the plate.
world::Camera above(double tilt = 0) {
  DiagnosticLog log;
  world::Camera camera;
  world::set_orthographic(camera, 4, 4, 0.1);
  const double turn = tilt * kDegree;
  camera.position = 5.0 * Vec3(std::sin(turn), 0, std::cos(turn));
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
  return camera;
}

struct Mean {
  double value, error;
};

Mean mean_of(const ReferenceImage& image) {
  const double area = 0.01;
  return {image.flux.x / area, image.flux_error.x / area};
}

ReferenceOptions direct(std::uint32_t samples) {
  ReferenceOptions options;
  options.samples = samples;
  options.bounces = 0;
  return options;
}

TEST(ReferenceSky, PlanetshineOfNadirPlates) {
  const pan::Model model = model_of(plate(10, 0, lambert(0.6)));
  struct Case {
    double height, zenith, want;
  };
  for (const Case& each :
       {Case{400e3, 0, 0.8817541}, Case{400e3, 60, 0.440882}, Case{400e3, 90, 0.020341},
        Case{35793e3, 60, 0.0095856}, Case{35793e3, 90, 0.0043818}}) {
    // the Sun is a point: at the horizon half of its disc would light the plate
    ReferenceOptions options = direct(4096);
    options.sun_disc = false;
    const Mean mean =
        mean_of(traced(over_earth(model, each.height, each.zenith), above(), options));
    const double want = 0.6 / kPi * 0.3 * each.want;
    EXPECT_NEAR(mean.value, want, 4 * mean.error + 2e-4 * want) << each.height << each.zenith;
    EXPECT_LT(mean.error, 0.02 * want);
  }
}

// A rough metal under the Earth: the integral of its BRDF over directions to the planet.
TEST(ReferenceSky, GoldReflectsTheEarth) {
  for (const double roughness : {0.1, 0.4}) {
    materials::Material gold;
    gold.weights = Vec3(0, 1, 0);
    gold.specular = Vec3(1);
    gold.refract = Vec3(0.2);
    gold.extinction = Vec3(3);
    gold.specular_brdf = materials::CookTorrance{.alpha = roughness};
    materials::fit(gold);
    const pan::Model model = model_of(plate(10, 0, gold));
    for (const double tilt : {0.0, 50.0}) {
      const world::World world = over_earth(model, 400e3, 40, tilt);
      const Mean mean = mean_of(traced(world, above(tilt), direct(4096)));
      const materials::Scattering scattering(gold);
      const double turn = tilt * kDegree;
      const Vec3 normal(std::sin(turn), 0, std::cos(turn)), eye(0, 0, -kRadius - 400e3);
      const Vec3 sun = glm::normalize(world.sun().direction);
      const double cosine = std::sqrt(1 - std::pow(kRadius / (kRadius + 400e3), 2));
      double want = 0;
      constexpr int kRings = 300, kSectors = 600;
      for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
          const double along = 1 - (1 - cosine) * (i + 0.5) / kRings;
          const double angle = 2 * kPi * (j + 0.5) / kSectors;
          const double across = std::sqrt(1 - along * along);
          const Vec3 to_light(across * std::cos(angle), across * std::sin(angle), along);
          const double facing = glm::dot(normal, to_light);
          if (facing <= 0) continue;
          const double b = glm::dot(eye, to_light);
          const double way = -b - std::sqrt(b * b - glm::dot(eye, eye) + kRadius * kRadius);
          const Vec3 up = (eye + way * to_light) / kRadius;
          const double light = 0.3 / kPi * std::max(0.0, glm::dot(up, sun));
          want += scattering.brdf(to_light, normal, normal, Vec3(0), Vec3(1)).x * facing * light *
                  (1 - cosine) / kRings * 2 * kPi / kSectors;
        }
      EXPECT_NEAR(mean.value, want, 4 * mean.error + 5e-3 * want) << roughness << ' ' << tilt;
      EXPECT_LT(mean.error, 0.01 * want);
    }
  }
}

TEST(ReferenceSky, GoldSphereReflectsTheEarth) {
  for (const double slope : {0.15, 0.4}) {
    const materials::Material material = gold(slope);
    world::World world = over_earth(model_of(single(sphere(300, 400), material)), 400e3, 30);
    const Vec3 to_viewer = glm::normalize(Vec3(0.9, -0.3, 0.3));
    DiagnosticLog log;
    world::Camera camera;
    world::set_orthographic(camera, 32, 32, 2.05);
    camera.position = 5.0 * to_viewer;
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log);
    const ReferenceImage both = traced(world, camera, direct(256));
    world.set_sky({}, false);
    const ReferenceImage sun = traced(world, camera, direct(256));
    const Earthshine earth{.to_sun = glm::normalize(world.sun().direction)};
    const double want = earth.intensity(material, to_viewer);
    const double error = glm::length(Vec2(both.flux_error.x, sun.flux_error.x));
    std::printf("%g: %.5f of %.5f, %.5f\n", slope, both.flux.x - sun.flux.x, want, error);
    // measured: 0.1 %
    EXPECT_NEAR(both.flux.x - sun.flux.x, want, 0.01 * want) << slope;
    EXPECT_LT(error, 0.004 * want);
  }
}

// A ceiling between plate and planet: what is left comes in beside it.
TEST(ReferenceSky, TargetsShadowPlanets) {
  pan::Contents both = plate(1, 0, lambert(0.6));
  const pan::Contents ceiling = plate(1000, 20, lambert(0.6));
  both.meshes.push_back(ceiling.meshes[0]);
  both.instances.push_back({0, 1, 0, -1});
  const pan::Model model = model_of(both);
  const Mean mean = mean_of(traced(over_earth(model, 400e3, 0), above(), direct(1024)));
  EXPECT_LT(mean.value, 1e-3 * 0.6 * 0.3 / kPi);
}

// The Sun beside the Earth's limb.
TEST(ReferenceSky, Eclipse) {
  const pan::Model model = model_of(plate(10, 0, lambert(0.6)));
  for (const double t : {-1.2, -0.5, 0.0, 0.4, 1.2}) {
    const double distance = kRadius + 400e3;
    const double angle = std::asin(kRadius / distance) + t * world::kSunSineAtOneAu;
    world::World world = over_earth(model, 400e3, 0);
    world.set_sun({.direction = {std::sin(angle), 0, std::cos(angle)}, .limb_darkening = 0.6});
    const sky::Sky sky(world);
    const double share = sky.sun_share(Vec3(0));
    // the night side lights nothing but the last of the dusk
    const double dusk = 0.001;
    const Mean mean = mean_of(traced(world, above(), direct(4096)));
    const double want = 0.6 / kPi * std::cos(angle) * share;
    EXPECT_NEAR(mean.value, want, 4 * mean.error + dusk * 0.6 / kPi) << t;
  }
}

// The Sun through the Earth's air, by directions of its disc one by one: beside the Earth's own
// light, which is the same without.
TEST(ReferenceSky, LastLightThroughAir) {
  const pan::Model model = model_of(plate(10, 0, lambert(0.6)));
  const double distance = kRadius + 400e3;
  for (const auto& [t, second] :
       {std::pair(-1.5, false), std::pair(0.0, false), std::pair(1.0, false), std::pair(3.0, false),
        std::pair(6.0, false), std::pair(1.0, true)}) {
    const double angle = std::asin(kRadius / distance) + t * world::kSunSineAtOneAu;
    world::World world = over_earth(model, 400e3, 0);
    const Vec3 to_sun(std::sin(angle), 0, std::cos(angle));
    world.set_sun({.direction = to_sun, .limb_darkening = 0.6});
    std::vector<light::Body> bodies(world.bodies().begin(), world.bodies().end());
    bodies[0].air = true;
    if (second) {  // beside the Sun's middle, on the side of the limb
      const double width = world::kSunSineAtOneAu * 1e5;
      light::Body ball;
      ball.name = "ball";
      ball.radii = Vec3(0.5 * width);
      ball.centre = 1e5 * to_sun + 0.5 * width * Vec3(-std::cos(angle), 0, std::sin(angle));
      bodies.push_back(ball);
    }
    world.set_sky(bodies, false);
    const ReferenceImage hard = traced(world, above(), direct(4096));
    const double geometric = sky::Sky(world).sun_share(Vec3(0));
    bodies[0].sunset = true;
    world.set_sky(bodies, false);
    const ReferenceImage soft = traced(world, above(), direct(4096));
    const Vec3 share = sky::Sky(world).sunlight(Vec3(0));
    const double pixels = static_cast<double>(soft.image.pixels());
    for (std::size_t k = 0; k < 3; ++k) {
      double got = 0, error = 0;
      for (std::size_t i = k; i < soft.image.radiance.size(); i += 3) {
        got += (soft.image.radiance[i] - hard.image.radiance[i]) / pixels;
        error += std::pow(soft.standard_error[i] / pixels, 2) +
                 std::pow(hard.standard_error[i] / pixels, 2);
      }
      const double white = 0.6 / kPi * std::cos(angle);
      const double want = share[static_cast<int>(k)] - geometric;
      printf("t = %g, band %zu: %.5f of %.5f\n", t, k, got / white, want);
      EXPECT_NEAR(got / white, want, 4 * std::sqrt(error) / white + 2e-3) << t << ' ' << k;
    }
  }
}

// Its own rays and those of sky/.
TEST(ReferenceSky, BackgroundAsByAreas) {
  const pan::Model model = model_of(plate(1, 0, lambert(0.6)));
  world::World world = over_earth(model, 35793e3, 0);
  world.set_sun({.direction = {0.6, 0.3, -1}});
  DiagnosticLog log;
  world::Camera camera;
  world::set_field_of_view(camera, 96, 96, 30 * kDegree);
  camera.position = {0, 0, 50};
  camera.world_from_camera =
      *world::looking_at(camera.position, camera.position + Vec3(0.01, 0, 1), {}, log);
  for (const double sigma : {0.0, 1.2}) {
    ReferenceOptions options = direct(256);
    options.psf_sigma = sigma;
    const ReferenceImage got = traced(world, camera, options);
    const std::vector<float> want = sky::backdrop(sky::Sky(world), camera, sigma);
    double sums[2] = {0, 0};
    for (std::size_t i = 0; i < want.size(); ++i) {
      sums[0] += got.image.radiance[i];
      sums[1] += want[i];
      EXPECT_NEAR(got.image.radiance[i], want[i], 5 * got.standard_error[i] + 0.02 * 0.3 / kPi);
    }
    EXPECT_NEAR(sums[0] / sums[1], 1, 2e-3);
  }
}

// A body before a target hides it.
TEST(ReferenceSky, BodyBeforeATarget) {
  const pan::Model model = model_of(plate(10, 0, lambert(0.6)));
  world::World world = over_earth(model, 400e3, 0);
  light::Body rock = world.bodies()[0];
  rock.radii = Vec3(0.5);
  rock.centre = Vec3(0, 0, 2);
  rock.albedo = Vec3(0.9);
  world.set_sky({rock}, false);
  world.set_sun({.direction = {0, 0, 1}});
  const ReferenceImage image = traced(world, above(), direct(64));
  for (const float value : image.image.radiance) EXPECT_NEAR(value, 0.9 / kPi, 0.01);
  for (const float value : image.image.coverage) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace panwright::preview::sky_test
