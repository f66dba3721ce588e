// Terrain tiles against the heights that they were made of: values, bounds, errors by brute force.
#include "terrain/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/file.h"
#include "base/hash.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::tiles_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;

std::string text_of(const std::string& path) {
  DiagnosticLog log;
  const auto text = read_file(path, 1u << 30, log);
  return text ? *text : std::string();
}

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();

// Heights with waves, a cliff and noise.
struct Field {
  std::uint32_t width, height;
  std::vector<float> z;
  float at(std::uint32_t x, std::uint32_t y) const { return z[std::size_t{y} * width + x]; }
  float& at(std::uint32_t x, std::uint32_t y) { return z[std::size_t{y} * width + x]; }
};

Field made_field(std::uint32_t width, std::uint32_t height) {
  Field field{width, height, std::vector<float>(std::size_t{width} * height)};
  std::uint32_t state = 1;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      state = state * 1664525u + 1013904223u;
      field.at(x, y) = float(120 * std::sin(x * 0.02) * std::cos(y * 0.03) + (x > 300 ? 40 : 0) +
                             double(state >> 8) / (1 << 24));
    }
  return field;
}

struct Written {
  TilesReport report;
  std::optional<Tiles> tiles;
  std::string said;
  std::string file;
};

Written write(const Field& field, const TilesOptions& options, const TemporaryFolder& folder,
              std::size_t threads = 0,
              const std::string& map = "map info = {Local, 1, 1, 0, 0, 10, 10}\n") {
  std::string data;
  for (const float z : field.z) data += bytes_of(z, false);
  (void)folder.write("a.dat", data);
  const std::string path =
      folder.write("a.hdr", "ENVI\nsamples = " + std::to_string(field.width) +
                                "\nlines = " + std::to_string(field.height) +
                                "\nbands = 1\ndata type = 4\nbyte order = 0\n" + map);
  DiagnosticLog log;
  DemOptions reading;
  reading.unit = 1;
  auto dem = Dem::open(path, reading, log);
  Written out;
  out.file = folder / "a.pan";
  const Job job(JobOptions{threads, {}});
  if (dem) {
    const auto report = write_tiles({&*dem, 1}, out.file, options, log, job);
    if (report) {
      out.report = *report;
      auto tiles = Tiles::open(out.file, log);
      if (tiles) out.tiles = *std::move(tiles);
    }
  }
  out.said = to_text(log);
  return out;
}

// Place of a level's post among those of level 0.
std::uint32_t place(std::uint32_t post, std::uint32_t level, std::uint32_t all) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t{post} << level, all - 1));
}

// Every post of every tile is that of the source, within `step` / 2.
void expect_posts(const Field& field, const Tiles& tiles, double step) {
  for (std::uint32_t t = 0; t < tiles.records().size(); ++t) {
    const TileRecord& record = tiles.records()[t];
    const auto view = tiles.view(t);
    const LevelSide across = level_side(field.width, record.level),
                    down = level_side(field.height, record.level);
    for (std::uint32_t j = 0; j < kTilePosts; ++j)
      for (std::uint32_t i = 0; i < kTilePosts; ++i) {
        const std::uint32_t x = record.column * kTileCells + i, y = record.row * kTileCells + j;
        const double z = view ? view->height(i, j) : double(kVoid);
        if (x >= across.posts || y >= down.posts) {
          ASSERT_TRUE(std::isnan(z));
          continue;
        }
        const float source =
            field.at(place(x, record.level, field.width), place(y, record.level, field.height));
        ASSERT_EQ(std::isnan(z), std::isnan(source)) << tile_words(tiles, t);
        if (!std::isnan(z)) {
          ASSERT_LE(std::fabs(z - double(source)), step / 2) << tile_words(tiles, t);
        }
      }
  }
}

// Height of a level's triangles at a post of level 0; NaN where a corner is void.
double level_height(const Field& field, std::uint32_t level, std::uint32_t x, std::uint32_t y) {
  const auto cell = [&](std::uint32_t at, std::uint32_t all, double& part) {
    std::uint32_t low = at >> level << level;
    if (low + 1 >= all && all > 1) low = (all - 2) >> level << level;
    const std::uint32_t high = place((low >> level) + 1, level, all);
    part = high > low ? double(at - low) / double(high - low) : 0;
    return std::pair(low, high);
  };
  double u = 0, v = 0;
  const auto [xa, xb] = cell(x, field.width, u);
  const auto [ya, yb] = cell(y, field.height, v);
  const double a = field.at(xa, ya), b = field.at(xb, ya), c = field.at(xa, yb),
               d = field.at(xb, yb);
  return u >= v ? a + u * (b - a) + v * (d - b) : a + v * (c - a) + u * (d - c);
}

