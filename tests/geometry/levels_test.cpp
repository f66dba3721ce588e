// Levels of detail of meshes.

#include "geometry/mesh/levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "geometry/mesh/closest.h"
#include "shapes.h"

namespace panwright::geometry::levels_test {
namespace {

// The largest distance of points spread over a mesh from the other one: corners, and some at random
// on triangles.
double sampled_side(const Mesh& from, const Mesh& to, std::uint64_t seed) {
  shapes::Random random(seed);
  double most = 0;
  const std::size_t step = 1 + from.triangles.size() / 400;
  for (std::size_t i = 0; i < from.triangles.size(); i += step) {
    const Triangle& t = from.triangles[i];
    for (int k = 0; k < 4; ++k) {
      double u = k == 0 ? 0 : random(), v = k == 0 ? 0 : random();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3 p =
          (1 - u - v) * from.positions[t[0]] + u * from.positions[t[1]] + v * from.positions[t[2]];
      most = std::max(most, closest_point(to, p)->distance);
    }
  }
  return most;
}

void expect_sound(const Mesh& full, const std::vector<MeshLevel>& levels, double share = 0.7) {
  std::size_t before = full.triangles.size();
  double error = 0;
  for (const MeshLevel& level : levels) {
    EXPECT_LE(static_cast<double>(level.mesh.triangles.size()),
              share * static_cast<double>(before));
    EXPECT_GT(level.distance.high, error);
    EXPECT_GE(level.distance.high, level.distance.low);
    EXPECT_EQ(level.mesh.error, level.distance.high);
    const MeshReport report = check(level.mesh);
    EXPECT_EQ(report.bad_indices + report.bad_lengths + report.non_finite + report.bad_normals, 0u);
    const double sampled =
        std::max(sampled_side(full, level.mesh, 1), sampled_side(level.mesh, full, 2));
    const double size = glm::length(full.positions[0]) + level.distance.high;
    EXPECT_GE(level.distance.high, sampled - 1e-14 * size);
    before = level.mesh.triangles.size();
    error = level.distance.high;
  }
}

// What is no model for renderers, but shapes that are known.
LevelOptions loose() {
  LevelOptions options;
  options.most_area_error = 0.02;
  options.most_normal_error = 0.25;
  return options;
}

TEST(MeshLevels, OfASphere) {
  const Mesh full = shapes::sphere(100, 150);
  const auto levels = mesh_levels(full, loose());
  ASSERT_GE(levels.size(), 4u);
  expect_sound(full, levels);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const MeshLevel& level = levels[i];
    EXPECT_TRUE(level.mesh.closed);
    EXPECT_LE(level.distance.high, 1.6 * level.distance.low);  // 1.51 measured
    // corners are on the sphere, so a level cannot be nearer than the deepest facet is
    double deepest = 1;
    for (const Triangle& t : level.mesh.triangles)
      deepest =
          std::min(deepest, glm::length(level.mesh.positions[t[0]] + level.mesh.positions[t[1]] +
                                        level.mesh.positions[t[2]]) /
                                3);
    EXPECT_GE(level.distance.high, 1 - 4.1e-4 - deepest);  // of the full one's facets: 4.0e-4
    EXPECT_LE(level.distance.low, 3 * (1 - deepest));
    // a power of two is its tolerance, and it uses most of it
    const double tolerance = std::exp2(std::ceil(std::log2(level.distance.high)));
    EXPECT_GT(level.distance.high, tolerance / 4);
    // normals are the sphere's
    for (std::size_t v = 0; v < level.mesh.positions.size(); ++v)
      EXPECT_NEAR(glm::dot(level.mesh.normals[v], glm::normalize(level.mesh.positions[v])), 1,
                  1e-12);
    if (i > 0) {
      EXPECT_GT(level.distance.high, 1.3 * levels[i - 1].distance.high);
      EXPECT_GE(level.area_error, levels[i - 1].area_error);
    }
  }
}

TEST(MeshLevels, NoPartGoes) {
  // two hundred rods, each a prism that cannot be simpler, and a sphere that can
  Mesh full = shapes::sphere(60, 90);
  full.normals.clear();
  for (int i = 0; i < 200; ++i) {
    Mesh rod = shapes::cube();
    const auto base = static_cast<std::uint32_t>(full.positions.size());
    for (const Vec3& p : rod.positions)
      full.positions.push_back(Vec3(3 + 0.01 * i, 0, 0) + Vec3(1e-3, 1e-3, 1) * p);
    for (const Triangle& t : rod.triangles)
      full.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  const auto levels = mesh_levels(full);
  ASSERT_GE(levels.size(), 1u);
  expect_sound(full, levels);
  for (const MeshLevel& level : levels) {
    std::vector<char> seen(200);
    for (const Vec3& p : level.mesh.positions)
      if (p.x > 2.5) seen[static_cast<std::size_t>(std::lround((p.x - 3) / 0.01))] = 1;
    EXPECT_EQ(std::ranges::count(seen, 1), 200);
  }
}

// An open, wavy sheet of n × n quads.
Mesh wavy(int n) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      mesh.positions.push_back({x, y, 0.03 * std::sin(9 * x) * std::cos(7 * y)});
      mesh.texcoords.push_back({x, y});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::uint32_t>(j * (n + 1) + i);
      const auto up = at + static_cast<std::uint32_t>(n) + 1;
      mesh.triangles.push_back({at, at + 1, up + 1});
      mesh.triangles.push_back({at, up + 1, up});
    }
  return mesh;
}

