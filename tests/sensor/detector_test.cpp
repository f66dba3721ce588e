// Detectors: laws of their noise, charge that is kept, the same bytes whatever the parts.
#include "sensor/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

#include "base/hash.h"
#include "base/job.h"
#include "base/random.h"
#include "sensor/charge.h"
#include "sensor/draws.h"
#include "sensor/internal/tracks.h"

namespace panwright::sensor::detector_test {
namespace {

// Mean and central moments.
struct Moments {
  double mean = 0, variance = 0, third = 0;
};

template <class Range>
Moments moments_of(const Range& values) {
  Moments m;
  const double n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v;
  m.mean /= n;
  for (const double v : values) {
    const double d = v - m.mean;
    m.variance += d * d;
    m.third += d * d * d;
  }
  m.variance /= n - 1;
  m.third /= n;
  return m;
}

Readout flat(const Detector& detector, double electrons, std::uint32_t side, std::uint32_t frame,
             std::uint64_t seed = 1) {
  const std::vector<float> values(std::size_t{side} * side, static_cast<float>(electrons));
  MeanElectrons means;
  means.width = means.height = side;
  means.values = values;
  return read_out(detector, means, seed, frame);
}

// ---- random numbers

TEST(Draws, WordsAreThoseOfPhilox) {
  std::array<std::vector<std::uint32_t>, 4> words;
  std::array<std::span<std::uint32_t>, 4> spans;
  for (std::size_t k = 0; k < 4; ++k) spans[k] = words[k] = std::vector<std::uint32_t>(200);
  for (std::size_t k = 0; k < 4; ++k) spans[k] = words[k];
  draw_words(0, {}, spans);
  // Random123, kat_vectors
  EXPECT_EQ(words[0][0], 0x6627e8d5u);
  EXPECT_EQ(words[1][0], 0xe169c58du);
  EXPECT_EQ(words[2][0], 0xbc57ac4cu);
  EXPECT_EQ(words[3][0], 0x9b00dbd8u);
  const Stream stream{{0xa4093822u, 0x299f31d0u}, 0x13198a2eu, 0x03707344u};
  draw_words(0x85a308d3u, stream, spans);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto one = philox({0, 0x85a308d3u + i, stream.frame, stream.stage}, stream.seed);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(words[k][i], one[k]);
  }
}

// 2^20 draws of each mean; deviations in standard errors.
TEST(Draws, PoissonHasItsMoments) {
  constexpr std::size_t kDraws = 1 << 20;
  const double n = kDraws;
  for (const double mean : {0.1, 0.7, 3.0, 9.999, 10.0, 12.0, 40.0, 1e3, 3e4, 1e6}) {
    const std::vector<double> means(kDraws, mean);
    std::vector<double> counts(kDraws);
    draw_poisson(means, 5, {{3, 4}, 7, 1}, counts);
    const Moments m = moments_of(counts);
    EXPECT_LT(std::fabs(m.mean - mean), 4 * std::sqrt(mean / n)) << mean;
    EXPECT_LT(std::fabs(m.variance - mean), 4 * std::sqrt((2 * mean * mean + mean) / n)) << mean;
    // variance of the third central moment of a Poisson law, to its leading terms
    const double of_third = 6 * mean * mean * mean + 25 * mean * mean + mean;
    EXPECT_LT(std::fabs(m.third - mean), 4.5 * std::sqrt(of_third / n)) << mean;
  }
}

// Chi square against the probabilities themselves.
TEST(Draws, PoissonHasItsProbabilities) {
  constexpr std::size_t kDraws = 1 << 20;
  for (const double mean : {0.5, 6.0, 10.0, 11.0, 25.0, 300.0}) {
    const std::vector<double> means(kDraws, mean);
    std::vector<double> counts(kDraws);
    draw_poisson(means, 0, {{8, 9}, 1, 2}, counts);
    std::vector<double> observed(2000), expected(2000);
    for (const double count : counts) ++observed.at(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double x = static_cast<double>(k);
      expected[k] = kDraws * std::exp(x * std::log(mean) - mean - std::lgamma(x + 1));
    }
    double chi = 0, degrees = -1, few = 0, few_seen = 0;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      if (expected[k] < 20) {
        few += expected[k];
        few_seen += observed[k];
        continue;
      }
      chi += (observed[k] - expected[k]) * (observed[k] - expected[k]) / expected[k];
      ++degrees;
    }
    EXPECT_LT(chi, degrees + 4 * std::sqrt(2 * degrees)) << mean;
    EXPECT_LT(std::fabs(few_seen - few), 4 * std::sqrt(few) + 1) << mean;
  }
}

