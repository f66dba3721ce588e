// Look-ups against a caster of its own kind: every triangle in world axes, in extended precision.
#include "instruments/lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/parallel.h"
#include "geometry/tessellate/tessellate.h"
#include "labels/compute.h"
#include "preview/reference/reference.h"
#include "tests/trace/trace_models.h"
#include "world/evaluation.h"

namespace panwright::instruments::lookup_test {
namespace {

using trace::testing_support::add;
using trace::testing_support::box;
using trace::testing_support::plate;
using trace::testing_support::Random;
using trace::testing_support::single;
using Real = long double;
using Point = std::array<Real, 3>;

geometry::Mesh sphere(double radius) {
  DiagnosticLog log;
  return *geometry::tessellated(geometry::Sphere{radius, geometry::SphereCounts{16, 24}}, {}, {},
                                log);
}

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point point(const Vec3& v) { return {v.x, v.y, v.z}; }

// A triangle in world axes, with the numbers that an image gives it.
struct Piece {
  std::array<Point, 3> corner;
  trace::Ids front, back;
  bool closed = false;
};

// By the matrices of world/evaluation.h, which look-ups do not use, without holes.
std::vector<Piece> pieces_of(const world::World& world) {
  std::vector<Piece> out;
  for (std::uint32_t t = 0; t < world.size(); ++t) {
    const world::EvaluatedInstance state = world::evaluated(world[t]);
    const pan::Model& model = *world[t].model();
    const Mat4 world_from_model = world[t].pose().matrix();
    for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
      const auto& instance = model.instances()[i];
      if (!state.node_visible[instance.node]) continue;
      const auto& record = model.meshes()[instance.mesh];
      const pan::MeshView mesh = model.mesh(instance.mesh);
      const Mat4 place = world_from_model * state.model_from_nodes[instance.node];
      const bool mirrored = glm::determinant(Mat3(place)) < 0;
      const auto back = model.back_of(i);
      Piece piece;
      piece.front = {t + 1, instance.node + 1, instance.material + 1, i + 1};
      piece.back = piece.front;
      if (back >= 0) piece.back.material = static_cast<std::uint32_t>(back) + 1;
      piece.closed = (record.flags & pan::layout::kMeshClosed) != 0;
      for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        for (std::size_t c = 0; c < 3; ++c) {
          const auto& p = mesh.positions[mesh.indices[k + c]];
          const Vec3 local(record.origin[0] + p.x, record.origin[1] + p.y, record.origin[2] + p.z);
          piece.corner[c] = point(Vec3(place * Vec4(local, 1)));
        }
        if (mirrored) std::swap(piece.corner[1], piece.corner[2]);
        out.push_back(piece);
      }
    }
  }
  return out;
}

struct Crossed {
  Real distance = std::numeric_limits<Real>::infinity();
  Real margin = 1;  // least weight of a corner; of misses: from the outline, in weights
  trace::Ids ids;
};

// Pieces of one instance, and a ball around them.
struct Ball {
  std::size_t first = 0, end = 0;
  Vec3 centre{0};
  double radius = 0;
};

std::vector<Ball> balls_of(const std::vector<Piece>& pieces) {
  std::vector<Ball> out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (i == 0 || pieces[i].front.instance != pieces[i - 1].front.instance) out.push_back({i, i});
    out.back().end = i + 1;
  }
  const auto corner = [](const Point& p) {
    return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  };
  for (Ball& ball : out) {
    ball.centre = corner(pieces[ball.first].corner[0]);
    for (std::size_t i = ball.first; i < ball.end; ++i)
      for (const Point& p : pieces[i].corner)
        ball.radius = std::max(ball.radius, 1.001 * glm::length(corner(p) - ball.centre));
  }
  return out;
}

// Möller and Trumbore's solution, without a tree.
void improve(const std::vector<Piece>& pieces, const Ball& ball, const geometry::Ray& ray,
             Crossed& best, Real* edge) {
  const Point origin = point(ray.origin), along = point(ray.direction);
  const Real length = std::sqrt(dot(along, along));
  for (std::size_t i = ball.first; i < ball.end; ++i) {
    const Piece& piece = pieces[i];
    const Point ab = piece.corner[1] - piece.corner[0], ac = piece.corner[2] - piece.corner[0];
    const Point p = cross(along, ac);
    const Real det = dot(ab, p);
    if (det == 0 || (piece.closed && det < 0)) continue;
    const Point from = origin - piece.corner[0];
    const Real u = dot(from, p) / det;
    const Point q = cross(from, ab);
    const Real v = dot(along, q) / det, t = dot(ac, q) / det * length;
    if (t < 0) continue;
    const Real margin = std::min({u, v, 1 - u - v});
    if (std::fabs(margin) < 1e-6L) *edge = std::min(*edge, std::fabs(margin));
    if (margin < 0 || t >= best.distance) continue;
    best = {t, margin, det > 0 ? piece.front : piece.back};
  }
}

