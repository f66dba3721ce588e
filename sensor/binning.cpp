#include <algorithm>
#include <cassert>
#include <utility>

#include "base/parallel.h"
#include "sensor/internal/binning.h"

namespace panwright::sensor {

namespace {

using Stage = DetectorStage;

// Parts of a detector in pixels and in blocks.
struct Blocks {
  std::uint32_t side = 1;
  std::uint32_t width = 0, height = 0;  // of the part, blocks

  std::size_t count() const { return std::size_t{width} * height; }

  // Calls (block, pixel) for all pixels, in their order within each block.
  template <class Body>
  void each(const Body& body) const {
    const std::size_t across = std::size_t{width} * side;
    parallel_for(height, [&](std::size_t row) {
      for (std::size_t y = row * side; y < (row + 1) * side; ++y)
        for (std::size_t x = 0; x < across; ++x) body(row * width + x / side, y * across + x);
    });
  }

  template <class To, class From>
  std::vector<To> sums(const std::vector<From>& of) const {
    std::vector<double> sum(of.empty() ? 0 : count());
    if (!of.empty()) each([&](std::size_t block, std::size_t pixel) { sum[block] += of[pixel]; });
    std::vector<To> out(sum.size());
    std::ranges::transform(sum, out.begin(), [](double each) { return static_cast<To>(each); });
    return out;
  }
};

// What happens to the charge of pixels, without the converter.
Detector without_reading(Detector detector) {
  detector.off[static_cast<std::size_t>(Stage::nonlinearity)] = true;
  detector.off[static_cast<std::size_t>(Stage::read)] = true;
  // a converter that takes any charge
  detector.dn_per_e = 1e-6;
  detector.bias_dn = 0;
  detector.bits = 16;
  detector.compressed_bits = 0;
  return detector;
}

// What happens to the charge of blocks when it is read.
Detector reading(Detector detector, double pixels) {
  const std::array<bool, kDetectorStages> given = detector.off;
  detector.off.fill(true);
  for (const Stage stage : {Stage::nonlinearity, Stage::read, Stage::adc})
    detector.off[static_cast<std::size_t>(stage)] = given[static_cast<std::size_t>(stage)];
  detector.full_well_e *= pixels;
  detector.cosmic_per_cm2_s = 0;
  detector.blooming = false;
  return detector;
}

}  // namespace

Readout read_out_blocks(const Detector& detector, const MeanElectrons& means, std::uint64_t seed,
                        std::uint32_t frame, bool layers) {
  assert(detector.is_mono());
  const std::uint32_t side = detector.binning;
  const Blocks blocks{side, means.width, means.height};
  const auto pixels = static_cast<float>(side * side);
  Detector one = detector;
  one.binning = 1;
  one.sums_numbers = false;
  const Detector charge = detector.sums_numbers ? one : without_reading(one);
  std::vector<float> values(blocks.count() * side * side * means.bands);
  blocks.each([&](std::size_t block, std::size_t pixel) {
    for (std::uint32_t k = 0; k < means.bands; ++k)
      values[pixel * means.bands + k] = means.values[block * means.bands + k] / pixels;
  });
  MeanElectrons fine{means.x * side,
                     means.y * side,
                     means.width * side,
                     means.height * side,
                     means.detector_width * side,
                     means.detector_height * side,
                     means.bands,
                     values};
  Readout of_pixels = read_out(charge, fine, seed, frame, layers);
  const std::vector<std::uint8_t> full =
      saturated_pixels(charge, of_pixels.dn, of_pixels.electrons);
  std::vector<std::uint8_t> saturated(blocks.count());
  blocks.each([&](std::size_t block, std::size_t pixel) { saturated[block] |= full[pixel]; });
  Readout out;
  out.electrons = blocks.sums<float>(of_pixels.electrons);
  if (detector.sums_numbers) {
    out.dn = blocks.sums<std::uint16_t>(of_pixels.dn);
  } else {
    const Detector converter = reading(one, pixels);
    MeanElectrons sums = means;
    sums.bands = 1;
    sums.values = out.electrons;
    Readout read = read_out(converter, sums, seed, frame, layers);
    const auto top = saturated_pixels(converter, read.dn, read.electrons);
    for (std::size_t i = 0; i < top.size(); ++i) saturated[i] |= top[i];
    out.dn = std::move(read.dn);
    out.electrons = std::move(read.electrons);
    for (const Stage stage : {Stage::nonlinearity, Stage::read, Stage::adc}) {
      const auto k = static_cast<std::size_t>(stage);
      of_pixels.added[k].clear();
      out.added[k] = std::move(read.added[k]);
    }
  }
  out.signal = blocks.sums<float>(of_pixels.signal);
  for (std::size_t k = 0; k < kDetectorStages; ++k)
    if (!of_pixels.added[k].empty()) out.added[k] = blocks.sums<float>(of_pixels.added[k]);
  out.lost = of_pixels.lost;
  out.saturated = static_cast<std::size_t>(std::ranges::count(saturated, 1));
  out.invalid = of_pixels.invalid / (side * side);
  return out;
}

Detector detector_of_blocks(Detector detector) {
  const double side = detector.binning, pixels = side * side;
  detector.full_well_e *= pixels;
  detector.dark_e_per_s *= pixels;
  detector.prnu /= side;
  detector.dsnu /= side;
  detector.pixel_um *= side;
  if (detector.sums_numbers) {
    detector.bits = detector.stored_bits();
    detector.bias_dn *= pixels;
    detector.read_noise_e *= side;
  }
  detector.binning = 1;
  detector.sums_numbers = false;
  return detector;
}

}  // namespace panwright::sensor
