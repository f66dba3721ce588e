// Rays of beams against the same rays alone, and the tiles that far views look at.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "base/random.h"
#include "terrain/ground.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::beams_test {
namespace {

using support::TemporaryFolder;
using testing_support::bytes_of;
using testing_support::Kind;
using testing_support::label_of;
using testing_support::place_of;

constexpr std::uint32_t kWidth = 1025, kHeight = 515;

std::shared_ptr<const Tiles> hills(Kind kind, std::uint32_t width, std::uint32_t height,
                                   double size) {
  std::string data;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      data += bytes_of(static_cast<float>(size * std::sin(x * 0.11) * std::cos(y * 0.07)), false);
  return tiles_of(kind, data, label_of(kind, width, height));
}

double drawn(std::uint32_t i, std::uint32_t use) {
  return in_unit(philox({i, use, 0, 0}, {11, 0})[0]) - 0.5;
}
Vec3 drawn_vector(std::uint32_t i, std::uint32_t use) {
  return {drawn(i, use), drawn(i, use + 1), drawn(i, use + 2)};
}

struct Counts {
  int hits = 0, misses = 0, blocked = 0;
};

void expect_same(const Ground& ground, const Vec3& origin, const Vec3& direction,
                 const GroundLevels* levels, const GroundBeam& beam, Counts& counts) {
  constexpr double kFar = 1e9;
  const auto alone = ground.nearest(origin, direction, 0, kFar, levels);
  const auto found = ground.nearest(origin, direction, 0, kFar, levels, &beam);
  ASSERT_EQ(found.has_value(), alone.has_value());
  ASSERT_EQ(ground.is_blocked(origin, direction, 0, kFar, levels, &beam),
            ground.is_blocked(origin, direction, 0, kFar, levels));
  (alone ? counts.hits : counts.misses) += 1;
  if (!alone) return;
  EXPECT_EQ(found->distance, alone->distance);
  EXPECT_EQ(found->point.level, alone->point.level);
  EXPECT_EQ(found->point.column, alone->point.column);
  EXPECT_EQ(found->point.row, alone->point.row);
}

// From above the ground and from far away, narrow and wide; of the finest level and of several.
void expect_beams(Kind kind) {
  const Ground ground(hills(kind, kWidth, kHeight, 60));
  Counts counts;
  int beams = 0, outside = 0;
  for (std::uint32_t k = 0; k < 300; ++k) {
    const auto post = [&](std::uint32_t use) {
      return place_of(kind, static_cast<std::uint32_t>((drawn(k, use) + 0.5) * (kWidth - 1)),
                      static_cast<std::uint32_t>((drawn(k, use + 1) + 0.5) * (kHeight - 1)), 0,
                      kWidth, kHeight);
    };
    const Vec3 aim = post(0);
    const Vec3 up = kind == Kind::plane ? Vec3(0, 0, 1) : glm::normalize(aim);
    const double away = k % 3 == 0 ? 200 : k % 3 == 1 ? 4000 : 1e6;
    const Vec3 eye = aim + away * glm::normalize(up + 1.4 * drawn_vector(k, 2));
    const GroundLevels levels = ground.levels(eye, 0.01);
    const GroundLevels* used = k % 2 == 0 ? &levels : nullptr;
    const RayBeam about{eye, k % 5 == 0 ? 30.0 : 0.0, glm::normalize(aim - eye),
                        k % 4 == 0 ? 0.2 : 0.01};
    const auto beam = ground.beam(about, used);
    if (!beam) continue;
    ++beams;
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::uint32_t use = 10 + 6 * i;
      // one in ten is not of the beam
      const double much = i % 10 == 9 ? 8 : 1;
      outside += i % 10 == 9;
      const Vec3 origin = eye + much * about.radius * drawn_vector(k, use);
      const Vec3 direction =
          glm::normalize(about.axis + much * about.angle * drawn_vector(k, use + 3));
      expect_same(ground, origin, direction, used, *beam, counts);
    }
  }
  printf("%d beams: %d hits, %d misses\n", beams, counts.hits, counts.misses);
  EXPECT_GT(beams, 150);
  EXPECT_GT(counts.hits, 1000);
  EXPECT_GT(counts.misses, 100);
  EXPECT_GT(outside, 100);
}
TEST(GroundBeam, OnAPlane) { expect_beams(Kind::plane); }
TEST(GroundBeam, OnACylindricalMap) { expect_beams(Kind::cylindrical); }
TEST(GroundBeam, OnAPolarMap) { expect_beams(Kind::polar); }

