#include "geometry/mesh/clean.h"

#include <gtest/gtest.h>

#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "base/parallel.h"
#include "geometry/internal/weld.h"
#include "geometry/mesh/internal/boundary_loops.h"
#include "geometry/mesh/internal/edges.h"
#include "geometry/mesh/internal/tjunction.h"
#include "shapes.h"

namespace panwright::geometry::clean_test {
namespace {

Mesh soup(const Mesh& mesh) {
  Mesh out;
  for (const Triangle& t : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(out.positions.size());
    for (const std::uint32_t v : t) {
      out.positions.push_back(mesh.positions[v]);
      if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
    }
    out.triangles.push_back({base, base + 1, base + 2});
  }
  return out;
}

Mesh bare(const Mesh& mesh) {
  Mesh out;
  out.positions = mesh.positions;
  out.triangles = mesh.triangles;
  return out;
}

void append(Mesh& to, const Mesh& from, const Vec3& offset, bool inside_out = false) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3& p : from.positions) to.positions.push_back(p + offset);
  for (const Triangle& t : from.triangles)
    to.triangles.push_back(inside_out ? Triangle{base + t[0], base + t[2], base + t[1]}
                                      : Triangle{base + t[0], base + t[1], base + t[2]});
}

Vec3 facet_normal(const Mesh& mesh, const Triangle& t) {
  return glm::normalize(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                   mesh.positions[t[2]] - mesh.positions[t[0]]));
}

// An open plane of n x n squares in [0, 1]².
Mesh sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.positions.push_back({double(i) / n, double(j) / n, 0});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return mesh;
}

bool same(const Mesh& a, const Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.texcoords == b.texcoords &&
         a.colors == b.colors && a.triangles == b.triangles && a.closed == b.closed &&
         a.error == b.error;
}

TEST(Clean, ACleanSphereLosesNothing) {
  Mesh mesh = bare(shapes::sphere(20, 30));
  const Mesh before = mesh;
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(mesh.triangles.size(), before.triangles.size());
  EXPECT_EQ(mesh.positions.size(), before.positions.size());
  EXPECT_EQ(report.flipped + report.duplicates + report.degenerate + report.holes, 0u);
  EXPECT_EQ(report.components, 1u);
  EXPECT_EQ(report.closed_components, 1u);
  EXPECT_TRUE(mesh.closed);
  const MeshReport found = check(mesh);
  EXPECT_TRUE(found.closed);
  EXPECT_NEAR(found.volume, check(before).volume, 1e-14);
}

TEST(Clean, SoupBecomesTheMeshItWasMadeOf) {
  const Mesh whole = shapes::sphere(20, 30);
  Mesh mesh = bare(soup(whole));
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(mesh.positions.size(), whole.positions.size());
  EXPECT_EQ(report.welded, 3 * whole.triangles.size() - whole.positions.size());
  EXPECT_EQ(report.largest_move, 0);
  EXPECT_TRUE(check(mesh).closed);
}

// No vertex moves further than the tolerance, and none that stays has another one within it.
TEST(Clean, WeldingKeepsToItsTolerance) {
  shapes::Random random(11);
  for (const double tolerance : {1e-9, 1e-3, 0.05, 0.4}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 3000; ++i)
      points.push_back({random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    for (int i = 0; i < 1000; ++i)  // chains, which creep where welding is by neighbours
      points.push_back({0.3 * tolerance * i, 5, 0});
    const std::vector<std::uint32_t> at = welded_within(points, tolerance);
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      EXPECT_LE(glm::length(points[i] - points[at[i]]), tolerance * (1 + 1e-12));
      EXPECT_EQ(at[at[i]], at[i]);
      // the first that stayed, by a double loop
      std::uint32_t expected = i;
      for (const std::uint32_t k : kept) {
        const Vec3 off = points[k] - points[i];
        if (glm::dot(off, off) <= tolerance * tolerance) {
          expected = k;
          break;
        }
      }
      ASSERT_EQ(at[i], expected);
      if (expected == i) kept.push_back(i);
    }
  }
}

