// Solar cells on imported faces: columns and rows per metre of the world, or none.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cell_grid_support.h"

namespace panwright::pxn::cell_grid_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kRectangle =
    "coord Coordinate { point [ 0 0 0, 2 0 0, 2 1 0, 0 1 0 ] } coordIndex [ 0 1 2 3 ]";
// 3 m2 without a quarter
constexpr const char* kLShape =
    "coord Coordinate { point [ 0 0 0, 2 0 0, 2 1 0, 1 1 0, 1 2 0, 0 2 0 ] } "
    "coordIndex [ 0 1 2 3 -1 0 3 4 5 ]";

std::string face_set(const std::string& text, const std::string& texcoords = "") {
  const std::string more =
      texcoords.empty() ? "" : " texCoord TextureCoordinate { point [ " + texcoords + " ] }";
  return "Shape { appearance Appearance { material Material {} } geometry IndexedFaceSet { " +
         text + more + " } }";
}

CellReading cells_on(const std::string& children, const std::string& import = "") {
  return cells_reading(
      "sat.wrl", "#VRML V2.0 utf8\nDEF wing Transform { children [ " + children + " ] }\n", import);
}

std::string message(const CellReading& r, Code code) {
  std::string out;
  for (const Diagnostic& d : r.log.entries())
    if (d.code == code) out += d.message + "\n";
  return out;
}

