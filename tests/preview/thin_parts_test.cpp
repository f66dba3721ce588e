// Area of thin parts in pixels without samples. Oracles: closed forms of strips; sums over fine
// grids of points.
#include "preview/frame/thin_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace panwright::preview::thin_parts_test {
namespace {

// A strip of two triangles between two points, pixels; its camera is 2 m above, 100 pixels a metre.
struct Strip {
  std::vector<pan::layout::Float3> positions;
  std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};

  Strip(const Vec2& from, const Vec2& to, double width) {
    const Vec2 along = glm::normalize(to - from);
    const Vec2 side = 0.5 * width * Vec2(-along.y, along.x);
    for (const Vec2& p : {from - side, to - side, to + side, from + side})
      positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), 0});
  }
  ThinMesh mesh(double depth = 2, bool closed = false) const {
    ThinMesh mesh;
    mesh.mesh.positions = positions;
    mesh.mesh.indices.longs = indices;
    mesh.camera_from_mesh[0].x = mesh.camera_from_mesh[1].y = depth / 100;
    mesh.camera_from_mesh[3].z = depth;
    mesh.closed = closed;
    return mesh;
  }
};

world::Camera camera() {
  world::Camera camera;
  camera.width = camera.height = 32;
  camera.focal = Vec2(100);
  camera.principal = Vec2(0);
  return camera;
}

constexpr Tile kPart{4, 2, 20, 16};
const std::vector<std::uint8_t> kAllEmpty(std::size_t{20} * 16, 1);

TEST(ThinParts, AreasOfStripsAreClosedForms) {
  ThinParts thin;
  thin.begin(kPart, kAllEmpty);
  thin.add(camera(), Strip({6.25, 5.75}, {20.5, 5.75}, 0.125).mesh());
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 20; ++x) {
      const double length = y != 3 ? 0 : x == 2 ? 0.75 : x > 2 && x < 16 ? 1 : x == 16 ? 0.5 : 0;
      // positions in float
      EXPECT_NEAR(thin.areas()[20 * y + x], 0.125 * length, 1e-5) << x << " " << y;
    }
}

// Aslant and across the border of the part, against points of a grid of 1/200 pixel.
TEST(ThinParts, SlantedStripsAreThoseOfPoints) {
  const Vec2 from(-3, 1.3), to(40, 20.1);
  const double width = 0.3;
  ThinParts thin;
  thin.begin(kPart, kAllEmpty);
  thin.add(camera(), Strip(from, to, width).mesh());
  const Vec2 along = glm::normalize(to - from);
  double most = 0;
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 20; ++x) {
      int inside = 0;
      for (int k = 0; k < 200 * 200; ++k) {
        const Vec2 p(4.0 + static_cast<double>(x) + (k % 200 + 0.5) / 200,
                     2.0 + static_cast<double>(y) + (k / 200 + 0.5) / 200);
        const Vec2 d = p - from;
        inside += std::fabs(d.y * along.x - d.x * along.y) <= 0.5 * width;
      }
      const double off = std::fabs(thin.areas()[20 * y + x] - inside / (200.0 * 200));
      most = std::max(most, off);
    }
  EXPECT_LE(most, 1e-3);  // measured: 1.4e-4
}

TEST(ThinParts, WhatSamplesShowOrIsWideCountsNot) {
  const auto sum_of = [](const ThinMesh& mesh, std::span<const std::uint8_t> empty) {
    ThinParts thin;
    thin.begin(kPart, empty);
    thin.add(camera(), mesh);
    double sum = 0;
    for (const float area : thin.areas()) sum += static_cast<double>(area);
    return sum;
  };
  const Strip strip({6, 5.5}, {16, 5.5}, 0.25);
  EXPECT_NEAR(sum_of(strip.mesh(), kAllEmpty), 2.5, 1e-4);
  EXPECT_NEAR(sum_of(strip.mesh(2, true), kAllEmpty), 1.25, 1e-4);  // one of two sides is seen
  EXPECT_EQ(sum_of(strip.mesh(-2), kAllEmpty), 0);                  // behind the camera
  EXPECT_EQ(sum_of(Strip({6, 5.5}, {16, 5.5}, 0.8).mesh(), kAllEmpty), 0);
  std::vector<std::uint8_t> some = kAllEmpty;
  for (std::size_t x = 0; x < 7; ++x) some[20 * 3 + x] = 0;  // pixels 4 to 10
  EXPECT_NEAR(sum_of(strip.mesh(), some), 0.25 * 5, 1e-4);
  // a boom that many strips make together covers no more than the pixel
  ThinParts thin;
  thin.begin(kPart, kAllEmpty);
  for (int i = 0; i < 9; ++i) thin.add(camera(), strip.mesh());
  EXPECT_EQ(thin.areas()[20 * 3 + 5], 1);
}

TEST(ThinParts, EmptyPixelsHaveNoSampleAround) {
  image::Image image;
  image.width = image.height = 8;
  image.coverage.assign(64, 0);
  image::Image corners = image;
  const Tile part{1, 1, 6, 6};
  std::vector<std::uint8_t> empty;
  corners.coverage[8 * 4 + 4] = 1;  // of the four pixels that meet there
  find_empty(image, &corners, part, empty);
  for (std::uint32_t y = 1; y < 7; ++y)
    for (std::uint32_t x = 1; x < 7; ++x)
      EXPECT_EQ(empty[6 * (y - 1) + x - 1], x + 1 < 4 || x > 4 || y + 1 < 4 || y > 4) << x << y;
  image.coverage[8 * 2 + 5] = 0.5f;
  find_empty(image, nullptr, part, empty);
  for (std::uint32_t y = 1; y < 7; ++y)
    for (std::uint32_t x = 1; x < 7; ++x)
      EXPECT_EQ(empty[6 * (y - 1) + x - 1], x < 4 || y > 3) << x << y;
}

}  // namespace
}  // namespace panwright::preview::thin_parts_test
