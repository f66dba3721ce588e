#include "preview/model/texture_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/image.h"
#include "preview/frame/samples.h"

namespace panwright::preview::texture_levels_test {
namespace {

std::vector<std::uint8_t> noise(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> codes;
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < std::size_t{4} * width * height; ++i) {
    state = state * 1664525u + 1013904223u;  // Numerical Recipes' quick generator
    codes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return codes;
}

std::vector<TextureLevel> texture_levels(std::span<const std::uint8_t> codes, std::uint32_t width,
                                         std::uint32_t height, bool linear) {
  return with_levels_below(decoded_level(codes, width, height, linear));
}

TEST(TextureLevels, BottomRowFirstAndDecoded) {
  const std::vector<std::uint8_t> codes{255, 128, 0, 255, 10, 20, 30, 51,  // top row
                                        1,   2,   3, 4,   5,  6,  7,  8};
  const auto levels = texture_levels(codes, 2, 2, false);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_FLOAT_EQ(levels[0].rgba[8], 1);
  EXPECT_EQ(levels[0].rgba[9], static_cast<float>(image::srgb_decoded(128)));
  EXPECT_FLOAT_EQ(levels[0].rgba[15], 0.2f);  // alpha is linear
  EXPECT_EQ(levels[0].rgba[0], static_cast<float>(image::srgb_decoded(1)));
  const auto linear = texture_levels(codes, 2, 2, true);
  EXPECT_FLOAT_EQ(linear[0].rgba[9], 128 / 255.0f);
}

// A box filter with shares keeps the mean whatever the sides; a 2×2 filter that drops the last odd
// row and column does not.
TEST(TextureLevels, EveryLevelHasTheMeanOfTheFirst) {
  for (const auto& [width, height] : {std::pair{64u, 64u},
                                      {100u, 60u},
                                      {127u, 1u},
                                      {1u, 37u},
                                      {255u, 129u},
                                      {3u, 3u},
                                      {1u, 1u}}) {
    const auto levels = texture_levels(noise(width, height), width, height, false);
    EXPECT_EQ(levels.size(), 1 + static_cast<std::size_t>(std::log2(std::max(width, height))));
    std::vector<double> means;
    for (const TextureLevel& level : levels) {
      double sum = 0;
      for (std::size_t i = 0; i < level.rgba.size(); i += 4) sum += level.rgba[i];
      means.push_back(sum / (level.width * level.height));
      // measured 4e-8: each level is rounded to float once
      EXPECT_NEAR(means.back() / means.front(), 1, 2e-7) << width << 'x' << height;
    }
    EXPECT_EQ(levels.back().width, 1u);
    EXPECT_EQ(levels.back().height, 1u);
  }
}

TEST(TextureLevels, ConstantStaysConstant) {
  const auto levels = texture_levels(std::vector<std::uint8_t>(4 * 97 * 41, 200), 97, 41, false);
  const auto value = static_cast<float>(image::srgb_decoded(200));
  for (const TextureLevel& level : levels)
    for (std::size_t i = 0; i < level.rgba.size(); i += 4)
      EXPECT_NEAR(level.rgba[i] / value, 1, 1.2e-7);  // one rounding
}

TEST(Samples, TilesCoverTheImageOnce) {
  for (const auto& [width, height, side] :
       {std::tuple{10u, 7u, 3u}, {1u, 1u, 5u}, {16u, 16u, 16u}, {5u, 9u, 1u}}) {
    std::vector<int> covered(std::size_t{width} * height);
    for (Tiles next(width, height, side); next; next.next()) {
      const Tile tile = *next;
      EXPECT_LE(tile.width, side);
      for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y)
        for (std::uint32_t x = tile.x; x < tile.x + tile.width; ++x) ++covered[y * width + x];
    }
    for (const int count : covered) EXPECT_EQ(count, 1);
  }
}

TEST(Samples, PixelsStandWhereTheirTileIs) {
  std::vector<float> rgba;
  for (int i = 0; i < 16; ++i) rgba.push_back(static_cast<float>(i));
  image::Image image;
  image.width = 4;
  image.height = 3;
  image.radiance.assign(36, -1);
  image.coverage.assign(12, -1);
  store_pixels(rgba, {1, 1, 2, 2}, image);
  const auto pixel = [&](int x, int y) { return static_cast<std::size_t>(4 * y + x); };
  EXPECT_EQ(image.radiance[3 * pixel(1, 1)], 0);
  EXPECT_EQ(image.radiance[3 * pixel(2, 1) + 1], 5);
  EXPECT_EQ(image.radiance[3 * pixel(1, 2) + 2], 10);
  EXPECT_EQ(image.coverage[pixel(2, 2)], 15);
  EXPECT_EQ(image.radiance[3 * pixel(0, 0)], -1);  // outside of the tile
  EXPECT_EQ(image.coverage[pixel(3, 2)], -1);
}

TEST(Samples, RunsHoldEachPixelOnce) {
  const std::vector<Pixel> pixels{{1, 0}, {2, 0}, {4, 0}, {0, 1}, {1, 1}, {2, 3}};
  std::vector<Pixel> seen;
  for (const PixelRun& run : runs(pixels))
    for (std::uint32_t i = 0; i < run.count; ++i) seen.push_back({run.first.x + i, run.first.y});
  EXPECT_EQ(seen, pixels);
  EXPECT_EQ(runs(pixels).size(), 4u);
}

}  // namespace
}  // namespace panwright::preview::texture_levels_test
