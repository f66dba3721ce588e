// Forms: closed, oriented, as large as they should be, apart.
#include <gmock/gmock.h>

#include <algorithm>

#include "geometry/mesh/check.h"
#include "mli/form.h"
#include "tests/mli/sheet_support.h"

namespace panwright::mli::form_test {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using ::testing::HasSubstr;
using testing::recipe;
using testing::sheet_of;

Mesh mesh_of(const Sheet& sheet, const Form& form, std::size_t warnings = 0) {
  DiagnosticLog log;
  auto mesh = formed(sheet, form, log);
  EXPECT_TRUE(mesh.ok()) << to_text(log);
  EXPECT_EQ(log.warnings(), warnings) << to_text(log);
  return mesh ? std::move(*mesh) : Mesh{};
}

Sheet level(double width, double height, std::uint32_t xgrid) {
  return sheet_of(recipe(width, height, xgrid, {}));
}

Sheet crinkled(double width, double height, std::uint32_t xgrid, double slope) {
  Crease crease;
  crease.density = 200;
  crease.depth = 0.02;
  crease.length = 0.1;
  return sheet_of(recipe(width, height, xgrid, {crease, SlopeRms{slope}}, 3));
}

// Whether a segment goes through a triangle, ends apart from it: signs of volumes.
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto volume = [](const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
    return glm::dot(glm::cross(u - o, v - o), w - o);
  };
  const double from = volume(a, b, c, p), to = volume(a, b, c, q);
  if (!(from * to < 0)) return false;
  const double x = volume(p, q, a, b), y = volume(p, q, b, c), z = volume(p, q, c, a);
  return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

// Pairs of triangles without a common corner, of which one is pierced by the other's edge.
std::size_t intersections(const Mesh& mesh) {
  struct Item {
    double low, high;
    std::uint32_t t;
  };
  std::vector<Item> items;
  const auto corner = [&](std::uint32_t t, std::size_t k) {
    return mesh.positions[mesh.triangles[t][k]];
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const double x[3] = {corner(t, 0).x, corner(t, 1).x, corner(t, 2).x};
    items.push_back({std::min({x[0], x[1], x[2]}), std::max({x[0], x[1], x[2]}), t});
  }
  std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.low < b.low; });
  std::size_t count = 0;
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::size_t j = i + 1; j < items.size() && items[j].low <= items[i].high; ++j) {
      const std::uint32_t s = items[i].t, t = items[j].t;
      bool apart = false, share = false;
      for (int axis = 1; axis < 3; ++axis) {
        const auto [s0, s1] =
            std::minmax({corner(s, 0)[axis], corner(s, 1)[axis], corner(s, 2)[axis]});
        const auto [t0, t1] =
            std::minmax({corner(t, 0)[axis], corner(t, 1)[axis], corner(t, 2)[axis]});
        apart = apart || s1 < t0 || t1 < s0;
      }
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          share = share || glm::length(corner(s, a) - corner(t, b)) < 1e-12;
      if (apart || share) continue;
      bool hit = false;
      for (std::size_t k = 0; k < 3; ++k)
        hit =
            hit ||
            pierces(corner(s, k), corner(s, (k + 1) % 3), corner(t, 0), corner(t, 1),
                    corner(t, 2)) ||
            pierces(corner(t, k), corner(t, (k + 1) % 3), corner(s, 0), corner(s, 1), corner(s, 2));
      count += hit;
    }
  return count;
}

// Every edge is shared by two triangles but for `boundary`; none is turned.
void expect_sound(const Mesh& mesh, std::size_t boundary) {
  const geometry::MeshReport report = geometry::check(mesh);
  EXPECT_EQ(report.boundary_edges, boundary);
  EXPECT_EQ(report.non_manifold_edges, 0u);
  EXPECT_EQ(report.misoriented_edges, 0u);
  EXPECT_EQ(report.degenerate_triangles, 0u);
  EXPECT_EQ(report.non_finite, 0u);
  EXPECT_EQ(report.bad_indices, 0u);
  EXPECT_EQ(mesh.texcoords.size(), mesh.positions.size());
  EXPECT_EQ(report.closed, boundary == 0);
  EXPECT_EQ(mesh.closed, boundary == 0);
}

constexpr double kAround = 2 * kPi * 0.3;

