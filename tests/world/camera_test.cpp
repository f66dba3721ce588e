#include "world/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace panwright::world::camera_test {
namespace {

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

Quat looks(const Vec3& from, const Vec3& at, const std::optional<Vec3>& up = {}) {
  DiagnosticLog log;
  const auto quat = looking_at(from, at, up, log);
  EXPECT_TRUE(quat);
  EXPECT_FALSE(log.contains(Code("N5004")));
  return quat ? *quat : Quat(1, 0, 0, 0);
}

TEST(LookingAt, AxesAreRightDownForward) {
  // from -y towards the origin with z up: right is +x, down is -z
  const Quat q = looks({0, -5, 0}, {0, 0, 0});
  expect_near(q * Vec3(1, 0, 0), {1, 0, 0}, 1e-15);
  expect_near(q * Vec3(0, 1, 0), {0, 0, -1}, 1e-15);
  expect_near(q * Vec3(0, 0, 1), {0, 1, 0}, 1e-15);
}

TEST(LookingAt, KeepsUpInTheImagePlaneForAnyDirection) {
  for (const Vec3& from : {Vec3(3, 4, 5), Vec3(-1e8, 2, 1e7), Vec3(1e-9, 2e-9, -1e-9)})
    for (const Vec3& up : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(0, -1e-3, 0)}) {
      const Quat q = looks(from, {0, 0, 0}, up);
      EXPECT_NEAR(glm::length(q), 1, 1e-15);
      expect_near(q * Vec3(0, 0, 1), -glm::normalize(from), 1e-15);  // measured 7e-16
      // no sideways part of up, and its upper part is positive
      EXPECT_NEAR(glm::dot(q * Vec3(1, 0, 0), glm::normalize(up)), 0, 4e-16);
      EXPECT_LT(glm::dot(q * Vec3(0, 1, 0), up), 0);
    }
}

TEST(LookingAt, ReplacesUpAlongTheLineOfSight) {
  // measured: quat_cast and normalize leave 2e-16
  for (const double offset : {0.0, 0.9e-6, -0.9e-6}) {
    DiagnosticLog log;
    const auto q = looking_at({offset, 0, 10}, {0, 0, 0}, {}, log);
    ASSERT_TRUE(q);
    // the angle between boresight and -z is offset/10
    EXPECT_TRUE(log.contains(Code("N5004")));
    EXPECT_LT(glm::dot(*q * Vec3(0, 1, 0), Vec3(0, 1, 0)), -0.999999);
  }
  DiagnosticLog log;
  ASSERT_TRUE(looking_at({1.1e-5, 0, 10}, {0, 0, 0}, {}, log));
  EXPECT_FALSE(log.contains(Code("N5004")));
}

TEST(LookingAt, ReplacesEvenPlusY) {
  DiagnosticLog log;
  const auto q = looking_at({0, -7, 0}, {0, 0, 0}, Vec3(0, 2, 0), log);
  ASSERT_TRUE(q);
  EXPECT_TRUE(log.contains(Code("N5004")));
  expect_near(*q * Vec3(0, 1, 0), {0, 0, -1}, 1e-15);
}

TEST(LookingAt, RefusesNoDirection) {
  DiagnosticLog log;
  EXPECT_FALSE(looking_at({1, 2, 3}, {1, 2, 3}, {}, log));
  EXPECT_FALSE(looking_at({1, 2, 3}, {0, 0, 0}, Vec3(0), log));
  EXPECT_EQ(log.errors(), 2u);
  EXPECT_TRUE(log.contains(Code("E0201")));
}

TEST(Camera, FieldOfViewIsHorizontalAndFull) {
  Camera camera;
  set_field_of_view(camera, 800, 600, 90 * kDegree);
  EXPECT_NEAR(camera.focal.x, 400, 1e-12);
  EXPECT_EQ(camera.focal.x, camera.focal.y);
  EXPECT_EQ(camera.principal, Vec2(400, 300));
  const Vec3 left = pixel_ray(camera, {0, 300}).direction;
  const Vec3 right = pixel_ray(camera, {800, 300}).direction;
  EXPECT_NEAR(angle_between(left, right), 90 * kDegree, 1e-15);
}

