// Tubes: errors, counts, coordinates, normals, circular edges.

#include <gtest/gtest.h>

#include <cmath>

#include "tube_support.h"

namespace panwright::geometry::tube_test {
namespace {

using namespace tubes;

TEST(Tube, StraightPipeIsItsPrism) {
  for (const double radius : {1e-3, 0.1, 5.0}) {
    for (const Caps caps : {Caps::both, Caps::none, Caps::bottom, Caps::top}) {
      const Tube tube{.path = {{0, 0, -1}, {0, 0, 2}}, .radius = radius, .caps = caps};
      const Mesh mesh = made(tube, 1e-2 * radius);
      expect_sound(mesh, caps == Caps::both);
      const double ends = caps == Caps::both ? 2 : caps == Caps::none ? 0 : 1;
      const auto n = static_cast<double>(segments_of(tube, {.max_error = 1e-2 * radius}));
      EXPECT_EQ(static_cast<double>(mesh.triangles.size()), 2 * n + ends * (n - 2));
      const MeshReport report = check(mesh);
      if (caps != Caps::both) continue;
      // area-preserving: the volume is the cylinder's; 2e-16 measured
      EXPECT_NEAR(report.volume / (M_PI * radius * radius * 3), 1, 1e-14);
    }
  }
}

TEST(Tube, VolumeOfAMitredPipeIsThatOfItsPath) {
  // Mitres take from one side what they leave on the other, so the volume is area times length.
  for (const bool closed : {false, true}) {
    Tube tube{.path = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {3, 2, 4}, {-1, 2, 4}, {-1, -2, 3}},
              .radius = 0.2,
              .closed = closed};
    double length = 0;
    for (std::size_t i = 1; i < tube.path.size(); ++i)
      length += glm::length(tube.path[i] - tube.path[i - 1]);
    if (closed) length += glm::length(tube.path.back() - tube.path[0]);
    const Mesh mesh = made(tube, 1e-4);
    expect_sound(mesh, true);
    // 1e-15 measured open; a closed one is turned by less than half a segment, 6e-4 measured
    EXPECT_NEAR(check(mesh).volume / (M_PI * 0.04 * length), 1, closed ? 1e-3 : 1e-13);
  }
}

TEST(Tube, HollowPipesHaveWalls) {
  const Tube tube{.path = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}}, .radius = 0.2, .inner_radius = 0.15};
  const Mesh mesh = made(tube, 1e-3);
  expect_sound(mesh, true);
  EXPECT_NEAR(check(mesh).volume / (M_PI * (0.04 - 0.0225) * 2), 1, 1e-13);
  const Mesh open =
      made(Tube{.path = tube.path, .radius = 0.2, .inner_radius = 0.15, .caps = Caps::none}, 1e-3);
  expect_sound(open, false);
  expect_sound(
      made(Tube{.path = helix(0.2).path, .radius = 0.2, .inner_radius = 0.19, .spline = true},
           1e-3),
      true);
}

TEST(Tube, VolumeOfARingByPappus) {
  // the spline through 64 points of a circle is one to 1e-6
  const Tube tube = ring(64, 2, 0.3);
  const double exact = 2 * M_PI * M_PI * 2 * 0.09;
  double last = 1;
  for (const double error : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const Mesh mesh = made(tube, error);
    expect_sound(mesh, true);
    const double miss = std::fabs(check(mesh).volume / exact - 1);
    // sections keep their area, chords shorten the path: 0.5 of the relative error measured
    EXPECT_LT(miss, 1.5 * error / 0.3 + 2e-6) << error;
    EXPECT_LT(miss, last);
    last = miss;
  }
}

TEST(Tube, ErrorIsKeptAndNotWasted) {
  const Tube tubes[] = {helix(0.05),     helix(0.3), helix(0.05, false), ring(16, 1, 0.2),
                        ring(7, 1, 0.5), knot(0.1),  knot(0.3)};
  for (const Tube& tube : tubes) {
    for (const double relative : {0.3, 0.1, 0.03, 1e-2, 1e-3}) {
      const double requested = relative * tube.radius;
      const Mesh mesh = made(tube, requested);
      expect_sound(mesh, true);
      EXPECT_LE(mesh.error, requested);
      // a hexagon needs more than the error of a pentagon leaves
      EXPECT_GE(mesh.error, 0.5 * requested) << relative << " " << tube.radius;
      if (mesh.triangles.size() > 2600) continue;
      const double sampled = sampled_error(mesh, tube, 4);
      EXPECT_LE(sampled, requested + 1e-5 * tube.radius) << relative << " " << tube.radius;
    }
  }
}

