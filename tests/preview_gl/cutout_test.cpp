// Holes: how much of a surface is there, and what is seen through them.
#include "textured.h"

namespace panwright::preview::cutout_test {
namespace {

using namespace testing_support;

// The share of a repeated texture where bilinear alpha reaches the threshold: many lines along x,
// each exactly.
double share_there(const std::vector<double>& alpha, int side, double threshold) {
  constexpr int kLines = 251;  // a texel
  const auto at = [&](int x, int y) {
    return alpha[static_cast<std::size_t>(((y + side) % side) * side + (x + side) % side)];
  };
  double sum = 0;
  for (int line = 0; line < side * kLines; ++line) {
    const double y = (line + 0.5) / kLines - 0.5;
    const int low = static_cast<int>(std::floor(y));
    const double v = y - low;
    for (int x = 0; x < side; ++x) {
      const double left = at(x, low) * (1 - v) + at(x, low + 1) * v - threshold;
      const double right = at(x + 1, low) * (1 - v) + at(x + 1, low + 1) * v - threshold;
      if (left >= 0 && right >= 0) sum += 1;
      if ((left >= 0) != (right >= 0)) sum += std::max(left, right) / std::fabs(left - right);
    }
  }
  return sum / (double(side) * side * kLines);
}

// A mesh (a net of wires) as alpha codes; hole: 0.
Texel net(std::uint32_t x, std::uint32_t y) {
  const bool wire = x % 8 < 2 || y % 8 < 3;
  return grey(200, wire ? 255 : 0);
}
Texel soft(std::uint32_t x, std::uint32_t y) {
  return grey(200, static_cast<int>(127.5 + 120 * std::sin(x * 0.31) * std::cos(y * 0.53)));
}

struct Case {
  Texel (*texel)(std::uint32_t, std::uint32_t);
  double threshold;
};

// Turned in the image, so that texels and pixels never march in step; held against the same plate
// without holes.
TEST(Cutout, ShareIsRightAtAnyRange) {
  for (const Case& c : {Case{net, 0.5}, Case{net, 0.9}, Case{soft, 0.3}, Case{soft, 0.75}}) {
    pan::Contents whole = single(plate(1, 1), lambert(0.9));
    whole.nodes[0].rotation = glm::angleAxis(0.4, Vec3(0, 0, 1));
    Textured contents(whole);
    std::vector<double> alpha(64 * 64);
    contents.materials[0].maps.cutout = contents.add(64, 64, false, [&](auto x, auto y) {
      alpha[y * 64 + x] = c.texel(x, y)[3] / 255.0;
      return c.texel(x, y);
    });
    contents.materials[0].maps.threshold = c.threshold;
    const double share = share_there(alpha, 64, c.threshold);
    const pan::Model full = model_of(whole);
    const pan::Model model = model_of(contents);
    for (const std::uint32_t size : {1000u, 200u, 130u, 64u, 30u, 12u, 4u})
      for (const unsigned samples : {1u, 4u, 8u}) {
        if (size * samples > 1600) continue;
        RenderOptions options;
        options.samples = samples;
        options.ground_truth = true;
        const View view = above(size, 2);
        const image::Image image = rendered(model, view, options);
        expect_no_nan(image);
        const Sums sum = sums(image);
        const double all = sums(rendered(full, view, options)).coverage;
        const double off = sum.coverage / all / share - 1;
        const double drawn = all * samples * samples;
        printf("threshold %g, share %.4f, %.3g px a texel, %u samples: %+.1e, %.0f samples\n",
               c.threshold, share, size / 128.0, samples, off, drawn);
        // 0.5/√n is what independent samples leave; measured up to 0.52/√n, and 5e-5 for many
        EXPECT_LE(std::fabs(off) * share, 0.6 / std::sqrt(drawn) + 2e-4);
        EXPECT_NEAR(sum.radiance.x, sum.coverage * 0.9 / kPi, 1e-6 * sum.coverage + 1e-12);
        for (std::size_t i = 0; i < image.pixels(); ++i) {
          ASSERT_TRUE(samples != 1 || (image.node_id[i] != 0) == (image.coverage[i] > 0));
          ASSERT_EQ(image.node_id[i] != 0, std::isfinite(image.depth[i]));
        }
      }
  }
}

// Three nets behind each other, far away: what passes is the product, whatever faces the camera.
TEST(Cutout, LayersAreIndependent) {
  Textured contents(single(plate(1, 1), lambert(0.9)));
  contents.materials[0].maps.cutout = contents.add(64, 64, false, net);
  contents.materials[0].maps.repeat = Vec2(40);
  for (int layer = 1; layer < 3; ++layer) {
    const Quat turn = glm::angleAxis(layer == 1 ? kPi : 0.0, Vec3(1, 0, 0));
    contents.nodes.push_back({"layer", 0, Vec3(0, 0, -0.1 * layer), turn, Vec3(1)});
    contents.instances.push_back({static_cast<std::uint32_t>(layer), 0, 0, -1});
  }
  const Sums sum = sums(rendered(model_of(contents), above(400, 1)));
  std::vector<double> alpha;
  for (std::uint32_t i = 0; i < 64 * 64; ++i) alpha.push_back(net(i % 64, i / 64)[3] / 255.0);
  const double hole = 1 - share_there(alpha, 64, 0.5);
  // measured 5e-4; 160,000 independent samples leave 1e-3
  EXPECT_NEAR(sum.coverage / 160000, 1 - hole * hole * hole, 3e-3);
}

// A closed box of net around a ball: through the holes one sees the ball or the box's far inside.
TEST(Cutout, WhatIsBehindAHole) {
  geometry::Mesh cage = box({2, 2, 2});
  for (const Vec3& p : cage.positions) cage.texcoords.push_back(Vec2(p.x + 0.5 * p.z, p.y) * 0.5);
  Textured contents(single(cage, lambert(0.5)));
  // half of each face is a hole, and the other half of the face across
  contents.materials[0].maps.cutout =
      contents.add(2, 1, false, [](auto x, auto) { return grey(255, x == 0 ? 255 : 0); });
  contents.materials.push_back(lambert(0.8));
  contents.meshes.push_back(pan::packed(sphere(40, 40), "ball"));
  contents.nodes.push_back({"ball", 0, Vec3(0.5, 0, 0), Quat(1, 0, 0, 0), Vec3(0.5)});
  contents.instances.push_back({1, 1, 1, -1});
  const pan::Model model = model_of(contents);
  RenderOptions options;
  options.ground_truth = true;
  options.shadow_side = 0;
  const Vec3 sun = glm::normalize(Vec3(0.1, 0.2, 1));
  const image::Image image = rendered(model, above(200, 2.5, sun), options);
  expect_no_nan(image);
  std::size_t near = 0;
  std::size_t far = 0;
  std::size_t ball = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    EXPECT_EQ(image.node_id[i] != 0, image.coverage[i] == 1);
    if (image.node_id[i] == 0) continue;
    const double depth = image.depth[i];
    const bool of_ball = image.node_id[i] == 2;
    EXPECT_EQ(of_ball, depth > 9.4 && depth < 10.1);
    const bool front = std::fabs(depth - 9) < 1e-5;
    near += front;
    ball += of_ball;
    if (of_ball) continue;
    // the camera sees z = +1 or, from inside, z = −1, both turned to it and to the Sun
    EXPECT_NEAR(depth, front ? 9 : 11, 1e-5);
    EXPECT_NEAR(image.radiance[3 * i] * kPi / (0.5 * sun.z), 1, 1e-6);
    EXPECT_NEAR(image.normal[3 * i + 2], 1, 1e-6);
    far += !front;
  }
  printf("near %zu, far %zu, ball %zu\n", near, far, ball);
  EXPECT_NEAR(near, 160 * 160 / 2, 200);
  EXPECT_GT(far, 1000u);
  EXPECT_GT(ball, 1000u);
}

// The texture that cuts also colours: what colour its holes have shows nowhere, near or far.
TEST(Cutout, ColoursOfHolesDoNotBleed) {
  for (const bool as_texture : {false, true})
    for (const std::uint32_t size : {500u, 40u, 4u}) {
      image::Image images[2];
      for (const int hidden : {0, 255}) {
        Textured contents(single(plate(1, 1), lambert(1)));
        const auto texture = contents.add(64, 64, true, [&](auto x, auto y) {
          return net(x, y)[3] ? grey(100) : grey(hidden, 0);
        });
        contents.materials[0].maps.cutout = texture;
        if (as_texture)
          contents.instances[0].texture = texture;
        else
          contents.materials[0].maps.albedo = texture;
        images[hidden / 255] = rendered(model_of(contents), above(size, 1.2));
        for (std::size_t i = 0; i < images[0].pixels(); ++i) {
          const float* p = &images[hidden / 255].radiance[3 * i];
          if (*p > 0) {
            EXPECT_NEAR(*p * kPi, 100 / 255.0, 1e-6);
          }
        }
      }
      EXPECT_EQ(images[0].radiance, images[1].radiance);
    }
}

// Opaque at the threshold is there everywhere; under it, nowhere.
TEST(Cutout, LimitsOfTheThreshold) {
  const auto share = [](double threshold, int code, std::uint32_t size) {
    Textured contents(single(plate(1, 1), lambert(1)));
    contents.materials[0].maps.cutout =
        contents.add(37, 11, false, [&](auto, auto) { return grey(9, code); });
    contents.materials[0].maps.threshold = threshold;
    contents.materials[0].maps.repeat = Vec2(3.7, 1.3);
    return sums(rendered(model_of(contents), above(size, 1))).coverage / size / size;
  };
  for (const std::uint32_t size : {900u, 60u, 7u}) {
    EXPECT_EQ(share(0, 0, size), 1);
    EXPECT_EQ(share(1, 255, size), 1);
    EXPECT_EQ(share(1, 254, size), 0);
    EXPECT_EQ(share(77 / 255.0, 77, size), 1);
    EXPECT_EQ(share(77.5 / 255.0, 77, size), 0);
  }
}

TEST(Cutout, TilesDrawTheSameHoles) {
  Textured contents(single(plate(1, 1), lambert(1)));
  contents.materials[0].maps.cutout = contents.add(64, 64, false, soft);
  contents.materials[0].maps.repeat = Vec2(8);
  const pan::Model model = model_of(contents);
  for (const unsigned samples : {1u, 3u}) {
    RenderOptions options;
    options.samples = samples;
    const image::Image whole = rendered(model, above(200, 1.1), options);
    options.tile_side = 64;
    const image::Image tiled = rendered(model, above(200, 1.1), options);
    std::size_t other = 0;
    for (std::size_t i = 0; i < whole.pixels(); ++i)
      other += whole.coverage[i] != tiled.coverage[i];
    printf("%u samples: %zu pixels differ\n", samples, other);
    EXPECT_LE(other, 40u);
  }
}

// Textures that no author makes, in every role at once, near, far and at grazing angles.
TEST(Cutout, HostileTexturesGiveNoNan) {
  struct Shape {
    std::uint32_t width, height;
  };
  for (const Shape& shape : {Shape{1, 1}, Shape{16384, 1}, Shape{1, 16384}, Shape{3, 7}})
    for (const int kind : {0, 1, 2, 3})
      for (const Vec2& repeat : {Vec2(1), Vec2(0), Vec2(-3, 1e12), Vec2(1e-30)}) {
        materials::Material material = lambert(0.8);
        material.specular_brdf = materials::CookTorrance{.alpha = 1e-6};
        material.specular = Vec3(1);
        material.weights = {0.5, 0.5, 0};
        geometry::Mesh mesh = sphere(9, 12, true);
        if (kind == 2)
          for (Vec2& t : mesh.texcoords) t = Vec2(0.5);  // no direction at all
        if (kind == 3)
          for (Vec2& t : mesh.texcoords) t *= 1e12;  // the largest that are read
        Textured contents(single(mesh, material));
        std::uint32_t state = 7;
        const auto texture = contents.add(shape.width, shape.height, false, [&](auto, auto) {
          state = state * 1664525u + 1013904223u;
          const auto code = static_cast<int>(state >> 24);
          return kind == 0 ? grey(0, 0) : kind == 1 ? grey(127, 127) : grey(code, 255 - code);
        });
        contents.materials[0].maps = {texture, texture, texture, texture, kind == 0 ? -1 : texture,
                                      0.5,     repeat};
        contents.instances[0].texture = texture;
        contents.decals.push_back(
            {"decal", 0, 0, Vec3(0, 0, 1), Quat(1, 0, 0, 0), 1e-3, 1e3, 1e-300});
        contents.decals.push_back({"decal", 0, 0, Vec3(0, 0, 1), Quat(1, 0, 0, 0), 2, 2, 2});
        SCOPED_TRACE(testing::Message()
                     << shape.width << ' ' << shape.height << ' ' << kind << ' ' << repeat.y);
        const pan::Model model = model_of(contents);
        for (const double distance : {1.001, 5.0, 1e5}) {
          RenderOptions options;
          options.ground_truth = true;
          expect_no_nan(
              rendered(model, looking_from({1, -1, 1}, distance, 1.5 / distance, 24, 1), options));
        }
      }
}

}  // namespace
}  // namespace panwright::preview::cutout_test