TEST(Form, LevelSheetsHaveTheAreaOfTheirForm) {
  const Sheet sheet = level(2.4, 1.6, 240);  // cells of 10 mm
  const double cell = 0.01;
  expect_sound(mesh_of(sheet, Flat{}), 2 * (240 + 160));
  EXPECT_NEAR(geometry::check(mesh_of(sheet, Flat{})).area, 2.4 * 1.6, 1e-12);

  // chords of n steps: areas of prisms and rings of polygons
  const auto around = [&](double widest) { return std::round(2 * kPi * widest / cell); };
  const auto ring = [&](double n, double r, double s, double slant_height) {
    // two trapezoids' parallel sides: chords of both radii
    const double a = 2 * r * std::sin(kPi / n), b = 2 * s * std::sin(kPi / n);
    const double inward = (r - s) * std::cos(kPi / n);
    return n * (a + b) / 2 * std::sqrt(inward * inward + slant_height * slant_height);
  };
  const Tube tube{0.3, 0.8, 0.05};
  double n = around(0.35);
  const Mesh tubular = mesh_of(sheet, tube);
  expect_sound(tubular, static_cast<std::size_t>(2 * n));
  EXPECT_NEAR(geometry::check(tubular).area, ring(n, 0.3, 0.3, 0.8) + 2 * ring(n, 0.35, 0.3, 0),
              1e-9);

  const Cone cone{0.3, 0.1, 0.5, 0.04};
  n = around(0.34);
  const Mesh conical = mesh_of(sheet, cone);
  expect_sound(conical, static_cast<std::size_t>(2 * n));
  EXPECT_NEAR(geometry::check(conical).area,
              ring(n, 0.3, 0.1, 0.5) + ring(n, 0.34, 0.3, 0) + ring(n, 0.14, 0.1, 0), 1e-9);
  const Mesh pointed = mesh_of(sheet, Cone{0.3, 0, 0.5, 0.04});
  expect_sound(pointed, static_cast<std::size_t>(n));
  EXPECT_NEAR(geometry::check(pointed).area, ring(n, 0.3, 0, 0.5) + ring(n, 0.34, 0.3, 0), 1e-9);

  const Mesh disc = mesh_of(sheet, Disc{0.3, 0.05});
  n = around(0.3);
  expect_sound(disc, static_cast<std::size_t>(n));
  EXPECT_NEAR(geometry::check(disc).area, ring(n, 0.3, 0, 0) + ring(n, 0.3, 0.3, 0.05), 1e-9);

  const Mesh box = mesh_of(sheet, Box{{0.6, 0.4, 0.5}, 0.02});
  expect_sound(box, 0);
  EXPECT_NEAR(geometry::check(box).area, 2 * (0.24 + 0.3 + 0.2), 1e-12);
  EXPECT_NEAR(geometry::check(box).volume, 0.12, 1e-12);
}

// Heights push the surface out of the body by as much.
TEST(Form, LiesOutsideItsBody) {
  const double lift = 0.01;
  const Sheet sheet = sheet_of(recipe(2.4, 1.6, 240, {Constant{lift}}));
  for (const Vec3& p : mesh_of(sheet, Tube{0.3, 0.8, 0.05}).positions) {
    const double r = std::hypot(p.x, p.y);
    // on the wall or on a flange, both lifted, the mitre between
    const double off =
        std::min({std::fabs(r - 0.31), std::fabs(p.z - lift), std::fabs(p.z - 0.8 + lift)});
    EXPECT_LT(off, 1e-12);
    EXPECT_GE(r, 0.31 - 1e-12);
  }
  for (const Vec3& p : mesh_of(sheet, Disc{0.3, 0.05}).positions) {
    const double r = std::hypot(p.x, p.y);
    EXPECT_LT(std::min(std::fabs(r - 0.31), std::fabs(p.z - lift)), 1e-12);
  }
  const double slant = std::hypot(0.2, 0.5);
  for (const Vec3& p : mesh_of(sheet, Cone{0.3, 0.1, 0.5, 0}).positions) {
    const double r = std::hypot(p.x, p.y);
    EXPECT_NEAR((r - 0.3) * 0.5 / slant + p.z * 0.2 / slant, lift, 1e-12);
  }
}

TEST(Form, IsClosedAndApartAtUsualHeights) {
  const Sheet sheet = crinkled(2.1, 1.4, 105, 0.2);
  ASSERT_GT(sheet.statistics.highest - sheet.statistics.lowest, 0.03);
  const Form forms[] = {Flat{}, Tube{0.3, 0.8, 0.1}, Cone{0.3, 0.15, 0.4, 0.1}, Disc{0.3, 0.12},
                        Box{{0.5, 0.4, 0.5}, 0.04}};
  const std::size_t boundaries[] = {2 * (105 + 70), 0, 0, 0, 0};
  for (std::size_t k = 0; k < std::size(forms); ++k) {
    DiagnosticLog log;
    const auto mesh = formed(sheet, forms[k], log);
    ASSERT_TRUE(mesh.ok()) << to_text(log);
    const geometry::MeshReport report = geometry::check(*mesh);
    EXPECT_EQ(report.non_manifold_edges, 0u) << k;
    EXPECT_EQ(report.misoriented_edges, 0u) << k;
    if (k == 0 || k == 4) {
      EXPECT_EQ(report.boundary_edges, boundaries[k]);
    }
    const std::size_t met = intersections(*mesh);
    EXPECT_EQ(log.warnings(), 0u) << k << to_text(log);
    EXPECT_EQ(met, 0u) << k;
  }
}

