// Tubes that bend too sharply, bad paths, hard ones, limits.

#include <gtest/gtest.h>

#include <cmath>

#include "base/hash.h"
#include "base/parallel.h"
#include "tube_support.h"

namespace panwright::geometry::tube_hard_test {
namespace {

using namespace tubes;

TEST(Tube, BendsSharperThanTheRadiusAreRefused) {
  const auto expect_problem = [](const Tube& tube, Code code, std::size_t item) {
    const auto problem = problem_of(tube);
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->code, code);
    EXPECT_EQ(problem->item, item) << problem->message;
  };
  // doubles back
  expect_problem({.path = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}}, Code("E2014"), 1);
  expect_problem({.path = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, .spline = true}, Code("E2014"), 1);
  // a right angle takes the radius from both sides
  Tube corner{.path = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, .radius = 0.99};
  EXPECT_FALSE(problem_of(corner));
  expect_sound(made(corner, 0.01), true);
  corner.radius = 1.01;
  expect_problem(corner, Code("E2014"), 1);
  // two corners to one side share the straight between them, to both sides they do not
  Tube u{.path = {{0, 3, 0}, {0, 0, 0}, {1, 0, 0}, {1, 3, 0}}, .radius = 0.51};
  expect_problem(u, Code("E2014"), 1);
  u.radius = 0.49;
  EXPECT_FALSE(problem_of(u));
  Tube z{.path = {{0, 3, 0}, {0, 0, 0}, {1, 0, 0}, {1, -3, 0}}, .radius = 0.9};
  EXPECT_FALSE(problem_of(z));
  expect_sound(made(z, 0.05), true);
  // a ring of radius 1 bends like one
  EXPECT_FALSE(problem_of(ring(64, 1, 0.99)));
  expect_sound(made(ring(64, 1, 0.99), 1e-2), true);
  EXPECT_TRUE(problem_of(ring(64, 1, 1.01)));
  // a hairpin, at its tip
  const auto hairpin =
      problem_of(Tube{.path = {{0, 0, 0}, {5, 0, 0}, {5.2, 0.1, 0}, {5, 0.2, 0}, {0, 0.2, 0}},
                      .radius = 0.2,
                      .spline = true});
  ASSERT_TRUE(hairpin);
  EXPECT_EQ(hairpin->code, Code("E2014"));
  EXPECT_EQ(hairpin->item, 2u);
}

TEST(Tube, BadPathsAndSizesAreNamed) {
  const auto code = [](const Tube& tube) {
    const auto problem = problem_of(tube);
    return problem ? std::string(code_info(problem->code).name) : "";
  };
  const std::vector<Vec3> path{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  EXPECT_EQ(code({.path = path}), "");
  EXPECT_EQ(code({.path = {}}), "E2015");
  EXPECT_EQ(code({.path = {{0, 0, 0}}}), "E2015");
  EXPECT_EQ(code({.path = {{0, 0, 0}, {1, 0, 0}}, .closed = true}), "E2015");
  EXPECT_EQ(code({.path = {{0, 0, 0}, {0, 0, 0}}}), "E2011");  // no extent at all
  EXPECT_EQ(code({.path = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1e-10}}}), "E2015");
  EXPECT_EQ(code({.path = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}}, .closed = true}), "E2015");
  EXPECT_EQ(code({.path = {{0, 0, 0}, {NAN, 0, 0}}}), "E2010");
  EXPECT_EQ(code({.path = {{0, 0, 0}, {1e300, 0, 0}}}), "E2010");
  for (const double radius : {0.0, -1.0})
    EXPECT_EQ(code({.path = path, .radius = radius}), "E2011");
  for (const double radius : {1e-31, 1e31, HUGE_VAL, std::nan("")})
    EXPECT_EQ(code({.path = path, .radius = radius}), "E2010");
  EXPECT_EQ(code({.path = path, .radius = 0.1, .inner_radius = 0.1}), "E2011");
  EXPECT_EQ(code({.path = path, .radius = 0.1, .inner_radius = -0.1}), "E2011");
  EXPECT_EQ(code({.path = path, .counts = {2, 0}}), "E2018");
}

