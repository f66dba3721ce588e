// What must not change an image, and what must change it exactly so.
#include <cstring>

#include "textured.h"

namespace panwright::preview::invariance_test {
namespace {

using namespace testing_support;

bool equal_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

pan::Contents two_bodies() {
  pan::Contents contents = single(sphere(40, 60), lambert(0.7));
  contents.meshes.push_back(pan::packed(box({1, 1, 3}), "box"));
  contents.nodes.push_back({"box", 0, Vec3(1, 0, 0), glm::angleAxis(1.0, Vec3(1, 0, 0)), Vec3(1)});
  contents.instances.push_back({1, 1, 0, -1});
  return contents;
}

TEST(Invariance, TwoRendersAreEqualBits) {
  const pan::Model model = model_of(two_bodies());
  const View view = looking_from({1, 1, 1}, 20, 0.3, 200, 1);
  for (const bool flat : {false, true}) {
    RenderOptions options;
    options.ground_truth = true;
    options.samples = 3;
    options.flat = flat;
    DiagnosticLog log;
    support::ModelRenderer renderer(shared_device(), model);
    const auto a = renderer.render(view, options, log);
    View elsewhere = view;
    elsewhere.camera.width = 77;
    elsewhere.camera.position *= 2.0;
    ASSERT_TRUE(renderer.render(elsewhere, {}, log));
    const auto b = renderer.render(view, options, log);
    ASSERT_TRUE(a && b);
    EXPECT_TRUE(equal_bits(a->radiance, b->radiance));
    EXPECT_TRUE(equal_bits(a->coverage, b->coverage));
    EXPECT_TRUE(equal_bits(a->depth, b->depth));
    EXPECT_TRUE(equal_bits(a->normal, b->normal));
    EXPECT_EQ(a->node_id, b->node_id);
  }
}

TEST(Invariance, BothContextKindsDrawTheSame) {
  DiagnosticLog log;
  auto egl = Device::create(ContextKind::egl, log);
  ASSERT_TRUE(egl) << to_text(log);
  if ((*egl)->context().is_hardware()) GTEST_SKIP() << "bits are equal on one rasteriser only";
  const pan::Model model = model_of(two_bodies());
  const View view = looking_from({1, 1, 1}, 20, 0.3, 200, 1);
  support::ModelRenderer a(shared_device(), model);
  support::ModelRenderer b(*egl, model);
  for (int i = 0; i < 3; ++i) {
    const auto image_a = a.render(view, {}, log);
    const auto image_b = b.render(view, {}, log);
    ASSERT_TRUE(image_a && image_b);
    EXPECT_TRUE(equal_bits(image_a->radiance, image_b->radiance));
  }
}

// A tile draws what the whole draws, but for vertices whose rounding falls on another step of the
// context's sub-pixel grid.
TEST(Invariance, TilesDrawTheSameImage) {
  const pan::Model model = model_of(two_bodies());
  View view = looking_from({1, 1, 1}, 20, 0.3, 300, 1);
  view.camera.height = 217;
  RenderOptions options;
  options.ground_truth = true;
  for (const unsigned samples : {1u, 4u}) {
    options.samples = samples;
    options.tile_side = 2048;
    const image::Image whole = rendered(model, view, options);
    for (const std::uint32_t side : {64u, 100u, 509u}) {
      options.tile_side = side;
      const image::Image tiled = rendered(model, view, options);
      std::size_t other = 0;
      for (std::size_t i = 0; i < whole.pixels(); ++i)
        other += std::fabs(whole.radiance[3 * i] - tiled.radiance[3 * i]) > 1e-6;
      printf("samples %u tile %u: %zu pixels differ by more than 1e-6, rms %.1e\n", samples, side,
             other, rms_difference(whole.radiance, tiled.radiance));
      EXPECT_LE(static_cast<double>(other), whole.pixels() * bound(5e-4, 2e-3));  // an H100: 6.3e-4
    }
  }
}

TEST(Invariance, ScaleOfTheWholeSceneChangesNothing) {
  image::Image first;
  for (const double scale : {1.0, 1e-6, 1e6}) {
    pan::Contents contents = two_bodies();
    contents.nodes[0].scale = Vec3(scale);
    const pan::Model model = model_of(contents);
    View view = looking_from({1, 1, 1}, 20, 0.3, 128, 1);
    view.camera.position *= scale;
    RenderOptions options;
    options.ground_truth = true;
    const image::Image image = rendered(model, view, options);
    expect_no_nan(image);
    if (scale == 1) {
      first = image;
      continue;
    }
    // measured: 3 and 5 of 16384 pixels, on edges
    std::size_t other = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      other += std::fabs(first.radiance[3 * i] - image.radiance[3 * i]) > 1e-5;
      if (image.node_id[i] != 0 && first.node_id[i] == image.node_id[i]) {
        EXPECT_NEAR(image.depth[i] / scale / first.depth[i], 1, 1e-4);
      }
    }
    printf("scale %g: %zu pixels differ\n", scale, other);
    EXPECT_LE(other, 10u);
  }
}

// Turning model, camera and Sun together changes nothing.
TEST(Invariance, RotationOfEverything) {
  const pan::Model model = model_of(two_bodies());
  const View view = looking_from({1, 1, 1}, 20, 0.3, 128, 1);
  const image::Image first = rendered(model, view);
  const Quat turn = glm::angleAxis(2.1, glm::normalize(Vec3(3, -1, 2)));
  View turned = view;
  turned.world_from_model.rotation = turn;
  turned.camera.position = turn * view.camera.position;
  turned.camera.world_from_camera = turn * view.camera.world_from_camera;
  turned.to_sun = turn * view.to_sun;
  const image::Image image = rendered(model, turned);
  std::size_t other = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i)
    other += std::fabs(first.radiance[3 * i] - image.radiance[3 * i]) > 1e-6;
  EXPECT_LE(other, 10u);  // measured 2, on edges
}