// The least product of segments and sections, by the model that plans neither: sections of n
// segments keep their area (they stand out by π²r/3n², dip by π²r/6n²), chords of length h leave a
// bend of curvature κ by κh²(1 ± κr)/8, half inside when vertices are balanced. Filip, Magedson,
// Markot 1986.
double least_triangles(const Tube& tube, double error, double length, double curvature) {
  double best = 1e300;
  for (double n = 3; n < 4000; n *= 1.01) {
    const double out = M_PI * M_PI * tube.radius / (3 * n * n);
    const double high = error - out, low = error - out / 2;
    if (high <= 0) continue;
    const double bent = curvature * tube.radius;
    const double bands = length * std::max(std::sqrt(curvature * (1 + bent) / (8 * (high + low))),
                                           std::sqrt(curvature * (1 - bent) / (16 * high)));
    best = std::min(best, 2 * n * std::max(3.0, bands));
  }
  return best;
}

TEST(Tube, TrianglesNearTheClosedForm) {
  for (const double radius : {0.05, 0.3, 0.7}) {
    for (const double relative : {0.03, 1e-2, 1e-3, 1e-4}) {
      for (const int points : {8, 64, 500}) {
        // 500 points are closer than sections: those must skip them
        const Tube tube = ring(points, 1, radius);
        if (problem_of(tube)) continue;  // a spline of 8 points bends with radii from 0.66
        const double error = relative * radius;
        const double planned = planned_triangles(tube, {.max_error = error});
        const double least = least_triangles(tube, error, 2 * M_PI, 1);
        // a spline of 8 points is no circle
        EXPECT_LE(planned, (points == 8 ? 1.45 : 1.3) * least);
        EXPECT_GE(planned, 0.9 * least);
      }
    }
  }
}

TEST(Tube, PlannedIsExact) {
  for (const Tube& tube : {helix(0.1), helix(0.1, false), ring(9, 1, 0.2), knot(0.2)})
    for (const double error : {1e-2, 1e-3})
      for (const bool texcoords : {false, true})
        EXPECT_EQ(planned_triangles(tube, {.max_error = error, .texcoords = texcoords}),
                  static_cast<double>(made(tube, error, texcoords).triangles.size()));
}

TEST(Tube, TextureCoordinatesRunAroundAndAlong) {
  for (const Tube& tube : {helix(0.1), helix(0.1, false), knot(0.2), ring(9, 1, 0.2)}) {
    const Mesh mesh = made(tube, 1e-2, true);
    expect_sound(mesh, true);
    ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
      double least = 2, most = -1;
      for (const std::uint32_t v : t) {
        least = std::min(least, mesh.texcoords[v].x);
        most = std::max(most, mesh.texcoords[v].x);
        EXPECT_GE(mesh.texcoords[v].y, -1e-15);
        EXPECT_LE(mesh.texcoords[v].y, 1 + 1e-15);
      }
      EXPECT_GE(least, -1e-15);
      EXPECT_LE(most, 1 + 1e-15);
    }
  }
  // v is length: half of a straight pipe's points lie at 0, half at 1
  const Mesh pipe =
      made(Tube{.path = {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {4, 1, 0}}, .radius = 0.1}, 1e-2, true);
  for (std::size_t i = 0; i < pipe.positions.size(); ++i) {
    if (std::fabs(pipe.normals[i].z) < 0.999) continue;
    if (pipe.positions[i].x < 3.5) {
      EXPECT_NEAR(pipe.texcoords[i].y, pipe.positions[i].x < 1 ? 0 : 0.8, 1e-12);
    }
  }
}

TEST(Tube, NormalsAreAcrossThePath) {
  const Tube tube = helix(0.2);
  const Mesh mesh = made(tube, 1e-3);
  const Centreline path(tube, 4000);
  double worst = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); i += 7) {
    if (std::fabs(path.distance(mesh.positions[i]) - 0.2) > 2e-3) continue;
    // the distance from the path grows along the normal as fast as the point moves
    const double step = 0.05;
    const double grown = path.distance(mesh.positions[i] + step * mesh.normals[i]) -
                         path.distance(mesh.positions[i]);
    // normals of caps leave along the path
    if (grown < 0.5 * step) continue;
    worst = std::max(worst, std::fabs(grown / step - 1));
  }
  EXPECT_LT(worst, 2e-4);
}