TEST(Draws, NormalNumbersHaveTheirDistribution) {
  constexpr std::size_t kDraws = 1 << 20;
  std::vector<double> numbers(kDraws), a(kDraws), b(kDraws);
  draw_normal(3, {{1, 2}, 3, 4}, numbers);
  draw_normal_pairs(3, {{1, 2}, 3, 5}, a, b);
  for (const auto* each : {&numbers, &a, &b}) {
    std::vector<double> bins(64);
    for (const double x : *each)
      ++bins[std::min<std::size_t>(63,
                                   static_cast<std::size_t>(32 * std::erfc(-x / std::sqrt(2))))];
    double chi = 0;
    const double expected = kDraws / 64.0;
    for (const double bin : bins) chi += (bin - expected) * (bin - expected) / expected;
    EXPECT_LT(chi, 63 + 4 * std::sqrt(126));
  }
  double product = 0, next = 0;
  for (std::size_t i = 0; i + 1 < kDraws; ++i) {
    product += a[i] * b[i];
    next += numbers[i] * numbers[i + 1];
  }
  EXPECT_LT(std::fabs(product), 4 * std::sqrt(kDraws));
  EXPECT_LT(std::fabs(next), 4 * std::sqrt(kDraws));
}

// Whatever pixels share a call.
TEST(Draws, DependOnThePixelAlone) {
  std::vector<double> means(500), whole(500), normal(500);
  for (std::size_t i = 0; i < means.size(); ++i) means[i] = 0.07 * static_cast<double>(i);
  const Stream stream{{1, 2}, 3, 4};
  draw_poisson(means, 11, stream, whole);
  draw_normal(11, stream, normal);
  for (std::size_t i = 0; i < means.size(); i += 7) {
    double one = -1, number = 9;
    draw_poisson({&means[i], 1}, 11 + static_cast<std::uint32_t>(i), stream, {&one, 1});
    draw_normal(11 + static_cast<std::uint32_t>(i), stream, {&number, 1});
    EXPECT_EQ(one, whole[i]);
    EXPECT_EQ(number, normal[i]);
  }
}

// ---- charge

TEST(Charge, SmearHasItsSumAndItsInverse) {
  constexpr std::uint32_t kWidth = 37, kHeight = 211;
  std::vector<double> light(std::size_t{kWidth} * kHeight);
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = 1e4 * in_unit(philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {1, 1})[0]);
  for (const bool flush : {false, true}) {
    const Smear smear{0.002, flush};
    std::vector<double> smeared = light;
    add_smear(smeared, kWidth, smear);
    // by the definition: what passes over other rows
    for (const std::size_t y : {0u, 100u, 210u}) {
      double sum = light[y * kWidth + 5];
      for (std::size_t other = flush ? y + 1 : 0; other < kHeight; ++other)
        if (other != y) sum += smear.ratio * light[other * kWidth + 5];
      EXPECT_NEAR(smeared[y * kWidth + 5], sum, 1e-9);
    }
    remove_smear(smeared, kWidth, smear);
    for (std::size_t i = 0; i < light.size(); ++i)
      ASSERT_NEAR(smeared[i], light[i], 1e-12 * 1e4);  // largest: 2e-12 of 1e4
  }
}

TEST(Charge, BloomingKeepsEveryElectron) {
  constexpr std::uint32_t kWidth = 19, kHeight = 101;
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    std::vector<double> charge(std::size_t{kWidth} * kHeight);
    for (std::size_t i = 0; i < charge.size(); ++i) {
      const auto word = philox({static_cast<std::uint32_t>(i), trial, 0, 0}, {2, 2});
      charge[i] = word[0] % 1000 + (word[1] % 40 == 0 ? word[2] % (1u << trial % 20) : 0);
    }
    const double before = std::accumulate(charge.begin(), charge.end(), 0.0);
    const double lost = bloom(charge, kWidth, 900.5);
    EXPECT_EQ(std::accumulate(charge.begin(), charge.end(), 0.0) + lost, before);
    EXPECT_LE(*std::ranges::max_element(charge), 900);
    EXPECT_GE(*std::ranges::min_element(charge), 0);
  }
  // a single source spreads evenly up and down
  std::vector<double> column(101, 0.0);
  column[50] = 10 * 1000 + 1000;
  EXPECT_EQ(bloom(column, 1, 1000), 0);
  for (std::size_t y = 0; y < column.size(); ++y)
    EXPECT_EQ(column[y], y >= 45 && y <= 55 ? 1000 : 0) << y;
}

