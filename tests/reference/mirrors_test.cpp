// Mirrors by rays: where images in mirrors stand, their flux, and how many there are.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "reference_models.h"

namespace panwright::preview::mirrors_test {
namespace {

using namespace testing_support;

constexpr double kReflectance = 0.8;

materials::Material mirror() {
  materials::Material material;
  material.diffuse = Vec3(0);
  material.weights = Vec3(0, 1, 0);
  material.specular = Vec3(kReflectance);
  material.specular_brdf = materials::Mirror{};
  return material;
}

materials::Material glow() {
  materials::Material material;
  material.diffuse = Vec3(0);
  material.emissive = Vec3(1, 0.5, 0.25);
  material.weights = Vec3(1, 0, 1);
  return material;
}

// A square of 2 m about the origin that faces +z, on both sides.
geometry::Mesh square(double half = 1) {
  geometry::Mesh mesh;
  mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

void add(world::World& world, const geometry::Mesh& mesh, const materials::Material& material,
         const world::Pose& pose) {
  DiagnosticLog log;
  const auto model = std::make_shared<const pan::Model>(model_of(single(mesh, material)));
  EXPECT_TRUE(world.add("target" + std::to_string(world.size()), model, log)) << to_text(log);
  world.set_pose(static_cast<std::uint32_t>(world.size() - 1), pose);
}

world::World night() {
  world::World world;
  world.set_sun({.irradiance = Vec3(0)});
  return world;
}

world::Camera camera_at(const Vec3& from, const Vec3& to, double fov, std::uint32_t size) {
  DiagnosticLog log;
  world::Camera camera;
  set_field_of_view(camera, size, size, fov);
  camera.position = from;
  camera.world_from_camera = *world::looking_at(from, to, {}, log);
  return camera;
}

image::Image mirrored(const world::World& world, const world::Camera& camera,
                      const MirrorOptions& options = {}) {
  image::Image image;
  image.width = camera.width;
  image.height = camera.height;
  image.radiance.assign(3 * image.pixels(), 0);
  DiagnosticLog log;
  Reference reference;
  EXPECT_TRUE(reference.add_mirrored(world, camera, options, image, log)) << to_text(log);
  return image;
}

double flux_of(const image::Image& image, const world::Camera& camera) {
  return intensity(image, camera, 1);
}

geometry::Mesh ball(double radius) {
  geometry::Mesh mesh = sphere(120, 120);
  for (Vec3& at : mesh.positions) at *= radius;
  return mesh;
}

// A ball that glows before a tilted mirror: its image stands where the ball's mirrored place is
// seen, and sends what the ball does times the reflectance.
TEST(Mirrors, ImageOfABall) {
  constexpr double kRadius = 0.05;
  for (const double tilt : {0.0, 0.3, 1.2})
    for (const double psf : {0.0, 0.7}) {
      const Quat turned = glm::angleAxis(tilt, glm::normalize(Vec3(1, 0.4, 0)));
      const Vec3 normal = turned * Vec3(0, 0, 1);
      const Vec3 at = 0.6 * normal + turned * Vec3(0.1, 0.05, 0);
      world::World world = night();
      add(world, square(4), mirror(), {Vec3(0), turned});
      add(world, ball(kRadius), glow(), {at, Quat(1, 0, 0, 0)});
      const Vec3 image_at = at - 2 * glm::dot(normal, at) * normal;
      const Vec3 eye = turned * Vec3(2, -1, 2.5);
      const world::Camera camera = camera_at(eye, image_at, 6 * kDegree, 200);
      const image::Image image = mirrored(world, camera, {.psf_sigma = psf});
      expect_no_nan(image);
      const Vec2 place = *world::project(camera, image_at);
      const double off = glm::length(photocentre(image) - place);
      const double sine = kRadius / glm::length(image_at - eye);
      const double expected =
          kReflectance * world.white().x / kPi * 2 * kPi * (1 - std::sqrt((1 - sine) * (1 + sine)));
      const double flux = flux_of(image, camera) / expected - 1;
      printf("tilt %.1f, PSF %.1f: off by %.4f px, flux %+.2e\n", tilt, psf, off, flux);
      EXPECT_LE(off, 0.05);              // 0.0095
      EXPECT_LE(std::fabs(flux), 2e-3);  // 1.2e-3
    }
}

// Lit pixels that touch one another, as numbers of patches.
int patches(const image::Image& image) {
  std::vector<std::uint8_t> left(image.pixels());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = image.radiance[3 * i] > 0;
  int count = 0;
  for (std::size_t start = 0; start < left.size(); ++start) {
    if (left[start] == 0) continue;
    ++count;
    std::vector<std::size_t> open{start};
    left[start] = 0;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      const std::size_t x = i % image.width, y = i / image.width;
      for (std::size_t v = y > 0 ? y - 1 : 0; v <= std::min<std::size_t>(y + 1, image.height - 1);
           ++v)
        for (std::size_t u = x > 0 ? x - 1 : 0; u <= std::min<std::size_t>(x + 1, image.width - 1);
             ++u) {
          const std::size_t next = v * image.width + u;
          if (left[next] == 0) continue;
          left[next] = 0;
          open.push_back(next);
        }
    }
  }
  return count;
}

// Two mirrors at 360/k degrees show k - 1 images of what stands between them.
TEST(Mirrors, Kaleidoscope) {
  for (const int k : {2, 4, 6, 8}) {
    const double angle = 2 * kPi / k;
    geometry::Mesh half = square();
    half.positions = {{0, 0, -3}, {6, 0, -3}, {6, 0, 3}, {0, 0, 3}};
    half.normals.assign(4, Vec3(0, -1, 0));
    world::World world = night();
    add(world, half, mirror(), {});
    add(world, half, mirror(), {Vec3(0), glm::angleAxis(angle, Vec3(0, 0, 1))});
    const auto on_circle = [](double radius, double turn) {
      return radius * Vec3(std::cos(turn), std::sin(turn), 0);
    };
    add(world, ball(0.03), glow(), {on_circle(0.5, 0.4 * angle), Quat(1, 0, 0, 0)});
    const Vec3 eye = on_circle(2, 0.55 * angle) + Vec3(0, 0, 0.5);
    const image::Image image = mirrored(world, camera_at(eye, Vec3(0), 60 * kDegree, 400));
    EXPECT_EQ(patches(image), k - 1) << k;
  }
}

// A block in the Sun before a mirror, beside what the path tracer's first bounce adds.
TEST(Mirrors, LightIsThatOfPaths) {
  world::World world;
  world.set_sun({.direction = glm::normalize(Vec3(0.6, -0.5, 1))});
  add(world, square(3), mirror(), {});
  add(world, box({0.5, 0.4, 0.6}), lambert(0.6),
      {Vec3(0, 0, 0.7), glm::angleAxis(0.5, glm::normalize(Vec3(1, 1, 0.3)))});
  const world::Camera camera = camera_at({-1.5, -3, 2}, {0, 0, -0.3}, 40 * kDegree, 96);
  const image::Image image = mirrored(world, camera);
  ReferenceOptions options;
  options.samples = 1024;
  options.sun_disc =
      false;  // or paths from the block to the mirror find the Sun there, now and then
  options.bounces = 0;
  const ReferenceImage without = traced(world, camera, options);
  options.bounces = 1;
  const ReferenceImage with = traced(world, camera, options);
  const double found = flux_of(image, camera);
  const double expected = with.flux.x - without.flux.x;
  const double error = std::hypot(with.flux_error.x, without.flux_error.x);
  printf("flux %+.2e of %.3g (error %.1e)\n", found / expected - 1, expected, error / expected);
  EXPECT_NEAR(found, expected, 4 * error + 0.01 * expected);
  EXPECT_LE(error, 0.01 * expected);
}

// Mirrors that face each other, seen edge-on, of a pixel, and a camera that lies in one.
TEST(Mirrors, HardCasesAreFinite) {
  world::World world;
  world.set_sun({.direction = glm::normalize(Vec3(0.2, 0.1, 1))});
  add(world, square(1), mirror(), {});
  add(world, square(1), mirror(), {Vec3(0, 0, 0.5), glm::angleAxis(kPi, Vec3(1, 0, 0))});
  add(world, box(Vec3(0.1)), lambert(1), {Vec3(0.2, 0.1, 0.25), Quat(1, 0, 0, 0)});
  add(world, square(1e-4), mirror(), {Vec3(0, 0.8, 0.25), Quat(1, 0, 0, 0)});
  for (const Vec3& eye :
       {Vec3(3, 0, 0.25), Vec3(3, 0, 0), Vec3(0.3, 0.2, 0), Vec3(0.9, 0, 0.2), Vec3(0, 0, 1e6)}) {
    const world::Camera camera = camera_at(eye, {0, 0, 0.25}, 50 * kDegree, 64);
    expect_no_nan(mirrored(world, camera));
  }
}

}  // namespace
}  // namespace panwright::preview::mirrors_test
