#include "tests/support/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::ray_test {
namespace {

support::RayCaster caster_of(const Mesh& mesh, const Mat4& world_from_mesh = Mat4(1)) {
  support::RayCaster caster;
  caster.add(mesh, world_from_mesh);
  caster.build();
  return caster;
}

struct Expected {
  double distance = 1e300;
  std::uint32_t triangle = 0xffffffffu;
  double margin = 1e300;  // of the ray from the outline of any triangle, in barycentric weights
};

// Every triangle, by signed volumes, in double.
Expected brute_force(const Mesh& mesh, const Vec3& origin, const Vec3& direction) {
  Expected expected;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3 a = mesh.positions[mesh.triangles[i][0]] - origin;
    const Vec3 b = mesh.positions[mesh.triangles[i][1]] - origin;
    const Vec3 c = mesh.positions[mesh.triangles[i][2]] - origin;
    const double u = glm::dot(direction, glm::cross(b, c));
    const double v = glm::dot(direction, glm::cross(c, a));
    const double w = glm::dot(direction, glm::cross(a, b));
    const double sum = u + v + w;
    const double inside = std::min({u / sum, v / sum, w / sum});
    const double distance =
        glm::dot(a, glm::cross(b - a, c - a)) / glm::dot(direction, glm::cross(b - a, c - a));
    if (!(distance > 0)) continue;
    expected.margin = std::min(expected.margin, std::fabs(inside));
    if (inside >= 0 && distance < expected.distance) {
      expected.distance = distance;
      expected.triangle = i;
    }
  }
  return expected;
}

TEST(Ray, AgreesWithADoubleLoop) {
  const Mesh mesh = shapes::sphere(15, 21);
  const support::RayCaster caster = caster_of(mesh);
  shapes::Random random(1);
  int hits = 0;
  int compared = 0;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 origin = random.direction() * random.between(0, 3);
    const Vec3 direction = random.direction();
    const Expected expected = brute_force(mesh, origin, direction);
    const auto hit = caster.closest({origin, direction * random.between(1e-3, 1e3)});
    EXPECT_EQ(hit.has_value(), caster.any({origin, direction}));
    // within 1e-5 of an outline the search's single precision may decide otherwise
    if (expected.margin < 1e-5) continue;
    ++compared;
    ASSERT_EQ(hit.has_value(), expected.triangle != 0xffffffffu);
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->triangle, expected.triangle);
    EXPECT_EQ(hit->instance, 0u);
    worst = std::max(worst, std::fabs(hit->distance - expected.distance));
    const Triangle& t = mesh.triangles[hit->triangle];
    const Vec3 place = mesh.positions[t[0]] +
                       hit->barycentric.x * (mesh.positions[t[1]] - mesh.positions[t[0]]) +
                       hit->barycentric.y * (mesh.positions[t[2]] - mesh.positions[t[0]]);
    EXPECT_LT(glm::length(origin + hit->distance * direction - place), 1e-13);  // 7e-15 measured
    EXPECT_GT(glm::dot(hit->normal, place), 0);
  }
  EXPECT_GT(compared, 19000);
  EXPECT_GT(hits, 5000);
  EXPECT_LT(worst, 1e-13);  // 1.1e-14 measured
}

TEST(Ray, ASphereFromNearAndFar) {
  const Mesh mesh = shapes::sphere(400, 400);
  const support::RayCaster caster = caster_of(mesh);
  shapes::Random random(2);
  for (const double range : {1.5, 1e3, 1e6, 1.5e11}) {
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 toward = random.direction();
      const Vec3 side = glm::normalize(glm::cross(toward, random.direction()));
      const double impact = random.between(0, 0.95);
      const Vec3 origin = toward * range + side * impact;
      const auto hit = caster.closest({origin, -toward});
      ASSERT_TRUE(hit.has_value());
      const double along = glm::dot(origin, toward);
      const Vec3 across = origin - along * toward;
      const double expected = along - std::sqrt(1 - glm::dot(across, across));
      worst = std::max(worst, std::fabs(hit->distance - expected));
      EXPECT_FALSE(caster.any({origin, toward}));
    }
    // 1.53e-4 measured at range 1.5 to 1e6: facets dip 3.9e-5, over the cosine 0.31 at impact
    // 0.95; the ulp of an astronomical unit is 3e-5
    EXPECT_LT(worst, 1.6e-4 + 1e-15 * range) << range;
  }
}