TEST(Clean, WeldingWithToleranceBelowRoundingStaysFast) {
  std::vector<Vec3> points;
  for (int i = 0; i < 200'000; ++i) points.push_back({1e30 + 1e16 * i, 1e30, 0});
  EXPECT_EQ(welded_within(points, 1e-300), welded(points));
}

TEST(Clean, WeldingWithinATolerance) {
  const Mesh whole = shapes::sphere(12, 16);
  Mesh mesh = bare(soup(whole));
  shapes::Random random(5);
  for (Vec3& p : mesh.positions) p += 1e-6 * random() * random.direction();
  CleanOptions options;
  options.tolerance = 3e-6;
  const CleanReport report = clean(mesh, options);
  EXPECT_EQ(mesh.positions.size(), whole.positions.size());
  EXPECT_LE(report.largest_move, 2e-6);
  EXPECT_GT(report.largest_move, 1e-7);
  EXPECT_EQ(mesh.error, report.largest_move);
  EXPECT_TRUE(mesh.closed);
}

TEST(Clean, SeamsStayApart) {
  // two triangles with one edge in common, and another texture on each
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {1, 1}, {0, 1}};
  mesh.colors.assign(6, Vec3(1));
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  clean(mesh, {});
  // (0, 1, 0) looks the same on both, (1, 0, 0) does not
  EXPECT_EQ(mesh.positions.size(), 5u);
  std::multiset<std::pair<double, double>> seam;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v] == Vec3(1, 0, 0)) seam.insert({mesh.texcoords[v].x, mesh.texcoords[v].y});
  EXPECT_EQ(seam, (std::multiset<std::pair<double, double>>{{0.5, 0}, {1, 0}}));
}

TEST(Clean, DuplicatesGoAndTwoSidedSheetsBecomeOne) {
  Mesh mesh = sheet(4);
  const std::size_t triangles = mesh.triangles.size();
  append(mesh, sheet(4), Vec3(0), true);  // its back
  append(mesh, sheet(4), Vec3(0));        // and its front again
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(report.duplicates, 2 * triangles);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  for (const Triangle& t : mesh.triangles) EXPECT_GT(facet_normal(mesh, t).z, 0.99);
}

