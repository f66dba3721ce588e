// Subdivision surfaces against Catmull and Clark's own rules, uniform B-splines, and each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/job.h"
#include "geometry/mesh/distance.h"
#include "shapes.h"
#include "tests/support/cages.h"
#include "tests/support/catmull_clark.h"

namespace panwright::geometry::subdiv_test {
namespace {

using oracles::CatmullClark;

Mesh made(const Subdiv& shape, double max_error = 1e-3, bool texcoords = false) {
  const auto problem = problem_of(shape);
  EXPECT_FALSE(problem) << problem->message;
  if (problem) return {};
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = max_error;
  options.texcoords = texcoords;
  auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh.ok());
  return mesh.ok() ? *std::move(mesh) : Mesh{};
}

Mesh at_levels(Subdiv shape, std::uint32_t levels) {
  shape.levels = levels;
  return made(shape);
}

// The largest distance of a point of one list from the nearest of the other, both ways.
double furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const Vec3& p : *from) {
      double nearest = HUGE_VAL;
      for (const Vec3& q : *to) nearest = std::min(nearest, glm::length(p - q));
      worst = std::max(worst, nearest);
    }
  return worst;
}

TEST(Subdiv, ACornerOfTheCubeConverges) {
  // corners (1, 1, 1) after 1 to 6 levels, and their limit
  const double corners[] = {5.0 / 9,      0.5092592593, 0.5015432099,
                            0.5002572016, 0.5000428669, 0.5000071445};
  CatmullClark cage(cages::cube());
  for (const double x : corners) {
    cage = cage.refined();
    EXPECT_NEAR(cage.positions()[7].x, x, 1e-10);
    EXPECT_NEAR(cage.limits()[7].x, 0.5, 1e-14);
  }
  for (const std::uint32_t levels : {1u, 2u, 5u}) {
    const Mesh mesh = at_levels(cages::cube(), levels);
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      if (const double d = glm::length(mesh.positions[i] - Vec3(0.5)); d < nearest) {
        nearest = d;

        EXPECT_LT(d < 0.01 ? glm::length(mesh.normals[i] - Vec3(std::sqrt(1.0 / 3))) : 0, 1e-12);
      }
    EXPECT_LT(nearest, 1e-14);
  }
}

double basis(double t) {
  t = std::fabs(t);
  return t < 1 ? 2.0 / 3 - t * t + t * t * t / 2 : t < 2 ? std::pow(2 - t, 3) / 6 : 0;
}
double slope(double t) {
  const double sign = t < 0 ? -1 : 1;
  t = std::fabs(t);
  return sign * (t < 1 ? -2 * t + 1.5 * t * t : t < 2 ? -std::pow(2 - t, 2) / 2 : 0);
}

// The vertices of a grid are uniform in x and y, so the limit over interior faces is a graph.
TEST(Subdiv, RegularGridsAreBicubicSplines) {
  const std::uint32_t n = 6, m = 5;
  const Subdiv shape = cages::sheet(n, m);
  for (const std::uint32_t levels : {1u, 2u, 3u, 4u}) {
    const Mesh mesh = at_levels(shape, levels);
    std::size_t found = 0;
    double position = 0, normal = 0;
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      const Vec3& p = mesh.positions[k];
      if (p.x < 1 || p.x > n - 1 || p.y < 1 || p.y > m - 1) continue;
      double z = 0, dx = 0, dy = 0;
      for (std::uint32_t j = 0; j <= m; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
          const double h = shape.positions[j * (n + 1) + i].z;
          z += h * basis(p.x - i) * basis(p.y - j);
          dx += h * slope(p.x - i) * basis(p.y - j);
          dy += h * basis(p.x - i) * slope(p.y - j);
        }
      position = std::max(position, std::fabs(p.z - z));
      normal = std::max(normal, glm::length(mesh.normals[k] - glm::normalize(Vec3(-dx, -dy, 1))));
      ++found;
    }
    EXPECT_GE(found, ((n - 2u) << levels) * ((m - 2u) << levels));
    EXPECT_LT(position, 1e-12);
    EXPECT_LT(normal, 1e-12);
  }
}

