// Meshes and exact shapes of bodies that OpenCASCADE builds, against closed forms.

#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Ax1.hxx>

#include <algorithm>
#include <cmath>
#include <functional>

#include "geometry/mesh/check.h"
#include "importers/step/internal/bodies.h"

namespace panwright::importers::step::bodies_test {
namespace {

// Metres; negative inside.
using Distance = std::function<double(const Vec3&)>;

double sphere(const Vec3& p, double radius) { return glm::length(p) - radius; }

// about z, from −h/2 to h/2: of a point near the surface
double cylinder(const Vec3& p, double radius, double height) {
  const double r = std::hypot(p.x, p.y) - radius;
  const double z = std::abs(p.z) - height / 2;
  return std::max(r, z);
}

// from radius `bottom` at −h/2 to `top` at h/2
double cone(const Vec3& p, double bottom, double top, double height) {
  const double slope = (bottom - top) / height;
  const double r = std::hypot(p.x, p.y) - (0.5 * (bottom + top) - slope * p.z);
  return std::max(r / std::sqrt(1 + slope * slope), std::abs(p.z) - height / 2);
}

double torus(const Vec3& p, double radius, double tube) {
  return std::hypot(std::hypot(p.x, p.y) - radius, p.z) - tube;
}

double box(const Vec3& p, const Vec3& size, double round) {
  const Vec3 q = glm::abs(p) - 0.5 * size + Vec3(round);
  return glm::length(glm::max(q, Vec3(0))) + std::min(std::max(q.x, std::max(q.y, q.z)), 0.0) -
         round;
}

TopoDS_Shape moved(const TopoDS_Shape& shape, const gp_Trsf& transform) {
  return BRepBuilderAPI_Transform(shape, transform, Standard_True).Shape();
}

gp_Trsf shift(double x, double y, double z) {
  gp_Trsf out;
  out.SetTranslation(gp_Vec(x, y, z));
  return out;
}

// Of the test's sizes, in millimetres: 1000 is a metre.
TopoDS_Shape filleted_box(double x, double y, double z, double radius) {
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(gp_Pnt(-x / 2, -y / 2, -z / 2), x, y, z).Shape();
  BRepFilletAPI_MakeFillet fillet(block);
  for (TopExp_Explorer at(block, TopAbs_EDGE); at.More(); at.Next())
    fillet.Add(radius, TopoDS::Edge(at.Current()));
  return fillet.Shape();
}

struct Case {
  const char* name;
  TopoDS_Shape body;
  Distance distance;
  double area;
  double volume;
};

std::vector<Case> cases() {
  const double slant = std::sqrt(4 + 1.0);
  const double a = 0.6;  // of the filleted box, between the rounded edges: 0.8, 1.0, 1.2 less 0.2
  return {
      {"sphere", BRepPrimAPI_MakeSphere(1000).Shape(), [](const Vec3& p) { return sphere(p, 1); },
       4 * kPi, 4 * kPi / 3},
      {"cylinder", moved(BRepPrimAPI_MakeCylinder(1000, 2000).Shape(), shift(0, 0, -1000)),
       [](const Vec3& p) { return cylinder(p, 1, 2); }, 6 * kPi, 2 * kPi},
      {"cone", moved(BRepPrimAPI_MakeCone(1000, 0, 2000).Shape(), shift(0, 0, -1000)),
       [](const Vec3& p) { return cone(p, 1, 0, 2); }, kPi * (1 + slant), 2 * kPi / 3},
      {"torus", BRepPrimAPI_MakeTorus(1000, 300).Shape(),
       [](const Vec3& p) { return torus(p, 1, 0.3); }, 4 * kPi * kPi * 0.3, 2 * kPi * kPi * 0.09},
      {"filleted box", filleted_box(800, 1000, 1200, 100),
       [](const Vec3& p) {
         return box(p, {0.8, 1, 1.2}, 0.1);
       },
       2 * (a * 0.8 + 0.8 * 1 + a * 1) + 2 * kPi * 0.1 * (a + 0.8 + 1) + 4 * kPi * 0.01,
       a * 0.8 * 1 + 2 * 0.1 * (a * 0.8 + 0.8 * 1 + a * 1) + kPi * 0.01 * (a + 0.8 + 1) +
           4 * kPi / 3 * 0.001},
  };
}

constexpr double kDeflection = 1e-3;  // metres

geometry::Mesh mesh_of(const TopoDS_Shape& body, double deflection = kDeflection) {
  const Meshed out = meshed(body, {}, deflection);
  EXPECT_TRUE(out.lost.empty());
  EXPECT_EQ(out.patches.size(), 1u);
  return out.patches.empty() ? geometry::Mesh{} : *out.patches[0].mesh;
}

TEST(StepBodies, MeshesLieAsCloseAsAsked) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const geometry::Mesh mesh = mesh_of(c.body);
    double off = 0;
    for (const Vec3& p : mesh.positions) off = std::max(off, std::abs(c.distance(p)));
    EXPECT_LE(off, 1e-12);  // measured 4.5e-16
    double furthest = 0;
    constexpr int kParts = 8;
    for (const geometry::Triangle& t : mesh.triangles)
      for (int i = 0; i <= kParts; ++i)
        for (int k = 0; i + k <= kParts; ++k) {
          const Vec3 p = (double(i) * mesh.positions[t[0]] + double(k) * mesh.positions[t[1]] +
                          double(kParts - i - k) * mesh.positions[t[2]]) /
                         double(kParts);
          furthest = std::max(furthest, std::abs(c.distance(p)));
        }
    EXPECT_LE(furthest, kDeflection);
    EXPECT_GT(furthest, 0.2 * kDeflection);
    RecordProperty(c.name, std::to_string(furthest / kDeflection));
  }
}