// Whatever meets itself is said; ever higher sheets do.
TEST(Form, SaysWhatMeetsItself) {
  const Form forms[] = {Tube{0.3, 0.8, 0.1}, Cone{0.3, 0.15, 0.4, 0.1}, Disc{0.3, 0.12},
                        Box{{0.5, 0.4, 0.5}, 0.04}};
  for (const Form& form : forms) {
    bool met_any = false;
    for (const double slope : {0.1, 0.3, 0.6, 1.2, 3.0}) {
      const Sheet sheet = crinkled(2.1, 1.4, 52, slope);
      DiagnosticLog log;
      const auto mesh = formed(sheet, form, log);
      ASSERT_TRUE(mesh.ok());
      if (intersections(*mesh) == 0) continue;
      met_any = true;
      EXPECT_TRUE(log.contains(Code("W7002"))) << form.index() << " " << slope;
    }
    EXPECT_TRUE(met_any) << form.index();
  }
  DiagnosticLog log;
  ASSERT_TRUE(formed(sheet_of(recipe(2, 1, 100, {Constant{0.06}})), Tube{0.3, 0.8, 0.1}, log).ok());
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("W7002"));
  EXPECT_THAT(log.entries()[0].message, HasSubstr("its height is 0.06 m"));
  EXPECT_THAT(log.entries()[0].message, HasSubstr(", expected at most 0.05 m"));
  DiagnosticLog none;
  ASSERT_TRUE(
      formed(sheet_of(recipe(2, 1, 100, {Constant{0.0499}})), Tube{0.3, 0.8, 0.1}, none).ok());
  EXPECT_EQ(none.warnings(), 0u);
}

TEST(Form, TubesTakeTheirSizesFromTheSheet) {
  const Mesh mesh = mesh_of(level(kAround, 1, 188), Tube{0, 0, 0.05});
  double highest = 0, widest = 0, narrowest = 1;
  for (const Vec3& p : mesh.positions) {
    highest = std::max(highest, p.z);
    widest = std::max(widest, std::hypot(p.x, p.y));
    narrowest = std::min(narrowest, std::hypot(p.x, p.y));
  }
  EXPECT_NEAR(highest, 100 * kAround / 188 - 0.1, 1e-12);  // a hundred rows of cells
  EXPECT_NEAR(narrowest, 0.3, 1e-12);
  EXPECT_NEAR(widest, 0.35, 1e-12);
}

// Cut out of the flat sheet: lengths on the wall are lengths of texture coordinates.
TEST(Form, DoesNotStretchTheSheet) {
  const Sheet sheet = level(2.4, 1.6, 240);
  for (const Form& form :
       {Form(Tube{0.3, 0.8, 0}), Form(Cone{0.3, 0.1, 0.5, 0}), Form(Cone{0.1, 0.3, 0.5, 0}),
        Form(Disc{0.3, 0}), Form(Box{{0.5, 0.4, 0.5}, 0.02})}) {
    const Mesh mesh = mesh_of(sheet, form);
    double worst = 0;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const double real = glm::length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]);
        const double flat = glm::length(mesh.texcoords[t[k]] - mesh.texcoords[t[(k + 1) % 3]]);
        worst = std::max(worst, std::fabs(real / flat - 1));
      }
    EXPECT_LT(worst, 5e-4) << form.index();  // chords: (cell/radius)²/24, 4e-4 at the cone's top
  }
}

TEST(Form, SizesThatCannotBe) {
  const Sheet sheet = level(1, 1, 50);
  const auto said = [&](const Form& form) {
    DiagnosticLog log;
    EXPECT_FALSE(formed(sheet, form, log).ok());
    EXPECT_TRUE(log.contains(Code("E7001")));
    return log.entries().empty() ? std::string() : log.entries()[0].message;
  };
  EXPECT_THAT(said(Tube{0.3, 0.5, 0}),
              HasSubstr("expected at least 1.88496 by 0.5 m for this form"));
  EXPECT_THAT(said(Tube{-1, 0.5, 0}), HasSubstr("radius is -1"));
  EXPECT_THAT(said(Tube{0.1, 0, 0.75}), HasSubstr("length is -0.5"));
  EXPECT_THAT(said(Tube{0.1, 0.5, std::nan("")}), HasSubstr("flange is nan"));
  EXPECT_THAT(said(Cone{0, 0.1, 0.5, 0}), HasSubstr("radius is 0"));
  EXPECT_THAT(said(Cone{0.1, 0.1, 0, 0}), HasSubstr("length is 0"));
  EXPECT_THAT(said(Cone{0.1, 0.3, 0.001, 0.02}), HasSubstr("a hundredth of their difference"));
  EXPECT_THAT(said(Disc{0.6, 0}), HasSubstr("expected at least 1.2 by 1.2 m"));
  EXPECT_THAT(said(Disc{1e8, 0}), HasSubstr("vertices, expected at most 70000000"));
  EXPECT_THAT(said(Box{{0.1, 0.1, 0.1}, 0}), HasSubstr("flange is 0"));
  EXPECT_THAT(said(Box{{0.1, 0.1, 0}, 0.01}), HasSubstr("size is 0"));
  EXPECT_THAT(said(Box{{0.1, 0.1, 0.1}, 0.05}), HasSubstr("more than twice the flange"));
  EXPECT_THAT(said(Box{{0.3, 0.3, 0.3}, 0.01}), HasSubstr("expected at least 1.2 by 0.9 m"));
}

}  // namespace
}  // namespace panwright::mli::form_test
