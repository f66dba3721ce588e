#include "preview/model/map_levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace panwright::preview::map_levels_test {
namespace {

std::vector<std::uint8_t> noise(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> codes;
  std::uint32_t state = 5;
  for (std::size_t i = 0; i < std::size_t{4} * width * height; ++i) {
    state = state * 1664525u + 1013904223u;  // Numerical Recipes' quick generator
    codes.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return codes;
}

Vec3 normal_of(const TextureLevel& level, std::size_t i) {
  return Vec3(level.rgba[4 * i], level.rgba[4 * i + 1], level.rgba[4 * i + 2]);
}

TEST(MapLevels, NormalsAreUnitAndOutwardsAndKeepTheirMean) {
  const auto levels = map_levels(noise(61, 40), 61, 40, false, TextureRole::normal, 0);
  Vec3 mean(0);
  for (std::size_t i = 0; i < 61 * 40; ++i) {
    const Vec3 n = normal_of(levels[0], i);
    EXPECT_NEAR(glm::length(n), 1, 1e-7);
    EXPECT_GE(n.z, 0);
    EXPECT_EQ(levels[0].rgba[4 * i + 3], 0);
    mean += n / (61.0 * 40);
  }
  EXPECT_LE(glm::length(normal_of(levels.back(), 0) - mean), 1e-6);
  for (const TextureLevel& level : levels)
    for (const float value : level.rgba) EXPECT_TRUE(std::isfinite(value));
}

// Equal normals have no slopes around their mean, at any level and for sides of any length.
TEST(MapLevels, EqualNormalsHaveNoSlopes) {
  std::vector<std::uint8_t> codes;
  for (int i = 0; i < 97 * 41; ++i) codes.insert(codes.end(), {150, 90, 240, 7});
  for (const auto& level : map_levels(codes, 97, 41, false, TextureRole::normal, 0))
    for (std::size_t i = 3; i < level.rgba.size(); i += 4) EXPECT_EQ(level.rgba[i], 0);
  for (const auto& level : map_levels(codes, 97, 41, false, TextureRole::slopes, 0))
    for (const float value : level.rgba) EXPECT_EQ(value, 0);
}

// Gaussian slopes of a known variance. What each axis' squared slope becomes larger by is twice
// that.
TEST(MapLevels, SlopesOfGaussianBumps) {
  for (const double sigma : {0.02, 0.1, 0.3, 0.6}) {
    constexpr int kSide = 256;
    std::vector<std::uint8_t> codes;
    std::uint32_t state = 1;
    const auto deviate = [&] {
      double sum = -6;
      for (int i = 0; i < 12; ++i) {
        state = state * 1664525u + 1013904223u;
        sum += state * 0x1p-32;
      }
      return sum;
    };
    double square = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = sigma * deviate();
      const Vec3 n = glm::normalize(Vec3(x, sigma * deviate(), 1));
      Vec3 kept(0);
      for (int k = 0; k < 3; ++k) {
        codes.push_back(static_cast<std::uint8_t>(std::lround((n[k] + 1) * 127.5)));
        kept[k] = codes.back() / 127.5 - 1;
      }
      codes.push_back(0);
      square += (kept.x * kept.x + kept.y * kept.y) / (kept.z * kept.z) / (kSide * kSide);
    }
    const auto levels = map_levels(codes, kSide, kSide, false, TextureRole::slopes, 0);
    const double ratio = 0.5 * (levels.back().rgba[0] + levels.back().rgba[1]) / square;
    printf("sigma %g: mean squared slope %.5f, found %.6f of it\n", sigma, square, ratio);
    EXPECT_NEAR(ratio, 1, 1e-4);  // the mean slope's square is missing; measured 3e-5
    EXPECT_NEAR(levels.back().rgba[0] / levels.back().rgba[1], 1, 0.02);  // measured 0.008
  }
}

TEST(MapLevels, PremultipliedColorsForgetWhatIsTransparent) {
  auto codes = noise(32, 32);
  for (std::size_t i = 0; i < codes.size(); i += 8) codes[i + 3] = 0;
  auto other = codes;
  for (std::size_t i = 0; i < codes.size(); i += 8) other[i] = other[i + 1] = other[i + 2] = 255;
  const auto a = map_levels(codes, 32, 32, false, TextureRole::premultiplied, 0);
  const auto b = map_levels(other, 32, 32, false, TextureRole::premultiplied, 0);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].rgba, b[i].rgba);
}

TEST(MapLevels, RoughnessIsTheCodeWhateverTheFileSays) {
  const std::vector<std::uint8_t> codes{51, 200, 200, 9};
  for (const bool linear : {false, true})
    EXPECT_EQ(map_levels(codes, 1, 1, linear, TextureRole::roughness, 0)[0].rgba[0], 0.2f);
}

// Each texel's share by brute force in both directions; the levels above keep the mean.
TEST(MapLevels, SharesOfCutouts) {
  constexpr int kWidth = 13;
  constexpr int kHeight = 9;
  constexpr int kSteps = 400;
  const auto codes = noise(kWidth, kHeight);
  const auto alpha = [&](int x, int y) {  // from the bottom row, repeating
    const int column = (x + kWidth) % kWidth;
    const int row = kHeight - 1 - (y + kHeight) % kHeight;
    return codes[static_cast<std::size_t>(4 * (row * kWidth + column) + 3)] / 255.0;
  };
  for (const double threshold : {0.2, 0.5, 0.81}) {
    const auto levels = map_levels(codes, kWidth, kHeight, false, TextureRole::cutout,
                                   static_cast<float>(threshold));
    double worst = 0;
    double mean = 0;
    for (int j = 0; j < kHeight; ++j)
      for (int i = 0; i < kWidth; ++i) {
        int there = 0;
        for (int b = 0; b < kSteps; ++b)
          for (int a = 0; a < kSteps; ++a) {
            const double x = i + (a + 0.5) / kSteps - 0.5;
            const double y = j + (b + 0.5) / kSteps - 0.5;
            const int left = static_cast<int>(std::floor(x));
            const int low = static_cast<int>(std::floor(y));
            const double u = x - left;
            const double v = y - low;
            there += (alpha(left, low) * (1 - u) + alpha(left + 1, low) * u) * (1 - v) +
                         (alpha(left, low + 1) * (1 - u) + alpha(left + 1, low + 1) * u) * v >=
                     threshold;
          }
        const double share = double(there) / (kSteps * kSteps);
        mean += share / (kWidth * kHeight);
        const float* texel = &levels[0].rgba[static_cast<std::size_t>(4 * (j * kWidth + i))];
        EXPECT_NEAR(texel[0], alpha(i, j) - threshold, 1e-7);
        worst = std::max(worst, std::fabs(texel[1] - share));
      }
    printf("threshold %g: worst texel %.1e, mean %+.1e\n", threshold, worst,
           levels.back().rgba[1] - mean);
    EXPECT_LE(worst, 2e-3);
    EXPECT_NEAR(levels.back().rgba[1], mean, 2e-4);
  }
}

}  // namespace
}  // namespace panwright::preview::map_levels_test
