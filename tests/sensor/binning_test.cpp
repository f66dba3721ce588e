// Detectors whose pixels are read in blocks: noise, wells, bytes; camera files with binning.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "sensor/camera_file.h"
#include "sensor/detector.h"

namespace panwright::sensor::binning_test {
namespace {

Readout flat(const Detector& detector, double electrons, std::uint32_t side, std::uint32_t frame) {
  const std::vector<float> values(std::size_t{side} * side, static_cast<float>(electrons));
  MeanElectrons means;
  means.width = means.height = side;
  means.values = values;
  return read_out(detector, means, 5, frame, true);
}

// Mean, and variance in time by pairs of frames, of blocks of 2 × 2 pixels.
struct Statistics {
  double mean = 0, variance = 0;
};

Statistics statistics(const Detector& detector, double electrons) {
  constexpr std::uint32_t kSide = 256, kPairs = 4;
  Statistics out;
  for (std::uint32_t k = 0; k < kPairs; ++k) {
    const auto a = flat(detector, electrons, kSide, 2 * k).dn,
               b = flat(detector, electrons, kSide, 2 * k + 1).dn;
    for (std::size_t i = 0; i < a.size(); ++i) {
      out.mean += 0.5 * (a[i] + b[i]) / (kPairs * kSide * kSide);
      out.variance += 0.5 * (a[i] - b[i]) * (a[i] - b[i]) / (double{kPairs} * kSide * kSide);
    }
  }
  return out;
}

Detector block() {
  Detector detector;
  detector.binning = 2;
  detector.exposure_s = 0.5;
  detector.dark_e_per_s = 20;
  detector.read_noise_e = 12;
  detector.full_well_e = 5000;
  detector.dn_per_e = 0.5;
  detector.bias_dn = 100;
  return detector;
}

// Charge is read once: noise² = light + dark + read²; numbers four times: light + dark + 4 read².
TEST(Binning, NoiseIsReadOnceOfChargeAndOftenOfNumbers) {
  constexpr double kLight = 300, kDark = 4 * 20 * 0.5;
  // 262144 pairs: the standard error of a variance is 0.28 %; measured residuals are below 0.5 %
  constexpr double kWithin = 0.012;
  const Statistics charge = statistics(block(), kLight);
  EXPECT_NEAR(charge.mean, 100 + 0.5 * (kLight + kDark), 0.1);
  const double once = 0.25 * (kLight + kDark + 144) + 1.0 / 12;
  EXPECT_NEAR(charge.variance, once, kWithin * once);
  Detector numbers = block();
  numbers.sums_numbers = true;
  const Statistics sum = statistics(numbers, kLight);
  EXPECT_NEAR(sum.mean, 4 * 100 + 0.5 * (kLight + kDark), 0.2);
  const double often = 0.25 * (kLight + kDark + 4 * 144) + 4.0 / 12;
  EXPECT_NEAR(sum.variance, often, kWithin * often);
  // the equivalent detector has the same noise
  for (const Detector& each : {block(), numbers}) {
    const Detector one = detector_of_blocks(each);
    EXPECT_EQ(one.binning, 1u);
    const Statistics like = statistics(one, kLight), is = statistics(each, kLight);
    EXPECT_NEAR(like.mean, is.mean, 0.2);
    EXPECT_NEAR(like.variance, is.variance, 2 * kWithin * is.variance);
  }
}

// Fixed patterns of pixels average in blocks.
TEST(Binning, PatternsAverage) {
  Detector detector = block();
  detector.prnu = 0.04;
  for (const DetectorStage off : {DetectorStage::shot, DetectorStage::read, DetectorStage::dark})
    detector.off[static_cast<std::size_t>(off)] = true;
  const auto out = flat(detector, 4000, 256, 0);
  double sum = 0, squares = 0;
  for (const float charge : out.electrons) sum += charge, squares += double(charge) * charge;
  const double mean = sum / 65536, spread = std::sqrt(squares / 65536 - mean * mean);
  EXPECT_NEAR(mean, 4000, 2);
  EXPECT_NEAR(spread / mean, 0.04 / 2, 0.0003);  // 65536 blocks: 0.28 %
}

// A block is full where one of its pixels is; numbers hold the sums.
TEST(Binning, WellsAreThoseOfPixels) {
  Detector detector = block();
  detector.bias_dn = 0;
  detector.bits = 14;
  const auto full = flat(detector, 40000, 16, 0);
  EXPECT_EQ(full.saturated, 256u);
  for (const float charge : full.electrons) EXPECT_EQ(charge, 4 * 5000);
  for (const std::uint8_t each : saturated_pixels(detector, full.dn, full.electrons))
    EXPECT_EQ(each, 1);
  EXPECT_EQ(flat(detector, 8000, 16, 0).saturated, 0u);
  detector.sums_numbers = true;
  detector.dn_per_e = 100;
  const auto top = flat(detector, 4000, 16, 0);
  EXPECT_EQ(detector.most_dn(), 4 * 16383u);
  EXPECT_EQ(detector.stored_bits(), 16u);
  for (const std::uint16_t each : top.dn) EXPECT_EQ(each, 4 * 16383);
  EXPECT_EQ(top.saturated, 256u);
}

// Layers add up, and the numbers do not depend on parts of the detector.
TEST(Binning, LayersAddUpAndPartsAgree) {
  constexpr std::uint32_t kWide = 40, kHigh = 30;
  std::vector<float> values(kWide * kHigh);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(
        9000 * in_unit(philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {5, 5})[0]));
  for (const bool numbers : {false, true}) {
    Detector detector = block();
    detector.sums_numbers = numbers;
    detector.prnu = 0.02;
    detector.hot_pixels = 0.02;
    detector.hot_e_per_s = 2000;
    detector.nonlinearity = {-0.02, 0};
    MeanElectrons means;
    means.width = kWide;
    means.height = kHigh;
    means.values = values;
    const Readout whole = read_out(detector, means, 3, 4, true);
    const double bias = numbers ? 4 * detector.bias_dn : detector.bias_dn;
    for (std::size_t i = 0; i < whole.dn.size(); ++i) {
      double sum = whole.signal[i];
      for (const auto& added : whole.added)
        if (!added.empty()) sum += added[i];
      ASSERT_NEAR(sum, (whole.dn[i] - bias) / detector.dn_per_e, 0.02);
    }
    MeanElectrons tile{7, 5, 20, 11, kWide, kHigh, 1, {}};
    std::vector<float> part;
    for (std::uint32_t y = 5; y < 16; ++y)
      part.insert(part.end(), values.begin() + y * kWide + 7, values.begin() + y * kWide + 27);
    tile.values = part;
    const Readout some = read_out(detector, tile, 3, 4);
    for (std::uint32_t y = 0; y < 11; ++y)
      for (std::uint32_t x = 0; x < 20; ++x)
        ASSERT_EQ(some.dn[y * 20 + x], whole.dn[(y + 5) * kWide + x + 7]);
  }
}

Result<CameraFile> camera_of(const std::string& binning, const std::string& optics,
                             const std::string& detector, std::string& said) {
  DiagnosticLog log;
  auto camera = read_camera("size = [64, 48]\nfocal_length_mm = 50\npixel_um = 5\n" + binning +
                                "\n[optics]\nf_number = 5\n" + optics +
                                "\n[detector]\nexposure_s = 0.01\n" + detector,
                            "c", log);
  said = to_text(log);
  return camera;
}

TEST(Binning, CameraFilesHaveIt) {
  std::string said;
  const auto camera = camera_of("binning = [2, 2]", "psf_px = 0.8\ndefocus_px = 3",
                                "read_noise_e = 5\nblock_sum = \"numbers\"", said);
  ASSERT_TRUE(camera) << said;
  EXPECT_EQ(camera->width, 32u);
  EXPECT_EQ(camera->lens.focal.x, 5000);
  const Imager& imager = *camera->imager;
  EXPECT_EQ(imager.detector.binning, 2u);
  EXPECT_TRUE(imager.detector.sums_numbers);
  EXPECT_EQ(imager.detector.pixel_um, Vec2(5, 5));
  EXPECT_NEAR(imager.optics.aperture_mm, 10, 1e-12);  // of the lens, whatever is read
  EXPECT_EQ(imager.optics.psf_px, 0.4);
  EXPECT_EQ(imager.optics.defocus_px, 1.5);
  DiagnosticLog log;
  const auto again = parse_imager(imager_text(imager), log);
  ASSERT_TRUE(again) << to_text(log);
  EXPECT_EQ(*again, imager);
  // the text of the camera reads back as the same
  const auto text = camera_text(*camera, CameraFormat::toml, log);
  ASSERT_TRUE(text) << to_text(log);
  const auto same = read_camera(*text, "again", log);
  ASSERT_TRUE(same) << to_text(log) << *text;
  EXPECT_EQ(*same->imager, imager);
  EXPECT_EQ(same->width, 32u);

  const auto refused = [&](const std::string& binning, const std::string& optics,
                           const std::string& detector, const std::string& why) {
    EXPECT_FALSE(camera_of(binning, optics, detector, said));
    EXPECT_NE(said.find(why), said.npos) << said;
  };
  refused("binning = [2, 1]", "", "", "square blocks");
  refused("binning = [2, 2]", "", "bayer = \"rggb\"", "expected a mono one");
  refused("binning = [2, 2]", "kernel = [[1]]", "", "measured kernel");
  refused("binning = [4, 4]", "", "bits = 14\nblock_sum = \"numbers\"", "18 bits");
  refused("binning = [2, 2]", "", "block_sum = \"numbers\"\ncompressed_bits = 8", "compressed");
  refused("binning = [2, 2]", "", "block_sum = \"sum\"", "expected \"charge\" or \"numbers\"");
  refused("", "", "blocks = 17", "blocks");
}

}  // namespace
}  // namespace panwright::sensor::binning_test
