#include "geometry/tessellate/mapping.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::mapping_test {
namespace {

// Every triangle is a sensible piece of the texture, and every corner is where it belongs.
void expect_mapped(const Mesh& mesh, const Mat4& texture_from_mesh, double widest) {
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    double low = 3;
    double high = -3;
    for (const std::uint32_t v : t) {
      const Vec2& uv = mesh.texcoords[v];
      const Vec3 p = Vec3(texture_from_mesh * Vec4(mesh.positions[v], 1));
      low = std::min(low, uv.x);
      high = std::max(high, uv.x);
      const double across = std::hypot(p.x, p.y);
      EXPECT_NEAR(uv.y, 0.5 + std::atan2(p.z, across) / M_PI, 1e-15);
      if (across < 1e-9) continue;
      EXPECT_NEAR(std::remainder(uv.x - std::atan2(p.y, p.x) / (2 * M_PI), 1.0), 0, 1e-15);
    }
    EXPECT_LE(high - low, widest);
    EXPECT_GE(low, 0);
    EXPECT_LT(low, 1);
  }
}

TEST(SphereMapping, EqualsTheCoordinatesOfATexturedSphere) {
  Mesh mesh = shapes::sphere(10, 16);
  const std::size_t triangles = mesh.triangles.size();
  const std::size_t vertices = mesh.positions.size();
  apply_sphere_mapping(mesh, Mat4(1));
  expect_mapped(mesh, Mat4(1), 1.0 / 16 + 1e-12);
  // each ring's first vertex once more, and each pole once for each triangle
  EXPECT_EQ(mesh.positions.size(), vertices + 9 + 2 * 15);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_TRUE(check(mesh).closed);

  const Mesh reference = shapes::sphere(10, 16, 1, true);
  for (std::size_t i = 0; i < triangles; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = mesh.texcoords[mesh.triangles[i][k]];
      const Vec2 b = reference.texcoords[reference.triangles[i][k]];
      EXPECT_NEAR(a.x, b.x, 1e-15);
      EXPECT_NEAR(a.y, b.y, 1e-15);
    }
  }
}

TEST(SphereMapping, InAnotherFrame) {
  shapes::Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Mesh mesh = shapes::sphere(30, 40, 2);
    const Vec3 axis = random.direction();
    const double half = random.between(0, kPi);
    const Quat rotation(std::cos(half), axis * std::sin(half));
    const Mat4 frame = matrix_from_trs(0.1 * random.direction(), rotation, Vec3(0.3));
    const std::size_t triangles = mesh.triangles.size();
    apply_sphere_mapping(mesh, frame);
    EXPECT_EQ(mesh.triangles.size(), triangles);
    // a pole of the texture inside a triangle: three longitudes lie on two thirds of a circle
    expect_mapped(mesh, frame, 2.0 / 3 + 1e-12);
    EXPECT_TRUE(check(mesh).closed);
  }
}

TEST(SphereMapping, ATriangleAcrossTheSeamGetsItsOwnVertices) {
  Mesh mesh;
  mesh.positions = {{1, -0.1, 0}, {1, 0.1, 0}, {1, 0, 0.2}, {1, 0.3, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  apply_sphere_mapping(mesh, Mat4(1));
  ASSERT_EQ(mesh.positions.size(), 6u);
  // the vertex west of the seam stays; the two on the other side are there twice
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 4, 5}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{1, 3, 2}));
  EXPECT_EQ(mesh.texcoords[4], mesh.texcoords[1] + Vec2(1, 0));
  EXPECT_EQ(mesh.texcoords[5], Vec2(1, mesh.texcoords[2].y));
  EXPECT_EQ(mesh.positions[4], mesh.positions[1]);
}

TEST(SphereMapping, HardPlaces) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0},       {0, 0, 5},           {0, 0, -5},    {1e-200, 0, 0},
                    {1, -1e-300, 0}, {-1, -1e-300, 1e-9}, {1e12, 1, -3}, {1e-9, -1e-9, 1e12}};
  for (std::uint32_t a = 0; a < 8; ++a)
    for (std::uint32_t b = a + 1; b < 8; ++b) mesh.triangles.push_back({a, b, (b + 1) % 8});
  apply_sphere_mapping(mesh, Mat4(1));
  for (const Vec2& uv : mesh.texcoords) {
    EXPECT_TRUE(uv.x >= 0 && uv.x < 2) << uv.x;
    EXPECT_TRUE(uv.y >= 0 && uv.y <= 1) << uv.y;
  }
}

// A box's own coordinates, thrown away and found again from its bounds.
TEST(BoxMapping, equals_that_of_a_box) {
  DiagnosticLog log;
  TessellationOptions options;
  options.texcoords = true;
  const auto box = tessellated(Box{{1, 2, 3}, 0, false}, options, {}, log);
  ASSERT_TRUE(box);
  Mesh welded;  // eight corners, as a CAD file has them
  for (const Triangle& t : box->triangles) {
    Triangle out;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = box->positions[t[k]];
      const auto found = std::find(welded.positions.begin(), welded.positions.end(), p);
      out[k] = static_cast<std::uint32_t>(found - welded.positions.begin());
      if (found == welded.positions.end()) welded.positions.push_back(p);
    }
    welded.triangles.push_back(out);
  }
  ASSERT_EQ(welded.positions.size(), 8u);
  apply_box_mapping(welded);
  EXPECT_EQ(welded.positions.size(), 24u);
  ASSERT_EQ(welded.texcoords.size(), 24u);
  for (std::size_t i = 0; i < welded.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(welded.positions[welded.triangles[i][k]], box->positions[box->triangles[i][k]]);
      EXPECT_EQ(welded.texcoords[welded.triangles[i][k]], box->texcoords[box->triangles[i][k]])
          << i << " " << k;
    }
}

TEST(BoxMapping, flat_meshes_and_those_without_area_have_finite_coordinates) {
  Mesh mesh;
  mesh.positions = {{0, 0, 5}, {2, 0, 5}, {0, 4, 5}, {1, 1, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 3}};
  apply_box_mapping(mesh);
  EXPECT_EQ(mesh.texcoords[1], Vec2(1, 0));
  EXPECT_EQ(mesh.texcoords[2], Vec2(0, 1));
  for (const Vec2& uv : mesh.texcoords) EXPECT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y));
}

}  // namespace
}  // namespace panwright::geometry::mapping_test
