// Tracks of charged particles through a detector. Private to sensor.
#pragma once

#include <cstdint>
#include <vector>

#include "sensor/detector.h"

namespace panwright::sensor {

struct Deposit {
  std::uint32_t pixel = 0;  // of the whole detector, row-major
  double electrons = 0;     // mean
};

inline constexpr double kElectronsPerMicrometre = 80;  // of a minimum ionising particle in silicon

// Straight tracks of an isotropic flux through the slab; they enter uniformly over the detector.
// Sorted by pixel.
std::vector<Deposit> cosmic_deposits(const Detector& detector, std::uint32_t width,
                                     std::uint32_t height, std::uint64_t seed, std::uint32_t frame);

}  // namespace panwright::sensor
