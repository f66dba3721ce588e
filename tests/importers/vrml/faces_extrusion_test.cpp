#define GLM_ENABLE_EXPERIMENTAL
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtx/quaternion.hpp>

#include "geometry/mesh/check.h"
#include "importers/vrml/internal/faces.h"

namespace panwright::importers::vrml::faces_extrusion_test {
namespace {

using geometry::Mesh;
using geometry::MeshReport;

using Numbers = std::vector<double>;

// The standard's default: a square of side 2, counter-clockwise seen from +y.
const Numbers kSquare{1, 1, 1, -1, -1, -1, -1, 1, 1, 1};
const Numbers kUp{0, 0, 0, 0, 1, 0};

struct Made {
  Mesh mesh;
  ListProblems problems;
  MeshReport report;
};

Made made(const Extrusion& extrusion, const FaceOptions& options = {}) {
  Made out;
  out.mesh = mesh_of(extrusion, options, out.problems);
  out.report = check(out.mesh);
  EXPECT_EQ(out.report.bad_lengths, 0u);
  EXPECT_EQ(out.report.bad_indices, 0u);
  EXPECT_EQ(out.report.non_finite, 0u);
  EXPECT_EQ(out.report.bad_normals, 0u);
  return out;
}

Extrusion extrusion(const Numbers& section, const Numbers& spine) {
  Extrusion e;
  e.cross_section = section;
  e.spine = spine;
  return e;
}

// A regular polygon, counter-clockwise seen from +y (x to the right, z down).
Numbers ring(int n, double radius) {
  Numbers section;
  for (int i = 0; i <= n; ++i) {
    const double a = i == n ? 0 : 2 * kPi * i / n;
    section.push_back(radius * std::cos(a));
    section.push_back(-radius * std::sin(a));
  }
  return section;
}

double ring_area(int n, double radius) { return 0.5 * n * radius * radius * std::sin(2 * kPi / n); }

TEST(Extrusions, TheDefaultIsABox) {
  const Made box = made(extrusion(kSquare, kUp));
  EXPECT_TRUE(box.problems.empty());
  EXPECT_EQ(box.mesh.triangles.size(), 12u);
  EXPECT_TRUE(box.report.closed);
  EXPECT_DOUBLE_EQ(box.report.volume, 4);
  for (const Vec3& p : box.mesh.positions) {
    EXPECT_EQ(std::fabs(p.x), 1);
    EXPECT_EQ(std::fabs(p.z), 1);
    EXPECT_TRUE(p.y == 0 || p.y == 1);
  }
  Extrusion inside_out = extrusion(kSquare, kUp);
  inside_out.ccw = false;
  EXPECT_DOUBLE_EQ(made(inside_out).report.volume, -4);
}

TEST(Extrusions, CapsAtEitherEnd) {
  for (const bool begin : {false, true}) {
    for (const bool end : {false, true}) {
      Extrusion e = extrusion(kSquare, kUp);
      e.begin_cap = begin;
      e.end_cap = end;
      const Mesh mesh = made(e).mesh;
      EXPECT_EQ(mesh.triangles.size(), 8u + 2 * begin + 2 * end);
      double low = 0, high = 0;  // of facets that look along y
      for (const Vec3& n : mesh.normals) {
        low = std::min(low, n.y);
        high = std::max(high, n.y);
      }
      EXPECT_EQ(low, begin ? -1 : 0);
      EXPECT_EQ(high, end ? 1 : 0);
    }
  }
}

TEST(Extrusions, AnOpenSectionIsClosedByItsCapsAlone) {
  const Numbers section{1, 1, 1, -1, -1, -1};
  const Made open = made(extrusion(section, kUp));
  EXPECT_EQ(open.mesh.triangles.size(), 2u * 2 + 2);
  EXPECT_DOUBLE_EQ(open.report.area, 2 + 2 + 2 + 2);
  EXPECT_FALSE(open.report.closed);
  const Numbers line{1, 1, -1, 1};
  EXPECT_EQ(made(extrusion(line, kUp)).mesh.triangles.size(), 2u);
}

TEST(Extrusions, StraightSpinesTurnTheSectionTheShortestWay) {
  const Numbers section{3, 1, 3, -2, -1, -2, -1, 1, 3, 1};
  const Vec3 directions[] = {{0, 1, 0}, {1, 0, 0},   {-1, 0, 0}, {0, 0, 1},   {0, 0, -1},
                             {1, 2, 3}, {-3, -1, 2}, {1, 1, 0},  {0, -1, -1}, {2, -7, 1}};
  for (const Vec3& direction : directions) {
    const Vec3 y = glm::normalize(direction);
    // two points, and more of them on one line
    for (const int n : {2, 5}) {
      Numbers spine;
      for (int i = 0; i < n; ++i) {
        const Vec3 p = Vec3(5, -3, 2) + y * (7.0 * i / (n - 1));
        spine.insert(spine.end(), {p.x, p.y, p.z});
      }
      const Made bar = made(extrusion(section, spine));
      EXPECT_TRUE(bar.report.closed);
      EXPECT_NEAR(bar.report.volume, 12 * 7, 1e-11);  // 5e-13 was seen
      // the turn by quaternions that takes +y there, applied to the section's corners
      const Quat turn = glm::rotation(Vec3(0, 1, 0), y);
      double worst = 0;
      for (std::size_t j = 0; j < section.size() / 2; ++j) {
        const Vec3 expected = Vec3(5, -3, 2) + turn * Vec3(section[2 * j], 0, section[2 * j + 1]);
        double nearest = 1e300;
        for (const Vec3& p : bar.mesh.positions)
          nearest = std::min(nearest, glm::length(p - expected));
        worst = std::max(worst, nearest);
      }
      EXPECT_LT(worst, 1e-14) << y.x << " " << y.y << " " << y.z;  // 2e-15 was seen
    }
  }
}

TEST(Extrusions, AlmostStraightUpOrDownTheAxisOfTheTurnStays) {
  // the turn about `axis` leaves the corner there where it is
  for (const double y : {1.0, -1.0}) {
    for (const double lean : {1e-3, 1e-9, 1e-15}) {
      const Vec3 axis = glm::normalize(Vec3(2, 0, -1));
      const Vec3 spine_end = Vec3(axis.z, 0, -axis.x) * lean + Vec3(0, y, 0);
      const Numbers spine{0, 0, 0, spine_end.x, spine_end.y, spine_end.z};
      const Numbers section{axis.x, axis.z, -axis.z, axis.x, -axis.x, -axis.z, axis.x, axis.z};
      const Mesh mesh = made(extrusion(section, spine)).mesh;
      double nearest = 1e300;
      for (const Vec3& p : mesh.positions) nearest = std::min(nearest, glm::length(p - axis));
      EXPECT_LT(nearest, 3e-16) << y << " " << lean;  // 1.6e-16 was seen
    }
  }
}

TEST(Extrusions, ASpineThatRunsDown) {
  // half a turn about z: x changes its sign, z does not
  const Numbers section{1, 2, 1, -1, -3, -1, -3, 2, 1, 2};
  const Numbers spine{0, 0, 0, 0, -1, 0};
  const Made down = made(extrusion(section, spine));
  EXPECT_DOUBLE_EQ(down.report.volume, 12);
  for (const Vec3& p : down.mesh.positions) {
    EXPECT_TRUE(p.x == -1 || p.x == 3) << p.x;
    EXPECT_TRUE(p.z == 2 || p.z == -1) << p.z;
  }
}

// A circle along a circle: corners stand on the torus, and as chords of all radii turn by the same
// angle, the volume is n·A·R·sin(2π/n).
TEST(Extrusions, ACircleAlongACircleIsATorus) {
  const int m = 24, n = 40;
  const double r = 0.7, big = 3;
  const Numbers section = ring(m, r);
  Numbers spine;
  for (int i = 0; i <= n; ++i) {
    const double a = i == n ? 0 : 2 * kPi * i / n;
    spine.insert(spine.end(), {big * std::cos(a), 4, big * std::sin(a)});
  }
  Extrusion e = extrusion(section, spine);
  e.crease_angle = 1;
  const Made torus = made(e);
  EXPECT_EQ(torus.mesh.triangles.size(), 2u * m * n);  // no caps
  EXPECT_TRUE(torus.report.closed);
  EXPECT_NEAR(torus.report.volume, n * ring_area(m, r) * big * std::sin(2 * kPi / n),
              1e-12);  // 8e-14 was seen
  double off = 0, tilt = 0;
  for (std::size_t v = 0; v < torus.mesh.positions.size(); ++v) {
    const Vec3 p = torus.mesh.positions[v] - Vec3(0, 4, 0);
    const double around = std::hypot(p.x, p.z);
    off = std::max(off, std::fabs(std::hypot(around - big, p.y) - r));
    const Vec3 normal = (p - Vec3(p.x, 0, p.z) * (big / around)) / r;
    tilt = std::max(tilt, angle_between(normal, torus.mesh.normals[v]));
  }
  EXPECT_LT(off, 1e-15);           // 5e-16 was seen
  EXPECT_LT(tilt, 0.4 * kDegree);  // of facets 15 degrees wide: 0.374 was seen
}

TEST(Extrusions, TheTorusOfOtherPlanesAndSensesIsNotInsideOut) {
  const int m = 12, n = 20;
  const Numbers section = ring(m, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sense : {1.0, -1.0}) {
      Numbers spine;
      for (int i = 0; i <= n; ++i) {
        const double a = i == n ? 0 : sense * 2 * kPi * i / n;
        Vec3 p(0);
        p[(axis + 1) % 3] = 2 * std::cos(a);
        p[(axis + 2) % 3] = 2 * std::sin(a);
        spine.insert(spine.end(), {p.x, p.y, p.z});
      }
      const Made torus = made(extrusion(section, spine));
      EXPECT_TRUE(torus.report.closed);
      EXPECT_NEAR(torus.report.volume, n * ring_area(m, 0.5) * 2 * std::sin(2 * kPi / n), 1e-12);
    }
  }
}

// Along an S in one plane the axes across it turn over at the inflection; the standard flips them
// back. The plane's normal must stay a mirror of the pipe.
TEST(Extrusions, AnSDoesNotTwist) {
  Numbers spine;
  for (int i = 0; i <= 30; ++i) {
    const double t = 4 * kPi * i / 30;
    spine.insert(spine.end(), {t, std::sin(t), 0});
  }
  const Made pipe = made(extrusion(ring(8, 0.2), spine));
  EXPECT_TRUE(pipe.report.closed);
  EXPECT_GT(pipe.report.volume, 0);
  for (const Vec3& p : pipe.mesh.positions) {
    const bool mirrored = std::ranges::any_of(pipe.mesh.positions, [&](const Vec3& q) {
      return glm::length(q - Vec3(p.x, p.y, -p.z)) < 1e-14;
    });
    EXPECT_TRUE(mirrored);
  }
}

TEST(Extrusions, ScalesMakeAFrustum) {
  const Numbers scales{1, 1, 0.5, 0.5};
  Extrusion e = extrusion(kSquare, kUp);
  e.scales = scales;
  // h/3·(A + a + √(A·a))
  EXPECT_NEAR(made(e).report.volume, (4 + 1 + 2) / 3.0, 1e-15);
  const Numbers one{2, 3};
  e.scales = one;
  EXPECT_NEAR(made(e).report.volume, 24, 1e-14);
  const Numbers point{1, 1, 0, 0};
  e.scales = point;
  const Made pyramid = made(e);
  EXPECT_NEAR(pyramid.report.volume, 4 / 3.0, 1e-15);
  EXPECT_EQ(pyramid.mesh.triangles.size(), 12u);  // as the file has it, the flat ones too
}

TEST(Extrusions, OrientationsTurnSections) {
  const Numbers spine{0, 0, 0, 0, 1, 0, 0, 2, 0};
  const Numbers turns{0, 1, 0, 0.3, 0, 1, 0, 0.3, 0, 5, 0, 0.3};
  Extrusion e = extrusion(kSquare, spine);
  e.orientations = turns;
  const Made bar = made(e);
  EXPECT_NEAR(bar.report.volume, 8, 1e-14);
  // counter-clockwise about +y: the corner (1, 1) of x, z
  const Vec3 expected(std::cos(0.3) + std::sin(0.3), 0, std::cos(0.3) - std::sin(0.3));
  EXPECT_LT(glm::length(bar.mesh.positions[0] - expected), 1e-15);
  // one for all, and tilted about x: a sheared bar of the same volume over a slanted square
  const Numbers tilt{1, 0, 0, 0.5};
  e.orientations = tilt;
  EXPECT_NEAR(made(e).report.volume, 8 * std::cos(0.5), 1e-14);
}

TEST(Extrusions, ListsThatAreTooShortHoldTheirLast) {
  const Numbers spine{0, 0, 0, 0, 1, 0, 0, 2, 0};
  const Numbers scales{1, 1, 2, 2};
  Extrusion e = extrusion(kSquare, spine);
  e.scales = scales;
  const Made bar = made(e);
  ASSERT_EQ(bar.problems.size(), 1u);
  EXPECT_EQ(bar.problems[0].code, Code("W6114"));
  EXPECT_EQ(bar.problems[0].list, List::scales);
  EXPECT_NEAR(bar.report.volume, (4 + 16 + 8) / 3.0 + 16, 1e-13);
}

// Places that stand twice, spines that begin straight, turn back, or go nowhere.
TEST(Extrusions, SpinesThatGiveNoDirection) {
  const Numbers twice{0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0};
  EXPECT_NEAR(made(extrusion(kSquare, twice)).report.volume, 8, 1e-14);

  // straight at first, then a bend in the plane x y: the first sections take its axis
  const Numbers late{0, 0, 0, 0, 1, 0, 0, 2, 0, 1, 3, 0};
  const Made bent = made(extrusion(kSquare, late));
  EXPECT_TRUE(bent.report.closed);
  for (const Vec3& p : bent.mesh.positions) EXPECT_NEAR(std::fabs(p.z), 1, 1e-15);

  const Numbers back{0, 0, 0, 0, 2, 0, 0, 1, 0};
  EXPECT_EQ(made(extrusion(kSquare, back)).mesh.triangles.size(), 2u * 4 * 2 + 4);
  const Numbers back_bent{0, 0, 0, 1, 0, 0, 1, 2, 0, 1, 0, 0, 1, 0, 5};
  EXPECT_EQ(made(extrusion(kSquare, back_bent)).mesh.triangles.size(), 2u * 4 * 4 + 4);
  const Numbers there_and_back{0, 0, 0, 0, 2, 0, 0, 0, 0};
  EXPECT_EQ(made(extrusion(kSquare, there_and_back)).mesh.triangles.size(), 2u * 4 * 2);
  const Numbers nowhere{1, 2, 3, 1, 2, 3};
  EXPECT_EQ(made(extrusion(kSquare, nowhere)).mesh.triangles.size(), 12u);
  const Numbers nowhere_closed{1, 2, 3, 1, 2, 3, 1, 2, 3};
  EXPECT_EQ(made(extrusion(kSquare, nowhere_closed)).mesh.triangles.size(), 2u * 4 * 2);
}

// Seven digits make a straight spine a little crooked: it must not twist for that.
TEST(Extrusions, SpinesThatAreStraightButForTheirDigits) {
  Numbers spine;
  const Vec3 y = glm::normalize(Vec3(1, 2, 3));
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = y * (1.0 * i);
    spine.insert(spine.end(), {std::round(p.x * 1e7) / 1e7, std::round(p.y * 1e7) / 1e7,
                               std::round(p.z * 1e7) / 1e7});
  }
  const Made bar = made(extrusion(ring(12, 2), spine));
  EXPECT_NEAR(bar.report.volume, 19 * ring_area(12, 2), 1e-4);
}