TEST(Clean, SheetsWithTwoTexturesKeepBoth) {
  Mesh mesh = sheet(2);
  append(mesh, sheet(2), Vec3(0), true);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.colors.push_back(v < 9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  EXPECT_EQ(clean(mesh, {}).duplicates, 0u);
  EXPECT_EQ(mesh.triangles.size(), 16u);
}

TEST(Clean, DegenerateTrianglesGoUnlessTheyHoldASurfaceTogether) {
  Mesh mesh = shapes::cube();
  mesh.triangles.push_back({0, 0, 1});
  mesh.positions.push_back({5, 0, 0});
  mesh.positions.push_back({6, 0, 0});
  mesh.positions.push_back({7, 0, 0});
  mesh.triangles.push_back({8, 9, 10});
  EXPECT_EQ(clean(mesh, {}).degenerate, 2u);
  EXPECT_TRUE(mesh.closed);
  // a cube with a vertex on one of its edges, and a triangle without area that closes the gap
  Mesh split = shapes::cube();
  const Triangle cut = split.triangles[0];
  const auto middle = static_cast<std::uint32_t>(split.positions.size());
  split.positions.push_back(0.5 * split.positions[cut[0]] + 0.5 * split.positions[cut[1]]);
  split.triangles[0] = {cut[0], middle, cut[2]};
  split.triangles.push_back({middle, cut[1], cut[2]});
  split.triangles.push_back({cut[0], cut[1], middle});
  ASSERT_TRUE(check(split).closed);
  EXPECT_EQ(clean(split, {}).degenerate, 0u);
  EXPECT_TRUE(split.closed);
}

TEST(Clean, ClosedPiecesFaceOutwards) {
  shapes::Random random(7);
  Mesh mesh;
  append(mesh, bare(shapes::sphere(8, 9)), Vec3(0), true);  // inside out
  append(mesh, bare(shapes::sphere(8, 9)), Vec3(3, 0, 0));  // right
  append(mesh, shapes::cube(), Vec3(1e6, 0, 0));            // far away, windings at random
  std::size_t turned = 0;
  for (std::size_t i = mesh.triangles.size() - 12; i < mesh.triangles.size(); ++i)
    if (random() < 0.5) {
      std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
      ++turned;
    }
  ASSERT_GT(turned, 0u);
  const double sphere = check(shapes::sphere(8, 9)).volume;
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(report.components, 3u);
  EXPECT_EQ(report.closed_components, 3u);
  EXPECT_EQ(report.flipped, shapes::sphere(8, 9).triangles.size() + turned);
  const MeshReport found = check(mesh);
  EXPECT_EQ(found.misoriented_edges, 0u);
  // 3e-10 of cones 1e6 long are rounding; 1.2e-10 measured
  EXPECT_NEAR(found.volume, 2 * sphere + 8, 1e-8);
}

// A bowl: a hemisphere seen from outside more than from inside.
TEST(Clean, OpenPiecesFaceWhereMoreIsSeen) {
  DiagnosticLog log;
  Sphere cap;
  cap.latitude_min = 0;
  TessellationOptions options;
  options.max_error = 0.01;
  const Mesh bowl = bare(*tessellated(geometry::Shape(cap), options, {}, log));
  for (const bool inside_out : {false, true}) {
    Mesh mesh;
    append(mesh, bowl, Vec3(0), inside_out);
    const CleanReport report = clean(mesh, {});
    EXPECT_EQ(report.flipped, inside_out ? bowl.triangles.size() : 0u);
    for (const Triangle& t : mesh.triangles)
      EXPECT_GT(glm::dot(facet_normal(mesh, t), mesh.positions[t[0]]), 0);
  }
}

TEST(Clean, FlatSheetsStayAsWrittenAndNeighboursAgree) {
  for (const bool reversed : {false, true}) {
    Mesh mesh;
    append(mesh, sheet(6), Vec3(0), reversed);
    for (std::size_t i = 0; i < 10; ++i)
      std::swap(mesh.triangles[3 * i][0], mesh.triangles[3 * i][1]);
    EXPECT_EQ(clean(mesh, {}).flipped, 10u);
    for (const Triangle& t : mesh.triangles)
      EXPECT_GT(facet_normal(mesh, t).z * (reversed ? -1 : 1), 0.99);
  }
}

TEST(Clean, NormalsEndOnTheOutsideWhicheverWayTheFileHadThem) {
  for (const bool winding : {false, true})
    for (const bool normals : {false, true}) {
      Mesh mesh = bare(shapes::sphere(20, 30));
      mesh.normals.clear();
      for (const Vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(normals ? -p : p));
      if (winding)
        for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
      const CleanReport report = clean(mesh, {});
      EXPECT_EQ(report.flipped, winding ? mesh.triangles.size() : 0u);
      EXPECT_EQ(report.normals_turned, normals ? mesh.triangles.size() : 0u);
      EXPECT_EQ(report.vertices_after, report.vertices_before - report.welded);
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        EXPECT_GT(glm::dot(mesh.normals[v], glm::normalize(mesh.positions[v])), 0.999);
    }
}

TEST(Clean, NormalsOfASheetFollowItsFaces) {
  Mesh mesh = sheet(2);
  mesh.normals.assign(mesh.positions.size(), Vec3(0, 0, 1));
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(clean(mesh, {}).normals_turned, 0u);
  for (const Vec3& n : mesh.normals) EXPECT_EQ(n.z, 1.0);
  // a normal that two faces want differently stands there twice
  Mesh half = sheet(1);
  half.normals.assign(half.positions.size(), Vec3(0, 0, -1));
  half.normals[half.triangles[0][0]] = half.normals[half.triangles[0][1]] = Vec3(0, 0, 1);
  const CleanReport report = clean(half, {});
  EXPECT_EQ(report.normals_turned, 1u);
}

TEST(Clean, MoebiusStripsAreLeftAlone) {
  Mesh mesh;
  const std::uint32_t n = 40;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * kPi * i / n;
    for (const double s : {-0.3, 0.3})
      mesh.positions.push_back({(1 + s * std::cos(a / 2)) * std::cos(a),
                                (1 + s * std::cos(a / 2)) * std::sin(a), s * std::sin(a / 2)});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i;
    const bool last = i + 1 == n;
    const std::uint32_t c = last ? 1 : a + 2;
    const std::uint32_t d = last ? 0 : a + 3;
    mesh.triangles.push_back({a, c, a + 1});
    mesh.triangles.push_back({a + 1, c, d});
  }
  const std::vector<Triangle> before = mesh.triangles;
  CleanOptions options;
  options.reorder = false;
  const CleanReport report = clean(mesh, options);
  EXPECT_EQ(report.one_sided, 1u);
  EXPECT_EQ(report.flipped, 0u);
  EXPECT_EQ(report.boundary_loops, 0u);  // half-edges need two sides
  EXPECT_EQ(report.border_edges, 2 * n);
  EXPECT_EQ(mesh.triangles.size(), before.size());
}

