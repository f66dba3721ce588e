#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "geometry/mesh/strip.h"
#include "outlines.h"

namespace panwright::geometry::flat_shapes_test {
namespace {

Mesh made(const Shape& shape, const TessellationOptions& options = {}) {
  const auto problem = problem_of(shape);
  EXPECT_FALSE(problem) << problem->message;
  DiagnosticLog log;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok());
  return mesh.ok() ? *mesh : Mesh{};
}

Mesh textured(const Shape& shape) { return made(shape, {.texcoords = true}); }

void expect_sound(const Mesh& mesh, bool closed) {
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.closed, closed);
  EXPECT_EQ(mesh.closed, closed);
  EXPECT_EQ(report.degenerate_triangles, 0u);
  EXPECT_EQ(report.bad_indices + report.bad_lengths + report.bad_normals + report.non_finite, 0u);
  EXPECT_EQ(report.misoriented_edges + report.non_manifold_edges, 0u);
}

// Every normal belongs to the facets at its vertex.
void expect_flat_normals(const Mesh& mesh) {
  for (const Triangle& t : mesh.triangles) {
    const Vec3 facet = glm::normalize(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                                 mesh.positions[t[2]] - mesh.positions[t[0]]));
    for (const std::uint32_t v : t) EXPECT_LT(glm::length(facet - mesh.normals[v]), 1e-12);
  }
}

std::string code(const Shape& shape) {
  const auto problem = problem_of(shape);
  return problem ? std::string(code_info(problem->code).name) : "";
}

// ---- boxes

TEST(Box, Sharp) {
  const Mesh mesh = made(Box{.size = {2, 3, 4}});
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.positions.size(), 24u);
  EXPECT_EQ(mesh.error, 0);
  expect_sound(mesh, true);
  expect_flat_normals(mesh);
  EXPECT_DOUBLE_EQ(check(mesh).volume, 24);
  EXPECT_DOUBLE_EQ(check(mesh).area, 52);
  // 0.1 is no float
  EXPECT_NEAR(made(Box{.size = Vec3(0.2)}).error,
              std::sqrt(3.0) * std::fabs(0.1 - static_cast<double>(0.1f)), 1e-22);
}

TEST(Box, FlatBevel) {
  for (const double b : {0.01, 0.3, 0.999, 1.0}) {
    const Box box{.size = {2, 3, 4}, .bevel = b};
    const Mesh mesh = made(box);
    expect_sound(mesh, true);
    expect_flat_normals(mesh);
    // From the block less a prism of b²/2 along each edge, plus what those prisms share in corners:
    // of the corner cube b³ the bevel keeps 5/6 of what three flat cuts would leave; counted below
    // by parts.
    const Vec3 in = box.size - 2 * b;
    const double parts = in.x * in.y * in.z +                                 // core
                         2 * b * (in.x * in.y + in.y * in.z + in.z * in.x) +  // slabs
                         4 * (b * b / 2) * (in.x + in.y + in.z) +             // edges
                         8 * b * b * b / 6;                                   // corners
    EXPECT_NEAR(check(mesh).volume, parts, 1e-13);
    EXPECT_EQ(static_cast<double>(mesh.triangles.size()), planned_triangles(box, {}));
    EXPECT_EQ(mesh.triangles.size(), b < 1 ? 44u : 44u - 2 * 4 - 4 * 2);
  }
  // a cube without faces is an octahedron
  const Mesh octahedron = made(Box{.size = Vec3(2), .bevel = 1});
  EXPECT_EQ(octahedron.triangles.size(), 8u);
  EXPECT_NEAR(check(octahedron).volume, 4.0 / 3, 1e-15);
}

// The distance from the surface of a rounded box, from its definition.
double rounded_distance(const Box& box, const Vec3& p) {
  const Vec3 inner = 0.5 * box.size - box.bevel;
  const Vec3 q = glm::abs(p) - inner;
  const double outside = glm::length(glm::max(q, Vec3(0)));
  return outside + std::min(0.0, std::max({q.x, q.y, q.z})) - box.bevel;
}

