// Shadows in models and worlds that are wide beside what a camera sees of them, against the
// reference renderer.
#include "models.h"
#include "preview/reference/reference.h"

namespace panwright::preview {
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
  EXPECT_FALSE(log.contains(Code::W5012)) << to_text(log);
}

}  // namespace
}  // namespace panwright::preview
