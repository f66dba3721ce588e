// Which pixels get more samples. Oracles: closed forms of second differences, sorting, sums in
// double.
#include "preview/frame/pixel_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace panwright::preview::pixel_errors_test {
namespace {

constexpr float kShare = 0.3f;            // of a second difference
constexpr float kNeighbourShare = 0.05f;  // of a neighbour's

image::Image image_of(std::uint32_t width, std::uint32_t height,
                      const std::function<float(std::uint32_t, std::uint32_t)>& value) {
  image::Image image;
  image.width = width;
  image.height = height;
  image.coverage.assign(image.pixels(), 1);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (int k = 0; k < 3; ++k) image.radiance.push_back(value(x, y));
  return image;
}

TEST(PixelErrors, SlopesAreNoErrors) {
  const image::Image image = image_of(20, 12, [](std::uint32_t x, std::uint32_t y) {
    return 0.5f + 0.125f * static_cast<float>(x) + 0.25f * static_cast<float>(y);
  });
  std::vector<float> errors;
  ErrorPredictor().predict(image, {}, {2, 2, 16, 8}, errors);
  ASSERT_EQ(errors.size(), 16u * 8u);
  for (const float error : errors) EXPECT_EQ(error, 0);
}

TEST(PixelErrors, EdgesAreSeenFromBothSides) {
  const image::Image image =
      image_of(20, 9, [](std::uint32_t x, std::uint32_t) { return x < 10 ? 0.25f : 2.25f; });
  std::vector<float> errors;
  ErrorPredictor().predict(image, {}, {0, 0, 20, 9}, errors);
  for (std::uint32_t x = 0; x < 20; ++x) {
    const float expected = x == 9 || x == 10   ? 2 * kShare
                           : x == 8 || x == 11 ? 2 * kNeighbourShare
                                               : 0;
    EXPECT_FLOAT_EQ(errors[4 * 20 + x], expected) << x;
  }
}

TEST(PixelErrors, PatternsAreNoErrorsButTheirBordersAre) {
  std::mt19937 random(7);
  const auto noise = [&] { return static_cast<float>(random() % 1000) / 1000; };
  image::Image image =
      image_of(16, 16, [&](std::uint32_t x, std::uint32_t) { return x < 8 ? noise() : 0.5f; });
  std::vector<float> patternless(16 * 16, -1.0f);
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 8; ++x) patternless[16 * y + x] = 0.5f;
  std::vector<float> errors;
  ErrorPredictor().predict(image, patternless, {0, 0, 16, 16}, errors);
  std::size_t large = 0;
  for (std::size_t y = 0; y < 16; ++y) {
    for (std::size_t x = 0; x < 6; ++x) EXPECT_EQ(errors[16 * y + x], 0);
    for (std::size_t x = 10; x < 16; ++x) EXPECT_EQ(errors[16 * y + x], 0);
    // what the pattern shows beside another thing may be an error
    large += errors[16 * y + 7] > 0.01f;
  }
  EXPECT_GT(large, 10u);
}

TEST(PixelErrors, WhatIsLeftFitsTheBudget) {
  std::mt19937 random(11);
  std::vector<float> errors(5000);
  for (float& error : errors)
    error = random() % 4 == 0 ? 0 : std::exp2(-static_cast<float>(random() % 2000) / 100);
  std::vector<float> sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  double all = 0;
  for (const float error : errors) all += static_cast<double>(error) * error;
  EXPECT_EQ(least_error_above(errors, 1.01 * all), INFINITY);
  for (const double share : {0.9, 0.1, 1e-3, 1e-6}) {
    const float above = least_error_above(errors, share * all);
    double left = 0;
    for (const float error : errors)
      if (error < above) left += static_cast<double>(error) * error;
    EXPECT_LE(left, share * all);
    // no error could be that is 0.4 % larger
    double more = 0;
    for (const float error : errors)
      if (error < 1.004f * above) more += static_cast<double>(error) * error;
    EXPECT_GT(more, share * all);
  }
}

