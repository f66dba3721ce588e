// Levels of detail in images.

#include <gtest/gtest.h>

#include "tests/preview_gl/models.h"

namespace panwright::preview::levels_test {
namespace {

using namespace testing_support;

// A plate; seen by pixels of 10 mm, one of half the size and half the albedo, from 20 mm on a
// quarter.
pan::Model leveled() {
  pan::Contents contents = single(plate(1, 1), lambert(0.8));
  contents.meshes.push_back(pan::packed(plate(0.5, 0.5), "level 1"));
  contents.meshes.push_back(pan::packed(plate(0.25, 0.25), "level 2"));
  contents.materials.push_back(lambert(0.4));
  contents.materials[1].name = "dark";
  contents.levels = {{0.01, 0, 0, 1, 1, 0}, {0.02, 0, 0, 2, 0, 0}};
  return model_of(contents);
}

View view_from(double distance) {
  return looking_from(Vec3(0.3, 0.2, 1), distance, 0.064, 64, 0.6);
}

RenderOptions options(std::optional<double> pixel = {}) {
  RenderOptions out;
  out.samples = 4;
  out.level_pixel = pixel;
  return out;
}

double sum_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.radiance) sum += value;
  return sum;
}

TEST(DetailLevels, APixelChooses) {
  const pan::Model model = leveled();
  const View view = view_from(25);
  const double all = sum_of(rendered(model, view, options(0)));
  // an eighth: a quarter of the area, half the albedo; measured off by 2e-3, from 4 x 4 samples
  EXPECT_NEAR(sum_of(rendered(model, view, options(0.01))) / all, 0.125, 1e-3);
  EXPECT_NEAR(sum_of(rendered(model, view, options(0.0199))) / all, 0.125, 1e-3);
  EXPECT_NEAR(sum_of(rendered(model, view, options(0.02))) / all, 0.0625, 1e-3);
  EXPECT_NEAR(sum_of(rendered(model, view, options(1e9))) / all, 0.0625, 1e-3);
  EXPECT_EQ(sum_of(rendered(model, view, options(0.00999))), all);
  RenderOptions off = options(0.02);
  off.levels = false;
  EXPECT_EQ(sum_of(rendered(model, view, off)), all);
}

// A pixel sees 0.0123 m and more of the plate's box: over the upper half of the octave from 1/128 m
// the image is the mean of both levels by the logarithm of what it sees, to a float's rounding.
TEST(DetailLevels, FadeIsAMeanOfBoth) {
  const pan::Model model = leveled();
  for (const double distance : {12.2, 12.8, 14.0, 15.2}) {
    const View view = view_from(distance);
    const double nearest = view.camera.position.z;
    // off the plate's edge in x and y, and above its plane
    const Vec3 off(std::max(std::fabs(view.camera.position.x) - 0.5, 0.0),
                   std::max(std::fabs(view.camera.position.y) - 0.5, 0.0), nearest);
    const double pixel = glm::length(off) / view.camera.focal.x;
    const double share = 2 * std::log2(pixel * 128) - 1;
    ASSERT_GT(share, 0.02) << distance;
    ASSERT_LT(share, 1) << distance;
    const image::Image fine = rendered(model, view, options(1.0 / 128)),
                       coarse = rendered(model, view, options(1.0 / 64)),
                       mixed = rendered(model, view, options());
    double off_by = 0;
    for (std::size_t i = 0; i < mixed.radiance.size(); ++i)
      off_by = std::max(off_by, std::fabs((1 - share) * static_cast<double>(fine.radiance[i]) +
                                          share * static_cast<double>(coarse.radiance[i]) -
                                          static_cast<double>(mixed.radiance[i])));
    EXPECT_LT(off_by, 1e-7) << distance;  // of radiances up to 0.2
    EXPECT_GT(std::fabs(sum_of(mixed) - sum_of(fine)), 0.01 * sum_of(fine));
  }
}

// Ground truth is that of the finer level, under the instance's own node and material.
TEST(DetailLevels, GroundTruth) {
  const pan::Model model = leveled();
  RenderOptions truth = options(0.02);
  truth.ground_truth = true;
  const image::Image image = rendered(model, view_from(25), truth);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < image.target_id.size(); ++i) {
    if (image.target_id[i] == 0) continue;
    ++seen;
    EXPECT_EQ(image.target_id[i], 1u);
    EXPECT_EQ(image.node_id[i], 1u);
    EXPECT_EQ(image.material_id[i], 1u);
  }
  EXPECT_GT(seen, 50u);
}

// Shadow maps follow the levels: a level's own facets cast the shadows.
TEST(DetailLevels, ShadowsFollow) {
  pan::Contents contents = single(plate(4, 4), lambert(0.5));
  contents.meshes.push_back(pan::packed(box({1, 1, 1}), "box"));
  contents.meshes.push_back(pan::packed(box({0.1, 0.1, 0.1}), "small box"));
  contents.nodes.push_back({"lid", 0, Vec3(0, 0, 1), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({1, 1, 0, -1});
  contents.levels = {{0.01, 0, 1, 2, 0, 0}};
  const pan::Model model = model_of(contents);
  const View view = looking_from(Vec3(1, 0, 1), 20, 0.3, 128, 0.7);
  DiagnosticLog log;
  support::ModelRenderer renderer(shared_device(), model);
  const auto sum = [&](std::optional<double> pixel, unsigned side) {
    RenderOptions o = options(pixel);
    o.shadow_side = side;
    const auto image = renderer.render(view, o, log);
    EXPECT_TRUE(image);
    return sum_of(*image);
  };
  const double shadow = sum(0, 0) - sum(0, 1024), less = sum(1, 0) - sum(1, 1024);
  // a hundredth of the area and more or less seen of it
  EXPECT_LT(less, 0.05 * shadow);
  EXPECT_EQ(sum(0, 0) - sum(0, 1024), shadow);
}

// Two views under way, one of which is mixed, are what each is alone.
TEST(DetailLevels, UnderWay) {
  const auto model = std::make_shared<const pan::Model>(leveled());
  Renderer renderer(shared_device());
  DiagnosticLog log;
  const View views[] = {view_from(14), view_from(30), view_from(12.8), view_from(3)};
  std::vector<image::Image> piped;
  const auto world_for = [&](const View& view) {
    world::World world = world_of(model, {});
    set_view(world, view);
    return world;
  };
  for (const View& view : views) {
    if (renderer.in_flight() == Renderer::kMostInFlight - 1) {
      auto image = renderer.collect(log);
      ASSERT_TRUE(image);
      piped.push_back(*std::move(image));
    }
    ASSERT_TRUE(renderer.submit(world_for(view), view.camera, options(), log));
  }
  while (renderer.in_flight() > 0) piped.push_back(*renderer.collect(log));
  ASSERT_EQ(piped.size(), std::size(views));
  for (std::size_t i = 0; i < piped.size(); ++i) {
    const image::Image alone = rendered(*model, views[i], options());
    EXPECT_EQ(piped[i].radiance, alone.radiance) << i;
    EXPECT_EQ(piped[i].coverage, alone.coverage) << i;
  }
}

}  // namespace
}  // namespace panwright::preview::levels_test
