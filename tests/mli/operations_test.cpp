// Wrinkles and what hands make, against closed forms.
#include <algorithm>

#include "base/random.h"
#include "mli/internal/crease.h"
#include "mli/internal/grid.h"
#include "tests/mli/sheet_support.h"

namespace panwright::mli::operations_test {
namespace {

using testing::everything;
using testing::recipe;
using testing::sheet_of;

TEST(Operations, TheSameBytesWithAnyNumberOfThreads) {
  const Sheet one = sheet_of(everything(), 0, Job({.threads = 1, .progress = {}}));
  for (const std::size_t threads : {2, 8}) {
    const Sheet many = sheet_of(everything(), 0, Job({.threads = threads, .progress = {}}));
    EXPECT_EQ(checksum(one.heights), checksum(many.heights));
    EXPECT_EQ(one.statistics.slope_rms, many.statistics.slope_rms);
    EXPECT_EQ(one.statistics.height_mean, many.statistics.height_mean);
    EXPECT_EQ(one.statistics.correlation_length, many.statistics.correlation_length);
    EXPECT_EQ(one.statistics.mean_normal, many.statistics.mean_normal);
    EXPECT_EQ(one.statistics.tilt_histogram, many.statistics.tilt_histogram);
  }
}

// Means over seeds.
struct Mean {
  double height2 = 0, height4 = 0, xx = 0, xy = 0, yy = 0;
};
Mean over_seeds(const Recipe& of, std::uint32_t seeds, bool facets = false) {
  Mean mean;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    Recipe recipe = of;
    recipe.seed = seed;
    const Sheet sheet = sheet_of(recipe);
    double h2 = 0, h4 = 0;
    for (const double h : sheet.heights) {
      h2 += h * h;
      h4 += h * h * h * h;
    }
    const auto count = static_cast<double>(sheet.heights.size()) * seeds;
    mean.height2 += h2 / count;
    mean.height4 += h4 / count;
    const Covariance& c =
        facets ? sheet.statistics.facet_slope_covariance : sheet.statistics.slope_covariance;
    mean.xx += c.xx / seeds;
    mean.xy += c.xy / seeds;
    mean.yy += c.yy / seeds;
  }
  return mean;
}

// ---- wrinkle

// Of wave vectors uniform within ±Θ of x, wave numbers within 20 % of 1.
struct Spectrum {
  double mean_x, xx, yy;
};
Spectrum spectrum_of(double anisotropy) {
  const double wanted = (anisotropy * anisotropy - 1) / (anisotropy * anisotropy + 1);
  double angle = kPi / 2;  // Newton's steps for sin(2Θ) = 2Θ·wanted
  for (int step = 0; step < 100; ++step)
    angle -= (std::sin(2 * angle) - 2 * angle * wanted) / (2 * std::cos(2 * angle) - 2 * wanted);
  const double square = 1 + 0.04 / 3, s = std::sin(2 * angle) / (2 * angle);
  return {std::sin(angle) / angle, square * (1 + s) / 2, square * (1 - s) / 2};
}

TEST(Wrinkle, SlopesHeightsAndCrossingsAreThoseOfItsSpectrum) {
  for (const double anisotropy : {1.0, 3.0, 10.0}) {
    const double wavelength = 0.04, a = 0.002, k = 2 * kPi / wavelength;
    const Recipe one = recipe(0.8, 0.8, 640, {Wrinkle{wavelength, a, 0, anisotropy}});
    const Mean mean = over_seeds(one, 16, true);
    EXPECT_NEAR(mean.height2, a * a / 2, 0.05 * a * a / 2) << anisotropy;
    // h = |z|·tri(arg z) of a Gaussian z: half of the variance of wave vectors about their mean
    // goes to the envelope, whose slopes count 1/3, the rest to the phase, whose slopes count
    // (2/π)²
    const Spectrum s = spectrum_of(anisotropy);
    const double envelope = 1.0 / 3, phase = 4 / (kPi * kPi);
    const double spread = s.xx - s.mean_x * s.mean_x;
    const double scale = 1.5 * a * a * k * k;
    // a crest takes two thirds of the one facet in 16 that it crosses
    const double met = 1 - 2.0 / 3 / 16 * std::sqrt(s.xx);
    const double xx =
        scale * (envelope * spread / 2 + met * phase * (s.mean_x * s.mean_x + spread / 2));
    const double yy = scale * (envelope + met * phase) * s.yy / 2;
    EXPECT_NEAR(mean.xx, xx, 0.05 * xx) << anisotropy;  // worst 3.1 %
    EXPECT_NEAR(mean.yy, yy, 0.08 * yy) << anisotropy;  // worst 3.1 %

    // zeros of h are those of a Gaussian process: Rice's formula
    double crossings = 0, length = 0;
    for (std::uint32_t seed = 0; seed < 16; ++seed) {
      Recipe each = one;
      each.seed = seed;
      const Sheet sheet = sheet_of(each);
      for (std::uint32_t j = 0; j < sheet.rows; ++j) {
        for (std::uint32_t i = 0; i + 1 < sheet.columns; ++i)
          crossings += (sheet.at(i, j) < 0) != (sheet.at(i + 1, j) < 0);
        length += 0.8;
      }
    }
    const double expected = k * std::sqrt(s.xx) / kPi;
    EXPECT_NEAR(crossings / length, expected, 0.02 * expected) << anisotropy;
  }
}

TEST(Wrinkle, RunsAcrossItsDirection) {
  for (const double direction : {0.0, 0.5, 1.2, 2.6, -0.3}) {
    const Mean mean = over_seeds(recipe(1, 1, 300, {Wrinkle{0.04, 0.002, direction, 4}}), 12);
    const double measured = 0.5 * std::atan2(2 * mean.xy, mean.xx - mean.yy);
    // an axis has no sense; worst 0.02 rad
    EXPECT_NEAR(std::sin(measured - direction), 0, 0.03) << direction;
  }
}

// ---- crease

TEST(Crease, LengthsFollowTheirLaw) {
  Crease crease;
  crease.length = 0.03;
  crease.spread = 0.5;
  crease.tail = 2.5;
  crease.tail_share = 0.2;
  std::vector<double> lengths;
  constexpr std::uint32_t kCount = 40000;
  for (std::uint32_t n = 0; n < kCount; ++n)
    lengths.push_back(ridge_length(crease, philox({n, 0, 0, 0}, {11, 3})) / crease.length);
  std::sort(lengths.begin(), lengths.end());
  const auto expected = [&](double x) {
    const double normal = 0.5 * std::erfc(-std::log(x) / crease.spread / std::sqrt(2.0));
    const double power = std::pow(20, 1 - crease.tail);
    const double tail = x < 1 ? 0 : (1 - std::pow(x, 1 - crease.tail)) / (1 - power);
    return 0.8 * normal + 0.2 * tail;
  };
  double worst = 0;
  for (std::uint32_t n = 0; n < kCount; ++n) {
    const double here = expected(lengths[n]);
    worst = std::max(
        {worst, std::fabs(here - (n + 0.0) / kCount), std::fabs(here - (n + 1.0) / kCount)});
  }
  // Kolmogorov and Smirnov: above by chance once in 10,000
  EXPECT_LT(worst, 2.23 / std::sqrt(kCount));
  EXPECT_LE(lengths.back(), 20 * (1 + 1e-12));
  // the long ones: the slope of their distribution's logarithm
  const auto above = [&](double x) {
    return static_cast<double>(lengths.end() - std::lower_bound(lengths.begin(), lengths.end(), x));
  };
  const double slope = std::log(above(8) / above(4)) / std::log(2.0);
  const double exact = std::log((1 - expected(8)) / (1 - expected(4))) / std::log(2.0);
  EXPECT_NEAR(slope, exact, 0.25);  // its standard error is 0.08
}

// Campbell's theorem: sums over pyramids at random places.
TEST(Crease, VariancesAreThoseOfItsPyramids) {
  Crease crease;
  crease.density = 1500;
  crease.depth = 0.002;
  crease.length = 0.04;
  crease.spread = 0.3;
  crease.tail_share = 0;
  const Mean mean = over_seeds(recipe(0.6, 0.6, 1200, {crease}), 12, true);
  const double moment = std::exp(2 * 0.09), fourth = std::exp(8 * 0.09);  // of L²/l², L⁴/l⁴
  // a pyramid of base A and height H: A·H²/6
  const double l2 = crease.length * crease.length;
  const double height = crease.density * 0.375 * l2 * fourth * crease.depth * crease.depth / 6;
  EXPECT_NEAR(mean.height2, height, 0.06 * height);
  // facets over (s, b): area s·b/2, slopes H/s and H/b; b uniform in 0.15 to 0.6, s in 0.15 to 0.85
  const double slopes = 2 * (0.375 * std::log(0.85 / 0.15) / 0.7 + 0.5 * std::log(4.0) / 0.45);
  const double expected = crease.density * moment * crease.depth * crease.depth * slopes;
  EXPECT_NEAR(mean.xx + mean.yy, expected, 0.045 * expected);  // 3.0 %: cells that edges cross
  EXPECT_NEAR(mean.xx, mean.yy, 0.05 * expected);
}

// Foil has facets, noise has none: most squares of 2 × 2 cells are flat to rounding.
TEST(Crease, MakesFlatFacets) {
  Crease crease;
  crease.density = 1500;
  crease.depth = 0.002;
  crease.length = 0.04;
  const auto flat_share = [](const Sheet& sheet) {
    double flat = 0, all = 0;
    for (std::uint32_t j = 1; j + 1 < sheet.rows; ++j)
      for (std::uint32_t i = 1; i + 1 < sheet.columns; ++i) {
        const double h = sheet.at(i, j);
        const double bend = std::fabs(sheet.at(i - 1, j) + sheet.at(i + 1, j) - 2 * h) +
                            std::fabs(sheet.at(i, j - 1) + sheet.at(i, j + 1) - 2 * h) +
                            std::fabs(sheet.at(i - 1, j - 1) + sheet.at(i + 1, j + 1) - 2 * h);
        flat += bend < 1e-13;
        ++all;
      }
    return flat / all;
  };
  EXPECT_GT(flat_share(sheet_of(recipe(0.5, 0.5, 1000, {crease}))), 0.6);  // 0.71
  EXPECT_LT(flat_share(sheet_of(recipe(0.5, 0.5, 1000, {Fractal{0.7, 0.002}}))), 0.01);
}

// ---- fractal

// Means over squares of side r, their second differences: a band of the spectrum about 1/r, whose
// power goes with r^2H.
TEST(Fractal, SpectrumFallsWithItsExponent) {
  for (const double hurst : {0.3, 0.5, 0.7, 0.9}) {
    double powers[3]{};
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
      const Sheet sheet = sheet_of(recipe(1, 1, 1023, {Fractal{hurst, 1, 0.5}}, seed));
      for (std::uint32_t k = 0; k < 3; ++k) {
        // octaves are 2 to 512 cells, correlated over two to three spacings
        const std::uint32_t side = 16u << k, count = 1024 / side;
        std::vector<double> means(std::size_t{count} * count);
        for (std::uint32_t j = 0; j < 1024; ++j)
          for (std::uint32_t i = 0; i < 1024; ++i)
            means[j / side * count + i / side] += sheet.at(i, j) / (side * side);
        for (std::uint32_t j = 0; j < count; ++j)
          for (std::uint32_t i = 1; i + 1 < count; ++i) {
            const double* m = &means[std::size_t{j} * count + i];
            powers[k] += std::pow(m[-1] - 2 * m[0] + m[1], 2) / (count * (count - 2.0));
          }
      }
    }
    const double slope = std::log(powers[2] / powers[0]) / std::log(4.0);
    EXPECT_NEAR(slope, 2 * hurst, 0.03) << hurst;  // worst 0.006
  }
}

