#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::hostile_shapes_test {
namespace {

// Numbers that authors do not write and files may hold, among a few small ones that meet often.
double odd_number(shapes::Random& random) {
  const double odd[] = {0,     -0.0, 1,    -1,    2,      0.5,      1e-9,         1e-30,
                        1e-31, 1e30, 1e31, 1e300, 5e-324, HUGE_VAL, std::nan(""), 1 + 0x1p-52};
  if (random() < 0.2) return odd[static_cast<int>(random() * 16)];
  if (random() < 0.5) return std::floor(random.between(-3, 4));
  return random.between(-2, 2);
}

// Nothing, or a mesh that holds water: never anything else.
bool expect_problem_or_mesh(const Shape& shape, bool texcoords) {
  if (const auto problem = problem_of(shape)) {
    EXPECT_FALSE(problem->message.empty());
    return false;
  }
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = 0.01;
  options.max_triangles = 20000;
  options.texcoords = texcoords;
  const auto mesh = tessellated(shape, options, {}, log);
  EXPECT_EQ(mesh.ok(), !log.contains(Code("E2003")));
  if (!mesh) return false;
  const MeshReport report = check(*mesh);
  EXPECT_EQ(report.bad_indices + report.bad_lengths + report.non_finite + report.bad_normals, 0u);
  EXPECT_TRUE(std::isfinite(mesh->error));
  EXPECT_GT(mesh->triangles.size(), 0u);
  if (is_closed(shape)) {
    // two faces of a cage may lie on each other: their edges are four
    EXPECT_TRUE(std::holds_alternative<Subdiv>(shape) ? mesh->closed : report.closed);
  }
  return true;
}

TEST(HostileShapes, Boxes) {
  shapes::Random random(1);
  int made = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Box box{{odd_number(random), odd_number(random), odd_number(random)},
                  random() < 0.5 ? 0 : odd_number(random),
                  random() < 0.5};
    made += expect_problem_or_mesh(box, random() < 0.5);
  }
  EXPECT_GT(made, 1000);
}

TEST(HostileShapes, Extrusions) {
  shapes::Random random(2);
  int made = 0;
  for (int trial = 0; trial < 30000; ++trial) {
    const auto loop = [&](double size) {
      std::vector<Vec2> points(static_cast<std::size_t>(random() * 7));
      const bool odd = random() < 0.2;
      for (Vec2& p : points)
        p = odd ? Vec2(odd_number(random), odd_number(random))
                : size * Vec2(random.between(-1, 1), random.between(-1, 1));
      return points;
    };
    Extrude shape{loop(2), {}, odd_number(random), odd_number(random)};
    while (random() < 0.3) shape.holes.push_back(loop(0.3));
    made += expect_problem_or_mesh(shape, random() < 0.5);
  }
  EXPECT_GT(made, 500);
}

TEST(HostileShapes, Faces) {
  shapes::Random random(3);
  int made = 0;
  for (int trial = 0; trial < 60000; ++trial) {
    Polygons shape;
    const bool flat = random() < 0.7;
    shape.positions.resize(static_cast<std::size_t>(random() * 9));
    for (Vec3& p : shape.positions) {
      p = {odd_number(random), odd_number(random), odd_number(random)};
      if (flat) p.z = p.x;
    }
    shape.faces.resize(static_cast<std::size_t>(random() * 3));
    for (auto& face : shape.faces) {
      const auto loop = [&] {
        std::vector<std::uint32_t> list(static_cast<std::size_t>(random() * 6));
        for (std::uint32_t& v : list)
          v = static_cast<std::uint32_t>(random() *
                                         (static_cast<double>(shape.positions.size()) + 0.1));
        return list;
      };
      face.outline = loop();
      if (random() < 0.2) face.holes.push_back(loop());
    }
    shape.smooth = random() < 0.5 ? 1 : odd_number(random);
    made += expect_problem_or_mesh(shape, random() < 0.5);
  }
  EXPECT_GT(made, 200);
}

TEST(HostileShapes, Cages) {
  shapes::Random random(5);
  int made = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    Subdiv shape;
    const bool odd = random() < 0.3;
    shape.positions.resize(static_cast<std::size_t>(3 + random() * 6));
    for (Vec3& p : shape.positions)
      p = odd ? Vec3(odd_number(random), odd_number(random), odd_number(random))
              : Vec3(random(), random(), random());
    const auto list = [&](std::size_t least) {
      std::vector<std::uint32_t> out(least + static_cast<std::size_t>(random() * 3));
      for (std::uint32_t& v : out)
        v = static_cast<std::uint32_t>(random() *
                                       (static_cast<double>(shape.positions.size()) + 0.02));
      return out;
    };
    shape.faces.resize(static_cast<std::size_t>(1 + random() * 3));
    for (auto& face : shape.faces) face.outline = list(3);
    if (random() < 0.3) shape.creases.push_back({list(2), 12 * random()});
    if (random() < 0.3) shape.corners.push_back({list(0), 12 * random()});
    shape.smooth_border = random() < 0.5;
    shape.levels = random() < 0.3 ? static_cast<std::uint32_t>(4 * random()) : 0;
    made += expect_problem_or_mesh(shape, random() < 0.5);
  }
  EXPECT_GT(made, 200);
}

TEST(HostileShapes, Tubes) {
  shapes::Random random(4);
  int made = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    Tube tube;
    tube.path.resize(static_cast<std::size_t>(random() * 7));
    const bool odd = random() < 0.3;
    for (Vec3& p : tube.path)
      p = odd ? Vec3(odd_number(random), odd_number(random), odd_number(random))
              : 5.0 * random.direction();
    tube.radius = odd ? odd_number(random) : random.between(0, 0.5);
    if (random() < 0.3) tube.inner_radius = odd ? odd_number(random) : 0.5 * tube.radius;
    tube.spline = random() < 0.5;
    tube.closed = random() < 0.5;
    if (random() < 0.2) tube.counts.around = static_cast<std::uint32_t>(random() * 9);
    if (random() < 0.2) tube.counts.along = static_cast<std::uint32_t>(random() * 30);
    made += expect_problem_or_mesh(tube, random() < 0.5);
    if (const auto problem = problem_of(tube)) continue;
    for (const CircularEdge& edge : circular_edges_of(tube)) {
      EXPECT_NEAR(glm::length(edge.axis), 1, 1e-12);
      EXPECT_TRUE(is_finite(edge.start));
    }
  }
  EXPECT_GT(made, 500);
}

}  // namespace
}  // namespace panwright::geometry::hostile_shapes_test