TEST(Tube, CircularEdgesStandWhereTheMeshHasThem) {
  const Tube tubes[] = {Tube{.path = {{0, 0, -1}, {0, 0, 2}}, .radius = 0.25},
                        Tube{.path = {{1, 2, 3}, {4, 2, 3}, {4, 4, 5}}, .radius = 0.1}, helix(0.1)};
  for (const Tube& tube : tubes) {
    const std::vector<CircularEdge> circular_edges = circular_edges_of(tube);
    ASSERT_EQ(circular_edges.size(), 2u);
    const std::uint32_t n = 24;
    const Mesh mesh = made(tube, 1e-2, false, n);
    for (const CircularEdge& edge : circular_edges) {
      EXPECT_NEAR(glm::length(edge.start), tube.radius, 1e-16);
      EXPECT_NEAR(glm::dot(edge.start, edge.axis), 0, 1e-16);
      for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * i / n;
        const Vec3 expected = edge.centre + std::cos(angle) * edge.start +
                              std::sin(angle) * glm::cross(edge.axis, edge.start);
        double nearest = 1;
        for (const Vec3& p : mesh.positions) nearest = std::min(nearest, glm::length(p - expected));
        EXPECT_LT(nearest, 2e-15);  // 9e-16 measured
      }
    }
  }
  // along z as a cylinder's: from +x, to the last bit
  const CircularEdge edge = circular_edges_of(tubes[0])[0];
  EXPECT_EQ(edge.start, Vec3(0.25, 0, 0));
  EXPECT_EQ(edge.axis, Vec3(0, 0, 1));
  EXPECT_EQ(circular_edges_of(Tube{.path = helix(1).path, .radius = 0.1, .counts = {8, 0}}).size(),
            0u);
  EXPECT_EQ(circular_edges_of(ring(8, 1, 0.1)).size(), 0u);
  EXPECT_EQ(
      circular_edges_of(Tube{.path = {{0, 0, 0}, {1, 0, 0}}, .radius = 0.2, .inner_radius = 0.1})
          .size(),
      4u);
}

TEST(Tube, CountsAreObeyedWithVerticesOnTheShape) {
  Tube tube = helix(0.2);
  tube.counts = {12, 40};
  const Mesh mesh = made(tube, 1e-3);
  EXPECT_EQ(mesh.triangles.size(), 2u * 12 * 40 + 2 * 10);
  const Centreline path(tube, 2000);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(path.distance(p), 0.2, 1e-6);
  EXPECT_GE(mesh.error, sampled_error(mesh, tube, 3) - 1e-6);
  Tube closed = knot(0.2);
  closed.counts = {7, 33};
  expect_sound(made(closed, 1), true);
  EXPECT_EQ(made(closed, 1).triangles.size(), 2u * 7 * 33);
}

TEST(Tube, ClosedPathsCloseWithoutAJump) {
  // at every edge along the path of the knot, vertices of neighbouring sections face each other
  const Mesh mesh = made(knot(0.1), 1e-3);
  expect_sound(mesh, true);
  for (const Triangle& t : mesh.triangles) {
    // a twist by a segment would turn normals along the path as far as around it
    const Vec3& a = mesh.normals[t[0]];
    for (const std::uint32_t v : t) EXPECT_GT(glm::dot(a, mesh.normals[v]), 0.7);
  }
  const auto worst_turn = [](const Mesh& m) {
    double least = 1;
    for (const Triangle& t : m.triangles)
      for (int k = 0; k < 3; ++k)
        least = std::min(least, glm::dot(m.normals[t[k]], m.normals[t[(k + 1) % 3]]));
    return least;
  };
  Tube open = knot(0.1);
  open.closed = false;
  open.caps = Caps::none;
  // the closed one bends no normal more than the open one does, but for its last span
  EXPECT_GT(worst_turn(mesh), worst_turn(made(open, 1e-3)) - 0.02);
}

TEST(Tube, FramesDoNotTurnAboutThePath) {
  // on a helix frames that do not turn lag behind the normal by the torsion times the length
  Tube tube;
  const double pitch = 0.3;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 4 * M_PI * i / 200;
    tube.path.push_back({std::cos(angle), std::sin(angle), pitch * angle});
  }
  const internal::SplinePath path(tube.path, false);
  const auto normal_angle = [&](double t) {
    const internal::Frame frame = path.frame_at(t);
    const Vec3 inward = -Vec3(frame.centre.x, frame.centre.y, 0);
    return std::atan2(glm::dot(frame.up(), inward), glm::dot(frame.right, inward));
  };
  // away from the ends, where the spline is no helix
  const double a = path.at_length(0.2 * path.length()), b = path.at_length(0.8 * path.length());
  const double torsion = pitch / (1 + pitch * pitch);
  const double expected = torsion * 0.6 * path.length();
  const double turned = normal_angle(b) - normal_angle(a);
  EXPECT_NEAR(std::remainder(turned - expected, 2 * M_PI), 0, 2e-4);
}

}  // namespace
}  // namespace panwright::geometry::tube_test
