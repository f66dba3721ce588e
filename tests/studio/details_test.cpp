// Levels of detail, triangles and errors of the parts of a view.
#include "studio/details.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compiler/compile.h"
#include "pxn/pxn.h"

namespace panwright::studio {
namespace {

world::World details_world(const std::string& body) {
  const std::vector<pxn::MemoryFile> files = {
      {"a.pxn", "<pangu_model ver=\"1\">" + body + "</pangu_model>"}};
  DiagnosticLog log;
  const auto scene = pxn::read_memory(files, {}, log);
  const auto bytes =
      scene ? compiler::compiled(*scene, {}, log) : Result<std::vector<std::byte>>(failed);
  auto model = bytes ? pan::Model::from_bytes(*bytes, "a", log) : Result<pan::Model>(failed);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  world::World world;
  EXPECT_TRUE(world.add("a", std::make_shared<const pan::Model>(std::move(*model)), {}, log))
      << to_text(log);
  return world;
}

// Above the middle of a flat sheet of 1 m.
world::Camera camera_above(double height, double focal) {
  world::Camera camera;
  camera.width = camera.height = 100;
  camera.focal = Vec2(focal);
  camera.principal = Vec2(50);
  camera.position = {0, 0, height};
  return camera;
}

const char* const kDetailsModel =
    R"(<mli name="sheet" type="flat" material="mli_gold_kapton" seed="1">
  <mli_settings> <width> 1 </width> <height> 1 </height> <xgrid> 400 </xgrid> </mli_settings>
  <mli_operations preset="crinkled"/> </mli>
  <box name="post" size="0.1" translate="0 0 -1"/>)";

TEST(Details, LevelsFollowTheFootprint) {
  const world::World world = details_world(kDetailsModel);
  const pan::Model& model = *world[0].model();
  ASSERT_GE(model.levels().size(), 2u);
  std::uint32_t sheet = model.levels()[0].instance;
  const auto levels = model.levels(sheet);
  const auto of_sheet = [&](double height) {
    for (const Detail& each : details_of(world, camera_above(height, 1000)))
      if (each.node == model.instances()[sheet].node) return each;
    return Detail{};
  };
  // nearer than a pixel of half the first level's detail: the finest; at a coarser footprint: that
  // level
  const Detail near = of_sheet(1000 * 0.4 * levels[0].detail);
  EXPECT_EQ(near.level, 0);
  EXPECT_EQ(near.triangles, model.meshes()[model.instances()[sheet].mesh].triangle_count);
  double before = 0;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    // a pixel of twice its detail has passed the power of two behind it; the box is some thickness
    // nearer
    const Detail at = of_sheet(1000 * 2.1 * levels[k].detail + 0.2);
    EXPECT_GE(at.level, static_cast<int>(k + 1));
    EXPECT_GT(at.error, before);
    EXPECT_LT(at.triangles, near.triangles);
    EXPECT_EQ(at.finest, near.triangles);
    EXPECT_NEAR(at.pixels, at.error / (1000 * 2.1 * levels[k].detail + 0.2) * 1000,
                0.2 * at.pixels);
    before = at.error * 0.99;
  }
  const Detail inside = of_sheet(0);
  EXPECT_EQ(inside.level, 0);
  EXPECT_EQ(inside.pixels, 0);
}

TEST(Details, PartsWithoutLevelsAndHiddenOnes) {
  world::World world = details_world(kDetailsModel);
  std::size_t boxes = 0;
  for (const Detail& each : details_of(world, camera_above(500, 1000)))
    if (each.level < 0) {
      ++boxes;
      EXPECT_EQ(each.triangles, 12u);
      EXPECT_EQ(each.finest, 12u);
      EXPECT_TRUE(each.visible);
      world.set_node_visible(0, each.node, false);
    }
  EXPECT_EQ(boxes, 1u);
  for (const Detail& each : details_of(world, camera_above(500, 1000)))
    EXPECT_EQ(each.visible, each.level >= 0);
}

TEST(Details, LevelsAreColoured) {
  image::Image image;
  image.width = 3;
  image.height = 1;
  image.target_id = {0, 1, 1};
  image.node_id = {0, 3, 9};
  image.normal = {0, 0, 0, 0, 0, 1, 0, 0, 1};
  Detail detail;
  detail.node = 2;
  detail.level = 1;
  const Pixels pixels = level_pixels(image, {detail});
  std::uint8_t one[3], none[3];
  level_color(1, one);
  level_color(-1, none);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(pixels.rgba[k], 0);
    EXPECT_EQ(pixels.rgba[4 + k], one[k]);
    EXPECT_EQ(pixels.rgba[8 + k], none[k]);
  }
}

}  // namespace
}  // namespace panwright::studio
