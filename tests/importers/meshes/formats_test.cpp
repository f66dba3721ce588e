// One model through all formats: the same triangles, area and volume.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::formats_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Triangles by their corners' places, each from its smallest corner on, sorted.
std::vector<std::array<std::array<double, 3>, 3>> triangles_of(const geometry::Mesh& mesh) {
  std::vector<std::array<std::array<double, 3>, 3>> out;
  for (const geometry::Triangle& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.positions[t[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Its coordinates and triangles alone: what single precision and STL can say.
Polyhedron rounded_ball() {
  Polyhedron out = ball(12, 16);
  for (Vec3& p : out.points)
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(p[k]);
  std::vector<std::vector<std::uint32_t>> triangles;
  for (const auto& f : out.faces)
    for (std::size_t k = 2; k < f.size(); ++k) triangles.push_back({f[0], f[k - 1], f[k]});
  out.faces = triangles;
  return out;
}

struct Written {
  const char* name;
  std::string bytes;
};

std::vector<Written> all_formats(const Polyhedron& in) {
  return {{"m.obj", obj_of(in)},
          {"text.stl", stl_text_of(in)},
          {"binary.stl", stl_binary_of(in)},
          {"solid.stl", stl_binary_of(in, "solid as some programs write it")},
          {"text.ply", ply_of(in, Order::text)},
          {"little.ply", ply_of(in, Order::little)},
          {"big.ply", ply_of(in, Order::big)}};
}

TEST(MeshFormats, GiveTheSameTriangles) {
  const Polyhedron in = rounded_ball();
  const auto first = read_meshes({{"m.obj", obj_of(in)}});
  ASSERT_TRUE(first->out) << first->text();
  const auto wanted = triangles_of(first->mesh());
  ASSERT_EQ(wanted.size(), in.faces.size());
  for (const Written& file : all_formats(in)) {
    const auto out = read_meshes({{file.name, file.bytes}});
    ASSERT_TRUE(out->out) << file.name << out->text();
    EXPECT_THAT(out->log.entries(), IsEmpty()) << file.name << out->text();
    EXPECT_EQ(scene::check(out->scene()), "");
    EXPECT_EQ(out->mesh().positions.size(), in.points.size()) << file.name;
    EXPECT_EQ(triangles_of(out->mesh()), wanted) << file.name;
    EXPECT_FALSE(out->out->in_metres);
  }
}

TEST(MeshFormats, KeepTheAreaAndVolumeOfACube) {
  const Polyhedron in = cube();
  for (const auto& [name, bytes] :
       {std::pair("c.obj", obj_of(in)), std::pair("c.stl", stl_text_of(in)),
        std::pair("c.ply", ply_of(in, Order::text)), std::pair("d.ply", ply_of(in, Order::big))}) {
    const auto out = read_meshes({{name, bytes}});
    ASSERT_TRUE(out->out) << name << out->text();
    const geometry::MeshReport report = geometry::check(out->mesh());
    EXPECT_TRUE(report.closed) << name;
    EXPECT_EQ(report.area, 24) << name;
    EXPECT_EQ(report.volume, 8) << name;
    // square edges stay sharp: three normals at each corner
    EXPECT_EQ(out->mesh().positions.size(), 24u) << name;
  }
}

TEST(MeshFormats, NormalsOfASphereAreItsRadii) {
  const Polyhedron in = ball(60, 80);
  const auto out = read_meshes({{"b.ply", ply_of(in, Order::little)}});
  ASSERT_TRUE(out->out);
  const geometry::MeshReport report = geometry::check(out->mesh());
  EXPECT_TRUE(report.closed);
  // slices between two rings are frusta of an 80-gon: the exact volume and, by the poles' sixth,
  // area
  double volume = 0;
  const double polygon = 40 * std::sin(2 * kPi / 80);  // area of an 80-gon of radius 1
  for (int i = 0; i < 60; ++i) {
    const double a = std::sin(kPi * i / 60), b = std::sin(kPi * (i + 1) / 60);
    const double h = std::cos(kPi * i / 60) - std::cos(kPi * (i + 1) / 60);
    volume += polygon * h * (a * a + a * b + b * b) / 3;
  }
  EXPECT_NEAR(report.volume, volume, 1e-14);  // measured 9e-16
  double worst = 0;
  for (std::size_t v = 0; v < out->mesh().positions.size(); ++v)
    worst = std::max(worst, glm::length(out->mesh().normals[v] - out->mesh().positions[v]));
  EXPECT_LT(worst, 1e-3);  // measured 6.5e-4: what averaging over flat faces leaves
}

TEST(MeshFormats, PositionsAreAsWritten) {
  // none of them is a float
  const Vec3 p(0.1, 1234567.8901234567, -2.2250738585072014e-10);
  Polyhedron in = cube();
  in.points[3] = p;
  for (const auto& [name, bytes] :
       {std::pair("c.obj", obj_of(in)), std::pair("c.stl", stl_text_of(in)),
        std::pair("c.ply", ply_of(in, Order::text)),
        std::pair("d.ply", ply_of(in, Order::little))}) {
    const auto out = read_meshes({{name, bytes}});
    ASSERT_TRUE(out->out) << name << out->text();
    EXPECT_THAT(out->mesh().positions, testing::Contains(p)) << name;
  }
}

TEST(MeshFormats, AConcaveFaceKeepsItsArea) {
  // a square of 4 m with a square hole of 2 m, joined to the outline by a double edge
  Polyhedron in;
  in.points = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
               {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  in.faces = {{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}};
  for (const auto& [name, bytes] :
       {std::pair("c.obj", obj_of(in)), std::pair("c.stl", stl_text_of(in)),
        std::pair("c.ply", ply_of(in, Order::text)), std::pair("d.ply", ply_of(in, Order::big))}) {
    const auto out = read_meshes({{name, bytes}});
    ASSERT_TRUE(out->out) << name << out->text();
    EXPECT_EQ(out->mesh().triangles.size(), 8u) << name;
    EXPECT_EQ(geometry::check(out->mesh()).area, 12) << name;
    for (const Vec3& n : out->mesh().normals) EXPECT_EQ(n, Vec3(0, 0, 1)) << name;
  }
}

TEST(MeshFormats, LimitsHold) {
  const Polyhedron in = rounded_ball();
  for (const Written& file : all_formats(in)) {
    Options few;
    few.limits.triangles = 100;
    const auto out = read_meshes({{file.name, file.bytes}}, few);
    EXPECT_TRUE(out->log.contains(Code("E6002"))) << file.name;
    if (out->out) {
      EXPECT_LE(out->mesh().triangles.size(), 100u) << file.name;
    }
    Options small;
    small.limits.memory = 1000;
    EXPECT_TRUE(read_meshes({{file.name, file.bytes}}, small)->log.contains(Code("E6002")))
        << file.name;
    Options no_node;
    no_node.limits.nodes = 1;
    EXPECT_TRUE(read_meshes({{file.name, file.bytes}}, no_node)->log.contains(Code("E6002")))
        << file.name;
  }
}

TEST(MeshFormats, AFileWithoutFacesIsRefused) {
  Polyhedron in = cube();
  in.faces.clear();
  for (const Written& file : all_formats(in)) {
    const auto out = read_meshes({{file.name, file.bytes}});
    EXPECT_FALSE(out->out) << file.name;
    EXPECT_TRUE(out->log.contains(Code("E6501"))) << file.name;
  }
  EXPECT_THAT(read_meshes({{"empty.obj", ""}})->places(), ElementsAre("1:1 E6501"));
  EXPECT_THAT(read_meshes({{"empty.stl", ""}})->places().size(), testing::Ge(1u));
}

}  // namespace
}  // namespace panwright::importers::formats_test