double sampled_error(const Mesh& mesh, const Box& box, int steps) {
  double worst = 0;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
        const Vec3 p = (1 - u - v) * mesh.positions[t[0]] + u * mesh.positions[t[1]] +
                       v * mesh.positions[t[2]];
        worst = std::max(worst, std::fabs(rounded_distance(box, p)));
      }
  return worst;
}

TEST(Box, RoundErrorIsKeptAndNotWasted) {
  for (const Box& box : {Box{.size = {2, 3, 4}, .bevel = 0.5, .round = true},
                         Box{.size = {2, 3, 4}, .bevel = 1, .round = true},
                         Box{.size = {2, 2, 3}, .bevel = 1, .round = true},
                         Box{.size = {1, 1, 10}, .bevel = 0.1, .round = true}}) {
    for (const double relative : {0.5, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5}) {
      const double requested = relative * box.bevel;
      if (relative < 1e-4 && box.size.z != 3) continue;
      const Mesh mesh = made(box, {.max_error = requested});
      expect_sound(mesh, true);
      EXPECT_LE(mesh.error, requested);
      EXPECT_EQ(static_cast<double>(mesh.triangles.size()),
                planned_triangles(box, {.max_error = requested}));
      const double sampled = sampled_error(mesh, box, mesh.triangles.size() > 10000 ? 6 : 24);
      EXPECT_LE(sampled, requested);
      EXPECT_LE(sampled, mesh.error * (1 + 1e-9));
      // few steps come in large steps of error: from 2 to 3 it halves
      if (relative <= 3e-3) {
        EXPECT_GE(sampled, 0.85 * requested) << relative;
      } else if (relative <= 0.03) {
        EXPECT_GE(sampled, 0.5 * requested) << relative;
      }
    }
  }
}

TEST(Box, RoundVolumeByMinkowski) {
  const Box box{.size = {2, 3, 4}, .bevel = 0.4, .round = true};
  const Vec3 in = box.size - 0.8;
  const double b = 0.4;
  // Steiner: core + area·b + edges·π b²/4·… + ball
  const double exact = in.x * in.y * in.z + 2 * b * (in.x * in.y + in.y * in.z + in.z * in.x) +
                       M_PI * b * b * (in.x + in.y + in.z) + 4 * M_PI / 3 * b * b * b;
  for (const double error : {1e-2, 1e-3, 1e-4}) {
    const MeshReport report = check(made(box, {.max_error = error}));
    // the bent part of the surface, off by a third of the error on average
    EXPECT_NEAR(report.volume, exact, 12 * error) << error;
    EXPECT_GT(std::fabs(report.volume - exact), 1e-9);
  }
}

TEST(Box, RoundTrianglesNearTheClosedForm) {
  // A corner's eighth of a sphere needs at least its area over that of the largest equilateral
  // triangle whose middle dips by twice the error: (π/2)/(3√3/4·4·ε)
  for (const double relative : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const double planned =
        planned_triangles(Box{.size = Vec3(2), .bevel = 1, .round = true}, {.max_error = relative});
    const double least = 8 * (M_PI / 2) / (3 * std::sqrt(3.0) * relative);
    // equal sines: 4/3 in the middle, 1.37 measured; and whole steps
    const double steps = std::sqrt(1.38 * least / 8) + 1;
    EXPECT_LE(planned, 8 * steps * steps) << relative;
    EXPECT_GE(planned, least);
  }
}

