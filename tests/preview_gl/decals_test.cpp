// Textures laid on instances, against their projection in double.
#include "textured.h"

namespace panwright::preview::decals_test {
namespace {

using namespace testing_support;

pan::DecalContent decal_at(const Vec3& origin, const Quat& rotation, double width, double height,
                           double depth) {
  pan::DecalContent decal;
  decal.name = "decal";
  decal.origin = origin;
  decal.rotation = glm::normalize(rotation);
  decal.width = width;
  decal.height = height;
  decal.depth = depth;
  return decal;
}

const Quat kUpright(1, 0, 0, 0);

Texel black(std::uint32_t, std::uint32_t) { return grey(0); }

// A black decal takes its share of a white plate's light, at any range and on any side of 1 pixel.
TEST(Decals, BlackShareOfAWhitePlate) {
  Textured contents(single(plate(1, 1), lambert(1)));
  contents.add(30, 20, false, black);
  contents.decals = {
      decal_at({0.11, -0.07, 0.03}, glm::angleAxis(0.4, Vec3(0, 0, 1)), 0.45, 0.3, 0.05)};
  const pan::Model model = model_of(contents);
  for (const std::uint32_t size : {1000u, 100u, 20u, 5u})
    for (const unsigned samples : {1u, 4u, 16u}) {
      if (size * samples > 4000) continue;
      RenderOptions options;
      options.samples = samples;
      const Sums sum = sums(rendered(model, above(size, 1), options));
      const double black_share = 1 - sum.radiance.x * kPi / sum.coverage;
      const double cells = double(size) * samples;
      printf("%u px, %u samples: share %.6f, off %+.1e\n", size, samples, black_share,
             black_share - 0.45 * 0.3);
      // point samples of an edge 1.5 long: measured up to 0.8 n^-3/2
      EXPECT_NEAR(black_share, 0.45 * 0.3, 1.5 * std::pow(cells, -1.5) + 1e-6);
    }
}

// What a decal's colour is, where it lies, and which way up: four colours on a plate.
TEST(Decals, LieTheRightWayUp) {
  Textured contents(single(plate(2, 2), lambert(0.25)));
  contents.materials[0].diffuse = {0.25, 0, 0.5};  // where a channel is 0, a decal still is not
  contents.add(2, 2, true, [](auto x, auto y) {
    if (y == 1) return x == 0 ? Texel{255, 0, 0, 255} : Texel{0, 255, 0, 255};
    return x == 0 ? Texel{0, 0, 255, 255} : Texel{255, 255, 255, 255};
  });
  contents.decals = {decal_at({0.5, 0.5, 0}, kUpright, 1, 1, 0.1)};
  const image::Image image = rendered(model_of(contents), above(64, 2));
  const auto color = [&](std::size_t x, std::size_t y) { return radiance_at(image, x, y) * kPi; };
  EXPECT_LE(glm::length(color(34, 2) - Vec3(1, 0, 0)), 1e-6);
  EXPECT_LE(glm::length(color(61, 2) - Vec3(0, 1, 0)), 1e-6);
  EXPECT_LE(glm::length(color(34, 29) - Vec3(0, 0, 1)), 1e-6);
  EXPECT_LE(glm::length(color(61, 29) - Vec3(1, 1, 1)), 1e-6);
  EXPECT_LE(glm::length(color(31, 2) - Vec3(0.25, 0, 0.5)), 1e-6);
  EXPECT_LE(glm::length(color(34, 32) - Vec3(0.25, 0, 0.5)), 1e-6);
}

// Alpha mixes; later decals lie over earlier ones; 100 of them in order.
TEST(Decals, MixInOrder) {
  Textured contents(single(plate(2, 2), lambert(0.5)));
  contents.add(1, 1, true, [](auto, auto) { return grey(255, 51); });
  contents.add(1, 1, true, [](auto, auto) { return grey(51, 102); });
  double expected = 0.5;
  for (int i = 0; i < 100; ++i) {
    pan::DecalContent decal = decal_at(Vec3(0), kUpright, 1, 1, 0.1);
    decal.texture = i % 3 == 0 ? 1 : 0;
    contents.decals.push_back(decal);
    expected = i % 3 == 0 ? expected * 0.6 + 0.2 * 0.4 : expected * 0.8 + 0.2;
  }
  const image::Image image = rendered(model_of(contents), above(32, 2));
  EXPECT_NEAR(radiance_at(image, 16, 16).x * kPi, expected, 1e-6);
  EXPECT_NEAR(radiance_at(image, 2, 16).x * kPi, 0.5, 1e-6);
}

// Pixels of an image whose colour is not the one that projecting each visible point gives.
struct Compared {
  std::size_t wrong = 0;
  std::size_t dark = 0;
};
Compared compared(const pan::Contents& contents, const View& view, bool two_sided) {
  const pan::Model model = model_of(contents);
  RenderOptions options;
  options.ground_truth = true;
  options.samples = 1;
  options.shadow_side = 0;
  const image::Image image = rendered(model, view, options);
  expect_no_nan(image);
  View lit = view;
  const pan::DecalContent& decal = contents.decals[0];
  Compared result;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t pixel = std::size_t{y} * image.width + x;
      const Vec3 normal(image.normal[3 * pixel], image.normal[3 * pixel + 1],
                        image.normal[3 * pixel + 2]);
      if (image.node_id[pixel] == 0 || glm::dot(normal, view.to_sun) < 0.01) continue;
      const geometry::Ray ray = pixel_ray(lit.camera, {x + 0.5, y + 0.5});
      const Vec3 point = ray.origin + static_cast<double>(image.range[pixel]) * ray.direction;
      const Vec3 at = glm::conjugate(decal.rotation) * (point - decal.origin);
      const Vec3 there = glm::conjugate(decal.rotation) * normal;
      const bool inside = std::fabs(at.x) <= decal.width / 2 &&
                          std::fabs(at.y) <= decal.height / 2 && std::fabs(at.z) <= decal.depth &&
                          there.z > 0;
      const bool is_dark = image.radiance[3 * pixel] == 0;
      result.dark += is_dark;
      result.wrong += is_dark != inside;
    }
  printf("%zu of %zu dark pixels wrong%s\n", result.wrong, result.dark,
         two_sided ? ", two-sided" : "");
  return result;
}

TEST(Decals, OnRoundBodies) {
  geometry::Mesh tube = sphere(60, 80);
  for (Vec3& p : tube.positions) {
    const double radius = std::hypot(p.x, p.y);
    if (radius > 1e-6) p = Vec3(p.x / radius, p.y / radius, 2 * p.z);
  }
  for (std::size_t i = 0; i < tube.positions.size(); ++i) {
    const Vec3 p = tube.positions[i];
    if (std::hypot(p.x, p.y) > 0.5) tube.normals[i] = glm::normalize(Vec3(p.x, p.y, 0));
  }
  tube.closed = false;
  for (const geometry::Mesh& mesh : {sphere(60, 80), tube})
    for (const double depth : {0.02, 0.3, 5.0}) {
      Textured contents(single(mesh, lambert(1)));
      contents.add(16, 16, false, black);
      const Vec3 out = glm::normalize(Vec3(0.6, -1, 0.1));
      const Vec3 up = glm::normalize(Vec3(0.1, 0.2, 1) - out * glm::dot(out, Vec3(0.1, 0.2, 1)));
      const Quat rotation = glm::quat_cast(Mat3(glm::cross(up, out), up, out));
      contents.decals = {decal_at(out * 0.99, rotation, 0.9, 0.7, depth)};
      for (const double distance : {4.0, 1e4}) {
        View view = looking_from({0.3, -1, 0.4}, distance, 3.4 / distance, 300, 0.3);
        const Compared result = compared(contents, view, !mesh.closed);
        EXPECT_GT(result.dark, 700u);
        // on the edge of the decal only: measured 0 to 20
        EXPECT_LE(result.wrong, 40u);
      }
    }
}

// From behind an open sheet its decal is not seen; a mirrored instance mirrors it.
TEST(Decals, OneSideAndMirrors) {
  Textured contents(single(plate(2, 2), lambert(1)));
  contents.add(2, 1, true, [](auto x, auto) { return grey(x == 0 ? 0 : 128); });
  contents.decals = {decal_at(Vec3(0), kUpright, 1, 1, 0.1)};
  const image::Image front = rendered(model_of(contents), above(32, 2));
  EXPECT_NEAR(radiance_at(front, 9, 16).x * kPi, 0, 1e-6);
  EXPECT_NEAR(radiance_at(front, 22, 16).x * kPi, 128 / 255.0, 1e-6);
  const image::Image back = rendered(model_of(contents), above(32, 2, Vec3(0, 0, -1), -1));
  EXPECT_NEAR(radiance_at(back, 9, 16).x * kPi, 1, 1e-6);
  EXPECT_NEAR(radiance_at(back, 22, 16).x * kPi, 1, 1e-6);
  contents.nodes[0].scale = {-1, 1, 1};
  const image::Image mirrored = rendered(model_of(contents), above(32, 2));
  EXPECT_NEAR(radiance_at(mirrored, 22, 16).x * kPi, 0, 1e-6);
  EXPECT_NEAR(radiance_at(mirrored, 9, 16).x * kPi, 128 / 255.0, 1e-6);
}

// Far away, the mean of what is premultiplied; the colour of transparent texels is nowhere.
TEST(Decals, TransparentTexelsHaveNoColor) {
  for (const std::uint32_t size : {400u, 64u, 6u}) {
    image::Image images[2];
    for (const int hidden : {0, 255}) {
      Textured contents(single(plate(1, 1), lambert(0.4)));
      contents.add(63, 41, true, [&](auto x, auto y) {
        return (x / 4 + y / 4) % 2 ? grey(200, 255) : grey(hidden, 0);
      });
      contents.decals = {decal_at(Vec3(0), kUpright, 1, 1, 0.1)};
      images[hidden / 255] = rendered(model_of(contents), above(size, 1));
    }
    EXPECT_EQ(images[0].radiance, images[1].radiance);
    double alpha = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 63; ++x) alpha += (x / 4 + y / 4) % 2 ? 1.0 / (63 * 41) : 0;
    const Sums sum = sums(images[0]);
    const double exact = alpha * 200 / 255 + (1 - alpha) * 0.4;
    const double off = sum.radiance.x * kPi / sum.coverage / exact - 1;
    printf("%u px: %+.1e\n", size, off);
    EXPECT_LE(std::fabs(off), 5e-3);
  }
}

