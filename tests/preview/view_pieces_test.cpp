// What a part of a view shows of boxes, against points strewn in them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/axis_box.h"
#include "preview/frame/projection.h"
#include "preview/frame/view_pieces.h"

namespace panwright::preview::view_pieces_test {
namespace {

TEST(ViewPieces, BoundsHoldAllThatIsSeenAndNoMore) {
  std::mt19937 random(7);
  const auto real = [&] { return static_cast<double>(random()) / 0x1p31 - 1; };
  std::size_t seen = 0;
  double tightest = 0;
  for (const bool perspective : {true, false})
    for (int round = 0; round < 60; ++round) {
      world::Camera camera;
      world::set_field_of_view(camera, 640, 480, 0.9);
      if (!perspective) world::set_orthographic(camera, 640, 480, 4);
      const ViewCell cell{{100, 80}, {500, 400}, 0.5, 4 + 3 * real()};
      // the camera may stand in the box
      const Mat4 camera_from_box = matrix_from_trs(
          Vec3(real(), real(), 1.5 + 2 * real()),
          glm::angleAxis(3 * real(), glm::normalize(Vec3(real(), real(), 1.1))), Vec3(1));
      const Vec3 half = Vec3(1.1 + real(), 1.1 + real(), round % 3 == 0 ? 0.0 : 1.1 + real());
      ViewFrame frame{
          &camera,
          matrix_from_trs(Vec3(5, -7, 2), glm::angleAxis(2 * real(), Vec3(0.6, 0, 0.8)), Vec3(1))};
      ViewPiece piece;
      piece.corners = corners(-half, half);
      for (Vec3& corner : piece.corners) corner = Vec3(camera_from_box * Vec4(corner, 1));
      const ShownPart part = shown_part(frame, cell, piece);
      AxisBox shown;
      for (int i = 0; i < 20000; ++i) {
        const Vec3 p(camera_from_box * Vec4(half * Vec3(real(), real(), real()), 1));
        const double w = perspective ? p.z : 1;
        const Vec2 pixel = camera.focal * Vec2(p) / w + camera.principal;
        if (!(p.z > cell.near && p.z < cell.far && pixel.x > cell.low.x && pixel.y > cell.low.y &&
              pixel.x < cell.high.x && pixel.y < cell.high.y))
          continue;
        ++seen;
        const Vec3 light(frame.light_from_camera * Vec4(p, 1));
        shown.add(light);
        // measured 0
        for (int k = 0; k < 3; ++k) {
          ASSERT_GE(light[k], part.light.low[k] - 1e-12);
          ASSERT_LE(light[k], part.light.high[k] + 1e-12);
        }
        ASSERT_GE(p.z, part.view.low.z - 1e-12);
        ASSERT_LE(p.z, part.view.high.z + 1e-12);
        ASSERT_GE(pixel.x, part.view.low.x - 1e-9);
        ASSERT_LE(pixel.y, part.view.high.y + 1e-9);
      }
      if (!(shown.low.x < shown.high.x)) continue;
      const Vec3 share = shown.extent() / glm::max(part.light.extent(), Vec3(1e-12));
      tightest = std::max(tightest, std::max(share.x, share.y));
    }
  EXPECT_GT(seen, 50000u);
  EXPECT_GT(tightest, 0.9);  // points strewn reach the bounds somewhere
}

TEST(ViewPieces, WhatLiesOutsideIsEmpty) {
  world::Camera camera;
  world::set_field_of_view(camera, 100, 100, 0.5);
  const ViewFrame frame{&camera, Mat4(1)};
  const ViewCell cell{{0, 0}, {100, 100}, 1, 10};
  for (const Vec3& at : {Vec3(0, 0, -5), Vec3(20, 0, 5), Vec3(0, 0, 30)}) {
    ViewPiece piece;
    piece.corners = corners(at - 1.0, at + 1.0);
    EXPECT_TRUE(shown_part(frame, cell, piece).empty());
  }
}

}  // namespace
}  // namespace panwright::preview::view_pieces_test