// At 1 AU from the origin of the world, model and camera together: only their difference counts.
TEST(Invariance, FarFromTheOriginOfTheWorld) {
  const pan::Model model = model_of(two_bodies());
  const View view = looking_from({1, 1, 1}, 20, 0.3, 128, 1);
  const image::Image first = rendered(model, view);
  View far = view;
  const Vec3 offset(1.5e11, -2e10, 3e9);
  far.world_from_model.translation = offset;
  far.camera.position += offset;
  // the camera's place is rounded to 3e-5 m there; 20 m away that is below 0.02 pixel
  const image::Image image = rendered(model, far);
  EXPECT_LE(rms_difference(first.radiance, image.radiance), 2e-3);
  EXPECT_GT(rms_difference(first.radiance, image.radiance), 0);
}

// Mirroring model, camera axis and Sun mirrors the image.
TEST(Invariance, MirroredInstanceIsTheMirrorImage) {
  pan::Contents contents = two_bodies();
  const image::Image first =
      rendered(model_of(contents), looking_from({0, -1, 0}, 20, 0.3, 128, 1));
  contents.nodes[0].scale = {-1, 1, 1};
  View view = looking_from({0, -1, 0}, 20, 0.3, 128, 1);
  view.to_sun.x = -view.to_sun.x;
  for (const bool flat : {false, true}) {
    RenderOptions options;
    options.flat = flat;
    contents.nodes[0].scale = {1, 1, 1};
    const image::Image plain =
        rendered(model_of(contents), looking_from({0, -1, 0}, 20, 0.3, 128, 1), options);
    contents.nodes[0].scale = {-1, 1, 1};
    const image::Image image = rendered(model_of(contents), view, options);
    std::size_t other = 0;
    for (std::size_t y = 0; y < 128; ++y)
      for (std::size_t x = 0; x < 128; ++x)
        other += std::fabs(plain.radiance[3 * (y * 128 + x)] -
                           image.radiance[3 * (y * 128 + 127 - x)]) > 1e-6;
    EXPECT_LE(other, 20u);  // measured 4: ties of the grid go the other way
  }
}

// Two meshes that are the same body: moved by the node, or moved in the mesh itself.
// Instances of one mesh and material are drawn at once; where each has a material of its own, that
// says the same, one by one.
TEST(Invariance, InstancesDrawnAtOnceAreTheSameBits) {
  const auto crowd = [](bool at_once, bool cutout) {
    testing_support::Textured contents(single(box({0.3, 0.2, 0.1}), lambert(0.7)));
    contents.meshes.push_back(pan::packed(sphere(6, 9, true), "ball"));
    contents.instances.clear();
    contents.materials.assign(80, contents.materials.front());
    const std::int32_t holes = cutout ? contents.add(8, 8, false,
                                                     [](std::uint32_t x, std::uint32_t y) {
                                                       return grey(255, (x + y) % 3 == 0 ? 0 : 255);
                                                     })
                                      : -1;
    for (materials::Material& material : contents.materials) material.maps.cutout = holes;
    for (std::uint32_t i = 0; i < 80; ++i) {
      const double at = i;
      contents.nodes.push_back({"part" + std::to_string(i), 0,
                                Vec3(std::sin(at), std::cos(1.7 * at), std::sin(2.3 * at)),
                                glm::normalize(Quat(1, std::sin(3 * at), 0.2, std::cos(5 * at))),
                                i % 7 == 0 ? Vec3(-0.5, 0.4, 0.6) : Vec3(0.5)});
      // 5 of the balls are too few
      const std::uint32_t mesh = cutout || i % 16 == 0;
      contents.instances.push_back({i + 1, mesh, at_once ? 0 : i, -1});
    }
    return model_of(contents);
  };
  for (const bool cutout : {false, true}) {
    const pan::Model together = crowd(true, cutout);
    const pan::Model apart = crowd(false, cutout);
    for (const bool flat : {false, true}) {
      RenderOptions options;
      options.samples = 2;
      options.flat = flat;
      options.ground_truth = true;
      const View view = looking_from({1, 0.4, 0.3}, 8, 0.4, 128, 1);
      const image::Image a = rendered(together, view, options);
      const image::Image b = rendered(apart, view, options);
      EXPECT_TRUE(equal_bits(a.radiance, b.radiance)) << cutout << flat;
      EXPECT_TRUE(equal_bits(a.coverage, b.coverage)) << cutout << flat;
      EXPECT_TRUE(equal_bits(a.depth, b.depth)) << cutout << flat;
      EXPECT_TRUE(equal_bits(a.normal, b.normal)) << cutout << flat;
      EXPECT_EQ(a.node_id, b.node_id) << cutout << flat;
      std::size_t seen = 0;
      for (const float share : a.coverage) seen += share > 0;
      EXPECT_GT(seen, 1000u);
    }
  }
}