// Records hold the extremes and the true error of all posts, nested upwards.
void expect_bounds(const Field& field, const Tiles& tiles) {
  for (std::uint32_t t = 0; t < tiles.records().size(); ++t) {
    const TileRecord& record = tiles.records()[t];
    const std::uint64_t unit = std::uint64_t{kTileCells} << record.level;
    const auto end = [&](std::uint32_t tile, std::uint32_t all) {
      return static_cast<std::uint32_t>(std::min<std::uint64_t>((tile + 1) * unit, all - 1));
    };
    float low = std::numeric_limits<float>::infinity(), high = -low;
    double error = 0;
    for (auto y = static_cast<std::uint32_t>(record.row * unit); y <= end(record.row, field.height);
         ++y)
      for (auto x = static_cast<std::uint32_t>(record.column * unit);
           x <= end(record.column, field.width); ++x) {
        const float z = field.at(x, y);
        low = std::min(low, z);
        high = std::max(high, z);
        for (std::uint32_t level = 1; level <= record.level; ++level)
          error = std::max(error, std::fabs(double(z) - level_height(field, level, x, y)));
      }
    EXPECT_EQ(record.low, low) << tile_words(tiles, t);
    EXPECT_EQ(record.high, high) << tile_words(tiles, t);
    EXPECT_GE(record.error, error) << tile_words(tiles, t);
    // measured: 1.2e-4 m of 281 m of relief
    EXPECT_LE(record.error, error + 1e-6 * (high - low)) << tile_words(tiles, t);
    const auto view = tiles.view(t);
    if (!view) continue;
    const std::uint64_t block = unit / kMipBlocks;
    for (std::uint32_t y = 0; y <= end(record.row, field.height) - record.row * unit; ++y)
      for (std::uint32_t x = 0; x <= end(record.column, field.width) - record.column * unit; ++x) {
        const auto bx = std::min<std::uint64_t>(x / block, kMipBlocks - 1),
                   by = std::min<std::uint64_t>(y / block, kMipBlocks - 1);
        ASSERT_GE(view->mip(static_cast<std::uint32_t>(bx), static_cast<std::uint32_t>(by)),
                  field.at(static_cast<std::uint32_t>(record.column * unit + x),
                           static_cast<std::uint32_t>(record.row * unit + y)));
      }
  }
}

TEST(Tiles, FloatsAreExact) {
  const TemporaryFolder folder;
  const Field field = made_field(700, 301);
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  EXPECT_EQ(out.report.error, 0);
  const ChartRecord& chart = out.tiles->charts().front();
  EXPECT_EQ(chart.levels, 3u);
  EXPECT_EQ(chart.tile_count, 3u * 2 + 2 * 1 + 1);
  EXPECT_EQ(chart.dx, 10);
  expect_posts(field, *out.tiles, 0);
  expect_bounds(field, *out.tiles);
}

