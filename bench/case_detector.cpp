// Detectors: speed of a readout beside the error of the gain that its images give back.
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/random.h"
#include "bench/bench.h"
#include "sensor/detector.h"

namespace panwright::bench::case_detector {

namespace {

using sensor::Detector;

Detector usual() {
  Detector detector;
  detector.dark_e_per_s = 100;
  detector.read_noise_e = 8;
  detector.full_well_e = 13500;
  detector.dn_per_e = 0.3;
  detector.bias_dn = 64;
  return detector;
}

Detector whole() {
  Detector detector = usual();
  detector.bayer = {'r', 'g', 'g', 'b'};
  detector.prnu = 0.01;
  detector.dsnu = 0.3;
  detector.hot_pixels = detector.telegraph_pixels = 1e-4;
  detector.hot_e_per_s = detector.telegraph_e_per_s = 2000;
  detector.cosmic_per_cm2_s = 100;
  detector.blooming = true;
  detector.smear_row_s = 1e-6;
  detector.nonlinearity = {-0.01, 0};
  return detector;
}

// Relative error of the gain by the variance of pairs of flat fields, whose nonlinearity is known.
double gain_error(Detector detector, std::uint32_t side) {
  constexpr double kSignal = 6000;
  detector.bayer = {};
  detector.nonlinearity = {};
  detector.smear_row_s = 0;
  detector.cosmic_per_cm2_s = 0;
  const std::vector<float> values(std::size_t{side} * side, static_cast<float>(kSignal));
  sensor::MeanElectrons means;
  means.width = means.height = side;
  means.values = values;
  const auto a = read_out(detector, means, 1, 0), b = read_out(detector, means, 1, 1);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.dn.size(); ++i) {
    const double difference = double(a.dn[i]) - b.dn[i];
    sum += 0.5 * (a.dn[i] + b.dn[i]);
    squares += 0.5 * difference * difference;
  }
  const double count = static_cast<double>(a.dn.size());
  const double noise = std::pow(detector.dn_per_e * detector.read_noise_e, 2) + 1.0 / 12;
  const double gain = (squares / count - noise) / (sum / count - detector.bias_dn);
  return std::fabs(gain / detector.dn_per_e - 1);
}

void run_detector(Context& context) {
  const std::uint32_t side = context.quick() ? 256 : 2048;
  const std::size_t pixels = std::size_t{side} * side;
  std::vector<float> values(3 * pixels);
  for (std::size_t i = 0; i < values.size(); ++i) {
    // a dark half, as before the sky, and a lit one
    const double share = in_unit(philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {1, 1})[0]);
    values[i] = static_cast<float>((i / 3 / side) % 2 == 0 ? 2 * share : 9000 * share);
  }
  sensor::MeanElectrons mono, color;
  mono.width = mono.height = color.width = color.height = side;
  mono.values = std::span(values).first(pixels);
  color.bands = 3;
  color.values = values;
  const Detector plain = usual(), all = whole();
  const auto timings = interleaved({{"usual", [&] { (void)read_out(plain, mono, 1, 2); }},
                                    {"whole", [&] { (void)read_out(all, color, 1, 2); }}},
                                   context.runs());
  for (std::size_t k = 0; k < 2; ++k) {
    Row row{.case_name = "detector",
            .setting = k == 0 ? "Poisson, dark, read, ADC" : "all stages, Bayer",
            .speed_unit = "Mpx/s",
            .error = gain_error(k == 0 ? plain : all, context.quick() ? 1024 : 2048),
            .error_unit = "relative",
            .reference = "gain of the detector, by its photon transfer",
            .reference_error = std::sqrt(2.0 / static_cast<double>(pixels)),
            .must = k == 0 ? 30.0 : 10.0,
            .must_error = 0.005};
    set_rate(row, timings[k], 1e-6 * static_cast<double>(pixels));
    context.add(row);
  }
}

const bool kAdded = add_case({"detector", "readout of detectors", run_detector});

}  // namespace

}  // namespace panwright::bench::case_detector