TEST(StepBodies, MeshesAreClosedWithAreaAndVolume) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const geometry::MeshReport report = geometry::check(mesh_of(c.body));
    EXPECT_TRUE(report.closed);
    // between two surfaces a deflection apart
    EXPECT_NEAR(report.volume, c.volume, c.area * kDeflection);
    EXPECT_LT(report.volume, c.volume + 1e-12 * c.volume + (c.name[0] == 't' ? c.area * 1e-4 : 0));
    EXPECT_NEAR(report.area, c.area, 2e-3 * c.area);  // measured 1.6e-3, of the sphere
  }
}

// The outward normals of all surfaces that a point of a body lies on.
using Normals = std::function<std::vector<Vec3>(const Vec3&)>;

Vec3 radial(const Vec3& p) { return glm::normalize(Vec3(p.x, p.y, 0)); }

TEST(StepBodies, NormalsAreThoseOfTheSurface) {
  const Vec3 up(0, 0, 1);
  const Normals normals[] = {
      [](const Vec3& p) { return std::vector<Vec3>{glm::normalize(p)}; },
      [&](const Vec3& p) {
        return std::vector<Vec3>{radial(p), up, -up};
      },
      [&](const Vec3& p) {
        return std::vector<Vec3>{glm::normalize(radial(p) + 0.5 * up), -up};
      },
      [](const Vec3& p) { return std::vector<Vec3>{glm::normalize(p - radial(p))}; },
      // where flat and round faces meet they have one normal
      [](const Vec3& p) {
        const Vec3 inner = Vec3(0.3, 0.4, 0.5);
        return std::vector<Vec3>{glm::normalize(p - glm::clamp(p, -inner, inner))};
      },
  };
  const auto all = cases();
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(all[i].name);
    const geometry::Mesh mesh = mesh_of(all[i].body);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    double off = 0;
    double turned = 0;
    for (const geometry::Triangle& t : mesh.triangles) {
      const Vec3 flat = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                   mesh.positions[t[2]] - mesh.positions[t[0]]);
      for (const std::uint32_t k : t) {
        turned = std::max(turned, angle_between(flat, mesh.normals[k]));
        const Vec3 p = mesh.positions[k];
        if (glm::length(p - up) < 1e-9 && i == 2) continue;  // the tip has all of them
        double nearest = 1;
        for (const Vec3& n : normals[i](p))
          nearest = std::min(nearest, glm::length(n - mesh.normals[k]));
        off = std::max(off, nearest);
      }
    }
    EXPECT_LE(off, 1e-9);     // measured below 1e-11
    EXPECT_LE(turned, 0.35);  // the angle between neighbouring chords
  }
}