Crossed nearest_crossing(const std::vector<Piece>& pieces, const std::vector<Ball>& balls,
                         const geometry::Ray& ray, Real* edge) {
  Crossed best;
  for (const Ball& ball : balls) {
    const Vec3 off = glm::cross(ball.centre - ray.origin, ray.direction);
    if (glm::length(off) <= ball.radius) improve(pieces, ball, ray, best, edge);
  }
  return best;
}

// Boxes, spheres and plates with backs; stretched, mirrored and on joints; two targets.
world::World assorted() {
  pan::Contents contents = single(box({1, 2, 0.5}));
  contents.meshes.push_back(pan::packed(sphere(0.6), "sphere"));
  contents.meshes.push_back(pan::packed(plate(3, 1), "plate"));
  contents.materials.emplace_back();
  contents.materials.emplace_back();
  const Quat turn = glm::angleAxis(0.9, glm::normalize(Vec3(1, 2, -1)));
  contents.nodes.push_back({"stretched", 0, Vec3(1.5, 0, 0.2), turn, Vec3(0.5, 1.5, 0.8)});
  contents.nodes.push_back({"mirror", 1, Vec3(-0.5, 1, 0), turn, Vec3(-1, 0.7, 1)});
  contents.nodes.push_back({"panel", 0, Vec3(-2, 0.3, -0.4), turn, Vec3(1, -1, 1)});
  contents.instances = {{0, 0, 0, -1}, {1, 1, 1, -1}, {2, 1, 0, -1}, {3, 2, 1, -1}};
  contents.instances[3].back = 2;
  contents.keypoints.push_back({"corner", 0, Vec3(0.5, 1, 0.25)});
  contents.keypoints.push_back({"inside", 0, Vec3(0)});
  contents.keypoints.push_back({"tip", 3, Vec3(1.5, 0.5, 0)});
  Random random(17);
  world::World world;
  add(world, "a", contents, {Vec3(0.3, -0.2, 0.1), random.rotation()});
  add(world, "b", contents, {Vec3(3, 1, -1), random.rotation()});
  world.set_node_visible(1, 2, false);
  return world;
}

void expect_equal(const trace::Ids& a, const trace::Ids& b, std::size_t i) {
  EXPECT_EQ(a.target, b.target) << i;
  EXPECT_EQ(a.node, b.node) << i;
  EXPECT_EQ(a.material, b.material) << i;
  EXPECT_EQ(a.instance, b.instance) << i;
}

TEST(Lookups, AHundredThousandRaysAreThoseOfAnotherCaster) {
  const world::World world = assorted();
  const std::vector<Piece> pieces = pieces_of(world);
  const std::vector<Ball> balls = balls_of(pieces);
  Lookups lookups;
  lookups.update(world);
  constexpr std::size_t kRays = 100'000;
  Random random(18);
  std::vector<geometry::Ray> rays(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    // from 1 m to 1e6 m
    const double range = std::pow(10, random.between(0, 6));
    const Vec3 origin = range * glm::normalize(random.in_cube(1)) + random.in_cube(1);
    const Vec3 aim = random.in_cube(0.9) + (i % 2 ? Vec3(3, 1, -1) : Vec3(0.3, -0.2, 0.1));
    rays[i] = {origin, glm::normalize(aim - origin)};
  }
  std::vector<SurfacePoint> found(kRays);
  lookups.rays(rays, found);
  std::vector<Crossed> expected(kRays);
  std::vector<Real> edges(kRays, 1);
  parallel_for(kRays / 500, [&](std::size_t chunk) {
    for (std::size_t i = 500 * chunk; i < 500 * (chunk + 1); ++i)
      expected[i] = nearest_crossing(pieces, balls, rays[i], &edges[i]);
  });
  std::size_t hits = 0, edged = 0;
  double worst = 0;
  for (std::size_t i = 0; i < kRays; ++i) {
    // the direction of a far ray is rounded: 1e-16 of the range against an edge's 1e-6
    if (edges[i] < 1e-6L) {
      ++edged;
      continue;
    }
    expect_equal(found[i].ids, expected[i].ids, i);
    if (!found[i] || !std::isfinite(expected[i].distance)) continue;
    ++hits;
    const double range = static_cast<double>(expected[i].distance);
    const Vec3 at = rays[i].origin + range * rays[i].direction;
    worst = std::max({worst, std::fabs(found[i].distance - range) / range,
                      glm::length(found[i].position - at) / range});
  }
  std::printf("%zu hits, %zu at edges; positions to %.1e of the range\n", hits, edged, worst);
  EXPECT_GT(hits, kRays / 4);
  EXPECT_LT(edged, kRays / 1000);
  EXPECT_LT(worst, 1e-9);  // measured 5e-13, where planes graze
}