TEST(Camera, PixelAngleIsThatOfTheAxis) {
  Camera camera;
  set_pixel_angle(camera, 1024, 1024, 1e-6);
  const double angle = angle_between(pixel_ray(camera, {511.5, 512}).direction,
                                     pixel_ray(camera, {512.5, 512}).direction);
  EXPECT_NEAR(angle / 1e-6, 1, 1e-9);  // measured 3e-11: rounding of unit vectors
}

TEST(Camera, ProjectInvertsPixelRay) {
  Camera camera;
  set_field_of_view(camera, 640, 480, 1.2);
  camera.position = {10, -20, 30};
  camera.world_from_camera = looks(camera.position, {1, 2, 3});
  camera.principal += Vec2(13.5, -7.25);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    camera.projection = projection;
    for (const Vec2& pixel : {Vec2(0, 0), Vec2(640, 480), Vec2(123.4, 321.0)})
      for (const double distance : {1e-3, 1.0, 1e8}) {
        const geometry::Ray ray = pixel_ray(camera, pixel);
        EXPECT_NEAR(glm::length(ray.direction), 1, 4e-16);
        const auto back = project(camera, ray.origin + distance * ray.direction);
        ASSERT_TRUE(back);
        // the point itself is rounded to 1 part in 2^53 of its coordinates
        const double coordinates = 40 + distance;
        const double tolerance = projection == Projection::perspective
                                     ? 6e-13 * coordinates / distance  // measured 2.3e-13
                                     : 2.5e-13 * coordinates;          // measured 1.2e-13
        EXPECT_LE(glm::length(*back - pixel), tolerance);
      }
  }
}

TEST(Camera, NothingProjectsFromBehind) {
  Camera camera;
  EXPECT_FALSE(project(camera, {0, 0, -1}));
  EXPECT_FALSE(project(camera, {0, 0, 0}));
  EXPECT_TRUE(project(camera, {0, 0, 1e-300}));
}

// Oracle: the solid angle of a rectangle seen from a point above its centre,
// 4·asin(sin(a/2)·sin(b/2)) with a, b the full angles (Khadjavi 1968).
TEST(Camera, SolidAnglesAddUpToTheImage) {
  struct Case {
    std::uint32_t width, height;
    double fov;
  };
  for (const Case& c : {Case{64, 48, 1e-6}, Case{64, 48, 0.2}, Case{200, 100, 2.0}, Case{3, 5, 2.9},
                        Case{1, 1, 3.0}, Case{31, 1, 1.0}}) {
    Camera camera;
    set_field_of_view(camera, c.width, c.height, c.fov);
    double sum = 0;
    for (std::uint32_t j = 0; j < c.height; ++j)
      for (std::uint32_t i = 0; i < c.width; ++i) sum += pixel_solid_angle(camera, i, j);
    const double half_a = std::atan(c.width / 2.0 / camera.focal.x);
    const double half_b = std::atan(c.height / 2.0 / camera.focal.y);
    const double exact = 4 * std::asin(std::sin(half_a) * std::sin(half_b));
    EXPECT_NEAR(sum / exact, 1, 1e-12) << c.width << ' ' << c.fov;
  }
}

