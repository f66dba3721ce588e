// What must not break: empty scenes, cameras inside, mirrored and flattened placements, triangles
// without area, great distances, small parts of large scenes.
#include <limits>

#include "base/parallel.h"
#include "reference_models.h"

namespace panwright::preview::hard_cases_test {
namespace {

using namespace testing_support;
using panwright::testing_support::world_of;

void expect_sound(const ReferenceImage& result) {
  expect_no_nan(result.image);
  std::size_t bad = 0;
  for (const float value : result.standard_error) bad += !(value >= 0 && std::isfinite(value));
  EXPECT_EQ(bad, 0u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(std::isfinite(result.flux[k]) && result.flux[k] >= 0);
    EXPECT_TRUE(std::isfinite(result.flux_error[k]) && result.flux_error[k] >= 0);
  }
}

TEST(ReferenceHardCases, NothingInView) {
  const pan::Model model = model_of(single(sphere(8, 8), lambert(1)));
  View view = looking_from({0, -1, 0}, 10, 0.1, 8);
  view.camera.world_from_camera =
      view.camera.world_from_camera * glm::angleAxis(2.0, Vec3(0, 1, 0));
  DiagnosticLog log;
  Reference reference;
  ReferenceOptions options;
  options.ground_truth = true;
  options.until_error = 0.01;
  const auto result = reference.render(world_of(model, view), view.camera, options, log);
  ASSERT_TRUE(result);
  EXPECT_TRUE(log.contains(Code("W5006")));
  EXPECT_EQ(result->flux, Vec3(0));
  EXPECT_EQ(result->camera_rays, 0u);
  expect_sound(*result);
}

TEST(ReferenceHardCases, ModelWithoutInstances) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  const pan::Model model = model_of(contents);
  const ReferenceImage result = traced(model, looking_from({0, -1, 0}, 10, 0.1, 8));
  EXPECT_EQ(result.flux, Vec3(0));
  expect_sound(result);
}

// A closed mesh shows its outside only; an open box shows its inside, too.
TEST(ReferenceHardCases, CameraInside) {
  geometry::Mesh mesh = box({2, 2, 2});
  for (const bool closed : {true, false}) {
    mesh.closed = closed;
    const pan::Model model = model_of(single(mesh, lambert(0.5)));
    View view = looking_from({0.2, -0.7, 0.1}, 0.5, 1.5, 16, 30 * kDegree);
    ReferenceOptions options;
    options.ground_truth = true;
    const ReferenceImage result = traced(model, view, options);
    const float covered = result.image.coverage[8 * 16 + 8];
    EXPECT_EQ(covered, closed ? 0 : 1);
    // no light gets in
    EXPECT_EQ(result.flux, Vec3(0));
    EXPECT_EQ(std::isfinite(result.image.depth[8 * 16 + 8]), !closed);
    expect_sound(result);
  }
}

TEST(ReferenceHardCases, UntilErrorOutOfReachIsSaid) {
  const pan::Model model = model_of(single(sphere(16, 16), lambert(1)));
  DiagnosticLog log;
  Reference reference;
  ReferenceOptions options;
  options.until_error = 1e-9;
  options.max_samples = 2000;
  const View view = looking_from({0, -1, 0}, 10, 0.5, 8);
  const auto result = reference.render(world_of(model, view), view.camera, options, log);
  ASSERT_TRUE(result);
  EXPECT_TRUE(log.contains(Code("W5008"))) << to_text(log);
  EXPECT_LE(result->samples, 2000u * 64);
}

TEST(ReferenceHardCases, TooLargeImagesAreRefused) {
  const pan::Model model = model_of(single(sphere(16, 16), lambert(1)));
  DiagnosticLog log;
  Reference reference;
  ReferenceOptions options;
  options.max_bytes = 1 << 16;
  const View view = looking_from({0, -1, 0}, 10, 0.2, 256);
  EXPECT_FALSE(reference.render(world_of(model, view), view.camera, options, log));
  EXPECT_TRUE(log.contains(Code("E5003")));
}

// Placements that mirror, stretch and all but flatten: a box as its axes' products say.
TEST(ReferenceHardCases, PlacementsKeepTheirAreas) {
  for (const Vec3& scale :
       {Vec3(-1, 1, 1), Vec3(1, -2, 0.5), Vec3(1e-3, 1, 1), Vec3(1, 1, 1e-9), Vec3(-1, -1, -1)}) {
    pan::Contents contents = single(box({1, 1, 1}), lambert(0.5));
    contents.nodes.push_back({"scaled", 0, Vec3(0.1, 0, 0), Quat(1, 0, 0, 0), scale});
    contents.instances[0].node = 1;
    const pan::Model model = model_of(contents);
    View view = looking_from({0, 0, 1}, 10, 0.1, 32);
    view.camera.projection = world::Projection::orthographic;
    view.camera.focal = Vec2(10);
    view.to_sun = {0.6, 0, 0.8};
    ReferenceOptions options;
    options.sun_disc = false;
    options.until_error = 1e-3;
    const ReferenceImage result = traced(model, view, options);
    // from above: the top alone, lit at 0.8
    const double exact = std::fabs(scale.x * scale.y) * 0.5 / kPi * 0.8;
    EXPECT_NEAR(result.flux.x / exact, 1, 4e-3) << scale.x << " " << scale.y << " " << scale.z;
    expect_sound(result);
  }
}

TEST(ReferenceHardCases, TrianglesWithoutAreaAndOddNormals) {
  geometry::Mesh mesh = plate(1, 1);
  mesh.positions.push_back({0, 0, 0});
  mesh.normals.push_back({0, 0, 1});
  mesh.texcoords.push_back({0, 0});
  mesh.triangles.push_back({0, 0, 4});
  mesh.triangles.push_back({0, 4, 2});  // on the diagonal: a line
  mesh.triangles.push_back({4, 4, 4});
  const pan::Model model = model_of(single(mesh, lambert(1)));
  for (const double tilt : {0.0, 0.5, 1.0}) {
    View view = looking_from({std::sin(tilt), 0.2, std::cos(tilt)}, 20, 0.1, 32);
    view.to_sun = {0, 0, 1};
    ReferenceOptions options;
    options.ground_truth = true;
    expect_sound(traced(model, view, options));
  }
  // edge on, and from the plane of the plate
  View view = looking_from({1, 0, 0}, 3, 0.5, 16);
  expect_sound(traced(model, view));
}

// The same image from 10 to 1e8 radii away, where floats of the world hold 8 m steps.
TEST(ReferenceHardCases, DistanceCostsNothing) {
  const pan::Model model = model_of(single(sphere(100, 100), lambert(1)));
  double first = 0;
  for (const double distance : {1e4, 1e6, 1e8}) {
    View view = looking_from({1, -2, 0.5}, distance, 0.1, 64, 60 * kDegree);
    view.camera.focal = Vec2(28 * distance);
    ReferenceOptions options = direct_light(64);
    options.ground_truth = true;
    const ReferenceImage result = traced(model, view, options);
    const double value = result.flux.x * distance * distance;
    if (first == 0) first = value;
    // 3e-5 of it is the finite distance of the first
    EXPECT_NEAR(value / first, 1, 5 * result.flux_error.x / result.flux.x + 1e-4) << distance;
    // the nearest point of the sphere, to what a float of the distance holds
    const double range = result.image.range[32 * 64 + 32];
    EXPECT_NEAR(range, distance - 1, 1e-7 * distance + 1e-2);
    expect_sound(result);
  }
  // large translations of both cancel
  View view = looking_from({1, -2, 0.5}, 1e4, 0.1, 64, 60 * kDegree);
  view.camera.focal = Vec2(28e4);
  const Vec3 far(1.5e11, -3e10, 7e9);
  view.camera.position += far;
  view.world_from_model.translation = far;
  const ReferenceImage moved = traced(model, view, direct_light(64));
  EXPECT_NEAR(moved.flux.x * 1e8 / first, 1, 1e-3);
}

// A thumb-sized part beside a panel a thousand kilometres away, one model.
TEST(ReferenceHardCases, SmallPartsOfLargeScenes) {
  pan::Contents contents = single(sphere(60, 60), lambert(0.9));
  contents.nodes.push_back({"small", 0, Vec3(0), Quat(1, 0, 0, 0), Vec3(1e-2)});
  contents.nodes.push_back({"far", 0, Vec3(0, 1e6, 0), Quat(1, 0, 0, 0), Vec3(1e3)});
  contents.instances[0].node = 1;
  contents.instances.push_back({2, 0, 0, -1});
  const pan::Model model = model_of(contents);
  View view = looking_from({1, 0, 0}, 1, 0.03, 64, 60 * kDegree);
  const ReferenceImage result = traced(model, view, direct_light(64));
  pan::Contents alone = single(sphere(60, 60), lambert(0.9));
  const pan::Model unit = model_of(alone);
  View scaled = looking_from({1, 0, 0}, 100, 0.03, 64, 60 * kDegree);
  const ReferenceImage same = traced(unit, scaled, direct_light(64));
  double worst = 0;
  for (std::size_t i = 0; i < same.image.radiance.size(); ++i)
    worst = std::max(
        worst, std::fabs(static_cast<double>(same.image.radiance[i]) - result.image.radiance[i]));
  // samples within rounding of an outline may fall on either side of it
  EXPECT_LE(worst, 0.02);
  EXPECT_NEAR(result.flux.x / same.flux.x, 1, 1e-5);
}

TEST(ReferenceHardCases, ManyInstancesOfOneMesh) {
  pan::Contents contents = single(sphere(16, 16), lambert(0.8));
  contents.instances.clear();
  for (int i = 0; i < 1000; ++i) {
    contents.nodes.push_back(
        {"n", 0, Vec3(3 * (i % 10), 3 * (i / 10 % 10), 3 * (i / 100)), Quat(1, 0, 0, 0), Vec3(1)});
    contents.instances.push_back({static_cast<std::uint32_t>(i + 1), 0, 0, -1});
  }
  const pan::Model model = model_of(contents);
  View view = looking_from({0.3, -1, 0.4}, 200, 0.3, 64, 40 * kDegree);
  view.camera.position += Vec3(13.5);
  ReferenceOptions options;
  options.ground_truth = true;
  const ReferenceImage result = traced(model, view, options);
  EXPECT_GT(result.flux.x, 0);
  std::uint32_t most = 0;
  for (const std::uint32_t id : result.image.node_id) most = std::max(most, id);
  EXPECT_GT(most, 500u);
  expect_sound(result);
}

// The faceted terminator: with shading normals nothing but the shape itself makes shadows.
TEST(ReferenceHardCases, NoShadowsOfFacetsOnASmoothSphere) {
  const geometry::Mesh mesh = sphere(24, 24);
  const pan::Model model = model_of(single(mesh, lambert(1)));
  const View view = looking_from({0, -1, 0}, 100, 0.021, 128, 90 * kDegree);
  ReferenceOptions options = direct_light(64);
  options.ground_truth = true;
  const ReferenceImage result = traced(model, view, options);
  const Vec3 to_sun = glm::normalize(view.to_sun);
  std::size_t lit = 0, dark = 0;
  for (std::size_t i = 0; i < result.image.pixels(); ++i) {
    if (result.image.coverage[i] < 1) continue;
    const float* n = &result.image.normal[3 * i];
    const double cosine = glm::dot(Vec3(n[0], n[1], n[2]), to_sun);
    if (cosine < 0.05) continue;
    ++lit;
    // the centre's cosine stands for the pixel's to a few hundredths at the rim
    dark += result.image.radiance[3 * i] * kPi < cosine - 0.05;
  }
  EXPECT_GT(lit, 4000u);
  EXPECT_EQ(dark, 0u);
}

TEST(ReferenceHardCases, ExtremeOptions) {
  const pan::Model model = model_of(single(sphere(12, 12), lambert(1)));
  ReferenceOptions options;
  options.samples = 8;
  options.bounces = 1000;
  options.seed = std::numeric_limits<std::uint64_t>::max();
  options.psf_sigma = 40;
  View view = looking_from({0, -1, 0}, 3, 1, 8, 60 * kDegree);
  for (const double distance : {1e-3, 1.0, 1e6}) {
    view.sun_distance = distance;
    view.to_sun = Vec3(1e-300, -1e-300, 0);
    view.sun_irradiance = Vec3(1e-30, 1361, 0);
    expect_sound(traced(model, view, options, 1));
  }
}

}  // namespace
}  // namespace panwright::preview::hard_cases_test