// ---- dark current, tracks

TEST(Detector, DarkCurrentFollowsTemperature) {
  const Vec2 pixel(5.5, 5.5);
  // Janesick's law at 1 nA/cm² and 300 K, evaluated apart
  EXPECT_NEAR(dark_current(1, pixel, 293), 1040, 5);
  EXPECT_NEAR(dark_current(1, pixel, 273), 167, 1);
  EXPECT_NEAR(dark_current(1, pixel, 253), 20, 0.5);
  EXPECT_NEAR(dark_current(1, pixel, 300), 1888, 20);  // 1 nA/cm² are 1888 e/s
  EXPECT_EQ(dark_ratio(kDarkReference), 1);
  // doubles in 8.1, 7.1 and 6.1 K
  for (const auto& [at, step] : {std::pair(293, 8.1), {273, 7.1}, {253, 6.1}})
    EXPECT_NEAR(dark_ratio(at + step / 2) / dark_ratio(at - step / 2), 2, 0.02) << at;
}

// 20,000 tracks: their number, length and charge.
TEST(Detector, TracksHaveTheirLaws) {
  Detector detector;
  detector.depth_um = 12;
  detector.pixel_um = Vec2(10, 8);
  detector.exposure_s = 1;
  constexpr std::uint32_t kSide = 4096;
  const double area = 1e-8 * 10 * 8 * kSide * double(kSide);
  constexpr double kMean = 0.02;
  detector.cosmic_per_cm2_s = kMean / area;
  double tracks = 0, steep = 0, steeper = 0, far = 0;
  constexpr std::uint32_t kFrames = 1'000'000;
  for (std::uint32_t frame = 0; frame < kFrames; ++frame) {
    const auto deposits = cosmic_deposits(detector, kSide, kSide, 9, frame);
    if (deposits.empty()) continue;
    double charge = 0;
    double left = 1e9, right = -1, top = 1e9, bottom = -1;
    for (const Deposit& each : deposits) {
      charge += each.electrons;
      const double x = each.pixel % kSide * 10.0, y = each.pixel / kSide * 8.0;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    ++tracks;
    const double path = charge / kElectronsPerMicrometre / detector.depth_um;
    steep += path > 2;
    steeper += path > 4;
    far += std::hypot(right - left, bottom - top) > 40 * detector.depth_um;
  }
  // frames with a track: 1 − e^−0.02; one in a hundred has two
  EXPECT_NEAR(tracks / kFrames, -std::expm1(-kMean), 4 * std::sqrt(kMean / kFrames));
  const auto share = [&](double seen, double expected) {
    EXPECT_NEAR(seen / tracks, expected, 0.01 + 4 * std::sqrt(expected / tracks));
  };
  share(steep, 1.0 / 4);  // P(path > s d) = 1/s²
  share(steeper, 1.0 / 16);
  share(far, 1.0 / 1601);  // P(lateral > l) = d²/(d² + l²)
}

// ---- photon transfer

// 12 levels, pairs of 512 × 512 pixels: the slope's standard error is 0.1 %.
TEST(Detector, MeanAndVarianceGiveTheGain) {
  Detector detector;
  detector.dn_per_e = 0.31;
  detector.bias_dn = 100;
  detector.read_noise_e = 6;
  detector.full_well_e = 12000;
  detector.prnu = 0.01;  // drops out of differences
  constexpr std::uint32_t kSide = 512;
  double sxx = 0, sxy = 0, intercept = 0;
  for (std::uint32_t k = 0; k < 13; ++k) {
    const double electrons = 700.0 * k;
    const Readout a = flat(detector, electrons, kSide, 2 * k);
    const Readout b = flat(detector, electrons, kSide, 2 * k + 1);
    std::vector<double> sum, difference;
    for (std::size_t i = 0; i < a.dn.size(); ++i) {
      sum.push_back(0.5 * (a.dn[i] + b.dn[i]));
      difference.push_back(double(a.dn[i]) - b.dn[i]);
    }
    const double mean = moments_of(sum).mean - detector.bias_dn;
    const double variance = moments_of(difference).variance / 2;
    if (k == 0) {
      intercept = variance;
      continue;
    }
    // weights of relative errors
    sxx += 1;
    sxy += (variance - intercept) / mean;
  }
  EXPECT_NEAR(sxy / sxx, detector.dn_per_e, 0.005 * detector.dn_per_e);
  EXPECT_NEAR(intercept, std::pow(detector.dn_per_e * detector.read_noise_e, 2) + 1.0 / 12,
              0.015 * intercept);
}

// Means over 100 frames of 256 × 256 pixels.
std::vector<double> mean_frames(const Detector& detector, double electrons, Moments* temporal) {
  constexpr std::uint32_t kSide = 256, kFrames = 100;
  std::vector<double> sum(kSide * kSide), squares(kSide * kSide);
  for (std::uint32_t k = 0; k < kFrames; ++k) {
    const Readout one = flat(detector, electrons, kSide, k, 77);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += one.dn[i];
      squares[i] += double(one.dn[i]) * one.dn[i];
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] /= kFrames;
    squares[i] = (squares[i] / kFrames - sum[i] * sum[i]) * kFrames / (kFrames - 1);
  }
  *temporal = moments_of(squares);
  temporal->variance = temporal->mean / kFrames;  // of the mean over frames
  return sum;
}