TEST(MeshLevels, BordersThatOthersShareStay) {
  const Mesh full = wavy(60);
  const auto is_border = [](const Vec3& p) { return p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1; };
  const auto borders = [&](const Mesh& mesh) {
    std::vector<std::array<double, 3>> out;
    for (const Vec3& p : mesh.positions)
      if (is_border(p)) out.push_back({p.x, p.y, p.z});
    std::sort(out.begin(), out.end());
    return out;
  };
  std::vector<char> shared(full.positions.size());
  shared[30] = 1;  // one vertex that another part has too
  const auto kept = mesh_levels(full, {.shared = shared});
  ASSERT_GE(kept.size(), 1u);
  expect_sound(full, kept);
  for (const MeshLevel& level : kept) EXPECT_EQ(borders(level.mesh), borders(full));
  const auto free = mesh_levels(full);
  ASSERT_GE(free.size(), 2u);
  expect_sound(full, free);
  EXPECT_LT(borders(free.back().mesh).size(), borders(full).size() / 2);
  // texture coordinates are those of the places
  for (const MeshLevel& level : free)
    for (std::size_t v = 0; v < level.mesh.positions.size(); ++v) {
      EXPECT_EQ(level.mesh.texcoords[v].x, level.mesh.positions[v].x);
      EXPECT_EQ(level.mesh.texcoords[v].y, level.mesh.positions[v].y);
    }
}

// Two colours in one plane: no distance tells where they meet, and still they meet where they did.
TEST(MeshLevels, ColoursStayWhereTheyAre) {
  Mesh full = wavy(60);
  full.texcoords.clear();
  for (Vec3& p : full.positions) p.z *= 0.2;
  const auto is_right = [](const Mesh& mesh, const Triangle& t) {
    return mesh.positions[t[0]].x + mesh.positions[t[1]].x + mesh.positions[t[2]].x > 1.5;
  };
  // vertices of the right half are others, of another colour
  const auto count = static_cast<std::uint32_t>(full.positions.size());
  full.colors.assign(count, Vec3(1, 0, 0));
  full.colors.resize(2 * count, Vec3(0, 0, 1));
  full.positions.insert(full.positions.end(), full.positions.begin(),
                        full.positions.begin() + count);
  for (Triangle& t : full.triangles)
    if (is_right(full, t))
      for (std::uint32_t& v : t) v += count;
  const auto levels = mesh_levels(full);
  ASSERT_GE(levels.size(), 1u);
  const auto area = [](const Mesh& mesh, double blue) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 corner = mesh.positions[t[0]];
      if (mesh.colors[t[0]].z == blue)
        sum += glm::cross(mesh.positions[t[1]] - corner, mesh.positions[t[2]] - corner).z / 2;
    }
    return sum;
  };
  for (const MeshLevel& level : levels)
    for (const double blue : {0.0, 1.0}) {
      // as seen from above: exactly, but for the outer border, which may move by the bound
      EXPECT_NEAR(area(level.mesh, blue), area(full, blue), 3 * level.distance.high);
      EXPECT_EQ(
          std::ranges::count_if(level.mesh.positions, [](const Vec3& p) { return p.x == 0.5; }),
          2 * 61);
    }
}

