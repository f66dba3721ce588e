// Rays against closed forms: plate, box, sphere, holes, joints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "geometry/tessellate/tessellate.h"
#include "tests/trace/trace_models.h"

namespace panwright::trace::closed_forms_test {
namespace {

using namespace testing_support;

// A plate of 2 × 1 m in a target's pose: the plane, its frame and its back.
TEST(TracePlate, HitsAreThoseOfThePlane) {
  pan::Contents contents = single(plate(2, 1));
  contents.materials.emplace_back();
  contents.instances[0].back = 1;
  Random random(1);
  double worst = 0, worst_texcoord = 0;
  std::size_t hits = 0, backs = 0;
  for (int i = 0; i < 2000; ++i) {
    world::World world;
    const world::Pose pose{random.in_cube(3), random.rotation()};
    add(world, "plate", contents, pose);
    Scene scene;
    scene.update(world);
    const Vec3 origin = random.in_cube(2);
    const Ray one = ray(origin, pose.translation + random.in_cube(0.7) - origin);
    const Hit hit = scene.nearest(one);

    const Quat back = glm::conjugate(pose.rotation);
    const Vec3 from = back * (origin - pose.translation), along = back * one.direction;
    const double t = -from.z / along.z;
    const Vec3 at = from + t * along;
    const double margin = std::min(1 - std::fabs(at.x), 0.5 - std::fabs(at.y));
    if (std::fabs(margin) < 1e-9 || std::fabs(t) < 1e-9) continue;
    ASSERT_EQ(static_cast<bool>(hit), t > 0 && margin > 0) << i;
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit.front, along.z < 0);
    backs += !hit.front;
    const Ids ids = scene.ids(hit);
    EXPECT_EQ(ids.target, 1u);
    EXPECT_EQ(ids.node, 1u);
    EXPECT_EQ(ids.instance, 1u);
    EXPECT_EQ(ids.material, hit.front ? 1u : 2u);
    const Surface surface = scene.surface(hit);
    const Vec3 towards(0, 0, along.z < 0 ? 1 : -1);
    worst = std::max({worst, std::fabs(hit.distance - t) / (1 + t),
                      glm::length(surface.position - at), glm::length(surface.normal - towards),
                      glm::length(surface.facet - towards), glm::length(hit.direction - along),
                      glm::length(scene.observer_from(0)(surface.position) -
                                  (origin + hit.distance * one.direction))});
    worst_texcoord =
        std::max(worst_texcoord, glm::length(surface.texcoord - Vec2(at.x / 2 + 0.5, at.y + 0.5)));
  }
  printf("%zu hits, %zu of the back; worst %.1e, texture %.1e\n", hits, backs, worst,
         worst_texcoord);
  EXPECT_GT(hits, 900u);
  EXPECT_GT(backs, 300u);
  EXPECT_LT(worst, 1e-13);           // measured 3e-14: where rays graze
  EXPECT_LT(worst_texcoord, 1e-13);  // measured 3e-14
}

struct Slabs {
  double in = -std::numeric_limits<double>::infinity();
  double out = std::numeric_limits<double>::infinity();
};

// Where a line is inside a box about the origin.
Slabs through(const Vec3& sides, const Vec3& from, const Vec3& along) {
  Slabs slabs;
  for (int k = 0; k < 3; ++k) {
    const double a = (-sides[k] / 2 - from[k]) / along[k], b = (sides[k] / 2 - from[k]) / along[k];
    slabs.in = std::max(slabs.in, std::min(a, b));
    slabs.out = std::min(slabs.out, std::max(a, b));
  }
  return slabs;
}

// The inside of a closed mesh lets rays pass, as in images, or stops them.
TEST(TraceBox, InsidesPassOrStop) {
  const Vec3 sides(1, 2, 0.5);
  world::World world;
  add(world, "box", single(box(sides)));
  Scene scene;
  scene.update(world);
  Random random(2);
  double worst = 0;
  std::size_t outside = 0, inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray one = ray(random.in_cube(1.2), random.in_cube(1));
    const Slabs slabs = through(sides, one.origin, one.direction);
    if (std::fabs(slabs.out - slabs.in) < 1e-9 || std::fabs(slabs.in) < 1e-9) continue;
    const bool hits = slabs.in < slabs.out && slabs.out > 0;
    const bool within = hits && slabs.in < 0;
    const Hit passing = scene.nearest(one), stopping = scene.nearest(one, Insides::stop);
    ASSERT_EQ(static_cast<bool>(passing), hits && !within) << i;
    ASSERT_EQ(static_cast<bool>(stopping), hits) << i;
    EXPECT_EQ(scene.any(one), hits && !within);
    EXPECT_EQ(scene.any(one, Insides::stop), hits);
    if (passing) worst = std::max(worst, std::fabs(passing.distance - slabs.in));
    if (within) {
      worst = std::max(worst, std::fabs(stopping.distance - slabs.out));
      EXPECT_TRUE(scene.is_inside(stopping));
      // outwards all the same
      EXPECT_GT(glm::dot(scene.surface(stopping).normal, one.direction), 0);
    }
    outside += hits && !within;
    inside += within;
  }
  printf("%zu from outside, %zu from inside: worst %.1e\n", outside, inside, worst);
  EXPECT_GT(outside, 1000u);
  EXPECT_GT(inside, 1000u);
  EXPECT_LT(worst, 1e-14);  // measured 2e-15
}

