// Warnings about shapes against what their meshes turn out to be.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string_view>

#include "base/clock.h"
#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::shape_warnings_test {
namespace {

MeshReport mesh_report(const Shape& shape, double error) {
  DiagnosticLog log;
  TessellationOptions options;
  options.max_error = error;
  const auto mesh = tessellated(shape, options, {}, log);
  EXPECT_TRUE(mesh);
  return mesh ? check(*mesh) : MeshReport{};
}

std::multiset<Code> codes(const Shape& shape) {
  EXPECT_FALSE(problem_of(shape)) << problem_of(shape)->message;
  std::multiset<Code> out;
  for (const ShapeProblem& doubt : shape_warnings_of(shape)) out.insert(doubt.code);
  return out;
}
using Codes = std::multiset<Code>;

Polygons cube(double top = 1) {
  Polygons s;
  for (int i = 0; i < 8; ++i) s.positions.emplace_back(i & 1, i >> 1 & 1, (i >> 2) * top);
  for (const auto& f : {std::vector<std::uint32_t>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}})
    s.faces.push_back({f, {}});
  return s;
}

// Each shape with one size that goes from ordinary to next to nothing.
TEST(ShapeWarnings, ThinPartsAreThoseWithDegenerateTriangles) {
  const std::pair<const char*, std::function<Shape(double)>> shapes[] = {
      {"ring",
       [](double x) {
         return Disc{1, 1 - x, {}, {}};
       }},
      {"hole",
       [](double x) {
         return Disc{1, x, {}, {}};
       }},
      {"cone's tip", [](double x) { return Cone{1, x, 1, Caps::both, {}, {}}; }},
      {"cone's foot", [](double x) { return Cone{x, 1, 1, Caps::both, {}, {}}; }},
      {"needle",
       [](double x) {
         return Cylinder{x, 1, Caps::both, {}, {}};
       }},
      {"coin",
       [](double x) {
         return Cylinder{1, x, Caps::both, {}, {}};
       }},
      {"slice",
       [](double x) {
         return Cylinder{1, 1, Caps::both, {0, x}, {}};
       }},
      {"bevel",
       [](double x) {
         return Box{{1, 1, 1}, x, false};
       }},
      {"round bevel",
       [](double x) {
         return Box{{1, 1, 1}, x, true};
       }},
      {"between bevels",
       [](double x) {
         return Box{{1, 1, 1}, 0.5 - x, false};
       }},
      {"sheet",
       [](double x) {
         return Box{{1, 1, x}, 0, false};
       }},
      {"plane",
       [](double x) {
         return Plane{x, 1};
       }},
      {"dish",
       [](double x) {
         return Dish{1, 0.5, x, {}};
       }},
      {"wire",
       [](double x) {
         return Tube{{{0, 0, 0}, {0, 0, 1}}, x};
       }},
      {"hull",
       [](double x) {
         return Tube{{{0, 0, 0}, {0, 0, 1}}, 1, 1 - x};
       }},
      {"foil",
       [](double x) {
         return Extrude{{{0, 0}, {1, 0}, {0, 1}}, {}, x};
       }},
      {"beam",
       [](double x) {
         return Extrude{{{0, 0}, {x, 0}, {0, x}}, {}, 1};
       }},
      {"vase's foot",
       [](double x) {
         return Lathe{{{x, 0}, {1, 1}, {0.5, 2}}, false, {}, {}};
       }},
      {"band",
       [](double x) {
         return Sphere{1, {}, 0.1, 0.1 + x, {}};
       }},
      {"polygons", [](double x) { return cube(x); }},
  };
  for (const auto& [name, shape] : shapes) {
    EXPECT_EQ(codes(shape(1e-5)), Codes{}) << name;
    EXPECT_EQ(mesh_report(shape(1e-5), 1e-4).degenerate_triangles, 0u) << name;
    // edges of polygons lie further apart than 1e-9
    const double tiny = std::string_view(name) == "polygons" ? 2e-9 : 1e-10;
    EXPECT_TRUE(codes(shape(tiny)).contains(Code("W2006"))) << name;
    EXPECT_GT(mesh_report(shape(tiny), 1e-4).degenerate_triangles, 0u) << name;
  }
}

