// Shadows of bodies across a target against the visible share of the Sun at each place.
#include "models.h"
#include "sky/sky.h"
#include "tests/support/view_world.h"

namespace panwright::preview::eclipse_test {
namespace {

using namespace testing_support;

constexpr std::uint32_t kSide = 64;
constexpr double kWidth = 40;  // metres

// A plate of 40 m from above, pixel by pixel; a body at a distance from it, its limb t radii of the
// Sun's disc beside the Sun.
struct Scene {
  world::World world;
  world::Camera camera;
};

Scene scene_of(const pan::Model& model, double radius, double distance, double t) {
  View view;
  view.to_sun = {0.3, 0.1, 1};
  view.limb_darkening = 0.6;
  Scene scene{panwright::testing_support::world_of(model, view), {}};
  const Vec3 sun = glm::normalize(view.to_sun);
  const Vec3 beside = glm::normalize(Vec3(1, 0.4, -0.34));
  const double limb = std::asin(radius / distance) + t * world::kSunSineAtOneAu;
  light::Body body = *light::body_preset("earth");
  body.air = false;  // closed forms are of rough ground alone
  body.albedo = Vec3(0.3);
  body.radii = Vec3(radius);
  body.centre = distance * (std::cos(limb) * sun + std::sin(limb) * beside);
  scene.world.set_sky({body}, false);
  DiagnosticLog log;
  world::set_orthographic(scene.camera, kSide, kSide, 0.9 * kWidth);
  scene.camera.position = {0, 0, 10};
  scene.camera.world_from_camera =
      *world::looking_at(scene.camera.position, Vec3(0), Vec3(0, 1, 0), log);
  return scene;
}

image::Image drawn(const Scene& scene, const RenderOptions& options) {
  DiagnosticLog log;
  auto image = Renderer(shared_device()).render(scene.world, scene.camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return *std::move(image);
}

TEST(Eclipse, EdgeAcrossATarget) {
  const pan::Model model = model_of(single(plate(kWidth, kWidth), lambert(0.5)));
  for (const auto& [radius, distance] : {std::pair(3000.0, 5000.0), std::pair(6371e3, 6771e3)})
    for (const double t : {-0.7, 0.0, 0.6, 1.5, -1.5}) {
      const Scene scene = scene_of(model, radius, distance, t);
      const sky::Sky sky(scene.world);
      for (const unsigned shadow_side : {256u, 0u}) {
        RenderOptions options;
        options.samples = 1;
        options.shadow_side = shadow_side;
        const image::Image image = drawn(scene, options);
        const double cosine = glm::normalize(scene.world.sun().direction).z;
        double most = 0;
        for (std::uint32_t row = 0; row < kSide; row += 7)
          for (std::uint32_t column = 0; column < kSide; column += 7) {
            const auto ray = world::pixel_ray(scene.camera, {column + 0.5, row + 0.5});
            const Vec3 place(ray.origin.x, ray.origin.y, 0);
            // without maps the whole target has the light of one place
            const double want = shadow_side > 0 ? sky.sun_share(place) : sky.sun_share(Vec3(0));
            const double got = image.radiance[3 * (row * kSide + column)] / (0.5 / kPi * cosine);
            most = std::max(most, std::fabs(got - want));
          }
        // 3.5e-4 measured in maps: the limb bends by 0.06 m across the plate, 3e-3 of the penumbra
        EXPECT_LT(most, 0.006) << radius << ' ' << t << ' ' << shadow_side;
      }
    }
}

// A moon's shadow half across a truss of 100 m: its edge, where half of the Sun is left, stands
// within a pixel of where the share of each place has it.
TEST(Eclipse, EdgeOnATruss) {
  constexpr double kLong = 100;
  const pan::Model model = model_of(single(plate(kLong, 6), lambert(0.5)));
  for (const double t : {-0.6, 0.0, 0.5}) {
    Scene scene = scene_of(model, 3000, 5000, t);
    world::set_orthographic(scene.camera, kSide, kSide, kLong);
    RenderOptions options;
    options.samples = 4;
    const image::Image image = drawn(scene, options);
    const sky::Sky sky(scene.world);
    const double white = 0.5 / kPi * glm::normalize(scene.world.sun().direction).z;
    // pixels from the left where the share passes a half
    double got = -1, want = -1, before[2] = {0, 0};
    for (std::uint32_t column = 2; column < kSide - 2; ++column) {
      const auto ray = world::pixel_ray(scene.camera, {column + 0.5, kSide / 2 + 0.5});
      const double now[] = {image.radiance[3 * (kSide / 2 * kSide + column)] / white,
                            sky.sun_share(Vec3(ray.origin.x, ray.origin.y, 0))};
      for (int k = 0; column > 2 && k < 2; ++k)
        if ((before[k] < 0.5) != (now[k] < 0.5))
          (k == 0 ? got : want) = column - 0.5 + (0.5 - before[k]) / (now[k] - before[k]);
      std::ranges::copy(now, before);
    }
    printf("t = %g: the edge at %.3f px, expected %.3f\n", t, got, want);
    EXPECT_GT(want, 0);
    EXPECT_NEAR(got, want, 1) << t;
  }
}

// Bodies smaller than the target, smaller than the Sun's disc, a planet as far as in GEO, the edge
// of one that bends, a flat one, and two at once: each place has its own share.
TEST(Eclipse, LimbsThatBend) {
  const pan::Model model = model_of(single(plate(kWidth, kWidth), lambert(0.5)));
  struct Case {
    Vec3 radii;
    double distance, t;
    bool second = false;
  };
  for (const Case& each :
       {Case{Vec3(5), 100, -8}, Case{Vec3(5), 2000, -0.5}, Case{Vec3(12), 4000, -0.4},
        Case{Vec3(60), 900, 0.2}, Case{Vec3(300, 200, 100), 2000, 0.1},
        Case{Vec3(6371e3), 42164e3, 0.3}, Case{Vec3(5), 1500, -0.8, true}}) {
    Scene scene = scene_of(model, each.radii.x, each.distance, each.t);
    std::vector<light::Body> bodies(scene.world.bodies().begin(), scene.world.bodies().end());
    bodies[0].radii = each.radii;
    bodies[0].world_from_body = glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3)));
    if (each.second) {
      bodies.push_back(bodies[0]);
      bodies[1].name = "other";
      bodies[1].centre += Vec3(-3, 2, 1);
    }
    scene.world.set_sky(bodies, false);
    const sky::Sky sky(scene.world);
    RenderOptions options;
    options.samples = 1;
    options.shadow_side = 256;
    const image::Image image = drawn(scene, options);
    const double cosine = glm::normalize(scene.world.sun().direction).z;
    double most = 0, least_share = 1;
    for (std::uint32_t row = 0; row < kSide; row += 3)
      for (std::uint32_t column = 0; column < kSide; column += 3) {
        const auto ray = world::pixel_ray(scene.camera, {column + 0.5, row + 0.5});
        const double want = sky.sun_share(Vec3(ray.origin.x, ray.origin.y, 0));
        const double got = image.radiance[3 * (row * kSide + column)] / (0.5 / kPi * cosine);
        most = std::max(most, std::fabs(got - want));
        least_share = std::min(least_share, want);
      }
    printf("radius %g at %g m: least share %.3f, error %.1e\n", each.radii.x, each.distance,
           least_share, most);
    EXPECT_LT(least_share, 0.9);
    // 1.6e-3 measured: by 24 chords of one body's width, or 96 of the whole disc
    EXPECT_LT(most, 2e-3) << each.radii.x << ' ' << each.distance;
  }
}