TEST(Box, RoundFacesStayWhereTheyAreAndNormalsAreSmooth) {
  const Box box{.size = {2, 3, 4}, .bevel = 0.5, .round = true};
  const Mesh mesh = made(box, {.max_error = 0.01});
  Vec3 low(1e9), high(-1e9);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    low = glm::min(low, mesh.positions[i]);
    high = glm::max(high, mesh.positions[i]);
    const Vec3 core = glm::clamp(mesh.positions[i], -(0.5 * box.size - 0.5), 0.5 * box.size - 0.5);
    // 2e-16 measured
    EXPECT_LT(glm::length(glm::normalize(mesh.positions[i] - core) - mesh.normals[i]), 1e-14);
  }
  EXPECT_EQ(low, Vec3(-1, -1.5, -2));
  EXPECT_EQ(high, Vec3(1, 1.5, 2));
  // each place is one vertex
  std::map<std::tuple<double, double, double>, int> places;
  for (const Vec3& p : mesh.positions) EXPECT_EQ(++places[std::make_tuple(p.x, p.y, p.z)], 1);
  const Mesh ball = made(Box{.size = Vec3(2), .bevel = 1, .round = true}, {.max_error = 0.01});
  expect_sound(ball, true);
  places.clear();
  for (const Vec3& p : ball.positions)
    EXPECT_EQ(++places[std::make_tuple(p.x + 0.0, p.y + 0.0, p.z + 0.0)], 1);
}

TEST(Box, TexturesStandUprightOnEachFace) {
  // seen from outside: u to the right, v up; +z up for the sides, +y for the ends
  const std::pair<Vec3, std::pair<Vec3, Vec3>> faces[] = {
      {{1, 0, 0}, {{0, 1, 0}, {0, 0, 1}}},  {{-1, 0, 0}, {{0, -1, 0}, {0, 0, 1}}},
      {{0, 1, 0}, {{-1, 0, 0}, {0, 0, 1}}}, {{0, -1, 0}, {{1, 0, 0}, {0, 0, 1}}},
      {{0, 0, 1}, {{1, 0, 0}, {0, 1, 0}}},  {{0, 0, -1}, {{-1, 0, 0}, {0, 1, 0}}}};
  for (const Box& box : {Box{.size = {2, 3, 4}}, Box{.size = {2, 3, 4}, .bevel = 0.2},
                         Box{.size = {2, 3, 4}, .bevel = 0.2, .round = true}}) {
    const Mesh mesh = made(box, {.max_error = 0.01, .texcoords = true});
    expect_sound(mesh, true);
    for (const auto& [normal, axes] : faces) {
      int found = 0;
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (glm::dot(mesh.normals[i], normal) < 1 - 1e-12) continue;
        const Vec2 expected(0.5 + glm::dot(mesh.positions[i], axes.first) /
                                      std::fabs(glm::dot(box.size, axes.first)),
                            0.5 + glm::dot(mesh.positions[i], axes.second) /
                                      std::fabs(glm::dot(box.size, axes.second)));
        // a bevel's edge has the normal of a face, and may continue another
        found += glm::length(expected - mesh.texcoords[i]) < 1e-12;
      }
      EXPECT_GE(found, 4);
    }
    for (const Vec2& uv : mesh.texcoords) {
      EXPECT_GE(std::min(uv.x, uv.y), -0.01);
      EXPECT_LE(std::max(uv.x, uv.y), 1.01);
    }
  }
}

TEST(Box, ProblemsAndLimits) {
  EXPECT_EQ(code(Box{.size = {1, 1, 0}}), "E2011");
  EXPECT_EQ(code(Box{.size = {1, -1, 1}}), "E2011");
  EXPECT_EQ(code(Box{.size = {1, NAN, 1}}), "E2010");
  EXPECT_EQ(code(Box{.size = {1, 1e300, 1}}), "E2010");
  EXPECT_EQ(code(Box{.size = {1, 1e-31, 1}}), "E2010");
  EXPECT_EQ(code(Box{.bevel = 0.51}), "E2011");
  EXPECT_EQ(code(Box{.bevel = -0.1}), "E2011");
  EXPECT_EQ(code(Box{.bevel = NAN}), "E2010");
  EXPECT_EQ(code(Box{.bevel = 0.5, .round = true}), "");
  EXPECT_EQ(code(Box{.size = Vec3(1e-30)}), "");
  for (const double size : {1e-28, 1e30})
    expect_sound(made(Box{.size = Vec3(size), .bevel = 0.1 * size}), true);
  for (const double error : {1e-12, 1e-300}) {
    DiagnosticLog log;
    EXPECT_FALSE(tessellated(Box{.bevel = 0.1, .round = true}, {.max_error = error}, {}, log).ok());
    EXPECT_TRUE(log.contains(Code("E2003")));
  }
  DiagnosticLog log;
  EXPECT_FALSE(tessellated(Box{}, {.max_triangles = 11}, {}, log).ok());
  EXPECT_FALSE(tessellated(Plane{}, {.max_triangles = 1}, {}, log).ok());
}

