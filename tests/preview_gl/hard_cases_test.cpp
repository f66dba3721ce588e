// Cameras in awkward places, models of any size, textures, colours, and what is refused.
#include "models.h"

namespace panwright::preview::hard_cases_test {
namespace {

using namespace testing_support;

TEST(HardCases, EmptyModel) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  const pan::Model model = model_of(contents);
  DiagnosticLog log;
  support::ModelRenderer renderer(shared_device(), model);
  RenderOptions options;
  options.ground_truth = true;
  const auto image = renderer.render(looking_from({0, 0, 1}, 1, 0.5, 16), options, log);
  ASSERT_TRUE(image);
  EXPECT_TRUE(log.contains(Code("W5006")));
  expect_no_nan(*image);
  for (const float depth : image->depth) EXPECT_EQ(depth, INFINITY);
}

TEST(HardCases, NothingInViewSaysWhy) {
  const pan::Model model = model_of(single(sphere(8, 8), lambert(1)));
  DiagnosticLog log;
  support::ModelRenderer renderer(shared_device(), model);
  View view = looking_from({0, 0, 1}, 10, 0.5, 16);
  view.camera.world_from_camera =
      view.camera.world_from_camera * glm::angleAxis(kPi, Vec3(0, 1, 0));
  ASSERT_TRUE(renderer.render(view, {}, log));
  ASSERT_TRUE(log.contains(Code("W5006")));
  EXPECT_NE(log.entries()[0].message.find("no part of the model"), std::string::npos);
  // far smaller than a pixel, between the centres
  DiagnosticLog small;
  ASSERT_TRUE(renderer.render(looking_from({0, 0, 1}, 1e6, 0.5, 16), {}, small));
  ASSERT_TRUE(small.contains(Code("W5006")));
  EXPECT_NE(small.entries()[0].message.find("--samples"), std::string::npos);
}

// Inside a closed box nothing shows (its back faces are not drawn); inside an open one all does.
TEST(HardCases, CameraInside) {
  geometry::Mesh room = box({4, 4, 4});
  View view = looking_from({0, 0, 1}, 1, 2.5, 64);
  view.to_sun = {0, 0, 1};
  RenderOptions options;
  options.ground_truth = true;
  DiagnosticLog log;
  const pan::Model closed = model_of(single(room, lambert(1)));
  support::ModelRenderer renderer(shared_device(), closed);
  ASSERT_TRUE(renderer.render(view, options, log));
  EXPECT_TRUE(log.contains(Code("W5006")));

  room.closed = false;
  const image::Image image = rendered(model_of(single(room, lambert(1))), view, options);
  expect_no_nan(image);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    EXPECT_EQ(image.coverage[i], 1);
    EXPECT_GT(image.depth[i], 0);
    EXPECT_LE(image.depth[i], 3.000001f);
  }
  // straight ahead: the floor at z = -2, from z = 1
  EXPECT_NEAR(image.depth[32 * 64 + 32], 3, 1e-5);
}

// A plate that runs from behind the camera to the horizon.
TEST(HardCases, CrossingTheNearPlane) {
  for (const double size : {1e-5, 1.0, 1e6}) {
    pan::Contents contents = single(plate(2, 2), lambert(1));
    contents.nodes[0].scale = Vec3(size);
    const pan::Model model = model_of(contents);
    View view;
    set_field_of_view(view.camera, 64, 64, 1.2);
    view.camera.position = Vec3(0, 0, 1e-3 * size);
    DiagnosticLog log;
    view.camera.world_from_camera = *world::looking_at(
        view.camera.position, view.camera.position + Vec3(0, 1, 0) * size, {}, log);
    view.to_sun = {0, 0, 1};
    RenderOptions options;
    options.ground_truth = true;
    const image::Image image = rendered(model, view, options);
    expect_no_nan(image);
    for (std::uint32_t y = 0; y < 64; ++y) {
      const std::size_t pixel = std::size_t{y} * 64 + 31;
      const geometry::Ray ray = pixel_ray(view.camera, {31.5, y + 0.5});
      const double t = -view.camera.position.z / ray.direction.z;
      const bool hits = t > 0 && std::fabs((view.camera.position + t * ray.direction).y) < size;
      EXPECT_EQ(image.coverage[pixel], hits ? 1 : 0) << y;
      if (hits) {
        EXPECT_NEAR(image.range[pixel] / t, 1, 1e-4) << size << ' ' << y;
      }
    }
  }
}

TEST(HardCases, OnePixelAndOneRow) {
  const pan::Model model = model_of(single(sphere(50, 50), lambert(1)));
  for (const auto& [width, height] : {std::pair{1u, 1u}, {200u, 1u}, {1u, 300u}, {333u, 2u}}) {
    View view = looking_from({0, -1, 0}, 10, 0.5, 1);
    set_field_of_view(view.camera, width, height, 0.5 * std::min(1.0, width / 100.0));
    RenderOptions options;
    options.ground_truth = true;
    options.samples = 5;
    const image::Image image = rendered(model, view, options);
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
    expect_no_nan(image);
    EXPECT_GT(image.coverage[std::size_t{height / 2} * width + width / 2], 0);
  }
}