// A face that half-edges cannot hold is left out without a word, and the stream that OpenMesh
// shares with the program around stays as it was set.
TEST(Clean, OpenMeshIsQuietAndStaysAsItWas) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::vector<std::uint32_t> unique_position = {0, 1, 2, 3, 4};
  std::ostringstream printed;
  omerr().connect(printed);
  for (const bool enabled : {true, false}) {
    enabled ? omerr().enable() : omerr().disable();
    (void)boundary_loops_of(mesh, unique_position, edges_of(mesh, unique_position));
    EXPECT_EQ(omerr().is_enabled(), enabled);
  }
  omerr().enable();
  EXPECT_EQ(printed.str(), "");
  omerr() << "heard" << std::endl;
  EXPECT_NE(printed.str(), "");
  omerr().disconnect(printed);
}

TEST(Clean, HolesAreFoundMeasuredAndFilled) {
  Mesh mesh = bare(shapes::sphere(30, 40));
  const double volume = check(mesh).volume;
  // the pole's cap goes: a boundary loop of 40 edges, and elsewhere one triangle
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(),
                       [&](std::uint32_t v) { return mesh.positions[v].z > 0.9999; });
  });
  mesh.triangles.erase(mesh.triangles.begin() + 700);
  ASSERT_FALSE(check(mesh).closed);
  Mesh open = mesh;
  const CleanReport report = clean(open, {});
  EXPECT_EQ(report.boundary_loops, 2u);
  EXPECT_EQ(report.holes, 2u);
  ASSERT_EQ(report.spots.size(), 2u);
  EXPECT_EQ(report.spots[0].size, 40u);
  // the polygon of 40 sides about the pole
  const double radius = std::sin(kPi / 30);
  EXPECT_NEAR(report.spots[0].length, 40 * 2 * radius * std::sin(kPi / 40), 1e-14);
  EXPECT_LT(glm::length(report.spots[0].at - Vec3(0, 0, std::cos(kPi / 30))), 1e-15);
  EXPECT_EQ(report.spots[1].size, 3u);
  EXPECT_FALSE(open.closed);
  CleanOptions options;
  options.fill_holes = true;
  EXPECT_EQ(clean(mesh, options).filled, 2u);
  EXPECT_TRUE(mesh.closed);
  const MeshReport found = check(mesh);
  EXPECT_TRUE(found.closed);
  // what is missing is the cap above the flat lid: under its height times its base
  EXPECT_LT(found.volume, volume);
  EXPECT_GT(found.volume, volume - kPi * radius * radius * (1 - std::cos(kPi / 30)));
}

