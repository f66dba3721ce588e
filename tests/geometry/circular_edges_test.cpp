// CircularEdges, explicit counts, sectors, texture coordinates, and surfaces of revolution at their
// limits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"
#include "tests/support/shape_distance.h"

namespace panwright::geometry::circular_edges_test {
namespace {

Mesh made(const Shape& shape, const TessellationOptions& options) {
  DiagnosticLog log;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok()) << (log.entries().empty() ? "" : log.entries().front().message);
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

Mesh made(const Shape& shape, double max_error, std::uint32_t edge_segments = 0) {
  TessellationOptions options;
  options.max_error = max_error;
  options.edge_segments = edge_segments;
  return made(shape, options);
}

std::size_t vertices_on(const Mesh& mesh, const CircularEdge& edge, std::uint32_t segments) {
  // exactly where geometry/tessellate/tessellate.h says; the sum over one face of the shape
  std::size_t found = 0;
  const double radius = glm::length(edge.start);
  const double begin = std::atan2(edge.start.y, edge.start.x);
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle = begin + edge.sector * i / segments;
    const Vec3 p = edge.centre + radius * Vec3(std::cos(angle), std::sin(angle), 0);
    for (const Vec3& q : mesh.positions)
      if (glm::length(p - q) <= 2e-15 * radius) {
        ++found;
        break;
      }
  }
  return found;
}

bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// the vertices of a mesh at a height, the first of each place
std::vector<Vec3> at_height(const Mesh& mesh, double z, double radius) {
  std::vector<Vec3> result;
  for (const Vec3& p : mesh.positions)
    if (p.z == z && std::fabs(std::hypot(p.x, p.y) - radius) < 1e-12 &&
        std::find(result.begin(), result.end(), p) == result.end())
      result.push_back(p);
  return result;
}

TEST(CircularEdges, AreEqualBitForBitBetweenShapes) {
  // all with a circular edge of radius 0.7 at z = 0.25
  const double radius = 0.7;
  Lathe lathe;
  lathe.profile = {{0.2, -1}, {0.5, -0.5}, {radius, 0.25}};
  Lathe smooth = lathe;
  smooth.spline = true;
  const std::vector<Shape> shapes = {Cylinder{radius, 0.5}, Cylinder{radius, 0.5, Caps::none},
                                     Cone{radius, 0, 0.5, Caps::none}, Cone{0.3, radius, 0.5},
                                     lathe, smooth,
                                     // 4f = r²/z
                                     Dish{2 * radius, radius * radius, 0.01}};
  for (const std::uint32_t segments : {3u, 7u, 12u, 90u}) {
    std::vector<Vec3> first;
    for (const Shape& shape : shapes) {
      const Mesh mesh = made(shape, 1e-2, segments);
      const bool down =
          std::holds_alternative<Cone>(shape) && std::get<Cone>(shape).top_radius == 0;
      std::vector<Vec3> edge = at_height(mesh, down ? -0.25 : 0.25, radius);
      ASSERT_EQ(edge.size(), segments) << kind_name(shape);
      for (Vec3& p : edge) p.z = 0.25;
      if (first.empty()) first = edge;
      for (const Vec3& p : edge)
        EXPECT_EQ(std::count_if(first.begin(), first.end(),
                                [&](const Vec3& q) { return same_bits(p, q); }),
                  1)
            << kind_name(shape);
    }
  }
}

TEST(CircularEdges, LieOnTheShapeAtEqualAngles) {
  Lathe lathe;
  lathe.profile = {{1, 0}, {0.5, 1}, {0.8, 2}};
  lathe.spline = true;
  const Sector part{0.4, 2.2};
  const std::vector<Shape> shapes = {Cylinder{1, 2, Caps::both, part},
                                     Cone{1, 0.5, 2, Caps::none, part},
                                     Disc{1, 0.5},
                                     Dish{1, 0.3},
                                     Dish{1, 0.3, 0.05},
                                     lathe,
                                     Sphere{1, {}, -0.4, 1.2, part},
                                     Sphere{1, {}, -kPi / 2, 0.3, {}}};
  for (const Shape& shape : shapes) {
    const std::vector<CircularEdge> circular_edges = circular_edges_of(shape);
    EXPECT_FALSE(circular_edges.empty());
    const Mesh mesh = made(shape, 0.02, 23);
    for (const CircularEdge& edge : circular_edges)
      EXPECT_EQ(vertices_on(mesh, edge, 23), 23u) << kind_name(shape);
  }
  EXPECT_TRUE(circular_edges_of(Sphere{}).empty());
  EXPECT_TRUE(circular_edges_of(Torus{}).empty());
  EXPECT_TRUE(circular_edges_of(Cylinder{1, 1, Caps::both, {}, {8, 0}}).empty());
  EXPECT_EQ(circular_edges_of(Cone{1, 0, 1}).size(), 1u);
  EXPECT_EQ(circular_edges_of(Disc{1}).size(), 1u);
}

TEST(CircularEdges, SegmentsOfKeepTheError) {
  Lathe lathe;
  lathe.profile = {{1, 0}, {0.5, 1}, {0.8, 2}};
  lathe.spline = true;
  for (const Shape& shape :
       {Shape(Cylinder{1, 2}), Shape(Cone{0.5, 1, 2}), Shape(Disc{1, 0.5}), Shape(Dish{2, 0.3}),
        Shape(Dish{1, 0.3, 0.05}), Shape(lathe), Shape(Sphere{1, {}, -0.4, 1.2, {}})}) {
    for (const double e : {0.3, 0.1, 1e-2, 1e-3, 1e-4}) {
      SCOPED_TRACE(std::string(kind_name(shape)) + " " + std::to_string(e));
      TessellationOptions options;
      options.max_error = e;
      options.edge_segments = segments_of(shape, options);
      EXPECT_LE(made(shape, options).error, e);
      // and a neighbour may ask for more
      options.edge_segments = options.edge_segments * 3 / 2 + 1;
      EXPECT_LE(made(shape, options).error, e);
    }
  }
}

TEST(Counts, AreObeyedWithVerticesOnTheShape) {
  Lathe spline;
  spline.profile = {{0, -1}, {1, -0.7}, {0.6, 0}, {0.8, 0.9}, {0, 1.5}};
  spline.spline = true;
  spline.counts = {9, 14};
  struct Expected {
    Shape shape;
    oracles::Distance distance;
    std::size_t triangles;
  };
  const auto with = [](const auto& s, std::size_t triangles) {
    return Expected{s, oracles::distance_to(s), triangles};
  };
  for (const Expected& one :
       {with(Cylinder{1, 2, Caps::both, {}, {12, 0}}, 4 * 12 - 4),
        with(Cylinder{1, 2, Caps::none, {}, {3, 0}}, 6),
        with(Cone{1, 0, 2, Caps::both, {}, {5, 0}}, 8), with(Disc{1, 0, {}, {6, 0}}, 4),
        with(Disc{1, 0.5, {}, {6, 0}}, 12), with(Torus{1, 0.3, {}, {16, 8}}, 2 * 16 * 8),
        with(Dish{1, 0.4, 0, {10, 4}}, 10 * 7), with(Dish{1, 0.4, 0.1, {10, 1}}, 10 * 4),
        with(Ellipsoid{{3, 2, 1}, {7, 5}}, 2 * 7 * 4),
        with(Sphere{2, SphereCounts{4, 6}, -0.5, 1.0, {}}, 48), with(spline, 9 * 2 * 13)}) {
    SCOPED_TRACE(std::string(kind_name(one.shape)));
    const Mesh mesh = made(one.shape, 1e-3);
    EXPECT_EQ(mesh.triangles.size(), one.triangles);
    EXPECT_EQ(planned_triangles(one.shape, {}), static_cast<double>(one.triangles));
    // note: 2e-7 of a polyline that stands for the spline; 4.4e-16 measured for the others
    for (const Vec3& p : mesh.positions)
      EXPECT_LE(one.distance(p), one.triangles == 234 ? 2e-7 : 2e-15);
    // the error is that of the coarse mesh, whatever was asked for
    EXPECT_LE(oracles::sampled_distance(mesh, one.distance, 16).worst, mesh.error + 2e-7);
  }
}

TEST(Counts, HalfGivenLeavesTheOtherToTheError) {
  const Mesh around = made(Torus{1, 0.3, {}, {400, 0}}, 1e-3);
  EXPECT_LE(around.error, 1e-3);
  EXPECT_EQ(around.triangles.size() % 800, 0u);
  const Mesh along = made(Torus{1, 0.3, {}, {0, 60}}, 1e-3);
  EXPECT_EQ(along.triangles.size() % 120, 0u);
  EXPECT_LE(along.error, 1e-3);
  const Mesh ball = made(Ellipsoid{{1, 1, 1}, {0, 100}}, 1e-3);
  EXPECT_EQ(ball.triangles.size() % 198, 0u);
  EXPECT_LE(ball.error, 1e-3);
}

TEST(Vertices, AreNotRepeatedWithoutNeed) {
  // poles are one vertex, edges two, seams none
  EXPECT_EQ(made(Ellipsoid{{1, 1, 1}, {8, 4}}, 1).positions.size(), 2u + 8 * 3);
  EXPECT_EQ(made(Torus{1, 0.3, {}, {8, 5}}, 1).positions.size(), 40u);
  EXPECT_EQ(made(Cylinder{1, 1, Caps::both, {}, {8, 0}}, 1).positions.size(), 32u);
  EXPECT_EQ(made(Dish{1, 1, 0, {8, 3}}, 1).positions.size(), 25u);
  EXPECT_EQ(made(Disc{1, 0, {}, {8, 0}}, 1).positions.size(), 8u);
  // the tip of a cone has a normal for each side
  EXPECT_EQ(made(Cone{1, 0, 1, Caps::none, {}, {8, 0}}, 1).positions.size(), 16u);
  // straight points of a profile are no edges
  Lathe straight;
  straight.profile = {{1, 0}, {1, 0.25}, {1, 1}, {0.5, 1}};
  straight.counts = {8, 0};
  EXPECT_EQ(made(straight, 1).positions.size(), 32u);
  TessellationOptions texture;
  texture.texcoords = true;
  EXPECT_EQ(made(Torus{1, 0.3, {}, {8, 5}}, texture).positions.size(), 9u * 6);
  EXPECT_EQ(made(Dish{1, 1, 0, {8, 3}}, texture).positions.size(), 25u);
}

TEST(Sectors, AreCutWhereTheyBeginAndEnd) {
  for (const Sector& sector :
       {Sector{0, kPi / 2}, Sector{-1, 2}, Sector{kPi / 2, 2 * kPi}, Sector{5, 9}}) {
    const double span = sector.end - sector.begin;
    SCOPED_TRACE(span);
    const MeshReport wedge = check(made(Cylinder{2, 3, Caps::both, sector}, 1e-3));
    EXPECT_TRUE(wedge.closed);
    EXPECT_EQ(wedge.degenerate_triangles, 0u);
    EXPECT_NEAR(wedge.volume, span / 2 * 4 * 3, 1e-13);
    const MeshReport tip = check(made(Cone{2, 0, 3, Caps::both, sector}, 1e-3));
    EXPECT_TRUE(tip.closed);
    EXPECT_NEAR(tip.volume, span / 2 * 4, 1e-13);
    const Mesh pipe = made(Torus{2, 0.5, sector}, 1e-3);
    EXPECT_FALSE(check(pipe).closed);
    // Pappus; areas are of the first order in the error
    EXPECT_NEAR(check(pipe).area, span * 2 * kPi, 4e-3 * span);
    const Mesh zone = made(Sphere{1, {}, -0.3, 0.8, sector}, 1e-3);
    EXPECT_NEAR(check(zone).area, span * (std::sin(0.8) + std::sin(0.3)), 4e-3 * span);
    for (const Mesh* mesh : {&pipe, &zone})
      for (const Vec3& p : mesh->positions) {
        const double turn = std::remainder(std::atan2(p.y, p.x) - sector.begin - span / 2, 2 * kPi);
        EXPECT_LE(std::fabs(turn), span / 2 + 1e-12);
      }
  }
  // exact at quarter turns: a wall in the plane x = 0 has no x
  const Mesh quarter = made(Cylinder{1, 1, Caps::both, {0, kPi / 2}}, 1e-2);
  EXPECT_EQ(quarter.positions.back().x, 0);
  EXPECT_EQ(quarter.normals.back(), Vec3(-1, 0, 0));
}

TEST(Texcoords, FollowTheParameters) {
  TessellationOptions options;
  options.max_error = 0.02;
  options.texcoords = true;
  const Mesh torus = made(Torus{2, 0.5}, options);
  for (std::size_t i = 0; i < torus.positions.size(); ++i) {
    const Vec3& p = torus.positions[i];
    const double u = std::atan2(p.y, p.x) / (2 * M_PI);
    EXPECT_NEAR(std::remainder(torus.texcoords[i].x - u, 1.0), 0, 1e-12);
    // from the normal, as vertices stand off the tube
    const Vec3& n = torus.normals[i];
    const double v = std::atan2(n.z, (n.x * p.x + n.y * p.y) / std::hypot(p.x, p.y)) / (2 * M_PI);
    EXPECT_NEAR(std::remainder(torus.texcoords[i].y - v, 1.0), 0, 0.005);
  }
  const Mesh cylinder = made(Cylinder{1, 2, Caps::both}, options);
  for (std::size_t i = 0; i < cylinder.positions.size(); ++i) {
    const Vec3& p = cylinder.positions[i];
    const Vec2& uv = cylinder.texcoords[i];
    const double radius = std::hypot(p.x, p.y);
    if (cylinder.normals[i].z == 0) {
      EXPECT_NEAR(std::remainder(uv.x - std::atan2(p.y, p.x) / (2 * M_PI), 1.0), 0, 1e-12);
      EXPECT_EQ(uv.y, p.z / 2 + 0.5);
    } else {
      EXPECT_NEAR(uv.x, 0.5 + 0.5 * cylinder.normals[i].z * p.x / radius, 1e-12);
      EXPECT_NEAR(uv.y, 0.5 + 0.5 * p.y / radius, 1e-12);
    }
  }
  const Mesh dish = made(Dish{2, 0.5, 0.1}, options);
  for (std::size_t i = 0; i < dish.positions.size(); ++i) {
    const Vec3& p = dish.positions[i];
    const double side = dish.normals[i].z < 0 ? -1 : 1;
    // 0.012: vertices stand off by their balance and the circular edge by its area
    EXPECT_NEAR(dish.texcoords[i].x, 0.5 + 0.5 * side * p.x, 0.012);
    EXPECT_NEAR(dish.texcoords[i].y, 0.5 + 0.5 * p.y, 0.012);
  }
}

// No texture is mirrored seen from outside: texture triangles turn the same way as their own.
TEST(Texcoords, AreNotMirrored) {
  TessellationOptions options;
  options.max_error = 0.02;
  options.texcoords = true;
  for (const Shape& shape :
       {Shape(Torus{2, 0.5}), Shape(Cylinder{1, 2}), Shape(Cylinder{1, 2, Caps::both, {0.2, 2}}),
        Shape(Cone{1, 0.5, 1}), Shape(Disc{1, 0.2}), Shape(Dish{1, 0.5}),
        Shape(Ellipsoid{{1, 2, 3}}), Shape(Sphere{1, {}, -1, 1, {}})}) {
    const Mesh mesh = made(shape, options);
    for (const Triangle& t : mesh.triangles) {
      const Vec2 a = mesh.texcoords[t[1]] - mesh.texcoords[t[0]];
      const Vec2 b = mesh.texcoords[t[2]] - mesh.texcoords[t[0]];
      EXPECT_GT(a.x * b.y - a.y * b.x, 0) << kind_name(shape);
    }
  }
}

std::optional<Code> problem_code(const Shape& shape) {
  const auto problem = problem_of(shape);
  return problem ? std::optional(problem->code) : std::nullopt;
}

TEST(Problems, AreFoundAndNamed) {
  const double nan = std::nan(""), inf = HUGE_VAL;
  for (const double bad : {nan, inf, -inf, 1e31, 1e300, 1e-31, 5e-324}) {
    const Code code = bad < 0 ? Code("E2011") : Code("E2010");
    EXPECT_EQ(problem_code(Cylinder{bad, 1}), code) << bad;
    EXPECT_EQ(problem_code(Cylinder{1, bad}), code) << bad;
    EXPECT_EQ(problem_code(Cone{bad, 1, 1}), code);
    EXPECT_EQ(problem_code(Disc{1, bad > 1 ? nan : bad}), bad < 0 ? Code("E2011") : Code("E2010"));
    EXPECT_EQ(problem_code(Ellipsoid{{1, bad, 1}}), code);
    EXPECT_EQ(problem_code(Torus{bad, 0.1}), code);
    EXPECT_EQ(problem_code(Dish{bad, 1}), code);
    EXPECT_EQ(problem_code(Dish{1, 1, bad}), code);
    EXPECT_EQ(problem_code(Sphere{bad, {}}), code);
  }
  for (const double none : {0.0, -1.0}) {
    EXPECT_EQ(problem_code(Cylinder{none, 1}), Code("E2011"));
    EXPECT_EQ(problem_code(Dish{1, none}), Code("E2011"));
    EXPECT_EQ(problem_code(Ellipsoid{{none, 1, 1}}), Code("E2011"));
  }
  EXPECT_EQ(problem_code(Cone{0, 0, 1}), Code("E2011"));
  EXPECT_EQ(problem_code(Disc{1, 1}), Code("E2011"));
  EXPECT_EQ(problem_code(Torus{1, 1}), Code("E2011"));
  EXPECT_EQ(problem_code(Dish{1e20, 1}), Code("E2010"));
  for (const Sector& s : {Sector{1, 1}, Sector{2, 1}, Sector{0, 7}, Sector{nan, 1}, Sector{0, inf},
                          Sector{1e300, 1e301}}) {
    EXPECT_EQ(problem_code(Cylinder{1, 1, Caps::both, s}), Code("E2017"));
    EXPECT_EQ(problem_code(Torus{1, 0.1, s}), Code("E2017"));
    EXPECT_EQ(problem_code(Sphere{1, {}, -1, 1, s}), Code("E2017"));
  }
  EXPECT_EQ(problem_code(Sphere{1, {}, 1, 1, {}}), Code("E2017"));
  EXPECT_EQ(problem_code(Sphere{1, {}, -2, 1, {}}), Code("E2017"));
  EXPECT_EQ(problem_code(Sphere{1, {}, nan, 1, {}}), Code("E2017"));
  EXPECT_EQ(problem_code(Sphere{1, SphereCounts{1, 8}}), Code("E2018"));
  EXPECT_EQ(problem_code(Cylinder{1, 1, Caps::both, {}, {2, 0}}), Code("E2018"));
  EXPECT_EQ(problem_code(Cylinder{1, 1, Caps::both, {0, 1}, {1, 0}}), std::nullopt);
  EXPECT_EQ(problem_code(Ellipsoid{{1, 1, 1}, {8, 1}}), Code("E2018"));
  EXPECT_EQ(problem_code(Torus{1, 0.1, {}, {8, 2}}), Code("E2018"));
}

TEST(Problems, OfProfiles) {
  const auto code = [](std::vector<Vec2> points, bool spline) {
    Lathe s;
    s.profile = std::move(points);
    s.spline = spline;
    return problem_code(s);
  };
  for (const bool spline : {false, true}) {
    EXPECT_EQ(code({}, spline), Code("E2015"));
    EXPECT_EQ(code({{1, 0}}, spline), Code("E2015"));
    EXPECT_EQ(code({{1, 0}, {1, 0}}, spline), Code("E2015"));
    EXPECT_EQ(code({{1, 0}, {1, 1}, {1, 1 + 1e-12}}, spline), Code("E2015"));
    EXPECT_EQ(code({{0, 0}, {0, 1}}, spline), Code("E2011"));
    EXPECT_EQ(code({{1, 0}, {-1e-9, 1}}, spline), Code("E2011"));
    EXPECT_EQ(code({{1, 0}, {std::nan(""), 1}}, spline), Code("E2010"));
    EXPECT_EQ(code({{1, 0}, {1, 1e300}}, spline), Code("E2010"));
    EXPECT_EQ(code({{1, 0}, {1, 1}}, spline), std::nullopt);
    EXPECT_EQ(code({{0, 0}, {1, 1}, {0, 2}, {1, 3}, {0, 4}}, spline), std::nullopt);
  }
  // dips across the axis between two points
  EXPECT_EQ(code({{2, 0}, {0.01, 1}, {0.01, 1.1}, {2, 2.1}}, true), Code("E2011"));
  EXPECT_EQ(code({{2, 0}, {0.01, 1}, {0.01, 1.1}, {2, 2.1}}, false), std::nullopt);
  EXPECT_EQ(code({{1, 0}, {2, 0}, {1, 0}}, true), Code("E2015"));
}

TEST(Limits, HoldBeforeAnythingIsAllocated) {
  Lathe lathe;
  lathe.profile = {{0, 0}, {1, 1}, {0, 2}};
  lathe.spline = true;
  const std::uint32_t many = 4294967295u;
  const std::vector<Shape> counted = {Cylinder{1, 1, Caps::both, {}, {many, 0}},
                                      Torus{1, 0.1, {}, {many, many}},
                                      Torus{1, 0.1, {}, {100000, 100000}},
                                      Dish{1, 1, 0, {many, 1}},
                                      Dish{1, 1, 0, {3, many}},
                                      Ellipsoid{{1, 1, 1}, {many, many}},
                                      Ellipsoid{{1, 1, 1}, {3, many}},
                                      Sphere{1, SphereCounts{many, many}, -1, 1, {}}};
  for (const Shape& shape : counted) {
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(shape, {}, {}, log).ok()) << kind_name(shape);
    EXPECT_TRUE(log.contains(Code("E2003")));
  }
  for (const Shape& shape :
       {Shape(Cylinder{1, 1}), Shape(Torus{1, 0.1}), Shape(Dish{1, 1}), Shape(lathe),
        Shape(Ellipsoid{{1, 2, 3}}), Shape(Sphere{1, {}, -1, 1, {}}), Shape(Disc{1})}) {
    for (const double impossible : {1e-8, 1e-15, 1e-300}) {
      DiagnosticLog log;
      TessellationOptions options;
      options.max_error = impossible;
      EXPECT_FALSE(tessellated(shape, options, {}, log).ok());
      EXPECT_TRUE(log.contains(Code("E2003")));
      EXPECT_GT(planned_triangles(shape, options), 1e6);
    }
    TessellationOptions options;
    options.max_error = 1e-4;
    options.max_triangles = static_cast<std::uint64_t>(planned_triangles(shape, options)) - 1;
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(shape, options, {}, log).ok());
    EXPECT_TRUE(log.contains(Code("E2003")));
    ++options.max_triangles;
    EXPECT_TRUE(tessellated(shape, options, {}, log).ok());
  }
}

}  // namespace
}  // namespace panwright::geometry::circular_edges_test