// Oracle: the corners' closed form atan(xy/√(1+x²+y²)) with 60 digits (mpmath).
TEST(Camera, SolidAngleOfAnyPixel) {
  const struct {
    double focal, x, y;
    std::uint32_t column, row;
    double exact;
  } cases[] = {
      {1024.0, 512, 512, 0, 0, 5.196216446432790398944e-7},
      {1e6, 512, 512, 1023, 3, 9.999992196935073991957e-13},
      // a hair under 0.02 rad a pixel and above it, up to 83° off the axis
      {60.0, 512, 512, 0, 512, 4.392499717842473307055e-7},
      {60.0, 512, 512, 1000, 20, 1.782981050511057668202e-7},
      {49.0, 512, 512, 0, 0, 1.285677890143690376083e-7},
      {30.0, 4096, 16, 0, 0, 4.366728489620397891351e-10},
      // wide pixels, up to 90° off
      {4.0, 512, 4, 0, 0, 2.988500709437007554049e-8},
      {4.0, 512, 512, 0, 0, 1.05671646878224226062e-8},
      {0.25, 32, 32, 0, 63, 0.000002828296351451500708314},
      // around the axis: a third of half a sphere, and almost all of it
      {0.5, 0.5, 0.5, 0, 0, 2.094395102393195492308},
      {0.001, 0.5, 0.5, 0, 0, 6.271871617536733899137},
      {0.125, 1.25, 1.75, 1, 1, 4.426342069937514416145},
      {2e8, 0.5, 0.5, 0, 0, 2.499999999999999984375e-17},
  };
  for (const auto& c : cases) {
    Camera camera;
    camera.width = camera.height = 8192;
    camera.focal = Vec2(c.focal);
    camera.principal = {c.x, c.y};
    const double off = pixel_solid_angle(camera, c.column, c.row) / c.exact - 1;
    // measured: 4.4e-16, and 3.5e-14 of the pixel that spans 179.9 degrees
    EXPECT_NEAR(off, 0, c.focal < 0.01 ? 1e-13 : 2e-15)
        << c.focal << ' ' << c.column << ' ' << c.row;
  }
}

TEST(Camera, SolidAngleOfOnePixelOffAxis) {
  Camera camera;
  set_field_of_view(camera, 1000, 1000, 1.5);
  // p²·cos³θ/f² at the pixel's centre is off by the second derivative over the pixel, about 1/f²
  const double theta = angle_between(pixel_ray(camera, {900.5, 100.5}).direction, {0, 0, 1});
  const double midpoint = std::pow(std::cos(theta) / camera.focal.x, 2) * std::cos(theta);
  EXPECT_NEAR(pixel_solid_angle(camera, 900, 100) / midpoint, 1, 1e-6);  // measured 4e-7
}

Camera distorted(const sensor::Distortion& distortion, double focal) {
  Camera camera;
  camera.focal = {focal, 1.1 * focal};
  camera.principal = {500, 520};
  camera.position = {1, -2, 3};
  camera.world_from_camera = glm::angleAxis(kPi / 2, glm::normalize(Vec3(1, 2, 3)));
  camera.distortion = std::make_shared<sensor::DistortionMap>(distortion);
  return camera;
}

TEST(Camera, DistortedRaysProjectBack) {
  for (const sensor::Distortion& each :
       {sensor::Distortion(sensor::Brown{{-.2, .1, 4e-3, -3e-3}}),
        sensor::Distortion(sensor::Fisheye{{-.02, .005}}),
        sensor::Distortion(sensor::Cahvore{.e = {0.2, 0, 0}, .linearity = 0.5})}) {
    const Camera camera = distorted(each, 500);
    for (const Vec2& pixel : {Vec2(500, 520), Vec2(0.5, 1023.5), Vec2(900, 300)}) {
      const auto ray = distorted_ray(camera, pixel);
      ASSERT_TRUE(ray);
      const auto back = project(camera, ray->origin + 7.0 * ray->direction);
      ASSERT_TRUE(back);
      EXPECT_LE(glm::length(*back - pixel), 1e-11);
    }
  }
  const Camera brown = distorted(sensor::Brown{{-.2}}, 500);
  EXPECT_FALSE(project(brown, brown.position + brown.world_from_camera * Vec3(0, 0, -1)));
  // without: the same as pixel_ray()
  Camera plain;
  EXPECT_EQ(distorted_ray(plain, {3, 4})->direction, pixel_ray(plain, {3, 4}).direction);
}