TEST(Fractal, HasItsHeight) {
  const double hurst = 0.6, rms = 0.003;
  const Mean mean = over_seeds(recipe(2, 2, 256, {Fractal{hurst, rms, 0.25}}), 24);
  // octaves of 32, 16, 8, 4 and 2 cells of an endless series
  const double expected = rms * rms * (1 - std::pow(2, -2 * hurst * 5));
  EXPECT_NEAR(mean.height2, expected, 0.04 * expected);  // 3.0 %, by chance
}

// ---- crush

TEST(Crush, DentsHaveTheirHeightAndSharpCrests) {
  const double depth = 0.002;
  const Mean mean = over_seeds(recipe(1, 1, 400, {Crush{0.04, depth}}), 12);
  const double expected = depth * depth * (1 + 1.0 / 4 + 1.0 / 16);
  EXPECT_NEAR(mean.height2, expected, 0.03 * expected);
  // a dent is a paraboloid, one curvature for all, and crests bend the other way, much more
  const Sheet sheet = sheet_of(recipe(0.2, 0.2, 800, {Crush{0.1, depth}}));
  std::vector<double> bends;
  for (std::uint32_t j = 0; j < sheet.rows; ++j)
    for (std::uint32_t i = 1; i + 1 < sheet.columns; ++i)
      bends.push_back(sheet.at(i - 1, j) + sheet.at(i + 1, j) - 2 * sheet.at(i, j));
  std::sort(bends.begin(), bends.end());
  const double dent = bends[bends.size() / 2];
  EXPECT_GT(dent, 0);
  EXPECT_NEAR(bends[bends.size() / 4] / dent, 1, 1e-6);
  EXPECT_NEAR(bends.back() / dent, 1, 1e-6);
  EXPECT_LT(bends.front(), -20 * dent);
}

