#include "labels/internal/pixels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "labels/internal/outline.h"

namespace panwright::labels::pixels_test {
namespace {

using testing::ElementsAre;

Mask block(std::uint32_t left, std::uint32_t top, std::uint32_t width, std::uint32_t height) {
  return {left, top, width, height, std::vector<std::uint8_t>(std::size_t{width} * height, 255)};
}

// Through maskApi.c of COCO: 4 rows, 5 columns, rows 1-2, columns 1-3.
TEST(Pixels, RunLengthsAreThoseOfCoco) {
  const auto counts = rle_counts(pixels_of(block(1, 1, 3, 2)), 5, 4);
  EXPECT_THAT(counts, ElementsAre(5, 2, 2, 2, 2, 2, 5));
  EXPECT_EQ(rle_text(counts), "5220003");
}

TEST(Pixels, RunLengthsOfALargeImage) {
  const std::string text = rle_text(rle_counts(pixels_of(block(900, 500, 100, 120)), 1920, 1200));
  EXPECT_EQ(text.substr(0, 10), "dUoP1h3hQ1");
  EXPECT_EQ(text.size(), 212u);
}

TEST(Pixels, RunsJoinOverColumnsOfFullHeight) {
  EXPECT_THAT(rle_counts(pixels_of(block(1, 0, 2, 4)), 5, 4), ElementsAre(4, 8, 8));
  EXPECT_THAT(rle_counts(pixels_of(block(0, 0, 5, 4)), 5, 4), ElementsAre(0, 20));
  EXPECT_THAT(rle_counts(pixels_of(block(4, 3, 1, 1)), 5, 4), ElementsAre(19, 1));
  EXPECT_THAT(rle_counts(PixelMask(), 5, 4), ElementsAre(20));
}

TEST(Pixels, MoreThanHalfIsSet) {
  const PixelMask mask = pixels_of({2, 3, 3, 1, {127, 128, 255}});
  EXPECT_EQ(mask.left, 3u);
  EXPECT_EQ(mask.top, 3u);
  EXPECT_EQ(mask.width, 2u);
  EXPECT_EQ(mask.count, 2u);
  EXPECT_TRUE(pixels_of({0, 0, 1, 1, {127}}).empty());
}

// Even and odd crossings of the polygon from the centre of each pixel to the left are the mask, for
// masks of noise, with holes and corners that touch.
TEST(Outline, EvenAndOddCrossingsAreTheMask) {
  std::uint64_t state = 1;
  for (int round = 0; round < 200; ++round) {
    Mask mask{3, 5, 9, 7, std::vector<std::uint8_t>(63)};
    for (auto& value : mask.coverage) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      value = (state >> 40) % 5 < 3 ? 255 : 0;
    }
    const PixelMask pixels = pixels_of(mask);
    const auto outline = outline_of(pixels);
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) {
        int crossings = 0;
        for (std::size_t k = 0; k < outline.size(); ++k) {
          const auto& a = outline[k];
          const auto& b = outline[(k + 1) % outline.size()];
          if ((a.second <= y) == (b.second <= y)) continue;
          const double share = (y + 0.5 - a.second) / (double(b.second) - a.second);
          crossings += a.first + share * (double(b.first) - a.first) < x + 0.5;
        }
        ASSERT_EQ(crossings % 2 == 1, pixels.at(x, y)) << round << ": " << x << " " << y;
      }
  }
}

}  // namespace
}  // namespace panwright::labels::pixels_test