// Pixels add up to the polygon of the border; without terms to the closed form of a pyramid.
TEST(Camera, DistortedSolidAngles) {
  Camera camera = distorted(sensor::Pinhole{}, 60);
  camera.width = 64, camera.height = 48;
  camera.focal = {60, 70};
  camera.principal = {32, 24};
  double sum = 0;
  for (unsigned row = 0; row < 48; ++row)
    for (unsigned column = 0; column < 64; ++column) sum += pixel_solid_angle(camera, column, row);
  const double a = 32 / 60.0, b = 24 / 70.0;
  EXPECT_NEAR(sum, 4 * std::atan(a * b / std::sqrt(1 + a * a + b * b)), 1e-14);
  // of an equidistant lens dΩ = sin θ/θ dx dy, here 0.01 rad a pixel: 4.2e-6 for squares
  Camera fisheye = distorted(sensor::Fisheye{}, 100);
  fisheye.focal = Vec2(100);
  fisheye.principal = Vec2(0);
  for (const unsigned column : {0u, 50u, 140u}) {
    const double theta = std::hypot(column + 0.5, 0.5) / 100;
    EXPECT_NEAR(pixel_solid_angle(fisheye, column, 0) / (1e-4 * std::sin(theta) / theta), 1, 2e-5);
  }
  // narrow: one millionth of a radian
  const Camera narrow = distorted(sensor::Pinhole{}, 1e6);
  EXPECT_NEAR(pixel_solid_angle(narrow, 500, 520) * 1.1e12, 1, 1e-9);
  // beyond a fold at r' = 0.70 there is nothing
  EXPECT_EQ(pixel_solid_angle(distorted(sensor::Brown{{-.3}}, 500), 0, 0), 0);
}

TEST(Camera, OrthographicPixels) {
  Camera camera;
  set_orthographic(camera, 400, 200, 8);
  EXPECT_DOUBLE_EQ(pixel_area(camera), 0.02 * 0.02);
  EXPECT_EQ(pixel_ray(camera, {400, 100}).origin, Vec3(4, 0, 0));
}

TEST(Camera, RidesOnAFrame) {
  const Quat turn = glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3)));
  const Mat4 node = matrix_from_trs({5, 6, 7}, turn, {2, 2, 2});
  const Quat frame = glm::angleAxis(-1.1, glm::normalize(Vec3(-1, 0, 2)));
  Camera camera;
  place_in_frame(camera, node, {1, 0, 0}, frame);
  expect_near(camera.position, Vec3(5, 6, 7) + 2.0 * (turn * Vec3(1, 0, 0)), 1e-14);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit(0);
    unit[axis] = 1;
    expect_near(camera.world_from_camera * unit, turn * (frame * unit), 1e-15);
  }
}

TEST(Camera, StaysRightHandedInAMirroredNode) {
  const Mat4 node = matrix_from_trs({0, 0, 0}, Quat(1, 0, 0, 0), {-1, 1, 1});
  Camera camera;
  place_in_frame(camera, node, {3, 0, 0}, Quat(1, 0, 0, 0));
  EXPECT_EQ(camera.position, Vec3(-3, 0, 0));
  expect_near(camera.world_from_camera * Vec3(0, 0, 1), {0, 0, 1}, 1e-15);
  expect_near(camera.world_from_camera * Vec3(0, 1, 0), {0, 1, 0}, 1e-15);
  expect_near(camera.world_from_camera * Vec3(1, 0, 0), {1, 0, 0}, 1e-15);
}

TEST(Camera, PoseIsRigid) {
  const Pose pose{{1, 2, 3}, glm::angleAxis(0.5, Vec3(0, 0, 1))};
  const Vec4 moved = pose.matrix() * Vec4(1, 0, 0, 1);
  expect_near(Vec3(moved), {1 + std::cos(0.5), 2 + std::sin(0.5), 3}, 1e-15);
}

}  // namespace
}  // namespace panwright::world::camera_test
