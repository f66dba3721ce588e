// Surfaces of revolution that stand on each other: their vertices meet in the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "base/clock.h"
#include "base/parallel.h"
#include "compiler/compile.h"
#include "pan/model.h"

namespace panwright::compiler::circular_edges_test {
namespace {

geometry::Cylinder cylinder(double radius, double height) {
  geometry::Cylinder shape;
  shape.radius = radius;
  shape.height = height;
  return shape;
}

geometry::Cone cone(double bottom, double top, double height) {
  geometry::Cone shape;
  shape.bottom_radius = bottom;
  shape.top_radius = top;
  shape.height = height;
  return shape;
}

Quat turned(double degrees) { return quat_from_fixed_xyz({0, 0, degrees * kDegree}); }

class Stack {
 public:
  Stack() {
    scene_.nodes.push_back({"root", scene::kNone, {}, {}});
    scene_.materials.emplace_back();
  }
  void add(const geometry::Shape& shape, const scene::Transform& where) {
    scene_.nodes.push_back({"n", 0, where, {}});
    scene_.shapes.push_back(shape);
    scene::Instance instance;
    instance.node = static_cast<std::int32_t>(scene_.nodes.size()) - 1;
    instance.shape = static_cast<std::int32_t>(scene_.shapes.size()) - 1;
    scene_.instances.push_back(instance);
  }
  pan::Model compiled_to(double tolerance) {
    scene_.budget.tolerance = tolerance;
    EXPECT_EQ(scene::check(scene_), "");
    DiagnosticLog log;
    const auto bytes = compiled(scene_, {}, log);
    EXPECT_TRUE(bytes) << to_text(log);
    auto model = pan::Model::from_bytes(*bytes, "stack.pan", log);
    EXPECT_TRUE(model && model->check(log)) << to_text(log);
    return *std::move(model);
  }
  scene::Scene& scene() { return scene_; }

