#include "preview/frame/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace panwright::preview::projection_test {
namespace {

// uniform in [-1, 1), the same on every machine
class Numbers {
 public:
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-52 - 1; }
  Vec3 vector() {
    const double x = (*this)();
    const double y = (*this)();
    return {x, y, (*this)()};
  }
  Quat rotation() {
    for (;;) {
      const Vec3 v = vector();
      const Quat q((*this)(), v.x, v.y, v.z);
      const double square = glm::dot(q, q);
      if (square > 0.01 && square < 1) return glm::normalize(q);
    }
  }

 private:
  std::mt19937_64 engine_{7};
};

world::Camera some_camera(Numbers& number, world::Projection projection) {
  world::Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.projection = projection;
  camera.focal = projection == world::Projection::perspective ? Vec2(700, 650) : Vec2(70, 65);
  camera.principal = {300, 260};
  camera.position = 3.0 * number.vector();
  camera.world_from_camera = number.rotation();
  return camera;
}

TEST(Projection, WindowAgreesWithProject) {
  Numbers number;
  for (const world::Projection projection :
       {world::Projection::perspective, world::Projection::orthographic})
    for (int i = 0; i < 2000; ++i) {
      const world::Camera camera = some_camera(number, projection);
      const Tile tile{128, 64, 100, 50};
      const Mat4 world_from_mesh =
          matrix_from_trs(number.vector(), number.rotation(), Vec3(0.5) + 0.3 * number.vector());
      const DepthRange range{0.5, 9};
      const Mat4 clip = clip_from_mesh(camera, tile, range, camera_from(camera, world_from_mesh));
      const Vec3 p = number.vector();
      const Vec4 at = clip * Vec4(p, 1);
      const auto pixel = project(camera, Vec3(world_from_mesh * Vec4(p, 1)));
      if (!pixel || at.w < 0.1) continue;
      const Vec2 window = (Vec2(at) / at.w + 1.0) / 2.0 * Vec2(100, 50) + Vec2(128, 64);
      EXPECT_LE(glm::length(window - *pixel), 1e-9 * (1 + glm::length(*pixel)));
    }
}

TEST(Projection, DepthIsOneAtNearAndZeroAtFar) {
  world::Camera camera;
  for (const world::Projection projection :
       {world::Projection::perspective, world::Projection::orthographic}) {
    camera.projection = projection;
    for (const DepthRange range :
         {DepthRange{1, 2}, DepthRange{1e-3, 1e6}, DepthRange{1e8, 1e8 + 2}}) {
      const Mat4 clip = clip_from_mesh(camera, {0, 0, 1024, 1024}, range, Mat4(1));
      const Vec4 near = clip * Vec4(0, 0, range.near, 1);
      const Vec4 far = clip * Vec4(0, 0, range.far, 1);
      // a sphere of 1 m at 1e8 m: 1e8 has 1.5e-8 as its last bit, half of that over 2 m
      EXPECT_NEAR(near.z / near.w, 1, 1e-8);
      EXPECT_NEAR(far.z / far.w, 0, 1e-8);
    }
  }
}

// The whole point of the fitted range: float clip coordinates of a far away mesh still tell depths
// apart at the resolution of the mesh. Oracle: the formula in long double.
TEST(Projection, FloatDepthResolvesTheMeshAtAnyDistance) {
  for (const double distance : {1e1, 1e3, 1e5, 1e8}) {
    world::Camera camera;
    camera.position = {0, 0, -distance};
    const Mat4 camera_from_mesh = camera_from(camera, Mat4(1));
    const PlacedBox box{camera_from_mesh, Vec3(-1), Vec3(1)};
    const DepthRange range = fitted_depth(world::Projection::perspective, std::span(&box, 1));
    const Mat4 exact = clip_from_mesh(camera, {0, 0, 1024, 1024}, range, camera_from_mesh);
    const glm::mat4 clip(exact);
    double worst = 0;
    for (int i = -1000; i <= 1000; ++i) {
      const float z = static_cast<float>(i / 1000.0);
      const glm::vec4 at = clip * glm::vec4(0.1f, -0.2f, z, 1);
      const long double depth = static_cast<long double>(range.near) * (range.far - distance - z) /
                                (range.far - range.near) / (distance + z);
      worst = std::max(worst, static_cast<double>(std::fabs(at.z / at.w - depth)));
    }
    // measured 9e-8 to 1.3e-7 of the whole range, that is 2 roundings of a float below 1
    EXPECT_LE(worst, 2.5e-7) << distance;
  }
}