TEST(Plane, IsTwoTriangles) {
  const Mesh mesh = textured(Plane{.width = 2, .height = 3});
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(check(mesh).area, 6);
  expect_sound(mesh, false);
  expect_flat_normals(mesh);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.texcoords[i].x, mesh.positions[i].x / 2 + 0.5);
    EXPECT_EQ(mesh.texcoords[i].y, mesh.positions[i].y / 3 + 0.5);
  }
  EXPECT_EQ(code(Plane{.width = 0}), "E2011");
  EXPECT_EQ(code(Plane{.height = HUGE_VAL}), "E2010");
}

// ---- extrusions

Extrude extrusion(const shapes::Outline& outline, double height = 1) {
  Extrude shape;
  shape.height = height;
  for (std::size_t l = 0; l + 1 < outline.loops.size(); ++l) {
    const std::vector<Vec2> loop(outline.points.begin() + outline.loops[l],
                                 outline.points.begin() + outline.loops[l + 1]);
    l == 0 ? shape.outline = loop : shape.holes.emplace_back(loop);
  }
  return shape;
}

TEST(Extrude, VolumeIsAreaTimesHeight) {
  shapes::Outline plate = shapes::outline(shapes::star(200, 7, 0.5));
  plate.add(shapes::circle(40, 0.2));
  for (const auto& outline : {plate, shapes::sieve(6), shapes::outline(shapes::comb(9)),
                              shapes::outline(shapes::spiral(90, 3))}) {
    for (const Caps caps : {Caps::both, Caps::none, Caps::top, Caps::bottom}) {
      Extrude shape = extrusion(outline, 0.7);
      shape.caps = caps;
      const Mesh mesh = made(shape);
      EXPECT_EQ(static_cast<double>(mesh.triangles.size()), planned_triangles(shape, {}));
      const MeshReport report = check(mesh);
      EXPECT_EQ(report.closed, caps == Caps::both);
      EXPECT_EQ(report.misoriented_edges + report.non_manifold_edges, 0u);
      if (caps != Caps::both) continue;
      const double expected = 0.7 * shapes::area(outline);
      EXPECT_NEAR(report.volume, expected, 1e-12 * expected);
      double walls = 0;
      for (std::size_t l = 0; l + 1 < outline.loops.size(); ++l)
        for (std::uint32_t i = outline.loops[l]; i < outline.loops[l + 1]; ++i)
          walls +=
              0.7 *
              glm::length(outline.points[i + 1 < outline.loops[l + 1] ? i + 1 : outline.loops[l]] -
                          outline.points[i]);
      EXPECT_NEAR(report.area, walls + 2 * expected / 0.7, 1e-12 * report.area);
    }
  }
}

TEST(Extrude, AnyWindingMakesTheSameSolid) {
  shapes::Outline plate = shapes::outline({{0, 0}, {4, 0}, {4, 3}, {0, 3}});
  plate.add({{1, 1}, {2, 1}, {2, 2}, {1, 2}});
  for (int k = 0; k < 4; ++k) {
    Extrude shape = extrusion(plate, 2);
    if (k & 1) std::reverse(shape.outline.begin(), shape.outline.end());
    if (k & 2) std::reverse(shape.holes[0].begin(), shape.holes[0].end());
    const Mesh mesh = made(shape);
    expect_sound(mesh, true);
    expect_flat_normals(mesh);
    EXPECT_DOUBLE_EQ(check(mesh).volume, 22);
    EXPECT_EQ(mesh.error, 0);
  }
}

