// Detectors whose pixels are read in blocks. Private to sensor.
#pragma once

#include <cstdint>

#include "sensor/detector.h"

namespace panwright::sensor {

// As read_out(), of a detector with binning: light is even within a block. Expects: mono.
Readout read_out_blocks(const Detector& detector, const MeanElectrons& means, std::uint64_t seed,
                        std::uint32_t frame, bool layers);

}  // namespace panwright::sensor
