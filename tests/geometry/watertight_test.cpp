// No ray slips between the triangles of a closed mesh.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "geometry/ray/instances.h"
#include "shapes.h"

namespace panwright::geometry::watertight_test {
namespace {

// A convex mesh about the origin, inscribed in a stretched unit ball or cube.
struct Solid {
  const char* name;
  Mesh mesh;
  Vec3 stretch;
};

// Counts of rays that pass a closed mesh without a hit where there must be one.
struct Slips {
  std::atomic<std::uint64_t> rays{0};
  std::atomic<std::uint64_t> closest{0};
  std::atomic<std::uint64_t> any{0};
};

// Rays at shared edges and corners: from the middle, from close to a face inside, and from outside,
// near and a million sizes away.
void shoot(const Solid& solid, double size, const Vec3& place, std::uint64_t count, Slips& slips) {
  Mesh mesh = solid.mesh;
  for (Vec3& p : mesh.positions) p = size * solid.stretch * p + place;
  InstanceCaster instances;
  instances.add(instances.add_mesh(mesh.positions, mesh.triangles), Mat4(1), false);
  instances.build();
  parallel_for(16, [&](std::size_t task) {
    shapes::Random random(100 + task);
    for (std::uint64_t i = 0; i < count / 16; ++i) {
      const Triangle& t = mesh.triangles[static_cast<std::size_t>(
          random() * static_cast<double>(mesh.triangles.size()))];
      const auto k = static_cast<std::size_t>(3 * random());
      const Vec3& a = mesh.positions[t[k]];
      const Vec3& b = mesh.positions[t[(k + 1) % 3]];
      const Vec3& c = mesh.positions[t[(k + 2) % 3]];
      const Vec3 target = i % 3 == 0 ? a : a + random() * (b - a);
      const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
      Vec3 from;
      double reach = 1e30;
      if (i % 4 == 0) {
        from = place + 0.5 * random() * (target - place);
      } else if (i % 4 == 1) {
        const double u = random.between(0.05, 0.45);
        const double v = random.between(0.05, 0.45);
        // 1e-4 to 1e-8 sizes deep
        from = a + u * (b - a) + v * (c - a) - size * std::pow(10, random.between(-8, -4)) * normal;
      } else {
        const Vec3& other = mesh.positions[static_cast<std::size_t>(
            random() * static_cast<double>(mesh.positions.size()))];
        const Vec3 inside = place + 0.5 * (other - place);
        from = target + size * (i % 4 == 2 ? 5 : 1e6) * glm::normalize(target - inside);
        reach = glm::length(inside - from);
      }
      const Vec3 d = glm::normalize(target - from);
      const Ray ray{from, d, 0, reach};
      ++slips.rays;
      slips.closest += !instances.closest(ray);
      slips.any += !instances.any(ray);
    }
  });
}

// The surface of a closed mesh is crossed by every ray from inside, and by a ray from outside
// before it comes to a place inside. Single precision let 7 % of the rays from close to a face
// slip.
TEST(Watertight, NothingSlipsThroughEdgesAndCorners) {
  const std::vector<Solid> solids{{"cube", shapes::cube(), Vec3(1)},
                                  {"ball", shapes::sphere(12, 17), Vec3(1)},
                                  {"lens", shapes::sphere(7, 200), Vec3(1, 1, 0.1)}};
  std::uint64_t rays = 0;
  for (const Solid& solid : solids)
    for (const double size : {1e-6, 1.0, 1e6})
      for (const double away : {0.0, 1e3}) {
        Slips slips;
        shoot(solid, size, size * away * Vec3(1, -0.7, 0.3), 560'000, slips);
        EXPECT_EQ(slips.closest, 0u) << solid.name << " " << size << " " << away;
        EXPECT_EQ(slips.any, 0u) << solid.name << " " << size << " " << away;
        rays += slips.rays;
      }
  EXPECT_GT(rays, 10'000'000u);
}

}  // namespace
}  // namespace panwright::geometry::watertight_test
