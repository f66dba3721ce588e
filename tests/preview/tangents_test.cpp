#include "preview/model/tangents.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace panwright::preview::tangents_test {
namespace {

struct Vertices {
  std::vector<pan::layout::Float3> positions, normals;
  std::vector<pan::layout::Float2> texcoords;
  std::vector<std::uint32_t> indices;

  void add(const Vec3& p, const Vec3& n, const Vec2& t) {
    const auto f = [](double x) { return static_cast<float>(x); };
    positions.push_back({f(p.x), f(p.y), f(p.z)});
    normals.push_back({f(n.x), f(n.y), f(n.z)});
    texcoords.push_back({f(t.x), f(t.y)});
  }
  pan::MeshView view() const { return {positions, normals, texcoords, {}, {{}, indices}}; }
};

Vec3 tangent(const Tangents& found, std::size_t i) {
  return Vec3(found.tangents[4 * i], found.tangents[4 * i + 1], found.tangents[4 * i + 2]);
}

// A tube about z, u around it; the seam's vertices stand twice, at u = 0 and u = 1.
Vertices tube(int segments, bool mirrored) {
  Vertices mesh;
  for (int i = 0; i <= segments; ++i) {
    // the seam's two ends have the same floats
    const double angle = 2 * kPi * (i % segments) / segments;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    const double u = mirrored ? 1 - double(i) / segments : double(i) / segments;
    for (const double z : {0.0, 1.0}) mesh.add(out + Vec3(0, 0, z), out, Vec2(u, z));
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(segments); ++i)
    mesh.indices.insert(mesh.indices.end(),
                        {2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1});
  return mesh;
}

// By symmetry the tangent is the circle's own, seam included.
TEST(Tangents, OfATubeAreTheCirclesOwn) {
  for (const bool mirrored : {false, true}) {
    const Vertices mesh = tube(12, mirrored);
    const Tangents found = tangents(mesh.view());
    EXPECT_TRUE(found.repeats.empty());
    EXPECT_TRUE(found.indices.empty());
    double worst = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const auto& n = mesh.normals[i];
      const Vec3 exact = Vec3(-n.y, n.x, 0) * (mirrored ? -1.0 : 1.0);
      worst = std::max(worst, glm::length(tangent(found, i) - exact));
      EXPECT_EQ(found.tangents[4 * i + 3], mirrored ? -1 : 1);
    }
    EXPECT_LE(worst, 5e-7);  // measured 1.2e-7
  }
}

// Sheared and stretched texture coordinates: where u grows and v stands still.
TEST(Tangents, FollowUAlone) {
  const Vec2 du(2, -1);
  const Vec2 dv(0.5, 3);
  Vertices mesh;
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
    mesh.add(Vec3(x, y, 0), Vec3(0, 0, 1),
             Vec2(x * du.x + y * du.y, x * dv.x + y * dv.y) * 1e-3 + Vec2(7));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  // v = const along (dv.y, −dv.x)
  const Vec3 exact = glm::normalize(Vec3(dv.y, -dv.x, 0));
  const Tangents found = tangents(mesh.view());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LE(glm::length(tangent(found, i) - exact), 2e-3);
}

// An image mirrored about an edge: the edge's vertices are needed twice.
TEST(Tangents, MirrorsRepeatVertices) {
  Vertices mesh;
  for (const int x : {0, 1, 2})
    for (const int y : {0, 1}) mesh.add(Vec3(x, y, 0), Vec3(0, 0, 1), Vec2(x == 1 ? 1 : 0, y));
  mesh.indices = {0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3};
  const Tangents found = tangents(mesh.view());
  ASSERT_EQ(found.repeats, (std::vector<std::uint32_t>{2, 3}));
  ASSERT_EQ(found.tangents.size(), 4 * 8u);
  EXPECT_EQ(found.indices, (std::vector<std::uint32_t>{0, 2, 3, 0, 3, 1, 6, 4, 5, 6, 5, 7}));
  for (std::size_t i = 0; i < found.indices.size(); ++i) {
    const std::size_t vertex = found.indices[i];
    const bool mirrored = i >= 6;
    EXPECT_LE(glm::length(tangent(found, vertex) - Vec3(mirrored ? -1 : 1, 0, 0)), 1e-7);
    EXPECT_EQ(found.tangents[4 * vertex + 3], mirrored ? -1 : 1);
  }
}

TEST(Tangents, AnyInTheirPlaneWhereTheImageHasNoArea) {
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), glm::normalize(Vec3(1, -2, 3))})
    for (const double scale : {0.0, 1e-30, 1e30}) {
      Vertices mesh;
      for (const int i : {0, 1, 2}) mesh.add(Vec3(i, i * i, 0) * scale, normal, Vec2(i, i) * scale);
      mesh.indices = {0, 1, 2, 0, 0, 1};
      const Tangents found = tangents(mesh.view());
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(glm::length(tangent(found, i)), 1, 1e-6);
        EXPECT_NEAR(glm::dot(tangent(found, i), normal), 0, 1e-6);
      }
    }
}

}  // namespace
}  // namespace panwright::preview::tangents_test
