// Parts of elevation files, and bands that blend them, against formulas evaluated here.
#include "terrain/part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>

#include "terrain/ground.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"

namespace panwright::terrain::part_test {
namespace {

using support::TemporaryFolder;
using Height = std::function<double(double x, double y)>;

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();

// A plane: post (i, j) at x = left + i·step, y = top − j·step.
struct Plane {
  std::uint32_t width, height;
  double left, top, step;
  Height z;

  double x(std::uint32_t i) const { return left + i * step; }
  double y(std::uint32_t j) const { return top - j * step; }
};

std::string written(const TemporaryFolder& folder, const std::string& name,
                    const std::string& label, const std::vector<float>& z, const char* extension,
                    const char* data_extension) {
  std::string data(4 * z.size(), 0);
  std::memcpy(data.data(), z.data(), data.size());
  (void)folder.write(name + data_extension, data);
  return folder.write(name + extension, label);
}

std::string write_plane(const TemporaryFolder& folder, const std::string& name,
                        const Plane& plane) {
  std::vector<float> z;
  for (std::uint32_t j = 0; j < plane.height; ++j)
    for (std::uint32_t i = 0; i < plane.width; ++i)
      z.push_back(static_cast<float>(plane.z(plane.x(i), plane.y(j))));
  const auto number = [](double v) { return std::to_string(v); };
  return written(folder, name,
                 "ENVI\nsamples = " + std::to_string(plane.width) +
                     "\nlines = " + std::to_string(plane.height) +
                     "\nbands = 1\ndata type = 4\nbyte order = 0\nmap info = {Local, 1, 1, " +
                     number(plane.left - plane.step / 2) + ", " +
                     number(plane.top + plane.step / 2) + ", " + number(plane.step) + ", " +
                     number(plane.step) + "}\n",
                 z, ".hdr", ".dat");
}

Dem opened(const std::string& path) {
  DiagnosticLog log;
  DemOptions reading;
  reading.unit = 1;
  reading.quantity = Quantity::height;
  auto dem = Dem::open(path, reading, log);
  EXPECT_TRUE(dem) << to_text(log);
  return *std::move(dem);
}

Result<DemPart> part_of(const std::string& path, const PartChoice& choice, DiagnosticLog& log) {
  return DemPart::of(opened(path), choice, "site.pxn:3:5", log);
}

DemPart part_of(const std::string& path, const PartChoice& choice) {
  DiagnosticLog log;
  auto part = part_of(path, choice, log);
  EXPECT_TRUE(part) << to_text(log);
  return *std::move(part);
}

std::vector<double> heights_of(const DemPart& part) {
  std::vector<double> out;
  DiagnosticLog log;
  EXPECT_TRUE(part.read(
      [&](const Rows& rows) {
        EXPECT_EQ(rows.first * part.info().width, out.size());
        out.insert(out.end(), rows.heights.begin(), rows.heights.end());
        return true;
      },
      log));
  EXPECT_EQ(out.size(), std::size_t{part.info().width} * part.info().height);
  return out;
}

Tiles tiles_of(const TemporaryFolder& folder, const std::vector<DemPart>& parts, DiagnosticLog& log,
               double error = 0) {
  EXPECT_TRUE(write_parts(parts, folder / "a.pan", {error}, log)) << to_text(log);
  DiagnosticLog own;
  auto tiles = Tiles::open(folder / "a.pan", own);
  EXPECT_TRUE(tiles) << to_text(own);
  EXPECT_TRUE(tiles->check(own)) << to_text(own);
  return *std::move(tiles);
}

// Stored height of a post of a chart.
double stored(const Tiles& tiles, std::uint32_t chart, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t column = std::min(x / kTileCells,
                                        level_side(tiles.charts()[chart].width, 0).tiles - 1),
                      row = std::min(y / kTileCells,
                                     level_side(tiles.charts()[chart].height, 0).tiles - 1);
  const auto view = tiles.view(tiles.index(chart, 0, column, row));
  return view ? view->height(x - column * kTileCells, y - row * kTileCells) : NAN;
}

double waves(double x, double y) { return 8 * std::sin(0.05 * x) * std::cos(0.033 * y) + 0.01 * x; }

TEST(DemPart, PixelsMeansAndShifts) {
  const TemporaryFolder folder;
  const Plane plane{37, 29, 100, 50, 2, waves};
  const std::string path = write_plane(folder, "a", plane);
  // 5 x 4 means of 3 x 3, one column and one row left out
  const DemPart part = part_of(path, {{{4, 7, 16, 13}}, {}, 3, -12.5, 0});
  ASSERT_EQ(part.info().width, 5u);
  ASSERT_EQ(part.info().height, 4u);
  const std::vector<double> found = heights_of(part);
  for (std::uint32_t j = 0; j < 4; ++j)
    for (std::uint32_t i = 0; i < 5; ++i) {
      double sum = 0;
      for (std::uint32_t v = 0; v < 3; ++v)
        for (std::uint32_t u = 0; u < 3; ++u)
          sum += double(static_cast<float>(waves(plane.x(4 + 3 * i + u), plane.y(7 + 3 * j + v))));
      // measured: 0
      EXPECT_NEAR(found[5 * j + i], sum / 9 - 12.5, 1e-12);
      const Vec2 centre = part.info().map.point(i + 0.5, j + 0.5);
      EXPECT_DOUBLE_EQ(centre.x, plane.x(4 + 3 * i + 1));
      EXPECT_DOUBLE_EQ(centre.y, plane.y(7 + 3 * j + 1));
    }
  // what is neither reduced nor raised keeps its bits
  const std::vector<double> same = heights_of(part_of(path, {{{4, 7, 16, 13}}, {}, 1, 0, 0}));
  for (std::uint32_t j = 0; j < 13; ++j)
    for (std::uint32_t i = 0; i < 16; ++i)
      ASSERT_EQ(same[16 * j + i],
                double(static_cast<float>(waves(plane.x(4 + i), plane.y(7 + j)))));
}

TEST(DemPart, MeansLeaveOutVoids) {
  const TemporaryFolder folder;
  const Plane plane{4, 4, 0, 0, 1, [](double x, double y) {
                      if (x >= 2 && y > -2) return double(kVoid);
                      return x == 0 && y == 0 ? double(kVoid) : x - 10 * y;
                    }};
  const std::vector<double> found =
      heights_of(part_of(write_plane(folder, "a", plane), {{}, {}, 2, 0, 0}));
  EXPECT_DOUBLE_EQ(found[0], (1 + 10 + 11) / 3.0);
  EXPECT_TRUE(std::isnan(found[1]));
  EXPECT_DOUBLE_EQ(found[2], (20 + 21 + 30 + 31) / 4.0);
}

TEST(DemPart, BoundsHoldThePostsWithin) {
  const TemporaryFolder folder;
  const std::string path = write_plane(folder, "a", {40, 30, -20, 15, 1, waves});
  const DemPart part = part_of(path, {{}, {{-3, -2, 4.5, 6}}, 1, 0, 0});
  EXPECT_EQ(part.info().width, 9u);   // x -2 to 6
  EXPECT_EQ(part.info().height, 8u);  // y -3 to 4
  const Vec2 first = part.info().map.point(0.5, 0.5);
  EXPECT_DOUBLE_EQ(first.x, -2);
  EXPECT_DOUBLE_EQ(first.y, 4);
}

TEST(DemPart, RefusesWhatIsNotThere) {
  const TemporaryFolder folder;
  const std::string path = write_plane(folder, "a", {20, 10, 0, 0, 1, waves});
  const std::pair<PartChoice, const char*> cases[] = {
      {{{{15, 0, 6, 5}}, {}, 1, 0, 0}, "no 6 x 5 pixels from column 15"},
      {{{{0, 0, 4294967295u, 5}}, {}, 1, 0, 0}, "no 4294967295 x 5 pixels"},
      {{{{0, 0, 0, 5}}, {}, 1, 0, 0}, "no 0 x 5 pixels"},
      {{{}, {{100, 100, 200, 200}}, 1, 0, 0}, "no post of the file lies within"},
      {{{}, {}, 6, 0, 0}, "leave 3 x 1 posts"}};
  for (const auto& [choice, words] : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(part_of(path, choice, log));
    ASSERT_EQ(log.entries().size(), 1u);
    EXPECT_EQ(log.entries()[0].code, Code("E9613"));
    EXPECT_NE(log.entries()[0].message.find(words), std::string::npos) << to_text(log);
    EXPECT_TRUE(log.entries()[0].message.starts_with("site.pxn:3:5: ")) << to_text(log);
  }
}

// A patch of 1 m in a base of 4 m, which is a plane: its triangles are the formula.
TEST(Blend, FollowsTheFormula) {
  const auto base = [](double x, double y) { return 20 + 0.125 * x - 0.25 * y; };
  const auto patch = [](double x, double y) { return 20 + 0.1 * x - 0.2 * y + waves(x, y); };
  const TemporaryFolder folder;
  const Plane fine{90, 70, -45, 35, 1, patch};
  const std::string low = write_plane(folder, "base", {60, 60, -118, 118, 4, base}),
                    high = write_plane(folder, "patch", fine);
  constexpr double kBand = 12.5;
  DiagnosticLog log;
  const Tiles tiles =
      tiles_of(folder, {part_of(high, {{}, {}, 1, 0, kBand}), part_of(low, {})}, log);
  double worst = 0;
  int blended = 0;
  for (std::uint32_t j = 0; j < fine.height; ++j)
    for (std::uint32_t i = 0; i < fine.width; ++i) {
      const double own = double(static_cast<float>(patch(fine.x(i), fine.y(j))));
      const double border = std::min({i, j, fine.width - 1 - i, fine.height - 1 - j});
      const double found = stored(tiles, 0, i, j);
      if (border >= kBand) {
        ASSERT_EQ(found, own);
        continue;
      }
      ++blended;
      const double t = border / kBand, below = base(fine.x(i), fine.y(j));
      worst =
          std::max(worst, std::fabs(found - (below + (3 * t * t - 2 * t * t * t) * (own - below))));
    }
  printf("blend: %.1e m, of %d posts\n", worst, blended);
  EXPECT_GT(blended, 3000);
  // measured: 1.9e-6 m, of floats of 32 m
  EXPECT_LT(worst, 1e-5);
  EXPECT_EQ(stored(tiles, 1, 7, 9), base(-118 + 28, 118 - 36));
  // the first chart counts; the border is the ground below, from either side
  const Ground ground(std::make_shared<const Tiles>(tiles));
  EXPECT_EQ(ground.at({0, 0}).chart, 0u);
  EXPECT_EQ(ground.at({0, -60}).chart, 1u);
  EXPECT_NEAR(ground.at({0.5, -45.001}).height, ground.at({0.5, -44.999}).height, 1e-3);
}

std::string moon_label(std::uint32_t width, std::uint32_t height, double per_degree, double line,
                       double sample, const std::string& file) {
  return "PDS_VERSION_ID = PDS3\n^IMAGE = \"" + file +
         "\"\nOBJECT = IMAGE\n LINES = " + std::to_string(height) +
         "\n LINE_SAMPLES = " + std::to_string(width) +
         "\n SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = METER\nEND_OBJECT\nOBJECT = "
         "IMAGE_MAP_PROJECTION\n A_AXIS_RADIUS = 1737.4 <km>\n POSITIVE_LONGITUDE_DIRECTION = "
         "EAST\n CENTER_LONGITUDE = 0\n MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n "
         "CENTER_LATITUDE = 0\n MAP_RESOLUTION = " +
         std::to_string(per_degree) +
         " <pix/deg>\n LINE_PROJECTION_OFFSET = " + std::to_string(line) +
         "\n SAMPLE_PROJECTION_OFFSET = " + std::to_string(sample) + "\nEND_OBJECT\nEND\n";
}

// On a globe the border's posts lie on the triangles of the globe, whose chords sag by up to
// 4 m: those that its own ground answers with. Over the date line, and at a pole.
TEST(Blend, MeetsTheTrianglesOfAGlobe) {
  const TemporaryFolder folder;
  std::vector<float> globe(720 * 360);
  for (int j = 0; j < 360; ++j)
    for (int i = 0; i < 720; ++i)
      globe[static_cast<std::size_t>(720 * j + i)] =
          static_cast<float>(900 * std::sin(i * kPi / 90) * std::cos(j * 0.07));
  const std::string low = written(
      folder, "globe", moon_label(720, 360, 2, 179.5, 359.5, "globe.img"), globe, ".lbl", ".img");
  struct Case {
    const char* name;
    std::string label;
    std::uint32_t width, height;
  };
  std::string polar = moon_label(100, 100, 20, 49.5, 49.5, "polar.img");
  const auto replace = [&](const std::string& what, const std::string& by) {
    polar.replace(polar.find(what), what.size(), by);
  };
  replace("SIMPLE CYLINDRICAL", "POLAR STEREOGRAPHIC");
  replace("CENTER_LATITUDE = 0", "CENTER_LATITUDE = -90");
  replace("MAP_RESOLUTION = 20.000000 <pix/deg>", "MAP_SCALE = 1500 <m/pix>");
  // 10 pixels a degree about 20 N, 178 E to 174 W
  const Case cases[] = {
      {"dateline", moon_label(80, 60, 10, 230.5, -1780.5, "dateline.img"), 80, 60},
      {"polar", polar, 100, 100}};
  const Ground alone(std::make_shared<const Tiles>([&] {
    DiagnosticLog log;
    return tiles_of(folder, {part_of(low, {})}, log);
  }()));
  for (const Case& each : cases) {
    const std::string high =
        written(folder, each.name, each.label,
                std::vector<float>(std::size_t{each.width} * each.height, 250), ".lbl", ".img");
    const TemporaryFolder own;
    DiagnosticLog log;
    const Tiles tiles =
        tiles_of(own, {part_of(high, {{}, {}, 1, 0, 30000}), part_of(low, {})}, log);
    EXPECT_EQ(log.errors(), 0u) << to_text(log);
    const Map map = tiles.map(0);
    double worst = 0, spread = 0;
    for (std::uint32_t k = 0; k < each.width; ++k)
      for (const std::uint32_t row : {0u, each.height - 1}) {
        const GroundPoint below = alone.at(map.at(k + 0.5, row + 0.5));
        ASSERT_TRUE(below) << each.name << k;
        worst = std::max(worst, std::fabs(stored(tiles, 0, k, row) - below.height));
        spread = std::max(spread, std::fabs(below.height - 250));
      }
    printf("blend on a globe, %s: %.1e m\n", each.name, worst);
    // measured: 2.9e-5 m, of floats of 900 m
    EXPECT_LT(worst, 1e-4) << each.name;
    EXPECT_GT(spread, 100) << each.name;
    EXPECT_EQ(stored(tiles, 0, each.width / 2, each.height / 2), 250);
  }
}

TEST(Blend, WarnsOfJumps) {
  const TemporaryFolder folder;
  const std::string low = write_plane(folder, "base", {60, 60, -118, 118, 4, waves}),
                    high = write_plane(folder, "patch", {90, 70, -45, 35, 1, waves});
  const auto told = [&](const std::vector<DemPart>& parts) {
    DiagnosticLog log;
    (void)tiles_of(folder, parts, log);
    return to_text(log);
  };
  EXPECT_EQ(told({part_of(high, {{}, {}, 1, 0, 20}), part_of(low, {})}), "");
  const std::string datum = told({part_of(high, {{}, {}, 1, 30, 20}), part_of(low, {})});
  EXPECT_NE(datum.find("W9614"), std::string::npos) << datum;
  EXPECT_NE(datum.find("raise=\"-30"), std::string::npos) << datum;
  const std::string nothing = told({part_of(high, {{}, {}, 1, 0, 20})});
  EXPECT_NE(nothing.find("316 of 316 posts"), std::string::npos) << nothing;
}

// Three parts, the middle one blended too: the first meets what is stored of it.
TEST(Blend, ChainsOfParts) {
  const auto level = [](double h) { return [h](double, double) { return h; }; };
  const TemporaryFolder folder;
  const std::string base = write_plane(folder, "a", {80, 80, -158, 158, 4, level(0)}),
                    middle = write_plane(folder, "b", {100, 100, -99, 99, 2, level(8)}),
                    top = write_plane(folder, "c", {60, 60, -29.5, 29.5, 1, level(32)});
  DiagnosticLog log;
  const Tiles tiles = tiles_of(
      folder,
      {part_of(top, {{}, {}, 1, 0, 400}), part_of(middle, {{}, {}, 1, 0, 40}), part_of(base, {})},
      log);
  EXPECT_EQ(stored(tiles, 1, 0, 50), 0);
  EXPECT_EQ(stored(tiles, 1, 10, 50), 4);
  EXPECT_EQ(stored(tiles, 1, 20, 50), 8);
  EXPECT_EQ(stored(tiles, 0, 0, 30), 8);
  EXPECT_GT(stored(tiles, 0, 29, 30), 8);
}

// The same bytes of any number of threads; without a blend those of write_tiles().
TEST(Blend, SameBytes) {
  const TemporaryFolder folder;
  const std::string low = write_plane(folder, "base", {600, 300, -1198, 598, 4, waves}),
                    high = write_plane(folder, "patch", {390, 370, -195, 185, 1, waves});
  const auto bytes = [&](const std::vector<DemPart>& parts, std::size_t threads) {
    DiagnosticLog log;
    EXPECT_TRUE(write_parts(parts, folder / "b.pan", {0.05}, log, Job({threads, {}})));
    auto model = pan::Model::open(folder / "b.pan", log);
    const auto all = model->bytes();
    return std::vector<std::byte>(all.begin(), all.end());
  };
  const std::vector<DemPart> blended{part_of(high, {{}, {}, 1, 0.5, 20}), part_of(low, {})};
  EXPECT_EQ(bytes(blended, 1), bytes(blended, 3));
  const std::vector<Dem> dems{opened(high), opened(low)};
  DiagnosticLog log;
  ASSERT_TRUE(write_tiles(dems, folder / "c.pan", {0.05}, log));
  auto plain = pan::Model::open(folder / "c.pan", log);
  const auto all = plain->bytes();
  EXPECT_EQ(bytes({part_of(high, {}), part_of(low, {})}, 2),
            std::vector<std::byte>(all.begin(), all.end()));
}

}  // namespace
}  // namespace panwright::terrain::part_test