TEST(MeshLevels, HardEdgesStayHard) {
  // a cylinder with normals of its own on wall and lids
  DiagnosticLog log;
  const auto full = tessellated(Cylinder{0.5, 2}, {.max_error = 2e-5}, {}, log);
  ASSERT_TRUE(full);
  const auto levels = mesh_levels(*full);
  ASSERT_GE(levels.size(), 2u);
  expect_sound(*full, levels);
  for (const MeshLevel& level : levels)
    for (const Vec3& n : level.mesh.normals)
      EXPECT_LT(std::min(std::fabs(n.z), 1 - std::fabs(n.z)), 1e-12);
}

TEST(MeshLevels, AnySizeGivesTheSame) {
  const Mesh full = shapes::sphere(40, 60);
  const auto plain = mesh_levels(full, loose());
  ASSERT_GE(plain.size(), 2u);
  for (const double scale : {0x1p-30, 0x1p20}) {  // 1e-9 and 1e6, exactly
    Mesh other = full;
    for (Vec3& p : other.positions) p *= scale;
    LevelOptions options = loose();
    options.unit = scale;
    const auto levels = mesh_levels(other, options);
    ASSERT_EQ(levels.size(), plain.size()) << scale;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      EXPECT_EQ(levels[i].mesh.triangles, plain[i].mesh.triangles);
      EXPECT_EQ(levels[i].distance.high, scale * plain[i].distance.high);
    }
  }
}

TEST(MeshLevels, OfWhatIsBroken) {
  // needles, doubled, flat, folded and touching triangles, edges of three
  Mesh full = wavy(30);
  shapes::Random random(3);
  const std::size_t whole = full.triangles.size();
  for (std::size_t i = 0; i < whole; i += 3) {
    Triangle t = full.triangles[i];
    if (i % 2 == 0) full.triangles.push_back({t[0], t[2], t[1]});
    if (i % 5 == 0) full.triangles.push_back({t[0], t[1], t[1]});
    if (i % 7 == 0) full.triangles.push_back(t);
    if (i % 4 == 0) {
      full.positions.push_back(0.5 * (full.positions[t[0]] + full.positions[t[1]]) +
                               Vec3(0, 0, i % 8 == 0 ? 0.01 : 1e-13));
      full.texcoords.push_back(full.texcoords[t[0]]);
      t[2] = static_cast<std::uint32_t>(full.positions.size() - 1);
      full.triangles.push_back(t);
    }
  }
  expect_sound(full, mesh_levels(full));
  // nothing, one point, a line
  EXPECT_TRUE(mesh_levels(Mesh{}).empty());
  Mesh point;
  point.positions.assign(3, Vec3(1, 2, 3));
  for (int i = 0; i < 100; ++i) point.triangles.push_back({0, 1, 2});
  EXPECT_TRUE(mesh_levels(point).empty());
  Mesh line = point;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_TRUE(mesh_levels(line).empty());
}

TEST(MeshLevels, FinerOnesThanAskedForAreLeftOut) {
  const Mesh full = shapes::sphere(100, 150);
  const auto levels = mesh_levels(full, {.least_error = 0.004});
  ASSERT_GE(levels.size(), 1u);
  EXPECT_GT(levels.front().distance.high, 0.002);
  expect_sound(full, levels);
}

TEST(MeshLevels, SameWhateverTheThreads) {
  const Mesh full = shapes::sphere(50, 70);
  const auto one = mesh_levels(full, {}, Job(JobOptions{1, {}}));
  const auto four = mesh_levels(full, {}, Job(JobOptions{4, {}}));
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].mesh.triangles, four[i].mesh.triangles);
    EXPECT_EQ(one[i].distance.low, four[i].distance.low);
    EXPECT_EQ(one[i].distance.high, four[i].distance.high);
    EXPECT_EQ(one[i].normals.rms, four[i].normals.rms);
    EXPECT_EQ(one[i].area_error, four[i].area_error);
  }
}

}  // namespace
}  // namespace panwright::geometry::levels_test
