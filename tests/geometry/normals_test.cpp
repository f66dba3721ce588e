#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "base/clock.h"
#include "geometry/mesh/strip.h"
#include "shapes.h"

namespace panwright::geometry::normals_test {
namespace {

// Corners, each with its own vertex.
Mesh soup(const Mesh& mesh) {
  Mesh out;
  for (const Triangle& t : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(out.positions.size());
    for (const std::uint32_t v : t) out.positions.push_back(mesh.positions[v]);
    out.triangles.push_back({base, base + 1, base + 2});
  }
  return out;
}

TEST(Normals, ACubeWithSharpEdgesHasTwentyFour) {
  Mesh mesh = shapes::cube();
  compute_normals(mesh, 30 * kDegree);
  EXPECT_EQ(mesh.positions.size(), 24u);
  EXPECT_EQ(mesh.normals.size(), 24u);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 n = glm::normalize(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                             mesh.positions[t[2]] - mesh.positions[t[0]]));
    for (const std::uint32_t v : t) EXPECT_EQ(mesh.normals[v], n);
  }
  EXPECT_TRUE(check(mesh).closed);
}

TEST(Normals, ASmoothCubeHasEight) {
  // the diagonals of its faces have no say: angle weights
  for (const double crease : {90 * kDegree, kPi, 10.0}) {
    Mesh mesh = shapes::cube();
    compute_normals(mesh, crease);
    ASSERT_EQ(mesh.positions.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i)
      EXPECT_LT(glm::length(mesh.normals[i] - mesh.positions[i] / std::sqrt(3.0)), 1e-15);
  }
}

TEST(Normals, OriginalVerticesKeepTheirIndexAndCopiesFollowInOrderOfUse) {
  Mesh mesh = shapes::cube();
  mesh.texcoords.resize(8);
  mesh.colors.resize(8);
  for (std::size_t i = 0; i < 8; ++i) {
    mesh.texcoords[i] = {double(i), 0.5};
    mesh.colors[i] = Vec3(double(i));
  }
  const Mesh original = mesh;
  compute_normals(mesh, 0.1);
  std::uint32_t next = 8;
  std::vector<bool> seen(24, false);
  for (std::size_t i = 0; i < 12; ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      const std::uint32_t from = original.triangles[i][k];
      EXPECT_EQ(mesh.positions[v], original.positions[from]);
      EXPECT_EQ(mesh.texcoords[v], original.texcoords[from]);
      EXPECT_EQ(mesh.colors[v], original.colors[from]);
      if (seen[v]) continue;
      EXPECT_EQ(v, v < 8 ? from : next++);
      seen[v] = true;
    }
  }
  EXPECT_EQ(next, 24u);
}

TEST(Normals, ASphereIsSmoothAndCloseToItsRadii) {
  for (const bool split : {false, true}) {
    Mesh mesh = shapes::sphere(60, 90);
    if (split) mesh = soup(mesh);
    const std::vector<Vec3> positions = mesh.positions;
    compute_normals(mesh, 30 * kDegree);
    EXPECT_EQ(mesh.positions, positions);
    double worst = 0;
    for (std::size_t i = 0; i < positions.size(); ++i)
      worst = std::max(worst, angle_between(mesh.normals[i], positions[i]));
    // 5.8e-4 rad measured: the diagonals of the quads are not symmetric
    EXPECT_LT(worst, 7e-4);
  }
}

TEST(Normals, SoupAndSharedVerticesAgree) {
  for (const double crease : {0.05, 0.2, 0.6, 2.0}) {
    Mesh shared = shapes::sphere(9, 14);
    Mesh split = soup(shared);
    compute_normals(shared, crease);
    compute_normals(split, crease);
    for (std::size_t i = 0; i < shared.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(shared.normals[shared.triangles[i][k]], split.normals[split.triangles[i][k]]);
  }
}

// A closed can: the side is smooth about it, the circular edges are sharp.
TEST(Normals, ACylinderKeepsItsCircularEdges) {
  Mesh mesh;
  const std::uint32_t n = 36;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    mesh.positions.push_back({std::cos(a), std::sin(a), -1});
    mesh.positions.push_back({std::cos(a), std::sin(a), 1});
  }
  mesh.positions.push_back({0, 0, -1});
  mesh.positions.push_back({0, 0, 1});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({2 * i, 2 * j, 2 * j + 1});
    mesh.triangles.push_back({2 * i, 2 * j + 1, 2 * i + 1});
    mesh.triangles.push_back({2 * n, 2 * j, 2 * i});
    mesh.triangles.push_back({2 * n + 1, 2 * i + 1, 2 * j + 1});
  }
  compute_normals(mesh, 30 * kDegree);
  EXPECT_EQ(mesh.positions.size(), 4 * n + 2);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    const Vec3& normal = mesh.normals[i];
    const Vec3 radial(p.x, p.y, 0);
    if (std::fabs(normal.z) > 0.5) {
      EXPECT_LT(glm::length(normal - Vec3(0, 0, p.z)), 1e-15);
    } else {
      // angle weights: the diagonals of the sides have no say; 4.4e-16 measured
      EXPECT_LT(angle_between(normal, radial), 2e-15);
      EXPECT_LT(std::fabs(normal.z), 1e-15);
    }
  }
}