TEST(Tiles, CodesStayWithinTheirErrorAndMeet) {
  const TemporaryFolder folder;
  const Field field = made_field(520, 260);
  TilesOptions options;
  options.error = 0.3;
  const Written out = write(field, options, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  EXPECT_EQ(out.tiles->charts().front().step, 0.5);
  EXPECT_LE(out.report.error, 0.25);
  EXPECT_GT(out.report.error, 0.2);
  EXPECT_EQ(out.report.float_tiles, 0u);
  expect_posts(field, *out.tiles, 0.5);
  const auto left = out.tiles->view(out.tiles->index(0, 0, 0, 0)),
             right = out.tiles->view(out.tiles->index(0, 0, 1, 0));
  ASSERT_TRUE(left && right);
  for (std::uint32_t y = 0; y < kTilePosts; ++y)
    EXPECT_EQ(left->height(kTileCells, y), right->height(0, y));
}

// Relief of more than 65,535 steps is stored as floats, of the same multiples.
TEST(Tiles, LargeReliefIsFloats) {
  const TemporaryFolder folder;
  Field field = made_field(300, 20);
  field.at(10, 10) = 50000;
  TilesOptions options;
  options.error = 0.25;
  const Written out = write(field, options, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  EXPECT_EQ(out.report.float_tiles, 2u);  // of both levels; the second tile of level 0 is codes
  expect_posts(field, *out.tiles, 0.5);
  field.at(11, 10) = 1e8f;
  const Written beyond = write(field, options, folder);
  EXPECT_NE(beyond.said.find("E9612"), std::string::npos) << beyond.said;
}

TEST(Tiles, VoidsAreKept) {
  const TemporaryFolder folder;
  Field field = made_field(400, 300);
  for (std::uint32_t y = 100; y < 103; ++y)
    for (std::uint32_t x = 50; x < 90; ++x) field.at(x, y) = kVoid;
  for (std::uint32_t y = 0; y < 300; ++y)
    for (std::uint32_t x = 256; x < 400; ++x) field.at(x, y) = kVoid;
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  expect_posts(field, *out.tiles, 0);
  const auto records = out.tiles->records();
  EXPECT_EQ(records[0].voids, 3u * 40 + 257);
  EXPECT_EQ(records[0].void_kinds, 1u << unsigned(VoidKind::not_finite));
  EXPECT_EQ(records[1].form, std::uint32_t(TileForm::nothing));
  EXPECT_EQ(records[1].length, 0u);
  // a hole of three rows is lost in level 1, and its border moves: said so
  EXPECT_TRUE(std::isinf(records.back().error));
  Field empty = made_field(20, 20);
  std::ranges::fill(empty.z, kVoid);
  EXPECT_NE(write(empty, {}, folder).said.find("E9612"), std::string::npos);
}

TEST(Tiles, OnePostAndOneRow) {
  const TemporaryFolder folder;
  for (const auto& [w, h] : {std::pair{1u, 1u}, {1u, 600u}, {513u, 1u}, {257u, 257u}}) {
    const Field field = made_field(w, h);
    const Written out = write(field, {}, folder);
    ASSERT_TRUE(out.tiles) << out.said;
    expect_posts(field, *out.tiles, 0);
  }
}

// Levels above 8 take their errors from the posts of level 8.
TEST(Tiles, ManyLevels) {
  const TemporaryFolder folder;
  const Field field = made_field(70000, 3);
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  EXPECT_EQ(out.tiles->charts().front().levels, 10u);
  expect_posts(field, *out.tiles, 0);
  double error = 0;
  for (std::uint32_t y = 0; y < 3; ++y)
    for (std::uint32_t x = 0; x < field.width; ++x)
      error = std::max(error, std::fabs(double(field.at(x, y)) - level_height(field, 9, x, y)));
  const float stated = out.tiles->records().back().error;
  EXPECT_GE(stated, error);
  EXPECT_LE(stated, 2 * error);  // measured: 1.59
}

// Slope moments of a plane.
TEST(Tiles, SlopesOfAPlane) {
  const TemporaryFolder folder;
  Field field{300, 290, {}};
  for (std::uint32_t y = 0; y < field.height; ++y)
    for (std::uint32_t x = 0; x < field.width; ++x) field.z.push_back(float(x) - 2 * float(y));
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  for (const TileRecord& record : out.tiles->records()) {
    const double want[5] = {0.1, -0.2, 0.01, 0.04, -0.02};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(record.slope[i], want[i], 1e-7);
    EXPECT_NEAR(record.error, 0, 1e-3);  // measured: 3.1e-4 of 877 m, the bound of rounding
  }
}

TEST(Tiles, SameBytesOfAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Field field = made_field(700, 301);
  TilesOptions options;
  options.error = 0.01;
  const std::string one = text_of(write(field, options, folder, 1).file);
  const std::string two = text_of(write(field, options, folder, 2).file);
  EXPECT_FALSE(one.empty());
  EXPECT_TRUE(one == two);
}

// A damaged tile is named and left out; the others stay.
TEST(Tiles, DamagedTilesAreNamed) {
  const TemporaryFolder folder;
  const Field field = made_field(700, 301);
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  std::string bytes = text_of(out.file);
  const TileRecord& record = out.tiles->records()[4];
  // the section of tiles is the first of the file
  bytes[128 + record.offset + 5000] ^= 1;
  const std::string damaged = folder.write("damaged.pan", bytes);
  DiagnosticLog log;
  const auto tiles = Tiles::open(damaged, log);
  ASSERT_TRUE(tiles) << to_text(log);
  EXPECT_FALSE(tiles->view(4));
  EXPECT_TRUE(tiles->is_damaged(4));
  EXPECT_TRUE(tiles->view(3));
  // told once to those who left it out, and by every check
  DiagnosticLog left_out;
  tiles->report_damaged(left_out);
  tiles->report_damaged(left_out);
  ASSERT_EQ(left_out.entries().size(), 1u);
  EXPECT_EQ(left_out.entries()[0].code, Code("W9615"));
  EXPECT_FALSE(tiles->view(4));
  EXPECT_FALSE(tiles->check(log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E9611"));
  for (const DiagnosticLog* said : {&log, &left_out})
    EXPECT_NE(said->entries()[0].message.find("level 0, column 1, row 1"), std::string::npos)
        << to_text(*said);
  DiagnosticLog sound;
  EXPECT_TRUE(out.tiles->check(sound));
  out.tiles->report_damaged(sound);
  EXPECT_TRUE(sound.entries().empty());
}

// Of many damaged tiles the first are named, and the others counted.
TEST(Tiles, ManyDamagedTilesAreCounted) {
  const TemporaryFolder folder;
  const Written out = write(made_field(1100, 700), {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  std::string bytes = text_of(out.file);
  for (std::uint32_t i = 0; i < 12; ++i) bytes[128 + out.tiles->records()[i].offset] ^= 1;
  DiagnosticLog log;
  const auto tiles = Tiles::open(folder.write("damaged.pan", bytes), log);
  ASSERT_TRUE(tiles) << to_text(log);
  for (std::uint32_t i = 0; i < 15; ++i) EXPECT_EQ(tiles->view(i).has_value(), i >= 12);
  tiles->report_damaged(log);
  ASSERT_EQ(log.entries().size(), 9u);
  EXPECT_EQ(log.entries()[8].message, "4 more tiles are left out");
}

// Bytes between tiles lie under no hash of a tile; a check looks at them.
TEST(Tiles, PaddingIsChecked) {
  const TemporaryFolder folder;
  const Written out = write(made_field(700, 301), {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  std::string bytes = text_of(out.file);
  const TileRecord& record = out.tiles->records()[2];
  ASSERT_NE((record.offset + record.length) % 64, 0u);
  bytes[128 + record.offset + record.length] = 1;
  DiagnosticLog log;
  const auto tiles = Tiles::open(folder.write("damaged.pan", bytes), log);
  ASSERT_TRUE(tiles) << to_text(log);
  for (std::uint32_t i = 0; i < tiles->records().size(); ++i) EXPECT_TRUE(tiles->view(i));
  EXPECT_FALSE(tiles->check(log));
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E9611"));
}

// Version 1 had no blocks of slopes.
TEST(Tiles, OfVersionOne) {
  const TemporaryFolder folder;
  const Written out = write(made_field(1100, 40), {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  const auto last = static_cast<std::uint32_t>(out.tiles->records().size() - 1);
  ASSERT_EQ(out.tiles->records()[last].level, kSlopeLevel);
  ASSERT_EQ(out.tiles->view(last)->slopes.size(), std::size_t{kSlopeBlocks} * kSlopeBlocks);
  std::string bytes = text_of(out.file);
  const pan::layout::DirectoryEntry& entry = out.tiles->model().directory().front();
  char* section = bytes.data() + entry.offset;
  TilesTail tail;
  char* const end = section + entry.raw_length - sizeof tail;
  std::memcpy(&tail, end, sizeof tail);
  const auto bytes_at = [](const char* at, std::size_t count) {
    return std::as_bytes(std::span(at, count));
  };
  TileRecord record;
  char* const place = section + tail.tiles_offset + last * sizeof record;
  std::memcpy(&record, place, sizeof record);
  record.length -= static_cast<std::uint32_t>(4 + kSlopeBlocks * kSlopeBlocks * sizeof(SlopeBlock));
  record.hash = hash64(bytes_at(section + record.offset, record.length));
  std::memcpy(place, &record, sizeof record);
  for (const std::uint32_t version : {1u, 3u}) {
    tail.version = version;
    Hasher hasher;
    hasher.update(bytes_at(section + tail.charts_offset,
                           static_cast<std::size_t>(end - section) - tail.charts_offset));
    hasher.update(std::as_bytes(std::span(&tail, 1)).first(offsetof(TilesTail, hash)));
    tail.hash = hasher.digest64();
    std::memcpy(end, &tail, sizeof tail);
    DiagnosticLog log;
    const auto tiles = Tiles::open(folder.write("old.pan", bytes), log);
    ASSERT_EQ(bool(tiles), version == 1) << to_text(log);
    if (!tiles) continue;
    ASSERT_TRUE(tiles->view(last));
    EXPECT_TRUE(tiles->view(last)->slopes.empty());
  }
}

// Any byte of the lists and the tail may be wrong: the file is refused, or read as it was.
TEST(Tiles, DamagedListsAreRefused) {
  const TemporaryFolder folder;
  const Field field = made_field(20, 20);
  const Written out = write(field, {}, folder);
  ASSERT_TRUE(out.tiles) << out.said;
  const std::string whole = text_of(out.file);
  const pan::layout::DirectoryEntry& entry = out.tiles->model().directory().front();
  ASSERT_EQ(entry.kind, kTilesSection);
  const std::size_t end = entry.offset + entry.raw_length;
  const std::size_t lists = sizeof(TilesTail) + sizeof(TileRecord) + sizeof(ChartRecord);
  int refused = 0;
  for (std::size_t at = end - lists; at < end; at += 3) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x41);
    DiagnosticLog log;
    const auto tiles = Tiles::open(folder.write("b.pan", bytes), log);
    refused += !tiles;
    // reserved words of the tail lie under no hash of its own
    if (tiles) {
      EXPECT_GE(at, end - 16);
    }
  }
  EXPECT_GE(refused, int(lists / 3) - 6);
}

}  // namespace
}  // namespace panwright::terrain::tiles_test
