// Texels of imposters on pixels. Oracles: areas by fine subdivision, sums that are known, the error
// function, moments of kernels, areas of discs.

#include "preview/frame/texel_areas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace panwright::preview::texel_areas_test {
namespace {

world::Camera camera_of(std::uint32_t size = 32, double focal = 1000) {
  world::Camera camera;
  camera.width = size;
  camera.height = size;
  camera.focal = Vec2(focal);
  camera.principal = Vec2(size / 2.0);
  return camera;
}

// An imposter of a rectangle about a point of the image, pixels, in its own turned axes.
Imposter imposter_at(const world::Camera& camera, const Vec2& pixel, const Vec2& size,
                     std::uint32_t texels) {
  Imposter imposter;
  const Vec2 at = (pixel - camera.principal) / camera.focal;
  const double c = 1 / std::sqrt(1 + 0.25 * (std::sqrt(5.0) - 1) * (std::sqrt(5.0) - 1));
  const double s = std::sqrt(1 - c * c);
  const Vec2 centre(c * at.x + s * at.y, c * at.y - s * at.x);
  imposter.rect = {centre - 0.5 * size / camera.focal, centre + 0.5 * size / camera.focal};
  imposter.extent = std::max(size.x, size.y);
  imposter.texels = texels;
  place_imposter(camera, imposter);
  return imposter;
}

// An image whose texels have the coverage that a function of their centres, pixels, says; radiance
// twice that.
template <class Inside>
image::Image texels_of(const Imposter& imposter, const Inside& inside) {
  image::Image image;
  image.width = imposter.camera.width;
  image.height = imposter.camera.height;
  image.radiance.resize(3 * image.pixels());
  image.coverage.resize(image.pixels());
  for (std::size_t j = 0; j < image.height; ++j)
    for (std::size_t i = 0; i < image.width; ++i) {
      const Vec2 centre = imposter.origin + (static_cast<double>(i) + 0.5) * imposter.along +
                          (static_cast<double>(j) + 0.5) * imposter.down;
      const auto value = static_cast<float>(inside(centre));
      image.coverage[j * image.width + i] = value;
      for (std::size_t k = 0; k < 3; ++k) image.radiance[3 * (j * image.width + i) + k] = 2 * value;
    }
  return image;
}

double sum_of(const ImposterPatch& patch, std::size_t channel = 3) {
  double sum = 0;
  for (std::size_t i = channel; i < patch.light.size(); i += 4) sum += patch.light[i];
  return sum;
}

Vec2 centre_of(const ImposterPatch& patch) {
  Vec2 sum(0);
  double all = 0;
  for (std::size_t i = 0; i < patch.light.size() / 4; ++i) {
    const Vec2 at(static_cast<double>(i % patch.part.width) + 0.5 + patch.part.x,
                  static_cast<double>(i / patch.part.width) + 0.5 + patch.part.y);
    sum += patch.light[4 * i + 3] * at;
    all += patch.light[4 * i + 3];
  }
  return sum / all;
}

TEST(TexelAreas, WhatIsFullIsFull) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-0.5, 0.5);
  for (int run = 0; run < 20; ++run) {
    const world::Camera camera = camera_of();
    const Imposter imposter =
        imposter_at(camera, Vec2(16 + offset(random), 16 + offset(random)), Vec2(14, 12), 71);
    const image::Image texels = texels_of(imposter, [](const Vec2&) { return 1; });
    const ImposterPatch patch = patch_of(imposter, texels, nullptr, {}, 0, 32, 32);
    EXPECT_NEAR(sum_of(patch), 14 * 12, 1e-10);
    EXPECT_NEAR(sum_of(patch, 0), 2 * 14 * 12, 1e-10);
    std::size_t full = 0;
    for (std::size_t i = 3; i < patch.light.size(); i += 4) {
      EXPECT_LE(patch.light[i], 1 + 1e-12);
      if (patch.light[i] > 1 - 1e-12) ++full;
    }
    EXPECT_GT(full, 100u);  // of 168 pixels of area
  }
}

