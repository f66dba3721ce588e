// Tape and cut edges of sheets in a form, by closed forms of their areas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh/check.h"
#include "geometry/mesh/strip.h"
#include "mli/form.h"
#include "mli/levels.h"
#include "mli/trim.h"
#include "tests/mli/sheet_support.h"

namespace panwright::mli::trim_test {
namespace {

using geometry::Mesh;
using testing::recipe;
using testing::sheet_of;

constexpr double kCrease = 30 * kDegree, kTape = 0.03, kThick = 0.008;

struct Trimmed {
  Mesh mesh;
  std::vector<Cover> covers;
  std::array<double, kCovers> areas{};
};

double area_of(const Mesh& mesh, const geometry::Triangle& t) {
  return glm::length(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                mesh.positions[t[2]] - mesh.positions[t[0]])) /
         2;
}

Trimmed trimmed_sheet(Sheet sheet, const Form& form, const Trim& trim) {
  DiagnosticLog log;
  auto mesh = formed(sheet, form, log);
  std::ranges::fill(sheet.heights, 0.0);
  auto surface = formed(sheet, form, log);
  EXPECT_TRUE(mesh.ok() && surface.ok()) << to_text(log);
  if (!mesh || !surface) return {};
  geometry::compute_normals(*mesh, kCrease);
  geometry::compute_normals(*surface, kCrease);
  Trimmed out;
  out.covers = trimmed(*mesh, *surface, trim);
  out.mesh = *std::move(mesh);
  EXPECT_EQ(out.covers.size(), out.mesh.triangles.size());
  for (std::size_t t = 0; t < out.covers.size(); ++t)
    out.areas[static_cast<std::size_t>(out.covers[t])] += area_of(out.mesh, out.mesh.triangles[t]);
  EXPECT_EQ(geometry::check(out.mesh).non_finite, 0u);
  EXPECT_EQ(geometry::check(out.mesh).non_manifold_edges, 0u);
  return out;
}

// Areas of foil, tape and edges.
void expect_areas(const Form& form, double all, double tape, double edge) {
  const Trimmed got = trimmed_sheet(sheet_of(recipe(2.4, 1.6, 300, {})), form, {kTape, kThick});
  // measured 0.0069 for tape, whose border goes through near vertices; chords 1e-3
  EXPECT_NEAR((got.areas[0] + got.areas[1]) / all, 1, 2e-3) << form.index();
  EXPECT_NEAR(got.areas[1] / tape, 1, 0.02) << form.index();
  EXPECT_NEAR(got.areas[2], edge, 2e-3 * edge) << form.index();
}

TEST(Trim, BordersAndJointsAreTapedAndOpenBordersCut) {
  const double w = kTape;
  expect_areas(Flat{}, 2.4 * 1.6, 2.4 * 1.6 - (2.4 - 2 * w) * (1.6 - 2 * w), 8 * kThick);
  const double around = 2 * kPi * 0.3;
  // two ends, and the joint on both sides
  expect_areas(Tube{0.3, 0.8, 0}, around * 0.8, around * 2 * w + 2 * w * (0.8 - 2 * w),
               2 * kPi * (2 * 0.3 - kThick) * kThick);
  const double slant = std::hypot(0.2, 0.5);
  expect_areas(Cone{0.3, 0.1, 0.5, 0}, kPi * 0.4 * slant,
               2 * kPi * w * (0.3 + 0.1) + 2 * w * (slant - 2 * w),
               2 * kPi * (0.4 - kThick * 0.5 / slant) * kThick);
  expect_areas(Disc{0.3, 0}, kPi * 0.09, kPi * (0.09 - (0.3 - w) * (0.3 - w)), around * kThick);
  // the pattern of a box: two ends of three sides each that are joined, and one joint along a side
  const Trimmed box = trimmed_sheet(sheet_of(recipe(2.4, 1.6, 300, {})), Box{{0.5, 0.4, 0.5}, 0.02},
                                    {kTape, kThick});
  EXPECT_EQ(box.areas[2], 0);
  const double lines = 2 * (0.5 + 2 * 0.4) + 0.5;
  EXPECT_NEAR(box.areas[1] / (2 * w * lines), 1, 0.06);  // measured 0.025: ends overlap
}

// Edges hang from the border against the form's normal, and show outwards.
TEST(Trim, EdgesShowOutwards) {
  const Trimmed got =
      trimmed_sheet(sheet_of(recipe(1, 0.8, 100, {Random{1e-3}, Smooth{4}})), Flat{}, {0, kThick});
  for (std::size_t t = 0; t < got.covers.size(); ++t) {
    if (got.covers[t] != Cover::edge) continue;
    const auto& corners = got.mesh.triangles[t];
    const Vec3 a = got.mesh.positions[corners[0]];
    const Vec3 facet =
        glm::cross(got.mesh.positions[corners[1]] - a, got.mesh.positions[corners[2]] - a);
    const bool on_x = std::fabs(std::fabs(a.x) - 0.5) < 1e-9 && std::fabs(facet.y) < 1e-9;
    EXPECT_GT(on_x ? facet.x * a.x : facet.y * a.y, 0);
    for (const std::uint32_t v : corners) {
      EXPECT_GT(glm::dot(got.mesh.normals[v], facet), 0.7 * glm::length(facet));
      EXPECT_EQ(got.mesh.normals[v].z, 0);
    }
  }
}

// Without trim nothing changes; levels are trimmed as the finest.
TEST(Trim, LevelsAreTrimmedAlike) {
  const Sheet sheet =
      sheet_of(recipe(1.28, 1.28, 256, {Random{1e-3}, Smooth{8}, SlopeRms{0.1}}, 2));
  const Trimmed none = trimmed_sheet(sheet, Tube{0.15, 0.8, 0.05}, {});
  EXPECT_EQ(none.areas[1] + none.areas[2], 0);
  const Trimmed fine = trimmed_sheet(sheet, Tube{0.15, 0.8, 0.05}, {kTape, kThick});
  const auto levels = levels_of(sheet, Tube{0.15, 0.8, 0.05}, kCrease, 1e9, {kTape, kThick});
  ASSERT_FALSE(levels.empty());
  std::array<double, kCovers> areas{};
  ASSERT_EQ(levels[0].covers.size(), levels[0].mesh.triangles.size());
  for (std::size_t t = 0; t < levels[0].covers.size(); ++t)
    areas[static_cast<std::size_t>(levels[0].covers[t])] +=
        area_of(levels[0].mesh, levels[0].mesh.triangles[t]);
  for (std::size_t k = 0; k < kCovers; ++k) EXPECT_NEAR(areas[k] / fine.areas[k], 1, 0.02) << k;
  double parts = 0;
  for (const Cover cover : {Cover::foil, Cover::tape, Cover::edge})
    parts += static_cast<double>(part_of(fine.mesh, fine.covers, cover).triangles.size());
  EXPECT_EQ(parts, static_cast<double>(fine.mesh.triangles.size()));
}

}  // namespace
}  // namespace panwright::mli::trim_test