TEST(Extrude, WallsShareNormalsBelowTheAngle) {
  Extrude shape = extrusion(shapes::outline(shapes::circle(36, 1)));
  shape.smooth = 11 * kDegree;  // the walls meet at 10
  for (const bool texcoords : {false, true}) {
    const Mesh mesh = made(shape, {.texcoords = texcoords});
    expect_sound(mesh, true);
    std::size_t walls = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      if (mesh.normals[i].z != 0) continue;
      ++walls;
      const Vec3 radial = glm::normalize(Vec3(mesh.positions[i].x, mesh.positions[i].y, 0));
      EXPECT_LT(glm::length(mesh.normals[i] - radial), 1e-14);
    }
    EXPECT_EQ(walls, texcoords ? 74u : 72u);
  }
  shape.smooth = 9 * kDegree;
  const Mesh sharp = made(shape);
  expect_sound(sharp, true);
  expect_flat_normals(sharp);
  EXPECT_EQ(sharp.positions.size(), 36u * 2 + 36 * 4);
  // only some corners: a square with one corner cut into a smooth one
  Extrude mixed = extrusion(shapes::outline({{0, 0}, {2, 0}, {2, 1.9}, {1.9, 2}, {0, 2}}));
  mixed.smooth = 50 * kDegree;
  expect_sound(made(mixed), true);
  EXPECT_EQ(made(mixed).positions.size(), 10u + 2 * (3 * 2 + 2));
}

TEST(Extrude, TextureCoordinates) {
  const Mesh mesh = textured(extrusion(shapes::outline({{-1, 0}, {3, 0}, {3, 2}, {-1, 2}}), 5));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3& p = mesh.positions[i];
    const Vec2& uv = mesh.texcoords[i];
    if (mesh.normals[i].z == 1)
      EXPECT_EQ(uv, Vec2((p.x + 1) / 4, p.y / 2));
    else if (mesh.normals[i].z == -1)
      EXPECT_EQ(uv, Vec2(1 - (p.x + 1) / 4, p.y / 2));
    else {
      EXPECT_EQ(uv.y, p.z / 5);
      // length along 4 + 2 + 4 + 2
      const double along = mesh.normals[i].y == -1  ? p.x + 1
                           : mesh.normals[i].x == 1 ? 4 + p.y
                           : mesh.normals[i].y == 1 ? 6 + 3 - p.x
                                                    : 10 + 2 - p.y;
      EXPECT_NEAR(uv.x, along / 12, 1e-15);
    }
  }
}