TEST(Subdiv, ExplicitLevelsAreRefinedCagesPushedToTheLimit) {
  for (const auto& [name, shape] : cages::all()) {
    const bool quads = std::all_of(shape.faces.begin(), shape.faces.end(),
                                   [](const auto& f) { return f.outline.size() == 4; });
    for (const std::uint32_t levels : {1u, 2u, 3u}) {
      const Mesh mesh = at_levels(shape, levels);
      const CatmullClark cage = CatmullClark(shape).refined(static_cast<int>(levels));
      EXPECT_LT(furthest(mesh.positions, cage.pushed_used()), 1e-12) << name << ' ' << levels;
      EXPECT_EQ(mesh.triangles.size(), 2 * cage.faces().size()) << name;
      (void)quads;
    }
  }
}

// By subdividing the faces about each vertex until they are flat, without masks.
TEST(Subdiv, NormalsAndLimitsAreThoseOfTheRefinedRing) {
  std::size_t compared = 0;
  for (const auto& [name, shape] : cages::all()) {
    const Mesh mesh = at_levels(shape, 1);
    CatmullClark cage = CatmullClark(shape).refined();
    const std::size_t count = cage.positions().size();
    while (!cage.is_decayed()) cage = cage.refined();
    for (std::uint32_t v = 0; v < count; ++v) {
      const CatmullClark::Ring ring = cage.ring_of(v);
      if (ring.normals.empty()) continue;
      std::size_t found = 0;
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (glm::length(mesh.positions[i] - ring.limit) > 1e-12) continue;
        ++found;
        if (ring.corner) continue;
        double nearest = HUGE_VAL;
        for (const Vec3& n : ring.normals)
          nearest = std::min(nearest, glm::length(n - mesh.normals[i]));
        EXPECT_LT(nearest, 1e-9) << name << " vertex " << v;
        ++compared;
      }
      EXPECT_EQ(found, ring.normals.size()) << name << " vertex " << v;
    }
  }
  EXPECT_GT(compared, 500u);
}

// By the bounds of Hausdorff's distance, against cages refined five times.
TEST(Subdiv, ErrorsKeepWhatIsAskedWithoutWaste) {
  for (const auto& [name, shape] : cages::all()) {
    const Mesh fine = CatmullClark(shape).refined(5).limit_mesh();
    const MeasuredMesh reference(fine);
    for (const double asked : {0.1, 0.02}) {
      const Mesh mesh = made(shape, asked);
      const MeasuredMesh measured(mesh);
      const double there = distance_from(measured, reference, {.relative = 0.01}).low;
      const double back = distance_from(reference, measured, {.relative = 0.01}).low;
      EXPECT_LE(mesh.error, asked) << name;

      EXPECT_GT(mesh.error, 0.4 * asked) << name << ' ' << asked;
      // what the fine cage misses is a thousandth of its size at creases of sharpness 3; 0.02
      // measured
      EXPECT_LT(there, mesh.error + 0.025 * asked) << name << ' ' << asked;
      EXPECT_LT(back, 1.05 * asked) << name << ' ' << asked;
      const double planned = planned_triangles(shape, {.max_error = asked});
      EXPECT_GE(planned, 0.9 * static_cast<double>(mesh.triangles.size())) << name;
      EXPECT_LE(planned, 1.1 * static_cast<double>(mesh.triangles.size())) << name;
    }
  }
}

TEST(Subdiv, FinerErrorsArePlannedToo) {
  for (const auto& [name, shape] : {cages::Named{"cube", cages::cube()},
                                    {"ring", cages::creased(cages::cube(), {4, 5, 7, 6, 4}, 3)},
                                    {"prism", cages::prism(5)}}) {
    const Mesh mesh = made(shape, 1e-4);
    EXPECT_GT(mesh.triangles.size(), 20000u);
    EXPECT_GT(mesh.error, 0.4e-4) << name;
    EXPECT_LE(mesh.error, 1e-4) << name;
    const double planned = planned_triangles(shape, {.max_error = 1e-4});
    EXPECT_GE(planned, 0.9 * static_cast<double>(mesh.triangles.size())) << name;
  }
}

