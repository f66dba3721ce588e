#include "geometry/ray/instances.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::instances_test {
namespace {

Mesh ball(std::uint32_t rings) {
  DiagnosticLog log;
  auto mesh = tessellated(Sphere{1.0, SphereCounts{rings, rings}}, {}, {}, log);
  EXPECT_TRUE(mesh) << to_text(log);
  return *mesh;
}

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Vec3 direction(std::mt19937_64& random) {
  for (;;) {
    const Vec3 v(2 * uniform(random) - 1, 2 * uniform(random) - 1, 2 * uniform(random) - 1);
    const double square = glm::dot(v, v);
    if (square > 0.01 && square < 1) return v / std::sqrt(square);
  }
}

// Every triangle of every placement, one by one, in long double.
struct Brute {
  struct Placed {
    const Mesh* mesh;
    Mat4 place;
  };
  std::vector<Placed> placed;

  double closest(const Ray& ray) const {
    long double best = INFINITY;
    using V = glm::vec<3, long double>;
    const V o(ray.origin), d(ray.direction);
    for (const Placed& one : placed)
      for (const Triangle& t : one.mesh->triangles) {
        V p[3];
        for (std::size_t k = 0; k < 3; ++k)
          p[k] = V(Vec3(one.place * Vec4(one.mesh->positions[t[k]], 1)));
        const V e1 = p[1] - p[0], e2 = p[2] - p[0], h = glm::cross(d, e2);
        const long double a = glm::dot(e1, h);
        if (a == 0) continue;
        const V s = o - p[0], q = glm::cross(s, e1);
        const long double u = glm::dot(s, h) / a, v = glm::dot(d, q) / a;
        const long double distance = glm::dot(e2, q) / a;
        if (u >= 0 && v >= 0 && u + v <= 1 && distance >= ray.min_distance &&
            distance <= ray.max_distance)
          best = std::min(best, distance);
      }
    return static_cast<double>(best);
  }
};

TEST(InstanceCaster, AgreesWithEveryTriangleOneByOne) {
  std::mt19937_64 random(7);
  const Mesh mesh = ball(8);
  Brute brute;
  InstanceCaster caster;
  const std::uint32_t number = caster.add_mesh(mesh.positions, mesh.triangles);
  for (int i = 0; i < 60; ++i) {
    const Vec3 scale(std::exp(4 * uniform(random) - 2) * (i % 3 == 0 ? -1 : 1),
                     std::exp(4 * uniform(random) - 2), i % 7 == 0 ? 0 : 0.5);
    const Quat turn = glm::angleAxis(3 * uniform(random), direction(random));
    const Mat4 place = matrix_from_trs(direction(random) * (20 * uniform(random)), turn, scale);
    caster.add(number, place, false);
    brute.placed.push_back({&mesh, place});
  }
  caster.build();
  int hits = 0;
  double worst = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 d = direction(random);
    const Vec3 target = direction(random) * (15 * uniform(random));
    Ray ray{target - d * (i % 2 ? 50.0 : 3.0), d};
    if (i % 5 == 0) ray.max_distance = 60 * uniform(random);
    const double exact = brute.closest(ray);
    const auto hit = caster.closest(ray);
    EXPECT_EQ(caster.any(ray), hit.has_value());
    // rays within 2e-6 radii of an outline may be given either way: none of these is
    ASSERT_EQ(hit.has_value(), std::isfinite(exact)) << i;
    if (!hit) continue;
    ++hits;
    worst = std::max(worst, std::fabs(hit->distance - exact));
  }
  EXPECT_GT(hits, 1000);
  // 2e-13 seen: grazing rays on flattened balls
  EXPECT_LE(worst, 1e-10);
}

// From 1e8 radii away, where the search alone would see nothing smaller than 8 m.
TEST(InstanceCaster, DistanceCostsNothing) {
  const Mesh mesh = ball(200);
  InstanceCaster caster;
  caster.add(caster.add_mesh(mesh.positions, mesh.triangles), Mat4(1), false);
  caster.build();
  std::mt19937_64 random(3);
  for (const double distance : {1.0, 1e4, 1e8}) {
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 d = direction(random);
      const Vec3 aside = glm::normalize(glm::cross(d, direction(random))) * (0.9 * uniform(random));
      const Ray ray{aside - d * (distance + 1), d};
      const auto hit = caster.closest(ray);
      ASSERT_TRUE(hit);
      EXPECT_TRUE(hit->front);
      const Triangle& t = mesh.triangles[hit->triangle];
      const Vec3& a = mesh.positions[t[0]];
      const Vec3 at = a + hit->barycentric.x * (mesh.positions[t[1]] - a) +
                      hit->barycentric.y * (mesh.positions[t[2]] - a);
      // off the ray sideways: the triangle is where the ray passes
      const Vec3 off = at - aside;
      worst = std::max(worst, glm::length(off - d * glm::dot(off, d)));
    }
    // 4e-15 seen at 1: what the doubles of the origin and the direction are worth
    EXPECT_LE(worst, 1e-14 + 1.2e-15 * distance) << distance;
  }
}

