// Streams of random numbers of a detector. Private to sensor.
#pragma once

#include <array>
#include <cstdint>

namespace panwright::sensor {

// Stages of counters (sensor/draws.h). Fixed patterns have frame 0 and the serial number as key.
enum class StreamStage : std::uint32_t {
  pattern = 1,  // PRNU and DSNU
  defects = 2,  // hot and telegraph pixels
  telegraph = 3,
  cosmic = 4,
  shot = 5,
  read = 6,
};

constexpr std::array<std::uint32_t, 2> key_of(std::uint64_t number) {
  return {static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
}

}  // namespace panwright::sensor