TEST(Normals, TheCreaseAngleIsTheAngleBetweenFacets) {
  // a roof of two triangles whose normals differ by 40 degrees
  for (const double crease : {39.999, 40.0, 40.001}) {
    const double half = 20 * kDegree;
    Mesh mesh;
    mesh.positions = {{-1, 0, 0},
                      {1, 0, 0},
                      {0, std::cos(half), -std::sin(half)},
                      {0, -std::cos(half), -std::sin(half)}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    compute_normals(mesh, crease * kDegree);
    EXPECT_EQ(mesh.positions.size(), crease < 40 ? 6u : 4u);
    const Vec3 first = crease < 40 ? Vec3(0, std::sin(half), std::cos(half)) : Vec3(0, 0, 1);
    EXPECT_LT(glm::length(mesh.normals[0] - first), 1e-15);
  }
}

TEST(Normals, TrianglesWithoutAreaHaveNoSay) {
  Mesh plain = shapes::cube();
  Mesh mesh = plain;
  mesh.positions.push_back({0, 1, 1});  // 8: the middle of the edge from 6 to 7
  mesh.triangles.push_back({6, 8, 7});
  mesh.triangles.push_back({0, 0, 1});
  mesh.positions.push_back({9, 9, 9});  // 9: only in a triangle without area
  mesh.triangles.push_back({9, 9, 9});
  mesh.positions.push_back({5, 5, 5});  // 10: in none
  compute_normals(plain, 0.5);
  compute_normals(mesh, 0.5);
  for (std::size_t i = 0; i < plain.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(mesh.normals[mesh.triangles[i][k]], plain.normals[plain.triangles[i][k]]);
  EXPECT_EQ(mesh.positions.size(), 24u + 3);
  EXPECT_EQ(check(mesh).bad_normals, 0u);
  EXPECT_EQ(mesh.normals[9], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[10], Vec3(0, 0, 1));
}

TEST(Normals, FacetsBackToBackHaveANormal) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  for (const double crease : {0.5, kPi}) {
    Mesh copy = mesh;
    compute_normals(copy, crease);
    EXPECT_EQ(check(copy).bad_normals, 0u);
    EXPECT_EQ(copy.positions.size(), crease < 1 ? 6u : 3u);
  }
}

// Many facets on one edge: the same groups as joining every pair that is smooth, one by one.
TEST(Normals, FansAboutOneEdge) {
  shapes::Random random(77);
  for (int trial = 0; trial < 40; ++trial) {
    const std::size_t facets = 3 + std::size_t(random() * 12);
    const double crease = random.between(0.05, 1.0);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}};
    std::vector<Vec3> normals;
    for (std::size_t i = 0; i < facets; ++i) {
      const double a = random.between(0, 2 * M_PI);
      mesh.positions.push_back({std::cos(a), std::sin(a), 0.5});
      const auto tip = static_cast<std::uint32_t>(mesh.positions.size() - 1);
      const bool flip = random() < 0.5;
      mesh.triangles.push_back(flip ? Triangle{1, 0, tip} : Triangle{0, 1, tip});
      normals.push_back(Vec3(-std::sin(a), std::cos(a), 0) * (flip ? -1.0 : 1.0));
    }
    std::vector<std::size_t> group(facets);
    for (std::size_t i = 0; i < facets; ++i) group[i] = i;
    for (std::size_t i = 0; i < facets; ++i)
      for (std::size_t j = 0; j < facets; ++j)
        if (std::acos(std::clamp(glm::dot(normals[i], normals[j]), -1.0, 1.0)) <= crease) {
          const std::size_t from = group[j];
          for (std::size_t& g : group)
            if (g == from) g = group[i];
        }
    compute_normals(mesh, crease);
    const auto at_first_vertex = [&](std::size_t i) {
      for (const std::uint32_t v : mesh.triangles[i])
        if (mesh.positions[v] == Vec3(0, 0, 0)) return v;
      return 0xffffffffu;
    };
    for (std::size_t i = 0; i < facets; ++i)
      for (std::size_t j = 0; j < facets; ++j)
        EXPECT_EQ(group[i] == group[j], at_first_vertex(i) == at_first_vertex(j));
  }
}

