// Lamps in the path tracer: closed forms, the Sun as a lamp, and images of OpenGL.
#include <vector>

#include "reference_models.h"

namespace panwright::preview::reference_lamps_test {
namespace {

using namespace testing_support;

world::World lit_world(const pan::Contents& contents, std::vector<light::Source> sources) {
  world::World world;
  DiagnosticLog log;
  EXPECT_TRUE(world.add("target", std::make_shared<const pan::Model>(model_of(contents)), log));
  world.set_sun({.irradiance = Vec3(0)});
  std::vector<world::Lamp> lamps;
  for (const light::Source& source : sources) {
    world::Lamp lamp;
    lamp.source = source;
    lamps.push_back(lamp);
  }
  world.set_lamps(std::move(lamps));
  return world;
}

// A bar over a plate: shadows, and light between the two.
pan::Contents bar_over_plate() {
  pan::Contents contents = single(plate(6, 6), lambert(0.8));
  contents.nodes.push_back({"bar", 0, Vec3(0.3, 0, 0.5), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(box(Vec3(0.4, 2, 0.4)), "bar"));
  contents.instances.push_back({1, 1, 0, -1});
  return contents;
}

// A Lambert plate below the middle of a sphere, and on the axis of a disc: radiance E/π.
TEST(ReferenceLamps, ClosedForms) {
  const pan::Contents contents = single(plate(1e-3, 1e-3), lambert(1));
  const View view = looking_from({0.2, 0, 1}, 10, 5e-5, 2);
  struct Case {
    light::Source source;
    double irradiance;
  };
  for (const Case& c :
       {Case{light::Point{.position = {0, 0, 2}, .intensity = Vec3(8)}, 2},
        Case{light::Point{.position = {0, 0, 2}, .intensity = Vec3(8), .radius = 1.5}, 2},
        // radiance 8/π·r²: of the disc's share of the sky
        Case{light::Disc{
                 .position = {0, 0, 2}, .axis = {0, 0, -1}, .intensity = Vec3(8), .radius = 2},
             1},
        Case{light::Disc{.position = {0, 0, 2}, .axis = {0, 0, 1}, .radius = 2}, 0},
        Case{light::Spot{.position = {0, 3, 4},
        .axis = {0, 0, -1},
        .intensity = Vec3(50),
        .half_angle = 1,
        .exponent = 2},
             50 * 0.64 / 25 * 0.8},
        Case{light::Spot{.position = {0, 3, 4}, .axis = {0, 0, -1}, .half_angle = 0.6}, 0},
        // of radiance 1
        Case{light::Point{.position = {0, 0, 6.771e6},
        .intensity = Vec3(kPi * 6.371e6 * 6.371e6),
        .radius = 6.371e6},
             kPi * 0.8853390}}) {
    const world::World world = lit_world(contents, {c.source});
    const ReferenceImage result = traced(world, view.camera, direct_light(4096));
    const double got = result.image.radiance[0] * kPi;
    // 4096 samples of each of four pixels: the disc's cosines spread by half of their mean
    EXPECT_NEAR(got, c.irradiance, 2e-2 * c.irradiance) << c.source.index();
    EXPECT_LE(std::fabs(got - c.irradiance),
              5 * kPi * result.standard_error[0] + 2e-4 * c.irradiance);
  }
}

// A lamp that is another Sun gives what the Sun gives, after bounces too.
TEST(ReferenceLamps, AnotherSun) {
  const light::Sun sun{.direction = {1, 0.3, 0.8}, .irradiance = Vec3(1)};
  const View view = looking_from({-1, 0.2, 1}, 10, 0.6, 24);
  world::World lamp = lit_world(bar_over_plate(), {sun});
  world::World own = lit_world(bar_over_plate(), {});
  own.set_sun(sun);
  for (const std::uint32_t bounces : {0u, 3u}) {
    ReferenceOptions options;
    options.samples = 128;
    options.bounces = bounces;
    const ReferenceImage a = traced(lamp, view.camera, options);
    const ReferenceImage b = traced(own, view.camera, options);
    EXPECT_NEAR(a.flux.x, b.flux.x, 4 * (a.flux_error.x + b.flux_error.x)) << bounces;
    EXPECT_LT(a.flux_error.x, 0.01 * a.flux.x);
  }
}

// OpenGL and the reference, each with its own lamps, rays and shadows.
TEST(ReferenceLamps, AsInOpenGl) {
  const View view = looking_from({-1, 0.2, 1}, 10, 0.6, 96);
  Renderer renderer(shared_device());
  const std::vector<light::Source> sources = {
      light::Point{.position = {2, 0.5, 3}, .intensity = Vec3(5)},
      light::Point{.position = {-1, 0.5, 0.6}, .intensity = Vec3(1)},
      light::Spot{.position = {2, 0.5, 3},
                  .axis = {-1, 0, -2},
                  .intensity = Vec3(5),
                  .half_angle = 0.5,
                  .exponent = 3},
      light::Disc{.position = {1, -2, 4}, .axis = {0, 1, -2}, .intensity = Vec3(5), .radius = 0.02},
      light::Sun{.direction = {1, 1, 2}, .distance = 2, .irradiance = Vec3(1)}};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const world::World world = lit_world(bar_over_plate(), {sources[k]});
    const ReferenceImage exact = traced(world, view.camera, direct_light(64));
    DiagnosticLog log;
    const auto image = renderer.render(world, view.camera, {.samples = 8}, log);
    ASSERT_TRUE(image) << to_text(log);
    const double got = intensity(*image, view.camera, 10);
    const double want = intensity(exact.image, view.camera, 10);
    double squares = 0;
    double power = 0;
    for (std::size_t i = 0; i < image->pixels(); ++i) {
      const double off = image->radiance[3 * i] - exact.image.radiance[3 * i];
      squares += off * off;
      power += exact.image.radiance[3 * i] * exact.image.radiance[3 * i];
    }
    printf("source %zu: flux %+.1e, rmse %.1e\n", k, got / want - 1, std::sqrt(squares / power));
    EXPECT_NEAR(got / want, 1, 3e-3) << k;
    EXPECT_LE(squares, 9e-4 * power) << k;  // noise of 64 samples at the edge of the cone
  }
}

// A thin box with normals that are smooth across its edges, in the light of a lamp above: its dark
// side stays dark in both, the other has the same flux.
TEST(ReferenceLamps, FacesAwayFromALamp) {
  geometry::Mesh mesh = box(Vec3(4, 2, 0.004));
  for (std::size_t i = 0; i < mesh.normals.size(); ++i)
    mesh.normals[i] = glm::normalize(mesh.positions[i] / Vec3(2, 1, 0.002));
  Renderer renderer(shared_device());
  for (const Vec3& place : {Vec3(-2.5, -0.5, 6), Vec3(-4, -1.2, 2)})
    for (const double height : {-0.02, -0.5, 0.5}) {
      const View view = looking_from({1, 0.4, height}, 6, 0.8, 64);
      const world::World world = lit_world(
          single(mesh, lambert(1)), {light::Point{.position = place, .intensity = Vec3(30)}});
      const ReferenceImage exact = traced(world, view.camera, direct_light(64));
      DiagnosticLog log;
      const auto image =
          renderer.render(world, view.camera, {.samples = 8, .shadow_side = 512}, log);
      ASSERT_TRUE(image) << to_text(log);
      const double got = intensity(*image, view.camera, 6),
                   want = intensity(exact.image, view.camera, 6);
      printf("from %.2f: flux %.4e, reference %.4e\n", height, got, want);
      if (height < 0) {
        EXPECT_EQ(got, 0) << height;
        EXPECT_EQ(want, 0) << height;
      } else {
        EXPECT_NEAR(got / want, 1, 3e-3) << height;
      }
    }
}

}  // namespace
}  // namespace panwright::preview::reference_lamps_test