// Far from the world's origin and from the observer, distances keep their precision.
TEST(TraceBox, DistanceCostsItsOwnRoundingOnly) {
  const Vec3 sides(1, 2, 0.5);
  for (const double far : {1e3, 1e7}) {
    world::World world;
    const Vec3 origin(3e7, -2e7, 1e7);
    add(world, "box", single(box(sides)), {origin, {1, 0, 0, 0}});
    Scene scene;
    scene.update(world);
    scene.place_observer({origin + Vec3(0, 0, far), {0, 1, 0, 0}});  // looks down −z
    const Hit hit = scene.nearest(ray({0.1, 0.2, 0}, {0, 0, 1}));
    ASSERT_TRUE(hit);
    EXPECT_LE(std::fabs(hit.distance - (far - 0.25)), 2e-16 * far);
    // y and z are turned about x
    EXPECT_LE(glm::length(scene.surface(hit).position - Vec3(0.1, -0.2, 0.25)), 1e-15);
  }
}

// Chords lie within the mesh's error below the sphere; normals of vertices are radii.
TEST(TraceSphere, HitsLieWithinTheChordError) {
  DiagnosticLog log;
  const auto mesh =
      geometry::tessellated(geometry::Sphere{1.0, geometry::SphereCounts{60, 60}}, {}, {}, log);
  ASSERT_TRUE(mesh) << to_text(log);
  world::World world;
  add(world, "sphere", single(*mesh));
  const double error = world[0].model()->meshes()[0].error;
  Scene scene;
  scene.update(world);
  Random random(3);
  std::size_t hits = 0;
  double deepest = 0, turned = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 origin = 3.0 * glm::normalize(random.in_cube(1));
    const Ray one = ray(origin, random.in_cube(0.5) - origin);
    const double middle = -glm::dot(origin, one.direction);
    const double half = 1 - (glm::dot(origin, origin) - middle * middle);
    ASSERT_GT(half, 0.2);  // none grazes
    const Hit hit = scene.nearest(one);
    ASSERT_TRUE(hit);
    ++hits;
    // the polyhedron is inside the sphere
    EXPECT_GE(hit.distance, middle - std::sqrt(half) - 1e-7);
    const Surface surface = scene.surface(hit);
    deepest = std::max(deepest, 1 - glm::length(surface.position));
    turned = std::max(turned, glm::length(surface.normal - glm::normalize(surface.position)));
    EXPECT_GT(glm::dot(surface.facet, surface.normal), 0.99);
  }
  printf("%zu hits: deepest %.2e of %.2e, normals %.1e\n", hits, deepest, error, turned);
  EXPECT_LE(deepest, error + 1e-7);
  EXPECT_GT(deepest, error / 2);
  EXPECT_LT(turned, 2e-15);  // measured 4e-16: those of a sphere are its positions
}