// One texel, of any place and of pixels that are no squares, against 2000 x 2000 points in it.
TEST(TexelAreas, EachPixelHasTheAreaInCommon) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> offset(-0.5, 0.5);
  for (int run = 0; run < 30; ++run) {
    world::Camera camera = camera_of();
    camera.focal = Vec2(1000, run % 2 == 0 ? 1000 : 700);
    Imposter imposter =
        imposter_at(camera, Vec2(16 + offset(random), 16 + offset(random)), Vec2(3, 2.6), 8);
    image::Image texels = texels_of(imposter, [](const Vec2&) { return 0; });
    const std::uint32_t i = texels.width / 2;
    const std::uint32_t j = texels.height / 2 - 1;
    texels.coverage[j * texels.width + i] = 1;
    const ImposterPatch patch = patch_of(imposter, texels, nullptr, {}, 0, 32, 32);
    std::vector<double> expected(patch.light.size() / 4, 0);
    constexpr int kPoints = 2000;
    const double area =
        std::fabs(imposter.along.x * imposter.down.y - imposter.along.y * imposter.down.x);
    for (int a = 0; a < kPoints; ++a)
      for (int b = 0; b < kPoints; ++b) {
        const Vec2 at = imposter.origin + (i + (a + 0.5) / kPoints) * imposter.along +
                        (j + (b + 0.5) / kPoints) * imposter.down;
        expected[static_cast<std::size_t>(std::floor(at.y) - patch.part.y) * patch.part.width +
                 static_cast<std::size_t>(std::floor(at.x) - patch.part.x)] +=
            area / (kPoints * double{kPoints});
      }
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(patch.light[4 * k + 3], expected[k], 2e-4 * area) << run << ' ' << k;
    EXPECT_NEAR(sum_of(patch), area, 1e-14);
  }
}

// Discs and plates: flux, its estimate, and no dependence on where pixels are.
TEST(TexelAreas, AreasOfDiscsAndPlates) {
  const world::Camera camera = camera_of();
  double squares = 0;
  double estimates = 0;
  double plates = 0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    const double r = 3 + 0.01 * run;
    const Vec2 centre(16.3, 15.8);
    const Imposter imposter = imposter_at(camera, centre, Vec2(8), 128);
    const image::Image disc =
        texels_of(imposter, [&](const Vec2& p) { return glm::length(p - centre) < r ? 1 : 0; });
    const ImposterPatch patch = patch_of(imposter, disc, nullptr, {}, 0, 32, 32);
    const double error = sum_of(patch) / (kPi * r * r) - 1;
    squares += error * error / kRuns;
    estimates += flux_error_of(disc) / kRuns;
    // measured: 7.6e-3, of texels of 0.06
    EXPECT_NEAR(centre_of(patch).x, centre.x, 0.012);
    EXPECT_NEAR(centre_of(patch).y, centre.y, 0.012);
    // along rows and columns of the image: where straight grids are off by up to 1/50
    const double half = 1.5 + 0.013 * run;
    const image::Image plate = texels_of(imposter, [&](const Vec2& p) {
      return std::fabs(p.x - centre.x) < half && std::fabs(p.y - centre.y) < half ? 1 : 0;
    });
    plates = std::max(plates, std::fabs(sum_of(patch_of(imposter, plate, nullptr, {}, 0, 32, 32)) /
                                            (4 * half * half) -
                                        1));
  }
  // measured: 3.7e-4 where 7.6e-4 are estimated, of radii of 50 texels (1.3e-3 where they stand
  // about a corner of texels); plates 8e-4
  EXPECT_LT(std::sqrt(squares) / estimates, 1);
  EXPECT_GT(std::sqrt(squares) / estimates, 0.2);
  EXPECT_LT(plates, 2e-3);
}

// Glints smaller than texels, each met by chance: the relative deviation of a sum of n of them is
// 1/sqrt(n).
TEST(TexelAreas, FluxErrorOfGlintsMetByChance) {
  std::mt19937 random(7);
  image::Image texels;
  texels.width = texels.height = 400;
  texels.radiance.assign(3 * 400 * 400, 0.0f);
  double glints = 0;
  for (std::size_t i = 0; i < 400 * 400; ++i)
    if (random() % 500 == 0) {
      for (std::size_t k = 0; k < 3; ++k) texels.radiance[3 * i + k] = 2;
      ++glints;
    }
  ASSERT_GT(glints, 200);
  // a few are neighbours; steps alone gave 0.64 of it
  EXPECT_NEAR(flux_error_of(texels) * std::sqrt(glints), 1, 0.03);
}