TEST(HardCases, ModelsOfAnySizeAtAnyDistance) {
  for (const double size : {1e-6, 1.0, 1e6})
    for (const double far : {2.5, 1e3, 1e8}) {
      pan::Contents contents = single(sphere(60, 60), lambert(1));
      contents.nodes[0].scale = Vec3(size);
      const double distance = size * far;
      const View view = looking_from({1, 2, -1}, distance, 2 * std::asin(1.2 / far), 200, 0.5);
      RenderOptions options;
      options.ground_truth = true;
      const image::Image image = rendered(model_of(contents), view, options);
      expect_no_nan(image);
      // the silhouette: a cone of half angle asin(R/d)
      const double radius = view.camera.focal.x * std::tan(std::asin(1 / far));
      double area = 0;
      for (const float coverage : image.coverage) area += coverage;
      // measured 1.5e-3 to 4e-3: an inscribed mesh and one sample a pixel
      EXPECT_NEAR(area / (kPi * radius * radius), 1, 8e-3) << size << ' ' << far;
      EXPECT_NEAR(image.depth[100 * 200 + 100] / (distance - size), 1, 1e-3) << size << ' ' << far;
    }
}

// A normal that points away from the camera at the limb still gets its light.
TEST(HardCases, NormalsThatFaceAwayFromTheCamera) {
  geometry::Mesh mesh = plate(2, 2);
  for (Vec3& n : mesh.normals) n = glm::normalize(Vec3(0.8, 0, -0.3));
  const pan::Model model = model_of(single(mesh, lambert(1)));
  View view = looking_from({0, 0, 1}, 100, 0.01, 8);
  view.to_sun = {1, 0, 0};
  const image::Image image = rendered(model, view);
  expect_no_nan(image);
  EXPECT_NEAR(image.radiance[0] * kPi, 0.8 / std::hypot(0.8, 0.3), 1e-6);
}

// Opposite normals meet in zero half way: dark there, and no NaN.
TEST(HardCases, NormalsThatCancel) {
  geometry::Mesh mesh = plate(2, 2);
  mesh.normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}, {0, 0, -1}};
  RenderOptions options;
  options.ground_truth = true;
  expect_no_nan(
      rendered(model_of(single(mesh, lambert(1))), looking_from({0, 0, 1}, 10, 0.1, 65), options));
}

TEST(Orthographic, PlateCoversItsArea) {
  const pan::Model model = model_of(single(plate(2, 1), lambert(0.5)));
  for (const double distance : {1.0, 1e8}) {
    View view = looking_from({0, 0, 1}, distance, 0.1, 8);
    const world::Camera placed = view.camera;
    set_orthographic(view.camera, 300, 200, 3);
    view.camera.position = placed.position;
    view.camera.world_from_camera = placed.world_from_camera;
    RenderOptions options;
    options.ground_truth = true;
    const image::Image image = rendered(model, view, options);
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
      sum += image.radiance[3 * i] * pixel_area(view.camera);
    EXPECT_NEAR(sum, 0.5 / kPi * 2, 1e-6);  // edges lie on pixel edges
    EXPECT_EQ(image.depth[100 * 300 + 150], static_cast<float>(distance));
    EXPECT_EQ(image.range[50 * 300 + 50],
              image.depth[50 * 300 + 50] == INFINITY ? INFINITY : static_cast<float>(distance));
  }
}

// ---- textures and colours

pan::Contents textured(const geometry::Mesh& mesh, std::vector<std::uint8_t>& rgba,
                       std::uint32_t width, std::uint32_t height, bool linear) {
  pan::Contents contents = single(mesh, lambert(1));
  pan::TextureContent texture;
  texture.name = "picture";
  texture.width = width;
  texture.height = height;
  texture.linear = linear;
  texture.rgba = rgba;
  contents.textures.push_back(texture);
  contents.instances[0].texture = 0;
  return contents;
}

TEST(Textures, LieTheRightWayUp) {
  // red, green / blue, white: the image as a person sees it
  std::vector<std::uint8_t> rgba{255, 0, 0,   255, 0,   255, 0,   255,
                                 0,   0, 255, 255, 255, 255, 255, 255};
  const pan::Model model = model_of(textured(plate(2, 2), rgba, 2, 2, true));
  View view = looking_from({0, 0, 1}, 100, 2 * std::atan(0.01), 64);
  DiagnosticLog log;
  view.camera.world_from_camera =
      *world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log);
  view.to_sun = {0, 0, 1};
  const image::Image image = rendered(model, view);
  const auto at = [&](std::size_t x, std::size_t y) {
    const float* p = &image.radiance[3 * (y * 64 + x)];
    return Vec3(p[0], p[1], p[2]) * kPi;
  };
  // half a pixel off the texels' centres: 1/64 of each neighbour
  EXPECT_LE(glm::length(at(16, 16) - Vec3(1, 0, 0)), 0.05);
  EXPECT_LE(glm::length(at(48, 16) - Vec3(0, 1, 0)), 0.05);
  EXPECT_LE(glm::length(at(16, 48) - Vec3(0, 0, 1)), 0.05);
  EXPECT_LE(glm::length(at(48, 48) - Vec3(1, 1, 1)), 0.05);
}