// Cells of unequal rates, sharp edges and seams leave no gap.
TEST(Subdiv, MeshesAreClosedWhereCagesAre) {
  for (const auto& [name, shape] : cages::all())
    for (const double error : {0.2, 0.05, 0.012}) {
      const Mesh mesh = made(shape, error);
      const MeshReport report = check(mesh);
      EXPECT_EQ(report.closed, is_closed(shape)) << name;
      EXPECT_EQ(mesh.closed, is_closed(shape)) << name;
      EXPECT_EQ(report.bad_indices + report.bad_lengths + report.bad_normals + report.non_finite,
                0u)
          << name;
      EXPECT_EQ(report.misoriented_edges + report.non_manifold_edges, 0u) << name;
      EXPECT_EQ(report.degenerate_triangles, 0u) << name << ' ' << error;
      if (mesh.closed) {
        EXPECT_GT(report.volume, 0) << name;
      }
    }
}

// A long cell has segments along its bend alone.
TEST(Subdiv, FlatDirectionsHaveNoSegments) {
  Subdiv trough = cages::sheet(4, 1, 0);
  for (Vec3& p : trough.positions) p.z = 0.3 * (p.x - 2) * (p.x - 2);
  trough.creases.push_back({{0, 5}, kInfinitelySharp});
  const Mesh mesh = made(trough, 1e-4);
  for (const Vec3& p : mesh.positions)
    EXPECT_LT(std::min(std::fabs(p.y), std::fabs(p.y - 1)), 1e-12);
  Subdiv flat = cages::sheet(3, 3, 0);
  EXPECT_EQ(made(flat, 10).triangles.size(), 18u);
  EXPECT_EQ(made(flat, 10).error, 0);
}

Mat3 turn(const Vec3& axis, double angle) {
  return glm::mat3_cast(glm::angleAxis(angle, glm::normalize(axis)));
}

TEST(Subdiv, RigidMotionsMoveTheMesh) {
  shapes::Random random(7);
  for (const auto& [name, shape] : cages::all()) {
    const Mesh here = made(shape, 0.02);
    for (int i = 0; i < 3; ++i) {
      const Mat3 rotation = turn(random.direction(), random.between(0, 3));
      const Vec3 shift = random.between(0, 2) * random.direction();
      Subdiv moved = shape;
      for (Vec3& p : moved.positions) p = rotation * p + shift;
      const Mesh there = made(moved, 0.02);
      ASSERT_EQ(here.triangles, there.triangles) << name;
      double position = 0, normal = 0;
      for (std::size_t v = 0; v < here.positions.size(); ++v) {
        position = std::max(position,
                            glm::length(rotation * here.positions[v] + shift - there.positions[v]));
        normal = std::max(normal, glm::length(rotation * here.normals[v] - there.normals[v]));
      }
      EXPECT_LT(position, 1e-12) << name;
      EXPECT_LT(normal, 1e-12) << name;
    }
  }
}

TEST(Subdiv, MeshesAreTheSameWhateverTheThreads) {
  for (const auto& cage : cages::all()) {
    const auto& name = cage.name;
    const auto& shape = cage.shape;
    const Mesh many = made(shape, 0.01);
    Mesh one;
    run_on_threads(Job(JobOptions{1, {}}), [&] { one = made(shape, 0.01); });
    EXPECT_EQ(many.triangles, one.triangles) << name;
    EXPECT_EQ(many.positions, one.positions) << name;
    EXPECT_EQ(many.normals, one.normals) << name;
    EXPECT_EQ(many.error, one.error) << name;
  }
}

TEST(Subdiv, TextureCoordinatesAreLinearOverFaces) {
  Subdiv shape = cages::sheet(2, 1);
  // one seam: the second face has coordinates of its own
  shape.texcoords = {{0, 0},     {0.5, 0},   {0.5, 1},   {0, 1},
                     {0.1, 0.2}, {0.3, 0.2}, {0.3, 0.4}, {0.1, 0.4}};
  shape.faces[0].texcoords = {0, 1, 2, 3};
  shape.faces[1].texcoords = {4, 5, 6, 7};
  shape.levels = 2;
  const Mesh mesh = made(shape, 1, true);
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  EXPECT_EQ(mesh.positions.size(), 2u * 25);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec2& t = mesh.texcoords[v];
    if (std::fabs(mesh.positions[v].x - 1) < 1e-9) continue;
    // quarters of the face's square
    const Vec2 steps =
        mesh.positions[v].x < 1 ? Vec2(8 * t.x, 4 * t.y) : Vec2(20 * (t.x - 0.1), 20 * (t.y - 0.2));
    EXPECT_LT(std::fabs(steps.x - std::round(steps.x)) + std::fabs(steps.y - std::round(steps.y)),
              1e-12)
        << t.x << ' ' << t.y;
  }
  // joined at the seam where they agree
  shape.faces[1].texcoords = {1, 5, 6, 2};
  EXPECT_EQ(made(shape, 1, true).positions.size(), 45u);
  EXPECT_EQ(made(shape, 1, false).positions.size(), 45u);
  // without any: as on a box
  Subdiv cube = cages::cube();
  const Mesh boxed = made(cube, 0.01, true);
  ASSERT_EQ(boxed.texcoords.size(), boxed.positions.size());
  for (const Vec2& t : boxed.texcoords) EXPECT_TRUE(t.x >= 0 && t.x <= 1 && t.y >= 0 && t.y <= 1);
}