TEST(Extrude, Problems) {
  const auto with = [](std::vector<Vec2> outline, std::vector<std::vector<Vec2>> holes = {}) {
    return Extrude{.outline = std::move(outline), .holes = std::move(holes)};
  };
  const std::vector<Vec2> square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  EXPECT_EQ(code(with(square)), "");
  EXPECT_EQ(code(with({})), "E2015");
  EXPECT_EQ(code(with({{0, 0}, {1, 0}})), "E2015");
  EXPECT_EQ(code(with({{0, 0}, {1, 0}, {1, 0}, {0, 1}})), "E2015");
  EXPECT_EQ(code(with({{0, 0}, {0, 0}, {0, 0}})), "E2011");
  EXPECT_EQ(code(with({{0, 0}, {1, 1}, {1, 0}, {0, 1}})), "E2012");
  EXPECT_EQ(code(with({{0, 0}, {1, 1}, {2, 2}})), "E2012");
  EXPECT_EQ(code(with({{0, 0}, {1, NAN}, {1, 1}})), "E2010");
  EXPECT_EQ(code(with({{0, 0}, {1, 0}, {1e300, 1}})), "E2010");
  EXPECT_EQ(code(with(square, {shapes::circle(5, 1, {9, 9})})), "E2013");
  EXPECT_EQ(code(with(square, {shapes::circle(5, 1, {4, 2})})), "E2013");
  EXPECT_EQ(code(with(square, {{{1, 1}, {2, 2}, {2, 1}, {1, 2}}})), "E2012");
  EXPECT_EQ(code(with(square, {{{1, 1}, {2, 2}}})), "E2015");
  EXPECT_EQ(code(Extrude{.outline = square, .holes = {}, .height = 0}), "E2011");
  EXPECT_EQ(code(Extrude{.outline = square, .holes = {}, .smooth = -1}), "E2011");
  EXPECT_EQ(code(Extrude{.outline = square, .holes = {}, .smooth = NAN}), "E2011");
  // the message counts from 1, the item from 0
  const auto crossing = problem_of(with({{0, 0}, {2, 0}, {2, 2}, {1, -1}, {0, 2}}));
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->part, "outline");
  EXPECT_EQ(crossing->item, 0u);
  EXPECT_NE(crossing->message.find("edge 1 of the outline"), std::string::npos);
  const auto hole =
      problem_of(with(square, {shapes::circle(5, 0.4, {1, 1}), shapes::circle(5, 1, {9, 9})}));
  ASSERT_TRUE(hole);
  EXPECT_EQ(hole->part, "holes");
  EXPECT_EQ(hole->item, 1u);
  EXPECT_NE(hole->message.find("hole 2"), std::string::npos);
}

// ---- faces

Polygons cube_of_faces() {
  const Mesh cube = shapes::cube();
  Polygons shape;
  shape.positions = cube.positions;
  for (const auto& face : {std::vector<std::uint32_t>{0, 2, 3, 1},
                           {4, 5, 7, 6},
                           {0, 1, 5, 4},
                           {2, 6, 7, 3},
                           {0, 4, 6, 2},
                           {1, 3, 7, 5}})
    shape.faces.push_back({face, {}});
  return shape;
}

TEST(Polygons, CubeIsABox) {
  const Mesh mesh = made(cube_of_faces());
  const Mesh box = made(Box{.size = Vec3(2)});
  expect_sound(mesh, true);
  expect_flat_normals(mesh);
  EXPECT_EQ(mesh.error, 0);
  EXPECT_EQ(mesh.positions.size(), box.positions.size());
  EXPECT_EQ(mesh.triangles.size(), box.triangles.size());
  EXPECT_EQ(check(mesh).volume, check(box).volume);
}

TEST(Polygons, SmoothFacesShareNormals) {
  Polygons cube = cube_of_faces();
  cube.smooth = 91 * kDegree;
  const Mesh mesh = made(cube);
  expect_sound(mesh, true);
  EXPECT_EQ(mesh.positions.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_LT(glm::length(mesh.normals[i] - glm::normalize(mesh.positions[i])), 1e-15);
  // a prism of 12 sides, smooth around, sharp at the ends
  Polygons prism;
  prism.smooth = 31 * kDegree;
  Polygons::Face bottom, top;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const Vec2 p = shapes::circle(12, 1)[i];
    prism.positions.push_back({p.x, p.y, 0});
    prism.positions.push_back({p.x, p.y, 1});
    bottom.outline.insert(bottom.outline.begin(), 2 * i);
    top.outline.push_back(2 * i + 1);
    const std::uint32_t j = (i + 1) % 12;
    prism.faces.push_back({{2 * i, 2 * j, 2 * j + 1, 2 * i + 1}, {}});
  }
  prism.faces.push_back(bottom);
  prism.faces.push_back(top);
  const Mesh smooth = made(prism);
  expect_sound(smooth, true);
  EXPECT_EQ(smooth.positions.size(), 48u);
  Mesh creased = smooth;
  compute_normals(creased, prism.smooth);
  // by the angles of corners of triangles: another grouping, the same normals
  for (std::size_t i = 0; i < smooth.positions.size(); ++i)
    EXPECT_LT(glm::length(creased.normals[i] - smooth.normals[i]), 1e-12);
}