TEST(Tube, HardPathsStillMakeSoundMeshes) {
  // collinear points, spline and not
  for (const bool spline : {false, true}) {
    Tube tube{.path = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2.5, 0, 0}, {7, 0, 0}},
              .radius = 0.3,
              .spline = spline};
    const Mesh mesh = made(tube, 1e-3);
    expect_sound(mesh, true);
    // straight: two sections
    const auto n = segments_of(tube, {.max_error = 1e-3});
    EXPECT_EQ(mesh.triangles.size(), 2 * n + 2 * (n - 2));
    EXPECT_NEAR(check(mesh).volume / (M_PI * 0.09 * 7), 1, 1e-12);
  }
  // straight, then bent, then straight, with steps of very different lengths
  Tube mixed{.path = {{0, 0, 0},
                      {100, 0, 0},
                      {101, 0.2, 0},
                      {101.5, 1, 0},
                      {101.5, 100, 0},
                      {101.5, 100.5, 0}},
             .radius = 0.1,
             .spline = true};
  for (const double error : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const Mesh mesh = made(mixed, error);
    expect_sound(mesh, true);
    EXPECT_LE(mesh.error, error);
  }
  // a rough path: many points about a line
  shapes::Random random(5);
  Tube rough{.path = {}, .radius = 0.01, .spline = true};
  for (int i = 0; i < 100; ++i)
    rough.path.push_back({0.02 * i, random.between(-1e-4, 1e-4), random.between(-1e-4, 1e-4)});
  for (const double error : {1e-3, 1e-4}) {
    const Mesh mesh = made(rough, error);
    expect_sound(mesh, true);
    if (error == 1e-3) {
      EXPECT_LE(sampled_error(mesh, rough, 2), error + 1e-6);
    }
  }
  // an error larger than everything
  expect_closed_or_open(made(helix(0.1), 100), true);
  expect_closed_or_open(made(knot(0.1), 100), true);
  EXPECT_LE(made(knot(0.1), 100).triangles.size(), 200u);
  // huge and tiny
  for (const double scale : {1e-25, 1e-9, 1e9, 1e25}) {
    Tube tube = helix(0.2);
    for (Vec3& p : tube.path) p *= scale;
    tube.radius *= scale;
    const Mesh mesh = made(tube, 1e-3 * scale);
    expect_sound(mesh, true);
    EXPECT_LE(mesh.error, 1e-3 * scale);
  }
}

TEST(Tube, LimitsHold) {
  const auto code = [](const Tube& tube, double error, std::uint64_t most) {
    DiagnosticLog log;
    TessellationOptions options;
    options.max_error = error;
    options.max_triangles = most;
    const bool ok = tessellated(tube, options, {}, log).ok();
    EXPECT_EQ(ok, !log.contains(Code("E2003")));
    EXPECT_EQ(planned_triangles(tube, options) > static_cast<double>(most) || error < 1e-9, !ok);
    return !ok;
  };
  for (const Tube& tube : {helix(0.1), helix(0.1, false), ring(20, 1, 0.1)}) {
    const auto n = made(tube, 1e-3).triangles.size();
    EXPECT_FALSE(code(tube, 1e-3, n));
    EXPECT_TRUE(code(tube, 1e-3, n - 1));
    EXPECT_TRUE(code(tube, 1e-15, 1u << 27));
    EXPECT_TRUE(code(tube, 1e-300, 1u << 27));
  }
  Tube counted = helix(0.1);
  counted.counts = {4000000000u, 4000000000u};
  EXPECT_TRUE(code(counted, 1e-3, 1u << 27));
}

TEST(Tube, BytesDoNotDependOnTheNumberOfThreads) {
  const auto hashes = [](std::size_t threads) {
    Mesh mesh;
    run_on_threads(Job({threads, {}}), [&] { mesh = made(knot(0.2), 1e-4, true); });
    return std::tuple{hash64(std::as_bytes(std::span(mesh.positions))),
                      hash64(std::as_bytes(std::span(mesh.triangles))), mesh.error};
  };
  EXPECT_EQ(hashes(1), hashes(4));
}

}  // namespace
}  // namespace panwright::geometry::tube_hard_test
