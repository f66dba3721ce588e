// Sizes of models: in words, and those that tell of a unit mistaken.

#include "compiler/size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compiler/compile.h"
#include "geometry/tessellate/shape.h"

namespace panwright::compiler::size_test {
namespace {

using testing::HasSubstr;

TEST(Size, Words) {
  const std::pair<double, const char*> cases[] = {
      {0, "0 m"},          {34e-3, "34 mm"},      {1.1e3, "1.1 km"},   {0.9994, "999 mm"},
      {0.9996, "1 m"},     {999.4, "999 m"},      {999.6, "1 km"},     {12.345, "12.3 m"},
      {5e-6, "5 µm"},      {2.5e-9, "2.5 nm"},    {1e-12, "0.001 nm"}, {1.4e9, "1.4e+06 km"},
      {6371e3, "6371 km"}, {149.6e6, "149600 km"}};
  for (const auto& [metres, words] : cases) EXPECT_EQ(length_in_words(metres), words) << metres;
  EXPECT_EQ(size_in_words({2.1, 1.4, 6.8}), "2.1 x 1.4 x 6.8 m (about a bus)");
  EXPECT_EQ(size_in_words({0.1, 0.1, 0.3405}), "100 x 100 x 340 mm (about a shoe box)");
  EXPECT_EQ(size_in_words({1100, 224, 1e-13}), "1.1 x 0.224 x 0 km (larger than any spacecraft)");
  EXPECT_EQ(size_in_words({0, 0, 0}), "0 x 0 x 0 m (smaller than a grain of sand)");
}

// Boxes along x, of these sizes, or one shape.
scene::Scene scene_of(const std::vector<double>& sizes) {
  scene::Scene scene;
  scene.nodes.push_back({});
  scene.nodes.back().name = "root";
  scene.materials.push_back({});
  scene.inputs.push_back({"m.pxn", {}, 1});
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    scene::Node node;
    node.name = "part" + std::to_string(i);
    node.parent = 0;
    scene.nodes.push_back(node);
    geometry::Box box;
    box.size = Vec3(sizes[i]);
    scene.shapes.push_back(box);
    scene::Instance instance;
    instance.node = static_cast<std::int32_t>(i + 1);
    instance.shape = static_cast<std::int32_t>(i);
    scene.instances.push_back(instance);
  }
  return scene;
}

std::string said_of(const scene::Scene& scene) {
  DiagnosticLog log;
  Options options;
  options.check_size = true;
  EXPECT_TRUE(compiled(scene, options, log));
  std::string out;
  for (const Diagnostic& entry : log.entries())
    if (entry.code == Code("W2022") || entry.code == Code("W2023"))
      out += std::string(code_info(entry.code).name) + " " + entry.message;
  return out;
}

TEST(Size, ThatNoSpacecraftHasIsAWarning) {
  EXPECT_EQ(said_of(scene_of({1, 2})), "");
  EXPECT_EQ(said_of(scene_of({0.05})), "");
  EXPECT_EQ(said_of(scene_of({200})), "");
  EXPECT_EQ(said_of(scene_of({340.5})),
            "W2022 the model is 340 m large, more than any spacecraft; read as millimetres it is "
            "340 mm, as inches 8.65 m");
  EXPECT_EQ(said_of(scene_of({0.005, 0.034})),
            "W2022 the model is 34 mm large, less than any spacecraft; read as metres it is 34 m, "
            "as inches 864 mm");
  // only where it is asked for
  DiagnosticLog log;
  EXPECT_TRUE(compiled(scene_of({340.5}), {}, log));
  EXPECT_EQ(log.entries().size(), 0u);
}

TEST(Size, OfAWholeIsThatOfItsParts) {
  scene::Scene scene = scene_of({1, 1});
  scene.nodes[1].parent_from_node.translation = {0, 0, 150};
  EXPECT_EQ(said_of(scene), "");
  scene.nodes[1].parent_from_node.translation = {0, 0, 250};
  EXPECT_THAT(said_of(scene), HasSubstr("W2022 the model is 251 m large"));
  scene.nodes[0].parent_from_node.scale = Vec3(1e-3);
  EXPECT_EQ(said_of(scene), "");
}

TEST(Size, OfPartsIsComparedWithin) {
  EXPECT_EQ(said_of(scene_of({1, 1.1e-5})), "");
  EXPECT_EQ(said_of(scene_of({1, 0.9e-5})),
            "W2023 the part 'part1' is 9 µm large, and 'part0' is 1 m: 1.1e+05 times as much");
  // one cause, one warning
  EXPECT_THAT(said_of(scene_of({0.06, 5000, 3})), HasSubstr("W2022 the model is 5 km large"));
  EXPECT_THAT(said_of(scene_of({0.04, 5000, 3})), HasSubstr("W2023 the part 'part0' is 40 mm"));
}

TEST(Size, OfACelestialBodyIsNeverWrong) {
  scene::Scene scene = scene_of({1});
  geometry::Sphere sphere;
  sphere.radius = 1.7e6;
  scene.shapes[0] = sphere;
  EXPECT_EQ(said_of(scene), "");
  scene.shapes[0] = geometry::Ellipsoid{};
  std::get<geometry::Ellipsoid>(scene.shapes[0]).radii = {300, 200, 100};
  EXPECT_EQ(said_of(scene), "");
  scene.shapes[0] = geometry::Box{};
  std::get<geometry::Box>(scene.shapes[0]).size = Vec3(300);
  EXPECT_THAT(said_of(scene), HasSubstr("W2022"));
}

}  // namespace
}  // namespace panwright::compiler::size_test