// Holes stay holes, and truth knows nothing of paint.
TEST(Decals, OverACutout) {
  Textured contents(single(plate(1, 1), lambert(1)));
  contents.add(8, 8, false, black);
  contents.materials[0].maps.cutout = contents.add(
      16, 16, false, [](auto x, auto y) { return grey(255, (x / 4 + y / 4) % 2 ? 255 : 0); });
  RenderOptions options;
  options.ground_truth = true;
  options.samples = 4;
  const View view = above(128, 1.1);
  const image::Image bare = rendered(model_of(contents), view, options);
  contents.decals = {decal_at(Vec3(0), kUpright, 2, 2, 0.1)};
  const image::Image painted = rendered(model_of(contents), view, options);
  EXPECT_EQ(bare.coverage, painted.coverage);
  EXPECT_EQ(bare.depth, painted.depth);
  EXPECT_EQ(bare.normal, painted.normal);
  EXPECT_EQ(bare.node_id, painted.node_id);
  for (const float value : painted.radiance) EXPECT_EQ(value, 0);
}

// One of many instances of a mesh, partly hidden, on a tilted view: no other one is painted, and
// nothing in front of it.
TEST(Decals, OnlyWhatIsSeenOfItsInstance) {
  Textured contents(single(sphere(60, 80), lambert(1)));
  contents.add(8, 8, false, black);
  contents.nodes.push_back({"near", 0, Vec3(0.7, -2.5, 0), Quat(1, 0, 0, 0), Vec3(0.6)});
  contents.instances.push_back({1, 0, 0, -1});
  pan::DecalContent all = decal_at(Vec3(0), kUpright, 4, 4, 4);
  all.rotation = glm::angleAxis(kPi / 2, Vec3(1, 0, 0));  // z to −y
  contents.decals = {all};
  RenderOptions options;
  options.ground_truth = true;
  const View view = looking_from({0, -1, 0.1}, 9, 0.4, 200, 0.1);
  const image::Image image = rendered(model_of(contents), view, options);
  std::size_t painted = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    if (image.node_id[i] == 0) continue;
    const Vec3 normal(image.normal[3 * i], image.normal[3 * i + 1], image.normal[3 * i + 2]);
    if (glm::dot(normal, glm::normalize(view.to_sun)) < 0.05 || normal.y > -0.05) continue;
    painted += image.node_id[i] == 1;
    wrong += (image.radiance[3 * i] == 0) != (image.node_id[i] == 1);
  }
  EXPECT_GT(painted, 5000u);
  EXPECT_EQ(wrong, 0u);
}