TEST(Textures, AreDecodedFromSrgbExactly) {
  for (const bool linear : {false, true})
    for (const std::uint8_t code : {1, 13, 77, 128, 200, 255}) {
      std::vector<std::uint8_t> rgba(4 * 8 * 8, code);
      const pan::Model model = model_of(textured(plate(2, 2), rgba, 8, 8, linear));
      const View view = looking_from({0, 0, 1}, 100, 0.01, 4);
      const double exact = linear ? code / 255.0 : image::srgb_decoded(code);
      EXPECT_NEAR(rendered(model, view).radiance[0] * kPi / exact, 1, 4e-7) << int{code};
    }
}

// Far away, a texture is its mean in linear light, whatever its sides.
TEST(Textures, FarAwayTheyAreTheirMean) {
  for (const auto& [width, height] : {std::pair{64u, 64u}, {127u, 33u}}) {
    std::vector<std::uint8_t> rgba;
    double mean = 0;
    for (std::uint32_t i = 0; i < width * height; ++i) {
      const auto code = static_cast<std::uint8_t>((i * 2654435761u) >> 24);
      for (int k = 0; k < 4; ++k) rgba.push_back(code);
      mean += image::srgb_decoded(code) / (width * height);
    }
    const pan::Model model = model_of(textured(plate(2, 2), rgba, width, height, false));
    const View view = looking_from({0, 0, 1}, 1e4, 2 * std::atan(1e-4), 1);  // one pixel
    EXPECT_NEAR(rendered(model, view).radiance[0] * kPi / mean, 1, 2e-3);
  }
}

// A sphere's texture has no seam: a constant texture gives the untextured image.
TEST(Textures, NoSeamOnASphere) {
  std::vector<std::uint8_t> rgba(4 * 32 * 16, 255);
  const pan::Model with = model_of(textured(sphere(40, 40, true), rgba, 32, 16, true));
  const pan::Model without = model_of(single(sphere(40, 40, true), lambert(1)));
  const View view = looking_from({-1, 0.1, 0.3}, 10, 0.3, 128, 0.6);
  const image::Image a = rendered(with, view);
  const image::Image b = rendered(without, view);
  for (std::size_t i = 0; i < a.radiance.size(); ++i)
    EXPECT_NEAR(a.radiance[i], b.radiance[i], 1e-6);
}

TEST(Colours, MultiplyTheDiffuseColor) {
  geometry::Mesh mesh = plate(2, 2);
  mesh.colors = {{1, 0, 0.5}, {0, 1, 0.5}, {0, 1, 0.5}, {1, 0, 0.5}};  // along x
  const pan::Model model = model_of(single(mesh, lambert(0.5)));
  View view = looking_from({0, 0, 1}, 1e4, 2 * std::atan(1e-4), 64);
  DiagnosticLog log;
  view.camera.world_from_camera =
      *world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log);
  view.to_sun = {0, 0, 1};
  const image::Image image = rendered(model, view);
  for (std::size_t x = 0; x < 64; ++x) {
    const float* p = &image.radiance[3 * (32 * 64 + x)];
    const double share = (static_cast<double>(x) + 0.5) / 64;
    EXPECT_NEAR(p[0] * kPi, 0.5 * (1 - share), 1e-5);
    EXPECT_NEAR(p[1] * kPi, 0.5 * share, 1e-5);
    EXPECT_NEAR(p[2] * kPi, 0.25, 1e-6);
  }
}

// ---- refused

TEST(Refused, ImagesOverTheLimits) {
  const pan::Model model = model_of(single(sphere(8, 8), lambert(1)));
  DiagnosticLog log;
  support::ModelRenderer renderer(shared_device(), model);
  View view = looking_from({0, 0, 1}, 10, 0.5, 16);
  view.camera.width = 16385;
  EXPECT_FALSE(renderer.render(view, {}, log));
  view.camera.width = 1000;
  view.camera.height = 1000;
  RenderOptions options;
  options.max_bytes = 1000 * 1000 * 16 - 1;
  EXPECT_FALSE(renderer.render(view, options, log));
  EXPECT_EQ(log.errors(), 2u);
  EXPECT_TRUE(log.contains(Code("E5003")));
}

}  // namespace
}  // namespace panwright::preview::hard_cases_test