TEST(Extrusions, TextureRunsAroundAndAlong) {
  const Numbers spine{0, 0, 0, 0, 1, 0, 0, 4, 0};
  Extrusion e = extrusion(kSquare, spine);
  EXPECT_TRUE(made(e).mesh.texcoords.empty());
  const Mesh mesh = made(e, {.texcoords = true}).mesh;
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    if (std::fabs(mesh.normals[v].y) > 0.5) {
      EXPECT_EQ(mesh.texcoords[v], (Vec2(p.x, p.z) + Vec2(1)) / 2.0);
    } else {
      EXPECT_DOUBLE_EQ(mesh.texcoords[v].y, p.y / 4);
      EXPECT_EQ(std::fmod(mesh.texcoords[v].x, 0.25), 0);
    }
  }
}

TEST(Extrusions, ConcaveSectionsHaveCapsOfTheirArea) {
  const Numbers section{2, 0, 1, -2, 0, -0.5, -1, -2, -2, 0, 2, 0};
  Extrusion e = extrusion(section, kUp);
  const Made w = made(e);
  EXPECT_TRUE(w.report.closed);
  EXPECT_DOUBLE_EQ(w.report.volume, 8.0 / 2 + 0.5);  // shoelace
}

TEST(Extrusions, TooLittleAndTooMuch) {
  const Numbers point{1, 1};
  EXPECT_TRUE(made(extrusion(point, kUp)).mesh.triangles.empty());
  const Numbers stop{0, 0, 0};
  const Made none = made(extrusion(kSquare, stop));
  ASSERT_EQ(none.problems.size(), 1u);
  EXPECT_EQ(none.problems[0].code, Code("W6114"));
  EXPECT_EQ(none.problems[0].list, List::spine);
  EXPECT_TRUE(made(extrusion({}, {})).mesh.triangles.empty());

  const Made many = made(extrusion(kSquare, kUp), {.max_triangles = 11});
  ASSERT_EQ(many.problems.size(), 1u);
  EXPECT_EQ(many.problems[0].code, Code("E6002"));
  const Numbers wide(200'000, 0.5), far(300'000, 0.5);
  const Made bomb = made(extrusion(wide, far));
  ASSERT_EQ(bomb.problems.size(), 1u);
  EXPECT_EQ(bomb.problems[0].code, Code("E6002"));
}

}  // namespace
}  // namespace panwright::importers::vrml::faces_extrusion_test