TEST(TexelAreas, ShiftsOfPixelsChangeNothing) {
  double first = 0;
  for (int run = 0; run < 50; ++run) {
    world::Camera camera = camera_of();
    camera.principal += Vec2(0.017 * run, -0.031 * run);
    const Vec2 centre = camera.principal + Vec2(1.3, -2.2);
    const Imposter imposter = imposter_at(camera, centre, Vec2(0.9), 128);
    const image::Image disc =
        texels_of(imposter, [&](const Vec2& p) { return glm::length(p - centre) < 0.4 ? 1 : 0; });
    const ImposterPatch patch = patch_of(imposter, disc, nullptr, {}, 0, 32, 32);
    if (run == 0) first = sum_of(patch);
    EXPECT_NEAR(sum_of(patch), first, 1e-4 * first);
  }
}

// A texel far below a pixel is a point: pixels integrate the Gaussian about it.
TEST(TexelAreas, PsfIsTheIntegralOverPixels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> offset(-0.5, 0.5);
  for (const double sigma : {0.3, 0.5, 1.0, 2.5}) {
    for (int run = 0; run < 10; ++run) {
      const Vec2 at(30 + offset(random), 30 + offset(random));
      const Imposter imposter = imposter_at(camera_of(60), at, Vec2(0.01), 64);
      const image::Image dot =
          texels_of(imposter, [&](const Vec2& p) { return glm::length(p - at) < 4e-3 ? 1 : 0; });
      const ImposterPatch patch = patch_of(imposter, dot, nullptr, {}, sigma, 60, 60);
      const double flux = sum_of(patch_of(imposter, dot, nullptr, {}, 0, 60, 60));
      EXPECT_NEAR(sum_of(patch), flux, 1e-8 * flux);
      const auto share = [&](double low, double centre) {
        const double scale = 1 / (sigma * std::sqrt(2.0));
        return 0.5 * (std::erf((low + 1 - centre) * scale) - std::erf((low - centre) * scale));
      };
      for (std::size_t i = 0; i < patch.light.size() / 4; ++i) {
        const double x = static_cast<double>(i % patch.part.width) + patch.part.x;
        const double y = static_cast<double>(i / patch.part.width) + patch.part.y;
        // measured: 1.3e-5
        EXPECT_NEAR(patch.light[4 * i + 3] / flux, share(x, at.x) * share(y, at.y), 5e-5);
      }
    }
  }
}

// A disc under a PSF: its second moments are those of disc, PSF and pixel.
TEST(TexelAreas, PsfHasItsVariance) {
  const double r = 2.2;
  const double sigma = 0.8;
  const Vec2 at(30.21, 29.87);
  const Imposter imposter = imposter_at(camera_of(60), at, Vec2(4.6), 96);
  const image::Image disc =
      texels_of(imposter, [&](const Vec2& p) { return glm::length(p - at) < r ? 1 : 0; });
  const ImposterPatch patch = patch_of(imposter, disc, nullptr, {}, sigma, 60, 60);
  const Vec2 centre = centre_of(patch);
  double variance = 0;
  for (std::size_t i = 0; i < patch.light.size() / 4; ++i) {
    const double x = static_cast<double>(i % patch.part.width) + 0.5 + patch.part.x - centre.x;
    variance += patch.light[4 * i + 3] * x * x / sum_of(patch);
  }
  EXPECT_NEAR(centre.x, at.x, 2e-3);
  // measured: 7e-4 off
  EXPECT_NEAR(variance, r * r / 4 + sigma * sigma + 1.0 / 12, 3e-3);
}

TEST(TexelAreas, KernelsOfImagesHaveTheirVariance) {
  for (const double sigma : {0.2, 0.5, 1.0, 3.9, 4.1, 6.0}) {
    image::Image image;
    image.width = image.height = 101;
    image.radiance.assign(3 * image.pixels(), 0);
    image.coverage.assign(image.pixels(), 0);
    const std::size_t middle = 50 * 101 + 50;
    image.coverage[middle] = 1;
    image.radiance[3 * middle + 1] = 4;
    convolve(sigma, image);
    double sum = 0;
    double variance = 0;
    double light = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      const double y = static_cast<double>(i / 101) - 50;
      sum += static_cast<double>(image.coverage[i]);
      variance += static_cast<double>(image.coverage[i]) * y * y;
      light += static_cast<double>(image.radiance[3 * i + 1]);
      EXPECT_GE(image.coverage[i], 0);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(light, 4, 4e-6);
    EXPECT_NEAR(variance, sigma * sigma, 2e-6 * (1 + sigma * sigma)) << sigma;
  }
}

