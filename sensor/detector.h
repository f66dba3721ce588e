// Detectors: digital numbers of mean electrons. Pure functions, the same bytes on every machine.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/math.h"

namespace panwright::sensor {

// Stages, in their order.
enum class DetectorStage : std::uint8_t {
  prnu,          // response of each pixel
  smear,         // of frame transfer
  dark,          // dark current
  dsnu,          // of each pixel
  hot,           // pixels of much dark current
  telegraph,     // pixels whose dark current jumps
  cosmic,        // tracks of charged particles
  shot,          // Poisson numbers
  well,          // full well and blooming
  nonlinearity,  // of the charge
  read,          // read noise
  adc,           // gain, bias, rounding, limits
};
inline constexpr std::string_view kDetectorStageNames[] = {"prnu", "smear",        "dark",   "dsnu",
                                                           "hot",  "telegraph",    "cosmic", "shot",
                                                           "well", "nonlinearity", "read",   "adc"};
inline constexpr std::size_t kDetectorStages = std::size(kDetectorStageNames);

// Filters of the pixels: 'r', 'g', 'b' of (0,0), (1,0), (0,1), (1,1).
using BayerPattern = std::array<char, 4>;

inline constexpr double kDarkReference = 293.15;  // K, of dark currents

struct Detector {
  Vec2 pixel_um{5.5, 5.5};                   // sides of a pixel, µm
  double exposure_s = 0.01;                  // > 0
  BayerPattern bayer{};                      // all 0: mono
  double prnu = 0;                           // RMS, share of the signal
  double dark_e_per_s = 0;                   // a pixel, at kDarkReference
  double temperature_k = kDarkReference;     // 100 to 350
  double dsnu = 0;                           // RMS, share of the dark current
  double hot_pixels = 0;                     // share
  double hot_e_per_s = 0;                    // mean of an exponential law, at kDarkReference
  double telegraph_pixels = 0;               // share
  double telegraph_e_per_s = 0;              // likewise, while on
  std::uint32_t telegraph_frames = 1;        // length of a state
  double cosmic_per_cm2_s = 0;               // tracks
  double depth_um = 10;                      // of the slab that collects charge
  double full_well_e = 10000;                // >= 1
  bool blooming = false;                     // else what is beyond the well is lost
  double smear_row_s = 0;                    // time in a row while shifting; 0: no frame transfer
  bool smear_flush = false;                  // emptied before the exposure
  std::array<double, 2> nonlinearity{0, 0};  // q (1 + a x + b x²), x = q / full well
  double read_noise_e = 0;                   // RMS
  double dn_per_e = 1;                       // gain
  double bias_dn = 0;
  std::uint32_t bits = 12;            // 2 to 16
  std::uint32_t compressed_bits = 0;  // of the square root of numbers; 0: none
  std::uint32_t binning = 1;  // side of the blocks of pixels that are read as one; mono then
  bool sums_numbers = false;  // of the pixels of a block; else their charge, read once
  std::uint64_t serial = 0;   // of the specimen: its fixed patterns
  std::array<bool, kDetectorStages> off{};  // stages that are left out; not the ADC

  bool operator==(const Detector&) const = default;

  bool has(DetectorStage stage) const { return !off[static_cast<std::size_t>(stage)]; }
  bool is_mono() const { return bayer[0] == 0; }
  // Smear or blooming, which need whole columns.
  bool moves_charge() const {
    return (blooming && has(DetectorStage::well)) || (smear_row_s > 0 && has(DetectorStage::smear));
  }
  // Largest number that is stored, and its bits.
  std::uint32_t most_dn() const {
    const std::uint32_t one = (1u << (compressed_bits > 0 ? compressed_bits : bits)) - 1;
    return sums_numbers ? one * binning * binning : one;
  }
  std::uint32_t stored_bits() const {
    return static_cast<std::uint32_t>(std::bit_width(most_dn()));
  }
};

// Ratio of the dark current of silicon at a temperature (K) to that at kDarkReference.
//
// Source: J. R. Janesick, "Scientific Charge-Coupled Devices", 2001, eq. 7.22 and 7.23.
double dark_ratio(double temperature_k);

// Dark current of a pixel, e/s, of a density at 300 K.
double dark_current(double na_per_cm2, const Vec2& pixel_um, double temperature_k);

// The detector without binning that blocks are like: its gain, noise and full well, but for defects
// and tracks, rounding and the wells of single pixels.
Detector detector_of_blocks(Detector detector);

// Mean photoelectrons of a part of a detector, at the end of its exposure. With binning pixels are
// blocks, and light is even within each.
struct MeanElectrons {
  std::uint32_t x = 0, y = 0;           // of its first pixel
  std::uint32_t width = 0, height = 0;  // of the part
  std::uint32_t detector_width = 0;     // 0: of the part
  std::uint32_t detector_height = 0;
  std::uint32_t bands = 1;        // 1, or 3: red, green, blue
  std::span<const float> values;  // bands*width*height, bands of a pixel next to each other
};

struct Readout {
  std::vector<std::uint16_t> dn;  // width*height, as stored
  // Charge before the read noise, electrons.
  std::vector<float> electrons;
  // If asked for: the photoelectrons, and by stage what it added, electrons. Their sum is
  // (numbers − bias) / gain of the converter.
  std::vector<float> signal;
  std::array<std::vector<float>, kDetectorStages> added;
  double lost = 0;  // electrons beyond the well that no pixel took
  // Pixels at the full well or the largest number; blocks that have one.
  std::size_t saturated = 0;
  // Values that are negative or not a number, taken as 0, or infinite, taken as 1e12.
  std::size_t invalid = 0;
};

// Reads a detector out. The bytes depend on the arguments alone, not on threads or on the parts in
// which a detector is read.
//
//   seed, frame  of the random numbers of this exposure
//   layers       fills Readout::signal and added
// Expects: a detector within the bounds above; with moves_charge() a part of whole columns.
// Cost: some 30 ns a pixel and core with Poisson, dark, read noise and ADC; twice that with all.
Readout read_out(const Detector& detector, const MeanElectrons& means, std::uint64_t seed,
                 std::uint32_t frame, bool layers = false);

// Returns 1 for each pixel that Readout::saturated counts, of its numbers and electrons; with
// compressed numbers also for those next to the largest, with binning for blocks full in all
// pixels.
std::vector<std::uint8_t> saturated_pixels(const Detector& detector,
                                           std::span<const std::uint16_t> dn,
                                           std::span<const float> electrons);

}  // namespace panwright::sensor