TEST(StepBodies, PatchesOfOtherColorsShareTheirBorder) {
  const TopoDS_Shape body = filleted_box(800, 1000, 1200, 100);
  std::vector<std::int32_t> colors;
  for (TopExp_Explorer at(body, TopAbs_FACE); at.More(); at.Next())
    colors.push_back(colors.size() % 3 == 0 ? 1 : -1);
  const Meshed out = meshed(body, colors, kDeflection);
  ASSERT_EQ(out.patches.size(), 2u);
  EXPECT_EQ(out.patches[0].color, -1);
  EXPECT_EQ(out.patches[1].color, 1);
  // together they are closed, point for point
  geometry::Mesh all = *out.patches[0].mesh;
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  const geometry::Mesh& other = *out.patches[1].mesh;
  all.positions.insert(all.positions.end(), other.positions.begin(), other.positions.end());
  all.normals.insert(all.normals.end(), other.normals.begin(), other.normals.end());
  for (const geometry::Triangle& t : other.triangles)
    all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  EXPECT_FALSE(geometry::check(other).closed);
  EXPECT_TRUE(geometry::check(all).closed);
}

TEST(StepBodies, MirroredBodiesFaceOutwards) {
  const TopoDS_Shape body =
      BRepAlgoAPI_Fuse(BRepPrimAPI_MakeBox(1000, 500, 300).Shape(),
                       moved(BRepPrimAPI_MakeCylinder(100, 700).Shape(), shift(800, 300, 0)))
          .Shape();
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)));
  const double volume = 0.15 + kPi * 0.01 * 0.4;
  for (const TopoDS_Shape& each : {body, moved(body, mirror)}) {
    const geometry::Mesh mesh = mesh_of(each);
    const geometry::MeshReport report = geometry::check(mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_NEAR(report.volume, volume, kDeflection * 0.3);
    for (const geometry::Triangle& t : mesh.triangles) {
      const Vec3 flat = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                   mesh.positions[t[2]] - mesh.positions[t[0]]);
      for (const std::uint32_t i : t) EXPECT_GT(glm::dot(flat, mesh.normals[i]), 0);
    }
  }
}

TEST(StepBodies, FinerMeshesComeCloserAndCostWhatIsExpected) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(1000).Shape();
  const double coarse = static_cast<double>(mesh_of(ball, 1e-2).triangles.size());
  const double fine = static_cast<double>(mesh_of(ball, 1e-3).triangles.size());
  // triangles go with the inverse of the deflection
  EXPECT_NEAR(fine / coarse, 10, 4);
  for (const double deflection : {1e-2, 1e-3}) {
    const double ratio = static_cast<double>(mesh_of(ball, deflection).triangles.size()) /
                         expected_triangles(ball, deflection);
    EXPECT_GT(ratio, 1);
    EXPECT_LT(ratio, 8);
  }
}

// ---- exact shapes

TopoDS_Shape cut(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return TopExp_Explorer(BRepAlgoAPI_Cut(a, b).Shape(), TopAbs_SOLID).Current();
}

gp_Trsf somewhere() {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), 0.7);
  return shift(100, -200, 300) * turn;
}

template <typename T>
T exact_as(const TopoDS_Shape& body, const Distance& distance) {
  const auto exact = exact_of(body);
  EXPECT_TRUE(exact);
  if (!exact || !std::holds_alternative<T>(exact->shape)) {
    ADD_FAILURE() << "another shape";
    return {};
  }
  // the body's own points lie on the shape, where it stands
  const Mat4 shape_from_body = glm::inverse(exact->body_from_shape);
  double off = 0;
  for (const Vec3& p : mesh_of(body, 1e-2).positions)
    off = std::max(off, std::abs(distance(Vec3(shape_from_body * Vec4(p, 1)))));
  EXPECT_LE(off, 1e-12);  // measured 6e-16
  return std::get<T>(exact->shape);
}