// Smaller imposters take the place of a larger one's texels, also where they overlap each other or
// reach beyond it: no area counts twice.
TEST(TexelAreas, FinerOnesComeFirst) {
  const world::Camera camera = camera_of();
  const Imposter large = imposter_at(camera, Vec2(16, 16), Vec2(16), 80);
  const Imposter inside = imposter_at(camera, Vec2(15.1, 17.7), Vec2(1, 0.7), 64);
  const Imposter beyond = imposter_at(
      camera, Vec2(16, 16) + 8.0 * large.along / glm::length(large.along), Vec2(2, 1), 64);
  const std::vector<PlaneRect> finer{inside.rect, beyond.rect, inside.rect};
  const image::Image full = texels_of(large, [](const Vec2&) { return 1; });
  EXPECT_NEAR(sum_of(patch_of(large, full, nullptr, finer, 0, 32, 32)), 16 * 16 - 0.7 - 1, 1e-9);
}

TEST(TexelAreas, NothingBeyondTheImage) {
  const world::Camera camera = camera_of();
  for (const Vec2& at : {Vec2(0, 16), Vec2(32, 32), Vec2(-20, 5), Vec2(16, 32.5)}) {
    const Imposter imposter = imposter_at(camera, at, Vec2(3), 64);
    const image::Image full = texels_of(imposter, [](const Vec2&) { return 1; });
    for (const double sigma : {0.0, 0.7}) {
      const ImposterPatch patch = patch_of(imposter, full, nullptr, {}, sigma, 32, 32);
      EXPECT_LE(patch.part.x + patch.part.width, 32u);
      EXPECT_LE(patch.part.y + patch.part.height, 32u);
      image::Image image;
      image.width = image.height = 32;
      image.radiance.assign(3 * image.pixels(), 0);
      image.coverage.assign(image.pixels(), 0);
      add_patches({&patch, 1}, image);
      double sum = 0;
      for (const float value : image.coverage) sum += static_cast<double>(value);
      if (at.x == 0 && sigma == 0) {
        EXPECT_NEAR(sum, 4.5, 0.01);
      } else if (at.x == 32 && sigma == 0) {
        EXPECT_NEAR(sum, 2.25, 0.01);
      } else if (at.x == -20) {
        EXPECT_EQ(sum, 0);
      }
    }
  }
}

// Before a full image: half of what is behind is hidden, by a patch that shares pixels with
// another one.
TEST(TexelAreas, WhatIsBehindKeepsTheRest) {
  const world::Camera camera = camera_of();
  std::vector<ImposterPatch> patches;
  for (const Vec2& at : {Vec2(10.3, 16), Vec2(20.6, 16.2)}) {
    const Imposter imposter = imposter_at(camera, at, Vec2(4), 64);
    const image::Image behind = texels_of(imposter, [](const Vec2&) { return 1; });
    const image::Image before = texels_of(imposter, [](const Vec2&) { return 0.5; });
    patches.push_back(patch_of(imposter, before, &behind, {}, 0, 32, 32));
  }
  image::Image image;
  image.width = image.height = 32;
  image.radiance.assign(3 * image.pixels(), 2);
  image.coverage.assign(image.pixels(), 1);
  add_patches(patches, image);
  double coverage = 0;
  double radiance = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    coverage += static_cast<double>(image.coverage[i]);
    radiance += static_cast<double>(image.radiance[3 * i]);
  }
  EXPECT_NEAR(coverage, 32 * 32 - 16, 1e-4);
  EXPECT_NEAR(radiance, 2 * (32 * 32 - 16), 2e-4);
}

// ---- which targets become imposters

struct Scene {
  VisibleSet visible;
  world::Camera camera = camera_of(1024);

