#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/hash.h"
#include "base/parallel.h"
#include "geometry/internal/path.h"
#include "shapes.h"

namespace panwright::geometry {
namespace {

Mesh made(const Tube& tube, double max_error, bool texcoords = false, std::uint32_t rim = 0) {
  const auto problem = problem_of(tube);
  EXPECT_FALSE(problem) << problem->message;
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = max_error;
  options.texcoords = texcoords;
  options.rim_segments = rim;
  auto mesh = tessellated(tube, options, {}, log);
  EXPECT_TRUE(mesh.ok());
  return mesh.ok() ? *mesh : Mesh{};
}

void expect_closed_or_open(const Mesh& mesh, bool closed) {
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.closed, closed);
  EXPECT_EQ(mesh.closed, closed);
  EXPECT_EQ(report.degenerate_triangles, 0u);
  EXPECT_EQ(report.bad_indices + report.bad_lengths + report.bad_normals + report.non_finite, 0u);
  EXPECT_EQ(report.misoriented_edges + report.non_manifold_edges, 0u);
  if (closed) {
    EXPECT_GT(report.volume, 0);
  }
}

void expect_sound(const Mesh& mesh, bool closed) {
  expect_closed_or_open(mesh, closed);
  // nothing is folded: facets look where their vertices do
  std::size_t turned = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 facet = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                  mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t v : t) turned += !(glm::dot(facet, mesh.normals[v]) > 0);
  }
  EXPECT_EQ(turned, 0u);
}

// The pyramid of Barry and Goldman: the same spline by another way.
Vec3 pyramid(const Vec3 p[4], double share) {
  double t[4] = {0};
  for (int i = 1; i < 4; ++i) t[i] = t[i - 1] + std::sqrt(glm::length(p[i] - p[i - 1]));
  const double x = t[1] + share * (t[2] - t[1]);
  Vec3 a[3], b[2];
  for (int i = 0; i < 3; ++i)
    a[i] = ((t[i + 1] - x) * p[i] + (x - t[i]) * p[i + 1]) / (t[i + 1] - t[i]);
  for (int i = 0; i < 2; ++i)
    b[i] = ((t[i + 2] - x) * a[i] + (x - t[i]) * a[i + 1]) / (t[i + 2] - t[i]);
  return ((t[2] - x) * b[0] + (x - t[1]) * b[1]) / (t[2] - t[1]);
}

// Many points of a tube's path; distances are refined between them.
class Centreline {
 public:
  explicit Centreline(const Tube& tube, int per_span = 400) {
    const auto n = static_cast<int>(tube.path.size());
    const int spans = tube.closed ? n : n - 1;
    for (int i = 0; i < spans; ++i) {
      const auto at = [&](int k) {
        if (tube.closed) return tube.path[(k + n) % n];
        if (k < 0) return 2.0 * tube.path[0] - tube.path[1];
        if (k >= n) return 2.0 * tube.path[n - 1] - tube.path[n - 2];
        return tube.path[k];
      };
      const Vec3 p[4] = {at(i - 1), at(i), at(i + 1), at(i + 2)};
      for (int k = 0; k < per_span; ++k) {
        const double share = static_cast<double>(k) / per_span;
        points_.push_back(tube.spline ? pyramid(p, share) : p[1] + share * (p[2] - p[1]));
      }
    }
    points_.push_back(tube.closed ? tube.path[0] : tube.path.back());
  }
  double length() const {
    double sum = 0;
    for (std::size_t i = 1; i < points_.size(); ++i)
      sum += glm::length(points_[i] - points_[i - 1]);
    return sum;
  }
  // from the chords, which the curve leaves by step²·curvature/8
  double distance(const Vec3& q) const {
    constexpr std::size_t kBlock = 40;
    double best = 1e300;
    // a block's chords are no nearer than its first point less their length
    for (std::size_t first = 0; first + 1 < points_.size(); first += kBlock) {
      const std::size_t last = std::min(points_.size() - 1, first + kBlock);
      if (glm::length(q - points_[first]) - reach(first) > std::sqrt(best)) continue;
      for (std::size_t i = first + 1; i <= last; ++i) {
        const Vec3 d = points_[i] - points_[i - 1];
        const double t = std::clamp(glm::dot(q - points_[i - 1], d) / glm::dot(d, d), 0.0, 1.0);
        const Vec3 miss = q - points_[i - 1] - t * d;
        best = std::min(best, glm::dot(miss, miss));
      }
    }
    return std::sqrt(best);
  }
  // from the surface of a pipe, or of the cylinders that mitres cut
  double miss(const Vec3& q, const Tube& tube, double radius) const {
    if (tube.spline) return std::fabs(distance(q) - radius);
    double least = 1e300;
    for (std::size_t i = 1; i < tube.path.size(); ++i) {
      const Vec3 along = glm::normalize(tube.path[i] - tube.path[i - 1]);
      const Vec3 from = q - tube.path[i];
      least =
          std::min(least, std::fabs(glm::length(from - glm::dot(from, along) * along) - radius));
    }
    return least;
  }

 private:
  double reach(std::size_t first) const {
    const std::size_t block = first / 40;
    while (reach_.size() <= block) {
      const std::size_t begin = 40 * reach_.size();
      double furthest = 0;
      for (std::size_t i = begin; i <= std::min(points_.size() - 1, begin + 40); ++i)
        furthest = std::max(furthest, glm::length(points_[i] - points_[begin]));
      reach_.push_back(furthest);
    }
    return reach_[block];
  }
  std::vector<Vec3> points_;
  mutable std::vector<double> reach_;
};

