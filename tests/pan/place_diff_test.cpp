// Differences of surfaces by place: none for other names, trees and orders.
#include "pan/place_diff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "pan/writer.h"
#include "tests/pan/load.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::place_diff_test {
namespace {

PlaceDifferences after(const std::function<void(Contents&)>& change) {
  Contents changed = support::small_contents();
  change(changed);
  return diff_by_place(load(support::small_pan()), load(write_to_memory(changed)));
}

TEST(PlaceDiff, EqualModelsHaveNone) {
  const PlaceDifferences found = after([](Contents&) {});
  EXPECT_TRUE(found.same());
  EXPECT_GT(found.triangles_a, 0u);
  EXPECT_EQ(found.triangles_a, found.triangles_b);
  EXPECT_EQ(found.largest, 0);
}

TEST(PlaceDiff, NamesAndMaterialsDoNotCount) {
  EXPECT_TRUE(after([](Contents& c) {
                for (auto& node : c.nodes) node.name += "2";
                for (auto& mesh : c.meshes) mesh.name += "2";
                c.materials[0].diffuse = Vec3(0.125);
              }).same());
}

TEST(PlaceDiff, OrderOfTrianglesAndCornersDoesNotCount) {
  EXPECT_TRUE(after([](Contents& c) {
                for (auto& mesh : c.meshes) {
                  std::vector<std::uint32_t>& list = mesh.indices;
                  for (std::size_t k = 0; k + 2 < list.size(); k += 3)
                    std::rotate(list.begin() + static_cast<std::ptrdiff_t>(k),
                                list.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                                list.begin() + static_cast<std::ptrdiff_t>(k) + 3);
                }
              }).same());
  // but the side does
  const PlaceDifferences turned =
      after([](Contents& c) { std::swap(c.meshes[0].indices[0], c.meshes[0].indices[1]); });
  EXPECT_FALSE(turned.same());
}

TEST(PlaceDiff, MovedPartsAreNamed) {
  const PlaceDifferences found = after([](Contents& c) { c.nodes[1].translation.z += 0.5; });
  ASSERT_FALSE(found.same());
  EXPECT_TRUE(found.parts.front().in_a);
  EXPECT_FALSE(found.parts.back().in_a);
  for (const UnmatchedPart& part : found.parts) EXPECT_EQ(part.unmatched, part.triangles);
  const PlaceDifferences near = after([](Contents& c) { c.nodes[1].translation.z += 1e-9; });
  EXPECT_TRUE(near.same());
  EXPECT_NEAR(near.largest, 1e-9, 1e-12);
}

}  // namespace
}  // namespace panwright::pan::place_diff_test
