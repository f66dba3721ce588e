// The box that the Sun sees a model in.
#include <gtest/gtest.h>

#include <cmath>

#include "preview/frame/light_space.h"
#include "preview/frame/projection.h"

namespace panwright::preview::light_space_test {
namespace {

DrawItem item(const Vec3& low, const Vec3& high, const Mat4& model_from_mesh) {
  DrawItem result;
  result.low = low;
  result.high = high;
  result.model_from_mesh = model_from_mesh;
  return result;
}

const std::vector<Vec3> kSuns = {{0, 0, 1},   {0, 0, -1},   {1, 0, 0},      {0, -1, 0},
                                 {1, 2, 3},   {-3, 0.1, 1}, {1, 1e-9, 0},   {1, 1, 1},
                                 {0.6, 0, 1}, {-1, -1, -1}, {1e-9, 1e-9, 1}};

// Every corner lies inside, two texels from the border, and the furthest touch that line.
TEST(LightSpace, HoldsAllCornersAndNoMore) {
  for (const Vec3& moved : {Vec3(0), Vec3(1e6, -2e6, 3e6)})
    for (const double scale : {1.0, 1e-6, 1e8})
      for (const Vec3& direction : kSuns) {
        const Vec3 to_sun = glm::normalize(direction);
        const Quat turn = glm::angleAxis(0.7, glm::normalize(Vec3(1, -1, 2)));
        const std::vector<DrawItem> list = {
            item({-1, -2, -0.5}, {3, 1, 0}, matrix_from_trs(moved * scale, turn, Vec3(scale))),
            item({0, 0, 0}, {1, 1, 8},
                 matrix_from_trs((moved + Vec3(1, 2, 3)) * scale, Quat(1, 0, 0, 0),
                                 Vec3(scale, -scale, scale)))};
        const unsigned side = 256;
        const LightSpace frame = fitted_light_space(list, to_sun, side);
        Vec3 low(INFINITY);
        Vec3 high(-INFINITY);
        for (const DrawItem& one : list)
          for (const Vec3& corner : corners(one.low, one.high)) {
            const Vec3 at(frame.sun_from_model * one.model_from_mesh * Vec4(corner, 1));
            low = glm::min(low, at);
            high = glm::max(high, at);
          }
        const double room = 2 * 2.0 / side;
        // measured 2e-9 with the boxes at 1e6 times their size, 1e-15 else
        for (int k = 0; k < 2; ++k) {
          EXPECT_NEAR(low[k], -1 + room, 1e-8);
          EXPECT_NEAR(high[k], 1 - room, 1e-8);
        }
        EXPECT_GT(low.z, 0);
        EXPECT_LT(high.z, 1);
        EXPECT_GT(high.z - low.z, 0.99);
        // towards the Sun is up, and nothing else
        const Vec3 up(frame.sun_from_model * Vec4(to_sun, 0));
        EXPECT_NEAR(up.z * frame.extent.z, 1, 1e-12);
        EXPECT_LE(std::hypot(up.x, up.y) * frame.extent.z, 1e-12);
      }
}

// Planes stay planes: a normal in the frame is at a right angle to what lay in the plane.
TEST(LightSpace, NormalsFollowTheirPlanes) {
  for (const Vec3& direction : kSuns) {
    const std::vector<DrawItem> list = {item({-1, -20, -0.5}, {3, 1, 0.1}, Mat4(1))};
    const LightSpace frame = fitted_light_space(list, glm::normalize(direction), 512);
    const Vec3 normal = glm::normalize(Vec3(1, 2, -0.7));
    const Vec3 placed = glm::normalize(frame.sun_normal_from_model * normal);
    for (const Vec3& along : {glm::cross(normal, Vec3(1, 0, 0)), glm::cross(normal, Vec3(0, 3, 1))})
      EXPECT_LE(std::fabs(glm::dot(glm::normalize(Mat3(frame.sun_from_model) * along), placed)),
                1e-14);
  }
}

// The longest way across lies along x, whatever the Sun does; the frame follows it smoothly.
TEST(LightSpace, LiesAlongTheLongestWay) {
  const std::vector<DrawItem> list = {item({-1, -20, -0.5}, {3, 1, 0.1}, Mat4(1))};
  for (const Vec3& direction : kSuns) {
    const Vec3 to_sun = glm::normalize(direction);
    const LightSpace frame = fitted_light_space(list, to_sun, 512);
    if (std::fabs(to_sun.y) > 0.9) continue;
    EXPECT_GE(frame.extent.x, frame.extent.y);
    EXPECT_NEAR(frame.sun_from_model[0][0] * frame.sun_from_model[1][1] -
                    frame.sun_from_model[0][1] * frame.sun_from_model[1][0],
                4 / (frame.extent.x * frame.extent.y) * to_sun.z, 1e-12);
  }
}

// Points, lines and sheets, along and across the Sun.
TEST(LightSpace, ThinThingsGiveFiniteFrames) {
  for (const Vec3& size :
       {Vec3(0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1e-300), Vec3(1e100, 1e-100, 1)})
    for (const Vec3& direction : kSuns) {
      const LightSpace frame = fitted_light_space(std::vector{item(Vec3(0), size, Mat4(1))},
                                                  glm::normalize(direction), 16);
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
          EXPECT_TRUE(std::isfinite(frame.sun_from_model[column][row])) << size.x;
      for (int k = 0; k < 3; ++k) EXPECT_GT(frame.extent[k], 0);
    }
  EXPECT_GT(fitted_light_space({}, Vec3(0, 0, 1), 16).extent.x, 0);
}

}  // namespace
}  // namespace panwright::preview::light_space_test