// A square of 16 x 16 pixels about a point, together and one by one; most: metres, of every third.
void expect_together(const Ground& ground, const Vec3& eye, const Vec3& aim, double pixel,
                     const GroundLevels* levels, double most, Counts& counts) {
  const Vec3 axis = glm::normalize(aim - eye);
  const Vec3 right = glm::normalize(glm::cross(axis, Vec3(0.3, 0.2, 1))),
             down = glm::cross(axis, right);
  std::vector<Vec3> directions;
  std::vector<double> ends;
  for (int k = 0; k < 256; ++k) {
    directions.push_back(
        glm::normalize(axis + pixel * (k % 16 - 7.5) * right + pixel * (k / 16 - 7.5) * down));
    ends.push_back(k % 3 == 0 ? most : 1e9);
  }
  const auto beam = ground.beam({eye, 0, axis, 12 * pixel}, levels);
  std::vector<std::optional<GroundHit>> found(directions.size());
  ground.nearest(eye, directions, ends, found, levels, beam ? &*beam : nullptr);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const auto alone = ground.nearest(eye, directions[k], 0, ends[k], levels);
    ASSERT_EQ(found[k].has_value(), alone.has_value()) << k;
    (alone ? counts.hits : counts.misses) += 1;
    if (!alone) continue;
    ASSERT_EQ(found[k]->distance, alone->distance) << k;
    ASSERT_EQ(found[k]->point.position, alone->point.position) << k;
    ASSERT_EQ(found[k]->point.normal, alone->point.normal) << k;
    ASSERT_EQ(found[k]->point.level, alone->point.level) << k;
    ASSERT_EQ(found[k]->point.column, alone->point.column) << k;
    ASSERT_EQ(found[k]->point.row, alone->point.row) << k;
    ASSERT_EQ(found[k]->point.triangle, alone->point.triangle) << k;
  }
}

// From 0.2 m to 1,000 km, from below the ground too, of pixels wider and much narrower than cells.
void expect_squares(const Ground& ground, Kind kind, std::uint32_t width, std::uint32_t height) {
  Counts counts;
  for (std::uint32_t k = 0; k < 240 && !testing::Test::HasFatalFailure(); ++k) {
    const auto post = [&](std::uint32_t use) {
      return place_of(kind, static_cast<std::uint32_t>((drawn(k, use) + 0.5) * (width - 1)),
                      static_cast<std::uint32_t>((drawn(k, use + 1) + 0.5) * (height - 1)), 0,
                      width, height);
    };
    const Vec3 foot = post(0);
    const Vec3 up = kind == Kind::plane ? Vec3(0, 0, 1) : glm::normalize(foot);
    const auto below = ground.nearest(foot + 5000.0 * up, -up);
    constexpr double kAbove[] = {-3, 0.2, 20, 400, 10000, 1e6};
    const double away = kAbove[k % 6];
    const Vec3 eye = (below ? below->point.position : foot) + away * up;
    // some past the horizon
    const Vec3 aim = away > 1e4 ? post(2) : eye + drawn_vector(k, 2) - 0.2 * up;
    constexpr double kPixels[] = {1e-6, 1e-4, 1e-3, 0.01};
    const double pixel = kPixels[k / 6 % 4];
    const GroundLevels levels = ground.levels(eye, 0.5 * pixel);
    expect_together(ground, eye, aim, pixel, k % 5 < 3 ? &levels : nullptr, away + 30, counts);
  }
  printf("squares: %d hits, %d misses\n", counts.hits, counts.misses);
  EXPECT_GT(counts.hits, 20000);
  EXPECT_GT(counts.misses, 3000);
}
TEST(GroundBeam, SquaresOnAPlane) {
  expect_squares(Ground(hills(Kind::plane, kWidth, kHeight, 60)), Kind::plane, kWidth, kHeight);
}
TEST(GroundBeam, SquaresOnACylindricalMap) {
  expect_squares(Ground(hills(Kind::cylindrical, kWidth, kHeight, 300)), Kind::cylindrical, kWidth,
                 kHeight);
}
TEST(GroundBeam, SquaresOnAPolarMap) {
  expect_squares(Ground(hills(Kind::polar, kWidth, kHeight, 300)), Kind::polar, kWidth, kHeight);
}