// ---- emboss, seam, button

TEST(Emboss, QuiltsAndDiamonds) {
  const double pitch = 0.1, depth = 0.004;
  const Sheet quilt = sheet_of(recipe(1, 1, 400, {Emboss{Pattern::quilt, pitch, depth}}));
  EXPECT_NEAR(quilt.at(200, 200), depth, 1e-15);
  EXPECT_NEAR(quilt.at(220, 137), 0, 1e-15);  // on a line
  EXPECT_NEAR(quilt.at(210, 210), depth * 0.5625, 1e-15);
  EXPECT_NEAR(quilt.statistics.height_mean, depth * 4 / 9, 0.01 * depth);
  const Sheet diamond = sheet_of(recipe(1, 1, 400, {Emboss{Pattern::diamond, pitch, depth}}));
  EXPECT_NEAR(diamond.at(200, 200), depth, 1e-15);
  EXPECT_NEAR(diamond.statistics.height_mean, depth / 3, 0.01 * depth);
  // flat facets of one slope, but for cells that a line crosses
  EXPECT_NEAR(diamond.statistics.facet_slope_rms, 2 * depth / pitch, 0.05 * 2 * depth / pitch);
  EXPECT_NEAR(diamond.statistics.highest, depth, 1e-15);
  EXPECT_GE(diamond.statistics.lowest, -1e-15);
}