TEST(Ray, RaysAtEdgesAndVerticesNeverSlipThrough) {
  const Mesh mesh = shapes::sphere(12, 17);
  const support::RayCaster caster = caster_of(mesh);
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& a = mesh.positions[t[k]];
      const Vec3& b = mesh.positions[t[(k + 1) % 3]];
      for (const double w : {0.0, 0.25, 0.5}) {
        const Vec3 target = (1 - w) * a + w * b;
        for (const Vec3& from : {Vec3(0), 0.3 * a, 5.0 * target}) {
          const Vec3 direction = target - from;
          const auto hit = caster.closest({from, direction});
          ASSERT_TRUE(hit.has_value());
          EXPECT_NEAR(hit->distance, glm::length(direction), 1e-14);  // 1.3e-15 measured
        }
      }
    }
  }
}

TEST(Ray, RangesAreDecidedInDouble) {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
  mesh.triangles = {{0, 1, 2}};
  const support::RayCaster caster = caster_of(mesh);
  const double height = 0.7654321987654321;
  Ray ray{{0.1, 0.2, height}, {0, 0, -1}};
  const auto hit = caster.closest(ray);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->distance, height);
  for (const auto& [low, high, found] : {std::tuple{0.0, height, true},
                                         {height, 1.0, true},
                                         {0.0, std::nextafter(height, 0.0), false},
                                         {std::nextafter(height, 1.0), 9.0, false},
                                         {height, height, true},
                                         {0.9, 0.1, false}}) {
    ray.min_distance = low;
    ray.max_distance = high;
    EXPECT_EQ(caster.closest(ray).has_value(), found) << low << " " << high;
    EXPECT_EQ(caster.any(ray), found);
  }
  // starting on the triangle itself
  EXPECT_TRUE(caster.any({{0.1, 0.2, 0}, {0, 0, 1}}));
  EXPECT_FALSE(caster.any({{0.1, 0.2, 0}, {0, 0, 1}, 1e-12}));
}

TEST(Ray, TheNearerOfTwoLayersThatSinglePrecisionCannotTellApart) {
  const auto plate = [](double z) {
    Mesh mesh;
    mesh.positions = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  support::RayCaster caster;
  const std::vector<double> heights{0, 3e-10, -2e-10, 3e-10, 1e-12, 2.9e-10, -5e-9};
  for (const double z : heights) caster.add(plate(z), Mat4(1));
  caster.build();
  shapes::Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 from(random.between(-0.3, 0.3), random.between(-0.3, 0.3), 1);
    const Vec3 to(random.between(-0.9, 0.9), random.between(-0.9, 0.9), 0);
    const auto above = caster.closest({from, to - from});
    ASSERT_TRUE(above.has_value());
    EXPECT_EQ(above->instance, 1u);  // 3e-10, and the lower of two instances there
    const auto below = caster.closest({-from, from - to});
    ASSERT_TRUE(below.has_value());
    EXPECT_EQ(below->instance, 6u);
  }
}

TEST(Ray, InstancesAreMovedAndMirrored) {
  const Mesh mesh = shapes::cube();
  support::RayCaster caster;
  EXPECT_EQ(caster.add(mesh, matrix_from_trs({10, 0, 0}, {1, 0, 0, 0}, {1, 1, 1})), 0u);
  EXPECT_EQ(caster.add(mesh, matrix_from_trs({-10, 0, 0}, {1, 0, 0, 0}, {-2, 1, 1})), 1u);
  caster.build();
  const auto right = caster.closest({{0, 0.3, 0.2}, {1, 0, 0}});
  ASSERT_TRUE(right.has_value());
  EXPECT_EQ(right->instance, 0u);
  EXPECT_NEAR(right->distance, 9, 1e-14);
  EXPECT_EQ(right->normal, Vec3(-1, 0, 0));
  const auto left = caster.closest({{0, 0.3, 0.2}, {-1, 0, 0}});
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->instance, 1u);
  EXPECT_NEAR(left->distance, 8, 1e-14);
  EXPECT_EQ(left->normal, Vec3(1, 0, 0));  // outwards, though the matrix mirrors
  EXPECT_FALSE(caster.closest({{0, 0, 0}, {0, 0, 1}}).has_value());
}

