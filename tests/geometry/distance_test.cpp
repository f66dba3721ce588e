// The distance of meshes: closed forms, and dense samples by another algorithm.

#include "geometry/mesh/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/mesh/closest.h"
#include "shapes.h"

namespace panwright::geometry::distance_test {
namespace {

DistanceInterval distance(const Mesh& a, const Mesh& b, double relative = 0.1) {
  return hausdorff_distance(MeasuredMesh(a), MeasuredMesh(b), {.relative = relative});
}

// n × n quads over [x0, x1] × [0, 1] at a height.
Mesh plate(int n, double x0, double x1, double z) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.positions.push_back({x0 + (x1 - x0) * i / n, static_cast<double>(j) / n, z});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::uint32_t>(j * (n + 1) + i);
      const auto up = static_cast<std::uint32_t>(at + static_cast<std::uint32_t>(n) + 1);
      mesh.triangles.push_back({at, at + 1, up + 1});
      mesh.triangles.push_back({at, up + 1, up});
    }
  return mesh;
}

double from_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = glm::dot(along, along);
  const double t = squared > 0 ? std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0;
  return glm::length(a + t * along - p);
}

// The largest distance of a grid of points on a mesh's triangles from the other one. Triangles
// without area by their sides.
double sampled_side(const Mesh& from, const Mesh& to, int n) {
  Mesh sound = to;
  std::vector<Triangle> flat;
  std::erase_if(sound.triangles, [&](const Triangle& t) {
    const Vec3 a = to.positions[t[0]], b = to.positions[t[1]], c = to.positions[t[2]];
    const bool gone = glm::length(glm::cross(b - a, c - a)) < 1e-12 * glm::dot(b - a, b - a) ||
                      glm::dot(b - a, b - a) == 0;
    if (gone) flat.push_back(t);
    return gone;
  });
  double most = 0;
  for (const Triangle& t : from.triangles)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        const Vec3 p = (1 - u - v) * from.positions[t[0]] + u * from.positions[t[1]] +
                       v * from.positions[t[2]];
        const auto found = closest_point(sound, p);
        double d = found ? found->distance : HUGE_VAL;
        for (const Triangle& f : flat)
          for (std::size_t k = 0; k < 3; ++k)
            d = std::min(d, from_segment(p, to.positions[f[k]], to.positions[f[(k + 1) % 3]]));
        most = std::max(most, d);
      }
  return most;
}
double sampled(const Mesh& a, const Mesh& b, int n) {
  return std::max(sampled_side(a, b, n), sampled_side(b, a, n));
}

// Triangles of any form: needles, doubled ones, segments and points among them.
Mesh soup(std::uint64_t seed, int count) {
  shapes::Random random(seed);
  Mesh mesh;
  const auto point = [&] {
    return Vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  };
  for (int i = 0; i < count; ++i) {
    const Vec3 a = point();
    Vec3 b = point(), c = point();
    if (i % 5 == 1) c = 0.5 * (a + b) + 1e-9 * c;
    if (i % 5 == 2) c = 0.25 * a + 0.75 * b;
    if (i % 10 == 3) b = c = a;
    const auto at = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.push_back({at, at + 1, at + 2});
    if (i % 7 == 0) mesh.triangles.push_back({at, at + 2, at + 1});
  }
  return mesh;
}