// Through the Earth's air, also with a small body before the Sun: each place and band has its own
// share.
TEST(Eclipse, LastLightThroughAir) {
  constexpr double kLong = 4000;  // metres, a third of the Sun's radius
  const pan::Model model = model_of(single(plate(kLong, kLong), lambert(0.5)));
  double least = 1, apart = 0;
  for (const auto& [t, second] :
       {std::pair(-1.0, false), std::pair(0.0, false), std::pair(2.0, false), std::pair(5.0, false),
        std::pair(0.5, true), std::pair(2.0, true)}) {
    Scene scene = scene_of(model, 6371e3, 6771e3, t);
    DiagnosticLog log;
    world::set_orthographic(scene.camera, kSide, kSide, 0.9 * kLong);
    std::vector<light::Body> bodies(scene.world.bodies().begin(), scene.world.bodies().end());
    bodies[0].air = bodies[0].sunset = true;
    if (second) {
      constexpr double kFar = 2e6;
      bodies.push_back(bodies[0]);
      bodies[1].name = "ball";
      bodies[1].air = bodies[1].sunset = false;
      bodies[1].radii = Vec3(0.5 * world::kSunSineAtOneAu * kFar);
      bodies[1].centre = kFar * glm::normalize(glm::normalize(scene.world.sun().direction) +
                                               0.4 * world::kSunSineAtOneAu * Vec3(0.5, -0.8, 0));
    }
    scene.world.set_sky(bodies, false);
    const sky::Sky sky(scene.world);
    for (const unsigned shadow_side : {256u, 0u}) {
      RenderOptions options;
      options.samples = 1;
      options.shadow_side = shadow_side;
      const image::Image image = drawn(scene, options);
      // what it adds to the eclipse without, so that the Earth's own light is out
      bodies[0].sunset = false;
      scene.world.set_sky(bodies, false);
      const image::Image hard = drawn(scene, options);
      bodies[0].sunset = true;
      scene.world.set_sky(bodies, false);
      const double cosine = glm::normalize(scene.world.sun().direction).z;
      double most = 0;
      for (std::uint32_t row = 0; row < kSide; row += 9)
        for (std::uint32_t column = 0; column < kSide; column += 9) {
          const auto ray = world::pixel_ray(scene.camera, {column + 0.5, row + 0.5});
          const Vec3 place(ray.origin.x, ray.origin.y, 0);
          const Vec3 at = shadow_side > 0 ? place : Vec3(0);
          const Vec3 share = sky.sunlight(at), want = share - sky.sun_share(at);
          for (int k = 0; k < 3; ++k) {
            const std::size_t i = 3 * (row * kSide + column) + static_cast<std::size_t>(k);
            const double got = (image.radiance[i] - hard.radiance[i]) / (0.5 / kPi * cosine);
            most = std::max(most, std::fabs(got - want[k]));
          }
          least = std::min(least, share.z);
          apart = std::max(apart, share.x - share.z);
        }
      printf("t = %g, side %u, %d bodies: %.1e\n", t, shadow_side, second ? 2 : 1, most);
      // 2.9e-3 measured: by lines between places of the table; without maps 6e-8
      EXPECT_LT(most, shadow_side > 0 ? 4e-3 : 1e-6) << t << ' ' << shadow_side;
    }
  }
  EXPECT_LT(least, 0.01);
  EXPECT_GT(apart, 0.05);
}

// Bodies that hide nothing leave every bit.
TEST(Eclipse, BesideBodiesTheSameBytes) {
  const pan::Model model = model_of(single(plate(kWidth, kWidth), lambert(0.5)));
  Scene scene = scene_of(model, 6371e3, 6771e3, 1.5);
  const image::Image with = drawn(scene, {});
  scene.world.set_sky({}, false);
  EXPECT_EQ(with.radiance, drawn(scene, {}).radiance);
}

}  // namespace
}  // namespace panwright::preview::eclipse_test