TEST(Invariance, NestedTransformsAreTheirProduct) {
  const Quat turn = glm::angleAxis(0.7, glm::normalize(Vec3(1, -1, 2)));
  pan::Contents nested = single(box({1, 2, 3}), lambert(1));
  nested.nodes.push_back({"a", 0, Vec3(1, 2, 3), turn, Vec3(2, 1, 0.5)});
  nested.nodes.push_back({"b", 1, Vec3(-1, 0, 1), glm::conjugate(turn), Vec3(1, 1, 2)});
  nested.instances[0].node = 2;
  const Mat4 matrix = matrix_from_trs({1, 2, 3}, turn, {2, 1, 0.5}) *
                      matrix_from_trs({-1, 0, 1}, glm::conjugate(turn), {1, 1, 2});
  geometry::Mesh mesh = box({1, 2, 3});
  for (Vec3& p : mesh.positions) p = Vec3(matrix * Vec4(p, 1));
  for (Vec3& n : mesh.normals) n = glm::normalize(glm::transpose(glm::inverse(Mat3(matrix))) * n);
  const View view = looking_from({1, 1, 1}, 30, 0.4, 128, 1);
  const image::Image a = rendered(model_of(nested), view);
  const image::Image b = rendered(model_of(single(mesh, lambert(1))), view);
  std::size_t other = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i)
    other += std::fabs(a.radiance[3 * i] - b.radiance[3 * i]) > 1e-6;
  EXPECT_LE(other, 10u);
  EXPECT_GT(intensity(a, view.camera, 30), 0.1);
}

// The mean over N×N samples closes in on the exact area: errors fall about as 1/N^1.5.
TEST(Samples, ConvergeToTheExactCoverage) {
  const pan::Model model = model_of(single(sphere(300, 300), lambert(1)));
  const double distance = 1e4;
  const double radius_px = 3.3;
  View view = looking_from({0, -1, 0}, distance, 2 * std::atan(16 / radius_px / distance), 32);
  view.camera.principal += Vec2(0.21, -0.37);
  const double disc = kPi * radius_px * radius_px;
  for (const auto& [samples, tolerance] :
       {std::pair{1u, 0.15}, {4u, 0.03}, {16u, 3e-3}, {64u, 5e-4}}) {
    RenderOptions options;
    options.samples = samples;
    const image::Image image = rendered(model, view, options);
    double area = 0;
    for (const float coverage : image.coverage) area += coverage;
    printf("samples %2u: area %+.2e\n", samples, area / disc - 1);
    EXPECT_LE(std::fabs(area / disc - 1), tolerance);
    // coverage is a mean of N² zeros and ones
    for (const float coverage : image.coverage) {
      const double count = static_cast<double>(coverage) * samples * samples;
      EXPECT_NEAR(count, std::round(count), 1e-3);
    }
  }
}

// Premultiplied: a pixel half covered has half the radiance.
TEST(Samples, RadianceIsPremultiplied) {
  const pan::Model model = model_of(single(plate(2, 2), lambert(1)));
  View view = looking_from({0, 0, 1}, 100, 0.05, 64);
  view.camera.position += view.camera.world_from_camera * Vec3(-1.0, 0, 0);
  RenderOptions options;
  options.samples = 8;
  const image::Image image = rendered(model, view, options);
  for (std::size_t i = 0; i < image.pixels(); ++i)
    EXPECT_NEAR(image.radiance[3 * i] * kPi, image.coverage[i], 3e-7);
}

TEST(Sun, IrradianceScalesAndNamesTheUnit) {
  const pan::Model model = model_of(single(plate(2, 2), lambert(1)));
  View view = looking_from({0, 0, 1}, 100, 0.01, 8);
  EXPECT_EQ(rendered(model, view).unit, "1/sr");
  view.sun_irradiance = Vec3(1361, 500, 2);
  const image::Image image = rendered(model, view);
  EXPECT_EQ(image.unit, "W/(m^2 sr)");
  EXPECT_NEAR(image.radiance[0] * kPi / 1361, 1, 3e-7);
  EXPECT_NEAR(image.radiance[1] * kPi / 500, 1, 3e-7);
  EXPECT_NEAR(image.radiance[2] * kPi / 2, 1, 3e-7);
}

}  // namespace
}  // namespace panwright::preview::invariance_test