 private:
  scene::Scene scene_;
};

// The vertices of an instance at a height in the world.
std::vector<Vec3> at_height(const pan::Model& model, std::size_t index, double z) {
  const auto& instance = model.instances()[index];
  const auto& mesh = model.meshes()[instance.mesh];
  const Mat4 world = model.world_from_nodes()[instance.node];
  std::vector<Vec3> out;
  for (const auto& p : model.mesh(instance.mesh).positions) {
    const Vec3 local = Vec3(mesh.origin[0], mesh.origin[1], mesh.origin[2]) + Vec3(p.x, p.y, p.z);
    const Vec3 point(world * Vec4(local, 1.0));
    if (std::fabs(point.z - z) < 1e-4) out.push_back(point);
  }
  return out;
}

// How far the vertices of two instances lie apart at a height; infinity where one has none.
double gap(const pan::Model& model, std::size_t a, std::size_t b, double z) {
  const auto furthest = [](const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    double worst = from.empty() ? HUGE_VAL : 0;
    for (const Vec3& p : from) {
      double nearest = HUGE_VAL;
      for (const Vec3& q : to) nearest = std::min(nearest, glm::length(p - q));
      worst = std::max(worst, nearest);
    }
    return worst;
  };
  auto in_a = at_height(model, a, z), in_b = at_height(model, b, z);
  // the middles of caps stand on the axis and need not meet anything
  const auto inner = [](const Vec3& p) { return glm::length(Vec2(p)) < 0.1; };
  std::erase_if(in_a, inner);
  std::erase_if(in_b, inner);
  return std::max(furthest(in_a, in_b), furthest(in_b, in_a));
}

std::uint32_t triangles(const pan::Model& model, std::size_t instance) {
  return model.meshes()[model.instances()[instance].mesh].triangle_count;
}

constexpr double kRounding = 2e-7;  // of vertices 1 m off in float32: measured 1.2e-7
const Quat kStraight(1, 0, 0, 0);

TEST(CircularEdges, ACylinderAndTheConeOnItMeet) {
  Stack stack;
  stack.add(cylinder(1, 2), {});
  stack.add(cone(1, 0.3, 0.5), {{0, 0, 1.25}, kStraight, Vec3(1)});
  stack.add(cylinder(0.3, 1), {{0, 0, 2}, kStraight, Vec3(1)});
  const pan::Model model = stack.compiled_to(1e-3);
  EXPECT_LT(gap(model, 0, 1, 1), kRounding);
  EXPECT_LT(gap(model, 1, 2, 1.5), kRounding);
  for (const auto& mesh : model.meshes()) EXPECT_LE(mesh.error, 1e-3);
  // apart they do not: each takes its own count
  Stack apart;
  apart.add(cylinder(1, 2), {});
  apart.add(cone(1, 0.3, 0.5), {{0, 0, 1.26}, kStraight, Vec3(1)});
  apart.add(cylinder(0.3, 1), {{0, 0, 3}, kStraight, Vec3(1)});
  const pan::Model alone = apart.compiled_to(1e-3);
  EXPECT_LT(triangles(alone, 0), triangles(model, 0));
  EXPECT_LT(triangles(alone, 2), triangles(model, 2));
}

TEST(CircularEdges, TurnedByAPartOfACircle) {
  for (const double angle : {90.0, 45.0, 30.0, -120.0, 180.0}) {
    Stack stack;
    stack.add(cylinder(1, 2), {});
    stack.add(cone(1, 0.3, 0.5), {{0, 0, 1.25}, turned(angle), Vec3(1)});
    EXPECT_LT(gap(stack.compiled_to(1e-3), 0, 1, 1), kRounding) << angle;
  }
}

TEST(CircularEdges, TurnedAskewTheyAreLeftAlone) {
  Stack stack, apart;
  for (Stack* s : {&stack, &apart}) {
    const double z = s == &stack ? 1.25 : 1.5;
    s->add(cylinder(1, 2), {});
    s->add(cone(1, 0.3, 0.5), {{0, 0, z}, turned(13.7), Vec3(1)});
  }
  const pan::Model touching = stack.compiled_to(1e-3), alone = apart.compiled_to(1e-3);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(triangles(touching, i), triangles(alone, i));
  // a third that stands straight meets the first all the same
  stack.add(cone(1, 0.2, 0.5), {{0, 0, -1.25}, quat_from_fixed_xyz({kPi, 0, 0}), Vec3(1)});
  EXPECT_LT(gap(stack.compiled_to(1e-3), 0, 2, -1), kRounding);
}

TEST(CircularEdges, MirroredScaledAndUpsideDown) {
  const scene::Transform places[] = {
      {{0, 0, 1.25}, kStraight, {1, 1, -1}},
      {{0, 0, 1.25}, quat_from_fixed_xyz({kPi, 0, 0}), Vec3(1)},
      {{0, 0, 1.25}, kStraight, {-1, 1, -1}},
      {{0, 0, 1.25}, turned(90), {-1, -1, -1}},
  };
  for (const scene::Transform& place : places) {
    Stack stack;
    stack.add(cylinder(1, 2), {});
    stack.add(cone(0.3, 1, 0.5), place);
    EXPECT_LT(gap(stack.compiled_to(1e-3), 0, 1, 1), kRounding);
  }
  Stack scaled;
  scaled.add(cylinder(1, 2), {});
  scaled.add(cone(0.25, 0.1, 0.5), {{0, 0, 1.25}, kStraight, {4, 4, 1}});
  const pan::Model model = scaled.compiled_to(1e-3);
  EXPECT_LT(gap(model, 0, 1, 1), 2 * kRounding);
  EXPECT_LE(4 * model.meshes()[1].error, 1e-3);
}

TEST(CircularEdges, AnEllipseIsNoCircularEdge) {
  Stack stack, alone;
  stack.add(cylinder(1, 2), {});
  alone.add(cylinder(1, 2), {});
  stack.add(cone(1, 0.3, 0.5), {{0, 0, 1.25}, kStraight, {1, 1.001, 1}});
  EXPECT_EQ(triangles(stack.compiled_to(1e-3), 0), triangles(alone.compiled_to(1e-3), 0));
}

TEST(CircularEdges, NearlyIsNotMeeting) {
  for (const Vec3& off : {Vec3(0, 0, 1e-5), Vec3(1e-5, 0, 0)}) {
    Stack stack, alone;
    stack.add(cylinder(1, 2), {});
    alone.add(cylinder(1, 2), {});
    stack.add(cone(1, 0.3, 0.5), {Vec3(0, 0, 1.25) + off, kStraight, Vec3(1)});
    EXPECT_EQ(triangles(stack.compiled_to(1e-3), 0), triangles(alone.compiled_to(1e-3), 0));
  }
}

TEST(CircularEdges, FarFromTheOrigin) {
  Stack stack;
  stack.add(cylinder(1, 2), {{4e6, -3e6, 0}, kStraight, Vec3(1)});
  stack.add(cone(1, 0.3, 0.5), {{4e6, -3e6, 1.25}, kStraight, Vec3(1)});
  const pan::Model model = stack.compiled_to(1e-3);
  EXPECT_LT(gap(model, 0, 1, 1), kRounding + 2e-9);  // world coordinates have ulps of 1e-9
}

TEST(CircularEdges, OneFineInstanceRefinesWhatItStandsOn) {
  Stack stack;
  stack.add(cylinder(1, 2), {});
  stack.add(cone(1, 0.3, 0.5), {{0, 0, 1.25}, kStraight, Vec3(1)});
  stack.scene().instances[1].tolerance = 1e-5;
  const pan::Model model = stack.compiled_to(1e-3);
  EXPECT_LT(gap(model, 0, 1, 1), kRounding);
  EXPECT_LE(model.meshes()[1].error, 1e-5);
  EXPECT_EQ(model.mesh_tolerances()[0].tolerance, 1e-3);
  EXPECT_EQ(model.mesh_tolerances()[1].tolerance, 1e-5);
}

TEST(CircularEdges, AHalfOnAWhole) {
  Stack stack;
  geometry::Cylinder half = cylinder(1, 0.5);
  half.sector = {0, kPi};
  stack.add(cylinder(1, 2), {});
  stack.add(half, {{0, 0, 1.25}, turned(90), Vec3(1)});
  const pan::Model model = stack.compiled_to(1e-3);
  const auto whole = at_height(model, 0, 1);
  int met = 0;
  for (const Vec3& p : at_height(model, 1, 1)) {
    if (glm::length(Vec2(p)) < 0.9) continue;  // on the walls that close it
    double nearest = HUGE_VAL;
    for (const Vec3& q : whole) nearest = std::min(nearest, glm::length(p - q));
    EXPECT_LT(nearest, kRounding);
    ++met;
  }
  EXPECT_GT(met, 30);
}

TEST(CircularEdges, CopiesOfOneMeshKeepTheirArea) {
  Stack stack, alone;
  alone.add(cylinder(1, 2), {});
  for (int i = 0; i < 4; ++i) stack.add(cylinder(1, 2), {{0, 0, 2 * i}, kStraight, Vec3(1)});
  const pan::Model model = stack.compiled_to(1e-3);
  EXPECT_EQ(model.meshes().size(), 1u);
  EXPECT_EQ(triangles(model, 0), triangles(alone.compiled_to(1e-3), 0));
  EXPECT_LT(gap(model, 0, 1, 1), kRounding);
}

TEST(CircularEdges, CountsThatAreGivenStay) {
  Stack stack;
  geometry::Cylinder given = cylinder(1, 2);
  given.counts.around = 7;
  stack.add(given, {});
  stack.add(cone(1, 0.3, 0.5), {{0, 0, 1.25}, kStraight, Vec3(1)});
  EXPECT_EQ(triangles(stack.compiled_to(1e-3), 0), 7u * 2 + 2 * 5);
}

TEST(CircularEdges, EveryKindOfCircularEdgeIsSharedWithinTheTolerance) {
  geometry::Sphere dome;
  dome.latitude_min = 0;
  geometry::Dish dish;
  dish.diameter = 2;
  dish.focal_length = 0.5;
  geometry::Lathe vase;
  vase.profile = {{0.4, 0}, {0.7, 0.3}, {1, 0.5}};
  vase.spline = true;
  geometry::Tube pipe;
  pipe.radius = 1;
  pipe.path = {{0, 0, 0}, {0, 0, 3}, {3, 0, 6}};
  geometry::Disc lid;
  const struct {
    geometry::Shape shape;
    scene::Transform where;
  } cases[] = {
      {dome, {{0, 0, 1}, kStraight, Vec3(1)}},   {dish, {{0, 0, 0.5}, kStraight, Vec3(1)}},
      {vase, {{0, 0, 0.5}, kStraight, Vec3(1)}}, {pipe, {{0, 0, 1}, kStraight, Vec3(1)}},
      {lid, {{0, 0, 1}, kStraight, Vec3(1)}},
  };
  for (const auto& c : cases) {
    for (const double tolerance : {3e-2, 1e-3, 1e-5}) {
      Stack stack;
      stack.add(cylinder(1, 2), {});
      stack.add(c.shape, c.where);
      const pan::Model model = stack.compiled_to(tolerance);
      EXPECT_LT(gap(model, 0, 1, 1), 2 * kRounding)
          << geometry::kind_name(c.shape) << " at " << tolerance;
      for (const auto& mesh : model.meshes())
        EXPECT_LE(mesh.error, tolerance) << geometry::kind_name(c.shape) << " at " << tolerance;
    }
  }
}

double seconds_of(Stack& stack) {
  const auto start = std::chrono::steady_clock::now();
  stack.compiled_to(0.05);
  return seconds_since(start);
}

TEST(CircularEdges, TenThousandInstancesStayFast) {
  // a tower of cylinders and cones; all at one place; nearly at one place, one radius after another
  Stack tower, heap, spread;
  for (int i = 0; i < 5000; ++i) {
    tower.add(cylinder(1, 1), {{0, 0, 2 * i}, kStraight, Vec3(1)});
    tower.add(cone(1, 1.5, 1), {{0, 0, 2 * i + 1}, kStraight, Vec3(1)});
    for (int k = 0; k < 2; ++k) {
      heap.add(cylinder(1, 1), {{0, 0, 0}, turned(0.01 * i), Vec3(1)});
      const double size = 1 + 2e-9 * (2 * i + k);
      spread.add(cylinder(1, 1), {{0, 0, 1e-9 * i}, kStraight, Vec3(size)});
    }
  }
  // measured 0.1 s each, with checking; a square of the number would take minutes
  for (Stack* stack : {&tower, &heap, &spread}) EXPECT_LT(seconds_of(*stack), 5);
}

TEST(CircularEdges, BytesDoNotDependOnThreads) {
  Stack stack;
  for (int i = 0; i < 20; ++i) {
    stack.add(cylinder(1 + 0.1 * i, 1), {{0, 0, 2 * i}, kStraight, Vec3(1)});
    stack.add(cone(1 + 0.1 * i, 1.1 + 0.1 * i, 1), {{0, 0, 2 * i + 1}, kStraight, Vec3(1)});
  }
  DiagnosticLog log;
  const auto one = compiled(stack.scene(), {}, log, Job({1, {}}));
  const auto four = compiled(stack.scene(), {}, log, Job({4, {}}));
  EXPECT_EQ(*one, *four);
}

}  // namespace
}  // namespace panwright::compiler::circular_edges_test