TEST(StepExact, KnowsShapesWhereverTheyStand) {
  for (const gp_Trsf& at : {gp_Trsf(), somewhere()}) {
    const auto ball = exact_as<geometry::Sphere>(moved(BRepPrimAPI_MakeSphere(500).Shape(), at),
                                                 [](const Vec3& p) { return sphere(p, 0.5); });
    EXPECT_NEAR(ball.radius, 0.5, 1e-15);
    const auto rod =
        exact_as<geometry::Cylinder>(moved(BRepPrimAPI_MakeCylinder(100, 700).Shape(), at),
                                     [](const Vec3& p) { return cylinder(p, 0.1, 0.7); });
    EXPECT_NEAR(rod.radius, 0.1, 1e-15);
    EXPECT_NEAR(rod.height, 0.7, 1e-15);
    const auto tip = exact_as<geometry::Cone>(
        moved(BRepPrimAPI_MakeCone(400, 0, 700).Shape(), at), [](const Vec3& p) {
          return std::min(std::abs(cone(p, 0.4, 0, 0.7)), std::abs(cone(p, 0, 0.4, 0.7)));
        });
    EXPECT_NEAR(std::max(tip.bottom_radius, tip.top_radius), 0.4, 1e-15);
    EXPECT_EQ(std::min(tip.bottom_radius, tip.top_radius), 0);
    EXPECT_NEAR(tip.height, 0.7, 1e-15);
    const auto frustum = exact_as<geometry::Cone>(
        moved(BRepPrimAPI_MakeCone(400, 100, 700).Shape(), at), [](const Vec3& p) {
          return std::min(std::abs(cone(p, 0.4, 0.1, 0.7)), std::abs(cone(p, 0.1, 0.4, 0.7)));
        });
    EXPECT_NEAR(frustum.bottom_radius + frustum.top_radius, 0.5, 1e-15);
    const auto ring = exact_as<geometry::Torus>(moved(BRepPrimAPI_MakeTorus(500, 100).Shape(), at),
                                                [](const Vec3& p) { return torus(p, 0.5, 0.1); });
    EXPECT_NEAR(ring.tube_radius, 0.1, 1e-15);
    const auto block = exact_as<geometry::Box>(
        moved(BRepPrimAPI_MakeBox(200, 300, 400).Shape(), at), [](const Vec3& p) {
          return box(p, {0.2, 0.3, 0.4}, 0);
        });
    EXPECT_NEAR(glm::length(block.size - Vec3(0.2, 0.3, 0.4)), 0, 1e-15);
    const TopoDS_Shape pipe_body =
        cut(BRepPrimAPI_MakeCylinder(100, 700).Shape(), BRepPrimAPI_MakeCylinder(80, 700).Shape());
    const auto pipe = exact_as<geometry::Tube>(moved(pipe_body, at), [](const Vec3& p) {
      return std::min(std::abs(cylinder(p, 0.1, 0.7)), std::max(0.08 - std::hypot(p.x, p.y), 0.0) +
                                                           std::abs(std::hypot(p.x, p.y) - 0.08));
    });
    EXPECT_NEAR(pipe.radius, 0.1, 1e-15);
    EXPECT_NEAR(pipe.inner_radius, 0.08, 1e-15);
  }
}

TEST(StepExact, LeavesWhatIsCutOrHollow) {
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(200, 300, 400).Shape();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(100).Shape();
  EXPECT_FALSE(exact_of(cut(ball, block)));
  EXPECT_FALSE(exact_of(cut(ball, BRepPrimAPI_MakeSphere(50).Shape())));  // a void
  EXPECT_FALSE(exact_of(cut(block, BRepPrimAPI_MakeBox(100, 100, 100).Shape())));
  EXPECT_FALSE(exact_of(cut(block, BRepPrimAPI_MakeCylinder(20, 400).Shape())));
  EXPECT_FALSE(exact_of(cut(BRepPrimAPI_MakeCylinder(100, 700).Shape(), block)));
  EXPECT_FALSE(exact_of(cut(BRepPrimAPI_MakeTorus(300, 100).Shape(), block)));
  EXPECT_FALSE(exact_of(BRepPrimAPI_MakeCylinder(100, 700, kPi).Shape()));
  EXPECT_FALSE(exact_of(BRepPrimAPI_MakeSphere(100, kPi).Shape()));
  EXPECT_FALSE(exact_of(filleted_box(800, 1000, 1200, 100)));
  // a shell encloses nothing
  EXPECT_FALSE(exact_of(TopExp_Explorer(block, TopAbs_SHELL).Current()));
}

}  // namespace
}  // namespace panwright::importers::step::bodies_test
