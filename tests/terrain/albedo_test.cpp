// Albedo maps of terrain: means of every level, places between pixels, gaps, damage and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "terrain/ground.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::albedo_test {
namespace {

using testing::HasSubstr;
using testing_support::bytes_of;
using testing_support::Kind;
using testing_support::label_of;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// half a code of the largest number, and the rounding of means to float
constexpr double kCode = 0.5 / 65534 + 6e-8;

using Numbers = std::function<double(std::uint32_t column, std::uint32_t row)>;

struct Source {
  std::uint32_t width = 0, height = 0;
  std::vector<Numbers> bands;
  std::optional<double> white = 1.0;
};

// Writes a file of numbers, its bands one after the other, and opens it.
std::optional<Dem> opened(const support::TemporaryFolder& folder, const std::string& name,
                          Kind kind, const Source& source, std::uint32_t band, bool heights,
                          DiagnosticLog& log) {
  std::string data;
  for (const Numbers& of : source.bands)
    for (std::uint32_t y = 0; y < source.height; ++y)
      for (std::uint32_t x = 0; x < source.width; ++x)
        data += bytes_of(static_cast<float>(of(x, y)), false);
  std::string label = label_of(kind, source.width, source.height);
  const auto replace = [&](const std::string& what, const std::string& by) {
    label.replace(label.find(what), what.size(), by);
  };
  const bool plane = kind == Kind::plane;
  if (plane && source.bands.size() > 1)
    replace("bands = 1\n",
            "bands = " + std::to_string(source.bands.size()) + "\ninterleave = bsq\n");
  if (!plane) replace("a.img", name + ".img");
  (void)folder.write(name + (plane ? ".dat" : ".img"), data);
  DemOptions reading;
  reading.quantity = heights ? Quantity::height : Quantity::plain;
  if (heights) reading.unit = 1;
  reading.band = band;
  auto dem = Dem::open(folder.write(name + (plane ? ".hdr" : ".lbl"), label), reading, log);
  return dem ? std::optional(*std::move(dem)) : std::nullopt;
}

struct Made {
  support::TemporaryFolder folder;
  DiagnosticLog log;
  std::optional<Tiles> tiles;
  const AlbedoMaps& albedo() const { return tiles->albedo(); }
};

// Terrain with maps of a kind; no tiles where that failed.
std::unique_ptr<Made> made(Kind kind, const std::vector<Source>& maps, Kind ground = Kind::plane,
                           bool same = true) {
  auto out = std::make_unique<Made>();
  const Source flat{8, 8, {[](auto, auto) { return 0.0; }}, {}};
  const auto dem = opened(out->folder, "ground", same ? kind : ground, flat, 1, true, out->log);
  TilesOptions options;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    AlbedoPart part;
    part.white = maps[m].white;
    for (std::uint32_t b = 1; b <= maps[m].bands.size(); ++b)
      if (auto band =
              opened(out->folder, "map" + std::to_string(m), kind, maps[m], b, false, out->log))
        part.bands.push_back(*std::move(band));
    options.albedo.push_back(std::move(part));
  }
  if (!dem || !write_tiles({&*dem, 1}, out->folder / "a.pan", options, out->log)) return out;
  if (auto tiles = Tiles::open(out->folder / "a.pan", out->log)) out->tiles = *std::move(tiles);
  return out;
}

double random_number(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t a = (x * 2654435761u) ^ (y * 40503u + 12345u);
  return 0.05 + (a >> 8) % 1000 / 1000.0;
}

LatLon place(const Map& map, double column, double row) {
  if (map.kind != Map::Kind::none) return map.at(column, row);
  const Vec2 p = map.point(column, row);
  return {p.y, p.x};
}

class EveryKind : public testing::TestWithParam<Kind> {};