std::string code(const Subdiv& shape) {
  const auto problem = problem_of(shape);
  return problem ? std::string(code_info(problem->code).name) : "";
}

TEST(Subdiv, Problems) {
  const auto with = [](std::vector<std::vector<std::uint32_t>> faces) {
    Subdiv s;
    s.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}};
    cages::add_faces(s, faces);
    return s;
  };
  EXPECT_EQ(code(with({{0, 1, 2, 3}})), "");
  EXPECT_EQ(code(with({})), "E2015");
  EXPECT_EQ(code(with({{0, 1}})), "E2015");
  EXPECT_EQ(code(with({{0, 1, 2, 1}})), "E2015");
  EXPECT_EQ(code(with({{0, 1, 6}})), "E2001");
  EXPECT_EQ(code(with({{0, 1, 2, 3}, {1, 0, 4, 5}, {0, 1, 4}})), "E2026");
  EXPECT_EQ(code(with({{0, 1, 2, 3}, {0, 1, 5, 4}})), "E2026");
  EXPECT_EQ(code(with({{0, 1, 2}, {0, 4, 5}})), "E2026");
  EXPECT_EQ(code(with({{0, 1, 2, 3}, {0, 1, 2, 3}})), "E2026");
  EXPECT_EQ(code(with({{0, 1, 2, 3}, {3, 2, 1, 0}})), "");
  EXPECT_EQ(code(cages::creased(with({{0, 1, 2, 3}}), {0, 2}, 1)), "E2027");
  EXPECT_EQ(code(cages::creased(with({{0, 1, 2, 3}}), {0}, 1)), "E2015");
  EXPECT_EQ(code(cages::creased(with({{0, 1, 2, 3}}), {0, 9}, 1)), "E2001");
  for (const double bad : {-1.0, 10.5, static_cast<double>(NAN)}) {
    EXPECT_EQ(code(cages::creased(with({{0, 1, 2, 3}}), {0, 1}, bad)), "E2011");
    EXPECT_EQ(code(cages::cornered(with({{0, 1, 2, 3}}), {0}, bad)), "E2011");
  }
  EXPECT_EQ(code(cages::cornered(with({{0, 1, 2, 3}}), {7}, 1)), "E2001");
  Subdiv far = with({{0, 1, 2, 3}});
  far.positions[2].x = 1e31;
  EXPECT_EQ(code(far), "E2010");
  far.positions[2].x = NAN;
  EXPECT_EQ(code(far), "E2010");
  Subdiv point = with({{0, 1, 2, 3}});
  for (Vec3& p : point.positions) p = Vec3(3, 4, 5);
  EXPECT_EQ(code(point), "E2011");
  Subdiv deep = with({{0, 1, 2, 3}});
  deep.levels = 11;
  EXPECT_EQ(code(deep), "E2011");
  Subdiv textured = with({{0, 1, 2, 3}, {1, 0, 4, 5}});
  textured.texcoords = {{0, 0}, {1, 0}};
  textured.faces[0].texcoords = {0, 1, 1, 0};
  EXPECT_EQ(code(textured), "E2002");
  textured.faces[1].texcoords = {0, 1, 1};
  EXPECT_EQ(code(textured), "E2002");
  textured.faces[1].texcoords = {0, 1, 1, 2};
  EXPECT_EQ(code(textured), "E2001");
}

