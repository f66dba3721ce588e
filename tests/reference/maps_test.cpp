// Images on surfaces, on plates seen straight from above.
#include "reference_models.h"
#include "tests/preview_gl/textured.h"

namespace panwright::preview::maps_test {
namespace {

using namespace testing_support;

constexpr std::uint32_t kSide = 32;  // pixels across a plate of 1 m

TEST(ReferenceMaps, AlbedoMapsKeepTheirMean) {
  Textured contents(single(plate(1, 1), lambert(0.8)));
  contents.materials[0].maps.albedo = contents.add(
      4, 4, true, [](std::uint32_t x, std::uint32_t) { return grey(x % 2 ? 255 : 0); });
  const ReferenceImage result = traced(model_of(contents), above(kSide, 1), direct_light(64));
  // bilinear between stripes: half of the colour, on the mean
  EXPECT_NEAR(result.flux.x * kPi, 0.4, 5 * kPi * result.flux_error.x + 1e-6);
  expect_no_nan(result.image);
}

TEST(ReferenceMaps, HolesAreSeenAndLitThrough) {
  Textured contents(single(plate(1, 1), lambert(0.8)));
  contents.materials[0].maps.cutout = contents.add(
      4, 4, true, [](std::uint32_t x, std::uint32_t) { return grey(255, x < 2 ? 255 : 0); });
  ReferenceImage result = traced(model_of(contents), above(kSide, 1), direct_light(64));
  double covered = 0;
  for (const float c : result.image.coverage) covered += c;
  EXPECT_NEAR(covered / (kSide * kSide), 0.5, 2e-3);
  EXPECT_NEAR(result.flux.x * kPi, 0.4, 2e-3);
  // a whole plate below shows through the holes, and the light that falls through them
  contents.nodes.push_back({"below", 0, Vec3(0, 0, -0.5), Quat(1, 0, 0, 0), Vec3(1)});
  contents.materials.push_back(lambert(0.8));
  contents.instances.push_back({1, 0, 1, -1});
  result = traced(model_of(contents), above(kSide, 1), direct_light(64));
  EXPECT_NEAR(result.flux.x * kPi, 0.8, 1e-6);
}

TEST(ReferenceMaps, NormalMapsTilt) {
  Textured contents(single(plate(1, 1), lambert(1)));
  // (0.6, 0, 0.8) as codes
  contents.materials[0].maps.normal = contents.add(2, 2, true, [](std::uint32_t, std::uint32_t) {
    return Texel{204, 128, 230, 255};
  });
  const double x = 2 * 204 / 255.0 - 1, y = 2 * 128 / 255.0 - 1, z = 2 * 230 / 255.0 - 1;
  const Vec3 normal = glm::normalize(Vec3(x, y, z));
  for (const Vec3& sun : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8), Vec3(-0.6, 0.5, 0.6)}) {
    const ReferenceImage result =
        traced(model_of(contents), above(kSide, 1, sun), direct_light(32));
    EXPECT_NEAR(result.flux.x * kPi, std::max(0.0, glm::dot(normal, glm::normalize(sun))), 1e-6);
  }
}

// Cells of a plate of 1 m: gaps of 19 %, grid lines on an eighth of what is left.
materials::Material solar_cells() {
  materials::Material material = lambert(0.4);
  material.cells = materials::Cells{.count = {4, 4},
                                    .gap = {0.1, 0.1},
                                    .fingers = 8,
                                    .finger_width = 0.125,
                                    .gap_color = Vec3(0.2),
                                    .finger_color = Vec3(0.8)};
  return material;
}

TEST(ReferenceMaps, GapsDoNotEmit) {
  materials::Material material = solar_cells();
  material.weights = {0, 0, 1};
  material.emissive = Vec3(0.5);
  material.cells->gap_color = Vec3(0);
  material.cells->finger_color = Vec3(0);
  const ReferenceImage result =
      traced(model_of(single(plate(1, 1), material)), above(kSide, 1), direct_light(256));
  EXPECT_NEAR(result.flux.x * kPi, 0.5 * 0.81, 5e-4);  // measured 2.2e-4
}

// A decal covers cells and grid lines, and leaves gaps; beside it everything is as it was.
TEST(ReferenceMaps, DecalsLieOverCellsOnly) {
  Textured contents(single(plate(1, 1), solar_cells()));
  const double plain = 0.81 * (0.875 * 0.4 + 0.125 * 0.8) + 0.19 * 0.2;
  const auto flux = [&] {
    return traced(model_of(contents), above(kSide, 1), direct_light(256)).flux.x * kPi;
  };
  EXPECT_NEAR(flux(), plain, 5e-4);  // measured 2.2e-4
  pan::DecalContent decal;
  decal.name = "decal";
  decal.width = 2;
  decal.height = 2;
  decal.depth = 0.1;
  decal.texture =
      contents.add(2, 2, true, [](std::uint32_t, std::uint32_t) { return grey(255, 0); });
  contents.decals = {decal};
  EXPECT_NEAR(flux(), plain, 5e-4);  // one that shows nothing
  contents.decals[0].texture =
      contents.add(2, 2, true, [](std::uint32_t, std::uint32_t) { return grey(0, 255); });
  EXPECT_NEAR(flux(), 0.19 * 0.2, 5e-4);  // measured 9e-5
}

// Where surfaces of two targets coincide, the first is seen, and a decal of the other does not
// show.
TEST(ReferenceMaps, DecalsOfWhatIsNotSeenDoNotShow) {
  Textured contents(single(plate(1, 1), lambert(0.75)));
  contents.add(2, 2, false, [](std::uint32_t, std::uint32_t) { return grey(0, 255); });
  pan::DecalContent decal;
  decal.name = "decal";
  decal.width = decal.height = 2;
  decal.depth = 0.1;
  contents.decals = {decal};
  const auto marked = std::make_shared<const pan::Model>(model_of(contents));
  const auto bare =
      std::make_shared<const pan::Model>(model_of(single(plate(1, 1), lambert(0.25))));
  const View view = above(kSide, 1);
  for (const bool marked_first : {false, true}) {
    world::World world;
    DiagnosticLog log;
    ASSERT_TRUE(world.add("a", marked_first ? marked : bare, {}, log));
    ASSERT_TRUE(world.add("b", marked_first ? bare : marked, {}, log));
    world::Sun sun;
    sun.direction = view.to_sun;
    world.set_sun(sun);
    const ReferenceImage result = traced(world, view.camera, direct_light(16));
    EXPECT_NEAR(result.flux.x * kPi, marked_first ? 0 : 0.25, 1e-6);
  }
}

}  // namespace
}  // namespace panwright::preview::maps_test