TEST(Clean, LongBoundaryLoopsAreFilledByAFan) {
  DiagnosticLog log;
  Cylinder tube;
  tube.caps = Caps::none;
  tube.height = 100;
  tube.counts.around = 200;
  Mesh mesh = bare(*tessellated(geometry::Shape(tube), {}, {}, log));
  CleanOptions options;
  options.fill_holes = true;
  const CleanReport report = clean(mesh, options);
  EXPECT_EQ(report.filled, 2u);
  EXPECT_TRUE(check(mesh).closed);
  const double area = 100 * std::sin(2 * kPi / 200) * tube.radius * tube.radius;
  EXPECT_NEAR(check(mesh).volume, area * 100, 1e-10);
}

TEST(Clean, BoundaryLoopsOfSheetsAreNoHoles) {
  Mesh mesh = sheet(5);
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(report.boundary_loops, 1u);
  EXPECT_EQ(report.holes, 0u);
  EXPECT_EQ(report.border_edges, 20u);
}

TEST(Clean, JunctionsAgainstEachVertexAndEdge) {
  // strips of other division side by side
  for (const std::uint32_t n : {3u, 7u, 40u}) {
    Mesh mesh = sheet(n);
    append(mesh, sheet(5), Vec3(1, 0, 0));
    append(mesh, sheet(2), Vec3(1e-9, 1, 0));
    const std::vector<std::uint32_t> unique_position = welded(mesh.positions);
    const Edges edges = edges_of(mesh, unique_position);
    const double distance = 1e-7;
    const std::vector<Junction> found = junctions_of(mesh, unique_position, edges, distance);
    std::vector<Junction> expected;
    std::set<std::uint32_t> border;
    for (const std::uint32_t half_edge : edges.border)
      for (const std::uint32_t k : {0u, 1u})
        border.insert(unique_position[mesh.triangles[half_edge / 3][(half_edge + k) % 3]]);
    for (const std::uint32_t v : border) {
      for (const std::uint32_t half_edge : edges.border) {
        const Vec3 a = mesh.positions[mesh.triangles[half_edge / 3][half_edge % 3]];
        const Vec3 b = mesh.positions[mesh.triangles[half_edge / 3][(half_edge + 1) % 3]];
        const Vec3 p = mesh.positions[v];
        const double length = glm::length(b - a);
        const double along = glm::dot(p - a, b - a) / length;
        if (along > distance && along < length - distance &&
            glm::length(p - a - along * (b - a) / length) <= distance) {
          expected.push_back({v, half_edge});
          break;
        }
      }
    }
    EXPECT_EQ(found, expected);
    EXPECT_GT(found.size(), 3u);
  }
}

TEST(Clean, NonManifoldEdgesAreTold) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(report.non_manifold_edges, 1u);
  ASSERT_FALSE(report.spots.empty());
  EXPECT_EQ(report.spots[0].kind, SpotKind::non_manifold_edge);
  EXPECT_EQ(report.spots[0].at, Vec3(0, 0, 1));
  EXPECT_EQ(report.spots[0].length, 2);
  EXPECT_EQ(report.spots[0].size, 3u);
  EXPECT_FALSE(mesh.closed);
}

// Edges as check() counts them by another way.
TEST(Clean, EdgesAgreeWithCheck) {
  shapes::Random random(23);
  for (int round = 0; round < 50; ++round) {
    Mesh mesh;
    for (int i = 0; i < 12; ++i) mesh.positions.push_back(random.direction());
    for (int i = 0; i < 30; ++i) {
      const auto pick = [&] { return static_cast<std::uint32_t>(random() * 12); };
      mesh.triangles.push_back({pick(), pick(), pick()});
    }
    const Edges edges = edges_of(mesh, welded(mesh.positions));
    const MeshReport report = check(mesh);
    EXPECT_EQ(edges.border.size(), report.boundary_edges);
    EXPECT_EQ(edges.many.size(), report.non_manifold_edges);
    EXPECT_EQ(edges.misoriented, report.misoriented_edges);
    clean(mesh, {});
    EXPECT_EQ(mesh.closed, check(mesh).closed);
    EXPECT_EQ(check(mesh).non_finite + check(mesh).bad_lengths + check(mesh).bad_normals, 0u);
  }
}