TEST(Subdiv, WarningsOfCages) {
  const auto codes = [](const Subdiv& s) {
    std::string all;
    for (const ShapeProblem& p : shape_warnings_of(s))
      all += std::string(code_info(p.code).name) + ' ';
    return all;
  };
  for (const auto& [name, shape] : cages::all()) EXPECT_EQ(codes(shape), "") << name;
  Subdiv inside_out = cages::cube();
  for (auto& face : inside_out.faces) std::reverse(face.outline.begin(), face.outline.end());
  EXPECT_EQ(codes(inside_out), "W2009 ");
  Subdiv doubled = cages::sheet(2, 1);
  doubled.positions.push_back(doubled.positions[1]);
  doubled.positions.push_back(doubled.positions[4]);
  doubled.faces[1].outline = {6, 2, 5, 7};
  EXPECT_EQ(codes(doubled), "W2028 ");
  Subdiv thin = cages::sheet(1, 1);
  thin.positions[2] = thin.positions[0];
  thin.positions[3] = thin.positions[1];
  EXPECT_EQ(codes(thin), "W2006 W2028 ");
}

// Sizes that single precision just holds, flat and folded cages, and vertices at one place.
TEST(Subdiv, HardCagesAreMadeOrRefused) {
  for (const double size : {1e-29, 1e-6, 1.0, 1e6, 1e29}) {
    for (const auto& [name, unit] : cages::all()) {
      Subdiv shape = unit;
      for (Vec3& p : shape.positions) p *= size;
      const Mesh mesh = made(shape, 0.05 * size);
      const Mesh same = made(unit, 0.05);
      ASSERT_EQ(mesh.triangles.size(), same.triangles.size()) << name << ' ' << size;
      EXPECT_LE(mesh.error, 0.05 * size) << name;
      EXPECT_EQ(check(mesh).bad_normals, 0u) << name << ' ' << size;
    }
  }
  Subdiv folded = cages::sheet(2, 2, 0);
  for (Vec3& p : folded.positions) p.x = std::fabs(p.x - 1);
  Subdiv needle = cages::cube();
  for (Vec3& p : needle.positions) p *= Vec3(1e-9, 1, 1e-9);
  Subdiv pinched = cages::cube();
  pinched.positions[7] = pinched.positions[6];
  Subdiv line = cages::sheet(2, 1, 0);
  for (Vec3& p : line.positions) p.y = 0;
  for (const Subdiv& shape : {folded, needle, pinched, line})
    for (const double error : {0.1, 1e-3}) {
      const Mesh mesh = made(shape, error);
      const MeshReport report = check(mesh);
      EXPECT_LE(mesh.error, error);
      EXPECT_EQ(report.bad_normals + report.non_finite + report.bad_indices, 0u);
    }
  // far away the error cannot be kept, and so much is said
  Subdiv far = cages::cube();
  for (Vec3& p : far.positions) p = 1e6 * p;
  DiagnosticLog log;
  EXPECT_FALSE(tessellated(far, {.max_error = 1e-3}, {}, log).ok());
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E2003"));
  // too many triangles, and too many faces along semi-sharp creases
  DiagnosticLog more;
  EXPECT_FALSE(
      tessellated(cages::cube(), {.max_error = 1e-4, .max_triangles = 1000}, {}, more).ok());
  Subdiv sharp = cages::sheet(60, 60);
  for (std::uint32_t j = 1; j < 60; ++j) {
    sharp.creases.push_back({{}, 9.5});
    for (std::uint32_t i = 0; i <= 60; ++i) sharp.creases.back().path.push_back(61 * j + i);
  }
  EXPECT_FALSE(tessellated(sharp, {.max_error = 0.1}, {}, more).ok());
  EXPECT_EQ(more.entries().size(), 2u);
}

TEST(Subdiv, CurvatureOfACage) {
  const CageTurn cube = turn_of(cages::cube());
  EXPECT_NEAR(cube.area, 24, 1e-12);
  EXPECT_NEAR(cube.mean_curvature, 12 * 0.5 * 2 * M_PI / 2, 1e-12);
  EXPECT_EQ(turn_of(cages::sheet(3, 3, 0)).mean_curvature, 0);
}

}  // namespace
}  // namespace panwright::geometry::subdiv_test