Mesh sound_soup(std::uint64_t seed, int count) {
  shapes::Random random(seed);
  Mesh mesh;
  for (int i = 0; i < 3 * count; ++i)
    mesh.positions.push_back({random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return mesh;
}

Mesh moved(Mesh mesh, const Quat& turn, const Vec3& by, double scale) {
  for (Vec3& p : mesh.positions) p = scale * (turn * p) + by;
  return mesh;
}

TEST(Distance, PlatesAreAsFarApartAsTheyAre) {
  for (const int n : {1, 3, 7}) {
    const DistanceInterval found = distance(plate(5, 0, 1, 0), plate(n, 0, 1, 0.25));
    EXPECT_NEAR(found.low, 0.25, 1e-15);
    EXPECT_LE(found.high, 0.2751);
    EXPECT_GE(found.high, 0.25);
    // one is twice as long
    const DistanceInterval longer = distance(plate(n, 0, 1, 0), plate(4, 0, 2, 0));
    EXPECT_NEAR(longer.low, 1, 1e-15);
    EXPECT_LE(longer.high, 1.1 + 1e-13);
    EXPECT_GE(longer.high, 1);
    // the same plane, cut otherwise: a quarter of the smallest tolerance of levels
    const DistanceInterval same = hausdorff_distance(
        MeasuredMesh(plate(5, 0, 1, 0)), MeasuredMesh(plate(n, 0, 1, 0)), {.absolute = 1e-5});
    EXPECT_LE(same.low, 1e-15);
    EXPECT_LE(same.high, 1.0001e-5);
  }
}

TEST(Distance, OfOneSide) {
  const Mesh plain = plate(3, 0, 1, 0), longer = plate(4, 0, 2, 0);
  EXPECT_LE(distance_from(MeasuredMesh(plain), MeasuredMesh(longer), {.absolute = 1e-4}).high,
            1.1e-4);
  EXPECT_NEAR(distance_from(MeasuredMesh(longer), MeasuredMesh(plain)).low, 1, 1e-15);
}

TEST(Distance, SpikesCount) {
  Mesh spiked = plate(16, 0, 1, 0);
  const auto at = static_cast<std::uint32_t>(spiked.positions.size());
  // far thinner than what a grid of samples would meet
  spiked.positions.insert(spiked.positions.end(),
                          {{0.51, 0.51, 0}, {0.51001, 0.51, 0}, {0.510003, 0.510002, 0.375}});
  spiked.triangles.push_back({at, at + 1, at + 2});
  const DistanceInterval found = distance(plate(4, 0, 1, 0), spiked);
  EXPECT_NEAR(found.low, 0.375, 1e-15);
  EXPECT_NEAR(found.high, 0.375, 0.0376);
}

TEST(Distance, ChamferedCorner) {
  const Mesh cube = shapes::cube();
  Mesh cut = cube;
  const double c = 0.4;
  const auto at = static_cast<std::uint32_t>(cut.positions.size());
  cut.positions.insert(cut.positions.end(), {{1 - c, 1, 1}, {1, 1 - c, 1}, {1, 1, 1 - c}});
  std::vector<Triangle> triangles;
  for (const Triangle& t : cut.triangles) {
    // each face at the corner: what is left is cut into fans
    std::size_t k = 0;
    while (k < 3 && t[k] != 7) ++k;
    if (k == 3) {
      triangles.push_back(t);
      continue;
    }
    const std::uint32_t b = t[(k + 1) % 3], d = t[(k + 2) % 3];
    // points on the sides at c from the corner, where the side is an edge of the cube
    const auto on = [&](std::uint32_t to) {
      const Vec3 p = cube.positions[to];
      for (std::uint32_t i = 0; i < 3; ++i)
        if (p[static_cast<int>(i)] < 0 && glm::dot(p, Vec3(1)) > 0.5) return at + i;
      return 7u;
    };
    const std::uint32_t from = on(b), to = on(d);
    if (from != 7 && to != 7) {
      triangles.push_back({from, b, d});
      triangles.push_back({from, d, to});
    } else {
      // the diagonal of a face ends here: cut it where the chamfer crosses it
      const std::uint32_t far = from == 7 ? b : d;
      Vec3 q(1);
      for (int i = 0; i < 3; ++i)
        if (cube.positions[far][i] < 0) q[i] = 1 - c / 2;
      const auto middle = static_cast<std::uint32_t>(cut.positions.size());
      cut.positions.push_back(q);
      if (from == 7)
        triangles.push_back({middle, b, d}), triangles.push_back({middle, d, to});
      else
        triangles.push_back({from, b, d}), triangles.push_back({from, d, middle});
    }
  }
  triangles.push_back({at, at + 1, at + 2});
  cut.triangles = triangles;
  const DistanceInterval found = distance(cube, cut);
  EXPECT_NEAR(found.low, c / std::sqrt(3.0), 1e-15);
  EXPECT_LE(found.high, 1.1001 * c / std::sqrt(3.0));
  EXPECT_GE(found.high, c / std::sqrt(3.0));
}

TEST(Distance, SpheresOneInTheOther) {
  const Mesh inner = shapes::sphere(24, 36);
  Mesh outer = inner;
  for (Vec3& p : outer.positions) p *= 1.1;
  // a corner of the outer one has that of the inner one as its nearest point: both are convex
  const DistanceInterval found = distance(inner, outer);
  EXPECT_NEAR(found.low, 0.1, 1e-15);
  EXPECT_NEAR(found.high, 0.1, 0.0101);
  // and by samples, where triangles differ
  const Mesh coarse = shapes::sphere(7, 9);
  for (const double relative : {0.02, 0.5}) {
    const DistanceInterval other = distance(inner, coarse, relative);
    const double want = sampled(inner, coarse, 24);
    EXPECT_GE(other.high, want);
    // low is within the spacing of samples: sides of 0.9 in 24 parts
    EXPECT_LE(other.low, want + 1e-3);
    EXPECT_LE(other.high, (1 + relative) * other.low + 1e-14);
  }
}

TEST(Distance, AnyTrianglesAgainstDenseSamples) {
  constexpr int kGrid = 24;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Mesh a = soup(seed, 11), b = soup(seed + 100, 13);
    const DistanceInterval found = distance(a, b);
    const double want = sampled(a, b, kGrid);
    EXPECT_GE(found.high, want - 1e-14) << seed;
    // sides are up to 2·√3 long
    EXPECT_LE(found.low, want + 2 * std::sqrt(3.0) / kGrid) << seed;
    EXPECT_LE(found.high, 1.1 * found.low + 1e-13) << seed;
  }
}

TEST(Distance, StaysTheSameUnderMotionAndScale) {
  shapes::Random random(5);
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    // of the odd ones, several triangles are equally near: there intervals may differ
    const bool ties = seed % 2 == 1;
    const Mesh a = ties ? soup(seed, 9) : sound_soup(seed, 9);
    const Mesh b = ties ? soup(seed + 100, 12) : sound_soup(seed + 100, 12);
    const DistanceInterval found = distance(a, b);
    const Quat turn = glm::normalize(Quat(random.between(-1, 1), random.between(-1, 1),
                                          random.between(-1, 1), random.between(-1, 1)));
    for (const double scale : {1.0, 1e-9, 1e6}) {
      const Vec3 by = scale * random.direction();
      const DistanceInterval other = distance(moved(a, turn, by, scale), moved(b, turn, by, scale));
      EXPECT_LE(other.low, scale * found.high * (1 + 1e-12));
      EXPECT_GE(other.high, scale * found.low * (1 - 1e-12));
      if (ties) continue;
      worst = std::max(worst, std::fabs(other.low / scale - found.low));
      worst = std::max(worst, std::fabs(other.high / scale - found.high));
    }
  }
  EXPECT_LE(worst, 1e-12);  // measured
}

