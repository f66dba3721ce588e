// Shape models: one cube in every format, against its closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ephemeris/dsk.h"
#include "terrain/shape.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::shape_test {
namespace {

using support::TemporaryFolder;
using testing_support::dsk_file;

// A cube of 2 km about (0, 0, 0).
std::vector<std::array<double, 3>> corners() {
  std::vector<std::array<double, 3>> out;
  for (int k = 0; k < 8; ++k) out.push_back({k & 1 ? 1. : -1., k & 2 ? 1. : -1., k & 4 ? 1. : -1.});
  return out;
}
// Counter-clockwise from outside, from 1.
const std::vector<std::array<std::int32_t, 3>> kPlates = {
    {1, 3, 4}, {1, 4, 2}, {5, 6, 8}, {5, 8, 7}, {1, 2, 6}, {1, 6, 5},
    {3, 7, 8}, {3, 8, 4}, {1, 5, 7}, {1, 7, 3}, {2, 4, 8}, {2, 8, 6}};

void expect_cube(const Shape& shape, std::size_t vertices, std::size_t plates, const char* name) {
  const ShapeSurvey s = survey_shape(shape);
  EXPECT_EQ(shape.vertices.size(), vertices) << name;
  EXPECT_EQ(shape.plates.size(), plates) << name;
  EXPECT_NEAR(s.volume, 8e9, 1) << name;
  EXPECT_NEAR(s.area, 24e6, 1e-3) << name;
  EXPECT_EQ(s.open_edges, 0u) << name;
  EXPECT_EQ(s.flat_plates, 0u) << name;
  EXPECT_NEAR(s.largest.radius, 1000 * std::sqrt(3.0), 1e-9) << name;
  EXPECT_NEAR(glm::length(s.centroid), 0, 1e-6) << name;
}

std::string tab() {
  std::string out;
  for (const auto& v : corners()) out += fmt::format("v {:.5E} {:.5E} {:.5E}\n", v[0], v[1], v[2]);
  for (const auto& p : kPlates) out += fmt::format("f {} {} {}\n", p[0], p[1], p[2]);
  return out;
}

std::string plt() {
  std::string out = "8\n";
  int number = 0;
  for (const auto& v : corners()) out += fmt::format("{} {} {} {}\n", ++number, v[0], v[1], v[2]);
  out += "12\n";
  number = 0;
  for (const auto& p : kPlates) out += fmt::format("{} {} {} {}\n", ++number, p[0], p[1], p[2]);
  return out;
}

// Faces of (q + 1)² points; their edges are repeated.
std::string icq(int q) {
  std::string out = fmt::format("{}\n", q);
  const Vec3 faces[6][3] = {
      {{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}}, {{-1, 1, -1}, {2, 0, 0}, {0, -2, 0}},
      {{1, -1, -1}, {0, 2, 0}, {0, 0, 2}}, {{-1, -1, 1}, {0, 2, 0}, {0, 0, -2}},
      {{1, 1, -1}, {-2, 0, 0}, {0, 0, 2}}, {{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}}};
  for (const auto& face : faces)
    for (int i = 0; i <= q; ++i)
      for (int j = 0; j <= q; ++j) {
        const Vec3 p = face[0] + face[1] * (double(j) / q) + face[2] * (double(i) / q);
        out += fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
      }
  return out;
}

TEST(Shape, OneCubeInEveryFormat) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const auto read = [&](const std::string& path, const ShapeOptions& options = {}) {
    auto out = read_shape(path, options, log);
    EXPECT_TRUE(out) << path << to_text(log);
    return out ? *out : Shape{};
  };
  expect_cube(read(folder.write("a.tab", tab())), 8, 12, "tab");
  expect_cube(read(folder.write("a.plt", plt())), 8, 12, "plt");
  EXPECT_TRUE(log.contains(Code("N9604")));  // kilometres are assumed
  ShapeOptions kilometres;
  kilometres.unit = 1000;
  expect_cube(read(folder.write("a.obj", "# from nowhere\n" + tab()), kilometres), 8, 12, "obj");
  // (q + 1)² points of six faces, less those that faces share: 6q² + 2
  expect_cube(read(folder.write("a.icq", icq(4))), 98, 192, "icq");
  for (const bool big : {false, true}) {
    const Shape dsk = read(folder.write("a.bds", dsk_file(corners(), kPlates, big)));
    expect_cube(dsk, 8, 12, big ? "big-endian dsk" : "dsk");
    EXPECT_EQ(dsk.body, "2101955");
    EXPECT_EQ(dsk.frame, "10105");
    EXPECT_TRUE(dsk.unit_stated);
  }
}