// A report in the manner of EMVA 1288: what goes in comes out.
TEST(Detector, ReportRecoversItsParameters) {
  Detector detector;
  detector.exposure_s = 2;
  detector.dn_per_e = 0.5;
  detector.bias_dn = 200;
  detector.read_noise_e = 8;
  detector.full_well_e = 8000;
  detector.prnu = 0.02;
  detector.dark_e_per_s = 500;
  detector.dsnu = 0.15;
  Moments dark_noise, half_noise;
  const Moments dark = moments_of(mean_frames(detector, 0, &dark_noise));
  const Moments half = moments_of(mean_frames(detector, 3000, &half_noise));
  const double dark_spread = dark.variance - dark_noise.variance;
  const double half_spread = half.variance - half_noise.variance;
  const double gain = (half_noise.mean - dark_noise.mean) / (half.mean - dark.mean);
  EXPECT_NEAR(gain, detector.dn_per_e, 0.01 * detector.dn_per_e);
  EXPECT_NEAR(std::sqrt(half_spread - dark_spread) / (half.mean - dark.mean), detector.prnu,
              0.01 * detector.prnu);
  const double dark_mean = detector.dark_e_per_s * detector.exposure_s;
  EXPECT_NEAR(std::sqrt(dark_spread) / gain, detector.dsnu * dark_mean,
              0.015 * detector.dsnu * dark_mean);
  EXPECT_NEAR((dark.mean - detector.bias_dn) / gain, dark_mean, 0.01 * dark_mean);
  // dark noise: that of the current is the current itself
  const double read = (dark_noise.mean - 1.0 / 12) / (gain * gain) - dark_mean;
  Detector still = detector;
  still.dark_e_per_s = 0;
  Moments read_noise;
  mean_frames(still, 0, &read_noise);
  EXPECT_NEAR(std::sqrt((read_noise.mean - 1.0 / 12)) / gain, 8, 0.01 * 8);
  EXPECT_NEAR(read, 64, 0.1 * 64);
}

TEST(Detector, NonlinearityIsThatOfTheMeans) {
  Detector detector;
  detector.dn_per_e = 0.3;
  detector.full_well_e = 12000;
  detector.nonlinearity = {-0.05, 0.02};
  for (const double electrons : {1000.0, 4000.0, 9000.0}) {
    const double x = electrons / 12000;
    const Moments m = moments_of(flat(detector, electrons, 512, 1).dn);
    const double expected = 0.3 * electrons * (1 - 0.05 * x + 0.02 * x * x);
    EXPECT_NEAR(m.mean, expected, 1e-3 * expected) << electrons;
  }
}