// A ray that starts just above a triangle and leads away from it is free, however flat.
TEST(InstanceCaster, NeverHitsWhatARayLeaves) {
  Mesh mesh;
  constexpr std::uint32_t kSide = 40;
  for (std::uint32_t j = 0; j <= kSide; ++j)
    for (std::uint32_t i = 0; i <= kSide; ++i)
      mesh.positions.push_back({static_cast<double>(i) / kSide, static_cast<double>(j) / kSide, 0});
  for (std::uint32_t j = 0; j < kSide; ++j)
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + kSide + 2});
      mesh.triangles.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  InstanceCaster caster;
  const Mat4 place =
      matrix_from_trs({3, -2, 1}, glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3))), Vec3(2));
  caster.add(caster.add_mesh(mesh.positions, mesh.triangles), place, false);
  caster.build();
  std::mt19937_64 random(11);
  const Mat3 turn(place);
  for (int i = 0; i < 20000; ++i) {
    const double height = std::pow(10.0, -12 + 8 * uniform(random));
    const double rise = std::pow(10.0, -6 + 6 * uniform(random));
    const Vec3 start(uniform(random), uniform(random), height);
    const double turned = 2 * kPi * uniform(random);
    const Vec3 away = glm::normalize(turn * Vec3(std::cos(turned), std::sin(turned), rise));
    EXPECT_FALSE(caster.any({Vec3(place * Vec4(start, 1)), away}));
    // and from below it is hit
    const Vec3 below(start.x, start.y, -height);
    const Vec3 up = glm::normalize(turn * Vec3(0.1, 0.05, 1));
    EXPECT_TRUE(caster.any({Vec3(place * Vec4(below, 1)), up}));
  }
}

TEST(InstanceCaster, FiltersAreAskedWhereWanted) {
  const Mesh mesh = ball(12);
  InstanceCaster caster;
  const std::uint32_t number = caster.add_mesh(mesh.positions, mesh.triangles);
  caster.add(number, Mat4(1), true);
  caster.add(number, matrix_from_trs({0, 0, -4}, Quat(1, 0, 0, 0), Vec3(1)), false);
  caster.build();
  const HitFilter none{[](const void*, const InstanceHit&) { return false; }, nullptr};
  const HitFilter insides{[](const void*, const InstanceHit& hit) { return !hit.front; }, nullptr};
  const Ray down{{0.1, 0.05, 10}, {0, 0, -1}};
  EXPECT_EQ(caster.closest(down)->instance, 0u);
  EXPECT_TRUE(caster.closest(down)->front);
  EXPECT_EQ(caster.closest(down, none)->instance, 1u);
  const auto back = caster.closest(down, insides);
  EXPECT_EQ(back->instance, 0u);
  EXPECT_FALSE(back->front);
  EXPECT_TRUE(caster.any(down, none));
  Ray near = down;
  near.max_distance = 11.5;
  EXPECT_FALSE(caster.any(near, none));
}

TEST(InstanceCaster, NothingToHit) {
  InstanceCaster empty;
  empty.build();
  EXPECT_FALSE(empty.any({{0, 0, 0}, {0, 0, 1}}));
  InstanceCaster pointless;
  const std::vector<Vec3> positions(3, Vec3(1, 2, 3));
  const std::vector<Triangle> triangles{{0, 1, 2}};
  pointless.add(pointless.add_mesh(positions, triangles), Mat4(1), false);
  pointless.add(pointless.add_mesh({}, {}), Mat4(0), false);
  pointless.build();
  EXPECT_FALSE(pointless.closest({{1, 2, 0}, {0, 0, 1}}));
}

// A mesh that several casters share, flattened in one of them, gives the hits of a mesh of its own.
TEST(InstanceCaster, MeshesMayBeShared) {
  const Mesh mesh = ball(8);
  const SearchMesh shared = search_mesh(mesh.positions, mesh.triangles);
  for (const double depth : {1.0, 0.0}) {
    const Mat4 place = matrix_from_trs({1, 2, 3}, Quat(1, 0, 0, 0), {1, 2, depth});
    InstanceCaster own, sharing;
    own.add(own.add_mesh(mesh.positions, mesh.triangles), place, false);
    sharing.add(sharing.add_mesh(shared), place, false);
    own.build();
    sharing.build();
    std::mt19937_64 random(11);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 d = direction(random);
      const Ray ray{Vec3(1, 2, 3) - 5.0 * d + 0.5 * direction(random), d};
      const auto a = own.closest(ray);
      const auto b = sharing.closest(ray);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      ++hits;
      EXPECT_EQ(a->distance, b->distance);
      EXPECT_EQ(a->triangle, b->triangle);
    }
    EXPECT_GT(hits, 100);
  }
}

// Before the build, within it, or not at all: what was cancelled can be built again.
TEST(InstanceCaster, ACancelledBuildCanBeDoneAgain) {
  const Mesh mesh = ball(400);
  const auto start = std::chrono::steady_clock::now();
  {
    InstanceCaster whole;
    whole.add(whole.add_mesh(mesh.positions, mesh.triangles), Mat4(1), false);
    whole.build();
  }
  const auto seconds = std::chrono::steady_clock::now() - start;
  int cancelled = 0;
  for (int i = 0; i < 8; ++i) {
    InstanceCaster caster;
    caster.add(caster.add_mesh(mesh.positions, mesh.triangles), Mat4(1), false);
    const Job job(JobOptions{});
    if (i == 0) job.cancel();
    std::thread other([&] {
      std::this_thread::sleep_for(seconds * i / 8);
      job.cancel();
    });
    bool built = true;
    try {
      caster.build(job);
    } catch (const Cancelled&) {
      built = false;
    }
    other.join();
    cancelled += !built;
    if (!built) caster.build();
    const auto hit = caster.closest({{0, 0, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 4, 1e-3);
  }
  EXPECT_GT(cancelled, 0);
}

}  // namespace
}  // namespace panwright::geometry::instances_test
