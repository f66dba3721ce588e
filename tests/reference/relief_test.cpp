// Light of terrain whose relief is finer than the triangles that are drawn, against the mean of all
// posts.
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "preview/reference/ground_layer.h"
#include "reference_models.h"
#include "tests/support/terrain_models.h"

namespace panwright::preview::relief_test {
namespace {

using namespace testing_support;

constexpr int kPosts = 2049;  // levels up to 3

double lattice(int x, int y, int octave) {
  const auto words = philox({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                             static_cast<std::uint32_t>(octave), 0},
                            {7, 0});
  return 2 * in_unit(words[0]) - 1;
}

// Noise of all sizes from 128 posts down to two, smooth between the points of its lattices.
std::vector<double> noise() {
  std::vector<double> out(std::size_t{kPosts} * kPosts);
  double size = 1;
  int octave = 0;
  for (int length = 128; length >= 2; length /= 2, size *= 0.56, ++octave) {
    const int side = kPosts / length + 2;
    std::vector<double> values;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) values.push_back(size * lattice(i, j, octave));
    const auto smooth = [&](int at) {
      const double t = double(at % length) / length;
      return t * t * (3 - 2 * t);
    };
    for (int y = 0; y < kPosts; ++y)
      for (int x = 0; x < kPosts; ++x) {
        const double s = smooth(x), t = smooth(y);
        const double* at = &values[static_cast<std::size_t>(y / length * side + x / length)];
        out[static_cast<std::size_t>(y * kPosts + x)] +=
            (1 - t) * ((1 - s) * at[0] + s * at[1]) + t * ((1 - s) * at[side] + s * at[side + 1]);
      }
  }
  return out;
}

// Ground of an RMS slope, posts 1 m apart.
world::ModelPtr rough(double slope) {
  const std::vector<double> heights = noise();
  double sum = 0;
  for (std::size_t y = 1; y + 1 < kPosts; ++y)
    for (std::size_t x = 1; x + 1 < kPosts; ++x) {
      const double* at = &heights[y * kPosts + x];
      const double p = 0.5 * (at[1] - at[-1]), q = 0.5 * (at[kPosts] - at[-kPosts]);
      sum += p * p + q * q;
    }
  const double scale = std::tan(slope) / std::sqrt(sum / ((kPosts - 2.0) * (kPosts - 2.0)));
  std::vector<float> out;
  for (const double height : heights) out.push_back(static_cast<float>(scale * height));
  return support::plane_model(kPosts, out);
}

struct Difference {
  double rms = 0, bias = 0;
};

enum class Lit { sun, lamp, body };

// A far light towards which a direction leads.
void light(const Vec3& to_light, Lit by, world::World& world) {
  world::Sun sun = world.sun();
  sun.direction = to_light;
  if (by == Lit::lamp) {
    sun.irradiance = Vec3(0);
    constexpr double kFar = 1e9;
    world::Lamp lamp;
    lamp.source = light::Point{.position = kFar * to_light, .intensity = Vec3(kFar * kFar)};
    world.set_lamps({lamp});
  } else if (by == Lit::body) {
    // a full disc as wide as the Sun, which lights it from below the ground: of even light
    sun.direction = -to_light;
    light::Body ball;
    ball.name = "ball";
    ball.radii = Vec3(4.65e5);
    ball.centre = 1e8 * to_light;
    ball.albedo = Vec3(0.9);
    ball.photometry.law = light::Law::lommel_seeliger;
    world.set_sky({ball}, false);
  }
  world.set_sun(sun);
}

// Pixels of `block` posts a side against the means of as many of one post each. Angles of Sun and
// camera from the vertical, in planes at right angles: radians.
Difference difference(const world::ModelPtr& ground, int block, double sun, double camera_at,
                      Lit by) {
  DiagnosticLog log;
  world::World world;
  EXPECT_TRUE(world.add("ground", ground, log));
  light(Vec3(-std::sin(sun), 0, std::cos(sun)), by, world);
  const int side = 512 / block;  // pixels: the middle of the ground
  const auto draw = [&](int width, double pixel) {
    world::Camera camera;
    constexpr double kDistance = 3e5;
    const auto count = static_cast<std::uint32_t>(width);
    world::set_pixel_angle(camera, count, count, pixel / kDistance);
    camera.position = kDistance * Vec3(0, -std::sin(camera_at), std::cos(camera_at));
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
    image::Image image;
    image.width = image.height = count;
    image.radiance.assign(3 * image.pixels(), 0);
    image.coverage.assign(image.pixels(), 0);
    image.depth.assign(image.pixels(), INFINITY);
    GroundLayer layer;
    GroundOptions options;
    options.sun_disc = false;
    options.truth = false;
    layer.add(world, camera, options, image);
    return image;
  };
  const image::Image coarse = draw(side, block), fine = draw(side * block, 1);
  double sum = 0, squares = 0, all = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      double mean = 0;
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i)
          mean += double(fine.radiance[static_cast<std::size_t>(
              3 * ((y * block + j) * side * block + x * block + i))]);
      mean /= block * block;
      const double off =
          double(coarse.radiance[static_cast<std::size_t>(3 * (y * side + x))]) - mean;
      sum += off;
      squares += off * off;
      all += mean;
    }
  const double count = side * side;
  return {std::sqrt(squares / count) / (all / count), sum / all};
}

struct View {
  int block;
  double sun, camera;  // degrees
  double most_rms, most_bias;
  Lit by = Lit::sun;
};

void expect_light(double slope, std::initializer_list<View> views) {
  const world::ModelPtr ground = rough(slope * kDegree);
  for (const View& view : views) {
    const Difference found =
        difference(ground, view.block, view.sun * kDegree, view.camera * kDegree, view.by);
    std::printf("%g degrees, %d posts, Sun %g, camera %g: rms %.4f, bias %+.4f\n", slope,
                view.block, view.sun, view.camera, found.rms, found.bias);
    EXPECT_LT(found.rms, view.most_rms);
    EXPECT_LT(std::fabs(found.bias), view.most_bias);
  }
}

// Pixels of three levels. Without the relief's slopes 16 posts are 2.2 % off, in the mean 0.6 %.
TEST(ReferenceRelief, IsLitAsAllOfItsPosts) {
  expect_light(14.4, {{8, 60, 0, 0.01, 0.002},              // measured: 0.0042, -0.0002
                      {16, 30, 0, 0.01, 0.002},             // 0.0003, -0.0001
                      {16, 60, 0, 0.01, 0.002},             // 0.0014, -0.0001
                      {32, 60, 0, 0.01, 0.002},             // 0.0008, -0.0001
                      {16, 60, 0, 0.01, 0.002, Lit::lamp},  // as of the Sun
                      {16, 60, 0, 0.01, 0.002, Lit::body},  // 0.0036, -0.0003
                      // 2 x 2 rays miss some of what a long pixel holds: 0.031, 0.0005
                      {16, 60, 45, 0.04, 0.002}});
}

// With fewer facets. Measured: 3e-4, 3e-5.
TEST(ReferenceRelief, GentleSlopes) {
  expect_light(5.9, {{16, 30, 0, 5e-4, 2e-4}, {16, 60, 0, 5e-4, 2e-4}});
}

}  // namespace
}  // namespace panwright::preview::relief_test