TEST(Ray, TinyAndHugeSetsFarFromTheOrigin) {
  for (const double scale : {1e-30, 1e-9, 1.0, 1e12, 1e30}) {
    const Vec3 place = scale * Vec3(3e6, -2e6, 1e6);
    const Mesh mesh = shapes::cube();
    const support::RayCaster caster =
        caster_of(mesh, matrix_from_trs(place, {1, 0, 0, 0}, Vec3(scale)));
    const auto hit =
        caster.closest({place + scale * Vec3(0.25, 0.5, 4), {0, 0, -1e-200}, 0, 1e3 * scale});
    ASSERT_TRUE(hit.has_value()) << scale;
    // 6.3e-11 measured; the ulp of places 3e6 sizes away is 4.7e-10
    EXPECT_NEAR(hit->distance / scale, 3, 5e-10);
    EXPECT_FALSE(caster.any({place + scale * Vec3(1.5, 0.5, 4), {0, 0, -1}, 0, 1e3 * scale}));
  }
}

TEST(Ray, GrazingRays) {
  const Mesh mesh = shapes::cube();
  const support::RayCaster caster = caster_of(mesh);
  for (const double height : {1e-3, 1e-5}) {
    // over the face, and through it
    EXPECT_FALSE(caster.any({{-5, 0.2, 1 + height}, {1, 0, 0}}));
    const auto hit = caster.closest({{-5, 0.2, 1 - height}, {1, 0, 0}});
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->distance, 4, 1e-12);
    // down onto the face at a slope of height / 3
    const double start = 1 + height;
    const auto slope = caster.closest({{-2.1, 0.2, start}, {3, 0, -height}});
    ASSERT_TRUE(slope.has_value());
    const double down = (start - 1) / height;
    // 1.6e-11 measured at 1e-5: the last bit of a height, over the slope
    EXPECT_NEAR(slope->distance, down * std::hypot(3, height), 1e-15 / height);
    EXPECT_EQ(slope->normal, Vec3(0, 0, 1));
  }
  // in the plane of a face: whatever is answered is on the cube, and a number
  const auto edge_on = caster.closest({{-5, 0.2, 1}, {1, 0, 0}});
  if (edge_on) {
    EXPECT_GE(edge_on->distance, 4 - 1e-6);
    EXPECT_LE(edge_on->distance, 6 + 1e-6);
  }
}

TEST(Ray, DegenerateTrianglesAndEmptySets) {
  support::RayCaster empty;
  empty.build();
  EXPECT_FALSE(empty.any({{0, 0, 0}, {0, 0, 1}}));
  support::RayCaster none;
  none.add(Mesh{}, Mat4(1));
  none.build();
  EXPECT_FALSE(none.closest({{0, 0, 0}, {0, 0, 1}}).has_value());

  Mesh mesh = shapes::cube();
  mesh.triangles.push_back({0, 0, 0});
  mesh.triangles.push_back({0, 1, 1});
  mesh.positions.push_back({0, 0, 0});
  mesh.triangles.push_back({0, 7, 8});  // a needle along the diagonal
  const support::RayCaster caster = caster_of(mesh);
  shapes::Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const auto hit = caster.closest({random.direction() * 4.0, random.direction()});
    if (!hit) continue;
    EXPECT_TRUE(std::isfinite(hit->distance));
    EXPECT_TRUE(is_finite(hit->normal));
    EXPECT_LT(hit->triangle, 12u);
  }
  const auto middle = caster.closest({{0.1, 0.2, 9}, {0, 0, -1}});
  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(middle->distance, 8, 1e-14);
}

TEST(Ray, BuildingAgainGivesTheSameAnswers) {
  const Mesh mesh = shapes::sphere(50, 70);
  const support::RayCaster first = caster_of(mesh);
  const support::RayCaster second = caster_of(mesh);
  shapes::Random random(13);
  for (int i = 0; i < 5000; ++i) {
    const Ray ray{random.direction() * 2.0, random.direction()};
    const auto a = first.closest(ray);
    const auto b = second.closest(ray);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    EXPECT_EQ(a->triangle, b->triangle);
    EXPECT_EQ(a->distance, b->distance);
    EXPECT_EQ(a->barycentric, b->barycentric);
  }
}

}  // namespace
}  // namespace panwright::geometry::ray_test