// Where surfaces of two targets, or of two instances, coincide, one of them is seen, and a decal of
// the other does not show. The decals: black, over half of the plate.
TEST(Decals, OfWhatIsNotSeenDoNotShow) {
  const auto plain = [](double albedo) { return single(plate(1, 1), lambert(albedo)); };
  const auto decorated = [&](double albedo) {
    Textured contents(plain(albedo));
    contents.add(2, 2, false, black);
    contents.decals = {decal_at({0.25, 0, 0}, kUpright, 0.5, 1, 0.1)};
    return contents;
  };
  const auto shared = [](const pan::Contents& contents) {
    return std::make_shared<const pan::Model>(model_of(contents));
  };
  const world::ModelPtr bare = shared(plain(0.25));
  const world::ModelPtr marked = shared(decorated(0.75));
  const View view = above(16, 1);
  RenderOptions options;
  options.ground_truth = true;
  options.shadow_side = 0;
  for (const bool marked_first : {false, true}) {
    world::World world;
    DiagnosticLog log;
    ASSERT_TRUE(world.add("a", marked_first ? marked : bare, {}, log));
    ASSERT_TRUE(world.add("b", marked_first ? bare : marked, {}, log));
    world::Sun sun;
    sun.direction = view.to_sun;
    world.set_sun(sun);
    Renderer renderer(shared_device());
    const auto image = renderer.render(world, view.camera, options, log);
    ASSERT_TRUE(image) << to_text(log);
    std::size_t covered = 0;
    for (std::size_t pixel = 0; pixel < image->target_id.size(); ++pixel) {
      ASSERT_NE(image->target_id[pixel], 0u);
      const bool is_marked = (image->target_id[pixel] == 1) == marked_first;
      const bool right = pixel % 16 >= 8;
      const double expected = !is_marked ? 0.25 : right ? 0 : 0.75;
      EXPECT_NEAR(image->radiance[3 * pixel] * kPi, expected, 1e-6) << marked_first << " " << pixel;
      covered += is_marked && right;
    }
    // all of the one that was drawn first
    EXPECT_TRUE(covered == 0 || covered == 128);
    EXPECT_EQ(covered, marked_first ? 128u : 0u);
  }
  // two instances of one model
  Textured contents = decorated(0.75);
  contents.materials.push_back(lambert(0.25));
  contents.materials.back().name = "bare";
  contents.instances.push_back(contents.instances[0]);
  contents.instances[1].material = 1;
  for (const std::uint32_t owner : {0u, 1u}) {
    contents.decals[0].instance = owner;
    const image::Image image = rendered(model_of(contents), view, options);
    for (std::size_t pixel = 0; pixel < image.material_id.size(); ++pixel) {
      const bool is_owner = image.material_id[pixel] == owner + 1;
      const double bare_albedo = image.material_id[pixel] == 1 ? 0.75 : 0.25;
      EXPECT_NEAR(image.radiance[3 * pixel] * kPi, is_owner && pixel % 16 >= 8 ? 0 : bare_albedo,
                  1e-6)
          << owner << " " << pixel;
    }
  }
}

}  // namespace
}  // namespace panwright::preview::decals_test