// At the middle of a pixel of a level, asked for its width, stands the mean of its pixels of the
// file, each as much as the others.
TEST_P(EveryKind, MeansOfEveryLevel) {
  const Source source{601, 531, {random_number}, 1.0};
  const auto m = made(GetParam(), {source});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  ASSERT_EQ(m->albedo().maps().size(), 1u);
  const AlbedoRecord& record = m->albedo().maps()[0];
  EXPECT_EQ(record.levels, 11u);
  const Map map = map_of(record);
  double worst = 0;
  for (std::uint32_t level = 0; level < record.levels; ++level) {
    const std::uint32_t unit = 1u << level;
    for (std::uint32_t y = 0; y < source.height / unit; y += 1 + 40 / unit)
      for (std::uint32_t x = 0; x < source.width / unit; x += 1 + 37 / unit) {
        double sum = 0;
        for (std::uint32_t j = 0; j < unit; ++j)
          for (std::uint32_t i = 0; i < unit; ++i) sum += random_number(x * unit + i, y * unit + j);
        const double column = (x + 0.5) * unit, row = (y + 0.5) * unit;
        const Vec2 metres = map.spacing(column, row);
        const Vec3 found =
            m->albedo().at(place(map, column, row), unit * std::max(metres.x, metres.y));
        worst = std::max(worst, std::fabs(found.y - sum / unit / unit));
        EXPECT_EQ(found.x, found.y);
      }
  }
  // measured 8.0e-6, 8.1e-6 and 8.0e-6: half a code
  EXPECT_LT(worst, 1.05 * kCode + 1e-9);
  EXPECT_GT(worst, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKind,
                         testing::Values(Kind::plane, Kind::cylindrical, Kind::polar));

// Relative numbers are divided by their mean by area: cells of a cylindrical map by the difference
// of the sines of their latitudes, those of a stereographic one by (1 + (ρ/2R)²)⁻².
TEST(Albedo, RelativeNumbersHaveTheMeanOne) {
  for (const Kind kind : {Kind::plane, Kind::cylindrical, Kind::polar}) {
    // dark in the middle, so that each weight has another mean
    const auto bowl = [](std::uint32_t x, std::uint32_t y) {
      return 0.1 + 1e-5 * (std::pow(x - 300.0, 2) + std::pow(y - 300.0, 2));
    };
    const Source source{601, 601, {bowl}, {}};
    const auto m = made(kind, {source});
    ASSERT_TRUE(m->tiles) << to_text(m->log);
    EXPECT_THAT(to_text(m->log), HasSubstr("N9604"));
    double sum = 0, area = 0;
    for (int y = 0; y < 601; ++y)
      for (int x = 0; x < 601; ++x) {
        double weight = 1;
        const auto sine = [](double row) { return std::sin((300.5 - row) * 0.1 * kPi / 180); };
        if (kind == Kind::cylindrical) weight = sine(y) - sine(y + 1.0);
        if (kind == Kind::polar)
          weight = std::pow(1 + (std::pow(x - 300.0, 2) + std::pow(y - 300.0, 2)) * 1e4 /
                                    (4 * testing_support::kRadius * testing_support::kRadius),
                            -2);
        sum += weight * bowl(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
        area += weight;
      }
    const double found = m->albedo().at(place(map_of(m->albedo().maps()[0]), 300.5, 300.5), 0).x;
    // measured 2.4e-6, 1.6e-5, 5.0e-6 of it: the code
    EXPECT_NEAR(found * (sum / area) / 0.1, 1, 5e-5) << static_cast<int>(kind);
  }
}

TEST(Albedo, BetweenPixelsAndOverTheSeam) {
  const auto step = [](std::uint32_t x, std::uint32_t) {
    return x == 0 ? 1.0 : x == 3599 ? 0.5 : 0.25;
  };
  const auto m = made(Kind::cylindrical, {{3600, 8, {step}, 1.0}});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  const auto at = [&](double column) {
    return m->albedo().at(map_of(m->albedo().maps()[0]).at(column, 4), 0).x;
  };
  EXPECT_NEAR(at(0), 0.75, kCode + 1e-9);
  EXPECT_NEAR(at(0.25), 0.75 * 1 + 0.25 * 0.5, kCode + 1e-9);
  EXPECT_NEAR(at(3599.9), 0.6 * 0.5 + 0.4 * 1, kCode + 1e-9);
  EXPECT_NEAR(at(0.9), 0.6 * 1 + 0.4 * 0.25, kCode + 1e-9);
  EXPECT_NEAR(at(1800.3), 0.25, kCode + 1e-9);
}

// A gap shows the map below; where there is none the ground has its own colour.
TEST(Albedo, TheFirstWithAValueCounts) {
  const auto gap = [](std::uint32_t x, std::uint32_t) { return x < 100 ? 0.5 : kNaN; };
  const auto plain = [](std::uint32_t, std::uint32_t y) { return y < 100 ? 0.25 : kNaN; };
  const auto m = made(Kind::plane, {{300, 300, {gap}, 1.0}, {300, 300, {plain}, 0.5}});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  const auto at = [&](double column, double row, double size) {
    return m->albedo().at({-10 * row, 10 * column}, size).x;
  };
  for (const double size : {0.0, 5.0, 10.0, 17.0}) {
    EXPECT_NEAR(at(50, 50, size), 0.5, kCode);
    EXPECT_NEAR(at(150, 50, size), 0.5, kCode);  // 0.25 of white 0.5
    EXPECT_EQ(at(150, 150, size), 1);
    EXPECT_EQ(at(400, 50, size), 1);
    EXPECT_EQ(at(-1, 50, size), 1);
  }
  // the mean of a pixel with a gap is that of the rest
  EXPECT_NEAR(at(98, 150, 40), 0.5, kCode);
}

TEST(Albedo, ThreeBandsAreColours) {
  const auto grey = [](double v) { return [v](std::uint32_t, std::uint32_t) { return v; }; };
  const auto m = made(Kind::plane, {{20, 20, {grey(0.4), grey(0.2), grey(0.3)}, {}}});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  const Vec3 found = m->albedo().at({-100, 100}, 0);
  // their mean, 0.3, is white; half a code of 4/3
  EXPECT_NEAR(found.x, 4.0 / 3, 1.4 * kCode);
  EXPECT_NEAR(found.y, 2.0 / 3, 1.4 * kCode);
  EXPECT_NEAR(found.z, 1, 1.4 * kCode);
  // as materials of the ground see it
  EXPECT_EQ(Ground(std::make_shared<const Tiles>(*m->tiles)).albedo({100, -100, 0}, 0), found);
}

TEST(Albedo, DamagedTilesAreNamedAndLeftOut) {
  const auto m = made(Kind::plane, {{300, 300, {random_number}, 1.0}});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  const AlbedoMaps& whole = m->albedo();
  ASSERT_EQ(whole.tiles().size(), 13u);
  const auto offset =
      static_cast<std::size_t>(whole.bytes(1).data() - m->tiles->model().bytes().data());
  std::string bytes(reinterpret_cast<const char*>(m->tiles->model().bytes().data()),
                    m->tiles->model().bytes().size());
  bytes[offset + 5] ^= 1;
  DiagnosticLog log;
  const auto damaged = Tiles::open(m->folder.write("b.pan", bytes), log);
  ASSERT_TRUE(damaged) << to_text(log);
  EXPECT_EQ(damaged->albedo().at({-1000, 2800}, 0), Vec3(1));
  EXPECT_EQ(damaged->albedo().at({-1000, 1000}, 0), whole.at({-1000, 1000}, 0));
  damaged->report_damaged(log);
  EXPECT_THAT(to_text(log), HasSubstr("1 tiles of albedo maps"));
  EXPECT_FALSE(damaged->check(log));
  EXPECT_THAT(to_text(log), HasSubstr("tile 1 of the albedo maps"));
  DiagnosticLog good;
  EXPECT_TRUE(m->tiles->check(good)) << to_text(good);
}

// Every byte of the lists, changed or cut off, is refused.
TEST(Albedo, DamagedListsAreRefused) {
  const auto m = made(Kind::plane, {{300, 300, {random_number}, 1.0}});
  ASSERT_TRUE(m->tiles) << to_text(m->log);
  const auto all = m->tiles->model().bytes();
  const std::size_t begin =
      static_cast<std::size_t>(reinterpret_cast<const std::byte*>(m->albedo().maps().data()) -
                               all.data()) -
      sizeof(AlbedoHead);
  const std::size_t size = sizeof(AlbedoHead) + sizeof(AlbedoRecord) + 13 * sizeof(AlbedoTile);
  for (std::size_t k = 0; k < size; k += 3) {
    std::string bytes(reinterpret_cast<const char*>(all.data()), all.size());
    bytes[begin + k] = static_cast<char>(bytes[begin + k] + 1);
    DiagnosticLog log;
    EXPECT_FALSE(Tiles::open(m->folder.write("b.pan", bytes), log)) << k;
  }
  // lists that their hash does not protect
  const std::vector<std::byte> lists(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                     all.begin() + static_cast<std::ptrdiff_t>(begin + size));
  for (std::size_t count = 0; count < size; ++count) {
    AlbedoMaps maps;
    EXPECT_TRUE(AlbedoMaps::open({}, std::span(lists).first(count), maps)) << count;
  }
}

TEST(Albedo, RefusedAndWarnedOf) {
  const auto told = [](const std::unique_ptr<Made>& m) { return to_text(m->log); };
  const auto of = [](double v) { return [v](std::uint32_t, std::uint32_t) { return v; }; };
  EXPECT_THAT(told(made(Kind::plane, {{8, 8, {of(0)}, {}}})), HasSubstr("no albedo above 0"));
  EXPECT_THAT(told(made(Kind::plane, {{8, 8, {of(kNaN)}, {}}})), HasSubstr("no albedo above 0"));
  EXPECT_THAT(told(made(Kind::plane, {{8, 8, {of(1)}, {}}}, Kind::cylindrical, false)),
              HasSubstr("no places on a body"));
  EXPECT_THAT(told(made(Kind::cylindrical, {{8, 8, {of(1)}, {}}}, Kind::plane, false)),
              HasSubstr("the terrain is a plane"));
  const auto negative =
      made(Kind::plane,
           {{8, 8, {[](std::uint32_t x, std::uint32_t) { return x < 2 ? -1.0 : 0.5; }}, 0.5}});
  EXPECT_THAT(told(negative), HasSubstr("16 numbers are negative"));
  ASSERT_TRUE(negative->tiles);
  EXPECT_EQ(negative->albedo().at({-40, 5}, 0), Vec3(0));
}

}  // namespace
}  // namespace panwright::terrain::albedo_test