TEST(Projection, FittedDepthHoldsWhatIsInFront) {
  Numbers number;
  for (int i = 0; i < 1000; ++i) {
    PlacedBox boxes[3];
    for (PlacedBox& box : boxes) {
      box.camera_from_mesh = matrix_from_trs(5.0 * number.vector() + Vec3(0, 0, 8 + 5 * number()),
                                             number.rotation(), Vec3(1));
      const Vec3 a = number.vector();
      box.low = a - Vec3(0.5);
      box.high = a + Vec3(0.5);
    }
    for (const world::Projection projection :
         {world::Projection::perspective, world::Projection::orthographic}) {
      const DepthRange range = fitted_depth(projection, boxes);
      EXPECT_LT(range.near, range.far);
      EXPECT_GE(range.near, projection == world::Projection::perspective ? 1e-12 : 0);
      for (const PlacedBox& box : boxes)
        for (const Vec3& corner : corners(box.low, box.high)) {
          const double z = (box.camera_from_mesh * Vec4(corner, 1)).z;
          EXPECT_LT(z, range.far);
          EXPECT_TRUE(z <= 1e-7 || z > range.near) << z;
        }
    }
  }
}

TEST(Projection, FittedDepthOfAPlateAcrossTheBoresightIsNotEmpty) {
  for (const double distance : {1e-3, 1.0, 1e8}) {
    const PlacedBox box{matrix_from_trs({0, 0, distance}, Quat(1, 0, 0, 0), Vec3(1)),
                        Vec3(-1, -1, 0), Vec3(1, 1, 0)};
    const DepthRange range = fitted_depth(world::Projection::perspective, std::span(&box, 1));
    EXPECT_LT(range.near, distance);
    EXPECT_GT(range.far, distance);
    EXPECT_GT(range.near, 0);
  }
}

TEST(Projection, NothingInFrontIsStillAValidRange) {
  const PlacedBox behind{matrix_from_trs({0, 0, -9}, Quat(1, 0, 0, 0), Vec3(1)), Vec3(-1), Vec3(1)};
  for (const auto& boxes : {std::span<const PlacedBox>(), std::span(&behind, 1)}) {
    const DepthRange range = fitted_depth(world::Projection::perspective, boxes);
    EXPECT_GT(range.near, 0);
    EXPECT_GT(range.far, range.near);
  }
}

// Oracle: points of the box, by brute force.
TEST(Projection, TouchedPartsNeverMissAPoint) {
  Numbers number;
  int touched = 0;
  int refused = 0;
  int smaller = 0;
  for (int i = 0; i < 3000; ++i) {
    const world::Camera camera = some_camera(
        number, i % 2 ? world::Projection::perspective : world::Projection::orthographic);
    const Tile tile{200, 150, 64, 64};
    PlacedBox box;
    box.camera_from_mesh =
        matrix_from_trs(Vec3(0, 0, 3) + 4.0 * number.vector(), number.rotation(), Vec3(1, -2, 0.5));
    box.low = Vec3(-0.5);
    box.high = Vec3(0.5);
    bool inside = false;
    Vec2 seen(0);
    for (int k = 0; k < 300 && !inside; ++k) {
      const Vec3 p = Vec3(box.camera_from_mesh * Vec4(0.5 * number.vector(), 1));
      if (!(p.z > 0)) continue;
      const Vec2 pixel = camera.projection == world::Projection::perspective
                             ? camera.focal * Vec2(p) / p.z + camera.principal
                             : camera.focal * Vec2(p) + camera.principal;
      inside = pixel.x >= 200 && pixel.x < 264 && pixel.y >= 150 && pixel.y < 214;
      if (inside) seen = pixel;
    }
    const bool may = may_touch(camera, tile, 0, box);
    EXPECT_TRUE(may || !inside);
    const std::uint32_t first = 0;
    const Tile part = touched_part(camera, tile, std::span(&box, 1), std::span(&first, 1));
    EXPECT_TRUE(part.width > 0 || !inside);
    EXPECT_TRUE(part.x >= tile.x && part.x + part.width <= tile.x + tile.width);
    EXPECT_TRUE(part.y >= tile.y && part.y + part.height <= tile.y + tile.height);
    if (inside) {
      EXPECT_TRUE(seen.x >= part.x && seen.x < part.x + part.width);
      EXPECT_TRUE(seen.y >= part.y && seen.y < part.y + part.height);
    }
    smaller += part.width * part.height < tile.width * tile.height;
    touched += inside;
    refused += !may;
  }
  EXPECT_GT(touched, 100);  // the test has cases of both kinds
  EXPECT_GT(refused, 500);
  EXPECT_GT(smaller, 500);
}

}  // namespace
}  // namespace panwright::preview::projection_test