TEST(Polygons, HolesInTiltedFaces) {
  const shapes::Outline flat = [] {
    shapes::Outline outline = shapes::outline(shapes::star(40, 3, 0.6));
    outline.add(shapes::circle(11, 0.2, {0.1, 0.1}));
    outline.add(shapes::circle(7, 0.1, {-0.3, 0.1}));
    return outline;
  }();
  shapes::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 normal = random.direction();
    const Vec3 right = glm::normalize(glm::cross(normal, random.direction()));
    const Vec3 up = glm::cross(normal, right);
    Polygons shape;
    for (const Vec2& p : flat.points)
      shape.positions.push_back(Vec3(5, 6, 7) + p.x * right + p.y * up);
    Polygons::Face face;
    for (std::uint32_t i = 0; i < flat.points.size(); ++i) {
      if (i < flat.loops[1])
        face.outline.push_back(i);
      else if (i == flat.loops[1] || i == flat.loops[2])
        face.holes.push_back({i});
      else
        face.holes.back().push_back(i);
    }
    if (trial % 2) std::reverse(face.holes[0].begin(), face.holes[0].end());
    shape.faces.push_back(face);
    const Mesh mesh = made(shape, {.texcoords = trial % 3 == 0});
    EXPECT_EQ(mesh.triangles.size(), flat.points.size() + 4 - 2);
    EXPECT_NEAR(check(mesh).area, shapes::area(flat), 1e-13);
    for (const Triangle& t : mesh.triangles)
      EXPECT_GT(glm::dot(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                    mesh.positions[t[2]] - mesh.positions[t[0]]),
                         normal),
                0);
    for (const Vec3& n : mesh.normals) EXPECT_LT(glm::length(n - normal), 1e-13);
    for (const Vec2& uv : mesh.texcoords) {
      EXPECT_GE(std::min(uv.x, uv.y), -1e-15);
      EXPECT_LE(std::max(uv.x, uv.y), 1 + 1e-15);
    }
  }
}

TEST(Polygons, Problems) {
  const auto with = [](std::vector<Vec3> positions, std::vector<Polygons::Face> faces) {
    return Polygons{.positions = std::move(positions), .faces = std::move(faces)};
  };
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(code(with(square, {{{0, 1, 2, 3}, {}}})), "");
  EXPECT_EQ(code(with(square, {})), "E2015");
  EXPECT_EQ(code(with(square, {{{0, 1}, {}}})), "E2015");
  EXPECT_EQ(code(with(square, {{{0, 1, 2, 2}, {}}})), "E2015");
  EXPECT_EQ(code(with(square, {{{0, 1, 2, 4}, {}}})), "E2001");
  EXPECT_EQ(code(with(square, {{{0, 2, 1, 3}, {}}})), "E2012");
  EXPECT_EQ(code(with(square, {{{0, 1, 2, 3}, {{0, 1, 2}}}})), "E2013");
  EXPECT_EQ(code(with({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 2}, {}}})), "E2012");
  EXPECT_EQ(code(with({{0, 0, 0}, {1, 0, 0}, {1, 1, NAN}}, {{{0, 1, 2}, {}}})), "E2010");
  std::vector<Vec3> bent = square;
  bent[2].z = 1e-5;
  const auto problem = problem_of(with(bent, {{{0, 1, 2}, {}}, {{0, 1, 2, 3}, {}}}));
  ASSERT_TRUE(problem);
  EXPECT_EQ(problem->code, Code("E2016"));
  EXPECT_EQ(problem->part, "faces");
  EXPECT_EQ(problem->item, 1u);
  bent[2].z = 1e-7;
  EXPECT_EQ(code(with(bent, {{{0, 1, 2, 3}, {}}})), "");
  EXPECT_EQ(code(with(bent, {{{0, 0, 0, 0}, {}}})), "E2012");
}

}  // namespace
}  // namespace panwright::geometry::flat_shapes_test