// The largest | distance − radius | over points of the wall's triangles, on float32 vertices.
double sampled_error(const Mesh& mesh, const Tube& tube, int steps) {
  const Centreline path(tube);
  Vec3 least = mesh.positions[0], most = least;
  for (const Vec3& p : mesh.positions) least = glm::min(least, p), most = glm::max(most, p);
  const Vec3 origin = 0.5 * (least + most);
  const auto stored = [&](const Vec3& p) {
    const Vec3 d = p - origin;
    return origin + Vec3(static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z));
  };
  double worst = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = stored(mesh.positions[t[0]]), b = stored(mesh.positions[t[1]]),
               c = stored(mesh.positions[t[2]]);
    const Vec3 facet = glm::normalize(glm::cross(b - a, c - a));
    // caps are flat: their inside is at any distance
    if (glm::dot(facet, mesh.normals[t[0]]) > 0.999999 && !tube.closed &&
        mesh.normals[t[0]] == mesh.normals[t[1]] && mesh.normals[t[1]] == mesh.normals[t[2]])
      continue;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
        worst = std::max(worst, path.miss((1 - u - v) * a + u * b + v * c, tube, tube.radius));
      }
    }
  }
  return worst;
}

Tube ring(int points, double path_radius, double radius) {
  Tube tube;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * M_PI * i / points;
    tube.path.push_back({path_radius * std::cos(angle), path_radius * std::sin(angle), 0});
  }
  tube.radius = radius;
  tube.spline = tube.closed = true;
  return tube;
}

Tube helix(double radius, bool spline = true) {
  Tube tube;
  for (int i = 0; i <= 24; ++i) {
    const double angle = 2 * M_PI * i / 8;
    tube.path.push_back({std::cos(angle), std::sin(angle), 0.1 * i});
  }
  tube.radius = radius;
  tube.spline = spline;
  return tube;
}

// A closed curve in space without any plane: its frames come back turned.
Tube knot(double radius) {
  Tube tube;
  for (int i = 0; i < 40; ++i) {
    const double t = 2 * M_PI * i / 40;
    tube.path.push_back({std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t),
                         -1.5 * std::sin(3 * t)});
  }
  tube.radius = radius;
  tube.spline = tube.closed = true;
  return tube;
}

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

TEST(Tube, RimsStandWhereTheMeshHasThem) {
  const Tube tubes[] = {Tube{.path = {{0, 0, -1}, {0, 0, 2}}, .radius = 0.25},
                        Tube{.path = {{1, 2, 3}, {4, 2, 3}, {4, 4, 5}}, .radius = 0.1}, helix(0.1)};
  for (const Tube& tube : tubes) {
    const std::vector<Rim> rims = rims_of(tube);
    ASSERT_EQ(rims.size(), 2u);
    const std::uint32_t n = 24;
    const Mesh mesh = made(tube, 1e-2, false, n);
    for (const Rim& rim : rims) {
      EXPECT_NEAR(glm::length(rim.start), tube.radius, 1e-16);
      EXPECT_NEAR(glm::dot(rim.start, rim.axis), 0, 1e-16);
      for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * i / n;
        const Vec3 expected = rim.centre + std::cos(angle) * rim.start +
                              std::sin(angle) * glm::cross(rim.axis, rim.start);
        double nearest = 1;
        for (const Vec3& p : mesh.positions) nearest = std::min(nearest, glm::length(p - expected));
        EXPECT_LT(nearest, 2e-15);  // 9e-16 measured
      }
    }
  }
  // along z as a cylinder's: from +x, to the last bit
  const Rim rim = rims_of(tubes[0])[0];
  EXPECT_EQ(rim.start, Vec3(0.25, 0, 0));
  EXPECT_EQ(rim.axis, Vec3(0, 0, 1));
  EXPECT_EQ(rims_of(Tube{.path = helix(1).path, .radius = 0.1, .counts = {8, 0}}).size(), 0u);
  EXPECT_EQ(rims_of(ring(8, 1, 0.1)).size(), 0u);
  EXPECT_EQ(
      rims_of(Tube{.path = {{0, 0, 0}, {1, 0, 0}}, .radius = 0.2, .inner_radius = 0.1}).size(), 4u);
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

TEST(Tube, BendsSharperThanTheRadiusAreRefused) {
  const auto expect_problem = [](const Tube& tube, Code code, std::size_t item) {
    const auto problem = problem_of(tube);
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->code, code);
    EXPECT_EQ(problem->item, item) << problem->message;
  };
  // doubles back
  expect_problem({.path = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}}, Code::E2014, 1);
  expect_problem({.path = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, .spline = true}, Code::E2014, 1);
  // a right angle takes the radius from both sides
  Tube corner{.path = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, .radius = 0.99};
  EXPECT_FALSE(problem_of(corner));
  expect_sound(made(corner, 0.01), true);
  corner.radius = 1.01;
  expect_problem(corner, Code::E2014, 1);
  // two corners to one side share the straight between them, to both sides they do not
  Tube u{.path = {{0, 3, 0}, {0, 0, 0}, {1, 0, 0}, {1, 3, 0}}, .radius = 0.51};
  expect_problem(u, Code::E2014, 1);
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
  EXPECT_EQ(hairpin->code, Code::E2014);
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
    EXPECT_EQ(ok, !log.contains(Code::E2003));
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
    set_thread_count(threads);
    const Mesh mesh = made(knot(0.2), 1e-4, true);
    set_thread_count(0);
    return std::tuple{hash64(std::as_bytes(std::span(mesh.positions))),
                      hash64(std::as_bytes(std::span(mesh.triangles))), mesh.error};
  };
  EXPECT_EQ(hashes(1), hashes(4));
}

}  // namespace
}  // namespace panwright::geometry
