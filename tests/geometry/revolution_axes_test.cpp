// Axes of cylinders, cones, tori and circles in meshes: held against the ones they were made about.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/mesh/revolution_axes.h"

namespace panwright::geometry::revolution_axes_test {
namespace {

// A mesh of rings about +z: points of the profile (radius, height), `segments` over an arc.
Mesh revolved(const std::vector<Vec2>& profile, std::size_t segments, double arc = 2 * kPi,
              bool closed_profile = false) {
  Mesh mesh;
  const bool around = arc > 6.28;
  const std::size_t columns = around ? segments : segments + 1;
  for (std::size_t j = 0; j < columns; ++j) {
    const double angle = 0.3 + arc * static_cast<double>(j) / static_cast<double>(segments);
    for (const Vec2& p : profile)
      mesh.positions.emplace_back(p.x * std::cos(angle), p.x * std::sin(angle), p.y);
  }
  const std::size_t rows = profile.size();
  const auto at = [&](std::size_t j, std::size_t i) {
    return static_cast<std::uint32_t>((j % columns) * rows + i % rows);
  };
  for (std::size_t j = 0; j < segments; ++j)
    for (std::size_t i = 0; i + (closed_profile ? 0 : 1) < rows; ++i) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  return mesh;
}

Mesh cylinder(std::size_t segments, double arc = 2 * kPi) {
  return revolved({{0.5, -1}, {0.5, 1.5}}, segments, arc);
}

void append(Mesh& mesh, const Mesh& other, const Vec3& by = Vec3(0)) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p + by);
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Mesh box(const Vec3& size) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back(Vec3(k & 1, k >> 1 & 1, k >> 2 & 1) * size - size / 2.0);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh moved(Mesh mesh, const Mat3& turn, const Vec3& by = Vec3(0)) {
  for (Vec3& p : mesh.positions) p = turn * p + by;
  if (glm::determinant(turn) < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

Mat3 some_turn() { return glm::mat3_cast(glm::normalize(Quat(0.3, -0.7, 0.5, 0.4))); }

// Radians between lines.
double off_axis(const RevolvedFaces& found, const Vec3& axis) {
  return std::asin(std::min(1.0, glm::length(glm::cross(found.axis, glm::normalize(axis)))));
}
double off_line(const RevolvedFaces& found, const Vec3& point) {
  return glm::length(glm::cross(found.axis, point - found.origin));
}

TEST(RevolutionAxes, CylindersOfAnyNumberOfSidesSizeAndPlace) {
  double worst_angle = 0, worst_place = 0, worst_radius = 0;
  for (const std::size_t segments : {8, 9, 12, 16, 31, 64})
    for (const double arc : {2 * kPi, kPi, kPi / 2})
      for (const double scale : {1e-6, 1.0, 1e6})
        for (const double mirror : {1.0, -1.0}) {
          const Mat3 turn = scale * some_turn() * Mat3(mirror, 0, 0, 0, 1, 0, 0, 0, 1);
          const Vec3 by = scale * Vec3(3, -2, 7);
          const auto found = revolved_faces(moved(cylinder(segments, arc), turn, by));
          ASSERT_EQ(found.size(), 1u) << segments << ' ' << arc << ' ' << scale;
          EXPECT_EQ(found[0].kind, RevolvedKind::cylinder);
          worst_angle = std::max(worst_angle, off_axis(found[0], turn * Vec3(0, 0, 1)));
          worst_place = std::max(worst_place, off_line(found[0], by) / scale);
          worst_radius = std::max(worst_radius, std::fabs(found[0].radius / scale - 0.5));
          EXPECT_NEAR(found[0].high - found[0].low, 2.5 * scale, 1e-9 * scale);
          EXPECT_LT(found[0].residual, 1e-13 * scale);
          const double side = arc / static_cast<double>(segments);
          const double area = 2.5 * std::sin(side / 2) * static_cast<double>(segments);
          EXPECT_NEAR(found[0].area, area * scale * scale, 1e-9 * scale * scale);
          EXPECT_NEAR(found[0].turn, arc - side, 1e-6);
        }
  EXPECT_LT(worst_angle, 1e-9);  // measured 2.4e-16
  EXPECT_LT(worst_place, 1e-9);  // measured 1.3e-15
  EXPECT_LT(worst_radius, 1e-9);
}

TEST(RevolutionAxes, ScaledAlongTheAxisOnlyItStaysOne) {
  const Mat3 along(1, 0, 0, 0, 1, 0, 0, 0, 40), across(1, 0, 0, 0, 1.3, 0, 0, 0, 1);
  const auto found = revolved_faces(moved(moved(cylinder(24), along), some_turn()));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(off_axis(found[0], some_turn() * Vec3(0, 0, 1)), 1e-9);
  EXPECT_TRUE(revolved_faces(moved(cylinder(24), across)).empty());
}

TEST(RevolutionAxes, NoiseStaysInTheResidual) {
  for (const std::size_t segments : {8, 16, 32, 64})
    for (const double arc : {2 * kPi, kPi / 2}) {
      double worst_angle = 0, worst_place = 0;
      for (int seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        Mesh mesh = moved(cylinder(segments, arc), some_turn());
        const auto number = [&] { return 2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1; };
        for (Vec3& p : mesh.positions) p += 1e-4 * Vec3(number(), number(), number());
        const auto found = revolved_faces(mesh);
        ASSERT_EQ(found.size(), 1u) << segments << ' ' << arc;
        worst_angle = std::max(worst_angle, off_axis(found[0], some_turn() * Vec3(0, 0, 1)));
        worst_place = std::max(worst_place, off_line(found[0], some_turn() * Vec3(0, 0, 0.25)));
        EXPECT_LT(found[0].residual, 1e-4);
        EXPECT_GT(found[0].residual, 1e-5);
      }

      const bool whole = arc > 4;
      EXPECT_LT(worst_angle, whole ? 1e-4 : 6e-4);
      EXPECT_LT(worst_place, whole ? 1e-4 : 6e-4);
    }
}

TEST(RevolutionAxes, ConesAndTori) {
  const Mat3 turn = some_turn();
  const Vec3 by(1, 2, 3);
  for (const std::size_t segments : {8, 13, 32, 64})
    for (const double arc : {2 * kPi, kPi / 2}) {
      for (const Mesh& mesh : {revolved({{1, 0}, {0.4, 1}}, segments, arc),
                               revolved({{0.5, 0}, {0.45, 3}}, segments, arc),
                               revolved({{1, 0}, {0.01, 0.5}}, segments, arc)}) {
        const auto found = revolved_faces(moved(mesh, turn, by));
        ASSERT_EQ(found.size(), 1u) << segments << ' ' << arc;
        EXPECT_EQ(found[0].kind, RevolvedKind::cone);
        EXPECT_LT(off_axis(found[0], turn * Vec3(0, 0, 1)), 1e-9);
        EXPECT_LT(off_line(found[0], by), 1e-9);
      }
      std::vector<Vec2> tube;
      for (int i = 0; i < 16; ++i)
        tube.emplace_back(1 + 0.3 * std::cos(kPi * i / 8), 0.3 * std::sin(kPi * i / 8));
      const auto found = revolved_faces(moved(revolved(tube, segments, arc, true), turn, by));
      ASSERT_EQ(found.size(), 1u) << segments << ' ' << arc;
      EXPECT_EQ(found[0].kind, RevolvedKind::torus);
      EXPECT_LT(off_axis(found[0], turn * Vec3(0, 0, 1)), 1e-9);
      EXPECT_LT(off_line(found[0], by), 1e-9);
      EXPECT_NEAR(found[0].radius, 1, 1e-9);
    }
}

TEST(RevolutionAxes, AmongOtherParts) {
  Mesh mesh = box({4, 3, 2});
  append(mesh, moved(cylinder(16), some_turn(), {0.5, 2, 3}));
  append(mesh, moved(cylinder(12), 0.1 * Mat3(1)), {5, 0, 0});
  append(mesh, box({0.2, 0.1, 7}), {9, 0, 0});
  const auto found = revolved_faces(mesh);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(off_axis(found[0], some_turn() * Vec3(0, 0, 1)), 1e-9);
  EXPECT_LT(off_line(found[0], {0.5, 2, 3}), 1e-9);
  EXPECT_LT(off_axis(found[1], {0, 0, 1}), 1e-9);
  EXPECT_LT(off_line(found[1], {5, 0, 0}), 1e-9);
  EXPECT_FALSE(share_axis(found[0], found[1]));
  EXPECT_TRUE(share_axis(found[0], found[0]));
}

// One group: a cylinder that a fillet joins to a plate.
TEST(RevolutionAxes, ACylinderThatRunsOutInAFillet) {
  std::vector<Vec2> profile{{3, 0}, {2, 0}};
  for (int i = 0; i <= 8; ++i)
    profile.emplace_back(0.7 - 0.2 * std::sin(kPi * i / 16), 0.2 - 0.2 * std::cos(kPi * i / 16));
  profile.emplace_back(0.5, 1.5);
  const auto found = revolved_faces(moved(revolved(profile, 32), some_turn(), {1, 1, 1}));
  ASSERT_GE(found.size(), 1u);
  EXPECT_EQ(found[0].kind, RevolvedKind::cylinder);
  EXPECT_NEAR(found[0].radius, 0.5, 1e-9);
  EXPECT_LT(off_axis(found[0], some_turn() * Vec3(0, 0, 1)), 1e-9);
  EXPECT_LT(off_line(found[0], {1, 1, 1}), 1e-9);
}

// Two half cylinders and the planes between them: the wall of a slot.
TEST(RevolutionAxes, BothEndsOfASlot) {
  Mesh mesh;
  const int half = 12;
  for (int k = 0; k < 2 * (half + 1); ++k) {
    const int end = k / (half + 1), i = k % (half + 1);
    const double angle = kPi * (end + static_cast<double>(i) / half) - kPi / 2;
    for (const double z : {0.0, 1.0})
      mesh.positions.emplace_back((end == 0 ? 2 : -2) + 0.5 * std::cos(angle),
                                  0.5 * std::sin(angle), z);
  }
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t k = 0; k < count; k += 2) {
    const std::uint32_t a = k, b = (k + 2) % count;
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  auto found = revolved_faces(mesh);
  ASSERT_EQ(found.size(), 2u);
  for (const RevolvedFaces& each : found) {
    EXPECT_LT(off_axis(each, {0, 0, 1}), 1e-9);
    EXPECT_NEAR(each.radius, 0.5, 1e-9);
    EXPECT_NEAR(std::fabs(each.origin.x), 2, 1e-9);
  }
  EXPECT_FALSE(share_axis(found[0], found[1]));
}

TEST(RevolutionAxes, WhatHasNone) {
  EXPECT_TRUE(revolved_faces(box({1, 2, 3})).empty());
  EXPECT_TRUE(revolved_faces({}).empty());
  std::vector<Vec2> ball;
  for (int i = 0; i <= 24; ++i) ball.emplace_back(std::sin(kPi * i / 24), std::cos(kPi * i / 24));
  EXPECT_TRUE(revolved_faces(revolved(ball, 32)).empty());
  EXPECT_TRUE(revolved_faces(cylinder(6)).size() <= 2);  // a hexagon: at most its open ends
  // a panel whose edges are cut at 45 degrees
  Mesh panel = revolved({{1, 0}, {1, 1}}, 8);
  for (Vec3& p : panel.positions) p.x += p.x > 0 ? 1 : -1;
  for (const RevolvedFaces& each : revolved_faces(panel))
    EXPECT_EQ(each.kind, RevolvedKind::circle);
}

TEST(RevolutionAxes, HolesInSheets) {
  Mesh mesh;  // between a square of 16 points and a circle
  for (int k = 0; k < 16; ++k) {
    const double angle = 2 * kPi * k / 16;
    const Vec2 d(std::cos(angle), std::sin(angle));
    const double out = 2 / std::max(std::fabs(d.x), std::fabs(d.y));
    mesh.positions.emplace_back(out * d.x, out * d.y, 0);
    mesh.positions.emplace_back(0.25 + 0.5 * d.x, 0.5 * d.y, 0);
  }
  for (std::uint32_t k = 0; k < 32; k += 2) {
    const std::uint32_t n = (k + 2) % 32;
    mesh.triangles.push_back({k, n, n + 1});
    mesh.triangles.push_back({k, n + 1, k + 1});
  }
  const auto found = revolved_faces(moved(mesh, some_turn(), {4, 5, 6}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, RevolvedKind::circle);
  EXPECT_LT(off_axis(found[0], some_turn() * Vec3(0, 0, 1)), 1e-9);
  EXPECT_LT(glm::length(found[0].origin - (some_turn() * Vec3(0.25, 0, 0) + Vec3(4, 5, 6))), 1e-9);
  EXPECT_NEAR(found[0].radius, 0.5, 1e-9);
}

TEST(RevolutionAxes, HostileMeshesEnd) {
  Mesh mesh = cylinder(16);
  for (Vec3& p : mesh.positions) p *= 0;
  EXPECT_TRUE(revolved_faces(mesh).empty());
  mesh = cylinder(16);
  for (Vec3& p : mesh.positions) p.z = 0;
  EXPECT_TRUE(revolved_faces(mesh).empty());
  std::mt19937_64 random(5);
  for (int i = 0; i < 200; ++i) {
    Mesh soup;
    for (int k = 0; k < 30; ++k)
      soup.positions.emplace_back(static_cast<double>(random() % 5),
                                  static_cast<double>(random() % 5),
                                  static_cast<double>(random() % 5));
    for (int k = 0; k < 60; ++k)
      soup.triangles.push_back({static_cast<std::uint32_t>(random() % 30),
                                static_cast<std::uint32_t>(random() % 30),
                                static_cast<std::uint32_t>(random() % 30)});
    for (const RevolvedFaces& each : revolved_faces(soup)) {
      EXPECT_TRUE(is_finite(each.axis) && is_finite(each.origin));
      EXPECT_NEAR(glm::length(each.axis), 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace panwright::geometry::revolution_axes_test