TEST(Lookups, PixelsAreTheGroundTruthOfAnImage) {
  const world::World world = assorted();
  world::Camera camera;
  world::set_field_of_view(camera, 96, 64, 0.6);
  camera.position = {3, -11, 4};
  DiagnosticLog log;
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(1, 0, 0), std::nullopt, log);
  image::Image image;
  image.width = camera.width;
  image.height = camera.height;
  preview::Reference reference;
  ASSERT_TRUE(reference.add_ground_truth(world, camera, false, image, log)) << to_text(log);
  std::vector<Vec2> places;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column)
      places.emplace_back(column + 0.5, row + 0.5);
  std::vector<SurfacePoint> found(places.size());
  Lookups lookups;
  lookups.update(world);
  lookups.pixels(camera, places, found);
  std::size_t covered = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(found[i].ids.target, image.target_id[i]) << i;
    EXPECT_EQ(found[i].ids.node, image.node_id[i]) << i;
    EXPECT_EQ(found[i].ids.material, image.material_id[i]) << i;
    if (!found[i]) continue;
    ++covered;
    EXPECT_NEAR(found[i].distance, image.range[i], 1e-6 * found[i].distance) << i;
  }
  EXPECT_GT(covered, places.size() / 10);
}

TEST(Lookups, SightsAreBlockedFromBothEnds) {
  world::World world;
  add(world, "box", single(box({2, 2, 2})));
  Lookups lookups;
  lookups.update(world);
  const std::vector<Sight> sights = {
      {Vec3(-5, 0, 0), Vec3(5, 0, 0)},           // through
      {Vec3(-5, 1.001, 0), Vec3(5, 1.001, 0)},   // past
      {Vec3(0, 0, 0), Vec3(5, 0, 0)},            // out of a closed mesh
      {Vec3(1, 0.2, 0.3), Vec3(1e6, 0.2, 0.3)},  // from its surface
      {Vec3(1, 0, 0), Vec3(-1, 0, 0)},           // from side to side
      {Vec3(7, 7, 7), Vec3(7, 7, 7)},            // no way at all
  };
  const std::vector<std::uint8_t> expected = {0, 1, 0, 1, 1, 1};
  std::vector<Sight> turned;
  for (const Sight& each : sights) turned.push_back({each.to, each.from});
  for (const auto& asked : {sights, turned}) {
    std::vector<std::uint8_t> open(asked.size());
    lookups.sights(asked, 1e-6, open);
    EXPECT_EQ(open, expected);
  }
}

TEST(Lookups, ElevationsAreThoseOfASphereOnAPlate) {
  world::World world;
  add(world, "plate", single(plate(10, 10)), {Vec3(0, 0, 100), Quat(1, 0, 0, 0)});
  add(world, "sphere", single(sphere(1)), {Vec3(2, 1, 100.5), Quat(1, 0, 0, 0)});
  Lookups lookups;
  lookups.update(world);
  const std::vector<Vec2> places = {{0, 0}, {2, 1}, {2, 1.9}, {-4.9, 4.9}, {6, 0}};
  std::vector<SurfacePoint> found(places.size());
  lookups.elevations(places, found);
  EXPECT_NEAR(found[0].position.z, 100, 1e-9);
  EXPECT_NEAR(found[1].position.z, 101.5, 1e-6);
  EXPECT_NEAR(found[2].position.z, 100.5 + std::sqrt(1 - 0.81), 0.05);  // the mesh is coarse
  EXPECT_NEAR(found[3].position.z, 100, 1e-9);
  EXPECT_FALSE(found[4]);
  EXPECT_EQ(found[1].distance, found[1].position.z);
  EXPECT_EQ(found[1].ids.target, 2u);
  EXPECT_EQ(found[3].ids.target, 1u);
}

// Distance from a triangle by its corners, its sides and its inside, one by one.
Real distance_from(const Piece& piece, const Point& p) {
  Real best = std::numeric_limits<Real>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& a = piece.corner[k];
    const Point side = piece.corner[(k + 1) % 3] - a, off = p - a;
    const Real share = std::clamp<Real>(dot(off, side) / dot(side, side), 0, 1);
    const Point rest = {off[0] - share * side[0], off[1] - share * side[1],
                        off[2] - share * side[2]};
    best = std::min(best, std::sqrt(dot(rest, rest)));
  }
  const Point ab = piece.corner[1] - piece.corner[0], ac = piece.corner[2] - piece.corner[0];
  const Point normal = cross(ab, ac), off = p - piece.corner[0];
  const Real area = dot(normal, normal);
  const Real v = dot(cross(off, ac), normal) / area, w = dot(cross(ab, off), normal) / area;
  if (v >= 0 && w >= 0 && v + w <= 1)
    best = std::min(best, std::fabs(dot(off, normal)) / std::sqrt(area));
  return best;
}