TEST(Shape, LargerThanARecord) {
  // 300 vertices and 500 plates take several records of doubles and of integers
  std::vector<std::array<double, 3>> vertices;
  for (int k = 0; k < 300; ++k)
    vertices.push_back({std::cos(0.1 * k), std::sin(0.1 * k), 0.01 * k});
  std::vector<std::array<std::int32_t, 3>> plates;
  for (int k = 0; k < 500; ++k) plates.push_back({1 + k % 298, 2 + k % 298, 3 + k % 298});
  const std::string file = dsk_file(vertices, plates, false);
  std::vector<ephemeris::DskPlates> out;
  std::size_t skipped = 0;
  std::string problem;
  ASSERT_TRUE(ephemeris::read_dsk(std::as_bytes(std::span(file)), out, skipped, problem))
      << problem;
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].vertices, vertices);
  EXPECT_EQ(out[0].plates.back()[2], std::uint32_t(2 + 499 % 298));
}

TEST(Shape, UnitOfAnObjIsAsked) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  EXPECT_FALSE(read_shape(folder.write("a.obj", tab()), {}, log));
  EXPECT_TRUE(log.contains(Code("E9602")));
}

TEST(Shape, PlatesFromZero) {
  const TemporaryFolder folder;
  std::string text;
  for (const auto& v : corners()) text += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
  for (const auto& p : kPlates) text += fmt::format("f {} {} {}\n", p[0] - 1, p[1] - 1, p[2] - 1);
  DiagnosticLog log;
  const auto shape = read_shape(folder.write("a.tab", text), {}, log);
  ASSERT_TRUE(shape) << to_text(log);
  expect_cube(*shape, 8, 12, "from zero");
  EXPECT_TRUE(log.contains(Code("W9603")));
}

TEST(Shape, CutShort) {
  const TemporaryFolder folder;
  const std::string label =
      "PDS_VERSION_ID = PDS3\nOBJECT = VERTEX_TABLE\n ROWS = 8\n OBJECT = COLUMN\n UNIT = "
      "KILOMETER\n"
      " END_OBJECT\nEND_OBJECT\nOBJECT = FACET_TABLE\n ROWS = 12\nEND_OBJECT\nEND\n";
  (void)folder.write("a.lbl", label);
  const auto refuses = [&](const std::string& name, const std::string& text) {
    DiagnosticLog log;
    const bool read = static_cast<bool>(read_shape(folder.write(name, text), {}, log));
    EXPECT_EQ(read, !log.has_errors()) << name;
    return !read;
  };
  EXPECT_FALSE(refuses("a.tab", tab()));
  // the last number may lose digits and stay one: its line is complete
  for (std::size_t size = 0; size + 2 < tab().size(); size += 5)
    EXPECT_TRUE(refuses("a.tab", tab().substr(0, size))) << size;
  for (std::size_t size = 0; size + 2 < plt().size(); size += 3)
    EXPECT_TRUE(refuses("b.plt", plt().substr(0, size))) << size;
  const std::string dsk = dsk_file(corners(), kPlates, false);
  for (std::size_t size = 0; size < dsk.size() - 1024; size += 61)
    EXPECT_TRUE(refuses("c.bds", dsk.substr(0, size))) << size;
}

TEST(Shape, Drawing) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const auto shape = read_shape(folder.write("a.tab", tab()), {}, log);
  ASSERT_TRUE(shape);
  const auto image = draw_shape(*shape, 50);
  ASSERT_EQ(image.size(), 3u * 150 * 50);
  // 0.92 of a view is filled by a face that looks at it
  std::size_t lit = 0;
  for (std::size_t i = 0; i < image.size(); i += 3) lit += image[i] > 0 ? 1 : 0;
  EXPECT_NEAR(double(lit), 3 * 46 * 46, 3 * 4 * 46);
}

}  // namespace
}  // namespace panwright::terrain::shape_test
