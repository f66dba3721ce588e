#include "geometry/mesh/check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::check_test {
namespace {

using shapes::cube;

TEST(Check, ASoundCube) {
  Mesh mesh = cube();
  mesh.normals.assign(8, {0, 0, 1});
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.bad_lengths + report.bad_indices + report.non_finite + report.bad_normals, 0u);
  EXPECT_EQ(report.degenerate_triangles + report.boundary_edges, 0u);
  EXPECT_EQ(report.non_manifold_edges + report.misoriented_edges, 0u);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.volume, 8);
  EXPECT_EQ(report.area, 24);
}

TEST(Check, BadLengths) {
  Mesh mesh = cube();
  mesh.normals.assign(7, {0, 0, 1});
  mesh.texcoords.assign(9, {0, 0});
  mesh.colors.assign(8, {1, 1, 1});
  EXPECT_EQ(check(mesh).bad_lengths, 2u);
}

TEST(Check, BadIndices) {
  Mesh mesh = cube();
  mesh.triangles[3][1] = 8;
  mesh.triangles[7][2] = 0xffffffffu;
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.bad_indices, 2u);
  EXPECT_FALSE(report.closed);
}

TEST(Check, NumbersThatAreNotFinite) {
  Mesh mesh = cube();
  mesh.positions[0].x = std::nan("");
  mesh.positions[1].y = HUGE_VAL;
  mesh.normals.assign(8, {0, 0, 1});
  mesh.normals[2].z = -HUGE_VAL;
  mesh.texcoords.assign(8, {0, 0});
  mesh.texcoords[3].y = std::nan("");
  mesh.colors.assign(8, {0, 0, 0});
  mesh.colors[3].z = std::nan("");  // the same vertex counts once
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.non_finite, 4u);
  EXPECT_TRUE(std::isfinite(report.area));
  EXPECT_TRUE(std::isfinite(report.volume));
}

TEST(Check, BadNormals) {
  Mesh mesh = cube();
  mesh.normals.assign(8, {0, 0, 1});
  mesh.normals[2] = {0, 0, 0};
  mesh.normals[5] = {0, 0, 1.00001};
  mesh.normals[6] = {0, 0, 1.0000001};
  EXPECT_EQ(check(mesh).bad_normals, 2u);
}

TEST(Check, DegenerateTriangles) {
  Mesh mesh = cube();
  mesh.positions.push_back({0, 0, 1});       // 8
  mesh.positions.push_back({0, 0, 1});       // 9: the same place
  mesh.positions.push_back({0.5, 1e-8, 1});  // 10: on the line from 8 to 11 but for 2e-8
  mesh.positions.push_back({1, 0, 1});       // 11
  mesh.positions.push_back({0.5, 1e-6, 1});  // 12: off it
  mesh.triangles.push_back({8, 8, 11});
  mesh.triangles.push_back({8, 9, 11});
  mesh.triangles.push_back({8, 11, 10});
  mesh.triangles.push_back({8, 11, 12});
  EXPECT_EQ(check(mesh).degenerate_triangles, 3u);
}

TEST(Check, BoundaryEdges) {
  Mesh mesh = cube();
  mesh.triangles.pop_back();
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.boundary_edges, 3u);
  EXPECT_FALSE(report.closed);
  mesh.triangles.pop_back();  // the whole face is gone
  EXPECT_EQ(check(mesh).boundary_edges, 4u);
}

TEST(Check, NonManifoldEdges) {
  Mesh mesh = cube();
  mesh.positions.push_back({3, 3, 3});
  mesh.triangles.push_back({0, 1, 8});  // a fin on the edge 0–1
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.non_manifold_edges, 1u);
  EXPECT_EQ(report.boundary_edges, 2u);
  EXPECT_FALSE(report.closed);
}

TEST(Check, MisorientedEdges) {
  Mesh mesh = cube();
  std::swap(mesh.triangles[4][1], mesh.triangles[4][2]);
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.misoriented_edges, 3u);
  EXPECT_EQ(report.boundary_edges, 0u);
  EXPECT_FALSE(report.closed);
}

TEST(Check, AnInsideOutMeshHasNegativeVolume) {
  Mesh mesh = cube();
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.volume, -8);
}

TEST(Check, VerticesAtOnePlaceCountAsOne) {
  const Mesh original = cube();
  Mesh soup;
  for (const Triangle& t : original.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t) soup.positions.push_back(original.positions[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  soup.positions[0] += Vec3(0.0);
  const MeshReport report = check(soup);
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.volume, 8);
  soup.positions[0].x = std::nextafter(soup.positions[0].x, 0.0);
  EXPECT_FALSE(check(soup).closed);
}

TEST(Check, PositiveAndNegativeZeroAreOnePlace) {
  Mesh mesh;
  mesh.positions = {{0.0, 0.0, 0.0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, -0.0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {3, 1, 4}, {3, 4, 2}, {1, 2, 4}};
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume, 1.0 / 6, 1e-16);
}

TEST(Check, FarFromTheOriginVolumeKeepsItsDigits) {
  Mesh mesh = cube();
  for (Vec3& p : mesh.positions) p += Vec3(1e9, -3e9, 7e8);
  EXPECT_NEAR(check(mesh).volume, 8, 1e-14);  // 0 measured
}

TEST(Check, AnEmptyMeshIsNotClosed) {
  const MeshReport report = check(Mesh{});
  EXPECT_FALSE(report.closed);
  EXPECT_EQ(report.area, 0);
}

TEST(Check, SetClosed) {
  Mesh mesh = cube();
  mesh.closed = false;
  set_closed(mesh);
  EXPECT_TRUE(mesh.closed);
  mesh.triangles.pop_back();
  set_closed(mesh);
  EXPECT_FALSE(mesh.closed);
}

}  // namespace
}  // namespace panwright::geometry::check_test