TEST(ShapeWarnings, OrdinaryShapesHaveNone) {
  for (const Shape& shape :
       {Shape(Sphere{}), Shape(Ellipsoid{{1, 2, 1e-6}}), Shape(Box{}), Shape(Cylinder{}),
        Shape(Cone{}), Shape(Cone{0, 1}), Shape(Disc{}), Shape(Torus{}), Shape(Dish{}),
        Shape(Plane{}), Shape(cube()), Shape(Extrude{{{0, 0}, {1, 0}, {0, 1}}, {}, 1}),
        Shape(Sphere{1, {}, 0, kPi / 2, {}})})
    EXPECT_EQ(codes(shape), Codes{}) << kind_name(shape);
}

// ---- lathes

Lathe lathe(std::vector<Vec2> profile, bool spline = false) {
  return {std::move(profile), spline, {}, {}};
}

TEST(ShapeWarnings, LathesThatAreInsideOut) {
  const std::vector<Vec2> profiles[] = {
      {{0, -1}, {1, 0}, {0, 1}},
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}},
      {{2, 0}, {3, 0}, {3, 1}, {2, 1}, {2, 0}},
  };
  for (const auto& forward : profiles)
    for (const bool spline : {false, true}) {
      const std::vector<Vec2> backward(forward.rbegin(), forward.rend());
      EXPECT_EQ(codes(lathe(forward, spline)), Codes{});
      EXPECT_EQ(codes(lathe(backward, spline)), Codes{Code("W2009")});
      EXPECT_GT(mesh_report(lathe(forward, spline), 1e-2).volume, 0);
      EXPECT_LT(mesh_report(lathe(backward, spline), 1e-2).volume, 0);
    }
  // an open one may be meant from either side
  EXPECT_EQ(codes(lathe({{1, 2}, {2, 1}, {1, 0}})), Codes{});
  // a double cone of volume 2π/3
  const auto doubt = shape_warnings_of(lathe({{0, 1}, {1, 0}, {0, -1}})).at(0);
  EXPECT_NE(doubt.message.find("-2.094 m³"), std::string::npos) << doubt.message;
}

TEST(ShapeWarnings, ProfilesThatRunThroughThemselves) {
  const auto crossing = [](const std::vector<Vec2>& points, bool spline = false) {
    const auto shape_warnings = shape_warnings_of(lathe(points, spline));
    if (shape_warnings.empty()) return std::string();
    EXPECT_EQ(shape_warnings[0].code, Code("W2019"));
    return shape_warnings[0].message;
  };
  EXPECT_EQ(crossing({{0, 0}, {2, 0}, {2, 2}, {1, -1}, {1, 3}, {0, 3}}),
            "the profile after point 3 crosses or touches its part after point 1");
  // back along itself, a loop that does, a touch, an eight
  EXPECT_NE(crossing({{0, 0}, {1, 0}, {0.5, 0}, {0.5, 1}}), "");
  EXPECT_NE(crossing({{1, 0}, {3, 0}, {3, 1}, {1, 1}, {1, -1}, {1, 0}}), "");
  EXPECT_NE(crossing({{1, 0}, {3, 0}, {3, 1}, {2, 0}, {1, 1}}), "");
  EXPECT_NE(crossing({{2, 0}, {3, 1}, {2, 1}, {3, 0}, {2, 0}}), "");
  EXPECT_EQ(crossing({{2, 0}, {3, 0}, {3, 1}, {2, 1}, {2, 0}}), "");
  // runs that meet on the axis, and along it
  EXPECT_EQ(crossing({{0, 0}, {1, 1}, {0, 2}, {1, 3}, {0, 4}}), "");
  EXPECT_EQ(crossing({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 3}, {1, 3}, {1, 4}, {0, 4}}), "");
  EXPECT_EQ(crossing({{0, 0}, {1, 1}, {0.5, 2}}, true), "");
  EXPECT_NE(crossing({{0.5, 0}, {2, 0}, {2, 2}, {1, -1}, {1, 3}, {0.5, 3}}, true), "");
}