TEST(Distance, SameWhateverTheThreads) {
  const Mesh a = shapes::sphere(60, 90), b = shapes::sphere(31, 47);
  const MeasuredMesh first(a), second(b);
  const DistanceInterval one = hausdorff_distance(first, second, {}, Job(JobOptions{1, {}}));
  const DistanceInterval four = hausdorff_distance(first, second, {}, Job(JobOptions{4, {}}));
  EXPECT_EQ(one.low, four.low);
  EXPECT_EQ(one.high, four.high);
  EXPECT_EQ(normal_error(first, second, one.high, Job(JobOptions{1, {}})).rms,
            normal_error(first, second, one.high, Job(JobOptions{4, {}})).rms);
}

TEST(Distance, BoundsHoldWhereSearchesRunOut) {
  const Mesh a = shapes::sphere(40, 60), b = shapes::sphere(17, 23);
  const MeasuredMesh first(a), second(b);
  const DistanceInterval sharp = hausdorff_distance(first, second, {.relative = 1e-3});
  for (const double searches : {0.0, 0.5, 2.0}) {
    const DistanceInterval found =
        hausdorff_distance(first, second, {.relative = 1e-3, .searches = searches});
    EXPECT_GE(found.high, sharp.low) << searches;
    EXPECT_LE(found.low, sharp.high) << searches;
  }
}

TEST(Distance, OfNothing) {
  const Mesh none, some = shapes::cube();
  EXPECT_EQ(distance(none, none).high, 0);
  EXPECT_EQ(distance(none, some).low, HUGE_VAL);
  EXPECT_EQ(distance(some, none).high, HUGE_VAL);
}

TEST(NormalErrorTest, TurnedPlatesAndSheetsWithTwoSides) {
  const Mesh flat = plate(4, 0, 1, 0);
  Mesh turned = flat;
  for (Vec3& p : turned.positions) p.z = p.x * std::tan(0.2);
  const NormalError found = normal_error(MeasuredMesh(flat), MeasuredMesh(turned), 1);
  EXPECT_NEAR(found.rms, 0.2, 1e-12);
  EXPECT_NEAR(found.largest, 0.2, 1e-12);
  // a sheet with both sides against itself in another order: no side is taken for the other
  Mesh sheet = flat, other;
  for (const Triangle& t : flat.triangles) sheet.triangles.push_back({t[0], t[2], t[1]});
  other = sheet;
  std::reverse(other.triangles.begin(), other.triangles.end());
  EXPECT_EQ(normal_error(MeasuredMesh(sheet), MeasuredMesh(other), 1e-9).largest, 0);
}

TEST(ProjectedAreaError, OfABoxWithoutALid) {
  const Mesh cube = shapes::cube();
  Mesh open = cube;
  std::erase_if(open.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return cube.positions[v].z > 0; });
  });
  // half a face along z, of a cube whose largest shadow is nearly 4·√3: 64 directions
  EXPECT_NEAR(projected_area_error(cube, open), 2 / (4 * std::sqrt(3.0)), 0.01);
  EXPECT_EQ(projected_area_error(cube, cube), 0);
}

}  // namespace
}  // namespace panwright::geometry::distance_test