TEST(Detector, HotAndTelegraphPixelsHaveTheirShares) {
  Detector detector;
  detector.exposure_s = 1;
  detector.hot_pixels = 0.01;
  detector.hot_e_per_s = 500;
  detector.full_well_e = 1e6;
  detector.bits = 16;
  const Readout one = flat(detector, 0, 1024, 0), other = flat(detector, 0, 1024, 1);
  double hot = 0, sum = 0, same = 0;
  for (std::size_t i = 0; i < one.dn.size(); ++i) {
    hot += one.dn[i] > 0;
    sum += one.dn[i];
    same += one.dn[i] > 0 && other.dn[i] > 0;
  }
  const double pixels = 1024.0 * 1024;
  EXPECT_NEAR(hot / pixels, 0.01, 0.0004);
  EXPECT_NEAR(sum / hot, 500, 20);
  EXPECT_GT(same, 0.99 * hot);  // the same pixels in each frame
  detector.hot_pixels = 0;
  detector.telegraph_pixels = 0.01;
  detector.telegraph_e_per_s = 1000;
  detector.telegraph_frames = 5;
  double up = 0, kept = 0, before = 0;
  std::vector<std::uint16_t> last;
  for (std::uint32_t frame = 0; frame < 40; ++frame) {
    const Readout now = flat(detector, 0, 256, frame);
    for (std::size_t i = 0; i < now.dn.size(); ++i) {
      up += now.dn[i] > 0;
      if (!last.empty() && last[i] > 0) ++before, kept += now.dn[i] > 0;
    }
    last = now.dn;
  }
  EXPECT_NEAR(up / (40 * 65536.0), 0.005, 0.0005);
  // a state lasts 5 frames, and then stays as often as it changes
  EXPECT_NEAR(kept / before, 1 - 0.5 / 5, 0.01);
}

// ---- bytes

// All stages at once.
Detector whole_chain() {
  Detector detector;
  detector.bayer = {'r', 'g', 'g', 'b'};
  detector.exposure_s = 0.1;
  detector.prnu = 0.02;
  detector.dark_e_per_s = 800;
  detector.temperature_k = 300;
  detector.dsnu = 0.3;
  detector.hot_pixels = detector.telegraph_pixels = 0.01;
  detector.hot_e_per_s = detector.telegraph_e_per_s = 2e4;
  detector.telegraph_frames = 3;
  detector.cosmic_per_cm2_s = 3e4;
  detector.full_well_e = 5000;
  detector.blooming = true;
  detector.smear_row_s = 1e-5;
  detector.nonlinearity = {-0.03, 0.01};
  detector.read_noise_e = 7;
  detector.dn_per_e = 0.7;
  detector.bias_dn = 64;
  detector.serial = 0x123456789ull;
  return detector;
}

constexpr std::uint32_t kWide = 150, kHigh = 131;

std::vector<float> scene(std::size_t bands) {
  std::vector<float> values(bands * kWide * kHigh);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto word = philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {5, 5});
    values[i] = static_cast<float>(in_unit(word[0]) * (word[1] % 50 == 0 ? 30000 : 900));
  }
  return values;
}

MeanElectrons input(const std::vector<float>& values, std::uint32_t bands) {
  MeanElectrons means;
  means.width = kWide;
  means.height = kHigh;
  means.bands = bands;
  means.values = values;
  return means;
}

TEST(Detector, BytesAreTheSameWhateverTheParts) {
  const std::vector<float> values = scene(3);
  const Detector chain = whole_chain();
  const Readout whole = read_out(chain, input(values, 3), 42, 6);
  for (const unsigned threads : {1u, 3u}) {
    Readout again;
    run_on_threads(Job({threads, {}}), [&] { again = read_out(chain, input(values, 3), 42, 6); });
    EXPECT_EQ(again.dn, whole.dn);
  }
  // columns, and tiles where no charge moves
  for (const bool tiles : {false, true}) {
    Detector detector = chain;
    if (tiles) detector.blooming = false, detector.smear_row_s = 0;
    const Readout all = read_out(detector, input(values, 3), 42, 6);
    const std::uint32_t x = 37, width = 61, y = tiles ? 29 : 0, height = tiles ? 70 : kHigh;
    std::vector<float> part;
    for (std::uint32_t j = y; j < y + height; ++j)
      for (std::uint32_t i = 3 * x; i < 3 * (x + width); ++i)
        part.push_back(values[j * 3 * kWide + i]);
    MeanElectrons means;
    std::tie(means.x, means.y, means.width, means.height) = std::tuple(x, y, width, height);
    means.detector_width = kWide;
    means.detector_height = kHigh;
    means.bands = 3;
    means.values = part;
    const Readout tile = read_out(detector, means, 42, 6);
    for (std::uint32_t j = 0; j < height; ++j)
      for (std::uint32_t i = 0; i < width; ++i)
        ASSERT_EQ(tile.dn[j * width + i], all.dn[(j + y) * kWide + i + x]);
  }
  // of gcc 12 and clang 14, with and without AVX2
  EXPECT_EQ(hash64(std::as_bytes(std::span(whole.dn))), 8703442942656317869u);
  EXPECT_NE(read_out(chain, input(values, 3), 42, 7).dn, whole.dn);
  EXPECT_NE(read_out(chain, input(values, 3), 43, 6).dn, whole.dn);
}