std::optional<Dem> plane_of(const TemporaryFolder& folder, const std::string& name, int side,
                            const std::string& map, const std::function<float(int, int)>& height,
                            DiagnosticLog& log) {
  std::string data;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) data += bytes_of(height(x, y), false);
  (void)folder.write(name + ".dat", data);
  const std::string posts = std::to_string(side);
  const auto path =
      folder.write(name + ".hdr", "ENVI\nsamples = " + posts + "\nlines = " + posts +
                                      "\nbands = 1\ndata type = 4\nbyte order = 0\nmap info = "
                                      "{Local, 1, 1, " +
                                      map + "}\n");
  DemOptions reading;
  reading.unit = 1;
  reading.quantity = Quantity::height;
  auto dem = Dem::open(path, reading, log);
  if (!dem) return {};
  return *std::move(dem);
}

// Of two maps that overlap, the lower one with voids, the first counts.
TEST(GroundBeam, SquaresOnMapsThatOverlap) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  std::vector<Dem> dems;
  for (int k = 0; k < 2; ++k) {
    const auto height = [&](int x, int y) {
      if (k == 0 && x % 37 == 5 && y % 11 < 6) return NAN;
      return static_cast<float>(40 * std::sin(x * 0.11) * std::cos(y * 0.07) + 25 * k);
    };
    auto dem = plane_of(folder, k == 0 ? "a" : "b", 300,
                        k == 0 ? "0, 0, 10, 10" : "1000, -700, 10, 10", height, log);
    ASSERT_TRUE(dem) << to_text(log);
    dems.push_back(*std::move(dem));
  }
  ASSERT_TRUE(write_tiles(dems, folder / "c.pan", {}, log)) << to_text(log);
  auto tiles = Tiles::open(folder / "c.pan", log);
  ASSERT_TRUE(tiles) << to_text(log);
  ASSERT_EQ(tiles->charts().size(), 2u);
  expect_squares(Ground(std::make_shared<const Tiles>(*std::move(tiles))), Kind::plane, 350, 330);
}

// A cell of the second map with a ridge: its near side is covered by the first map, its far side is
// not.
TEST(GroundBeam, SquaresOnACellThatAMapCoversInPart) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  std::vector<Dem> dems;
  auto flat = plane_of(
      folder, "flat", 101, "-5, 505, 10, 10", [](int, int) { return 0.f; }, log);
  auto ridge = plane_of(
      folder, "ridge", 9, "900, 150, 100, 100",
      [](int x, int y) { return (x == 0 && y == 0) || (x == 1 && y == 1) ? 40.f : 0.f; }, log);
  ASSERT_TRUE(flat && ridge) << to_text(log);
  dems.push_back(*std::move(flat));
  dems.push_back(*std::move(ridge));
  ASSERT_TRUE(write_tiles(dems, folder / "c.pan", {}, log)) << to_text(log);
  auto tiles = Tiles::open(folder / "c.pan", log);
  ASSERT_TRUE(tiles) << to_text(log);
  const Ground ground(std::make_shared<const Tiles>(*std::move(tiles)));
  const Vec3 eye(900, -50, 30), aim(1000, 50, 15);
  const auto hit = ground.nearest(eye, glm::normalize(aim - eye));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.position.x, 1038.46, 0.01);
  Counts counts;
  expect_together(ground, eye, aim, 1e-4, nullptr, 1e9, counts);
  EXPECT_EQ(counts.hits, 256);
}

// Cells beside a damaged tile keep their own posts, whatever was shaded before.
TEST(GroundBeam, ShadingBesideADamagedTileMakesNoHoles) {
  const auto sound = hills(Kind::plane, kWidth, kHeight, 60);
  ASSERT_TRUE(sound);
  const auto all = sound->model().bytes();
  std::string bytes(reinterpret_cast<const char*>(all.data()), all.size());
  for (const TileRecord& record : sound->records())
    if (record.level == 0 && record.column == 0 && record.row == 0)
      bytes[128 + record.offset + 5000] ^= 1;
  const TemporaryFolder folder;
  DiagnosticLog log;
  auto tiles = Tiles::open(folder.write("damaged.pan", bytes), log);
  ASSERT_TRUE(tiles) << to_text(log);
  const Ground ground(std::make_shared<const Tiles>(*std::move(tiles)));
  int hits = 0;
  for (const auto& [x, y] : {std::pair(256, 100), {100, 256}, {256, 256}, {257, 100}}) {
    const Vec3 above(10 * x + 8, -10 * y - 8, 1000);
    const auto first = ground.nearest(above, {0, 0, -1});
    ASSERT_TRUE(first) << x;
    (void)ground.smooth(first->point);
    const auto again = ground.nearest(above, {0, 0, -1});
    ASSERT_TRUE(again) << x;
    EXPECT_EQ(again->distance, first->distance);
    ++hits;
  }
  EXPECT_EQ(hits, 4);
  EXPECT_FALSE(ground.nearest({1000, -1000, 1000}, {0, 0, -1}));
}