  // A cube in front of the camera, of `pixels` a side.
  void add(const Vec2& pixel, double pixels, double depth = 1e4) {
    VisibleTarget target;
    target.target = static_cast<std::uint32_t>(visible.targets.size());
    const double side = pixels * depth / camera.focal.x;
    const Vec2 at = depth * (pixel - camera.principal) / camera.focal;
    Mat4 place(1);
    place[3] = Vec4(at, depth, 1);
    target.boxes.push_back({place, Vec3(-side / 2), Vec3(side / 2)});
    target.items.push_back(0);
    visible.targets.push_back(target);
  }
  std::vector<Imposter> found(Imposters imposters = Imposters::automatic) const {
    RenderOptions options;
    options.imposters = imposters;
    ImposterFinder finder;
    const auto found = finder.find(camera, visible, options, 2048);
    return {found.begin(), found.end()};
  }
};

TEST(ImposterFinder, SmallOnesAndNeighbours) {
  Scene scene;
  scene.add(Vec2(100, 100), 5);
  scene.add(Vec2(103, 101), 4);       // overlaps
  scene.add(Vec2(600, 600), 300);     // too large
  scene.add(Vec2(600, 600), 2, 9e3);  // before it
  scene.add(Vec2(100.5, 100), 0.05);  // much smaller than the one it stands before
  scene.add(Vec2(800, 100), 3, -5);   // behind the camera
  const std::vector<Imposter> found = scene.found();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].targets, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(found[1].targets, (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(found[2].targets, (std::vector<std::uint32_t>{4}));
  EXPECT_FALSE(found[1].alone);
  // a cube of 0.05 pixels, turned by 31.7 degrees, of which one sees the sides too
  EXPECT_GT(found[2].extent, 0.05 * 1.376);
  EXPECT_LT(found[2].extent, 0.05 * 2.2);
  EXPECT_TRUE(scene.found(Imposters::off).empty());
  EXPECT_EQ(scene.found(Imposters::always).size(), 4u);
}

TEST(ImposterFinder, HundredsInOnePixelAreOne) {
  Scene scene;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> offset(0, 1);
  for (int i = 0; i < 300; ++i)
    scene.add(Vec2(512 + offset(random), 511 + offset(random)), 0.2 + 0.2 * offset(random));
  const std::vector<Imposter> found = scene.found();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].targets.size(), 300u);
  EXPECT_LE(found[0].extent, 2.5);
}

TEST(ImposterFinder, ManyShareTheTexels) {
  Scene scene;
  for (int i = 0; i < 400; ++i) scene.add(Vec2(30 + 50 * (i % 20), 30 + 50 * (i / 20)), 3);
  const std::vector<Imposter> found = scene.found();
  ASSERT_EQ(found.size(), 400u);
  double all = 0;
  for (const Imposter& one : found) all += static_cast<double>(one.texels) * one.texels;
  EXPECT_LE(all, 1.1 * (1 << 23));
  EXPECT_GE(found[0].texels, 100u);
}

// Corners that the imposter's camera and the image's see: the same place.
TEST(ImposterFinder, TexelsStandWhereTheCameraSaysTheyDo) {
  Scene scene;
  scene.camera.focal = Vec2(900, 1300);
  scene.camera.principal = Vec2(400, 610);
  scene.camera.world_from_camera = glm::normalize(Quat(0.3, -0.5, 0.7, 0.2));
  scene.camera.position = Vec3(1e7, -2e7, 3e6);
  scene.add(Vec2(1000, 50), 4);
  std::vector<Imposter> found = scene.found();
  ASSERT_EQ(found.size(), 1u);
  place_imposter(scene.camera, found[0]);
  for (const Vec3& offset : {Vec3(1, 2, 0), Vec3(-15, 7, 20), Vec3(3, -9, -4)}) {
    const PlacedBox& box = scene.visible.targets[0].boxes[0];
    const Vec3 in_camera = Vec3(box.camera_from_mesh[3]) + offset;
    const Vec3 point = scene.camera.position + scene.camera.world_from_camera * in_camera;
    const auto pixel = world::project(scene.camera, point);
    const auto texel = world::project(found[0].camera, point);
    ASSERT_TRUE(pixel && texel);
    const Vec2 again = found[0].origin + texel->x * found[0].along + texel->y * found[0].down;
    EXPECT_NEAR(again.x, pixel->x, 1e-7);
    EXPECT_NEAR(again.y, pixel->y, 1e-7);
  }
}

}  // namespace
}  // namespace panwright::preview::texel_areas_test