TEST(Seam, IsFlatOnTopAndGoneBeside) {
  for (const bool along_x : {true, false}) {
    const Sheet sheet = sheet_of(recipe(1, 1, 200, {Seam{along_x, 0.3, 0.1, 0.002, 0, 0}}));
    const auto at = [&](std::uint32_t across, std::uint32_t along) {
      return along_x ? sheet.at(along, across) : sheet.at(across, along);
    };
    for (std::uint32_t along : {0u, 77u, 200u})
      for (std::uint32_t across = 0; across <= 200; ++across) {
        const double d = std::fabs(across / 200.0 - 0.3);
        if (d < 0.0299) {
          EXPECT_NEAR(at(across, along), 0.002, 1e-15) << across;
        } else if (d > 0.0501) {
          EXPECT_EQ(at(across, along), 0) << across;
        }
      }
    EXPECT_NEAR(at(68, 5), 0.001, 1e-12);  // half-way down
  }
  // folds stand up and hang down in turn, half a stitch apart, straight between, within their bound
  const Sheet folded = sheet_of(recipe(1, 1, 200, {Seam{true, 0.3, 0.1, 0, 0.04, 0.001}}));
  const double fade = smooth_step(0.8);  // at the border
  double least = 1, most = 0;
  for (std::uint32_t i = 0; i < 200; i += 4) {
    const double size = folded.at(i, 70) / 0.001 / fade * (i % 8 == 0 ? 1 : -1);
    least = std::min(least, size);
    most = std::max(most, size);
    for (std::uint32_t k = 1; k < 4; ++k)
      EXPECT_NEAR(folded.at(i + k, 70), (folded.at(i, 70) * (4 - k) + folded.at(i + 4, 70) * k) / 4,
                  1e-15);
    EXPECT_EQ(folded.at(i, 60), 0);
    EXPECT_EQ(folded.at(i, 111), 0);  // 2.55 widths away
  }
  EXPECT_TRUE(least > 0.4 && least < 0.45) << least;
  EXPECT_TRUE(most > 0.95 && most < 1) << most;
}