TEST(Normals, TinyAndHugeMeshes) {
  for (const double scale : {1e-30, 1e-9, 1e12, 1e30}) {
    Mesh mesh = shapes::cube();
    for (Vec3& p : mesh.positions) p *= scale;
    compute_normals(mesh, 0.5);
    EXPECT_EQ(mesh.positions.size(), 24u) << scale;
    EXPECT_EQ(check(mesh).bad_normals, 0u);
  }
}

// Sharp facets at one vertex, as many as a byte numbers and more: each keeps its own normal.
TEST(Normals, SharpFacetsAtOneVertex) {
  for (const std::uint32_t n : {128u, 254u, 256u, 258u, 600u}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 1}};
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2 * M_PI * i / n;
      mesh.positions.push_back({std::cos(a), std::sin(a), i % 2 == 0 ? 0.0 : 0.5});
      mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    }
    compute_normals(mesh, 1e-3);
    ASSERT_EQ(mesh.positions.size(), 3 * n);
    double worst = 0;
    for (const Triangle& t : mesh.triangles) {
      const std::vector<Vec3>& p = mesh.positions;
      const Vec3 facet = glm::normalize(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
      for (const std::uint32_t v : t) worst = std::max(worst, glm::length(mesh.normals[v] - facet));
    }
    EXPECT_LT(worst, 8e-16) << n;  // 4.0e-16 measured
  }
}

// Many triangles in no order, against sums over all of them.
TEST(Normals, TheOrderOfTrianglesIsNothing) {
  Mesh mesh = shapes::sphere(150, 200);
  const std::size_t count = mesh.triangles.size();
  ASSERT_GT(count, 50'000u);
  Mesh shuffled = mesh;
  for (std::size_t i = 0; i < count; ++i) shuffled.triangles[i] = mesh.triangles[i * 7919 % count];
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]];
      const Vec3 b = mesh.positions[t[(k + 2) % 3]] - mesh.positions[t[k]];
      const Vec3 cross = glm::cross(a, b);
      sums[t[k]] += std::atan2(glm::length(cross), glm::dot(a, b)) * glm::normalize(cross);
    }
  }
  compute_normals(shuffled, 1);
  ASSERT_EQ(shuffled.positions, mesh.positions);
  double worst = 0;
  for (std::size_t v = 0; v < sums.size(); ++v)
    worst = std::max(worst, glm::length(shuffled.normals[v] - glm::normalize(sums[v])));
  EXPECT_LT(worst, 8e-16);  // 4.0e-16 measured
}

// 200,000 sharp facets on one vertex and on one edge: a pairwise method would need minutes.
TEST(Normals, ManyFacetsAtOnePlaceStayFast) {
  const std::uint32_t n = 200000;
  Mesh apex;
  Mesh fan;
  apex.positions = {{0, 0, 1}};
  fan.positions = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    apex.positions.push_back({std::cos(a), std::sin(a), i % 2 == 0 ? 0.0 : 0.5});
    apex.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    fan.positions.push_back({std::cos(a), std::sin(a), 0.5});
    fan.triangles.push_back({0, 1, 2 + i});
  }
  const auto start = std::chrono::steady_clock::now();
  compute_normals(apex, 1e-3);
  compute_normals(fan, 1e-7);
  const double seconds = seconds_since(start);
  EXPECT_EQ(check(apex).bad_normals, 0u);
  EXPECT_EQ(fan.positions.size(), 3u * n);
  EXPECT_LT(seconds, 20);  // 0.3 s measured; sanitizers are slower
}

}  // namespace
}  // namespace panwright::geometry::normals_test