// The error of one sample is a guess: a huge one takes no pixel beyond 16×16 before it is measured.
TEST(PixelErrors, AllocationMeasuresBeforeItTakesTheLast) {
  constexpr unsigned kSides[] = {1, 4, 8, 16, 32, 64};
  const std::vector<float> errors{1e6f, 1, 1, 1, 1};
  const std::vector<std::uint8_t> levels{0, 0, 0, 3, 2};
  const Allocation allocation(errors, levels, kSides, 1e-3);
  EXPECT_EQ(allocation.level(errors[0], 0), 3u);
  EXPECT_EQ(allocation.level(errors[1], 0), 3u);
  EXPECT_EQ(allocation.level(errors[3], 3), 5u);
  EXPECT_EQ(allocation.level(errors[4], 2), 5u);
}

TEST(PixelErrors, AllocationMeetsTheBudgetWithTheFewestLevels) {
  constexpr unsigned kSides[] = {1, 4, 8, 16};
  std::mt19937 random(13);
  std::vector<float> errors(3000);
  std::vector<std::uint8_t> levels(errors.size());
  double all = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    errors[i] = std::exp2(-static_cast<float>(random() % 1500) / 100);
    levels[i] = static_cast<std::uint8_t>(random() % 2);
    all += static_cast<double>(errors[i]) * errors[i];
  }
  const auto fallen = [&](std::size_t i, std::size_t to) {
    const double error =
        errors[i] * std::pow(static_cast<double>(kSides[levels[i]]) / kSides[to], 1.4);
    return error * error;
  };
  for (const double share : {0.5, 0.2, 0.01, 1e-3}) {
    // where every pixel goes up to a level, as far as it is not there
    std::size_t fewest = 1;
    bool enough = false;
    for (; fewest < 3; ++fewest) {
      double least = 0;
      for (std::size_t i = 0; i < errors.size(); ++i)
        least += fallen(i, std::max<std::size_t>(levels[i], fewest));
      enough = least <= share * all;
      if (enough) break;
    }
    const Allocation allocation(errors, levels, kSides, share * all);
    double left = 0;
    std::size_t highest = 0;
    std::vector<std::pair<float, std::size_t>> of_first;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const std::size_t to = allocation.level(errors[i], levels[i]);
      EXPECT_GE(to, levels[i]);
      // what cannot be met is come as near to as can be
      if (!enough) {
        EXPECT_EQ(to, 3u);
      }
      if (to > levels[i]) highest = std::max(highest, to);
      left += fallen(i, to);
      if (levels[i] == 0) of_first.push_back({errors[i], to});
    }
    EXPECT_LE(highest, fewest) << share;
    // bins of errors are 1/32 wide
    if (enough) {
      EXPECT_LE(left, 1.07 * share * all) << share;
      EXPECT_GT(left, 0.3 * share * all) << share;
    }
    std::sort(of_first.begin(), of_first.end());
    for (std::size_t i = 1; i < of_first.size(); ++i)
      EXPECT_LE(of_first[i - 1].second, of_first[i].second);
  }
}

TEST(PixelErrors, GroupsHoldEachPixelOnce) {
  std::mt19937 random(17);
  std::vector<Pixel> pixels;
  for (int i = 0; i < 400; ++i) {
    const auto below = [&](unsigned n) { return static_cast<std::uint32_t>(random() % n); };
    const std::uint32_t cluster = 300 * below(3);
    pixels.push_back({cluster + below(60), cluster / 2 + below(40)});
  }
  std::sort(pixels.begin(), pixels.end());
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  for (const std::uint64_t worth : {1u, 1000u, 1000000u}) {
    std::vector<std::uint32_t> order(pixels.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::vector<int> hits(pixels.size());
    std::uint64_t area = 0;
    const auto groups = group(pixels, order, 512, 256, worth);
    for (const PixelGroup& one : groups) {
      EXPECT_FALSE(one.pixels.empty());
      EXPECT_LE(one.around.width, 512u);
      EXPECT_LE(one.around.height, 256u);
      area += std::uint64_t{one.around.width} * one.around.height;
      for (const std::uint32_t index : one.pixels) {
        ++hits[index];
        EXPECT_LT(pixels[index].x - one.around.x, one.around.width);
        EXPECT_LT(pixels[index].y - one.around.y, one.around.height);
      }
      EXPECT_TRUE(std::is_sorted(one.pixels.begin(), one.pixels.end()));
    }
    EXPECT_TRUE(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; }));
    // three clusters, and what lies between them is left out
    if (worth == 1000) {
      EXPECT_LE(area, 3u * 60 * 40);
    }
  }
}

}  // namespace
}  // namespace panwright::preview::pixel_errors_test
