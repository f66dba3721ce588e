// Shadows in models and worlds that are wide beside what a camera sees of them, against the
// reference renderer.
#include "models.h"
#include "preview/reference/reference.h"

namespace panwright::preview::wide_test {
namespace {

using namespace testing_support;

// A cube of 10 cm stands on a plate.
pan::Contents cube_on_plate(double plate_side) {
  pan::Contents contents = single(plate(plate_side, plate_side), lambert(0.8));
  contents.meshes.push_back(pan::packed(box(Vec3(0.1)), "cube"));
  contents.nodes.push_back({"cube", 0, Vec3(0, 0, 0.05), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({1, 1, 0, -1});
  return contents;
}

void add_boxes(pan::Contents& contents, double away) {
  contents.meshes.push_back(pan::packed(box(Vec3(0.5)), "box"));
  for (const double side : {-1.0, 1.0}) {
    contents.nodes.push_back({"box", 0, Vec3(side * away, 0, 0), Quat(1, 0, 0, 0), Vec3(1)});
    contents.instances.push_back({static_cast<std::uint32_t>(contents.nodes.size() - 1),
                                  static_cast<std::uint32_t>(contents.meshes.size() - 1), 0, -1});
  }
}

View close_by(std::uint32_t pixels) {
  DiagnosticLog log;
  View view;
  set_field_of_view(view.camera, pixels, pixels, 25 * kDegree);
  view.camera.position = {0.3, -0.9, 0.8};
  view.camera.world_from_camera =
      *world::looking_at(view.camera.position, {0.05, 0.02, 0}, {}, log);
  view.to_sun = {-1, -0.4, 1.1};
  return view;
}

struct Errors {
  double flux = 0;  // relative
  double rmse = 0;  // of the image, over its RMS
  std::uint64_t maps = 0;
};

Errors errors(const pan::Contents& contents, const View& view, DiagnosticLog& log,
              RenderOptions options = {}) {
  const auto model = std::make_shared<const pan::Model>(model_of(contents));
  world::World world = world_of(model, {});
  set_view(world, view);
  options.samples = 4;
  Renderer renderer(shared_device());
  const auto drawn = renderer.render(world, view.camera, options, log);
  EXPECT_TRUE(drawn) << to_text(log);
  expect_no_nan(*drawn);
  ReferenceOptions exact;
  exact.bounces = 0;
  exact.sun_disc = false;
  exact.samples = 64;
  Reference reference;
  const auto truth = reference.render(world, view.camera, exact, log);
  EXPECT_TRUE(truth) << to_text(log);
  double sum = 0;
  double off = 0;
  double square = 0;
  double square_off = 0;
  for (std::size_t i = 0; i < drawn->radiance.size(); ++i) {
    const double t = truth->image.radiance[i];
    const double d = drawn->radiance[i] - t;
    sum += t;
    off += d;
    square += t * t;
    square_off += d * d;
  }
  return {std::fabs(off / sum), std::sqrt(square_off / square), renderer.counts().shadow_maps};
}

// The shadow of the cube is that of the cube and the plate alone, however far parts stand off.
TEST(WideModels, FarPartsLeaveAShadowAsItIs) {
  const View view = close_by(160);
  DiagnosticLog log;
  const Errors alone = errors(cube_on_plate(1), view, log);
  printf("alone: flux %.2e, RMSE %.2e\n", alone.flux, alone.rmse);
  for (const double away : {100.0, 1e3, 1e4}) {
    pan::Contents contents = cube_on_plate(1);
    add_boxes(contents, away);
    const Errors found = errors(contents, view, log);
    printf("%g m: flux %.2e, RMSE %.2e\n", away, found.flux, found.rmse);
    EXPECT_LE(found.flux, 1e-3);
    EXPECT_LE(found.rmse, 0.02);
  }
  EXPECT_FALSE(log.contains(Code("W5012"))) << to_text(log);
}

// One plate of which the camera sees a part.
TEST(WideModels, AWidePartLeavesAShadowAsItIs) {
  const View view = close_by(160);
  DiagnosticLog log;
  for (const double side : {20.0, 200.0, 2000.0}) {
    const Errors found = errors(cube_on_plate(side), view, log);
    printf("a plate of %g m: flux %.2e, RMSE %.2e\n", side, found.flux, found.rmse);
    EXPECT_LE(found.flux, 1e-3);
    EXPECT_LE(found.rmse, 0.02);
  }
  EXPECT_FALSE(log.contains(Code("W5012"))) << to_text(log);
}

// Along a truss from its near end: pixels span 1 mm there and 10 cm at the other one.
TEST(WideModels, ALongTruss) {
  pan::Contents contents = single(plate(1, 120), lambert(0.8));
  contents.meshes.push_back(pan::packed(box({0.05, 0.05, 0.6}), "post"));
  contents.meshes.push_back(pan::packed(box({0.05, 118, 0.05}), "rail"));
  contents.nodes.push_back({"rail", 0, Vec3(0.2, 0, 0.6), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({1, 2, 0, -1});
  for (int i = 0; i < 60; ++i) {
    contents.nodes.push_back({"post", 0, Vec3(0.2, 2 * i - 58.7, 0.3), Quat(1, 0, 0, 0), Vec3(1)});
    contents.instances.push_back({static_cast<std::uint32_t>(contents.nodes.size() - 1), 1, 0, -1});
  }
  DiagnosticLog log;
  View view;
  set_field_of_view(view.camera, 200, 200, 40 * kDegree);
  view.camera.position = {-0.6, -60, 0.9};
  view.camera.world_from_camera = *world::looking_at(view.camera.position, {0, -57, 0.1}, {}, log);
  view.to_sun = {1, -0.6, 0.8};
  RenderOptions options;
  options.shadow_side = 512;
  const Errors found = errors(contents, view, log, options);
  printf("truss: flux %.2e, RMSE %.2e\n", found.flux, found.rmse);
  EXPECT_LE(found.flux, 2e-3);
  EXPECT_LE(found.rmse, 0.03);
  EXPECT_FALSE(log.contains(Code("W5012"))) << to_text(log);
}

// Lit ground is lit, however much wider than the view it is and however many points the Sun has:
// exactly 1, a closed form. A camera 9 cm above a plate of 30 m lost 1/16.
TEST(WideModels, LitGroundStaysLit) {
  DiagnosticLog log;
  double worst = 0;
  for (const double ratio : {10.0, 2e3, 1e5, 1e6}) {
    const pan::Model model = model_of(single(plate(ratio, ratio), lambert(0.5)));
    support::ModelRenderer renderer(shared_device(), model);
    for (const double tilt : {30.0, 80.0})
      for (const unsigned points : {1u, 16u, 64u, 256u}) {
        View view;
        view.to_sun = {std::sin(tilt * kDegree), 0.1, std::cos(tilt * kDegree)};
        world::set_orthographic(view.camera, 32, 32, 1);
        view.camera.position = {0.21 * ratio, -0.13 * ratio, 3};
        view.camera.world_from_camera = *world::looking_at(
            view.camera.position, view.camera.position - Vec3(0, 0, 1), Vec3(0, 1, 0), log);
        RenderOptions options;
        options.shadow_side = 256;
        options.shadows = points > 1 ? Shadows::soft : Shadows::hard;
        options.sun_points = std::max(points, 2u);
        const auto image = renderer.render(view, options, log);
        ASSERT_TRUE(image) << to_text(log);
        const double lit = 0.5 / kPi * glm::normalize(view.to_sun).z;
        for (std::size_t i = 0; i < image->pixels(); ++i)
          worst = std::max(worst, std::fabs(image->radiance[3 * i] / lit - 1));
      }
  }
  printf("lit ground: %.1e at most\n", worst);
  EXPECT_LE(worst, 1e-5);
}

// Single precision places no triangle of 40 km to a millimetre: the image says so.
TEST(WideModels, WhatIsTooCoarseIsSaid) {
  const View view = close_by(160);
  DiagnosticLog log;
  errors(cube_on_plate(4e4), view, log);
  EXPECT_TRUE(log.contains(Code("W5012"))) << to_text(log);
  // and what helps: more texels do not
  EXPECT_NE(to_text(log).find("single precision"), std::string::npos) << to_text(log);
  EXPECT_EQ(to_text(log).find("--shadow-side"), std::string::npos) << to_text(log);
  // so it is where memory ends
  RenderOptions options;
  options.shadow_side = 64;
  options.max_shadow_bytes = 0;
  DiagnosticLog small;
  errors(cube_on_plate(20), view, small, options);
  EXPECT_TRUE(small.contains(Code("W5012"))) << to_text(small);
  EXPECT_NE(to_text(small).find("a larger --shadow-side"), std::string::npos) << to_text(small);
  printf("%s", to_text(small).c_str());
}

// A view that changes nothing draws no map, one close by draws its own.
TEST(WideModels, MapsAreKept) {
  pan::Contents contents = cube_on_plate(1);
  add_boxes(contents, 100);
  const pan::Model model = model_of(contents);
  support::ModelRenderer renderer(shared_device(), model);
  DiagnosticLog log;
  View view = close_by(100);
  const auto maps = [&] {
    EXPECT_TRUE(renderer.render(view, {}, log)) << to_text(log);
    return renderer.renderer().counts().shadow_maps;
  };
  EXPECT_EQ(maps(), 1u);
  EXPECT_EQ(maps(), 1u);
  const auto before = shared_device()->counts();
  EXPECT_EQ(maps(), 1u);
  EXPECT_EQ(shared_device()->counts().allocations, before.allocations);
  view.camera.position.x += 1e-5;  // tiles stay where they are
  EXPECT_EQ(maps(), 1u);
  view.camera.position.z += 0.5;
  EXPECT_EQ(maps(), 2u);
  const image::Image last = *renderer.render(view, {}, log);
  EXPECT_EQ(last.radiance, rendered(model, view).radiance);
}

}  // namespace
}  // namespace panwright::preview::wide_test