// Against the comparison of every edge with every other, by another test for crossing.
TEST(ShapeWarnings, RandomProfiles) {
  std::mt19937 random(17);
  const auto crossed = [](const std::vector<Vec2>& p) {
    const auto solve = [](const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
      // a + s (b − a) = c + t (d − c)
      const Vec2 u = b - a, v = d - c, w = c - a;
      const double det = u.x * v.y - u.y * v.x;
      const double s = (w.x * v.y - w.y * v.x) / det, t = (w.x * u.y - w.y * u.x) / det;
      return s >= 0 && s <= 1 && t >= 0 && t <= 1;
    };
    for (std::size_t i = 0; i + 1 < p.size(); ++i)
      for (std::size_t k = i + 2; k + 1 < p.size(); ++k)
        if (solve(p[i], p[i + 1], p[k], p[k + 1])) return true;
    return false;
  };
  const auto number = [&] { return static_cast<double>(random()) * 0x1p-32; };
  int all = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<Vec2> points;
    double z = 0;
    const std::size_t count = 3 + random() % 12;
    for (std::size_t k = 0; k < count; ++k)
      points.emplace_back(0.1 + number(), z += number() - 0.2);
    const bool expected = crossed(points);
    all += expected;
    ASSERT_EQ(codes(lathe(points)).contains(Code("W2019")), expected) << i;
  }
  // both answers are common
  EXPECT_GT(all, 4000);
  EXPECT_LT(all, 16000);
}

TEST(ShapeWarnings, LongProfilesTakeLittleTime) {
  std::vector<Vec2> points;
  // to and fro over the whole height: every edge beside every other
  for (int i = 0; i < 20000; ++i) points.emplace_back(1 + 1e-4 * i, i % 2);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(codes(lathe(points)), Codes{});
  const double took = seconds_since(start);
  // a bound on growth, many times what is measured: 0.2 s
  EXPECT_LT(took, 5);
}

// ---- polygons

TEST(ShapeWarnings, PolygonsThatAreInsideOut) {
  Polygons s = cube();
  EXPECT_EQ(codes(s), Codes{});
  // one face turned round: its four edges
  std::reverse(s.faces[2].outline.begin(), s.faces[2].outline.end());
  EXPECT_EQ(codes(s), Codes{Code("W2007")});
  EXPECT_NE(shape_warnings_of(s)[0].message.find("at 4 edges"), std::string::npos);
  EXPECT_EQ(mesh_report(s, 1e-3).misoriented_edges, 4u);
  // all of them
  s = cube();
  for (auto& face : s.faces) std::reverse(face.outline.begin(), face.outline.end());
  EXPECT_EQ(codes(s), Codes{Code("W2009")});
  EXPECT_NE(shape_warnings_of(s)[0].message.find("-1 m³"), std::string::npos);
  EXPECT_LT(mesh_report(s, 1e-3).volume, 0);
  // an open one encloses nothing
  s.faces.pop_back();
  EXPECT_EQ(codes(s), Codes{});
  // nor does a sheet with two sides
  Polygons sheet;
  sheet.positions = {{0, 0, 7}, {1, 0, 7.3}, {1, 1, 7.9}};
  sheet.faces = {{{0, 1, 2}, {}}, {{2, 1, 0}, {}}};
  EXPECT_EQ(codes(sheet), Codes{});
  // a single face is nobody's neighbour
  sheet.faces.pop_back();
  EXPECT_EQ(codes(sheet), Codes{});
}

// A square frame far from the origin, whose holes run either way.
TEST(ShapeWarnings, PolygonsWithHoles) {
  for (const bool turned : {false, true})
    for (const bool inside_out : {false, true}) {
      Polygons s;
      for (const double z : {0.0, 1.0})
        for (const double half : {2.0, 1.0})
          for (const Vec2& p : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
            s.positions.emplace_back(1000 + half * p.x, half * p.y, z - 300);
      // bottom and top, then walls outside and inside
      s.faces = {{{3, 2, 1, 0}, {{4, 5, 6, 7}}}, {{8, 9, 10, 11}, {{15, 14, 13, 12}}}};
      for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t k = (i + 1) % 4;
        s.faces.push_back({{i, k, 8 + k, 8 + i}, {}});
        s.faces.push_back({{4 + k, 4 + i, 12 + i, 12 + k}, {}});
      }
      if (turned)
        for (auto& face : s.faces)
          for (auto& hole : face.holes) std::reverse(hole.begin(), hole.end());
      if (inside_out)
        for (auto& face : s.faces) std::reverse(face.outline.begin(), face.outline.end());
      EXPECT_EQ(codes(s), inside_out ? Codes{Code("W2009")} : Codes{});
      if (inside_out) {
        EXPECT_NE(shape_warnings_of(s)[0].message.find("-12 m³"), std::string::npos)
            << shape_warnings_of(s)[0].message;
      }
    }
}

}  // namespace
}  // namespace panwright::geometry::shape_warnings_test