// Rays to a light, from the ground: those that rise faster than it are not looked for, and the
// others are blocked as ever.
void expect_light(Kind kind, double size) {
  const Ground ground(hills(kind, kWidth, kHeight, size));
  int blocked = 0, open = 0;
  for (std::uint32_t k = 0; k < 4000; ++k) {
    const auto x = static_cast<std::uint32_t>((drawn(k, 0) + 0.5) * (kWidth - 1)),
               y = static_cast<std::uint32_t>((drawn(k, 1) + 0.5) * (kHeight - 1));
    const Vec3 foot = place_of(kind, x, y, 0, kWidth, kHeight);
    const Vec3 up = kind == Kind::plane ? Vec3(0, 0, 1) : glm::normalize(foot);
    const auto here = ground.nearest(foot + 5000.0 * up, -up);
    if (!here) continue;
    const Vec3 origin = here->point.position + 0.001 * up;
    const Vec3 aside = glm::normalize(glm::cross(up, drawn_vector(k, 2)));
    const double elevation = (drawn(k, 5) + 0.5) * 1.2;
    const Vec3 to_light = std::cos(elevation) * aside + std::sin(elevation) * up;
    const double wide = k % 3 == 0 ? 300 : 1;
    const Vec3 axis = glm::normalize(to_light + 0.003 * drawn_vector(k, 12));
    const auto beam =
        ground.beam({origin + wide * drawn_vector(k, 8), wide, axis, 0.005, true}, nullptr);
    ASSERT_TRUE(beam);
    const bool want = ground.is_blocked(origin, to_light, 0, 1e9);
    EXPECT_EQ(ground.is_blocked(origin, to_light, 0, 1e9, nullptr, &*beam), want) << k;
    (want ? blocked : open) += 1;
  }
  printf("%d rays blocked, %d not\n", blocked, open);
  EXPECT_GT(blocked, 200);
  EXPECT_GT(open, 1000);
}
TEST(GroundBeam, LightOnAPlane) { expect_light(Kind::plane, 60); }
TEST(GroundBeam, LightOnACylindricalMap) { expect_light(Kind::cylindrical, 300); }
TEST(GroundBeam, LightOnAPolarMap) { expect_light(Kind::polar, 300); }

// A far view of the level before the first with slopes: the finer tiles, all damaged, are not
// looked at, and each tile has one tree of a fifth of a megabyte.
TEST(GroundBeam, FarViewsLeaveFineTilesAlone) {
  constexpr std::uint32_t kLong = 2300, kShort = 515, kLevel = kSlopeLevel - 1;
  const auto sound = hills(Kind::plane, kLong, kShort, 60);
  ASSERT_TRUE(sound);
  const auto all = sound->model().bytes();
  std::string bytes(reinterpret_cast<const char*>(all.data()), all.size());
  std::size_t tiles_of_level = 0;
  for (const TileRecord& record : sound->records()) {
    tiles_of_level += record.level == kLevel;
    // the section of tiles is the first of the file
    if (record.level < kLevel) bytes[128 + record.offset + 5000] ^= 1;
  }
  const TemporaryFolder folder;
  DiagnosticLog log;
  auto tiles = Tiles::open(folder.write("damaged.pan", bytes), log);
  ASSERT_TRUE(tiles) << to_text(log);
  const Ground ground(std::make_shared<const Tiles>(*std::move(tiles)), Ground::kTreeBytes, 0);
  const Vec3 eye(11500, -2570, 1e6);
  const GroundLevels levels = ground.levels(eye, 35e-6);
  int hits = 0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const Vec3 aim(11500 + 22000 * drawn(k, 0), -2570 + 5000 * drawn(k, 1), 0);
    const auto hit = ground.nearest(eye, glm::normalize(aim - eye), 0, 1e9, &levels);
    ASSERT_TRUE(hit) << k;
    EXPECT_EQ(hit->point.level, kLevel);
    EXPECT_TRUE(ground.relief(hit->point)) << k;
    ++hits;
  }
  for (std::uint32_t t = 0; t < ground.tiles().records().size(); ++t)
    EXPECT_FALSE(ground.tiles().is_damaged(t)) << t;
  EXPECT_GT(hits, 100);
  EXPECT_LT(ground.tree_bytes(), tiles_of_level * 220'000);
  EXPECT_GT(ground.tree_bytes(), 0u);
}

}  // namespace
}  // namespace panwright::terrain::beams_test