// What reorders triangles keeps each of them.
TEST(Clean, ReorderingKeepsTrianglesAndDropsUnusedVertices) {
  Mesh mesh = shapes::sphere(30, 30);
  mesh.positions.insert(mesh.positions.begin(), Vec3(9));
  if (!mesh.normals.empty()) mesh.normals.insert(mesh.normals.begin(), Vec3(0, 0, 1));
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) ++v;
  const auto corners = [](const Mesh& m) {
    std::multiset<std::array<double, 9>> out;
    for (const Triangle& t : m.triangles) {
      // begins with the smallest corner
      std::array<std::array<double, 3>, 3> c;
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = m.positions[t[k]];
        c[k] = {p.x, p.y, p.z};
      }
      std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
      out.insert({c[0][0], c[0][1], c[0][2], c[1][0], c[1][1], c[1][2], c[2][0], c[2][1], c[2][2]});
    }
    return out;
  };
  const auto before = corners(mesh);
  const std::size_t vertices = mesh.positions.size();
  clean(mesh, {});
  EXPECT_EQ(corners(mesh), before);
  EXPECT_LT(mesh.positions.size(), vertices);
  // vertices in order of first use
  std::uint32_t next = 0;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
}

TEST(Clean, TheSameWhateverTheThreads) {
  Mesh mesh = bare(soup(shapes::sphere(150, 150)));
  append(mesh, sheet(30), Vec3(1, 0, 0), true);
  shapes::Random random(3);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 7)
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  CleanOptions options;
  options.tolerance = 1e-3;
  std::vector<Mesh> results;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    results.push_back(mesh);
    run_on_threads(Job({threads, {}}), [&] { clean(results.back(), options); });
  }
  EXPECT_TRUE(same(results[0], results[1]));
  EXPECT_TRUE(same(results[0], results[2]));
}

TEST(Clean, EmptyFlatTinyAndHuge) {
  Mesh none;
  EXPECT_EQ(clean(none, {}).triangles_after, 0u);
  EXPECT_FALSE(none.closed);
  Mesh point;
  point.positions.assign(3, Vec3(1));
  point.triangles = {{0, 1, 2}, {0, 1, 1}};
  EXPECT_EQ(clean(point, {}).degenerate, 2u);
  EXPECT_TRUE(point.positions.empty());
  for (const double size : {1e-30, 1e30}) {
    Mesh mesh = soup(bare(shapes::sphere(8, 8)));
    for (Vec3& p : mesh.positions) p *= size;
    const CleanReport report = clean(mesh, {});
    EXPECT_EQ(report.flipped, 0u);
    EXPECT_TRUE(mesh.closed);
    EXPECT_EQ(check(mesh).non_finite + check(mesh).bad_normals, 0u);
  }
}

// Many border edges and vertices in one place do not take forever.
TEST(Clean, CrowdsStayFast) {
  Mesh mesh;
  shapes::Random random(19);
  for (std::uint32_t i = 0; i < 60'000; ++i) {
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(1e-3 * random.direction());
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.positions.push_back({1e6, 0, 0});
  mesh.positions.push_back({1e6, 1e6, 0});
  mesh.positions.push_back({0, 1e6, 0});
  mesh.triangles.push_back({180'000, 180'001, 180'002});
  const CleanReport report = clean(mesh, {});
  EXPECT_EQ(report.components, 60'001u);
  EXPECT_EQ(check(mesh).non_finite, 0u);
}

}  // namespace
}  // namespace panwright::geometry::clean_test