TEST(Lookups, NearestPointsAreThoseOfAllTriangles) {
  const world::World world = assorted();
  const std::vector<Piece> pieces = pieces_of(world);
  Lookups lookups;
  lookups.update(world);
  Random random(19);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i)
    points.push_back(random.in_cube(i % 4 == 0 ? 1e3 : 3) + Vec3(1.5, 0, 0));
  std::vector<SurfacePoint> found(points.size());
  lookups.nearest(points, found);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Piece* nearest = nullptr;
    Real best = std::numeric_limits<Real>::infinity(), second = best;
    for (const Piece& piece : pieces) {
      const Real distance = distance_from(piece, point(points[i]));
      if (distance < best) {
        second = nearest && nearest->front.instance != piece.front.instance ? best : second;
        best = distance;
        nearest = &piece;
      } else if (piece.front.instance != nearest->front.instance) {
        second = std::min(second, distance);
      }
    }
    ASSERT_TRUE(found[i]) << i;
    worst = std::max(worst, std::fabs(found[i].distance - static_cast<double>(best)));
    worst =
        std::max(worst, std::fabs(glm::length(found[i].position - points[i]) - found[i].distance));
    if (second - best > 1e-6L) {
      EXPECT_EQ(found[i].ids.instance, nearest->front.instance) << i;
    }
    EXPECT_GE(glm::dot(found[i].facet, points[i] - found[i].position), -1e-9) << i;
  }
  std::printf("distances to %.1e m\n", worst);
  EXPECT_LT(worst, 1e-12);  // measured 5e-13: of points 1e3 m away
}

TEST(Lookups, KeypointsAreThoseOfLabels) {
  const world::World world = assorted();
  world::Camera camera;
  world::set_field_of_view(camera, 200, 150, 0.6);
  DiagnosticLog log;
  Random random(20);
  Lookups lookups;
  lookups.update(world);
  labels::Labeller labeller;
  std::size_t hidden = 0, seen = 0;
  for (int i = 0; i < 12; ++i) {
    camera.position = 12.0 * glm::normalize(random.in_cube(1));
    camera.world_from_camera = *world::looking_at(camera.position, Vec3(1, 0, 0), {}, log);
    const auto frame = labeller.label(world, camera, {}, log);
    const auto all = lookups.keypoints(camera);
    ASSERT_TRUE(frame);
    ASSERT_EQ(all.size(), 2u);
    for (std::size_t t = 0; t < 2; ++t) {
      EXPECT_EQ(all[t], frame->things[t].keypoints);
      for (const labels::Keypoint& each : all[t]) ++(each.occluded ? hidden : seen);
    }
  }
  EXPECT_GT(hidden, 12u);
  EXPECT_GT(seen, 12u);
}

TEST(Lookups, AreTheSameForAnyNumberOfThreads) {
  const world::World world = assorted();
  Lookups lookups;
  lookups.update(world);
  Random random(21);
  std::vector<geometry::Ray> rays(5000);
  for (geometry::Ray& ray : rays) {
    ray.origin = random.in_cube(8);
    ray.direction = glm::normalize(random.in_cube(2) - ray.origin);
  }
  std::vector<SurfacePoint> one(rays.size()), many(rays.size());
  lookups.rays(rays, many);
  lookups.rays(rays, one, Job({1, {}}));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(one[i].distance, many[i].distance) << i;
    ASSERT_EQ(one[i].position, many[i].position) << i;
    ASSERT_EQ(one[i].normal, many[i].normal) << i;
  }
}

TEST(Lookups, OfNothingFindNothing) {
  Lookups lookups;
  lookups.update(world::World());
  std::vector<SurfacePoint> found(1);
  lookups.rays(std::vector<geometry::Ray>{{Vec3(0), Vec3(0, 0, 1)}}, found);
  EXPECT_FALSE(found[0]);
  lookups.elevations(std::vector<Vec2>{Vec2(0)}, found);
  EXPECT_FALSE(found[0]);
  lookups.nearest(std::vector<Vec3>{Vec3(0)}, found);
  EXPECT_FALSE(found[0]);
  EXPECT_TRUE(lookups.keypoints({}).empty());
}

}  // namespace
}  // namespace panwright::instruments::lookup_test