// Columns of alpha 0 and 1: bilinear alpha reaches half on the borders of texels.
TEST(TraceHoles, RaysPassWhereTheTextureCuts) {
  std::vector<std::uint8_t> rgba;
  for (int texel = 0; texel < 8; ++texel)
    for (int k = 0; k < 4; ++k) rgba.push_back(k < 3 || texel % 2 ? 255 : 0);
  pan::Contents contents = single(plate(2, 1));
  contents.textures.push_back({"grid", 4, 2, true, rgba});
  contents.materials[0].maps.cutout = 0;
  contents.materials[0].maps.threshold = 0.5;
  contents.materials.emplace_back();
  contents.nodes.push_back({"behind", 0, Vec3(0, 0, -1), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances.push_back({1, 0, 1, -1});
  world::World world;
  add(world, "grid", contents);
  Scene scene;
  scene.update(world);
  Random random(4);
  std::size_t through = 0;
  for (int i = 0; i < 4000; ++i) {
    const double x = random.between(-1, 1), y = random.between(-0.5, 0.5);
    const double column = 2 * (x + 1);
    if (std::fabs(column - std::round(column)) < 1e-9) continue;
    const bool hole = static_cast<int>(std::floor(column)) % 2 == 0;
    for (const double side : {1.0, -2.0}) {
      const Hit hit = scene.nearest(ray({x, y, side}, {0, 0, -side}));
      ASSERT_TRUE(hit);
      const std::uint32_t first = side > 0 ? 1 : 2, second = 3 - first;
      EXPECT_EQ(scene.ids(hit).node, side < 0 || !hole ? first : second) << x;
      Ray above = ray({x, y, side}, {0, 0, -side});
      above.max_distance = 1.5;
      EXPECT_EQ(scene.any(above), side < 0 || !hole);
      through += side > 0 && hole;
    }
  }
  EXPECT_GT(through, 1500u);
}

// A hinge of a quarter turn about x, from the world's joint values.
TEST(TraceJoints, PartsAreWhereTheirJointsPutThem) {
  pan::Contents contents = single(plate(2, 2));
  contents.nodes.push_back({"wing", 0, Vec3(0, 0, 1), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances[0].node = 1;
  pan::JointContent hinge;
  hinge.name = "hinge";
  hinge.node = 1;
  hinge.joint.kind = geometry::JointKind::revolute;
  hinge.joint.axis = Vec3(1, 0, 0);
  contents.joints.push_back(hinge);
  world::World world;
  add(world, "craft", contents);
  Scene scene;
  for (const double angle : {0.0, 0.3, -1.1}) {
    geometry::JointValues values{};
    values[0] = angle;
    world.set_joint(0, 0, values);
    scene.update(world);
    // down at y = 0.2: z = 1 + 0.2·tan(angle)
    const Hit hit = scene.nearest(ray({0.3, 0.2, 5}, {0, 0, -1}));
    ASSERT_TRUE(hit) << angle;
    EXPECT_NEAR(hit.distance, 4 - 0.2 * std::tan(angle), 1e-14);
    EXPECT_LE(glm::length(scene.surface(hit).normal - Vec3(0, -std::sin(angle), std::cos(angle))),
              1e-15);
    EXPECT_EQ(scene.ids(hit).node, 2u);
  }
  EXPECT_EQ(scene.work().models, 1u);
  EXPECT_EQ(scene.work().shapes, 3u);
}

}  // namespace
}  // namespace panwright::trace::closed_forms_test