TEST(Button, PinsTheSheetToItsBase) {
  const Sheet sheet =
      sheet_of(recipe(1, 0.5, 200, {Constant{0.01}, Button{0.25, 0.01, 0.1, 0.0005}}));
  std::size_t pinned = 0, free = 0;
  for (std::uint32_t j = 0; j < sheet.rows; ++j)
    for (std::uint32_t i = 0; i < sheet.columns; ++i) {
      // at 0.125, 0.375…
      const double x = std::remainder(i / 200.0 - 0.125, 0.25);
      const double y = std::remainder(j / 200.0 - 0.125, 0.25);
      const double r = std::sqrt(x * x + y * y);
      if (r < 0.0099) {
        EXPECT_EQ(sheet.at(i, j), 0);
        ++pinned;
      } else if (r > 0.1001) {
        EXPECT_EQ(sheet.at(i, j), 0.01);
        ++free;
      } else {
        EXPECT_LE(std::fabs(sheet.at(i, j) - 0.005), 0.0056);
      }
    }
  EXPECT_EQ(pinned, 8u * 9u);
  EXPECT_GT(free, 5000u);
}

// ---- slope_rms

TEST(SlopeRms, IsReachedWhateverTheSheet) {
  for (std::uint32_t seed = 0; seed < 8; ++seed)
    for (const double slope : {1e-6, 0.1, 0.3, 5.0}) {
      Recipe recipe = everything(seed);
      recipe.operations[9] = SlopeRms{slope};
      recipe.operations.resize(10);
      const Sheet sheet = sheet_of(recipe);
      EXPECT_NEAR(sheet.statistics.slope_rms / slope, 1, 1e-9);  // 6e-16 measured
      EXPECT_NEAR(slope_rms(sheet.heights, sheet.columns, sheet.spacing) / slope, 1, 1e-9);
    }
  const Sheet none = sheet_of(recipe(1, 1, 10, {Random{1}, SlopeRms{0}}));
  for (const double h : none.heights) EXPECT_EQ(h, 0);
}

// ---- seeds

TEST(Seeds, AreEquallyDistributed) {
  Crease crease;
  crease.density = 3000;
  crease.depth = 0.002;
  crease.length = 0.02;
  crease.spread = 0.3;
  crease.tail_share = 0;
  // low, high and far seeds: means of the slope variance of two halves agree
  double sums[2]{}, squares = 0;
  constexpr int kEach = 24;
  std::vector<std::uint64_t> seen;
  for (int k = 0; k < 2 * kEach; ++k) {
    const auto number = static_cast<std::uint32_t>(k);
    const std::uint32_t seed = k < kEach ? number : 0xffffffffu - 77777777u * number;
    const Sheet sheet = sheet_of(recipe(0.3, 0.3, 150, {crease}, seed));
    const double variance = std::pow(sheet.statistics.slope_rms, 2);
    sums[k < kEach ? 0 : 1] += variance / kEach;
    squares += variance * variance / (2 * kEach);
    seen.push_back(checksum(sheet.heights));
  }
  const double mean = (sums[0] + sums[1]) / 2;
  const double deviation = std::sqrt(std::max(0.0, squares - mean * mean));
  EXPECT_LT(deviation, 0.1 * mean);
  EXPECT_LT(std::fabs(sums[0] - sums[1]), 4 * deviation * std::sqrt(2.0 / kEach));
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

}  // namespace
}  // namespace panwright::mli::operations_test