TEST(Detector, LayersAddUpToTheNumbers) {
  const std::vector<float> values = scene(1);
  Detector detector = whole_chain();
  detector.bayer = {};
  const Readout out = read_out(detector, input(values, 1), 1, 2, true);
  const Readout plain = read_out(detector, input(values, 1), 1, 2);
  EXPECT_EQ(out.dn, plain.dn);
  for (std::size_t i = 0; i < out.dn.size(); ++i) {
    double sum = out.signal[i];
    for (const auto& added : out.added)
      if (!added.empty()) sum += added[i];
    ASSERT_NEAR(sum, (out.dn[i] - detector.bias_dn) / detector.dn_per_e, 0.02);
  }
  // a switch leaves out its stage alone
  for (std::size_t k = 0; k + 1 < kDetectorStages; ++k) {
    Detector without = detector;
    without.off[k] = true;
    const Readout less = read_out(without, input(values, 1), 1, 2, true);
    EXPECT_TRUE(less.added[k].empty());
    EXPECT_FALSE(std::ranges::all_of(out.added[k], [](float v) { return v == 0; }))
        << kDetectorStageNames[k];
    EXPECT_NE(less.dn, out.dn) << kDetectorStageNames[k];
  }
}

TEST(Detector, FiltersChooseBandsAndWrongValuesAreCounted) {
  Detector detector;
  detector.bayer = {'g', 'r', 'b', 'g'};
  detector.off[static_cast<std::size_t>(DetectorStage::shot)] = true;
  std::vector<float> values;
  for (int i = 0; i < 16; ++i) values.insert(values.end(), {100, 200, 300});
  MeanElectrons means;
  means.width = means.height = 4;
  means.bands = 3;
  means.values = values;
  const Readout out = read_out(detector, means, 0, 0);
  const std::vector<std::uint16_t> rows{200, 100, 200, 100, 300, 200, 300, 200};
  EXPECT_TRUE(std::equal(rows.begin(), rows.end(), out.dn.begin()));
  EXPECT_EQ(out.invalid, 0u);
  detector.bayer = {};
  EXPECT_EQ(read_out(detector, means, 0, 0).dn[0], 600);
  values[0] = -1;
  values[4] = std::nanf("");
  values[8] = -INFINITY;
  const Readout wrong = read_out(detector, means, 0, 0);
  EXPECT_EQ(wrong.invalid, 3u);
  EXPECT_EQ(wrong.dn[0], 500);
  values[8] = INFINITY;
  EXPECT_EQ(read_out(detector, means, 0, 0).invalid, 3u);
  EXPECT_EQ(read_out(detector, means, 0, 0).dn[2], 4095);
  values[8] = 0;
  // full wells and the converter's end
  detector.full_well_e = 550;
  const Readout full = read_out(detector, means, 0, 0);
  EXPECT_EQ(full.saturated, 13u);
  EXPECT_NEAR(full.lost, 13 * 50, 1e-9);
  detector.bits = 8;
  detector.compressed_bits = 4;
  detector.full_well_e = 1e5;
  EXPECT_EQ(read_out(detector, means, 0, 0).dn[3], 15);  // √(255/255)·15
  values.assign(48, 20);
  EXPECT_EQ(read_out(detector, means, 0, 0).dn[3], 7);  // √(60/255)·15 = 7.3
}

}  // namespace
}  // namespace panwright::sensor::detector_test