// Bounds of the texture coordinates.
Vec2 extent(const scene::Scene& scene, std::size_t instance) {
  const auto* mesh = std::get_if<geometry::MeshShape>(
      &scene.shapes[static_cast<std::size_t>(scene.instances[instance].shape)]);
  if (mesh == nullptr || (*mesh)->texcoords.empty()) return Vec2(-1);
  Vec2 low(HUGE_VAL), high(-HUGE_VAL);
  for (const Vec2& at : (*mesh)->texcoords) {
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  return high - low;
}

void expect_extent(const CellReading& r, std::size_t instance, Vec2 expected) {
  ASSERT_LT(instance, r.scene.instances.size());
  const Vec2 found = extent(r.scene, instance);
  EXPECT_NEAR(found.x, expected.x, 1e-9);  // 1.2e-15, where the metric is rounded to 2^-36
  EXPECT_NEAR(found.y, expected.y, 1e-9);
}

TEST(CellGrid, RectanglesAreLaidOutInMetres) {
  for (const char* texcoords : {"", "0 0, 1 0, 1.5 1, 0.5 1", "0 0, 1 0, 1 1, 0 1"}) {
    const CellReading r = cells_on(face_set(kRectangle, texcoords));
    ASSERT_EQ(r.scene.instances.size(), 1u) << to_text(r.log);
    expect_extent(r, 0, Vec2(2, 1));
    EXPECT_THAT(message(r, Code("N2021")),
                HasSubstr("1 imported face (2 m2), columns and rows per metre: 0 by texture "
                          "coordinates of the file, 1 as rectangles"));
    EXPECT_EQ(message(r, Code("W6008")), "");
    expect_true_metres(r.scene);
  }
}

TEST(CellGrid, MetresAreThoseOfTheWorld) {
  expect_extent(cells_on(face_set(kRectangle), "units=\"mm\""), 0, Vec2(0.002, 0.001));
  expect_extent(cells_on(face_set(kRectangle), "scale=\"3\" rotate=\"10deg 20deg 30deg\""), 0,
                Vec2(6, 3));
  // 2 by 5 m; y is up in the file
  const CellReading r = cells_on("Transform { rotation 1 2 3 0.7 scale 1 5 1 children [ " +
                                 face_set(kRectangle) + " ] }");
  expect_extent(r, 0, Vec2(5, 2));
  expect_true_metres(r.scene);
  // sheared to a parallelogram by the nodes
  const CellReading sheared =
      cells_on("Transform { scale 1 5 1 children Transform { rotation 0 0 1 0.5 children [ " +
               face_set(kRectangle) + " ] } }");
  EXPECT_THAT(message(sheared, Code("W6008")), HasSubstr("1 imported face (10 m2)"));
}

TEST(CellGrid, InstancesOfOneScaleShareAMesh) {
  const CellReading r =
      cells_on("DEF P " + face_set(kRectangle) +
               " Transform { rotation 1 1 0 0.4 translation 0 0 5 children USE P }"
               " Transform { scale 2 2 2 translation 0 0 9 children USE P }");
  ASSERT_EQ(r.scene.instances.size(), 3u);
  EXPECT_EQ(r.scene.instances[0].shape, r.scene.instances[1].shape);
  EXPECT_NE(r.scene.instances[0].shape, r.scene.instances[2].shape);
  expect_extent(r, 2, Vec2(4, 2));
  expect_true_metres(r.scene);
}

TEST(CellGrid, OtherFacesHaveNoneAndOneWarning) {
  const CellReading r =
      cells_on(face_set(kLShape) + " DEF second Transform { translation 0 0 3 children [ " +
               face_set(kLShape) + " ] }");
  ASSERT_EQ(r.scene.instances.size(), 2u);
  for (const scene::Instance& instance : r.scene.instances) {
    const auto& material = r.scene.materials[static_cast<std::size_t>(instance.material)];
    EXPECT_FALSE(material.cells);
    EXPECT_EQ(material.name, "c without cells");
  }
  EXPECT_EQ(r.scene.instances[0].material, r.scene.instances[1].material);
  EXPECT_THAT(message(r, Code("W6008")),
              HasSubstr("2 imported faces (6 m2) of the nodes 'Shape1', 'Shape2'"));
  EXPECT_EQ(message(r, Code("N2021")), "");
}

TEST(CellGrid, AMeshMayHaveBoth) {
  const CellReading r = cells_on(face_set(
      "coord Coordinate { point [ 0 0 0, 2 0 0, 2 1 0, 1 1 0, 1 2 0, 0 2 0, 5 0 0, 8 0 0, 8 1 0, "
      "5 1 0 ] } coordIndex [ 0 1 2 3 -1 0 3 4 5 -1 6 7 8 9 ]"));
  ASSERT_EQ(r.scene.instances.size(), 2u);
  expect_extent(r, 0, Vec2(3, 1));
  const auto& with = r.scene.materials[static_cast<std::size_t>(r.scene.instances[0].material)];
  const auto& without = r.scene.materials[static_cast<std::size_t>(r.scene.instances[1].material)];
  EXPECT_TRUE(with.cells);
  EXPECT_FALSE(without.cells);
  std::size_t triangles = 0;
  for (const scene::Instance& instance : r.scene.instances)
    triangles +=
        std::get<geometry::MeshShape>(r.scene.shapes[static_cast<std::size_t>(instance.shape)])
            ->triangles.size();
  EXPECT_EQ(triangles, 6u);
  EXPECT_THAT(message(r, Code("W6008")), HasSubstr("1 imported face (3 m2) of the node 'Shape1'"));
}

TEST(CellGrid, UnshearedCoordinatesOfAnyFaceStay) {
  const CellReading r = cells_on(face_set(kLShape, "0 0, 1 0, 1 0.5, 0.5 0.5, 0.5 1, 0 1"));
  ASSERT_EQ(r.scene.instances.size(), 1u);
  expect_extent(r, 0, Vec2(2, 2));
  EXPECT_THAT(message(r, Code("N2021")), HasSubstr("1 by texture coordinates of the file"));
}

TEST(CellGrid, BoxesAreSixRectanglesAndSpheresHaveNone) {
  const auto shape = [](const std::string& geometry) {
    return "Shape { appearance Appearance { material Material {} } geometry " + geometry + " }";
  };
  const CellReading box = cells_on(shape("Box { size 1 2 3 }"));
  EXPECT_THAT(message(box, Code("N2021")), HasSubstr("6 imported faces (22 m2)"));
  expect_true_metres(box.scene);
  const CellReading ball = cells_on(shape("Sphere {}"));
  EXPECT_THAT(message(ball, Code("W6008")), HasSubstr("1 imported face (12.6 m2) of the node"));
  EXPECT_EQ(message(ball, Code("N2021")), "");
}

// Shapes of the language keep columns and rows over the whole.
TEST(CellGrid, MaterialsWithoutCellsAndOwnShapesAreAsTheyWere) {
  DiagnosticLog log;
  const MemoryFile files[] = {
      {"model/top.pxn",
       "<pangu_model ver=\"1\"><material name=\"c\" preset=\"cells_gaas\"/>"
       "<plane size=\"3 2\" material=\"c\"/><import file=\"sat.wrl\"/></pangu_model>"},
      {"model/sat.wrl", "#VRML V2.0 utf8\n" + face_set(kLShape)}};
  const auto scene = read_memory(files, {}, log);
  ASSERT_TRUE(scene);
  EXPECT_EQ(log.entries().size(), 0u) << to_text(log);
  EXPECT_EQ(scene->instances.size(), 2u);
  EXPECT_EQ(scene->materials.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<geometry::Plane>(scene->shapes[0]) ||
              std::holds_alternative<geometry::Plane>(scene->shapes[1]));
}

}  // namespace
}  // namespace panwright::pxn::cell_grid_test
